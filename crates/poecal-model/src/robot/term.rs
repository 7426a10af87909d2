//! Terms of joint values in a configuration: theory.md §3.

use std::borrow::Cow;

use poecal_arm::{Term, TermArgument};
use serde::{Deserialize, Serialize};

use super::{JointKind, Moments, Robot, Statics};
use poecal_numerics::unit::Unit;

/// A term of a joint with its coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointTerm {
    /// Index of the joint.
    pub joint: usize,
    /// The term.
    pub term: Term,
    /// Coefficient c, in [`JointKind::unit_of`].
    pub coefficient: f64,
}

impl JointKind {
    /// Unit of the coefficient of a term for a joint of this kind.
    #[must_use]
    pub fn unit_of(self, term: Term) -> Unit {
        match self {
            JointKind::Revolute | JointKind::Prismatic if term.kind().row().is_share() => Unit::One,
            JointKind::Revolute => Unit::Radian,
            JointKind::Prismatic => Unit::Metre,
        }
    }

    /// Standard deviation of this coefficient over robots, its prior, in that unit.
    #[must_use]
    pub fn deviation_of(self, term: Term) -> f64 {
        term.deviation(self == JointKind::Prismatic)
    }
}

impl Robot {
    /// Requirement of a term of a joint that this robot does not fulfil, in words.
    pub fn lacks(&self, term: Term) -> Option<String> {
        let (joints, factors) = (self.joints.len(), self.factors.len());
        let weights = self.gravity.as_ref().map_or(0, |gravity| gravity.weights.len());
        if !term.is_of(joints, factors) {
            return Some(format!("one of the {joints} joints and {factors} factors"));
        }
        match term.argument() {
            TermArgument::Masses if self.masses.is_empty() => Some("a robot with masses".to_owned()),
            TermArgument::Weight | TermArgument::Payload if weights == 0 => Some("a robot with weights".to_owned()),
            TermArgument::Weight if term.index() >= weights => Some(format!("one of the {weights} weights")),
            TermArgument::Nothing
            | TermArgument::OwnValue
            | TermArgument::Masses
            | TermArgument::Weight
            | TermArgument::OtherJoint
            | TermArgument::Factor
            | TermArgument::Payload => None,
        }
    }
}

/// One configuration, as input of terms of joint values.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'a> {
    /// Values of all joints without terms, radians or metres.
    pub values: &'a [f64],
    /// Moments of the weights that the robot carries, if it has any.
    pub moments: Option<&'a Moments>,
    /// Factors of the robot, from their references.
    pub factors: &'a [f64],
}

impl<'a> Situation<'a> {
    /// Situation of these values of all joints, without weights and factors.
    #[must_use]
    pub fn from_values(values: &'a [f64]) -> Self {
        Situation { values, moments: None, factors: &[] }
    }

    /// Function b of a term of a joint.
    #[must_use]
    pub fn basis(&self, joint: usize, term: Term) -> f64 {
        let value = |of: &[f64], at: usize| of.get(at).copied().unwrap_or_default();
        let moment = |of: &dyn Fn(&Moments) -> f64| self.moments.map_or(0.0, of);
        let x = match term.argument() {
            TermArgument::Nothing => 0.0,
            TermArgument::OwnValue => value(self.values, joint),
            TermArgument::OtherJoint => value(self.values, term.index()),
            TermArgument::Masses => moment(&|it| it.of_masses(joint)),
            TermArgument::Weight => moment(&|it| it.moment(joint, term.index())),
            TermArgument::Factor => value(self.factors, term.index()),
            TermArgument::Payload => value(self.factors, term.index()) * moment(&|it| it.of_last(joint)),
        };
        let [found, _] = term.function(x);
        found
    }
}

/// Functions b of all terms of a robot, configuration after configuration.
pub struct TermFunctions<'a> {
    robot: &'a Robot,
    statics: Option<Statics<'a>>,
    moments: Moments,
}

impl<'a> TermFunctions<'a> {
    /// Functions of the terms of a robot.
    pub fn new(robot: &'a Robot) -> Self {
        TermFunctions { robot, statics: Statics::new(robot), moments: Moments::default() }
    }

    /// Functions at these values of all joints and of the factors, in the order of the robot's terms.
    pub(crate) fn evaluate(&mut self, values: &[f64], factors: &[f64]) -> Vec<f64> {
        let mut found = vec![0.0; self.robot.terms.len()];
        self.write(values, factors, &mut found);
        found
    }

    /// Writes the functions.
    pub fn write(&mut self, values: &[f64], factors: &[f64], out: &mut [f64]) {
        let TermFunctions { robot, statics, moments } = self;
        if let Some(statics) = &statics {
            statics.evaluate(values, moments);
        }
        let factors = robot.factors.iter().zip(factors).map(|(it, value)| value - it.reference);
        let factors: Vec<f64> = factors.collect();
        let own = own_values(robot, values);
        let at = Situation { values: &own, moments: statics.as_ref().map(|_| &*moments), factors: &factors };
        for (out, it) in out.iter_mut().zip(&robot.terms) {
            *out = at.basis(it.joint, it.term);
        }
    }
}

/// Joint values as arguments of terms: for a compliant joint, that of the joint to which it belongs.
fn own_values<'a>(robot: &Robot, values: &'a [f64]) -> Cow<'a, [f64]> {
    if robot.joints.iter().all(|joint| joint.give_of.is_none()) {
        return Cow::Borrowed(values);
    }
    let of = |give: Option<usize>| give.and_then(|joint| values.get(joint)).copied();
    let own = robot.joints.iter().zip(values);
    Cow::Owned(own.map(|(joint, &value)| of(joint.give_of).unwrap_or(value)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::tests::elbow;

    #[test]
    fn terms_are_functions_of_the_configuration() {
        let at = Situation { factors: &[21.5], ..Situation::from_values(&[0.7, 0.1, 0.2, 0.3]) };
        for (name, expected) in [
            ("offset", 1.0),
            ("ratio", 0.7),
            ("sin2", 1.4f64.sin()),
            ("cos2", 1.4f64.cos()),
            ("coupled4", 0.3),
            ("factor1", 21.5),
            // Without gravity there are no moments.
            ("masses", 0.0),
            ("sag6", 0.0),
            ("payload1", 0.0),
        ] {
            assert_eq!(at.basis(0, name.parse().unwrap()), expected, "{name}");
        }
        let mut robot = elbow();
        robot.terms.push(JointTerm { joint: 1, term: Term::OFFSET, coefficient: 0.02 });
        assert_eq!(robot.joint_values(&[0.0; 6])[1], 0.02);
    }
}
