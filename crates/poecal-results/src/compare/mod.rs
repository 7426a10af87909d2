//! Changes between two calibrations of one robot, in terms that do not depend on the choice of base, tool and screws (theory.md §9, *Two
//! calibrations*).
//!
//! Offset, tilt and shift of each joint come with base and tool in the best fit (`poecal-model`'s `offsets`), and their covariance from both files
//! (`change_covariance.rs`). This module has numbers only; `poecal-report` has the words and tables.

mod change_covariance;
mod chi_square;

pub use chi_square::ChiSquare;

use std::collections::BTreeSet;

use nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use crate::calibration_file::CalibrationFile;
use change_covariance::ChangeCovariance;
use poecal_arm::lie::{Pose, rotation};
use poecal_calibrate::DeviceFrameKnowledge;
use poecal_fit::analysis::within_sampled;
use poecal_model::offsets::{Changes, EndConstraint, JointChange, TaughtFrames, with_tool_of};
use poecal_model::robot::{JointKind, Robot};
use poecal_model::simulate::random_configuration;
use poecal_numerics::error::{Error, ErrorKind, Result};

/// Configurations over which tips are compared, and the seed of these.
const CONFIGURATIONS: usize = 1000;
const SEED: u64 = 1;
/// Distance and angle between nominal axes (m, rad) from which they are of another robot: no calibration corrects as much.
const OTHER_M: f64 = 0.05;
const OTHER_RAD: f64 = 0.1;
/// Probability of a test to call noise a change; of the joints all together.
const CHANCE: f64 = 0.01;

/// Change of a joint.
#[derive(Clone, Debug, PartialEq)]
pub struct ComparedJoint {
    /// Its name.
    pub name: String,
    /// Change from the first calibration to the second, with combined standard deviations.
    pub change: JointChange,
    /// Its test; `None` without the uncertainty of both.
    pub test: Option<ChiSquare>,
}

/// Difference of the tips, with base and tool in the best fit, by the models that the calibrations deliver: corrected if both have terms.
#[derive(Clone, Debug, PartialEq)]
pub struct TipDifference {
    /// Number of random configurations in the range that both sampled.
    pub configurations: usize,
    /// True if they are by the corrected models.
    pub is_corrected: bool,
    /// Root mean square distance, metres.
    pub rms_m: f64,
    /// Largest distance, metres.
    pub max_m: f64,
    /// Root mean square angle, radians.
    pub rms_rad: f64,
    /// Readings of the largest distance, by [`Robot::reading_names`], radians or metres.
    pub max_at: Vec<(String, f64)>,
    /// Position of the first robot's tip there, base frame, metres.
    pub max_place: Vector3<f64>,
    /// The distance (RMS) up to which the robot is unchanged, metres: as stated, or the expected errors of both together; `None` without either.
    pub limit_m: Option<f64>,
    /// True if it was stated.
    pub limit_is_stated: bool,
}

/// Changes between two calibrations of one robot.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationComparison {
    /// Each joint.
    pub joints: Vec<ComparedJoint>,
    /// The test of all joints; `None` without the uncertainty of both.
    pub test: Option<ChiSquare>,
    /// Difference of the tips.
    pub tip: TipDifference,
    /// True if the base frame was free in the comparison: at least one of the calibrations fitted it.
    pub base_is_free: bool,
}

impl CalibrationComparison {
    /// True if the tip moved by more than the limit; `None` without a limit.
    #[must_use]
    pub fn is_moved(&self) -> Option<bool> {
        self.tip.limit_m.map(|limit_m| self.tip.rms_m > limit_m)
    }

    /// True if the joints changed by more than noise; `None` without the uncertainty of both.
    #[must_use]
    pub fn is_change(&self) -> Option<bool> {
        self.test.map(|test| test.is_change() || self.changed_joints().next().is_some())
    }

    /// The joints that changed by more than noise.
    pub fn changed_joints(&self) -> impl Iterator<Item = &ComparedJoint> {
        self.joints.iter().filter(|joint| joint.test.is_some_and(|test| test.is_change()))
    }
}

/// Compares two calibrations of one robot, from `first` to `second`. The offset, tilt and shift of each joint, with base and tool in the best fit,
/// are compared with the covariances of both. The predictions of both over the commonly sampled range are compared with a limit (metres, RMS), or
/// else with the expected errors of both together.
///
/// # Errors
/// [`ErrorKind::Option`] if they are of different robots; [`ErrorKind::Model`] if a file holds no valid robot.
pub fn compare(
    first: &CalibrationFile,
    second: &CalibrationFile,
    limit_m: Option<f64>,
) -> Result<CalibrationComparison> {
    let (a, b) = (first.robot()?, second.robot()?);
    let is_known = |file: &CalibrationFile| file.frame() == DeviceFrameKnowledge::Base;
    let base_is_free = !(is_known(first) && is_known(second));
    let base = if base_is_free { EndConstraint::Free } else { EndConstraint::Kept };
    let changes = Changes::from_robots(&a, &b, base).map_err(|error| other_robot(&a, &b, error))?;
    check_nominal(&first.nominal_robot()?, &second.nominal_robot()?)?;
    let spread = ChangeCovariance::from_changes(&changes, [first, second])?;
    let chance = CHANCE / a.joints.len().max(1) as f64;
    let joints = a.joints.iter().zip(&changes.joints).enumerate();
    let joints = joints.map(|(index, (joint, change))| ComparedJoint {
        name: joint.name.clone(),
        change: spread.as_ref().map_or(*change, |spread| spread.with_sigmas(index, change)),
        test: spread.as_ref().map(|spread| spread.test(&[index], &changes, chance)),
    });
    let joints: Vec<ComparedJoint> = joints.collect();
    let all: Vec<usize> = (0..joints.len()).collect();
    let corrected = first.corrected_file().zip(second.corrected_file());
    let (one, other) = corrected.as_ref().map_or((first, second), |(one, other)| (one, other));
    let expected = |file: &CalibrationFile| file.uncertainty.as_ref().map(|it| it.measured.sigma_position_mm / 1e3);
    let expected_m = expected(one).zip(expected(other)).map(|(one, other)| one.hypot(other));
    let sampled = within_sampled(&a, &[&first.coverage, &second.coverage]);
    let tip = tips(&sampled, &one.robot()?, &other.robot()?, base_is_free);
    Ok(CalibrationComparison {
        joints,
        test: spread.as_ref().map(|spread| spread.test(&all, &changes, CHANCE)),
        tip: TipDifference {
            is_corrected: corrected.is_some(),
            limit_m: limit_m.or(expected_m),
            limit_is_stated: limit_m.is_some(),
            ..tip
        },
        base_is_free,
    })
}

/// The joint by which two robots differ.
fn other_robot(a: &Robot, b: &Robot, error: Error) -> Error {
    if !a.is_serial() || !b.is_serial() {
        let message = "found a robot with branches, expected a serial chain: compare its calibrations by `poecal validate` on each other's rows";
        return ErrorKind::Option.error(message);
    }
    let refused = |words: String| ErrorKind::Option.error(format!("{words}: compare two calibrations of one robot"));
    let pairs = a.joints.iter().zip(&b.joints);
    for (k, (one, other)) in pairs.enumerate() {
        if one.name != other.name {
            let (k, found, expected) = (k + 1, &other.name, &one.name);
            return refused(format!(
                "found joint `{found}` at place {k} of the second calibration, expected `{expected}` as in the first"
            ));
        }
        if one.kind != other.kind {
            let (name, found, expected) = (&one.name, other.kind.word(), one.kind.word());
            return refused(format!(
                "found joint `{name}` as a {found} one in the second calibration, expected a {expected} one as in the first"
            ));
        }
    }
    if a.joints.len() != b.joints.len() {
        let (found, expected) = (b.joints.len(), a.joints.len());
        let names: BTreeSet<&str> = a.joints.iter().map(|it| it.name.as_str()).collect();
        let more = b.joints.iter().find(|it| !names.contains(it.name.as_str()));
        let more = more.map_or_else(String::new, |it| format!(" (`{}` is another)", it.name));
        return refused(format!(
            "found {found} joints in the second calibration{more}, expected {expected} as in the first"
        ));
    }
    error
}

/// Refuses models of different robots, whose joints have the same names.
fn check_nominal(a: &Robot, b: &Robot) -> Result<()> {
    for (one, other) in a.joints.iter().zip(&b.joints) {
        let (d, e) = (one.screw.direction(), other.screw.direction());
        let angle = d.cross(&e).norm().atan2(d.dot(&e));
        let origin = one.screw.nearest_point(&one.frame.translation);
        let away = match one.kind {
            JointKind::Revolute => (other.screw.nearest_point(&origin) - origin).norm(),
            JointKind::Prismatic => 0.0,
        };
        if angle > OTHER_RAD || away > OTHER_M {
            let (name, mm, deg) = (&one.name, 1e3 * away, angle.to_degrees());
            return ErrorKind::Option.refuse(format!(
                "found the nominal axis of joint `{name}` {mm:.1} mm and {deg:.2} deg from that of the first calibration, expected one robot: \
                 compare two calibrations of one robot"
            ));
        }
    }
    Ok(())
}

/// Difference of the tips over random configurations of the sampled range, base and tool of the second in the best fit to the first.
fn tips(sampled: &Robot, a: &Robot, b: &Robot, base_is_free: bool) -> TipDifference {
    let mut generator = ChaCha8Rng::seed_from_u64(SEED);
    let b = with_tool_of(a, b).unwrap_or_else(|| b.clone());
    let readings: Vec<Vec<f64>> = (0..CONFIGURATIONS).map(|_| random_configuration(sampled, &mut generator)).collect();
    let pairs: Vec<(Pose, Pose)> =
        readings.iter().map(|q| (b.forward_kinematics(q), a.forward_kinematics(q))).collect();
    // Points do not show the orientation of a tip: its position alone determines the base and the position of the tool.
    let (placed, taught) = (
        TaughtFrames::of_places(&pairs, !base_is_free),
        TaughtFrames::from_tips(&pairs, a.arm_m() / 3.0, !base_is_free),
    );
    let differences = pairs.iter().map(|(b, a)| {
        let turn = rotation::log(&(taught.tip(b).rotation * a.rotation.transpose())).norm();
        ((placed.tip(b).translation - a.translation).norm(), turn)
    });
    let differences: Vec<(f64, f64)> = differences.collect();
    let rms = |of: fn(&(f64, f64)) -> f64| {
        let sum: f64 = differences.iter().map(|it| of(it).powi(2)).sum();
        (sum / differences.len().max(1) as f64).sqrt()
    };
    let worst = differences.iter().enumerate().max_by(|x, y| x.1.0.total_cmp(&y.1.0)).map_or(0, |(k, _)| k);
    let at = readings.get(worst).cloned().unwrap_or_default();
    TipDifference {
        configurations: differences.len(),
        rms_m: rms(|it| it.0),
        max_m: differences.get(worst).map_or(0.0, |it| it.0),
        rms_rad: rms(|it| it.1),
        max_at: a.reading_names().into_iter().zip(at).collect(),
        max_place: pairs.get(worst).map_or_else(Vector3::zeros, |(_, a)| a.translation),
        is_corrected: false,
        limit_m: None,
        limit_is_stated: false,
    }
}
