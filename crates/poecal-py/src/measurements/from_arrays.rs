//! Measurements from arrays.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use poecal_arm::lie::Pose;
use poecal_fit::input_doubts::joint_units::LARGEST_OTHERWISE;
use poecal_fit::input_doubts::{SHARE, lengths};
use poecal_import::LARGEST_NUMBER;
use poecal_model::measurement::{ByQuantity, Dataset, Measurement, Observation, Quantity, Set};
use poecal_model::robot::{JointKind, Robot};
use poecal_numerics::error::Error;
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;
use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::arguments::Argument as _;
use crate::arrays::{NumberArray, pose_of};
use crate::errors::{argument, raise, raise_at_row};
use crate::words::{choose_word, from_mm};

/// Largest deviation of a quaternion's norm from 1, as in files.
const QUATERNION_TOLERANCE: f64 = 1e-2;

/// Arguments of `Measurements.from_arrays`.
pub(crate) struct ArrayColumns<'a, 'py> {
    pub(crate) joints: &'a Bound<'py, PyAny>,
    pub(crate) positions: Option<&'a Bound<'py, PyAny>>,
    pub(crate) quaternions_xyzw: Option<&'a Bound<'py, PyAny>>,
    pub(crate) poses: Option<&'a Bound<'py, PyAny>>,
    pub(crate) targets: Option<Vec<String>>,
    pub(crate) instruments: Option<Vec<String>>,
    pub(crate) sets: Option<Vec<Option<String>>>,
    pub(crate) ids: Option<Vec<String>>,
    pub(crate) sigma_position_mm: Option<&'a Bound<'py, PyAny>>,
    pub(crate) sigma_rotation_deg: Option<&'a Bound<'py, PyAny>>,
    pub(crate) angle_unit: &'a str,
    pub(crate) length_unit: &'a str,
}

/// The rows.
pub(crate) fn dataset(robot: &Robot, columns: &ArrayColumns<'_, '_>) -> PyResult<Dataset> {
    let length =
        NamedUnit::parse(columns.length_unit, Unit::Metre).map_err(|error| argument_error("length_unit", error))?;
    let readings = readings(robot, columns, length)?;
    let names = robot.reading_names();
    let m = readings.len() / names.len().max(1);
    let seen = make_measurements(columns, m, length)?;
    if columns.length_unit == "m" {
        refuse_millimetres(robot, &seen)?;
    }
    for (name, found) in [
        ("targets", columns.targets.as_ref().map(Vec::len)),
        ("instruments", columns.instruments.as_ref().map(Vec::len)),
        ("sets", columns.sets.as_ref().map(Vec::len)),
        ("ids", columns.ids.as_ref().map(Vec::len)),
    ] {
        if let Some(found) = found.filter(|found| *found != m) {
            return Err(argument(name, format!("found {found} entries, expected {m}, one for each row of joints")));
        }
    }
    let sets = sets(columns)?;
    let sigma_position_m = sigma("sigma_position_mm", columns.sigma_position_mm, m, from_mm)?;
    let sigma_rotation_rad = sigma("sigma_rotation_deg", columns.sigma_rotation_deg, m, f64::to_radians)?;
    let at = |values: &[Option<f64>], row: usize| values.get(row).copied().flatten();
    let width = names.len();
    let mut data = Dataset::new(names);
    // Found once per target: there may be very many.
    let mut known: BTreeMap<Option<&str>, usize> = BTreeMap::new();
    let mut places: BTreeMap<&str, usize> = BTreeMap::new();
    for (row, (readings, measurement)) in readings.chunks_exact(width.max(1)).zip(seen).enumerate() {
        let target = columns.targets.as_ref().and_then(|targets| targets.get(row)).map(String::as_str);
        let mut stated = ByQuantity::default();
        stated[Quantity::Position] = at(&sigma_position_m, row);
        stated[Quantity::Rotation] = at(&sigma_rotation_rad, row);
        let target = *known.entry(target).or_insert_with(|| data.target_index(target));
        let observation = Observation {
            station: match columns.instruments.as_ref().and_then(|names| names.get(row)) {
                Some(name) => *places.entry(name).or_insert_with(|| data.station_index(Some(name))),
                None => 0,
            },
            stated: stated.into(),
            set: sets.get(row).copied().flatten(),
            ..Observation::new(target, measurement)
        };
        data.push_observation(readings, observation).map_err(|error| raise_at_row(error, Some(row)))?;
    }
    if data.is_empty() {
        return Err(argument("joints", "found no row, expected at least one measurement"));
    }
    data.ids = columns.ids.clone().unwrap_or_default();
    Ok(data)
}

fn argument_error(argument: &str, error: Error) -> PyErr {
    raise(Error::new(error.kind(), format!("{argument}: {}", error.message())))
}

/// Readings of all rows in SI.
fn readings(robot: &Robot, columns: &ArrayColumns<'_, '_>, length: NamedUnit) -> PyResult<Vec<f64>> {
    let angle =
        NamedUnit::parse(columns.angle_unit, Unit::Radian).map_err(|error| argument_error("angle_unit", error))?;
    let names = robot.reading_names();
    let n = names.len();
    let expected = format!("shape (m, {n}): in each row {}", names.join(", "));
    let joints = NumberArray::finite_of(columns.joints, "joints", &[None, Some(n)], &expected)?;
    let slides = |name: &String| {
        robot.joints.iter().any(|joint| joint.reading.name == *name && joint.kind == JointKind::Prismatic)
    };
    let units: Vec<NamedUnit> = names.iter().map(|name| if slides(name) { length } else { angle }).collect();
    let readings: Vec<f64> =
        joints.values.iter().zip(units.iter().cycle()).map(|(&value, unit)| unit.to_si(value)).collect();
    for (row, values) in readings.chunks_exact(n.max(1)).enumerate() {
        check_size("joints", row, values)?;
    }
    if columns.angle_unit == "rad" {
        refuse_degrees(robot, &readings)?;
    }
    Ok(readings)
}

/// Refuses angles that no joint has in radians.
fn refuse_degrees(robot: &Robot, readings: &[f64]) -> PyResult<()> {
    let names = robot.reading_names();
    let rows = readings.len() / names.len().max(1);
    for (at, name) in names.iter().enumerate() {
        let own: Vec<&poecal_model::robot::Joint> =
            robot.joints.iter().filter(|joint| joint.reading.name == *name).collect();
        let turns = own.iter().all(|joint| joint.kind == JointKind::Revolute);
        let limit = own.iter().filter_map(|joint| joint.limits).map(|it| it.lower.abs().max(it.upper.abs()));
        let largest = limit.fold(LARGEST_OTHERWISE, f64::max);
        let values = || readings.chunks_exact(names.len()).filter_map(|row| row.get(at).copied());
        let beyond = values().filter(|value| value.abs() > largest).count();
        let degrees_fit = values().all(|value| value.to_radians().abs() <= largest);
        if turns && degrees_fit && beyond as f64 > SHARE * rows as f64 {
            let extreme = values().fold(0.0, |most: f64, value| most.max(value.abs()));
            let message = format!(
                "found {extreme} rad of {name}, expected radians: if they are degrees, write angle_unit=\"deg\""
            );
            return Err(argument("joints", message));
        }
    }
    Ok(())
}

/// Refuses positions that no arm of this reach has in metres.
fn refuse_millimetres(robot: &Robot, seen: &[Measurement]) -> PyResult<()> {
    let reach_m = robot.reach_m();
    let places: Vec<Vector3<f64>> = seen.iter().filter_map(Measurement::position).collect();
    let mut spread_m: f64 = 0.0;
    for k in 0..3 {
        let mut own: Vec<f64> = places.iter().map(|place| place[k]).collect();
        own.sort_by(f64::total_cmp);
        // A few wrong rows are not evidence of a wrong unit.
        let cut = own.len() / 10;
        if let (Some(low), Some(high)) = (own.get(cut), own.get((own.len() - cut).saturating_sub(1))) {
            spread_m = spread_m.max(high - low);
        }
    }
    if reach_m > 0.0 && spread_m > lengths::REACHES * reach_m {
        let message = format!(
            "found positions that spread over {spread_m:.1} m of a robot that reaches {reach_m:.2} m, expected metres: if they are millimetres, write \
             length_unit=\"mm\""
        );
        return Err(argument("positions", message));
    }
    Ok(())
}

/// Refuses numbers beyond any measurement, whose squares would overflow, as in files.
fn check_size(name: &str, row: usize, si: &[f64]) -> PyResult<()> {
    let Some(value) = si.iter().find(|value| value.abs() > LARGEST_NUMBER) else { return Ok(()) };
    let message = format!(
        "row {row}: found {value:e} (metres or radians), expected at most {LARGEST_NUMBER:e}: correct the number or the unit"
    );
    Err(argument(name, message))
}

/// Measurements in SI.
fn make_measurements(columns: &ArrayColumns<'_, '_>, m: usize, length: NamedUnit) -> PyResult<Vec<Measurement>> {
    match (columns.positions, columns.poses) {
        (Some(positions), None) => points(positions, columns.quaternions_xyzw, m, length),
        (None, Some(poses)) if columns.quaternions_xyzw.is_none() => frames(poses, m, length),
        (None, Some(_)) => Err(argument(
            "quaternions_xyzw",
            "found both poses and quaternions_xyzw, expected quaternions beside positions only",
        )),
        (Some(_), Some(_)) => Err(argument("poses", "found both positions and poses, expected one of the two")),
        (None, None) => Err(argument("positions", "found neither positions nor poses, expected one of the two")),
    }
}

fn frames(poses: &Bound<'_, PyAny>, m: usize, length: NamedUnit) -> PyResult<Vec<Measurement>> {
    let expected = format!("shape ({m}, 4, 4): a pose for each row of joints");
    let poses = NumberArray::finite_of(poses, "poses", &[Some(m), Some(4), Some(4)], &expected)?;
    let rows = poses.values.chunks_exact(16).enumerate();
    rows.map(|(row, numbers)| {
        let pose = pose_of(numbers).map_err(|message| argument("poses", format!("row {row}: {message}")))?;
        let pose = Pose::new(pose.rotation, pose.translation.map(|value| length.to_si(value)));
        check_size("poses", row, pose.translation.as_slice())?;
        Ok(Measurement::of_pose(&pose))
    })
    .collect()
}

fn points(
    positions: &Bound<'_, PyAny>,
    quaternions: Option<&Bound<'_, PyAny>>,
    m: usize,
    length: NamedUnit,
) -> PyResult<Vec<Measurement>> {
    let expected = format!("shape ({m}, 3): a position for each row of joints");
    let positions = NumberArray::finite_of(positions, "positions", &[Some(m), Some(3)], &expected)?;
    let expected = format!("shape ({m}, 4): x, y, z, w of a unit quaternion for each row of joints");
    let name = "quaternions_xyzw";
    let quaternions = quaternions
        .map(|value| {
            NumberArray::from_argument(value, name, &expected)?.require_shape(&[Some(m), Some(4)], name, &expected)
        })
        .transpose()?;
    let rows = positions.values.chunks_exact(3).enumerate();
    rows.map(|(row, numbers)| {
        let position = Vector3::from_iterator(numbers.iter().map(|&value| length.to_si(value)));
        check_size("positions", row, position.as_slice())?;
        let quaternion =
            quaternions.as_ref().and_then(|it| <[f64; 4]>::try_from(it.values.get(4 * row..4 * row + 4)?).ok());
        let Some(quaternion) = quaternion.filter(|parts| !parts.iter().all(|part| part.is_nan())) else {
            return Ok(Measurement::point(position));
        };
        let norm = quaternion.iter().map(|part| part * part).sum::<f64>().sqrt();
        if norm.is_nan() || (norm - 1.0).abs() > QUATERNION_TOLERANCE {
            let message =
                format!("row {row}: found a quaternion of norm {norm:.4}, expected 1 to within {QUATERNION_TOLERANCE}");
            return Err(argument(name, message));
        }
        let pose = Pose::from_position_quaternion(position.into(), quaternion);
        Ok(Measurement::of_pose(&pose))
    })
    .collect()
}

fn sets(columns: &ArrayColumns<'_, '_>) -> PyResult<Vec<Option<Set>>> {
    let words = [("fit", Set::Fit), ("held_out", Set::HeldOut)];
    let stated = columns.sets.iter().flatten();
    stated.map(|word| word.as_ref().map(|word| choose_word("sets", word, &words)).transpose()).collect()
}

/// Standard deviation of each row, if stated.
fn sigma(name: &str, value: Option<&Bound<'_, PyAny>>, m: usize, to_si: fn(f64) -> f64) -> PyResult<Vec<Option<f64>>> {
    let Some(value) = value else { return Ok(Vec::new()) };
    let expected = format!("a number, or shape ({m},): one for each row of joints");
    let mut numbers = match value.is_instance_of::<PyString>() {
        true => NumberArray::repeat_number(f64::from_argument(value, name)?, m),
        false => NumberArray::from_argument(value, name, &expected)?,
    };
    if let (true, [number]) = (numbers.shape.is_empty(), numbers.values.as_slice()) {
        numbers = NumberArray::repeat_number(*number, m);
    }
    let numbers = numbers.require_shape(&[Some(m)], name, &expected)?;
    let of_row = |(row, &value): (usize, &f64)| match value {
        value if value.is_nan() => Ok(None),
        value if value > 0.0 && value.is_finite() => Ok(Some(to_si(value))),
        value => Err(argument(name, format!("row {row}: found {value}, expected a standard deviation above 0"))),
    };
    numbers.values.iter().enumerate().map(of_row).collect()
}
