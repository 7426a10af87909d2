//! Robot with compliant joints and links, with all terms that its model allows.

use nalgebra::Vector3;

use super::{
    CompliantDirections, Gravity, JointKind, JointTerm, Robot, Sizes, Statics, Term, TermArgument, TermFunction,
    TermGroup, TermKind,
};

/// Extent of the model of errors beyond geometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CorrectionExtent {
    /// Highest order of the harmonics of gears and encoders.
    pub orders: u8,
    /// Compliant directions of bearings and links. If they are all directions, first harmonics are among their terms.
    pub gives: CompliantDirections,
}

impl Default for CorrectionExtent {
    fn default() -> Self {
        CorrectionExtent { orders: 2, gives: CompliantDirections::Tilting }
    }
}

/// A robot with compliant joints and terms whose coefficients are zero, each term of a group.
#[derive(Clone, Debug, PartialEq)]
pub struct CorrectionModel {
    /// Robot with its compliant joints, its gravity and its terms.
    pub robot: Robot,
    /// Index there of each joint of the rigid robot.
    pub places: Vec<usize>,
    /// Group of each term of `robot.terms`, and its share of the variance there: several weights share one size. Terms of the model
    /// itself come first and have no group.
    pub groups: Vec<(TermGroup, f64)>,
}

impl CorrectionModel {
    /// Model of a robot with gravity in a direction (base frame); joints that do not move have no terms of their own values.
    #[must_use]
    pub fn new(robot: &Robot, gravity: Vector3<f64>, moves: &[bool], extent: CorrectionExtent) -> Self {
        let mut robot = robot.clone();
        robot.gravity = Some(Gravity::of_unit_weights(&robot, gravity));
        let all: Vec<usize> = (0..robot.joints.len()).collect();
        let (mut robot, places) = robot.with_compliance(&all, extent.gives);
        let (mut terms, mut groups) = (Vec::new(), Vec::new());
        let Some(statics) = Statics::new(&robot) else { return CorrectionModel { robot, places, groups } };
        for (joint, it) in robot.joints.iter().enumerate() {
            let of = places.iter().position(|&place| place == it.give_of.unwrap_or(joint));
            let is_moving = of.is_some_and(|at| moves.get(at) == Some(&true));
            for (term, group, share) in LoadedJoint::new(&robot, &statics, extent, joint).terms(is_moving) {
                let is_known = robot.terms.iter().any(|it| it.joint == joint && it.term == term);
                if !is_known {
                    terms.push(JointTerm { joint, term, coefficient: 0.0 });
                    groups.push((group, share));
                }
            }
        }
        robot.terms.extend(terms);
        CorrectionModel { robot, places, groups }
    }

    /// The same model without the terms of groups of size 0.
    #[must_use]
    pub fn with_sizes(&self, sizes: &Sizes) -> Self {
        let mut kept = self.clone();
        let corrected = kept.robot.terms.split_off(self.own_terms());
        let corrected = corrected.into_iter().zip(self.groups.iter().copied());
        let (terms, groups): (Vec<_>, _) = corrected.filter(|(_, (group, _))| sizes[*group] > 0.0).unzip();
        kept.robot.terms.extend(terms);
        kept.groups = groups;
        kept
    }

    /// Number of terms of the model itself.
    fn own_terms(&self) -> usize {
        self.robot.terms.len() - self.groups.len()
    }

    /// Prior standard deviation of each term of the groups.
    pub fn deviations(&self, sizes: &Sizes) -> impl Iterator<Item = f64> {
        self.groups.iter().map(|(group, share)| sizes[*group] * share.sqrt())
    }

    /// Joints and terms of the groups.
    pub fn terms(&self) -> impl Iterator<Item = (usize, Term)> {
        self.robot.terms.iter().skip(self.own_terms()).map(|it| (it.joint, it.term))
    }

    /// Compliant joints.
    pub fn gives(&self) -> impl Iterator<Item = usize> {
        (0..self.robot.joints.len()).filter(|&joint| self.robot.joints[joint].give_of.is_some())
    }

    /// Joints and terms of the groups of a size above 0.
    pub fn terms_of(&self, sizes: &Sizes) -> impl Iterator<Item = (usize, Term)> {
        let used = self.terms().zip(&self.groups).filter(|(_, (group, _))| sizes[*group] > 0.0);
        used.map(|(term, _)| term)
    }
}

/// A joint or a compliant joint of a robot in gravity, as input of the table of terms.
struct LoadedJoint<'a> {
    robot: &'a Robot,
    statics: &'a Statics<'a>,
    extent: CorrectionExtent,
    joint: usize,
    is_give: bool,
    /// True if it is a prismatic compliant joint.
    shifts: bool,
    /// True if the joint, or the one that the compliant joint belongs to, is revolute.
    turns: bool,
    /// Indices of the weights that it carries.
    carried: Vec<usize>,
}

impl<'a> LoadedJoint<'a> {
    fn new(robot: &'a Robot, statics: &'a Statics<'a>, extent: CorrectionExtent, joint: usize) -> Self {
        let own = &robot.joints[joint];
        let is_give = own.give_of.is_some();
        let weights = 0..robot.gravity.as_ref().map_or(0, |gravity| gravity.weights.len());
        LoadedJoint {
            robot,
            statics,
            extent,
            joint,
            is_give,
            shifts: is_give && own.kind == JointKind::Prismatic,
            turns: robot.joints[own.give_of.unwrap_or(joint)].kind == JointKind::Revolute,
            carried: weights.filter(|&weight| statics.is_carried(joint, weight)).collect(),
        }
    }

    /// Terms, each with its group and its share of the variance of that; those of its own value only if it moves.
    fn terms(&self, is_moving: bool) -> Vec<(Term, TermGroup, f64)> {
        let arguments = [
            TermArgument::Masses,
            TermArgument::Weight,
            TermArgument::Payload,
            TermArgument::Factor,
            TermArgument::OwnValue,
        ];
        let arguments = arguments.into_iter().filter(|it| is_moving || *it != TermArgument::OwnValue);
        let mut found = Vec::new();
        for (argument, number) in arguments.flat_map(|it| self.numbers(it).into_iter().map(move |at| (it, at))) {
            let is_of = |kind: &TermKind| kind.row().argument == argument && kind.row().is_numbered() == (number > 0);
            let terms = TermKind::ALL.into_iter().filter(is_of).map(|kind| kind.with_number(number));
            found.extend(terms.filter_map(|term| Some((term, self.group(term)?, self.share(term)))));
        }
        found
    }

    /// Numbers of its terms of this argument, 0 for those without: a prismatic joint has only those of its compliant joints under weight.
    fn numbers(&self, argument: TermArgument) -> Vec<usize> {
        let is_loaded = self.is_give || self.turns;
        let counted = |index: usize| index + 1;
        match argument {
            TermArgument::Masses if is_loaded && self.statics.carries_masses(self.joint) => vec![0],
            // All weights act alike where a link shifts.
            TermArgument::Weight if self.shifts => self.carried.last().copied().map(counted).into_iter().collect(),
            TermArgument::Weight if is_loaded => self.carried.iter().copied().map(counted).collect(),
            TermArgument::Payload if is_loaded => {
                let last = self.robot.gravity.as_ref().map_or(0, |gravity| gravity.weights.len());
                let is_carried = self.carried.last().is_some_and(|it| counted(*it) == last);
                self.robot.payloads().filter(|_| is_carried).map(counted).collect()
            }
            TermArgument::Factor if self.turns => self.factors().map(counted).collect(),
            TermArgument::OwnValue if self.turns => match (self.is_give, self.extent.gives) {
                (false, _) => (0..=usize::from(self.extent.orders)).collect(),
                (true, CompliantDirections::Tilting) => vec![2],
                (true, CompliantDirections::All) => vec![1, 2],
            },
            TermArgument::Nothing
            | TermArgument::OwnValue
            | TermArgument::Masses
            | TermArgument::Weight
            | TermArgument::OtherJoint
            | TermArgument::Factor
            | TermArgument::Payload => Vec::new(),
        }
    }

    /// Factors on which its value may depend: the side from which it is approached only if it is its own, or that of all.
    fn factors(&self) -> impl Iterator<Item = usize> {
        let joint = &self.robot.joints[self.joint];
        let is_own = |of: &str| of.is_empty() || [&joint.name, &joint.reading.name].into_iter().any(|it| it == of);
        let all = self.robot.factors.iter().enumerate();
        all.filter(move |(_, it)| !it.is_payload() && it.approached_joint().is_none_or(is_own)).map(|(index, _)| index)
    }

    /// Group of a term, if it is among corrections; of a factor by its name.
    fn group(&self, term: Term) -> Option<TermGroup> {
        let group = term.kind().row().groups[usize::from(self.is_give) + usize::from(self.shifts)]?;
        let factor = self.robot.factors.get(term.index()).filter(|_| term.argument() == TermArgument::Factor);
        Some(factor.map_or(group, |it| it.group()))
    }

    /// Share of a term in the variance of its group. Nominal masses are estimates: half of the prior of a moment.
    fn share(&self, term: Term) -> f64 {
        let is_moment = matches!(term.kind().row().function, TermFunction::Identity) && !self.shifts;
        let believed = if self.statics.carries_masses(self.joint) { 0.5 } else { 1.0 };
        match term.argument() {
            TermArgument::Masses if is_moment => believed,
            TermArgument::Weight if is_moment => believed / self.carried.len().max(1) as f64,
            TermArgument::Nothing
            | TermArgument::OwnValue
            | TermArgument::Masses
            | TermArgument::Weight
            | TermArgument::OtherJoint
            | TermArgument::Factor
            | TermArgument::Payload => 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::tests::elbow;

    #[test]
    fn each_joint_has_two_gives_and_each_term_a_group() {
        let model = CorrectionModel::new(&elbow(), -Vector3::z(), &[true; 6], CorrectionExtent::default());
        assert_eq!((model.robot.joints.len(), model.places[1]), (18, 3));
        assert!(model.groups.iter().any(|it| it.0 == TermGroup::Sag) && model.own_terms() == 0);
    }
}
