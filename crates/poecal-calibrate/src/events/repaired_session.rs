//! A session as it would have been without an event: rows left out, another device frame, another target, or earlier readings converted to those
//! after the event.

use std::borrow::Cow;

use nalgebra::Vector3;

use super::hypotheses::MovedPart;
use super::names::{DEVICE, next_of};
use super::search::SearchStep;
use super::search_outcome::SearchOutcome;
use crate::run::CalibrationRun;
use crate::{CalibrationOptions, DeviceFrameKnowledge};
use poecal_arm::lie::{Pose, rotation};
use poecal_model::measurement::Dataset;
use poecal_model::robot::{Body, MEASURED, Robot};
use poecal_numerics::error::Result;

/// The session without the event; `None` if that is not possible.
pub(crate) fn undo_events<'a>(
    run: &CalibrationRun<'a>,
    happened: &SearchOutcome,
) -> Option<Result<CalibrationRun<'a>>> {
    let CalibrationRun { robot, options, .. } = run;
    let mut left_out = run.left_out.clone();
    let step = match happened {
        SearchOutcome::Wrong(rows) => {
            left_out.extend(rows);
            left_out.sort_unstable();
            left_out.dedup();
            return Some(Ok(run.leaving_out(left_out)));
        }
        SearchOutcome::Step(step) => step,
    };
    let mut data = run.data.clone().into_owned();
    match step.moved {
        MovedPart::Device(station) => move_device(&mut data, station, step.first, robot, options)?,
        MovedPart::Target(target) => move_targets(&mut data, &[target], step.first, robot, options)?,
        MovedPart::Tool => {
            let all: Vec<usize> = (0..data.targets.len()).collect();
            move_targets(&mut data, &all, step.first, robot, options)?;
        }
        MovedPart::Zero(joint) => shift_readings(&mut data, step, joint, robot)?,
        MovedPart::Drift(station) => remove_drift(&mut data, step, station)?,
    }
    Some(CalibrationRun::new(robot, Cow::Owned(data), options, left_out))
}

/// Renames a device from a row on; `None` if its frame is known, or is not its only unknown.
fn move_device(
    data: &mut Dataset,
    station: usize,
    first: u32,
    robot: &Robot,
    options: &CalibrationOptions,
) -> Option<()> {
    let is_free = options.frame == DeviceFrameKnowledge::Unknown;
    let name = data.stations.get(station).cloned().flatten();
    let is_mounted = robot.instruments.iter().any(|it| Some(&it.name) == name.as_ref());
    let is_plain = data.lengths.is_empty() && !data.is_ranging(station) && sees_places(data, station);
    if !is_free || is_mounted || !is_plain {
        return None;
    }
    if data.stations.is_empty() {
        data.stations = vec![None];
    }
    let name = name.unwrap_or_else(|| DEVICE.to_owned());
    let next = next_of(&name, data.stations.iter().flatten());
    data.stations[station] = Some(name);
    data.stations.push(Some(next));
    let other = data.stations.len() - 1;
    let moved = data.observations.iter_mut().skip(first as usize);
    moved.filter(|row| row.station == station).for_each(|row| row.station = other);
    Some(())
}

/// Converts the readings before a joint's zero slipped to those after it: the robot is calibrated in its present state. `None` if the zero does not
/// explain its readings alone.
fn shift_readings(data: &mut Dataset, step: &SearchStep, joint: usize, robot: &Robot) -> Option<()> {
    let own = &robot.joints.get(joint)?.reading;
    let at = data.reading_names().iter().position(|it| *it == own.name)?;
    let is_own = robot.joints.iter().filter(|it| it.reading.name == own.name).count() == 1;
    let is_plain = data.controller.is_none() && data.further_readings().is_empty();
    if !is_own || !is_plain || own.multiplier == 0.0 {
        return None;
    }
    let shift = *step.size.first()? / own.multiplier;
    data.change_readings(step.first, |readings| {
        if let Some(value) = readings.get_mut(at) {
            *value -= shift;
        }
    });
    Some(())
}

/// True if all rows of a station measured positions.
fn sees_places(data: &Dataset, station: usize) -> bool {
    let mut own = data.observations.iter().filter(|row| row.station == station);
    own.all(|row| row.measurement.is_place())
}

/// Renames targets from a row on; `None` if they belong to the model.
fn move_targets(
    data: &mut Dataset,
    targets: &[usize],
    first: u32,
    robot: &Robot,
    options: &CalibrationOptions,
) -> Option<()> {
    if options.move_tip {
        return None;
    }
    for &target in targets {
        let name = data.targets.get(target)?.clone().unwrap_or_else(|| MEASURED.to_owned());
        let is_elsewhere = robot.mounted.iter().any(|it| it.name == name && it.body == Body::Base);
        let is_shared = data.stations.iter().flatten().any(|it| *it == name);
        let on_other = robot.mounted.iter().any(|it| it.name == name && it.body != robot.tip_body());
        if is_elsewhere || is_shared || on_other {
            return None;
        }
        let next = next_of(&name, data.targets.iter().flatten());
        data.targets[target] = Some(name);
        data.targets.push(Some(next));
        let other = data.targets.len() - 1;
        let moved = data.observations.iter_mut().skip(first as usize);
        moved.filter(|row| row.target == target).for_each(|row| row.target = other);
    }
    Some(())
}

/// Removes a device's drift from its measurements.
fn remove_drift(data: &mut Dataset, step: &SearchStep, station: usize) -> Option<()> {
    let [x, y, z, rx, ry, rz] = *<&[f64; 6]>::try_from(step.size.as_slice()).ok()?;
    if !sees_places(data, station) {
        return None;
    }
    let rows = data.seen_from(station, &data.all_rows());
    let about = data.mean_position(&rows);
    let last = (rows.len().max(2) - 1) as f64;
    for (place, &row) in rows.iter().enumerate() {
        let share = place as f64 / last - 0.5;
        let back = rotation::exp(&(Vector3::new(rx, ry, rz) * -share));
        let shift = Vector3::new(x, y, z) * share;
        let of = |position: &Vector3<f64>| back * (position - shift - about) + about;
        let measurement = &mut data.observations.get_mut(row as usize)?.measurement;
        *measurement = measurement.map_pose(|pose| Pose::new(back * pose.rotation, of(&pose.translation)))?;
    }
    Some(())
}
