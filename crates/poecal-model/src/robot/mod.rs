//! Robots: a chain or a tree of joints with screws, a home pose, forward kinematics. Estimation and files are elsewhere.
//!
//! [`Robot`] is a tree of joints, a serial chain by default, with the bodies of instruments and targets (`body.rs`). Errors of joints beyond
//! geometry are more joints, or terms of their values: a link that tilts is a joint without a reading (`compliance.rs`), and moments of weights are in
//! `statics.rs`. Unknowns and measured data are elsewhere.

mod arm;
mod body;
mod compliance;
mod controller;
mod correction_model;
mod corrections;
mod dh;
mod factor;
mod gravity;
mod joint;
mod kinematics;
mod reading_kind;
mod sizes;
mod statics;
mod term;
mod zeros;

pub use body::{Body, MEASURED, Mount};
pub use compliance::CompliantDirections;
pub use controller::{Controller, ControllerColumn, ControllerMap, ControllerReading, ThirdAxis, level, sum_words};
pub use correction_model::{CorrectionExtent, CorrectionModel};
pub use corrections::Corrections;
pub use dh::{DhRow, DhTableConvention};
pub use factor::FactorReading;
pub use gravity::{Gravity, GravityDirection, Mass, Weight};
pub use joint::{Joint, JointKind, JointLimits, Reading, Tolerance};
pub use poecal_arm::{Term, TermArgument, TermFunction, TermGroup, TermKind};
pub use reading_kind::ReadingKind;
pub use sizes::Sizes;
pub use statics::{Moments, Statics};
pub use term::{JointTerm, Situation, TermFunctions};

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector3;

use poecal_arm::lie::{Pose, Screw};
use poecal_numerics::error::{ErrorKind, Result};

/// Largest number of moving joints of a robot: the time of a fit grows with the cube of their number.
pub const MOST_JOINTS: usize = 1000;
/// Largest number of letters in the name of a joint or a target.
pub const LONGEST_NAME: usize = 200;

/// A robot at its zero configuration, `base_from_tip(θ) = exp(ξ₁θ₁) … exp(ξₙθₙ) M` over the joints between base and tip (lou2009 (2);
/// theory.md §2 (6)). It is a serial chain, or a tree if joints are on other links than that of the joint before.
///
/// All screws and frames are in the base frame. A robot is a value: forward kinematics changes nothing in it.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_arm::lie;
/// #     pub use poecal_model::robot::{Joint, Robot};
/// # }
/// use poecal::lie::{Pose, Screw};
/// use poecal::{Joint, Robot};
/// use nalgebra::Vector3;
/// let joint = Joint::revolute("shoulder", Screw::revolute(&Vector3::z(), &Vector3::zeros()));
/// let robot = Robot::new("one_axis", vec![joint], Pose::from_translation(Vector3::new(0.5, 0.0, 0.0)))?;
/// let tip = robot.forward_kinematics(&[std::f64::consts::FRAC_PI_2]);
/// assert!((tip.translation - Vector3::new(0.0, 0.5, 0.0)).norm() < 1e-15);
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Robot {
    /// The robot's name.
    pub name: String,
    /// Name of the base frame (URDF: the chain's first link).
    pub base_name: String,
    /// Name of the tip frame (URDF: the chain's last link).
    pub tip_name: String,
    /// Moving joints from base to tip, each after the joint that carries it on its link.
    pub joints: Vec<Joint>,
    /// Body of the tip, if it is not the last joint's link.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tip: Option<Body>,
    /// Home pose `M = base_from_tip(0)`.
    pub home: Pose,
    /// Tool points and frames of the model, in the tip frame.
    pub targets: Vec<(String, Pose)>,
    /// Targets on other bodies, or with other frames than the tip's.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mounted: Vec<Mount>,
    /// Terms of the joints' values beyond their readings.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub terms: Vec<JointTerm>,
    /// Gravity and the weights that bend the robot, if terms depend on them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gravity: Option<Gravity>,
    /// Masses of the model's links, if it states them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub masses: Vec<Mass>,
    /// Other readings of each configuration on which terms depend: readings of no joint, after those of the joints.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub factors: Vec<FactorReading>,
    /// Instruments on the robot; all others are beside it, on its base.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub instruments: Vec<Mount>,
}

impl Robot {
    /// A robot of its joints and home pose `base_from_tip` at zero joint values, with frames named `base` and `tip`.
    ///
    /// # Errors
    /// [`ErrorKind::Model`] if there is no joint, there are more than [`MOST_JOINTS`], two joints share a name, or a name is longer
    /// than [`LONGEST_NAME`].
    pub fn new(name: &str, joints: Vec<Joint>, home: Pose) -> Result<Self> {
        let error = |message: String| ErrorKind::Model.refuse(message);
        if joints.is_empty() {
            return error(format!(
                "robot `{name}` has no moving joint, expected at least one revolute, continuous or prismatic joint"
            ));
        }
        if joints.len() > MOST_JOINTS {
            return error(format!(
                "robot `{name}` has {} moving joints, expected at most {MOST_JOINTS}: choose a shorter chain",
                joints.len()
            ));
        }
        let mut names = BTreeSet::new();
        for joint in &joints {
            check_name(&joint.name, "joint")?;
            check_name(&joint.reading.name, "joint")?;
            if !names.insert(joint.name.as_str()) {
                return error(format!("robot `{name}` has two joints named `{}`, expected unique names", joint.name));
            }
        }
        Ok(Robot {
            name: name.to_owned(),
            base_name: "base".to_owned(),
            tip_name: "tip".to_owned(),
            joints,
            tip: None,
            home,
            targets: Vec::new(),
            mounted: Vec::new(),
            terms: Vec::new(),
            gravity: None,
            masses: Vec::new(),
            factors: Vec::new(),
            instruments: Vec::new(),
        })
    }

    /// Names of the mimic joints that follow a joint: an error of its encoder moves them too.
    #[must_use]
    pub fn followers(&self, joint: &str) -> Vec<&str> {
        let follows = |other: &&Joint| other.name != joint && other.reading.name == joint;
        self.joints.iter().filter(follows).map(|other| other.name.as_str()).collect()
    }

    /// Index of the joint that a mimic joint follows; `None` for a joint with a reading of its own.
    #[must_use]
    pub fn leader(&self, joint: &Joint) -> Option<usize> {
        let is_leader = |other: &Joint| other.name == joint.reading.name;
        self.joints.iter().position(|other| is_leader(other) && other.name != joint.name)
    }

    /// The same robot with further factors.
    ///
    /// # Errors
    /// [`ErrorKind::Option`] if two readings have one name, or a name is longer than [`LONGEST_NAME`].
    pub fn with_factors(&self, names: &[String]) -> Result<Self> {
        let mut robot = self.clone();
        for name in names {
            check_name(name, "factor")?;
            if robot.joints.iter().any(|joint| joint.name == *name) || robot.reading_names().contains(name) {
                return ErrorKind::Option.refuse(format!(
                    "found the factor `{name}`, expected a name that no joint and no other factor has"
                ));
            }
            robot.factors.push(FactorReading::new(name));
        }
        Ok(robot)
    }

    /// Names of the readings that a configuration consists of, in order: each joint's own, once; a mimic joint has its leader's. The
    /// factors follow.
    #[must_use]
    pub fn reading_names(&self) -> Vec<String> {
        let mut known = BTreeSet::new();
        let names = self.joints.iter().map(|joint| &joint.reading.name);
        names
            .filter(|name| known.insert(name.as_str()))
            .chain(self.factors.iter().map(|it| &it.name))
            .cloned()
            .collect()
    }

    /// Names of the readings of joints alone.
    #[must_use]
    pub fn joint_reading_names(&self) -> Vec<String> {
        let mut names = self.reading_names();
        names.truncate(names.len() - self.factors.len());
        names
    }

    /// Kind of a reading: that of the joint of its name, else of the first joint that follows it; without a joint it is a factor.
    pub fn reading_kind(&self, name: &str) -> ReadingKind {
        let mut users = self.joints.iter().filter(|joint| joint.reading.name == name);
        let leader = users.clone().find(|joint| joint.name == name);
        leader.or_else(|| users.next()).map_or(ReadingKind::Factor, |joint| joint.kind.into())
    }

    /// Factors among the readings of a configuration.
    pub fn factors_of<'a>(&self, readings: &'a [f64]) -> &'a [f64] {
        readings.get(readings.len().saturating_sub(self.factors.len())..).unwrap_or_default()
    }

    /// Indices of the factors that are payloads.
    pub(crate) fn payloads(&self) -> impl Iterator<Item = usize> {
        self.factors.iter().enumerate().filter(|(_, it)| it.is_payload()).map(|(index, _)| index)
    }

    /// For each joint, the index of its reading in [`Robot::reading_names`].
    #[must_use]
    pub fn reading_indices(&self) -> Vec<usize> {
        let mut known: BTreeMap<&str, usize> = BTreeMap::new();
        let mut indices = Vec::with_capacity(self.joints.len());
        for joint in &self.joints {
            let next = known.len();
            indices.push(*known.entry(&joint.reading.name).or_insert(next));
        }
        indices
    }

    /// The same robot with other screws (one a joint). Each joint frame follows its axis by the smallest motion
    /// ([`Screw::smallest_motion_to`] relative to the frame's origin); that of a compliant joint stays with its joint's. Home pose and
    /// targets stay.
    #[must_use]
    pub fn with_screws(&self, screws: &[Screw]) -> Self {
        let mut robot = self.clone();
        for (joint, screw) in robot.joints.iter_mut().zip(screws) {
            let motion = joint.screw.smallest_motion_to(screw, &joint.frame.translation);
            joint.frame = (motion * joint.frame).orthonormalized();
            joint.screw = *screw;
        }
        for index in 0..robot.joints.len() {
            if let Some(of) = robot.joints[index].give_of.and_then(|of| robot.joints.get(of)) {
                robot.joints[index].frame = of.frame;
            }
        }
        robot
    }

    /// Pose of the tip frame in the frame of the joint that moves it, at any configuration.
    #[must_use]
    pub fn last_joint_from_tip(&self) -> Pose {
        match self.tip_body().joint().and_then(|joint| self.joints.get(joint)) {
            Some(joint) => joint.frame.inverse() * self.home,
            None => self.home,
        }
    }

    /// Size of the arm (metres): the longest path from axis to axis to the tip at zero joint values, at least 1 cm. In a tree it is the
    /// longest to the tip, a target or an instrument.
    #[must_use]
    pub fn arm_m(&self) -> f64 {
        let mounts = self.mounted.iter().chain(&self.instruments);
        let ends = mounts
            .filter(|mount| mount.body != Body::Base)
            .map(|mount| (mount.body, self.base_from(mount).translation));
        let paths = std::iter::once((self.tip_body(), self.home.translation)).chain(ends);
        paths.map(|(body, end)| self.path_m(body, &end)).fold(0.01, f64::max)
    }

    /// Length of the path from the first axis between base and body, from axis to axis, to a point of the body (metres).
    fn path_m(&self, body: Body, end: &Vector3<f64>) -> f64 {
        let mut at: Option<Vector3<f64>> = None;
        let mut reach = 0.0;
        let joints = self.joints_to(body).into_iter().filter_map(|joint| self.joints.get(joint));
        for joint in joints.filter(|joint| joint.kind == JointKind::Revolute) {
            let from = at.unwrap_or(joint.frame.translation);
            let next = joint.screw.nearest_point(&from);
            reach += (next - from).norm();
            at = Some(next);
        }
        reach + (end - at.unwrap_or_else(Vector3::zeros)).norm()
    }

    /// Reach of the robot (metres): size of the arm plus the strokes of its prismatic joints. Limits wider than 100 m are placeholders and
    /// do not count.
    #[must_use]
    pub fn reach_m(&self) -> f64 {
        let slides: f64 = self
            .joints
            .iter()
            .filter(|joint| joint.kind == JointKind::Prismatic)
            .filter_map(|joint| joint.limits)
            .map(|limits| limits.upper - limits.lower)
            .filter(|span| *span < JointLimits::PLACEHOLDER_M)
            .sum();
        self.arm_m() + slides
    }
}

impl Robot {
    /// Statement that the limits of the joints are placeholders: all revolute joints have the same, and more than a turn to either side.
    #[must_use]
    pub fn placeholder_limits(&self) -> Option<String> {
        let turning = self.joints.iter().filter(|joint| joint.kind == JointKind::Revolute);
        let limits: Vec<JointLimits> = turning.map(|joint| joint.limits).collect::<Option<_>>()?;
        let first = *limits.first().filter(|_| limits.len() > 2)?;
        let is_wide = first.lower < -JointLimits::TURN_RAD && first.upper > JointLimits::TURN_RAD;
        (is_wide && limits.iter().all(|it| *it == first)).then(|| {
            format!(
                "every joint has the limits {:.0} to {:.0} deg, which are placeholders: state the limits of the robot in the model",
                first.lower.to_degrees(),
                first.upper.to_degrees()
            )
        })
    }

    /// Readings of joints that turn by more than one turn within their limits.
    #[must_use]
    pub fn readings_beyond_a_turn(&self) -> Vec<String> {
        let is_beyond = |name: &String| {
            let mut own = self.joints.iter().filter(|joint| joint.reading.name == *name);
            own.any(|joint| {
                let span = joint.limits.map_or(0.0, |it| it.upper - it.lower);
                joint.kind == JointKind::Revolute && span > JointLimits::TURN_RAD
            })
        };
        self.reading_names().iter().filter(|name| is_beyond(name)).cloned().collect()
    }
}

/// Refuses a name that is too long for messages and tables.
///
/// # Errors
/// [`ErrorKind::Model`] if it has more letters than [`LONGEST_NAME`].
pub fn check_name(name: &str, of: &str) -> Result<()> {
    // Letters are counted only if the name has too many bytes.
    if name.len() <= LONGEST_NAME || name.chars().count() <= LONGEST_NAME {
        return Ok(());
    }
    let letters = name.chars().count();
    ErrorKind::Model
        .refuse(format!("found the {of} `{name}`, whose name has {letters} letters, expected at most {LONGEST_NAME}"))
}

#[cfg(test)]
pub(crate) mod tests {
    use nalgebra::Vector3;

    use super::*;

    /// The elbow of [`simulate`](crate::simulate) without limits, for tests of modules that may not name that one.
    pub(crate) fn elbow() -> Robot {
        let axes = [
            (Vector3::z(), [0.0, 0.0, 0.0]),
            (Vector3::y(), [0.15, 0.0, 0.0]),
            (-Vector3::y(), [0.15, 0.0, 0.57]),
            (-Vector3::x(), [0.15, 0.0, 0.72]),
            (Vector3::y(), [0.784, 0.0, 0.72]),
            (-Vector3::x(), [0.784, 0.0, 0.72]),
        ];
        let joint = |(index, (direction, point)): (usize, (Vector3<f64>, [f64; 3]))| {
            Joint::revolute(&format!("joint{}", index + 1), Screw::revolute(&direction, &point.into()))
        };
        let joints = axes.into_iter().enumerate().map(joint).collect();
        Robot::new("elbow", joints, Pose::from_translation(Vector3::new(0.834, 0.0, 0.72))).unwrap()
    }

    #[test]
    fn a_reading_is_of_the_kind_of_the_joint_of_its_name() {
        let mut slide = Joint::prismatic("slide", Screw::prismatic(&Vector3::z()));
        slide.reading = Reading { name: "drive".to_owned(), multiplier: 0.01, offset: 0.0 };
        let drive = Joint::revolute("drive", Screw::revolute(&Vector3::z(), &Vector3::zeros()));
        let robot = Robot::new("r", vec![slide, drive], Pose::identity()).unwrap();
        assert_eq!(robot.reading_kind("drive"), ReadingKind::Angle);
    }
}
