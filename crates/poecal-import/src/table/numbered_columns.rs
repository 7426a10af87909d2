//! Columns of joints without the joints' names: numbered ones, and the joints' names with a prefix or suffix.

use std::collections::{BTreeMap, BTreeSet};

use super::header::Header;
use super::mapping::ColumnMap;
use super::roles::{ColumnRole, plain_letters};
use poecal_model::robot::{ReadingKind, Robot};

/// Yaskawa's names of axes, in the order of the chain.
const YASKAWA: [&str; 2] = ["SLURBT", "SLEURBT"];
/// Smallest number of joints of a robot whose numbered columns may have any name: fewer are coordinates.
const FEWEST: usize = 4;

/// Joints with the columns that are taken for them, if no column has the name of a joint.
pub(crate) fn match_numbered_columns(
    header: &Header<'_>,
    robot: &Robot,
    map: &ColumnMap,
    names: &[String],
) -> Option<Vec<(String, String)>> {
    let joints: Vec<&String> = names.iter().filter(|name| robot.reading_kind(name) != ReadingKind::Factor).collect();
    if !map.joints.is_empty() || joints.iter().any(|name| header.count(name) > 0) {
        return None;
    }
    let columns = with_more(header, &joints)
        .or_else(|| by_numbers(header, joints.len()))
        .or_else(|| by_letters(header, joints.len()))?;
    Some(joints.into_iter().cloned().zip(columns).collect())
}

/// The columns with the names of all joints and one common prefix and suffix, if they are the only ones.
fn with_more(header: &Header<'_>, joints: &[&String]) -> Option<Vec<String>> {
    let cells: Vec<(String, &String)> =
        header.cells.iter().map(|cell| (plain_letters(&cell.name), &cell.name)).collect();
    let first = plain_letters(joints.first()?);
    // A single letter is in many names.
    if first.chars().count() < 2 {
        return None;
    }
    let around: BTreeSet<(&str, &str)> = cells.iter().filter_map(|(text, _)| text.split_once(first.as_str())).collect();
    let columns = |(before, behind): (&str, &str)| -> Option<Vec<String>> {
        let is_other = ColumnRole::Other.is_in(before) || ColumnRole::Other.is_in(behind);
        let of = |joint: &&String| {
            let wanted = format!("{before}{}{behind}", plain_letters(joint));
            let mut found = cells.iter().filter(|(text, _)| *text == wanted);
            let (_, name) = found.next()?;
            found.next().is_none().then(|| (*name).clone())
        };
        if is_other { None } else { joints.iter().map(of).collect() }
    };
    single_item(around.into_iter().filter_map(columns))
}

/// The columns with numbers from 0 or from 1 and one common prefix and suffix, if they are the only ones.
fn by_numbers(header: &Header<'_>, joints: usize) -> Option<Vec<String>> {
    let mut groups: BTreeMap<String, BTreeMap<usize, Option<&String>>> = BTreeMap::new();
    for cell in &header.cells {
        let Some((stem, number)) = split_number(&cell.name) else { continue };
        let own = groups.entry(stem).or_default().entry(number);
        own.and_modify(|it| *it = None).or_insert(Some(&cell.name));
    }
    let whole = |numbers: &BTreeMap<usize, Option<&String>>| -> Option<Vec<String>> {
        let first = *numbers.keys().next()?;
        let is_counted = first <= 1 && numbers.keys().copied().eq(first..first + joints);
        if is_counted { numbers.values().map(|name| name.cloned()).collect() } else { None }
    };
    let of = |is_it: &dyn Fn(&str) -> bool| {
        single_item(groups.iter().filter(|(stem, _)| is_it(stem)).filter_map(|(_, numbers)| whole(numbers)))
    };
    let is_reading = |stem: &str| {
        let rest = |word| stem.strip_prefix(word).or_else(|| stem.strip_suffix(word));
        ColumnRole::Reading.words().filter_map(rest).any(|rest| ColumnRole::Joint.has(rest))
    };
    // Columns with any name, one for each joint.
    let is_any = |stem: &str| {
        joints >= FEWEST && !stem.is_empty() && !ColumnRole::Other.is_in(stem) && !ColumnRole::InStatistic.is_in(stem)
    };
    of(&is_reading).or_else(|| of(&|stem| ColumnRole::Joint.has(stem))).or_else(|| of(&is_any))
}

/// The columns with Yaskawa's letters.
fn by_letters(header: &Header<'_>, joints: usize) -> Option<Vec<String>> {
    let letters = YASKAWA.into_iter().find(|it| it.len() == joints)?;
    let of =
        |letter: char| header.cells.iter().find(|cell| cell.name.eq_ignore_ascii_case(letter.encode_utf8(&mut [0; 4])));
    letters.chars().map(|it| of(it).map(|cell| cell.name.clone())).collect()
}

/// The letters of a name and its one number.
fn split_number(name: &str) -> Option<(String, usize)> {
    let mut numbers = name.split(|it: char| !it.is_ascii_digit()).filter(|it| !it.is_empty());
    let number = numbers.next()?;
    if numbers.next().is_some() {
        return None;
    }
    let letters: String = plain_letters(name).chars().filter(|it| !it.is_ascii_digit()).collect();
    Some((letters, number.parse().ok()?))
}

/// The item of an iterator that has exactly one.
fn single_item<T>(mut all: impl Iterator<Item = T>) -> Option<T> {
    let found = all.next()?;
    all.next().is_none().then_some(found)
}
