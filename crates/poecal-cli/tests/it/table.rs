//! The table of a calibration: the verdict first, short, nothing twice, no long list.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use poecal_model::simulate::{SessionKind, Simulation};
use poecal_results::model::Model;

use crate::folder::Folder;
use crate::project::root;
use crate::session::{ROBOT, session};

/// Lines that the whole standard output has at most.
const LINES: usize = 14;
/// Names that a list has at most; the last may be the number of further ones.
const NAMES: usize = 5;

/// Labels of prose; others are of tables.
const LABELS: [&str; 7] = ["verdict", "look at", "determined", "undetermined", "more", "written", "report"];

/// The labelled paragraphs of a table.
fn paragraphs(out: &str) -> Vec<(String, String)> {
    let mut found: Vec<(String, String)> = Vec::new();
    for line in out.lines().filter(|line| !line.trim().is_empty()) {
        let (label, text) = line.split_at_checked(14).unwrap_or((line, ""));
        match found.last_mut() {
            Some((_, last)) if label.trim().is_empty() => write!(last, " {}", text.trim()).unwrap(),
            _ => found.push((label.trim().to_owned(), text.trim().to_owned())),
        }
    }
    found
}

fn paragraph(out: &str, label: &str) -> String {
    paragraphs(out).into_iter().find(|(name, _)| name == label).unwrap_or_else(|| panic!("no {label} in\n{out}")).1
}

/// Properties of every table: nothing twice, no long list, no line that is too wide.
fn check(out: &str) {
    assert!(out.starts_with("verdict       "), "{out}");
    assert!(out.lines().all(|line| line.chars().count() <= 80), "{out}");
    let mut sentences = BTreeSet::new();
    for (_, text) in paragraphs(out).into_iter().filter(|(label, _)| LABELS.contains(&label.as_str())) {
        let parts = text.replace("; ", "\n").replace(": ", "\n").replace(". ", "\n");
        for part in parts.lines() {
            assert!(part.split(", ").count() <= NAMES, "`{part}` is a long list in\n{out}");
            let is_new = sentences.insert(part.to_owned());
            assert!(is_new || part.split(' ').count() < 5, "`{part}` stands twice in\n{out}");
        }
    }
}

/// Measurements of the elbow in which most joints hardly move, one does not move, and some rows are wrong.
fn folder_with_poor_rows() -> Folder {
    let folder = Folder::new();
    folder.write("robot.urdf", ROBOT);
    let model = Model::read(folder.path("robot.urdf"), &Default::default()).unwrap();
    let made = Simulation { count: 80, ..Simulation::default() }.run(&model.robot, SessionKind::POINT).unwrap();
    let mut text = format!("{},x,y,z\n", made.data.reading_names().join(","));
    for row in 0..made.data.len() {
        let readings = made.data.readings(row);
        let share = [0.3, 0.3, 0.3, 0.2, 0.2, 0.0];
        let values: Vec<f64> = readings.iter().zip(share).map(|(reading, share)| reading * share + 0.5).collect();
        let place = made.device_from_base * made.actual.forward_kinematics(&values);
        let [x, y, z]: [f64; 3] = place.translation.into();
        let beside = if row % 9 == 4 { 0.03 } else { 2e-5 * ((row * 37 % 11) as f64 - 5.0) };
        let cells: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
        writeln!(text, "{},{:?},{y:?},{z:?}", cells.join(","), x + beside).unwrap();
    }
    // One row twice.
    let copied = text.lines().nth(3).unwrap().to_owned();
    folder.write("poor.csv", format!("{text}{copied}\n"));
    folder
}

#[test]
fn the_first_command_prints_a_short_table() {
    let folder = Folder::new();
    let elbow = root().join("examples/elbow");
    let words = format!("calibrate {0}/robot.urdf {0}/points.csv", elbow.display());
    let out = folder.run_to_success(&words);
    println!("{out}");
    check(&out);
    assert!(out.lines().count() <= LINES, "{} lines", out.lines().count());
    for word in ["to expect", "left out", "as drawn"] {
        assert!(!out.contains(word), "`{word}` is in\n{out}");
    }
    let order: Vec<String> = paragraphs(&out).into_iter().map(|(label, _)| label).collect();
    let at = |label: &str| order.iter().position(|it| it.starts_with(label)).unwrap_or_else(|| panic!("{order:?}"));
    let wanted = ["verdict", "before", "after", "expected", "valid", "held out", "look at", "more", "next", "written"];
    assert!(wanted.windows(2).all(|two| at(two[0]) < at(two[1])), "{order:?}");
    assert!(
        out.contains("before        20.40 mm (RMS) on rows held out: your model, tool and device\n")
            && out.contains(" mm (RMS) on rows held out: calibrated model\n"),
        "{out}"
    );

    let full = folder.run_to_success(&format!("{words} --force --verbose"));
    for words in [
        "training (70)",
        "nominal   registered   calibrated",
        "\nsolver ",
        "\nnoise ",
        "\nper joint ",
        "\njoint ",
        "\ndetermined ",
        "\ntarget ",
        "read back within",
    ] {
        assert!(full.contains(words) && !out.contains(words), "`{words}`\n{full}");
    }
}

#[test]
fn a_bad_day_is_told_in_short_lists_and_in_full_on_demand() {
    let folder = folder_with_poor_rows();
    let run = folder.run("calibrate robot.urdf poor.csv");
    println!("{}{}", run.err, run.out);
    check(&run.out);
    assert!(run.out.lines().count() <= LINES, "{}", run.out);
    assert!(run.out.contains("\nmore          --verbose: ") && run.out.contains(" more to look at, "), "{}", run.out);
    let full = folder.run("calibrate robot.urdf poor.csv --force --verbose").out;
    println!("{full}");
    assert!(!full.contains("more to look at") && full.contains("off by           position, mm"), "{full}");
    assert!(full.split("\ndetermined").next().unwrap().contains("rows are outliers"), "{full}");
    // Points without room in the table are in the report.
    let page = folder.read("poecal-out/report.html");
    assert!(page.contains("Look at") && page.contains("rows are outliers"));
}

#[test]
fn warnings_stand_in_the_table_or_on_standard_error_and_not_in_both() {
    let folder = session(SessionKind::POINT);
    let text = folder.read("measurements.csv");
    let copied = text.lines().nth(3).unwrap();
    folder.write("measurements.csv", format!("{text}{copied}\n"));
    let unused = "warning: measurements.csv: ignored the columns `stage`\n";
    let run = folder.run("calibrate robot.urdf measurements.csv");
    assert!(paragraph(&run.out, "look at").contains("1 row repeats another to the last digit"), "{}", run.out);
    assert_eq!(run.err, unused);
    let run = folder.run("calibrate robot.urdf measurements.csv --force --json");
    assert!(run.err.contains("warning: 1 row repeats another to the last digit"), "{}", run.err);
}

#[test]
fn without_held_out_rows_the_fitted_ones_are_shown_and_named() {
    let folder = session(SessionKind::POSE);
    let out = folder.run_to_success("calibrate robot.urdf measurements.csv --held-out 0");
    check(&out);
    assert!(
        out.contains("\nfitted        60 rows, at most 0.")
            && out.contains("\n              no row was held out; cross-validation 0."),
        "{out}"
    );
}

#[test]
fn suspected_rows_do_not_count_in_the_last_row() {
    let folder = session(SessionKind::POINT);
    let text = folder.read("measurements.csv");
    let knocked: Vec<String> = text
        .lines()
        .enumerate()
        .map(|(k, line)| {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            if k > 0 && k % 12 == 0 {
                cells[9] = (cells[9].parse::<f64>().unwrap() + 0.04).to_string();
            }
            cells.join(",")
        })
        .collect();
    folder.write("measurements.csv", knocked.join("\n") + "\n");
    let run = folder.run("calibrate robot.urdf measurements.csv --train-where stage=1");
    check(&run.out);
    let run = folder.run("calibrate robot.urdf measurements.csv --train-where stage=1 --force --verbose");
    let told = paragraph(&run.out, "held out");
    let after = |words: &str| -> f64 {
        let rest = told.split(words).nth(1).unwrap_or_else(|| panic!("{told}"));
        rest.split_whitespace().next().unwrap().parse().unwrap()
    };
    assert!(after("at most") > 39.0 && after("without 2 suspected:") < 0.5, "{}", run.out);
    assert!(paragraph(&run.out, "look at").contains("5 of 60 rows are outliers"), "{}", run.out);
}
