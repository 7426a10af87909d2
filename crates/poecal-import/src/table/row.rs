//! Measurement of a target in a row.

use std::borrow::Cow;

use nalgebra::{Matrix3, Vector3};

use super::cursor::Cursor;
use super::kinds::{FunctionKind, KindColumns};
use super::mapping::PoseDirection;
use super::orientation::MOST_PARTS;
use super::targets::TargetLayout;
use crate::PlaneContact;
use crate::table::FileRow;
use poecal_arm::lie::Pose;
use poecal_model::measurement::{FormCriterion, Measurement, StatedDeviations};
use poecal_numerics::error::Result;

/// Expected cells of an incomplete position that belongs to a pose, or to a row with nothing else.
const EMPTY: &str = "a position: where none was measured, leave all of its cells empty";

/// Measurement of a target in the current row; `None` if an optional one is missing.
pub(crate) fn measurement(
    row: &FileRow<'_>,
    target: &TargetLayout,
    direction: PoseDirection,
    inputs: &Cursor<'_>,
    (may_be_missing, strict): (bool, bool),
) -> Result<Option<Measurement>> {
    let Some(columns) = target.position else { return Ok(None) };
    let may_be_missing = may_be_missing || target.kinds.iter().any(|kind| kind.is_measured(row, inputs, false));
    let position = match inputs.all(columns) {
        [Some(x), Some(y), Some(z)] => Vector3::new(x, y, z),
        [None, None, None] if may_be_missing => return Ok(None),
        parts => {
            let is_pose = orientation(row, target, inputs)?.is_some();
            let is_plain = !is_pose && direction == PoseDirection::DeviceFromTarget;
            if parts.iter().any(Option::is_some) && is_plain && !strict {
                return Ok(Some(Measurement::components(parts)));
            }
            let empty = parts.iter().position(Option::is_none).unwrap_or(0);
            let input = columns.get(empty).copied().unwrap_or(0);
            return Err(inputs.error(row, input, "found an empty cell", EMPTY));
        }
    };
    let measurement = match (orientation(row, target, inputs)?, direction) {
        (None, PoseDirection::DeviceFromTarget) => Measurement::point(position),
        (None, PoseDirection::TargetFromDevice) => {
            let message = "found a position without orientation, expected both, because the mapping says that \
                           poses are target_from_device";
            return Err(row.error(inputs.column(columns[0]), message));
        }
        (Some(rotation), PoseDirection::DeviceFromTarget) => Measurement::of_pose(&Pose::new(rotation, position)),
        (Some(rotation), PoseDirection::TargetFromDevice) => {
            Measurement::of_pose(&Pose::new(rotation, position).inverse())
        }
    };
    Ok(Some(measurement))
}

/// The measured rotation; `None` if all its cells are empty.
fn orientation(row: &FileRow<'_>, target: &TargetLayout, inputs: &Cursor<'_>) -> Result<Option<Matrix3<f64>>> {
    let Some((form, columns)) = &target.orientation else { return Ok(None) };
    let mut values = [0.0; MOST_PARTS];
    let mut empty = None;
    let mut given = false;
    for (slot, &input) in values.iter_mut().zip(columns) {
        match inputs.value(input) {
            Some(value) => {
                *slot = value;
                given = true;
            }
            None => empty = Some(input),
        }
    }
    match (given, empty) {
        (false, _) => Ok(None),
        (true, Some(input)) => {
            Err(inputs.error(row, input, "found an empty cell", "an orientation that is complete or absent"))
        }
        (true, None) => {
            let first = columns.first().map_or(0, |&input| inputs.column(input));
            form.rotation(&values).map(Some).map_err(|message| row.error(first, message))
        }
    }
}

/// Standard deviations of the components of a measured position, if the row states them, metres.
pub(crate) fn component_noise(
    row: &FileRow<'_>,
    target: &TargetLayout,
    inputs: &Cursor<'_>,
    seen: &Measurement,
) -> Result<Option<[Option<f64>; 3]>> {
    let measured = seen.position_components().map(|value| value.is_some());
    let mut found = [None; 3];
    for ((found, input), _) in found.iter_mut().zip(target.sigma_components).zip(measured).filter(|(_, is)| *is) {
        *found = inputs.sigma(row, input)?;
    }
    let is_whole = found.iter().zip(measured).all(|(sigma, is)| sigma.is_some() == is);
    if found == [None; 3] || is_whole {
        return Ok(Some(found).filter(|_| found != [None; 3]));
    }
    let column = target.sigma_components.iter().flatten().map(|&input| inputs.column(input)).next();
    let message = "found a standard deviation of some components, expected one of each that was measured, or of none";
    Err(row.error(column.unwrap_or(0), message))
}

impl KindColumns {
    /// Name of the anchor of a row; `None` if no cell names it.
    pub(crate) fn place_name<'r>(&self, row: &FileRow<'r>) -> Option<Cow<'r, str>> {
        let mut parts = self.places.iter().filter_map(|&at| row.cells.get(at)).map(|cell| cell.text());
        let first = parts.next()?;
        let joined = parts.fold(first, |all, part| match (all.is_empty(), part.is_empty()) {
            (true, _) => part,
            (false, true) => all,
            (false, false) => Cow::Owned(format!("{all}/{part}")),
        });
        Some(joined).filter(|name| !name.is_empty())
    }

    /// True if the row's word is that of the kind; without a word, the usual one applies.
    fn has_word(&self, row: &FileRow<'_>, usual: PlaneContact) -> Result<bool> {
        let Some((column, own)) = self.kind.columns.word else { return Ok(true) };
        let cell = self.word.and_then(|at| Some((at, row.cells.get(at)?.text())));
        let Some((at, text)) = cell.filter(|(_, text)| !text.is_empty()) else {
            return Ok(usual.word() == own);
        };
        if !FunctionKind::words(column).any(|word| word == text) {
            let words: Vec<String> = FunctionKind::words(column).map(|word| format!("`{word}`")).collect();
            let message = format!("found `{text}` in column `{column}`, expected {}", words.join(" or "));
            return Err(row.error(at, message));
        }
        Ok(text == own)
    }

    /// True if a row has a measurement of the kind; `has_position` is true if it has a position too.
    pub(crate) fn is_measured(&self, row: &FileRow<'_>, inputs: &Cursor<'_>, has_position: bool) -> bool {
        let has_number = || self.numbers.iter().any(|&input| inputs.value(input).is_some());
        match self.kind.columns.from {
            FormCriterion::Numbers { .. } => has_number(),
            FormCriterion::Name { .. } => {
                let is_named =
                    self.places.last().and_then(|&at| row.cells.get(at)).is_some_and(|it| !it.text().is_empty());
                is_named && (!has_position || has_number())
            }
        }
    }

    /// True if its numbers in a row are those of a beam break.
    pub(crate) fn is_lost(&self, inputs: &Cursor<'_>) -> bool {
        self.kind.columns.from == (FormCriterion::Numbers { above_zero: true })
            && self.numbers.iter().all(|&input| inputs.value(input) == Some(0.0))
    }

    /// The measurement of a row, with its stated noise; `None` if it has none.
    pub(crate) fn measurement(
        &self,
        row: &FileRow<'_>,
        inputs: &Cursor<'_>,
        (has_position, usual): (bool, PlaneContact),
    ) -> Result<Option<(Measurement, StatedDeviations)>> {
        let FunctionKind { function, columns } = self.kind;
        if !self.is_measured(row, inputs, has_position) || !self.has_word(row, usual)? {
            return Ok(None);
        }
        let mut numbers = vec![0.0; columns.numbers.len()];
        for (number, &input) in numbers.iter_mut().zip(&self.numbers) {
            let value = match (inputs.value(input), columns.from) {
                (Some(value), _) => value,
                (None, FormCriterion::Name { .. }) => 0.0,
                (None, FormCriterion::Numbers { .. }) => {
                    let expected = "all numbers of a measurement, or none";
                    return Err(inputs.error(row, input, "found an empty cell", expected));
                }
            };
            let is_size = columns.from == (FormCriterion::Name { size: true }) && inputs.value(input).is_some();
            if (is_size || columns.from == (FormCriterion::Numbers { above_zero: true })) && value <= 0.0 {
                let text = row.raw_text(inputs.column(input));
                let what =
                    if is_size { columns.numbers.first().copied() } else { Some(function.leading_quantity().name()) };
                let expected = format!("a {} above 0", what.unwrap_or("number"));
                return Err(inputs.error(row, input, &format!("found `{text}`"), &expected));
            }
            *number = value;
        }
        let mut stated = StatedDeviations::default();
        for &(quantity, input) in &self.sigmas {
            stated.set(quantity, inputs.sigma(row, Some(input))?);
        }
        Ok(Some(((columns.of)(&numbers), stated)))
    }
}
