//! The offsets that explain the difference of one model from another.

use std::fmt::Write as _;

use serde::Serialize;

use super::table::{line, number, robot_words};
use poecal_arm::lie::{Pose, rotation};
use poecal_model::offsets::{EndConstraint, TipError};
use poecal_model::robot::JointKind;
use poecal_numerics::text::escape_invisible;
use poecal_results::calibration_file::PoseEntry;
use poecal_results::model::Model;
use poecal_results::offsets::ModelOffsets;

/// An explanation by offsets, for a person to look over or a machine to read.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Offsets {
    nominal: String,
    actual: String,
    base: EndEntry,
    tip: EndEntry,
    joints: Vec<JointOffsetEntry>,
    /// Pose of the tip at zero joint values; null if the tip is free.
    home: Option<HomeEntry>,
    /// Names of the joints whose offsets are not determined.
    undetermined: Vec<String>,
    predictions: PredictionsEntry,
    #[serde(skip)]
    robot_words: String,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct EndEntry {
    frame: &'static str,
    reason: String,
    motion: PoseEntry,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct JointOffsetEntry {
    joint: String,
    kind: &'static str,
    /// Offset of a turning joint; null for a sliding joint.
    offset_deg: Option<f64>,
    /// Offset of a sliding joint; null for a turning joint.
    offset_mm: Option<f64>,
    determined: bool,
    tilt_deg: f64,
    /// Shift of a turning joint's axis; null for a sliding joint.
    shift_mm: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct HomeEntry {
    position_mm: f64,
    rotation_deg: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct PredictionsEntry {
    configurations: usize,
    /// Range of the joints over which they are determined.
    range: &'static str,
    without_offsets: OffsetErrors,
    with_offsets: OffsetErrors,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct OffsetErrors {
    position_rms_mm: f64,
    position_max_mm: f64,
    rotation_rms_deg: f64,
    rotation_max_deg: f64,
}

impl Offsets {
    /// An explanation of the difference of `actual` from `nominal`.
    #[must_use]
    pub fn new(nominal: &Model, actual: &Model, found: &ModelOffsets) -> Self {
        let ModelOffsets { explanation, reasons, is_sampled } = found;
        let joints = nominal.robot.joints.iter().enumerate();
        let joints: Vec<JointOffsetEntry> = joints
            .zip(explanation.offsets.iter().zip(&explanation.joints))
            .map(|((index, joint), (&offset, left))| JointOffsetEntry {
                joint: joint.name.clone(),
                kind: joint.kind.word(),
                offset_deg: (joint.kind == JointKind::Revolute).then(|| offset.to_degrees()),
                offset_mm: (joint.kind == JointKind::Prismatic).then_some(offset * 1e3),
                determined: !explanation.undetermined.contains(&index),
                tilt_deg: left.tilt_rad.to_degrees(),
                shift_mm: left.shift_m.map(|shift| shift * 1e3),
            })
            .collect();
        let [base, tip] = *reasons;
        Offsets {
            nominal: nominal.path.display().to_string(),
            actual: actual.path.display().to_string(),
            base: EndEntry::new(explanation.options.base, base, &explanation.base_motion),
            tip: EndEntry::new(explanation.options.tip, tip, &explanation.tip_motion),
            home: explanation.home.map(|home| HomeEntry {
                position_mm: home.position_m * 1e3,
                rotation_deg: home.rotation_rad.to_degrees(),
            }),
            undetermined: joints.iter().filter(|joint| !joint.determined).map(|joint| joint.joint.clone()).collect(),
            joints,
            predictions: PredictionsEntry {
                configurations: explanation.options.configurations,
                range: if *is_sampled { "sampled" } else { "limits" },
                without_offsets: OffsetErrors::new(&explanation.without_offsets),
                with_offsets: OffsetErrors::new(&explanation.with_offsets),
            },
            robot_words: robot_words(&nominal.robot),
        }
    }

    /// The offsets, and their effect on the tip's error, in a sentence.
    #[must_use]
    pub fn answer(&self) -> String {
        let joints: Vec<String> = self.joints.iter().map(JointOffsetEntry::words).collect();
        let [before, after] = [&self.predictions.without_offsets, &self.predictions.with_offsets];
        format!(
            "{}: the tip's error changes from {} to {} mm (RMS)",
            joints.join(", "),
            number(before.position_rms_mm),
            number(after.position_rms_mm)
        )
    }

    /// As text of lines up to 80 characters (except for longer names).
    #[must_use]
    pub fn text(&self) -> String {
        let mut out = String::new();
        line(&mut out, "robot", &self.robot_words);
        line(&mut out, "nominal", &self.nominal);
        line(&mut out, "actual", &self.actual);
        line(&mut out, "base", &self.base.words());
        line(&mut out, "tip", &self.tip.words());
        // Writing to a String cannot fail.
        let _ = writeln!(out, "\n{:<21}{:>14}{:>22}{:>15}", "add to joint", "offset", "remaining: tilt", "shift");
        for joint in &self.joints {
            let _ = writeln!(out, "{}", joint.row());
        }
        if let Some(home) = self.home {
            let (turn, shift) = (format_fixed(home.rotation_deg), format_fixed(home.position_mm));
            let _ = writeln!(out, "  {:<37}{turn:>14} deg{shift:>11} mm", "tip at zero");
        }
        out.push('\n');
        line(&mut out, "predictions", &self.predictions.words());
        if !self.undetermined.is_empty() {
            let words = format!(
                "* {}: this comparison does not determine these offsets, or not each by itself; the smallest that explain as much are shown",
                self.undetermined.join(", ")
            );
            line(&mut out, "undetermined", &words);
        }
        out
    }
}

impl EndEntry {
    fn new(end: EndConstraint, reason: &str, motion: &Pose) -> Self {
        EndEntry { frame: end.word(), reason: reason.to_owned(), motion: motion.into() }
    }

    fn words(&self) -> String {
        if self.frame == EndConstraint::Kept.word() {
            return format!("{}: {}", self.frame, self.reason);
        }
        let motion = Pose::from_position_quaternion(self.motion.position_m, self.motion.quaternion_xyzw);
        let (shift_mm, turn_rad) = (motion.translation.norm() * 1e3, rotation::log(&motion.rotation).norm());
        let (shift, turn) = (format_fixed(shift_mm), format_fixed(turn_rad.to_degrees()));
        format!("{}, shifted by {shift} mm and turned by {turn} deg: {}", self.frame, self.reason)
    }
}

impl JointOffsetEntry {
    /// The offset, and its unit.
    fn offset(&self) -> (String, &'static str) {
        match (self.offset_deg, self.offset_mm) {
            (Some(angle), _) => (format_fixed(angle), "deg"),
            (None, length) => (format_fixed(length.unwrap_or(0.0)), "mm"),
        }
    }

    fn words(&self) -> String {
        let (offset, unit) = self.offset();
        let doubt = if self.determined { "" } else { " (not determined)" };
        format!("{} {offset} {unit}{doubt}", escape_invisible(&self.joint))
    }

    fn row(&self) -> String {
        let (offset, unit) = self.offset();
        let mark = if self.determined { "" } else { "*" };
        let shift = self.shift_mm.map_or_else(String::new, |shift| format!("{:>11} mm", format_fixed(shift)));
        let tilt = format_fixed(self.tilt_deg);
        format!("  {:<18}{offset:>13} {unit:<3} {mark:<1}{tilt:>14} deg{shift}", escape_invisible(&self.joint))
    }
}

impl OffsetErrors {
    fn new(error: &TipError) -> Self {
        OffsetErrors {
            position_rms_mm: error.rms_m * 1e3,
            position_max_mm: error.max_m * 1e3,
            rotation_rms_deg: error.rms_rad.to_degrees(),
            rotation_max_deg: error.max_rad.to_degrees(),
        }
    }
}

impl PredictionsEntry {
    fn words(&self) -> String {
        let (before, after) = (&self.without_offsets, &self.with_offsets);
        format!(
            "on {} random configurations {}, offsets change the tip's error from {} mm to {} mm (RMS; largest {} to {} mm), \
             and from {} deg to {} deg (largest {} to {} deg)",
            self.configurations,
            if self.range == "sampled" { "over the sampled range" } else { "within the limits" },
            number(before.position_rms_mm),
            number(after.position_rms_mm),
            number(before.position_max_mm),
            number(after.position_max_mm),
            number(before.rotation_rms_deg),
            number(after.rotation_rms_deg),
            number(before.rotation_max_deg),
            number(after.rotation_max_deg)
        )
    }
}

/// Four decimals, without a sign at zero.
fn format_fixed(value: f64) -> String {
    format!("{:.4}", (value * 1e4).round() / 1e4 + 0.0)
}
