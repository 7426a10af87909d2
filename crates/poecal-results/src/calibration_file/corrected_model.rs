//! The corrected model in `calibration.json`.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::bodies::{BodyEntry, InstrumentEntry, targets};
use super::trust::UncertaintyEntry;
use super::{CalibrationFile, FrameEntry, JointEntry, PoseEntry, RobotEntry, StationEntry, TargetEntry};
use poecal_arm::lie::Pose;
use poecal_calibrate::{
    Correction, JointEffect, JointErrorPart, JointErrors, Sizes, SizesReason, TermGroup, TriedSizes,
};
use poecal_fit::analysis::JointCoverage;
use poecal_model::measurement::{Dataset, MeasuredQuantities};
use poecal_model::robot::{Gravity, Robot, Statics, Weight};
use poecal_numerics::error::{ErrorKind, Result};

/// Screws and terms of the joints, fitted together. Its entries replace those of the same name where predictions are those of the corrected
/// model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CorrectedEntry {
    /// Prior standard deviation of the terms of each group, radians, of shift and runout metres; 0 where cross-validation left a group out.
    pub sizes: BTreeMap<String, f64>,
    /// Reason for these sizes.
    pub reason: SizesReason,
    /// Sizes that cross-validation tried; empty if the sizes were stated.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tried: Vec<TriedEntry>,
    /// Error of positions in cross-validation, millimetres (RMS): that of geometry alone times the share that remains with terms. Absent if the sizes
    /// were stated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub left_out_position_mm: Option<f64>,
    /// Effect of each group of terms at each joint, the joint that moves the target most first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub effects: Vec<EffectEntry>,
    /// Effects that the measurements cannot distinguish, a sentence each.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub indistinguishable: Vec<String>,
    /// Error of each joint over its sampled range, before and after.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub joint_errors: Vec<JointErrorsEntry>,
    /// Standard deviation of each component of the noise, millimetres or degrees, as estimated by the fit of screws and terms.
    pub noise: MeasuredQuantities<f64>,
    /// Expected errors of predictions; null without more residuals than the measurements determine unknowns.
    pub uncertainty: Option<UncertaintyEntry>,
    /// The corrected robot's frames, and the weights that it carries.
    pub robot: RobotEntry,
    /// The joints from base to tip: those of the robot, each followed by its compliant joints.
    pub joints: Vec<JointEntry>,
    /// Frame of the measuring device.
    pub measurement_frame: FrameEntry,
    /// Stations of the measuring device, if they are named or several.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stations: Vec<StationEntry>,
    /// Pose of the tip in the last joint's frame.
    pub tool: PoseEntry,
    /// Named targets.
    pub targets: BTreeMap<String, TargetEntry>,
    /// Instruments on the robot.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub instruments: BTreeMap<String, InstrumentEntry>,
}

/// Effect of one group of terms at one joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EffectEntry {
    /// The joint.
    pub joint: String,
    /// The group.
    pub group: String,
    /// The effect in words.
    pub words: String,
    /// Largest deviation in the fitted rows, milliradians, of shift and runout millimetres; of a ratio the change each radian.
    pub amplitude: f64,
    /// Its standard deviation.
    pub sigma: f64,
    /// Share of its prior variance that the measurements removed, 0 to 1.
    pub determined_share: f64,
    /// Distance by which it moves the target in the fitted rows, but for the mean of all (root mean square), millimetres.
    pub effect_mm: f64,
    /// True if it is larger than chance and the prior explain.
    pub found: bool,
}

/// Error of a joint over its sampled range: the motion of the joint that explains most of the residuals there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct JointErrorsEntry {
    /// The joint.
    pub joint: String,
    /// Parts of its range with enough rows.
    pub parts: Vec<JointErrorEntry>,
}

/// A part of a joint's range. Errors in milliradians, of a joint that slides in millimetres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct JointErrorEntry {
    /// Lower end, radians or metres.
    pub from: f64,
    /// Upper end.
    pub to: f64,
    /// Number of rows.
    pub rows: usize,
    /// Error of the calibrated model.
    pub calibrated: f64,
    /// Error of the corrected model.
    pub corrected: f64,
    /// Mean deviation by the joint's own terms.
    pub terms: f64,
    /// Its standard deviation.
    pub sigma: f64,
}

/// Sizes that were tried.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TriedEntry {
    /// The sizes.
    pub sizes: BTreeMap<String, f64>,
    /// Error (RMS) of parts that were left out, over that of geometry alone: a geometric mean over the parts. Six decimals.
    pub left_out: f64,
    /// Logarithm of its square with the prior of the choice: the least was chosen. Six decimals.
    pub score: f64,
}

/// Weights that a robot carries. Their masses are contained in the coefficients.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GravityEntry {
    /// Direction of gravity, base frame.
    pub direction: [f64; 3],
    /// The weights; the term `sag1` is of the first.
    pub weights: Vec<WeightEntry>,
    /// Origin of each joint of the nominal model at zero joint values, the reference of its moments, base frame.
    pub joint_origins_m: Vec<[f64; 3]>,
    /// Longest lever arm of each joint, the divisor of moments about it: the path from joint to joint to the farthest weight. It follows from the
    /// other entries; 0 for a joint that carries nothing.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub joint_levers_m: Vec<f64>,
    /// Sum over the masses that a joint carries, each times its longest lever arm; for a joint that slides, the masses alone. It divides the moment
    /// of all masses. It follows from the other entries; 0 for a joint that carries nothing.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub joint_mass_levers_kg_m: Vec<f64>,
}

/// A weight.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WeightEntry {
    /// Name of the joint that carries it, or of the tip.
    pub at: String,
    /// Its body.
    pub on: BodyEntry,
    /// Its position at zero joint values, base frame.
    pub place_m: [f64; 3],
}

fn of_sizes(sizes: &Sizes) -> BTreeMap<String, f64> {
    TermGroup::ALL.into_iter().map(|group| (group.name().to_owned(), sizes[group])).collect()
}

impl CorrectedEntry {
    /// True if there are terms: cross-validation may have left out every group.
    #[must_use]
    pub fn has_terms(&self) -> bool {
        self.sizes.values().any(|size| *size > 0.0)
    }

    /// Entry of a corrected model.
    pub(crate) fn from_correction(found: &Correction, data: &Dataset) -> Self {
        let (robot, model) = (&found.robot, &found.model);
        let geometry = found.tried.iter().find(|it| it.sizes == Sizes::NONE).map_or(0.0, |it| it.left_out);
        let tried = |it: &TriedSizes| TriedEntry {
            sizes: of_sizes(&it.sizes),
            left_out: with_six_decimals((0.5 * (it.left_out - geometry)).exp()),
            score: with_six_decimals(it.score),
        };
        let first = found.stations.first().map_or_else(Pose::identity, |it| it.base_from_device);
        let effect = |it: &JointEffect| EffectEntry {
            joint: it.joint.clone(),
            group: it.group.name().to_owned(),
            words: it.words(),
            amplitude: 1e3 * it.amplitude,
            sigma: 1e3 * it.sigma,
            determined_share: it.told,
            effect_mm: 1e3 * it.effect_m,
            found: it.is_found(),
        };
        let part = |it: &JointErrorPart| JointErrorEntry {
            from: it.range[0],
            to: it.range[1],
            rows: it.rows,
            calibrated: 1e3 * it.before,
            corrected: 1e3 * it.after,
            terms: 1e3 * it.terms.0,
            sigma: 1e3 * it.terms.1,
        };
        let errors =
            |it: &JointErrors| JointErrorsEntry { joint: it.joint.clone(), parts: it.parts.iter().map(part).collect() };
        CorrectedEntry {
            effects: found.effects.each.iter().map(effect).collect(),
            indistinguishable: found.effects.confused.clone(),
            joint_errors: found.effects.errors.iter().map(errors).collect(),
            sizes: of_sizes(&found.sizes),
            reason: found.reason,
            tried: found.tried.iter().filter(|it| it.left_out.is_finite()).map(tried).collect(),
            left_out_position_mm: found.left_out_m.map(|it| with_six_decimals(1e3 * it)),
            noise: super::measured_noise(&found.training, found.noise),
            uncertainty: UncertaintyEntry::of_correction(found, data),
            robot: RobotEntry::new(robot, &model.robot),
            joints: JointEntry::of_robot(robot, &model.robot),
            measurement_frame: FrameEntry { known: found.frame, base_from_device: (&first).into() },
            stations: StationEntry::all_from_stations(&found.stations, found.noise, &found.training),
            tool: (&robot.last_joint_from_tip()).into(),
            targets: targets(robot, &found.targets),
            instruments: InstrumentEntry::all_from_mounts(robot, &robot.instruments),
        }
    }
}

/// A figure of a choice, rounded to six decimals. The fits of parts of the rows are solved once by their normal equations, whose condition number
/// leaves about nine digits: vector instructions differed by 1.5e-9. Sizes differ by hundredths.
fn with_six_decimals(figure: f64) -> f64 {
    (figure * 1e6).round() / 1e6
}

impl CalibrationFile {
    /// The file as if its corrected model were the calibrated one. `None` without a corrected model, or if it has no terms and equals the calibrated
    /// one.
    #[must_use]
    pub fn corrected_file(&self) -> Option<CalibrationFile> {
        let found = self.corrected.as_deref().filter(|it| it.has_terms())?.clone();
        let of = |entry: &JointEntry| {
            let own = self.coverage.iter().find(|it| it.joint == entry.name).cloned();
            own.unwrap_or_else(|| JointCoverage::of_give(&entry.name))
        };
        Some(CalibrationFile {
            coverage: found.joints.iter().map(of).collect(),
            uncertainty: found.uncertainty,
            tool: found.tool,
            robot: found.robot,
            joints: found.joints,
            measurement_frame: found.measurement_frame,
            stations: found.stations,
            targets: found.targets,
            instruments: found.instruments,
            noise: super::NoiseEntry { sigma: found.noise, ..self.noise },
            corrected: None,
            ..self.clone()
        })
    }
}

impl GravityEntry {
    pub(crate) fn from_gravity(robot: &Robot, gravity: &Gravity) -> Self {
        let entry = |weight: &Weight| WeightEntry {
            at: weight.name.clone(),
            on: BodyEntry::from_body(robot, weight.body),
            place_m: weight.place.into(),
        };
        let statics = Statics::new(robot);
        GravityEntry {
            direction: gravity.direction.into(),
            weights: gravity.weights.iter().map(entry).collect(),
            joint_origins_m: gravity.axes.iter().map(|(_, origin)| (*origin).into()).collect(),
            joint_mass_levers_kg_m: statics
                .as_ref()
                .filter(|_| !robot.masses.is_empty())
                .map_or_else(Vec::new, |statics| statics.mass_levers_kg_m().to_vec()),
            joint_levers_m: statics.as_ref().map_or_else(Vec::new, |statics| statics.levers_m().to_vec()),
        }
    }

    /// The weights of a robot with these joints.
    pub(crate) fn gravity(&self, robot: &Robot, joints: &[JointEntry]) -> Result<Gravity> {
        let bad = |message: String| ErrorKind::Model.error(message);
        let direction = Vector3::from(self.direction);
        let length = direction.norm();
        if !(length > 0.0 && length.is_finite()) {
            return Err(bad("found a gravity without direction, expected one of length 1".to_owned()));
        }
        if self.joint_origins_m.len() != joints.len() {
            let (found, expected) = (self.joint_origins_m.len(), joints.len());
            return Err(bad(format!("found {found} origins of joints, expected those of {expected}")));
        }
        let axes = joints.iter().zip(&self.joint_origins_m);
        let axes = axes.map(|(entry, origin)| Ok((entry.nominal_screw.screw(entry)?, Vector3::from(*origin))));
        let weight = |entry: &WeightEntry| {
            let (name, place) = (entry.at.clone(), Vector3::from(entry.place_m));
            Ok(Weight { name, body: entry.on.body(robot)?, place })
        };
        Ok(Gravity {
            direction: direction / length,
            weights: self.weights.iter().map(weight).collect::<Result<_>>()?,
            axes: axes.collect::<Result<_>>()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_of_a_choice_have_six_decimals() {
        assert_eq!(with_six_decimals(0.277_971_625_198_774_7), 0.277_972);
        assert_eq!(with_six_decimals(-1.000_000_4), -1.0);
        assert_eq!(with_six_decimals(f64::INFINITY), f64::INFINITY);
    }
}
