//! LeRobot's calibration of motors with the zeros that a calibration found, in ticks of Feetech's motors: `position = raw − homing_offset`, and the
//! zero of an angle is the middle of the range.

use std::f64::consts::TAU;

use super::offsets::{explain_offsets, move_nominal};
use super::{ExportedText, Proof, export_error, remaining_difference};
use crate::model::Model;
use poecal_arm::lie::Pose;
use poecal_formats::motors::{DIVISOR, Motor, Motors, TICKS};
use poecal_model::robot::{Controller, Joint, JointKind, Robot};
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_storage::json_text;

/// Largest homing offset that the motors store.
const MOST_TICKS: i64 = 2047;
/// Smallest share of its travel that a motor keeps.
const LEAST_TRAVEL: f64 = 0.1;

/// The file with other homing offsets. Of readings that are those of the motors, zeros and signs are those that were found with them, and the
/// geometry is left to the calibrated URDF; of others, the offsets that come nearest to the calibrated robot.
pub(crate) fn write_motors(model: &Model, robot: &Robot, motors: Option<&str>) -> Result<ExportedText> {
    if let Some(joint) = robot.joints.iter().find(|it| it.kind == JointKind::Prismatic) {
        return Err(export_error(format!("found prismatic joint `{}`, expected revolute joints only", joint.name)));
    }
    let file = motors_of(robot, motors)?;
    let mut written = match model.sums() {
        Some(controller) => write_zeros(robot, file, controller)?,
        None => write_offsets(model, robot, file)?,
    };
    if motors.is_none() {
        written.notes.push(
            "the file begins with homing offsets of zero and the whole range: name the arm's own with --motors FILE"
                .to_owned(),
        );
    }
    Ok(written)
}

/// The calibration of motors that LeRobot has, or one without offsets.
fn motors_of(robot: &Robot, motors: Option<&str>) -> Result<Motors> {
    match motors {
        Some(text) => serde_json::from_str(text).map_err(|error| {
            option(format!(
                "found {error} in the calibration of motors, expected LeRobot's JSON with id, drive_mode, homing_offset, range_min, range_max of \
                 each joint"
            ))
        }),
        None => {
            let motor = |id: u8| Motor { id, drive_mode: 0, homing_offset: 0, range_min: 0, range_max: 4095 };
            let joints = robot.joints.iter().map(|joint| joint.name.clone());
            Ok(Motors(joints.zip((1..).map(motor)).collect()))
        }
    }
}

/// The motor of a joint, by its name, the name of its column, or its number.
fn motor_of<'m>(motors: &'m mut Motors, joint: &Joint, column: Option<&str>) -> Result<(String, &'m mut Motor)> {
    let known = motors.0.keys().cloned().collect::<Vec<_>>().join(", ");
    let name = motors.name_of(&joint.name, column).map(str::to_owned);
    name.and_then(|name| motors.0.get_mut(&name).map(|motor| (name, motor))).ok_or_else(|| {
        option(format!(
            "found no motor `{}` in the calibration of motors, expected one of each joint, and found {known}",
            joint.name
        ))
    })
}

/// Zeros and signs that were found with the readings of the motors.
fn write_zeros(robot: &Robot, mut motors: Motors, controller: &Controller) -> Result<ExportedText> {
    let (mut errors, mut table, mut turned) = (Vec::new(), Vec::new(), Vec::new());
    for joint in &robot.joints {
        let reading = controller.readings.iter().find(|it| it.reading == joint.reading.name);
        let columns = reading.map(|it| it.columns.iter().collect::<Vec<_>>()).unwrap_or_default();
        let (Some(reading), [(column, made)]) = (reading, &columns[..]) else {
            return Err(export_error(format!(
                "found readings that the mapping made of others ({}), expected those of one motor for each joint",
                controller.words()
            )));
        };
        let (name, motor) = motor_of(&mut motors, joint, Some(column))?;
        let middle = motor.middle();
        // Count at the joint's zero, in the column's own unit.
        let counted = -reading.offset / made.factor;
        let (zero, is_turned) = match made.unit.as_str() {
            "ticks" if made.factor.abs() == 1.0 => (counted * TICKS / TAU, made.factor < 0.0),
            "ticks" => {
                let per_cent = motor.ticks_of_per_cent();
                (middle + per_cent * counted * TICKS / TAU, made.factor * per_cent < 0.0)
            }
            "deg" => (middle + counted.to_degrees() * DIVISOR / 360.0, made.factor < 0.0),
            other => {
                return Err(export_error(format!(
                    "found readings of `{column}` in {other}, expected ticks, degrees or per cent of a motor: calibrate with its file as --columns"
                )));
            }
        };
        let sign = if is_turned { "-" } else { "" };
        table.push(format!("{} = {sign}({name} - {zero:.1}) ticks of 360/4096 deg", joint.name));
        if is_turned {
            turned.push(joint.name.clone());
        }
        let shift = rezero(motor, zero, &name)?;
        errors.push((zero - middle - shift as f64) * TAU / TICKS);
    }
    let again = move_nominal(robot, &errors, &Pose::identity(), &Pose::identity())?;
    let remains = remaining_difference(robot, &again);
    let mut notes = vec![
        format!("joint values of any software: {}", table.join(", ")),
        format!(
            "the file belongs to the calibrated URDF (poecal export --format urdf); zeros rounded to ticks move the tip by up to {:.3} mm; policies \
             and data recorded with the file before no longer fit",
            remains.position_m * 1e3
        ),
    ];
    if !turned.is_empty() {
        notes.push(format!(
            "the file cannot turn a motor round: reverse the axis of {} in the URDF that LeRobot reads, and exchange its limits",
            turned.join(", ")
        ));
    }
    Ok(ExportedText { text: json_text(&motors, "calibration of motors")?, notes, proof: Proof::Remains(remains) })
}

/// Offsets that come nearest to the calibrated robot, with its nominal model.
fn write_offsets(model: &Model, robot: &Robot, mut motors: Motors) -> Result<ExportedText> {
    let (nominal, found) = explain_offsets(model, robot)?;
    let mut rounded = Vec::with_capacity(found.offsets.len());
    for (joint, offset) in robot.joints.iter().zip(&found.offsets) {
        let (name, motor) = motor_of(&mut motors, joint, None)?;
        if motor.drive_mode != 0 {
            return Err(option(format!(
                "found drive_mode {} of motor `{name}`, expected 0: what turns a motor round depends on the unit in which LeRobot reads it",
                motor.drive_mode
            )));
        }
        let middle = motor.middle();
        let shift = rezero(motor, middle - offset * TICKS / TAU, &name)?;
        rounded.push(-(shift as f64) * TAU / TICKS);
    }
    let again = move_nominal(&nominal, &rounded, &found.base_motion, &found.tip_motion)?;
    let remains = remaining_difference(robot, &again);
    let alone = move_nominal(&nominal, &rounded, &Pose::identity(), &Pose::identity())?;
    let notes = vec![format!(
        "offsets alone, rounded to ticks of {:.3} deg: the tip is off by up to {:.3} mm, and by up to {:.3} mm where base and tool are entered \
         elsewhere",
        360.0 / TICKS,
        remaining_difference(robot, &alone).position_m * 1e3,
        remains.position_m * 1e3
    )];
    Ok(ExportedText { text: json_text(&motors, "calibration of motors")?, notes, proof: Proof::Remains(remains) })
}

/// Puts the middle of a motor's range to a position, in ticks, with the travel within that before; returns the shift in whole ticks.
fn rezero(motor: &mut Motor, zero: f64, name: &str) -> Result<i64> {
    let (least, most) = (motor.range_min, motor.range_max);
    let middle = motor.middle();
    let shift = (zero - middle).round() as i64;
    let corrected = motor.homing_offset.saturating_add(shift);
    if ![motor.homing_offset, corrected].iter().all(|it| (-MOST_TICKS..=MOST_TICKS).contains(it)) {
        return Err(option(format!(
            "found a homing offset of {} for motor `{name}`, which would become {corrected}, expected at most {MOST_TICKS}, as the motors store it: \
             take the horn off and put it back nearer to the middle",
            motor.homing_offset
        )));
    }
    // The travel is even about its zero: what the horn is off is lost at one end.
    let travel = 0.5 * (most - least) as f64 - shift.abs() as f64;
    if travel < LEAST_TRAVEL * (most - least) as f64 {
        return Err(option(format!(
            "found the zero of motor `{name}` {shift} ticks from the middle of its range from {least} to {most}, expected at least a fifth of the \
             range on both sides: take the horn off and put it back nearer to the middle"
        )));
    }
    (motor.range_min, motor.range_max) = ((middle - travel) as i64, (middle + travel) as i64);
    motor.homing_offset = corrected;
    Ok(shift)
}

fn option(message: String) -> Error {
    ErrorKind::Option.error(message)
}
