//! Joint readings of robot programs: RAPID, that of Rokae, KRL, FANUC's and URScript, in the order of their motions.

use super::made_table::{CellValue, FileLine, MadeTable, Refusal, TableColumn};
use super::words::{lines, number};
use super::{FileForm, OpeningContext};
use poecal_numerics::error::first_few;
use poecal_programs::{Language, joint_targets};

pub(crate) const FORM: FileForm = FileForm { title: "a robot program", is_it, table };

/// Number of lines in which a language is sought.
const FIRST: usize = 200;
/// Beginning of joint targets in Rokae's programs.
const ROKAE: &str = "= j:{";

fn is_it(text: &str, _: &OpeningContext<'_>) -> bool {
    language(text).is_some() || is_rokae(text)
}

fn is_rokae(text: &str) -> bool {
    lines(text).take(FIRST).any(|it| it.1.contains("jointtarget") && it.1.contains(ROKAE))
}

/// The language of a program by its words.
fn language(text: &str) -> Option<Language> {
    let first = lines(text).next()?.1.trim().to_ascii_uppercase();
    if first.starts_with("/PROG") {
        return Some(Language::Fanuc);
    }
    let begins = |line: &str, words: &[&str]| words.iter().any(|it| line.starts_with(it));
    // URScript has a colon behind the name of a function.
    if begins(&first, &["&ACCESS", "&REL", "&PARAM", "DEFDAT ", "DEF "]) && !first.ends_with(':') {
        return Some(Language::Krl);
    }
    lines(text).take(FIRST).find_map(|(_, line)| {
        let small = line.trim().to_ascii_lowercase();
        let is_target = small.contains("jointtarget") || small.contains("robtarget");
        if begins(&small, &["module "]) || begins(&small, &["const ", "var ", "pers ", "local "]) && is_target {
            return Some(Language::Rapid);
        }
        begins(&small, &["movej(", "movel(", "movep("]).then_some(Language::UrScript)
    })
}

fn table(text: &str, opening: &OpeningContext<'_>) -> Result<MadeTable, Refusal> {
    if is_rokae(text) {
        return of_rokae(text, opening);
    }
    let language = language(text).ok_or("found no program")?;
    let found = joint_targets(language, text.as_bytes(), opening.robot);
    let found = found.map_err(|error| Refusal::from_error(&error))?;
    let title = language.title();
    if let Some(line) = found.poses.first() {
        let (targets, are) = match found.poses.len() {
            1 => ("a target".to_owned(), "is a pose"),
            count => (format!("{count} targets"), "are poses"),
        };
        return FileLine(*line).refuse(format!(
            "found a program of {title} with {targets} that {are}, which say nothing of the joints, expected joint targets alone: write them from the \
             controller's joint readings"
        ));
    }
    if let Some(listed) = found.listed.first() {
        return FileLine(listed.line).refuse(format!(
            "found the target `{}` in a program of {title}, of which the joint readings are not known: {}",
            listed.name, listed.reason
        ));
    }
    // Targets that are numbers in a motion have no name.
    let is_named = language != Language::UrScript;
    let mut made = start_table(opening, is_named, found.targets.first().map_or(1, |it| it.0));
    for (line, name, readings) in &found.targets {
        let name = name.replace(['[', ']'], "");
        let name = name.split(':').next().unwrap_or_default();
        let id = is_named.then_some(CellValue::Text(name));
        made.row(*line, id.into_iter().chain(readings.iter().map(|it| CellValue::Number(*it))));
    }
    if made.rows() == 0 {
        return Refusal::refuse_whole(format!(
            "found a program of {title} without joint targets, expected at least one"
        ));
    }
    made.say(format!("{title}, {} joint targets in the order of its motions, or of its text", made.rows()));
    Ok(made)
}

/// The header: names of targets, and joints in the robot's order in radians and metres.
fn start_table(opening: &OpeningContext<'_>, is_named: bool, line: usize) -> MadeTable {
    let id = is_named.then(|| TableColumn::from("id"));
    MadeTable::new(line, id.into_iter().chain(opening.joint_columns("rad")))
}

/// Reads Rokae's dialect: `LOCAL VAR jointtarget j1 = j:{63.68,…,0}{EJ 0,…}`, degrees.
fn of_rokae(text: &str, opening: &OpeningContext<'_>) -> Result<MadeTable, Refusal> {
    let names = opening.robot.joint_reading_names();
    let mut made = start_table(opening, true, 1);
    for (line, content) in lines(text).filter(|it| it.1.contains("jointtarget")) {
        let (name, values) = rokae_target(content, &names).or_else(|message| FileLine(line).refuse(message))?;
        let readings = values.into_iter().zip(opening.slides());
        let si = readings.map(|(value, slides)| if slides { value * 1e-3 } else { value.to_radians() });
        made.row(line, std::iter::once(CellValue::Text(name)).chain(si.map(CellValue::Number)));
    }
    made.say(format!("joint targets of Rokae, {}, in degrees", made.rows()));
    Ok(made)
}

/// The name of a target, and its numbers, of which those behind the joints are zero.
fn rokae_target<'t>(line: &'t str, joints: &[String]) -> Result<(&'t str, Vec<f64>), String> {
    let parts = line
        .split_once(ROKAE)
        .and_then(|(before, rest)| Some((before.split_whitespace().last()?, rest.split_once('}')?.0)));
    let (name, inside) = parts.ok_or("found a jointtarget without `= j:{…}`, expected one, as in the lines before")?;
    let value = |text: &str| {
        let bad = || format!("found `{}` in a jointtarget, expected a number", text.trim());
        number(text).ok_or_else(bad)
    };
    let values: Vec<f64> = inside.split(',').map(value).collect::<Result<_, _>>()?;
    let (found, expected) = (values.len(), joints.len());
    if found < expected {
        let names = first_few(joints);
        return Err(format!("found {found} numbers of a jointtarget, expected {expected}: {names}"));
    }
    if values.iter().skip(expected).any(|it| *it != 0.0) {
        return Err(
            "found an axis that the model does not have and that is not at zero, expected the axes of the model"
                .to_owned(),
        );
    }
    Ok((name, values))
}
