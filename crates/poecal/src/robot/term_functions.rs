//! Functions of all terms of a robot at once.

use std::borrow::Cow;

use super::{Moments, Robot, Situation, Statics};

/// Functions b of all terms of a robot, configuration after configuration.
pub(crate) struct TermFunctions<'a> {
    robot: &'a Robot,
    statics: Option<Statics<'a>>,
    moments: Moments,
}

impl<'a> TermFunctions<'a> {
    pub(crate) fn new(robot: &'a Robot) -> Self {
        TermFunctions { robot, statics: Statics::new(robot), moments: Moments::default() }
    }

    /// The functions at these values of all joints and of the factors, in the order of the robot's terms.
    pub(crate) fn at(&mut self, values: &[f64], factors: &[f64]) -> Vec<f64> {
        let mut found = vec![0.0; self.robot.terms.len()];
        self.write(values, factors, &mut found);
        found
    }

    /// Writes them.
    pub(crate) fn write(&mut self, values: &[f64], factors: &[f64], out: &mut [f64]) {
        let TermFunctions { robot, statics, moments } = self;
        if let Some(statics) = &statics {
            statics.evaluate(values, moments);
        }
        let factors = robot.factors.iter().zip(factors).map(|(it, value)| value - it.reference);
        let factors: Vec<f64> = factors.collect();
        let own = own_values(robot, values);
        let at = Situation { values: &own, moments: statics.as_ref().map(|_| &*moments), factors: &factors };
        for (out, it) in out.iter_mut().zip(&robot.terms) {
            *out = it.term.model().basis(it.joint, &at);
        }
    }
}

/// Joint values as terms depend on them: of a give that of the joint which gives.
fn own_values<'a>(robot: &Robot, values: &'a [f64]) -> Cow<'a, [f64]> {
    if robot.joints.iter().all(|joint| joint.give_of.is_none()) {
        return Cow::Borrowed(values);
    }
    let of = |give: Option<usize>| give.and_then(|joint| values.get(joint)).copied();
    let own = robot.joints.iter().zip(values);
    Cow::Owned(own.map(|(joint, &value)| of(joint.give_of).unwrap_or(value)).collect())
}
