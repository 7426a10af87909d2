//! Properties that several targets share.

use std::path::Path;

use poecal_formats::proof::Difference;
use poecal_model::robot::Robot;
use poecal_numerics::error::{Error, Result};

use crate::{BETWEEN, LONGEST};

/// The name under which texts are read.
pub(crate) const PATH: &str = "input";

/// The input as text; `None` if it is too long.
pub(crate) fn text(data: &[u8]) -> Option<String> {
    (data.len() <= LONGEST).then(|| String::from_utf8_lossy(data).into_owned())
}

/// The texts of an input that has several; missing ones are empty.
pub(crate) fn parts<const N: usize>(data: &[u8]) -> Option<[String; N]> {
    let text = text(data)?;
    let between = format!("\n{BETWEEN}\n");
    let mut parts = text.splitn(N, &between).map(str::to_owned);
    Some(std::array::from_fn(|_| parts.next().unwrap_or_default()))
}

/// The value, if there is one; an error must read as one sentence, and its position must be in the text.
pub(crate) fn check_result<T>(result: Result<T>, text: &str) -> Option<T> {
    result.map_err(|error| check_error(&error, text)).ok()
}

/// The value of a result that must not fail.
pub(crate) fn certain<T>(result: Result<T>, what: &str) -> T {
    result.unwrap_or_else(|error| panic!("{what}: {error}"))
}

fn check_error(error: &Error, text: &str) {
    one_line(&error.to_string());
    assert!(!error.message().trim().is_empty(), "an error without words");
    let Some(place) = error.place() else { return };
    assert_eq!(place.path.with_extension(""), Path::new(PATH), "{error}");
    let Some(line) = place.line else { return };
    // Tables may have the line ends of an old Mac, other texts not; YAML, and JSON that is read as YAML, ends lines by either.
    let is_place = |ends: char| {
        let found = line.checked_sub(1).and_then(|line| text.split(ends).nth(line));
        // A missing part is reported one beyond the last character.
        let columns = found.map(|found| found.chars().count() + 1);
        columns.is_some_and(|most| (1..=most).contains(&place.column.unwrap_or(1)))
    };
    let is_of_either = || {
        let lines = text.replace("\r\n", "\n").replace('\r', "\n");
        let found = line.checked_sub(1).and_then(|line| lines.split('\n').nth(line));
        found.is_some_and(|found| (1..=found.chars().count() + 1).contains(&place.column.unwrap_or(1)))
    };
    let is_yaml = place.path.extension().is_some_and(|it| it == "yaml" || it == "json");
    let has_place = is_place('\n') || (!text.contains('\n') && is_place('\r')) || (is_yaml && is_of_either());
    assert!(has_place, "{error}: no place of {text:?}");
}

/// Asserts that a sentence moves no cursor and ends no line.
pub(crate) fn one_line(sentence: &str) {
    let ends = |c: char| c.is_control() || matches!(c, '\u{2028}' | '\u{2029}');
    assert!(!sentence.contains(ends), "more than a line: {sentence:?}");
}

/// Numbers beyond this are not written and read again by the properties: readers refuse sums of such numbers.
pub(crate) const VAST_M: f64 = 1e5;

/// A length that bounds all of the robot, metres: rounding is proportional to it.
pub(crate) fn size_m(robot: &Robot) -> f64 {
    let mut size = robot.reach_m().max(1.0) + robot.home.translation.norm();
    for joint in &robot.joints {
        let reading = &joint.reading;
        let limits = joint.limits.map_or(10.0, |limits| limits.lower.abs().max(limits.upper.abs()));
        size += joint.frame.translation.norm() + joint.screw.v().norm();
        // For large angles, sine and cosine are as coarse as their digits; a slide's reading is a length.
        size += (limits * reading.multiplier.abs() + reading.offset.abs()).max(limits);
    }
    size
}

/// Asserts that the robots move alike, except for rounding.
pub(crate) fn assert_alike(robot: &Robot, again: &Robot, tolerance: f64, what: &str) {
    let names = |robot: &Robot| {
        let joints = robot.joints.iter();
        joints.map(|joint| (joint.name.clone(), joint.kind, joint.reading.name.clone())).collect::<Vec<_>>()
    };
    assert_eq!(names(robot), names(again), "{what}: joints");
    let size = size_m(robot);
    let found = Difference::from_robots(robot, again, 20);
    assert!(found.is_within(tolerance * size * size, tolerance * size), "{what}: {found:?} of a robot of {size} m");
}
