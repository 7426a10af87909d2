//! The robot whose joints and links give, with all terms that its model allows.

use nalgebra::Vector3;

use super::{Sizes, TermGroup};
use crate::estimate::{Estimate, Packed, Tree, Unknowns};
use crate::measurement::Dataset;
use crate::problem::TermPrior;
use crate::robot::{Gravity, Harmonic, JointKind, JointTerm, Robot, Sag, Statics, Term};

/// Range of a joint's values in the fitted rows below which it has no term of its own value: encoders' jitter, radians.
const LEAST_RANGE_RAD: f64 = 0.02;

/// A robot with gives and terms whose coefficients are zero, each term of a group.
///
/// ```
/// use poecal::calibration::{CorrectionModel, TermGroup};
/// let robot = poecal::simulate::elbow();
/// let model = CorrectionModel::new(&robot, -nalgebra::Vector3::z(), &[true; 6]);
/// assert_eq!((model.robot.joints.len(), model.places[1]), (18, 3));
/// assert!(model.groups.contains(&TermGroup::Sag) && model.groups.len() == model.robot.terms.len());
/// ```
#[derive(Clone, Debug)]
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

impl CorrectionModel {
    /// The model of a robot in gravity of a direction (base frame); of joints that do not move no terms of their own values.
    #[must_use]
    pub fn new(robot: &Robot, gravity: Vector3<f64>, moves: &[bool]) -> Self {
        let mut robot = robot.clone();
        robot.gravity = Some(Gravity::of_unit_weights(&robot, gravity));
        let all: Vec<usize> = (0..robot.joints.len()).collect();
        let (mut robot, places) = robot.giving(&all);
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
            if !is_own || turns {
                let carried: Vec<usize> =
                    (0..weights).filter(|&weight| statics.is_carried(joint, weight)).collect();
                let group = if is_own { TermGroup::Sag } else { TermGroup::Tilt };
                let share = 1.0 / carried.len().max(1) as f64;
                carried.iter().for_each(|&weight| push(Term::Sag(Sag { weight }), group, share));
            }
            if !turns || !is_moving {
                continue;
            }
            let harmonic = |order, cosine| Term::Harmonic(Harmonic { order, cosine });
            if is_own {
                push(Term::Ratio, TermGroup::Ratio, 1.0);
                for order in 1..3 {
                    push(harmonic(order, false), TermGroup::Harmonics, 1.0);
                    push(harmonic(order, true), TermGroup::Harmonics, 1.0);
                }
            } else {
                push(harmonic(2, false), TermGroup::Wobble, 1.0);
                push(harmonic(2, true), TermGroup::Wobble, 1.0);
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

    /// Share of each term's variance in that of its group and joint.
    pub(super) fn shares(&self) -> impl Iterator<Item = f64> {
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

    /// Prior standard deviation of each term of the groups.
    #[must_use]
    pub fn priors(&self, sizes: &Sizes) -> Vec<TermPrior> {
        let each = self.terms().zip(self.groups.iter().zip(&self.shares));
        each.map(|((joint, term), (group, share))| TermPrior {
            joint,
            term,
            deviation: sizes[*group] * share.sqrt(),
        })
        .collect()
    }

    /// What a fit changes: what it changes of the robot without gives, and the terms.
    #[must_use]
    pub fn unknowns(&self, of_geometry: &Unknowns) -> Unknowns {
        let place = |joint: usize| self.places.get(joint).copied().unwrap_or(joint);
        let own = of_geometry.terms.iter().map(|&(joint, term)| (place(joint), term));
        let held = of_geometry.held_axes.iter().map(|&joint| place(joint));
        Unknowns {
            held_axes: held.chain(self.gives()).collect(),
            terms: own.chain(self.terms()).collect(),
            ..of_geometry.clone()
        }
    }

    /// The estimate of a robot without gives, as one of this model.
    #[must_use]
    pub fn estimate(&self, found: &Estimate, data: &Dataset) -> Estimate {
        let tree = Tree::of(&self.robot, data);
        let targets = found.base_from_target.clone();
        let mut estimate = Estimate::on(&self.robot, tree, targets, found.device_from_base);
        estimate.further_devices.clone_from(&found.further_devices);
        for (&place, frame) in self.places.iter().zip(&found.base_from_axis) {
            estimate.base_from_axis[place] = *frame;
        }
        for term in &found.terms {
            *estimate.coefficient_mut(self.places[term.joint], term.term) = term.coefficient;
        }
        estimate
    }
}

/// Whether each joint's value changes among some rows.
#[must_use]
pub(super) fn moving(robot: &Robot, packed: &Packed, rows: &[u32]) -> Vec<bool> {
    let range = |joint: usize| {
        let values = rows.iter().map(|&row| packed.joint_values(row as usize)[joint]);
        let (least, most) =
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), value| (a.min(value), b.max(value)));
        most - least
    };
    (0..robot.joints.len()).map(|joint| range(joint) > LEAST_RANGE_RAD).collect()
}
