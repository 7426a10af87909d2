//! The robot whose joints and links give, with all terms that its model allows.

use nalgebra::Vector3;

use super::{
    Factor, Gives, Gravity, Harmonic, JointKind, JointTerm, Payload, Robot, Sag, Sizes, Statics, Term,
    TermGroup,
};

/// How far the model of what joints do reaches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Highest order of the harmonics of gears and encoders.
    pub orders: u8,
    /// In which directions bearings and links give. Where they give in all, first harmonics are among their terms.
    pub gives: Gives,
}

impl Default for Extent {
    fn default() -> Self {
        Extent { orders: 2, gives: Gives::Tilting }
    }
}

/// A robot with gives and terms whose coefficients are zero, each term of a group.
#[derive(Clone, Debug, PartialEq)]
pub struct CorrectionModel {
    /// The robot with its gives, its gravity and its terms.
    pub robot: Robot,
    /// Index there of each joint of the robot without gives.
    pub places: Vec<usize>,
    /// Group of each term of `robot.terms`; those that the model has itself come first and have none.
    pub groups: Vec<TermGroup>,
    /// Number of terms that the model has itself.
    own: usize,
    /// Share of a term's variance in that of its group and joint: several weights share one size.
    shares: Vec<f64>,
}

/// Factors on which a joint's value may depend, with their groups: the side from which it is approached only if it is its own, or that of all.
fn factors(robot: &Robot, joint: usize) -> impl Iterator<Item = (usize, TermGroup)> {
    let own = robot.joints.get(joint).map(|joint| [&joint.name, &joint.reading.name]);
    let all = robot.factors.iter().enumerate().filter(|(_, it)| it.group() != TermGroup::Payload);
    all.filter_map(move |(index, it)| {
        let is_own =
            |of: &str| of.is_empty() || own.is_some_and(|own| own.into_iter().any(|name| name == of));
        it.approached().is_none_or(is_own).then(|| (index, it.group()))
    })
}

impl CorrectionModel {
    /// The model of a robot in gravity of a direction (base frame); of joints that do not move no terms of their own values.
    #[must_use]
    pub fn new(robot: &Robot, gravity: Vector3<f64>, moves: &[bool], extent: Extent) -> Self {
        let mut robot = robot.clone();
        robot.gravity = Some(Gravity::of_unit_weights(&robot, gravity));
        let all: Vec<usize> = (0..robot.joints.len()).collect();
        let (mut robot, places) = robot.giving(&all, extent.gives);
        let own = robot.terms.len();
        let (mut terms, mut groups, mut shares) = (Vec::new(), Vec::new(), Vec::new());
        let Some(statics) = Statics::new(&robot) else {
            return CorrectionModel { robot, places, groups, own, shares };
        };
        let weights = robot.gravity.as_ref().map_or(0, |gravity| gravity.weights.len());
        for (joint, it) in robot.joints.iter().enumerate() {
            let of = it.give_of.unwrap_or(joint);
            let is_own = it.give_of.is_none();
            let turns = robot.joints[of].kind == JointKind::Revolute;
            let shifts = !is_own && it.kind == JointKind::Prismatic;
            let is_moving =
                places.iter().position(|&place| place == of).is_some_and(|at| moves.get(at) == Some(&true));
            let mut push = |term: Term, group: TermGroup, share: f64| {
                let is_known = robot.terms.iter().any(|it| it.joint == joint && it.term == term);
                if !is_known {
                    terms.push(JointTerm { joint, term, coefficient: 0.0 });
                    groups.push(group);
                    shares.push(share);
                }
            };
            if shifts {
                // All weights pull alike.
                let carried = (0..weights).rev().find(|&weight| statics.is_carried(joint, weight));
                carried.into_iter().for_each(|weight| push(Term::Sag(Sag { weight }), TermGroup::Shift, 1.0));
            } else if !is_own || turns {
                let carried: Vec<usize> =
                    (0..weights).filter(|&weight| statics.is_carried(joint, weight)).collect();
                let group = if is_own { TermGroup::Sag } else { TermGroup::Tilt };
                // Masses of a drawing are estimates: half of what is believed.
                let masses = statics.carries_masses(joint);
                let believed = if masses { 0.5 } else { 1.0 };
                if masses {
                    push(Term::OwnWeight, group, 0.5);
                }
                let share = believed / carried.len().max(1) as f64;
                carried.iter().for_each(|&weight| push(Term::Sag(Sag { weight }), group, share));
                let carries_payload =
                    weights.checked_sub(1).is_some_and(|last| statics.is_carried(joint, last));
                for index in robot.payloads().filter(|_| carries_payload) {
                    push(Term::Payload(Payload { index }), TermGroup::Payload, 1.0);
                }
            }
            if is_own && turns {
                for (index, group) in factors(&robot, joint) {
                    push(Term::Factor(Factor { index }), group, 1.0);
                }
            }
            if !turns || !is_moving {
                continue;
            }
            let harmonic = |order, cosine| Term::Harmonic(Harmonic { order, cosine });
            if is_own {
                push(Term::Ratio, TermGroup::Ratio, 1.0);
                for order in 1..=extent.orders {
                    push(harmonic(order, false), TermGroup::Harmonics, 1.0);
                    push(harmonic(order, true), TermGroup::Harmonics, 1.0);
                }
            } else {
                let group = if shifts { TermGroup::Runout } else { TermGroup::Wobble };
                let first = match extent.gives {
                    Gives::Tilting => 2,
                    Gives::All => 1,
                };
                for order in first..=2 {
                    push(harmonic(order, false), group, 1.0);
                    push(harmonic(order, true), group, 1.0);
                }
            }
        }
        robot.terms.extend(terms);
        CorrectionModel { robot, places, groups, own, shares }
    }

    /// The same without the terms of groups of size 0.
    #[must_use]
    pub fn with_sizes(&self, sizes: &Sizes) -> Self {
        let mut kept = self.clone();
        let is_kept = |at: usize| at < self.own || sizes[self.groups[at - self.own]] > 0.0;
        let mut at = 0..;
        kept.robot.terms.retain(|_| at.next().is_some_and(is_kept));
        let mut at = self.own..;
        kept.groups.retain(|_| at.next().is_some_and(is_kept));
        let mut at = self.own..;
        kept.shares.retain(|_| at.next().is_some_and(is_kept));
        kept
    }

    /// Prior standard deviation of each term of the groups.
    pub fn deviations(&self, sizes: &Sizes) -> impl Iterator<Item = f64> {
        self.groups.iter().zip(&self.shares).map(|(group, share)| sizes[*group] * share.sqrt())
    }

    /// Share of each term's variance in that of its group and joint.
    pub fn shares(&self) -> impl Iterator<Item = f64> {
        self.shares.iter().copied()
    }

    /// The joints and terms of the groups.
    pub fn terms(&self) -> impl Iterator<Item = (usize, Term)> {
        self.robot.terms.iter().skip(self.own).map(|it| (it.joint, it.term))
    }

    /// The gives.
    pub fn gives(&self) -> impl Iterator<Item = usize> {
        (0..self.robot.joints.len()).filter(|&joint| self.robot.joints[joint].give_of.is_some())
    }

    /// The joints and terms of the groups of a size above 0.
    pub fn terms_of(&self, sizes: &Sizes) -> impl Iterator<Item = (usize, Term)> {
        let used = self.terms().zip(&self.groups).filter(|(_, group)| sizes[**group] > 0.0);
        used.map(|(term, _)| term)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::tests::elbow;

    #[test]
    fn each_joint_has_two_gives_and_each_term_a_group() {
        let model = CorrectionModel::new(&elbow(), -Vector3::z(), &[true; 6], Extent::default());
        assert_eq!((model.robot.joints.len(), model.places[1]), (18, 3));
        assert!(model.groups.contains(&TermGroup::Sag) && model.groups.len() == model.robot.terms.len());
    }
}
