//! Beam breaks: measurements without a position.

use std::path::Path;

use nalgebra::Matrix3;

use super::cursor::Cursor;
use super::orientation::MOST_PARTS;
use super::targets::TargetLayout;
use crate::table::FileRow;
use poecal_model::measurement::Observation;
use poecal_numerics::error::{Error, Result};
use poecal_numerics::text::NamedLines;

/// State of a target in a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Beam {
    /// It was measured.
    Seen,
    /// All cells are empty.
    Empty,
    /// The position is zero, and the orientation zero, the identity or empty.
    Zero,
}

/// Removes beam breaks from a row's numbers: measurements whose position is empty or exactly zero in all coordinates, since the device did not see
/// the target. True if the row then has no measurement.
///
/// # Errors
/// [`poecal_numerics::error::ErrorKind::Measurement`] at a beam break if it is refused (`strict`).
pub(crate) fn take_out(
    lost: &mut NamedLines,
    row: &FileRow<'_>,
    inputs: &mut Cursor<'_>,
    strict: bool,
) -> Result<bool> {
    let before = lost.count;
    let mut seen = false;
    let mut forgotten = Vec::new();
    for target in &inputs.layout.targets {
        match beam(row, target, inputs) {
            Beam::Seen => seen = true,
            // In rows with several targets, some may not have been measured.
            Beam::Empty => {}
            Beam::Zero if strict => return Err(beam_break_error(row, target, inputs, zero_words(target))),
            Beam::Zero => {
                lost.add(row.line);
                forgotten.extend(target.position.into_iter().flatten());
                forgotten.extend(target.kinds.iter().flat_map(|kind| &kind.numbers));
                forgotten.extend(target.orientation.iter().flat_map(|(_, parts)| parts));
            }
        }
    }
    if !seen && lost.count == before {
        if let (true, Some(target)) = (strict, inputs.layout.targets.first()) {
            return Err(beam_break_error(row, target, inputs, "an empty position"));
        }
        lost.add(row.line);
    }
    inputs.forget(&forgotten);
    Ok(!seen)
}

/// Omitted beam breaks of a file in words; `None` if there are none.
#[must_use]
pub fn lost_words(lost: &NamedLines) -> Option<String> {
    let what = match lost.count {
        0 => return None,
        1 => "1 measurement".to_owned(),
        count => format!("{count} measurements"),
    };
    Some(format!("{what} with an empty or zero position, as of a lost beam ({})", lost.words()))
}

/// True if the row has a position of a target.
pub(crate) fn has_position(target: &TargetLayout, inputs: &Cursor<'_>) -> bool {
    target.position.iter().flatten().any(|&input| inputs.value(input).is_some())
}

/// State of a target in the current row.
fn beam(row: &FileRow<'_>, target: &TargetLayout, inputs: &Cursor<'_>) -> Beam {
    let has_position = has_position(target, inputs);
    let mut measured = target.kinds.iter().filter(|kind| kind.is_measured(row, inputs, has_position));
    if let Some(first) = measured.next() {
        return if first.is_lost(inputs) && target.position.is_none() { Beam::Zero } else { Beam::Seen };
    }
    let position = target.position.map_or([None; 3], |position| inputs.all(position));
    let orientation = || target.orientation.iter().flat_map(|(_, parts)| parts).map(|&part| inputs.value(part));
    if position == [None; 3] {
        return if orientation().all(|part| part.is_none()) { Beam::Empty } else { Beam::Seen };
    }
    if position != [Some(0.0); 3] {
        return Beam::Seen;
    }
    let is_none = orientation().all(|part| part.is_none_or(|part| part == 0.0));
    let is_identity = || {
        let mut values = [0.0; MOST_PARTS];
        for (value, part) in values.iter_mut().zip(orientation()) {
            *value = part.unwrap_or(f64::NAN);
        }
        let form = target.orientation.as_ref().map(|(form, _)| form);
        form.and_then(|form| form.rotation(&values).ok()) == Some(Matrix3::identity())
    };
    if is_none || is_identity() { Beam::Zero } else { Beam::Seen }
}

/// The cells of a target at zero, in words.
fn zero_words(target: &TargetLayout) -> &'static str {
    if target.position.is_some() { "the position 0, 0, 0" } else { "0" }
}

fn beam_break_error(row: &FileRow<'_>, target: &TargetLayout, inputs: &Cursor<'_>, found: &str) -> Error {
    let first = target.position.iter().flatten().chain(target.kinds.iter().flat_map(|kind| &kind.numbers)).next();
    let first = first.copied().unwrap_or(0);
    let message = format!("found {found}, as of a lost beam, expected what was measured; leave out the row");
    row.error(inputs.column(first), message)
}

/// The warning of rows with some components of a position beside rows with all.
pub(crate) fn incomplete_warning(path: &Path, rows: &[Observation]) -> Option<String> {
    let is_part = |row: &&Observation| row.measurement.is_part_of_position();
    let lines: NamedLines = rows.iter().filter(is_part).map(|row| row.source.line as usize).collect();
    let has_whole = rows.iter().any(|row| row.measurement.is_place() && !row.measurement.sees_orientation());
    (has_whole && lines.count > 0).then(|| {
        format!(
            "{}: took {} ({}) as positions of which only some components were measured; --strict refuses empty cells",
            path.display(),
            count_rows(lines.count),
            lines.words()
        )
    })
}

fn count_rows(rows: usize) -> String {
    if rows == 1 { "one row".to_owned() } else { format!("{rows} rows") }
}
