//! A calibration with one joint recalibrated by a few measurements.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector, Matrix6};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::prediction_uncertainty::symmetric_from_upper;
use super::{CalibrationFile, PoseEntry, UncertaintyEntry};
use poecal_arm::lie::{Pose, Twist};
use poecal_fit::parameters::Parameter;
use poecal_model::offsets::into_screws;
use poecal_model::robot::{Joint, JointKind, Robot};
use poecal_numerics::error::{ErrorKind, Result};

/// The part of a joint that was recalibrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RepairedPart {
    /// Its zero.
    Zero,
    /// Its axis.
    Axis,
}

impl RepairedPart {
    /// The joint and the part of it that a text names: `joint2` and `joint2.offset` its zero, `joint2.axis` its axis.
    ///
    /// ```
    /// use poecal_results::calibration_file::RepairedPart;
    /// assert_eq!(RepairedPart::from_name("joint2.axis"), ("joint2", RepairedPart::Axis));
    /// assert_eq!(RepairedPart::from_name("joint2"), ("joint2", RepairedPart::Zero));
    /// ```
    #[must_use]
    pub fn from_name(text: &str) -> (&str, RepairedPart) {
        match text.rsplit_once('.') {
            Some((joint, "axis")) => (joint, RepairedPart::Axis),
            Some((joint, "offset")) => (joint, RepairedPart::Zero),
            _ => (text, RepairedPart::Zero),
        }
    }
}

/// A joint that was recalibrated; everything else is as in the earlier calibration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RecalibratedEntry {
    /// The joint.
    pub joint: String,
    /// Its recalibrated part.
    pub part: RepairedPart,
    /// Change of its zero, degrees; for a joint that slides, millimetres. For an axis its turn, degrees.
    pub size: f64,
    /// Standard deviation of that.
    pub sigma: f64,
    /// Motion of the axis in the base's axes, and for a zero of all that follows the joint: metres and radians, linear part first.
    pub motion: [f64; 6],
    /// Number of measurements.
    pub rows: usize,
    /// Number of measurements that repeat configurations of earlier ones.
    pub repeated: usize,
    /// The measurement files.
    pub measurements: Vec<String>,
    /// The earlier calibration.
    pub calibration: String,
    /// SHA-256 of each, by name.
    pub sha256: BTreeMap<String, String>,
}

/// Sources of a joint's recalibration: fields of [`RecalibratedEntry`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecalibrationSources {
    /// The measurement files.
    pub measurements: Vec<String>,
    /// The earlier calibration.
    pub calibration: String,
    /// SHA-256 of each, by name.
    pub sha256: BTreeMap<String, String>,
}

/// A change of one joint: coefficients of base twists, with their covariance.
#[derive(Clone, Debug, PartialEq)]
pub struct JointRepair {
    /// The joint's name.
    pub joint: String,
    /// The part of it that changes.
    pub part: RepairedPart,
    /// For a zero its shift, radians or metres; for an axis the coefficients.
    pub step: Vec<f64>,
    /// Base twists of an axis, each moved by one coefficient.
    pub twists: Vec<Twist>,
    /// Covariance of the step, row by row.
    pub covariance: Vec<f64>,
}

impl CalibrationFile {
    /// The same calibration with one joint changed: its zero, which moves all that follows it, or its axis alone. All other estimates keep their
    /// covariance, to which the uncertainty of the change is added.
    ///
    /// # Errors
    /// [`ErrorKind::Option`] if there is no such joint; [`ErrorKind::Model`] if the file holds no valid calibration.
    pub fn with_repair(&self, repair: &JointRepair, provenance: RecalibratedEntry) -> Result<Self> {
        let mut file = self.with_moved_models(repair, true)?;
        file.warnings.push(format!(
            "the {} of joint `{}` was calibrated anew by {} measurements: errors, corrections and coverage in this file are those of the calibration \
             before",
            match repair.part {
                RepairedPart::Zero => "zero",
                RepairedPart::Axis => "axis",
            },
            repair.joint,
            provenance.rows
        ));
        file.recalibrated.push(provenance);
        // Its changes of readings are those of the earlier robot.
        file.compensation = None;
        Ok(file)
    }

    /// The calibration from its own measurements: before joints were recalibrated.
    ///
    /// # Errors
    /// As [`CalibrationFile::with_repair`].
    pub fn before_repairs(&self) -> Result<Self> {
        let mut file = self.clone();
        for entry in self.recalibrated.iter().rev() {
            let [a, b, c, d, e, f] = entry.motion.map(|it| -it);
            let is_zero = entry.part == RepairedPart::Zero;
            let joint = file.joints.iter().find(|it| it.name == entry.joint);
            let turns = joint.is_none_or(|it| it.kind == JointKind::Revolute);
            let back = JointRepair {
                joint: entry.joint.clone(),
                part: entry.part,
                step: vec![if is_zero {
                    -if turns { entry.size.to_radians() } else { 1e-3 * entry.size }
                } else {
                    1.0
                }],
                twists: vec![Twist::from_vector(&[a, b, c, d, e, f].into())],
                covariance: vec![0.0],
            };
            file = file.with_moved_models(&back, false)?;
        }
        Ok(file)
    }

    /// Both models of the file, moved.
    fn with_moved_models(&self, repair: &JointRepair, with_covariance: bool) -> Result<Self> {
        let mut file = self.clone();
        ModelEntries::new(&mut file).move_joint(&self.robot()?, repair, self, with_covariance)?;
        if let (Some(corrected), Some(entry)) = (self.corrected_file(), file.corrected.as_deref_mut()) {
            let mut moved = corrected.clone();
            ModelEntries::new(&mut moved).move_joint(&corrected.robot()?, repair, &corrected, with_covariance)?;
            entry.joints = moved.joints;
            entry.robot = moved.robot;
            entry.uncertainty = moved.uncertainty;
        }
        Ok(file)
    }
}

/// The entries of a model that move.
struct ModelEntries<'a> {
    file: &'a mut CalibrationFile,
}

impl<'a> ModelEntries<'a> {
    fn new(file: &'a mut CalibrationFile) -> Self {
        ModelEntries { file }
    }

    fn move_joint(
        self,
        robot: &Robot,
        repair: &JointRepair,
        before: &CalibrationFile,
        with_covariance: bool,
    ) -> Result<()> {
        let Some(at) = robot.joints.iter().position(|joint| joint.name == repair.joint) else {
            let names: Vec<&str> =
                robot.joints.iter().filter(|it| it.give_of.is_none()).map(|it| it.name.as_str()).collect();
            return ErrorKind::Option.refuse(format!(
                "found joint `{}`, expected one of {}",
                repair.joint,
                poecal_numerics::error::first_few(&names)
            ));
        };
        let (moved, bodies) = match repair.part {
            RepairedPart::Zero => {
                let mut offsets = vec![0.0; robot.joints.len()];
                offsets[at] = repair.step.first().copied().unwrap_or_default();
                let moved = into_screws(robot, &offsets)?;
                let bodies = (0..robot.joints.len()).map(|joint| before_joint(robot, &moved, joint, at)).collect();
                (moved, bodies)
            }
            RepairedPart::Axis => with_axis(robot, at, repair),
        };
        for (entry, joint) in self.file.joints.iter_mut().zip(&moved.joints) {
            entry.screw = (&joint.screw).into();
            entry.base_from_joint = (&joint.frame).into();
        }
        self.file.robot.base_from_tip_at_zero = (&moved.home).into();
        let columns = if with_covariance { Some(columns(before, robot, at, repair)?) } else { None };
        let Some(entry) = self.file.uncertainty.as_mut() else { return Ok(()) };
        for (axis, body) in entry.axes.iter_mut().zip(&bodies) {
            *axis = PoseEntry::from(&(*body * axis.pose()?).orthonormalized());
        }
        if let Some(columns) = columns {
            add(entry, &columns, &repair.covariance);
        }
        Ok(())
    }
}

/// Motion of a joint's axis caused by a changed zero before it.
fn before_joint(robot: &Robot, moved: &Robot, joint: usize, changed: usize) -> Pose {
    if joint == changed {
        return Pose::identity();
    }
    (moved.joints[joint].frame * robot.joints[joint].frame.inverse()).orthonormalized()
}

/// The robot with an axis moved by base twists, and the motion of each axis; compliant joints of the joint move with it.
fn with_axis(robot: &Robot, at: usize, repair: &JointRepair) -> (Robot, Vec<Pose>) {
    let sum = repair
        .twists
        .iter()
        .zip(&repair.step)
        .fold(nalgebra::Vector6::zeros(), |sum, (twist, step)| sum + twist.to_vector() * *step);
    let motion = Pose::exp(&Twist::from_vector(&sum));
    let is_own = |index: usize, joint: &Joint| index == at || joint.give_of == Some(at);
    let screws: Vec<_> = robot
        .joints
        .iter()
        .enumerate()
        .map(|(index, joint)| if is_own(index, joint) { joint.screw.transform(&motion) } else { joint.screw })
        .collect();
    let bodies = robot.joints.iter().enumerate();
    let bodies = bodies.map(|(index, _)| if index == at { motion } else { Pose::identity() }).collect();
    (robot.with_screws(&screws), bodies)
}

/// Effect of each coefficient of a repair on the unknowns of the calibration.
fn columns(file: &CalibrationFile, robot: &Robot, at: usize, repair: &JointRepair) -> Result<DMatrix<f64>> {
    if file.uncertainty.is_none() {
        return Ok(DMatrix::zeros(0, repair.step.len()));
    }
    let (found, _) = file.uncertainty(&[])?;
    let own = robot.joints[at].screw.twist();
    let twists = match repair.part {
        RepairedPart::Zero => vec![own],
        RepairedPart::Axis => repair.twists.clone(),
    };
    let follows = |joint: usize| match repair.part {
        RepairedPart::Zero => joint != at && is_after(robot, joint, at),
        RepairedPart::Axis => joint == at,
    };
    let mut all = DMatrix::zeros(found.layout.dim(), twists.len());
    for (column, twist) in twists.iter().enumerate() {
        for (parameter, places) in found.layout.parameters() {
            let local: Vec<f64> = if let Parameter::ScrewAxis(axis) = parameter {
                if !follows(axis.joint) {
                    continue;
                }
                let inverse: Matrix6<f64> = found.estimate.base_from_axis[axis.joint].inverse().adjoint();
                let it = inverse * twist.to_vector();
                if axis.kind == JointKind::Revolute { vec![it[0], it[1], it[3], it[4]] } else { vec![it[3], it[4]] }
            } else if let Some((target, motions)) = parameter.target_motions() {
                let body = found.estimate.tree.targets().get(target).and_then(|body| body.joint());
                let is_carried = body.is_some_and(|joint| joint == at || is_after(robot, joint, at));
                if repair.part == RepairedPart::Axis || !is_carried {
                    continue;
                }
                let place = &found.estimate.base_from_target[target];
                let turn = place.rotation.transpose();
                let shift = turn * (twist.v + twist.w.cross(&place.translation));
                let angle = turn * twist.w;
                motions.iter().map(|&motion| if motion < 3 { shift[motion] } else { angle[motion - 3] }).collect()
            } else {
                continue;
            };
            for (value, &(place, scale)) in local.iter().zip(places) {
                all[(place, column)] = value * scale;
            }
        }
    }
    Ok(all)
}

/// True if a joint stands on the link of another, directly or through others.
fn is_after(robot: &Robot, joint: usize, of: usize) -> bool {
    let mut at = robot.body_before(joint).joint();
    while let Some(before) = at {
        if before == of {
            return true;
        }
        at = robot.body_before(before).joint().filter(|next| *next < before);
    }
    false
}

/// Adds the uncertainty of a repair to the covariances of an entry.
fn add(entry: &mut UncertaintyEntry, columns: &DMatrix<f64>, covariance: &[f64]) {
    let (n, k) = columns.shape();
    let added = columns * DMatrix::from_row_slice(k, k, covariance) * columns.transpose();
    let more = |upper: &mut Vec<f64>| {
        let whole = DMatrix::from_row_slice(n, n, &symmetric_from_upper(upper, n)) + &added;
        *upper = (0..n).flat_map(|i| (i..n).map(move |j| (i, j))).map(|at| whole[at]).collect();
    };
    more(&mut entry.covariance_m2);
    entry.covariance_outside_m2.iter_mut().for_each(more);
    entry.correlations = None;
}

impl JointRepair {
    /// The whole step as one motion of the base's axes.
    #[must_use]
    pub fn motion(&self, robot: &Robot) -> [f64; 6] {
        let sum = match self.part {
            RepairedPart::Zero => {
                let joint = robot.joints.iter().find(|joint| joint.name == self.joint);
                let step = self.step.first().copied().unwrap_or_default();
                joint.map_or_else(nalgebra::Vector6::zeros, |it| it.screw.twist().to_vector() * step)
            }
            RepairedPart::Axis => {
                let each = self.twists.iter().zip(&self.step);
                each.fold(nalgebra::Vector6::zeros(), |sum, (twist, step)| sum + twist.to_vector() * *step)
            }
        };
        sum.into()
    }

    /// Its size (radians, of the zero of a slide metres) and the standard deviation along it.
    #[must_use]
    pub fn size(&self) -> (f64, f64) {
        let k = self.step.len();
        if self.part == RepairedPart::Zero {
            let value = self.step.first().copied().unwrap_or_default();
            return (value, self.covariance.first().copied().unwrap_or_default().sqrt());
        }
        let turns: Vec<usize> = (0..k).filter(|at| self.twists[*at].w.norm() > 0.5).collect();
        let step = DVector::from_iterator(turns.len(), turns.iter().map(|at| self.step[*at]));
        let size = step.norm();
        let variance: f64 = turns
            .iter()
            .enumerate()
            .flat_map(|(i, a)| turns.iter().enumerate().map(move |(j, b)| (i, j, *a, *b)))
            .map(|(i, j, a, b)| step[i] * step[j] * self.covariance[a * k + b])
            .sum();
        (size, variance.max(0.0).sqrt() / size.max(f64::MIN_POSITIVE))
    }
}
