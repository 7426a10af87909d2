//! What an arm is made of: joints, what each reading turns them, and what they give under weight.

use alloc::vec::Vec;

use nalgebra::Vector3;

use crate::lie::{Pose, Screw};
use crate::placed::MOST_JOINTS;
use crate::terms::Term;

/// A serial arm as calibration finds it: `base_from_tip(q) = exp(ξ₁θ₁(q)) … exp(ξₘθₘ(q)) M` with n readings q and joint values θ that are
/// functions of them ([`JointValue`]). Joints that no reading turns are places where links give.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Number of readings n.
    pub readings: usize,
    /// Joints from the base to the tip.
    pub joints: Vec<Joint>,
    /// The tip in the base where all joint values are 0.
    pub home: Pose,
    /// Direction in which weights are pulled, base frame, of length 1.
    pub gravity: Vector3<f64>,
    /// The arm by which moments of weights are counted.
    pub drawing: Vec<Drawn>,
    /// Smallest and largest value of each reading (rad, m), of those that have such.
    pub limits: Vec<Option<(f64, f64)>>,
}

impl Model {
    /// An arm without joints.
    #[must_use]
    pub fn new(readings: usize, home: &Pose) -> Self {
        Model {
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
pub struct Joint {
    /// Its screw in the base where all joint values are 0.
    pub screw: Screw,
    /// Its value.
    pub value: JointValue,
}

/// A joint's value (rad, m) as a function of the readings: `θ = c + Σ fᵢ qᵢ + Σ waves + moments + Σ curves`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointValue {
    /// What it has where all readings are 0.
    pub constant: f64,
    /// Readings, and the joint's value per unit of each.
    pub linear: Vec<(usize, f64)>,
    /// Periodic parts.
    pub waves: Vec<Wave>,
    /// What it gives under weights.
    pub pull: Option<Pull>,
    /// Other functions.
    pub curves: Vec<Curve>,
}

impl JointValue {
    /// The value of a joint that turns by its reading.
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
pub struct Curve {
    /// The term with the function b.
    pub term: Term,
    /// Its coefficient k (rad, m).
    pub coefficient: f64,
    /// The argument where all readings are 0.
    pub constant: f64,
    /// Readings, and the argument per unit of each.
    pub linear: Vec<(usize, f64)>,
    /// The moments in the argument, of weights by their part of it.
    pub pull: Option<Pull>,
}

/// What a joint gives under weights: `Σ z·((p - o) × ĝ)` with the axis z through o, where weights at p are counted by what they turn the joint
/// per metre of lever; of a prismatic joint `Σ z·ĝ`. All places are those of the drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Pull {
    /// Number of the drawing's joints before it.
    pub after: usize,
    /// Whether it slides.
    pub slides: bool,
    /// Direction z of its axis, base frame at zero.
    pub direction: Vector3<f64>,
    /// Point o of its axis.
    pub place: Vector3<f64>,
    /// Weights.
    pub weights: Vec<PulledWeight>,
}

/// A weight: what it turns the joint for each metre of lever (of a prismatic joint, what it slides it), and where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PulledWeight {
    /// Number of the drawing's joints that carry it.
    pub after: usize,
    /// What it turns the joint, rad/m (of a prismatic joint m).
    pub size: f64,
    /// Its place p, base frame at zero.
    pub place: Vector3<f64>,
}

/// A joint of the drawing, whose value is `f q + c`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drawn {
    /// Its screw in the base at zero.
    pub screw: Screw,
    /// Index of its reading.
    pub reading: usize,
    /// Factor f.
    pub factor: f64,
    /// Constant c (rad, m).
    pub constant: f64,
}

impl Model {
    /// Whether all numbers are finite and all indices are of something that is there.
    pub(crate) fn is_whole(&self) -> bool {
        let finite = |v: &Vector3<f64>| v.iter().all(|it| it.is_finite());
        let screw = |it: &Screw| finite(&it.v()) && finite(&it.w());
        let reading = |it: usize| it < self.readings;
        let drawn = |it: &Drawn| {
            screw(&it.screw) && reading(it.reading) && it.factor.is_finite() && it.constant.is_finite()
        };
        let wave = |it: &Wave| {
            reading(it.reading)
                && [it.factor, it.offset, it.order, it.cosine, it.sine].iter().all(|it| it.is_finite())
        };
        let weight =
            |it: &PulledWeight| it.after <= self.drawing.len() && it.size.is_finite() && finite(&it.place);
        let pull = |it: &Pull| {
            it.after <= self.drawing.len()
                && finite(&it.direction)
                && finite(&it.place)
                && it.weights.iter().all(weight)
        };
        let linear = |it: &(usize, f64)| reading(it.0) && it.1.is_finite();
        let curve = |it: &Curve| {
            it.coefficient.is_finite()
                && it.constant.is_finite()
                && it.linear.iter().all(linear)
                && it.pull.iter().all(pull)
        };
        let joint = |it: &Joint| {
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
