//! Models as flat lists of numbers, which every language can hold in an array.

use alloc::vec::Vec;

use nalgebra::{Matrix3, Vector3};

use crate::lie::{Pose, Screw};
use crate::model::{Drawn, Joint, JointValue, Model, Pull, PulledWeight, Wave};
use crate::placed::MOST_JOINTS;

/// First number of a list: the version of its order.
const VERSION: f64 = 1.0;
/// Limit of a reading that has none; every language can write it.
const UNLIMITED: f64 = 1e300;
/// Most joints, waves or weights of a list.
const MOST: usize = 1000;

impl Model {
    /// All numbers of the model (m, rad), in this order: 1 (the version); the numbers of readings, joints and drawn joints; home as three rows
    /// of rotation and translation; gravity; of each reading its smallest and largest value (±1e300 if there is none); of each joint its
    /// axis, constant, the number of its linear parts with (reading, factor) each, the number of its waves with (reading, factor, offset,
    /// order, cosine, sine) each, and the number of its weights, before them, if there are any, (drawn joints before it, 1 if it slides,
    /// direction, place), with (drawn joints that carry it, size, place) each; of each drawn joint its axis, reading, factor and constant.
    /// An axis is 1 if it slides or 0, a direction and a point. Indices count from 0.
    #[must_use]
    pub fn numbers(&self) -> Vec<f64> {
        let mut out = Vec::new();
        out.extend([VERSION, self.readings as f64, self.joints.len() as f64, self.drawing.len() as f64]);
        for row in 0..3 {
            out.extend((0..3).map(|column| self.home.rotation[(row, column)]));
            out.push(self.home.translation[row]);
        }
        out.extend(self.gravity.iter());
        for reading in 0..self.readings {
            let limits = self.limits.get(reading).copied().flatten();
            let (low, high) = limits.unwrap_or((-UNLIMITED, UNLIMITED));
            out.extend([low, high]);
        }
        let axis = |out: &mut Vec<f64>, screw: &Screw| {
            out.push(if screw.is_prismatic() { 1.0 } else { 0.0 });
            out.extend(screw.direction().iter());
            let point =
                if screw.is_prismatic() { Vector3::zeros() } else { screw.nearest_point(&Vector3::zeros()) };
            out.extend(point.iter());
        };
        for Joint { screw, value } in &self.joints {
            axis(&mut out, screw);
            out.push(value.constant);
            out.push(value.linear.len() as f64);
            for (reading, factor) in &value.linear {
                out.extend([*reading as f64, *factor]);
            }
            out.push(value.waves.len() as f64);
            for it in &value.waves {
                out.extend([it.reading as f64, it.factor, it.offset, it.order, it.cosine, it.sine]);
            }
            let weights = value.pull.as_ref().map_or(0, |pull| pull.weights.len());
            out.push(weights as f64);
            if let Some(pull) = value.pull.as_ref().filter(|_| weights > 0) {
                out.extend([pull.after as f64, if pull.slides { 1.0 } else { 0.0 }]);
                out.extend(pull.direction.iter().chain(pull.place.iter()));
                for it in &pull.weights {
                    out.extend([it.after as f64, it.size]);
                    out.extend(it.place.iter());
                }
            }
        }
        for it in &self.drawing {
            axis(&mut out, &it.screw);
            out.extend([it.reading as f64, it.factor, it.constant]);
        }
        out
    }

    /// The model of such numbers; `None` if they are none.
    #[must_use]
    pub fn from_numbers(numbers: &[f64]) -> Option<Self> {
        let mut rest = Rest(numbers);
        if rest.number()? != VERSION {
            return None;
        }
        let (readings, joints, drawn) = (rest.count()?, rest.count()?, rest.count()?);
        if readings > MOST_JOINTS || drawn > MOST_JOINTS {
            return None;
        }
        let (mut rotation, mut translation) = (Matrix3::zeros(), Vector3::zeros());
        for row in 0..3 {
            for column in 0..3 {
                rotation[(row, column)] = rest.number()?;
            }
            translation[row] = rest.number()?;
        }
        let mut model = Model::new(readings, &Pose::new(rotation, translation));
        model.gravity = rest.vector()?;
        for _ in 0..readings {
            let (low, high) = (rest.number()?, rest.number()?);
            let is_limited = low > -UNLIMITED || high < UNLIMITED;
            model.limits.push(is_limited.then_some((low, high)));
        }
        for _ in 0..joints {
            let screw = rest.axis()?;
            let mut value = JointValue { constant: rest.number()?, ..JointValue::default() };
            for _ in 0..rest.count()? {
                value.linear.push((rest.count()?, rest.number()?));
            }
            for _ in 0..rest.count()? {
                value.waves.push(Wave {
                    reading: rest.count()?,
                    factor: rest.number()?,
                    offset: rest.number()?,
                    order: rest.number()?,
                    cosine: rest.number()?,
                    sine: rest.number()?,
                });
            }
            let weights = rest.count()?;
            if weights > 0 {
                let (after, slides) = (rest.count()?, rest.number()? != 0.0);
                let (direction, place) = (rest.vector()?, rest.vector()?);
                let mut pull = Pull { after, slides, direction, place, weights: Vec::new() };
                for _ in 0..weights {
                    let (after, size, place) = (rest.count()?, rest.number()?, rest.vector()?);
                    pull.weights.push(PulledWeight { after, size, place });
                }
                value.pull = Some(pull);
            }
            model.joints.push(Joint { screw, value });
        }
        for _ in 0..drawn {
            let screw = rest.axis()?;
            let (reading, factor, constant) = (rest.count()?, rest.number()?, rest.number()?);
            model.drawing.push(Drawn { screw, reading, factor, constant });
        }
        (rest.0.is_empty() && model.is_whole()).then_some(model)
    }
}

/// Numbers that are still to be read.
struct Rest<'a>(&'a [f64]);

impl Rest<'_> {
    fn number(&mut self) -> Option<f64> {
        let (first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(*first)
    }

    fn count(&mut self) -> Option<usize> {
        let number = self.number()?;
        let count = number as usize;
        (count <= MOST && count as f64 == number).then_some(count)
    }

    fn vector(&mut self) -> Option<Vector3<f64>> {
        Some(Vector3::new(self.number()?, self.number()?, self.number()?))
    }

    fn axis(&mut self) -> Option<Screw> {
        let slides = self.number()?;
        let (direction, point) = (self.vector()?, self.vector()?);
        let size = direction.norm_squared();
        if !(0.5..2.0).contains(&size) || !point.iter().all(|it| it.is_finite()) {
            return None;
        }
        match slides {
            0.0 => Some(Screw::revolute(&direction, &point)),
            1.0 => Some(Screw::prismatic(&direction)),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_comes_back_from_its_numbers() {
        let screw = Screw::revolute(&Vector3::z(), &Vector3::x());
        let mut model = Model::new(1, &Pose::identity());
        model.joints.push(Joint { screw, value: JointValue::of(0) });
        let numbers = model.numbers();
        assert_eq!(numbers[..4], [1.0, 1.0, 1.0, 0.0]);
        assert_eq!(Model::from_numbers(&numbers).unwrap().numbers(), numbers);
    }
}
