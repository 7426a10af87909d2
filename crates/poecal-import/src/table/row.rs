//! Measurement of a target in a row.

use nalgebra::{Matrix3, Vector3};

use super::cursor::Cursor;
use super::mapping::PoseDirection;
use super::orientation::MOST_PARTS;
use super::targets::TargetLayout;
use crate::table::Row;
use poecal_arm::lie::Pose;
use poecal_model::measurement::Measurement;
use poecal_numerics::error::Result;

/// Expected cells of an incomplete position that is one of a pose, or of a row with nothing else.
const EMPTY: &str = "a position: where none was measured, leave all of its cells empty";

/// Measurement of a target in the current row; `None` if an optional one is missing.
pub(crate) fn measurement(
    row: &Row<'_>,
    target: &TargetLayout,
    direction: PoseDirection,
    inputs: &Cursor<'_>,
    (may_be_missing, strict): (bool, bool),
) -> Result<Option<Measurement>> {
    let Some(columns) = target.position else { return Ok(None) };
    let may_be_missing =
        may_be_missing || target.kinds.iter().any(|kind| kind.is_measured(row, inputs, false));
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
        (Some(rotation), PoseDirection::DeviceFromTarget) => {
            Measurement::of_pose(&Pose::new(rotation, position))
        }
        (Some(rotation), PoseDirection::TargetFromDevice) => {
            Measurement::of_pose(&Pose::new(rotation, position).inverse())
        }
    };
    Ok(Some(measurement))
}

/// The measured rotation; `None` if all its cells are empty.
fn orientation(row: &Row<'_>, target: &TargetLayout, inputs: &Cursor<'_>) -> Result<Option<Matrix3<f64>>> {
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
    row: &Row<'_>,
    target: &TargetLayout,
    inputs: &Cursor<'_>,
    seen: &Measurement,
) -> Result<Option<[Option<f64>; 3]>> {
    let measured = seen.position_components().map(|value| value.is_some());
    let mut found = [None; 3];
    for ((found, input), _) in
        found.iter_mut().zip(target.sigma_components).zip(measured).filter(|(_, is)| *is)
    {
        *found = inputs.sigma(row, input)?;
    }
    let is_whole = found.iter().zip(measured).all(|(sigma, is)| sigma.is_some() == is);
    if found == [None; 3] || is_whole {
        return Ok(Some(found).filter(|_| found != [None; 3]));
    }
    let column = target.sigma_components.iter().flatten().map(|&input| inputs.column(input)).next();
    let message =
        "found a standard deviation of some components, expected one of each that was measured, or of none";
    Err(row.error(column.unwrap_or(0), message))
}
