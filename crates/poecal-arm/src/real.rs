//! Forward kinematics of arms whose joint values are more than their readings.

use alloc::vec::Vec;

use nalgebra::{Matrix3, Vector3};

use crate::lie::Pose;
use crate::model::{Drawn, JointValue, Model, Pull, Wave};
use crate::placed::{MOST_JOINTS, Placed, along, turn_by};
use crate::trig::cosine_and_sine;

/// A chain of joints, with what does not depend on the configuration.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Real {
    pub(crate) links: Vec<Link>,
    pub(crate) tip: Pose,
    pub(crate) readings: usize,
    /// Whether values depend on cosines and sines of the readings.
    pub(crate) has_functions: bool,
    pub(crate) drawing: Vec<(Pose, Drawn)>,
    pub(crate) gravity: Vector3<f64>,
    /// Moments of weights, and the link whose joint they turn.
    pub(crate) pulls: Vec<(usize, Moment)>,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Link {
    /// Its frame, the axis along z, in that of the link before.
    pub(crate) frame: Pose,
    pub(crate) slides: bool,
    pub(crate) value: JointValue,
}

/// A [`Pull`] with the weights of each body as one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Moment {
    pub(crate) after: usize,
    pub(crate) slides: bool,
    pub(crate) direction: Vector3<f64>,
    pub(crate) place: Vector3<f64>,
    /// Number of joints that carry them, sum of sizes, and of sizes times places.
    pub(crate) weights: Vec<(usize, f64, Vector3<f64>)>,
}

impl Moment {
    fn of(pull: &Pull, from_base: &[Pose]) -> Self {
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

    fn at(&self, bodies: &[Pose; MOST_JOINTS + 1], gravity: &Vector3<f64>) -> f64 {
        let body = &bodies[self.after];
        let axis = body.rotation * self.direction;
        let size: f64 = self.weights.iter().map(|(_, size, _)| size).sum();
        if self.slides {
            return size * axis.dot(gravity);
        }
        let mut sum = body.act(&self.place) * -size;
        for (after, size, place) in &self.weights {
            let body = &bodies[*after];
            sum += body.rotation * place + body.translation * *size;
        }
        axis.dot(&sum.cross(gravity))
    }
}

/// Angle below which a few terms of the series are exact.
pub(crate) const SMALL: f64 = 0.05;

/// `(cos, sin)` of a small angle, as of joints that give.
#[inline(always)]
pub(crate) fn small(angle: f64) -> (f64, f64) {
    let z = angle * angle;
    let cosine = 1.0 - z * (0.5 - z * (1.0 / 24.0 - z * (1.0 / 720.0 - z / 40320.0)));
    let sine = angle * (1.0 - z * (1.0 / 6.0 - z * (1.0 / 120.0 - z * (1.0 / 5040.0 - z / 362_880.0))));
    (cosine, sine)
}

/// Whether a wave is of the reading itself.
pub(crate) fn is_plain(wave: &Wave) -> bool {
    wave.factor == 1.0 && wave.offset == 0.0
}

impl Real {
    /// The chain of a model that is whole.
    pub(crate) fn new(model: &Model) -> Self {
        let mut before = Pose::identity();
        let mut from_base = Vec::with_capacity(model.drawing.len() + 1);
        from_base.push(before);
        let mut drawing = Vec::with_capacity(model.drawing.len());
        for drawn in &model.drawing {
            let frame = along(&drawn.screw, &before.translation);
            drawing.push((before.inverse() * frame, *drawn));
            from_base.push(frame.inverse());
            before = frame;
        }
        let mut before = Pose::identity();
        let mut links = Vec::with_capacity(model.joints.len());
        let mut pulls = Vec::new();
        for joint in model.joints.iter().filter(|joint| joint.value != JointValue::default()) {
            let frame = along(&joint.screw, &before.translation);
            if let Some(pull) = &joint.value.pull {
                pulls.push((links.len(), Moment::of(pull, &from_base)));
            }
            links.push(Link {
                frame: before.inverse() * frame,
                slides: joint.screw.is_prismatic(),
                value: joint.value.clone(),
            });
            before = frame;
        }
        let tip = before.inverse() * model.home;
        let has_waves = model.joints.iter().any(|joint| !joint.value.waves.is_empty());
        let has_functions = has_waves || !pulls.is_empty();
        Real { links, tip, readings: model.readings, has_functions, drawing, gravity: model.gravity, pulls }
    }

    /// Where the tip is, and how it moves with each reading: but for what weights add to it, some 1e-3 of it.
    pub(crate) fn placed<const N: usize>(&self, q: &[f64; N]) -> Placed<N> {
        let mut found = [(1.0, 0.0); N];
        if self.has_functions {
            for (found, q) in found.iter_mut().zip(&q[..self.readings]) {
                *found = cosine_and_sine(*q);
            }
        }
        let mut bodies = [Pose::identity(); MOST_JOINTS + 1];
        if !self.pulls.is_empty() {
            for (index, (frame, drawn)) in self.drawing.iter().enumerate() {
                let mut body = bodies[index] * *frame;
                let value = drawn.factor * q[drawn.reading] + drawn.constant;
                if drawn.screw.is_prismatic() {
                    body.translation += body.rotation.column(2) * value;
                } else if drawn.factor == 1.0 && drawn.constant == 0.0 {
                    turn_by(&mut body.rotation, found[drawn.reading]);
                } else {
                    turn_by(&mut body.rotation, cosine_and_sine(value));
                }
                bodies[index + 1] = body;
            }
        }
        let mut pulls = self.pulls.iter().peekable();
        let mut out = Placed::at_rest();
        let (mut turned, mut at) = (Matrix3::identity(), Vector3::zeros());
        for (index, link) in self.links.iter().enumerate() {
            at += turned * link.frame.translation;
            turned *= link.frame.rotation;
            let axis = turned.column(2).into_owned();
            let (v, w) = if link.slides { (axis, Vector3::zeros()) } else { (at.cross(&axis), axis) };
            let mut value = link.value.constant;
            let mut moves = |reading: usize, slope: f64| {
                out.v[reading] += v * slope;
                out.w[reading] += w * slope;
            };
            for &(reading, factor) in &link.value.linear {
                value += factor * q[reading];
                moves(reading, factor);
            }
            for wave in &link.value.waves {
                let (c, s) = match wave.order {
                    1.0 if is_plain(wave) => found[wave.reading],
                    2.0 if is_plain(wave) => {
                        let (c, s) = found[wave.reading];
                        (c * c - s * s, 2.0 * c * s)
                    }
                    order => cosine_and_sine(order * (wave.factor * q[wave.reading] + wave.offset)),
                };
                value += wave.cosine * c + wave.sine * s;
                moves(wave.reading, wave.order * wave.factor * (wave.sine * c - wave.cosine * s));
            }
            if let Some((_, pull)) = pulls.next_if(|(of, _)| *of == index) {
                value += pull.at(&bodies, &self.gravity);
            }
            if link.slides {
                at += axis * value;
            } else {
                turn_by(&mut turned, if value.abs() < SMALL { small(value) } else { cosine_and_sine(value) });
            }
        }
        out.tip = Pose::new(turned * self.tip.rotation, at + turned * self.tip.translation);
        out
    }
}
