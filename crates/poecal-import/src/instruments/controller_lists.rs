//! Joint readings as controllers and ROS list them: FANUC's position registers (posreg.va), Stäubli's data of a program (.dtx), telegrams of KUKA's
//! sensor interface (RSI), and `ros2 topic echo --csv` of joint states.

use super::maker::{At, Column, Made, Refused, Value};
use super::words::{cells, lines, number, quoted};
use super::{Form, Opening};
use crate::Separator;

pub(crate) const FANUC: Form =
    Form { title: "position registers of FANUC", is_it: is_fanuc, table: of_fanuc };
pub(crate) const STAUBLI: Form =
    Form { title: "joint data of Stäubli (VAL3)", is_it: is_staubli, table: of_staubli };
pub(crate) const KUKA: Form =
    Form { title: "telegrams of KUKA's sensor interface (RSI)", is_it: is_kuka, table: of_kuka };
pub(crate) const ECHO: Form =
    Form { title: "joint states of `ros2 topic echo --csv`", is_it: is_echo, table: of_echo };

/// Lines in which a form is sought.
const FIRST: usize = 60;

/// A listed configuration: its line, its name, its readings in the units of the controller.
struct Listed<'t> {
    line: usize,
    name: String,
    readings: Vec<&'t str>,
}

/// The table of configurations in degrees and millimetres.
fn made(listed: &[Listed<'_>], opening: &Opening<'_>) -> Result<Made, Refused> {
    let columns = std::iter::once(Column::from("id")).chain(opening.joint_columns("deg"));
    let mut made = Made::new(listed.first().map_or(1, |it| it.line), columns);
    let expected = opening.robot.joint_reading_names().len();
    for Listed { line, name, readings } in listed {
        let (found, beyond) = readings.split_at(expected.min(readings.len()));
        if found.len() < expected || beyond.iter().any(|it| number(it) != Some(0.0)) {
            let count = readings.len();
            return At(*line).refuse(format!(
                "found {count} axes of `{name}`, expected {expected} as the model has joints"
            ));
        }
        made.row(*line, std::iter::once(Value::Text(name)).chain(found.iter().map(|it| Value::Text(it))));
    }
    if made.rows() == 0 {
        return Refused::whole(
            "found no joint readings, expected at least one configuration as angles of the joints",
        );
    }
    made.say(format!("{} configurations in deg", made.rows()));
    Ok(made)
}

fn is_fanuc(text: &str, _: &Opening<'_>) -> bool {
    lines(text).next().is_some_and(|it| it.1.contains("$POSREG"))
}

/// `[1,4] = 'name'`, then `J1 = 10.000 deg …`; other registers are poses, of other groups, or not initialized.
fn of_fanuc(text: &str, opening: &Opening<'_>) -> Result<Made, Refused> {
    let mut listed: Vec<Listed<'_>> = Vec::new();
    let mut poses = 0;
    let mut is_first_group = false;
    for (line, content) in lines(text) {
        let trimmed = content.trim();
        if let Some((place, rest)) = trimmed.strip_prefix('[').and_then(|it| it.split_once(']'))
            && let Some((group, at)) = place.split_once(',')
        {
            is_first_group = group.trim() == "1";
            let own = rest.split('\'').nth(1).unwrap_or_default();
            let name = if own.is_empty() { format!("PR{at}") } else { own.to_owned() };
            if is_first_group {
                listed.push(Listed { line, name, readings: Vec::new() });
            }
        }
        let Some(last) = listed.last_mut().filter(|_| is_first_group) else { continue };
        poses += usize::from(trimmed.starts_with("X:"));
        let mut words = trimmed.split([' ', '=', ':']).filter(|it| !it.is_empty());
        while let Some(word) = words.next() {
            let is_axis = |before: &str| word.strip_prefix(before).is_some_and(|it| it.parse::<u8>().is_ok());
            if (is_axis("J") || is_axis("EXT")) && !trimmed.starts_with('[') {
                last.readings.extend(words.next());
            }
        }
    }
    // A pose has no angle of a joint, but may have external axes.
    let (with, without): (Vec<_>, Vec<_>) =
        listed.into_iter().partition(|it| it.readings.len() >= opening.robot.joint_reading_names().len());
    let mut made = made(&with, opening)?;
    if !without.is_empty() {
        made.say(format!("left out {} registers that are poses ({poses}) or not initialized", without.len()));
    }
    Ok(made)
}

/// The values of attributes with this letter and a number of an element's text, in their order.
fn numbered(element: &str, letter: char) -> impl Iterator<Item = (usize, &str)> {
    element.split_whitespace().filter_map(move |it| {
        let (name, value) = it.split_once('=')?;
        let number = name.strip_prefix(letter)?.parse().ok()?;
        Some((number, value.trim_matches(|it: char| matches!(it, '"' | '\'' | '/' | '>'))))
    })
}

fn is_staubli(text: &str, _: &Opening<'_>) -> bool {
    text.contains("staubli.com")
        && lines(text).take(FIRST).any(|it| it.1.contains("<Database"))
        && text.contains("type=\"joint")
}

/// `<Data name="…" type="jointRx"> <Value key="0" j1="…" …/>`; angles that are zero are left out of newer files.
fn of_staubli(text: &str, opening: &Opening<'_>) -> Result<Made, Refused> {
    let count = opening.robot.joint_reading_names().len();
    let mut arrays: Vec<(&str, Vec<Listed<'_>>)> = Vec::new();
    let mut is_joints = false;
    for (line, content) in lines(text) {
        for element in content.split('<') {
            let attribute = |name: &str| element.split_once(&format!(" {name}=\""))?.1.split('"').next();
            if element.starts_with("Data ") {
                is_joints = attribute("type").is_some_and(|it| it.starts_with("joint"))
                    || element.contains(" type=\"joint");
                if is_joints {
                    arrays.push((attribute("name").unwrap_or_default(), Vec::new()));
                }
            } else if element.starts_with("Value ")
                && is_joints
                && let Some((name, listed)) = arrays.last_mut()
            {
                let mut readings = vec!["0"; count];
                for (at, value) in numbered(element, 'j') {
                    match readings.get_mut(at.wrapping_sub(1)) {
                        Some(own) => *own = value,
                        None => readings.push(value),
                    }
                }
                listed.push(Listed {
                    line,
                    name: format!("{name}[{}]", attribute("key").unwrap_or_default()),
                    readings,
                });
            }
        }
    }
    let longest = arrays.iter().map(|it| it.1.len()).max().unwrap_or_default();
    let at = arrays.iter().position(|it| it.1.len() == longest).unwrap_or_default();
    let mut made = made(arrays.get(at).map_or(&[], |it| it.1.as_slice()), opening)?;
    made.say(format!("of the array `{}`", arrays.get(at).map_or("", |it| it.0)));
    let left = quoted(arrays.iter().enumerate().filter(|it| it.0 != at).map(|it| it.1.0));
    if !left.is_empty() {
        made.say(format!("left out {left}"));
    }
    Ok(made)
}

fn is_kuka(text: &str, _: &Opening<'_>) -> bool {
    lines(text).take(FIRST).any(|it| it.1.contains("<AIPos ")) && text.contains("<Rob ")
}

/// `<AIPos A1="…" …/>`, `<EIPos E1="…" …/>` of external axes, and `<IPOC>` with the controller's time in milliseconds.
fn of_kuka(text: &str, opening: &Opening<'_>) -> Result<Made, Refused> {
    let names = opening.robot.joint_reading_names();
    let columns = std::iter::once(Column::from("time").in_unit("ms")).chain(opening.joint_columns("deg"));
    let mut made = Made::new(1, columns);
    let mut readings: Vec<&str> = Vec::new();
    for (line, content) in lines(text) {
        for element in content.split('<') {
            match element.split([' ', '>']).next() {
                Some("AIPos") => readings = numbered(element, 'A').map(|it| it.1).collect(),
                Some("EIPos") => readings.extend(numbered(element, 'E').map(|it| it.1)),
                Some("IPOC") => {
                    let found = readings.len();
                    let beyond = readings.split_off(names.len().min(found));
                    // External axes that the model does not have stand at zero.
                    if found < names.len() || beyond.iter().any(|it| number(it) != Some(0.0)) {
                        return At(line).refuse(format!(
                            "found a telegram with {found} axes, expected {} as the model has joints",
                            names.len()
                        ));
                    }
                    let time = element.split_once('>').map_or("", |it| it.1.trim());
                    made.row(line, std::iter::once(time).chain(readings.drain(..)).map(Value::Text));
                }
                _ => {}
            }
        }
    }
    if made.rows() == 0 {
        return Refused::whole("found no telegram with AIPos and IPOC, expected both of each");
    }
    made.say(format!("{} telegrams, axes (AIPos) in deg, times (IPOC) in ms", made.rows()));
    Ok(made)
}

/// Names of a line of joint states, behind seconds, nanoseconds and the name of a frame.
fn echo_names<'t>(cells: &[&'t str]) -> Option<Vec<&'t str>> {
    let is_whole = |at: usize| {
        cells.get(at).is_some_and(|it| !it.is_empty() && it.bytes().all(|it| it.is_ascii_digit()))
    };
    let names: Vec<&str> =
        cells.iter().skip(3).take_while(|it| number(it).is_none() && !it.is_empty()).copied().collect();
    (is_whole(0) && is_whole(1) && !names.is_empty() && cells.len() >= 3 + 2 * names.len()).then_some(names)
}

fn is_echo(text: &str, opening: &Opening<'_>) -> bool {
    let Some(line) = lines(text).next() else { return false };
    let names = echo_names(&cells(line.1, Separator::Comma));
    names.is_some_and(|names| {
        opening.robot.joint_reading_names().iter().any(|it| names.contains(&it.as_str()))
    })
}

fn of_echo(text: &str, opening: &Opening<'_>) -> Result<Made, Refused> {
    let joints = opening.robot.joint_reading_names();
    let columns = std::iter::once(Column::from("time").in_unit("s"));
    let mut made = Made::new(1, columns.chain(opening.joint_columns("rad")));
    for (line, content) in lines(text) {
        let cells = cells(content, Separator::Comma);
        let Some(names) = echo_names(&cells) else {
            return At(line).refuse("found a line that is no joint state, expected seconds, nanoseconds, a frame, names of joints and their positions");
        };
        let value = |at: usize| cells.get(at).copied().and_then(number);
        let time = value(0).zip(value(1)).map_or(Value::Empty, |(s, ns)| Value::Number(s + 1e-9 * ns));
        let mut row = vec![time];
        for joint in &joints {
            let Some(at) = names.iter().position(|it| it == joint) else {
                return At(line)
                    .refuse(format!("found no joint `{joint}` among {}, expected it", quoted(&names)));
            };
            row.push(Value::at(&cells, 3 + names.len() + at));
        }
        made.row(line, row);
    }
    made.say(format!("{} joint states by the names in each line, in rad and m", made.rows()));
    Ok(made)
}
