//! Model of an arm: joints, their values by readings, and their compliance under weight.

use alloc::vec::Vec;

use nalgebra::Vector3;

use crate::arm_state::MOST_JOINTS;
use crate::lie::{Pose, Screw};
use crate::terms::Term;

/// A serial arm as calibration estimates it: `base_from_tip(q) = exp(ξ₁θ₁(q)) … exp(ξₘθₘ(q)) M` with n readings q and joint values θ that
/// are functions of them ([`JointValue`]). Joints without a reading are compliances of links.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmModel {
    /// Number of readings n.
    pub readings: usize,
    /// Joints from the base to the tip.
    pub joints: Vec<ModelJoint>,
    /// Tip in the base with all joint values at 0.
    pub home: Pose,
    /// Direction of gravity, base frame, of length 1.
    pub gravity: Vector3<f64>,
    /// Nominal arm, by which moments of weights are computed.
    pub drawing: Vec<NominalJoint>,
    /// Smallest and largest value of each reading (rad, m), if it has limits.
    pub limits: Vec<Option<(f64, f64)>>,
}

impl ArmModel {
    /// An arm without joints.
    #[must_use]
    pub fn new(readings: usize, home: &Pose) -> Self {
        ArmModel {
            readings,
            joints: Vec::new(),
            home: *home,
            gravity: Vector3::zeros(),
            drawing: Vec::new(),
            limits: Vec::new(),
        }
    }
}

/// A joint and its value.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelJoint {
    /// Screw in the base with all joint values at 0.
    pub screw: Screw,
    /// Value.
    pub value: JointValue,
}

/// A joint's value (rad, m) as a function of the readings: `θ = c + Σ fᵢ qᵢ + Σ waves + moments + Σ curves`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointValue {
    /// Value with all readings at 0.
    pub constant: f64,
    /// Readings, and the joint's value per unit of each.
    pub linear: Vec<(usize, f64)>,
    /// Periodic parts.
    pub waves: Vec<Wave>,
    /// Compliance under weights.
    pub pull: Option<GravityTorque>,
    /// Other functions.
    pub curves: Vec<TermCurve>,
}

impl JointValue {
    /// Value of a joint that turns by its reading.
    #[must_use]
    pub fn from_reading(reading: usize) -> Self {
        JointValue { linear: [(reading, 1.0)].to_vec(), ..JointValue::default() }
    }

    pub(crate) fn is_reading(&self, reading: usize) -> bool {
        self.constant == 0.0
            && self.linear == [(reading, 1.0)]
            && self.waves.is_empty()
            && self.pull.is_none()
            && self.curves.is_empty()
    }
}

/// A periodic part of a joint's value, `a cos kφ + b sin kφ` with `φ = f q + φ₀`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Index of the reading q.
    pub reading: usize,
    /// Factor f.
    pub factor: f64,
    /// Angle φ₀, rad.
    pub offset: f64,
    /// Order k.
    pub order: f64,
    /// Amplitude a (rad, m).
    pub cosine: f64,
    /// Amplitude b (rad, m).
    pub sine: f64,
}

/// A part of a joint's value that is another function of the table of terms ([`crate::TermKind`]), `k b(x)` with `x = c + Σ fᵢ qᵢ + moments`.
#[derive(Clone, Debug, PartialEq)]
pub struct TermCurve {
    /// Term with the function b.
    pub term: Term,
    /// Coefficient k (rad, m).
    pub coefficient: f64,
    /// Argument with all readings at 0.
    pub constant: f64,
    /// Readings, and the argument per unit of each.
    pub linear: Vec<(usize, f64)>,
    /// Moments in the argument, of weights by their part of it.
    pub pull: Option<GravityTorque>,
}

/// Deflection of a joint under weights: `Σ z·((p - o) × ĝ)` with the axis z through o; a weight at p counts by the rotation of the joint per
/// metre of lever. For a prismatic joint it is `Σ z·ĝ`. All positions are those of the nominal arm.
#[derive(Clone, Debug, PartialEq)]
pub struct GravityTorque {
    /// Number of the nominal joints before it.
    pub after: usize,
    /// True if it is prismatic.
    pub slides: bool,
    /// Direction z of its axis, base frame at zero.
    pub direction: Vector3<f64>,
    /// Point o of its axis.
    pub place: Vector3<f64>,
    /// Weights.
    pub weights: Vec<PulledWeight>,
}

/// A weight: the rotation of the joint for each metre of lever (for a prismatic joint, the translation), and the position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PulledWeight {
    /// Number of the nominal joints that carry it.
    pub after: usize,
    /// Rotation of the joint, rad/m (for a prismatic joint m).
    pub size: f64,
    /// Position p, base frame at zero.
    pub place: Vector3<f64>,
}

/// A joint of the nominal arm, whose value is `f q + c`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NominalJoint {
    /// Screw in the base at zero.
    pub screw: Screw,
    /// Index of its reading.
    pub reading: usize,
    /// Factor f.
    pub factor: f64,
    /// Constant c (rad, m).
    pub constant: f64,
}

impl ArmModel {
    /// True if all numbers are finite and all indices are valid.
    pub(crate) fn is_whole(&self) -> bool {
        let finite = |v: &Vector3<f64>| v.iter().all(|it| it.is_finite());
        let screw = |it: &Screw| finite(&it.v()) && finite(&it.w());
        let reading = |it: usize| it < self.readings;
        let drawn = |it: &NominalJoint| {
            screw(&it.screw) && reading(it.reading) && it.factor.is_finite() && it.constant.is_finite()
        };
        let wave = |it: &Wave| {
            reading(it.reading) && [it.factor, it.offset, it.order, it.cosine, it.sine].iter().all(|it| it.is_finite())
        };
        let weight = |it: &PulledWeight| it.after <= self.drawing.len() && it.size.is_finite() && finite(&it.place);
        let pull = |it: &GravityTorque| {
            it.after <= self.drawing.len()
                && finite(&it.direction)
                && finite(&it.place)
                && it.weights.iter().all(weight)
        };
        let linear = |it: &(usize, f64)| reading(it.0) && it.1.is_finite();
        let curve = |it: &TermCurve| {
            it.coefficient.is_finite()
                && it.constant.is_finite()
                && it.linear.iter().all(linear)
                && it.pull.iter().all(pull)
        };
        let joint = |it: &ModelJoint| {
            screw(&it.screw)
                && it.value.constant.is_finite()
                && it.value.linear.iter().all(linear)
                && it.value.waves.iter().all(wave)
                && it.value.pull.iter().all(pull)
                && it.value.curves.iter().all(curve)
        };
        (1..=MOST_JOINTS).contains(&self.readings)
            && self.drawing.len() <= MOST_JOINTS
            && !self.joints.is_empty()
            && self.joints.iter().all(joint)
            && self.drawing.iter().all(drawn)
            && finite(&self.gravity)
            && self.home.rotation.iter().all(|it| it.is_finite())
            && finite(&self.home.translation)
            && self.limits.len() <= self.readings
    }
}
