//! Columns that number the joints.

use super::header::Header;
use super::mapping::ColumnMap;
use crate::robot::{ReadingKind, Robot};

/// Names of columns that number joints from base to tip.
const NUMBERED: [&str; 8] = ["q", "joint", "j", "a", "joint_", "J", "A", "Q"];

/// Joints with their numbered columns, if the file names no joint and has a column `q1` (or [`NUMBERED`]) and so on for each, and no more.
pub(super) fn numbered(
    header: &Header<'_>,
    robot: &Robot,
    map: &ColumnMap,
    names: &[String],
) -> Option<Vec<(String, String)>> {
    let joints: Vec<&String> =
        names.iter().filter(|name| robot.reading_kind(name) != ReadingKind::Factor).collect();
    if !map.joints.is_empty() || joints.iter().any(|name| header.count(name) > 0) {
        return None;
    }
    let has_all = |prefix: &&str| {
        let has = |number: usize| header.count(&format!("{prefix}{number}")) == 1;
        (1..=joints.len()).all(has) && !has(joints.len() + 1)
    };
    let prefix = NUMBERED.into_iter().find(|prefix| has_all(prefix))?;
    let column = |(index, name): (usize, &String)| (name.clone(), format!("{prefix}{}", index + 1));
    Some(joints.into_iter().enumerate().map(column).collect())
}
