//! Arms whose joint values are more than their readings: the part that does not depend on the configuration.

use alloc::vec::Vec;

use nalgebra::Vector3;

use crate::arm_state::frame_on_axis;
use crate::lie::Pose;
use crate::model::{ArmModel, GravityTorque, JointValue, NominalJoint, TermCurve, Wave};
use crate::terms::Term;

/// A chain of joints, with quantities that do not depend on the configuration.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RealChain {
    pub(crate) links: Vec<RealJoint>,
    pub(crate) tip: Pose,
    pub(crate) readings: usize,
    /// True if values depend on cosines and sines of the readings.
    pub(crate) has_functions: bool,
    /// True if they depend on moments of weights.
    pub(crate) has_moments: bool,
    pub(crate) drawing: Vec<(Pose, NominalJoint)>,
    pub(crate) gravity: Vector3<f64>,
}

/// A joint: its frame, and its value as in a [`JointValue`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RealJoint {
    /// Frame, the axis along z, in that of the link before.
    pub(crate) frame: Pose,
    pub(crate) slides: bool,
    pub(crate) own: ReadingSum,
    pub(crate) waves: Vec<Wave>,
    /// Other functions of sums, with their coefficients.
    pub(crate) curves: Vec<(Term, f64, ReadingSum)>,
}

/// A sum of a constant, of readings and of a moment.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ReadingSum {
    pub(crate) constant: f64,
    pub(crate) linear: Vec<(usize, f64)>,
    pub(crate) moment: Option<Moment>,
}

impl ReadingSum {
    fn new(constant: f64, linear: &[(usize, f64)], pull: Option<&GravityTorque>, from_base: &[Pose]) -> Self {
        let moment = pull.map(|pull| Moment::new(pull, from_base));
        ReadingSum { constant, linear: linear.to_vec(), moment }
    }
}

/// A [`GravityTorque`] with the weights of each body joined.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Moment {
    pub(crate) after: usize,
    pub(crate) slides: bool,
    pub(crate) direction: Vector3<f64>,
    pub(crate) place: Vector3<f64>,
    /// Number of joints that carry them, sum of sizes, and of sizes times positions.
    pub(crate) weights: Vec<(usize, f64, Vector3<f64>)>,
}

impl Moment {
    fn new(pull: &GravityTorque, from_base: &[Pose]) -> Self {
        let mut weights: Vec<(usize, f64, Vector3<f64>)> = Vec::new();
        for weight in &pull.weights {
            let place = from_base[weight.after].act(&weight.place) * weight.size;
            match weights.iter_mut().find(|it| it.0 == weight.after) {
                Some(it) => {
                    it.1 += weight.size;
                    it.2 += place;
                }
                None => weights.push((weight.after, weight.size, place)),
            }
        }
        let from_base = &from_base[pull.after];
        Moment {
            after: pull.after,
            slides: pull.slides,
            direction: from_base.rotation * pull.direction,
            place: from_base.act(&pull.place),
            weights,
        }
    }
}

/// Angle below which a few terms of the series are exact.
pub(crate) const SMALL: f64 = 0.05;

/// `(cos, sin)` of a small angle, such as that of a compliant joint.
#[inline(always)]
pub(crate) fn small_turn(angle: f64) -> (f64, f64) {
    let z = angle * angle;
    let cosine = 1.0 - z * (0.5 - z * (1.0 / 24.0 - z * (1.0 / 720.0 - z / 40320.0)));
    let sine = angle * (1.0 - z * (1.0 / 6.0 - z * (1.0 / 120.0 - z * (1.0 / 5040.0 - z / 362_880.0))));
    (cosine, sine)
}

/// True if a wave is of the reading itself.
pub(crate) fn is_plain(wave: &Wave) -> bool {
    wave.factor == 1.0 && wave.offset == 0.0
}

impl RealChain {
    /// The chain of a model that is whole.
    pub(crate) fn new(model: &ArmModel) -> Self {
        let mut before = Pose::identity();
        let mut from_base = Vec::with_capacity(model.drawing.len() + 1);
        from_base.push(before);
        let mut drawing = Vec::with_capacity(model.drawing.len());
        for drawn in &model.drawing {
            let frame = frame_on_axis(&drawn.screw, &before.translation);
            drawing.push((before.inverse() * frame, *drawn));
            from_base.push(frame.inverse());
            before = frame;
        }
        let mut before = Pose::identity();
        let mut links: Vec<RealJoint> = Vec::with_capacity(model.joints.len());
        for joint in model.joints.iter().filter(|joint| joint.value != JointValue::default()) {
            let frame = frame_on_axis(&joint.screw, &before.translation);
            let JointValue { constant, linear, waves, pull, curves } = &joint.value;
            let curve = |it: &TermCurve| {
                (it.term, it.coefficient, ReadingSum::new(it.constant, &it.linear, it.pull.as_ref(), &from_base))
            };
            links.push(RealJoint {
                frame: before.inverse() * frame,
                slides: joint.screw.is_prismatic(),
                own: ReadingSum::new(*constant, linear, pull.as_ref(), &from_base),
                waves: waves.clone(),
                curves: curves.iter().map(curve).collect(),
            });
            before = frame;
        }
        let tip = before.inverse() * model.home;
        let pulls = |it: &RealJoint| it.own.moment.is_some() || it.curves.iter().any(|(.., of)| of.moment.is_some());
        let has_moments = links.iter().any(pulls);
        let has_functions = has_moments || links.iter().any(|it| !it.waves.is_empty());
        let (readings, gravity) = (model.readings, model.gravity);
        RealChain { links, tip, readings, has_functions, has_moments, drawing, gravity }
    }
}
