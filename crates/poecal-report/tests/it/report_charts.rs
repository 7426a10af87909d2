//! The charts of the rows: a dot for each row at its value, few for long sessions, and none for a joint that moves no target.

use crate::report_page::{Session, data_of, numbers_of};
use poecal_formats::urdf::{ChainSelection, UrdfDocument};
use poecal_model::simulate::{GrossErrors, SessionKind, Simulation, elbow};
use serde_json::Value;

/// The markup of a chart.
fn chart<'a>(page: &'a str, name: &str) -> &'a str {
    let rest = page.split_once(&format!("data-chart=\"{name}\"")).unwrap().1;
    rest.split_once("</figure>").unwrap().0
}

fn attribute<'a>(markup: &'a str, name: &str) -> &'a str {
    markup.split_once(&format!(" {name}=\"")).unwrap().1.split_once('"').unwrap().0
}

/// The dots of a class as the page's script reads them, `None` for rows without one.
fn dots(chart: &str, class: &str) -> Vec<Option<[f64; 2]>> {
    let Some((_, rest)) = chart.split_once(&format!("<path class=\"dots {class}\"")) else {
        return Vec::new();
    };
    let mut at = [0.0, 0.0];
    let dot = |text: &str| {
        let (numbers, length) = text.split_once('h').unwrap_or((text, ""));
        let cut = numbers.rfind(['-', ' ']).unwrap();
        at[0] += numbers[..cut].parse::<f64>().unwrap();
        at[1] += numbers[cut..].trim().parse::<f64>().unwrap();
        let dot = at;
        at[0] += length.parse().unwrap_or(0.0);
        (!length.is_empty()).then_some(dot)
    };
    attribute(rest, "d").split('m').skip(1).map(dot).collect()
}

/// Position of a value along an axis, by the labels of its first and its last tick; `share` is the attribute with their positions.
fn place_on_axis(chart: &str, axis: &str, share: &str, value: f64) -> f64 {
    let group = chart.split_once(&format!("<g class=\"{axis}\"")).unwrap().1.split_once("</g>").unwrap().0;
    let ticks: Vec<(f64, f64)> = group
        .split("<text ")
        .filter_map(|text| {
            let place = text.split_once(&format!("{share}=\""))?.1.split_once('%')?.0.parse::<f64>().ok()?;
            let label = text.split_once('>')?.1.split_once('<')?.0.replace('−', "-").parse::<f64>().ok()?;
            Some((label, place / 100.0))
        })
        .collect();
    let ((a, from), (b, to)) = (ticks[0], *ticks.last().unwrap());
    from + (to - from) * (value - a) / (b - a)
}

/// The rows of each class of dots.
fn rows_of(data: &Value, class: &str) -> Vec<usize> {
    let is_of = |digit: u8| match class {
        "s0" => digit & 1 == 0,
        "s1" => digit & 1 == 1,
        _ => digit & 2 == 2,
    };
    let sets = data["rows"]["sets"].as_str().unwrap().bytes();
    sets.enumerate().filter(|(_, digit)| is_of(digit - b'0')).map(|(row, _)| row).collect()
}

#[test]
fn every_row_has_its_dot_where_its_error_is() {
    let mut made = Simulation { count: 80, ..Simulation::default() }.run(&elbow(), SessionKind::POSE).unwrap();
    let gross = GrossErrors { share: 0.05, ..GrossErrors::default() }.spoil(&mut made.data);
    let page = Session::from_dataset(&elbow(), made.data).page();
    let (data, chart) = (data_of(&page), chart(&page, "rows"));
    let errors = numbers_of(&data["rows"]["error_mm"]);
    let [width, height] =
        [0, 1].map(|k| attribute(chart, "viewBox").split(' ').nth(2 + k).unwrap().parse::<f64>().unwrap());
    let mut count = 0;
    for class in ["s0", "s1", "alarm"] {
        let (rows, dots) = (rows_of(&data, class), dots(chart, class));
        assert_eq!(rows.len(), dots.len(), "{class}");
        for (row, dot) in rows.into_iter().zip(dots) {
            let [x, y] = dot.unwrap();
            let expected = [
                width * place_on_axis(chart, "x", "x", row as f64 + 1.0),
                height * place_on_axis(chart, "y", "y", errors[row].unwrap()),
            ];
            // Half a unit, and ticks to a tenth of a per cent.
            assert!(
                (x - expected[0]).abs() < 3.0 && (y - expected[1]).abs() < 2.0,
                "{class} {row}: {x} {y} {expected:?}"
            );
            count += 1;
        }
    }
    println!("{count} dots, {} of them of wrong rows", gross.len());
    assert!(count > 80 && !gross.is_empty());
}

#[test]
fn long_sessions_have_few_dots_and_every_chart() {
    for (count, most, few) in [(100, 100, 100), (5000, 4000, 600)] {
        let page = Session::new(&elbow(), SessionKind::POSE, count).page();
        let drawn = |markup: &str| markup.matches("h0").count() + markup.matches("h1").count();
        let [rows, components, joints] = ["rows", "components", "joints"].map(|name| chart(&page, name));
        assert!(drawn(rows) <= most && drawn(rows) > most * 8 / 10, "{}", drawn(rows));
        for cell in
            components.split("class=\"cell\"").chain(joints.split("class=\"cell\"")).filter(|it| it.contains("<svg"))
        {
            let is_still = cell.contains("does not move with this joint");
            assert!(drawn(cell) <= few && (drawn(cell) > few / 2) != is_still, "{}", drawn(cell));
        }
        assert_eq!((components.matches("class=\"cell\"").count(), joints.matches("class=\"cell\"").count()), (6, 6));
        // Each residual over each joint has an axis, and a curve of its own.
        assert_eq!(joints.matches("<g class=\"y\"").count(), 6 * 8);
        assert!(joints.matches("class=\"ink line\" d=\"m").count() > 40);
        assert!(drawn(chart(&page, "normal")) > 100 && drawn(chart(&page, "leverage")) > count.min(most) / 2);
        assert!(chart(&page, "histogram").contains("s0 bars") && chart(&page, "histogram").contains("s1 line"));
    }
}

/// On a robot with two arms, a joint of one arm moves no target of the other; a shared joint moves both alike, together with the cameras on it.
#[test]
fn a_joint_of_the_other_arm_has_no_residual_along_its_motion() {
    let pairs = |pairs: [(&str, &str); 2]| pairs.map(|(name, link)| (name.to_owned(), link.to_owned()));
    let selection = ChainSelection {
        instruments: pairs([("eyes", "head_camera"), ("chest", "torso")]).into(),
        targets: pairs([("left", "left_hand"), ("right", "right_hand")]).into(),
        ..ChainSelection::default()
    };
    let text = include_str!("../../../poecal-testing/data/torso.urdf");
    let document = UrdfDocument::parse(text, "torso.urdf", &selection).unwrap();
    let page = Session::new(document.robot(), SessionKind::POSE, 300).page();
    let data = data_of(&page);
    let targets = data["rows"]["target"].as_array().unwrap();
    let joints = chart(&page, "joints");
    // Number of rows of each target with a dot over a joint, and number of its rows that are not suspected.
    let counted = |joint: &str| {
        let cell =
            joints.split("class=\"cell\"").find(|it| it.contains(&format!("<p class=\"name\">{joint}<"))).unwrap();
        let mut found = [0, 0];
        for class in ["s0", "s1"] {
            for (row, dot) in rows_of(&data, class).into_iter().zip(dots(cell, class)) {
                found[targets[row].as_u64().unwrap() as usize] += usize::from(dot.is_some());
            }
        }
        found
    };
    let rows = [0, 1].map(|target| targets.iter().filter(|it| it.as_u64() == Some(target)).count());
    let [left, right] = [counted("left2"), counted("right2")];
    println!("{rows:?} rows, left {left:?}, right {right:?}");
    assert_eq!((left[1], right[0]), (0, 0));
    // A few beyond the range of the axis, or suspected, are not drawn.
    assert!(left[0] * 20 >= rows[0] * 19 && right[1] * 20 >= rows[1] * 19);
    assert_eq!(counted("torso2"), [0, 0]);
}
