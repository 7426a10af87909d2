//! The best approximation by joint offsets: for controllers that take nothing else.

use serde::Serialize;

use super::{ExportedText, Proof, export_error};
use crate::calibration_file::PoseEntry;
use crate::model::{Model, ModelSource};
use crate::offsets::ModelOffsets;
use poecal_arm::lie::Pose;
use poecal_formats::proof::Difference;
use poecal_model::offsets::{OffsetExplanation, into_screws};
use poecal_model::robot::{Joint, JointKind, Robot};
use poecal_numerics::error::Result;
use poecal_storage::json_text;

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
pub(super) fn explain_offsets(model: &Model, robot: &Robot) -> Result<(Robot, OffsetExplanation)> {
    let ModelSource::Calibration(file) = &model.source else {
        return Err(export_error(
            "found a model, expected the calibration.json of a robot that had other numbers before".to_owned(),
        ));
    };
    let mut nominal = file.nominal_robot()?.without_offsets().rigid();
    nominal.terms.clear();
    let found = ModelOffsets::of_robots(&nominal, robot, model, [None, None])?;
    Ok((nominal, found.explanation))
}

/// The nominal robot with offsets, another base and another tool.
pub(super) fn move_nominal(nominal: &Robot, offsets: &[f64], base: &Pose, tool: &Pose) -> Result<Robot> {
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
