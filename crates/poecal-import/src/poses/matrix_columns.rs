//! Matrices as sixteen columns of one name with numbers, such as `T0` to `T15`, or `O_T_EE[0]` to `O_T_EE[15]` of libfranka, which is column by
//! column.

use std::collections::BTreeMap;

use super::pose_owner::{PoseOwner, whose_of};
use crate::table::cells::{Separator, split};
use crate::table::header::Header;
use crate::table::number::number_of;

/// Numbers of a matrix.
const COUNT: usize = 16;

/// A column of a matrix: its index, its list if the name states it, and its part of the pose, by its name in conventions.
pub(crate) type MatrixColumn = (usize, Option<PoseOwner>, String);

/// The columns of all matrices in a header.
pub(crate) fn matrices(header: &Header<'_>) -> Vec<MatrixColumn> {
    let mut groups: BTreeMap<&str, BTreeMap<usize, usize>> = BTreeMap::new();
    for (at, cell) in header.cells.iter().enumerate() {
        let name = cell.name.trim_end_matches(']');
        let stem = name.trim_end_matches(|it: char| it.is_ascii_digit());
        if let Ok(number) = name.get(stem.len()..).unwrap_or_default().parse() {
            groups.entry(stem.trim_end_matches(['[', '_', '.', ' '])).or_default().insert(number, at);
        }
    }
    let mut found = Vec::new();
    for (stem, columns) in groups {
        let first = columns.keys().next().copied().unwrap_or_default();
        if first > 1 || !columns.keys().copied().eq(first..first + COUNT) {
            continue;
        }
        let columns: Vec<usize> = columns.into_values().collect();
        // The flange in the base, by its name in libfranka.
        let is_franka = stem.to_ascii_uppercase().starts_with("O_T_");
        let whose = if is_franka { Some(PoseOwner::Arm) } else { whose_of(stem) };
        let by_columns = is_franka || ends_with_place(header, &columns);
        found.extend(columns.iter().enumerate().map(|(place, at)| {
            let (row, column) = if by_columns { (place % 4, place / 4) } else { (place / 4, place % 4) };
            (*at, whose, format!("r{}{}", row + 1, column + 1))
        }));
    }
    found
}

/// True if the first row has a position in the last four of its numbers, and not the last row of a matrix.
fn ends_with_place(header: &Header<'_>, columns: &[usize]) -> bool {
    let Some(line) = header.first_row() else { return false };
    let mut cells = Vec::new();
    if split(&line, Separator::recognise(&line), &mut cells).is_err() {
        return false;
    }
    let number = |place: usize| columns.get(place).and_then(|at| number_of(cells.get(*at)?.raw));
    [12, 13, 14].into_iter().any(|place| number(place).is_some_and(|it| it != 0.0))
        && [3, 7, 11].into_iter().all(|place| number(place) == Some(0.0))
}
