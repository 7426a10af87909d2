//! Models as flat lists of numbers, which every language can hold in an array.

use alloc::string::{String, ToString};
use alloc::vec::Vec;

use nalgebra::{Matrix3, Vector3};

use crate::arm_state::MOST_JOINTS;
use crate::lie::{Pose, Screw};
use crate::model::{ArmModel, GravityTorque, JointValue, ModelJoint, NominalJoint, PulledWeight, TermCurve, Wave};

/// First number of a list, the version of its order: without curves, and with them.
const VERSIONS: [f64; 2] = [1.0, 2.0];
/// Limit of a reading without one; every language can write it.
const UNLIMITED: f64 = 1e300;
/// Largest number of joints, waves or weights of a list.
const MOST: usize = 1000;

impl ArmModel {
    /// All numbers of the model (m, rad), in this order. First come 1 (the version; 2 with curves); the numbers of readings, joints and nominal
    /// joints; home as three rows of rotation and translation; gravity; for each reading its smallest and largest value (±1e300 without a limit). For
    /// each joint follow its axis, constant, the number of its linear parts with (reading, factor) each, the number of its waves with (reading,
    /// factor, offset, order, cosine, sine) each, and the number of its weights. If there are weights, (nominal joints before it, 1 if it is
    /// prismatic, direction, position) precede them, with (nominal joints that carry it, size, position) each. For each nominal joint follow its
    /// axis, reading, factor and constant. With curves their number follows, and for each its joint, its coefficient, the number of letters of its
    /// term's name with the code of each, and for its argument constant, linear parts and weights as for a joint. An axis is 1 if it is prismatic or
    /// 0, a direction and a point. Indices count from 0.
    #[must_use]
    pub fn numbers(&self) -> Vec<f64> {
        let mut out = Vec::new();
        let curves: Vec<(usize, &TermCurve)> = (self.joints.iter().enumerate())
            .flat_map(|(at, joint)| joint.value.curves.iter().map(move |curve| (at, curve)))
            .collect();
        let version = VERSIONS[usize::from(!curves.is_empty())];
        out.extend([version, self.readings as f64, self.joints.len() as f64, self.drawing.len() as f64]);
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
            let point = if screw.is_prismatic() { Vector3::zeros() } else { screw.nearest_point(&Vector3::zeros()) };
            out.extend(point.iter());
        };
        for ModelJoint { screw, value } in &self.joints {
            axis(&mut out, screw);
            out.push(value.constant);
            write_linear(&mut out, &value.linear);
            out.push(value.waves.len() as f64);
            for it in &value.waves {
                out.extend([it.reading as f64, it.factor, it.offset, it.order, it.cosine, it.sine]);
            }
            write_pull(&mut out, value.pull.as_ref());
        }
        for it in &self.drawing {
            axis(&mut out, &it.screw);
            out.extend([it.reading as f64, it.factor, it.constant]);
        }
        if !curves.is_empty() {
            out.push(curves.len() as f64);
        }
        for (joint, curve) in curves {
            let name = curve.term.to_string();
            out.extend([joint as f64, curve.coefficient, name.len() as f64]);
            out.extend(name.bytes().map(f64::from));
            out.push(curve.constant);
            write_linear(&mut out, &curve.linear);
            write_pull(&mut out, curve.pull.as_ref());
        }
        out
    }

    /// The model of such numbers; `None` if they are no model.
    #[must_use]
    pub fn from_numbers(numbers: &[f64]) -> Option<Self> {
        let mut rest = RemainingNumbers(numbers);
        let version = rest.number()?;
        if !VERSIONS.contains(&version) {
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
        let mut model = ArmModel::new(readings, &Pose::new(rotation, translation));
        model.gravity = rest.vector()?;
        for _ in 0..readings {
            let (low, high) = (rest.number()?, rest.number()?);
            let is_limited = low > -UNLIMITED || high < UNLIMITED;
            model.limits.push(is_limited.then_some((low, high)));
        }
        for _ in 0..joints {
            let screw = rest.axis()?;
            let constant = rest.number()?;
            let mut value = JointValue { constant, linear: rest.linear()?, ..JointValue::default() };
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
            value.pull = rest.pull()?;
            model.joints.push(ModelJoint { screw, value });
        }
        for _ in 0..drawn {
            let screw = rest.axis()?;
            let (reading, factor, constant) = (rest.count()?, rest.number()?, rest.number()?);
            model.drawing.push(NominalJoint { screw, reading, factor, constant });
        }
        let curves = if version == VERSIONS[0] { 0 } else { rest.count()? };
        for _ in 0..curves {
            let (joint, curve) = (rest.count()?, rest.curve()?);
            model.joints.get_mut(joint)?.value.curves.push(curve);
        }
        (rest.0.is_empty() && model.is_whole()).then_some(model)
    }
}

fn write_linear(out: &mut Vec<f64>, linear: &[(usize, f64)]) {
    out.push(linear.len() as f64);
    for (reading, factor) in linear {
        out.extend([*reading as f64, *factor]);
    }
}

fn write_pull(out: &mut Vec<f64>, pull: Option<&GravityTorque>) {
    let weights = pull.map_or(0, |pull| pull.weights.len());
    out.push(weights as f64);
    if let Some(pull) = pull.filter(|_| weights > 0) {
        out.extend([pull.after as f64, if pull.slides { 1.0 } else { 0.0 }]);
        out.extend(pull.direction.iter().chain(pull.place.iter()));
        for it in &pull.weights {
            out.extend([it.after as f64, it.size]);
            out.extend(it.place.iter());
        }
    }
}

/// Numbers that are still to be read.
struct RemainingNumbers<'a>(&'a [f64]);

impl RemainingNumbers<'_> {
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

    fn linear(&mut self) -> Option<Vec<(usize, f64)>> {
        (0..self.count()?).map(|_| Some((self.count()?, self.number()?))).collect()
    }

    /// Weights, if there are any; `None` if the numbers are no model.
    fn pull(&mut self) -> Option<Option<GravityTorque>> {
        let weights = self.count()?;
        if weights == 0 {
            return Some(None);
        }
        let (after, slides) = (self.count()?, self.number()? != 0.0);
        let (direction, place) = (self.vector()?, self.vector()?);
        let mut pull = GravityTorque { after, slides, direction, place, weights: Vec::new() };
        for _ in 0..weights {
            let (after, size, place) = (self.count()?, self.number()?, self.vector()?);
            pull.weights.push(PulledWeight { after, size, place });
        }
        Some(Some(pull))
    }

    fn curve(&mut self) -> Option<TermCurve> {
        let coefficient = self.number()?;
        let letter = |code: usize| char::from_u32(u32::try_from(code).ok()?);
        let name: String = (0..self.count()?).map(|_| letter(self.count()?)).collect::<Option<_>>()?;
        let (term, constant) = (name.parse().ok()?, self.number()?);
        Some(TermCurve { term, coefficient, constant, linear: self.linear()?, pull: self.pull()? })
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
    use crate::terms::TermKind;

    #[test]
    fn a_model_comes_back_from_its_numbers() {
        let screw = Screw::revolute(&Vector3::z(), &Vector3::x());
        let mut model = ArmModel::new(1, &Pose::identity());
        model.joints.push(ModelJoint { screw, value: JointValue::from_reading(0) });
        let numbers = model.numbers();
        assert_eq!(numbers[..4], [1.0, 1.0, 1.0, 0.0]);
        assert_eq!(ArmModel::from_numbers(&numbers).unwrap().numbers(), numbers);

        let (term, linear) = (TermKind::Sine.with_number(3), [(0, 2.0)].to_vec());
        model.joints[0].value.curves.push(TermCurve { term, coefficient: 0.1, constant: 0.2, linear, pull: None });
        let again = ArmModel::from_numbers(&model.numbers()).unwrap();
        assert_eq!((model.numbers()[0], again.joints), (2.0, model.joints));
    }
}
