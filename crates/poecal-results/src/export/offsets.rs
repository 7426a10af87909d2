//! The best approximation by joint offsets: for controllers that take nothing else.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::{ExportedText, Proof, export_error, remaining_difference};
use crate::calibration_file::PoseEntry;
use crate::model::{Model, ModelSource};
use crate::offsets::ModelOffsets;
use poecal_arm::lie::Pose;
use poecal_formats::proof::Difference;
use poecal_model::offsets::{OffsetExplanation, into_screws};
use poecal_model::robot::{Joint, JointKind, Robot};
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_storage::json_text;

/// Ticks of a turn of Feetech's motors.
const TICKS: f64 = 4096.0;

#[derive(Serialize)]
struct OffsetsFile<'a> {
    form: &'static str,
    formula: &'static str,
    robot: &'a str,
    joints: Vec<JointOffset>,
    /// The offsets in the controller's counts, if its readings are not the model's.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    counted: Vec<JointOffset>,
    base_motion: PoseEntry,
    tool_motion: PoseEntry,
    without_offsets: TipErrorsEntry,
    remains: TipErrorsEntry,
}

#[derive(Serialize)]
struct JointOffset {
    joint: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    offset_deg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    offset_mm: Option<f64>,
    determined: bool,
}

/// Errors of the tip.
#[derive(Serialize)]
struct TipErrorsEntry {
    rms_mm: f64,
    max_mm: f64,
    rms_deg: f64,
    max_deg: f64,
}

/// Offsets with the best base and tool.
fn explain_offsets(model: &Model, robot: &Robot) -> Result<(Robot, OffsetExplanation)> {
    let ModelSource::Calibration(file) = &model.source else {
        return Err(export_error(
            "found a model, expected the calibration.json of a robot that had other numbers before"
                .to_owned(),
        ));
    };
    let mut nominal = file.nominal_robot()?.without_offsets().rigid();
    nominal.terms.clear();
    let found = ModelOffsets::of_robots(&nominal, robot, model, [None, None])?;
    Ok((nominal, found.explanation))
}

/// The nominal robot with offsets, another base and another tool.
fn move_nominal(nominal: &Robot, offsets: &[f64], base: &Pose, tool: &Pose) -> Result<Robot> {
    let mut robot = into_screws(&nominal.without_offsets(), offsets)?;
    for joint in &mut robot.joints {
        joint.screw = joint.screw.transform(base);
        joint.frame = *base * joint.frame;
    }
    robot.home = *base * robot.home * *tool;
    Ok(robot)
}

pub(crate) fn write(model: &Model, robot: &Robot) -> Result<ExportedText> {
    let (_, found) = explain_offsets(model, robot)?;
    let joints = robot.joints.iter().zip(&found.offsets).enumerate();
    let left = |error: &poecal_model::offsets::TipError| TipErrorsEntry {
        rms_mm: error.rms_m * 1e3,
        max_mm: error.max_m * 1e3,
        rms_deg: error.rms_rad.to_degrees(),
        max_deg: error.max_rad.to_degrees(),
    };
    let joint = |(at, (joint, &offset)): (usize, (&Joint, &f64))| JointOffset {
        joint: joint.name.clone(),
        offset_deg: (joint.kind == JointKind::Revolute).then(|| offset.to_degrees()),
        offset_mm: (joint.kind == JointKind::Prismatic).then_some(offset * 1e3),
        determined: !found.undetermined.contains(&at),
    };
    let counted = controller_offsets(model, robot, &found)?;
    let file = OffsetsFile {
        form: "offsets",
        formula: "value of a joint = its reading + offset; T(q) = base_motion * T_nominal(q + offsets) * tool_motion, nearly: remains",
        robot: &robot.name,
        joints: joints.map(joint).collect(),
        counted,
        base_motion: (&found.base_motion).into(),
        tool_motion: (&found.tip_motion).into(),
        without_offsets: left(&found.without_offsets),
        remains: left(&found.with_offsets),
    };
    let text = json_text(&file, "offsets")?;
    let notes = vec![words(&found)];
    let left = &found.with_offsets;
    let remains = Difference { position_m: left.max_m, rotation_rad: left.max_rad };
    Ok(ExportedText { text, notes, proof: Proof::Remains(remains) })
}

/// Offsets of the controller's counts; empty if these are the model's readings.
fn controller_offsets(model: &Model, robot: &Robot, found: &OffsetExplanation) -> Result<Vec<JointOffset>> {
    let Some(controller) = model.sums() else { return Ok(Vec::new()) };
    let counting = controller.controller_map()?;
    let mut of_readings = vec![0.0; counting.names().len()];
    let mut slides = vec![false; of_readings.len()];
    let mut is_known = vec![true; of_readings.len()];
    let joints = robot.joints.iter().zip(robot.reading_indices()).zip(&found.offsets).enumerate();
    for (at, ((joint, reading), offset)) in joints {
        let own = robot.reading_indices().iter().filter(|it| **it == reading).count() == 1;
        if let Some(it) = of_readings.get_mut(reading) {
            *it = offset / joint.reading.multiplier;
            slides[reading] = joint.kind == JointKind::Prismatic;
            is_known[reading] &= own && !found.undetermined.contains(&at);
        }
    }
    let change = counting.change(&of_readings);
    let offset = |(at, offset): (usize, &f64)| JointOffset {
        joint: counting.names()[at].clone(),
        offset_deg: (!slides[at]).then(|| offset.to_degrees()),
        offset_mm: slides[at].then_some(offset * 1e3),
        determined: (0..is_known.len()).all(|of| is_known[of] || counting.inverse()[(at, of)] == 0.0),
    };
    Ok(change.iter().enumerate().map(offset).collect())
}

fn words(found: &OffsetExplanation) -> String {
    format!(
        "offsets, base and tool are all that this form says: over the sampled range the tip is off by {:.4} mm (RMS), up to {:.4} mm and {:.5} deg; without offsets by \
         {:.4} mm (RMS)",
        found.with_offsets.rms_m * 1e3,
        found.with_offsets.max_m * 1e3,
        found.with_offsets.max_rad.to_degrees(),
        found.without_offsets.rms_m * 1e3
    )
}

/// A motor of LeRobot's calibration.
#[derive(Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Motor {
    id: u32,
    drive_mode: u8,
    homing_offset: i64,
    range_min: i64,
    range_max: i64,
}

/// Largest homing offset that the motors store.
const MOST_TICKS: i64 = 2047;

/// LeRobot's existing calibration of motors, or one without offsets.
fn motors_of(robot: &Robot, motors: Option<&str>) -> Result<BTreeMap<String, Motor>> {
    match motors {
        Some(text) => serde_json::from_str(text).map_err(|error| {
            option(format!(
                "found {error} in the calibration of motors, expected LeRobot's JSON with id, drive_mode, homing_offset, range_min, range_max of \
                 each joint"
            ))
        }),
        None => {
            let motor = |id: u32| Motor { id, drive_mode: 0, homing_offset: 0, range_min: 0, range_max: 4095 };
            let joints = robot.joints.iter().map(|joint| joint.name.clone());
            Ok(joints.zip((1..).map(motor)).collect())
        }
    }
}

/// Offsets in ticks of Feetech's motors, `position = ticks - homing_offset`.
pub(crate) fn write_ticks(model: &Model, robot: &Robot, motors: Option<&str>) -> Result<ExportedText> {
    let (nominal, found) = explain_offsets(model, robot)?;
    if let Some(joint) = robot.joints.iter().find(|it| it.kind == JointKind::Prismatic) {
        return Err(export_error(format!(
            "found joint `{}`, which slides, expected joints that motors turn",
            joint.name
        )));
    }
    if let Some(controller) = model.sums() {
        return Err(export_error(format!(
            "found readings that the mapping made of others ({}), expected those of the motors",
            controller.words()
        )));
    }
    let mut file = motors_of(robot, motors)?;
    let mut rounded = Vec::with_capacity(found.offsets.len());
    for (joint, offset) in robot.joints.iter().zip(&found.offsets) {
        let known = file.keys().cloned().collect::<Vec<_>>().join(", ");
        let Some(motor) = file.get_mut(&joint.name) else {
            return Err(option(format!(
                "found no motor `{}` in the calibration of motors, expected one of each joint, and found {known}",
                joint.name
            )));
        };
        if motor.drive_mode != 0 {
            return Err(option(format!(
                "found drive_mode {} of motor `{}`, expected 0: what turns a motor round depends on the unit in which LeRobot reads it",
                motor.drive_mode, joint.name
            )));
        }
        let ticks = (offset * TICKS / TAU).round();
        let corrected = motor.homing_offset.saturating_sub(ticks as i64);
        if ![motor.homing_offset, corrected].iter().all(|it| (-MOST_TICKS..=MOST_TICKS).contains(it)) {
            return Err(option(format!(
                "found a homing offset of {} for motor `{}`, which would become {corrected}, expected at most {MOST_TICKS}, as the motors store it: \
                 take the horn off and put it back nearer to the middle",
                motor.homing_offset, joint.name
            )));
        }
        motor.homing_offset = corrected;
        rounded.push(ticks * TAU / TICKS);
    }
    let again = move_nominal(&nominal, &rounded, &found.base_motion, &found.tip_motion)?;
    let remains = remaining_difference(robot, &again);
    let alone = move_nominal(&nominal, &rounded, &Pose::identity(), &Pose::identity())?;
    let mut notes = vec![format!(
        "offsets alone, rounded to ticks of {:.3} deg: the tip is off by up to {:.3} mm, and by up to {:.3} mm where base and tool are entered \
         elsewhere",
        360.0 / TICKS,
        remaining_difference(robot, &alone).position_m * 1e3,
        remains.position_m * 1e3
    )];
    if motors.is_none() {
        notes.push("the file begins with homing offsets of zero and the whole range: name the arm's own with --motors FILE".to_owned());
    }
    Ok(ExportedText {
        text: json_text(&file, "calibration of motors")?,
        notes,
        proof: Proof::Remains(remains),
    })
}

fn option(message: String) -> Error {
    ErrorKind::Option.error(message)
}
