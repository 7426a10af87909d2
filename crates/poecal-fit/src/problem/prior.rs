//! Gaussian prior: the axes are near nominal, and weakly the targets too (theory.md §6 (27a), (27c)).

use nalgebra::{SVector, Vector3, Vector6};

use super::Layout;
use super::deviations::{AxisDerivatives, AxisDeviation, Deviations, NominalAxis, NominalTarget};
use crate::parameters::{ClockUnknown, Parameter, ValueTerm};
use crate::state::{ClockTerm, Estimate, Session, nominal_estimate};
use poecal_arm::lie::{Pose, Twist};
use poecal_model::robot::{JointTerm, Robot, Term, Tolerance};
use poecal_numerics::linalg::Factor6;
use poecal_numerics::solve::NormalEquations;

/// Largest number of Gauss-Newton iterations for the motion of the base, which converge quadratically.
const ITERATIONS: usize = 20;
/// Converged step of the base (metres, radians): the gradient then moves no unknown by a picometre.
const FOUND: f64 = 1e-8;

/// Standard deviation of a target's position from its position in the model: a share of the robot's reach, and a least value in metres. A
/// reflector on any gripper or pointer is within it; the prior is decisive only if the measurements do not determine the position.
const TARGET_SHARE: f64 = 0.25;
const TARGET_LEAST_M: f64 = 0.3;

/// A Gaussian prior: each axis is near its nominal pose, with the standard deviations of a [`Tolerance`]. The axis has the direction d
/// (nominal d⁰), and q is its point nearest to the nominal joint's origin o (base frame). The deviation is `u = ((d - d⁰) / σ_angle; (q -
/// o) / σ_length)`; for a prismatic joint it is the first part alone. The cost is `½ Σ |u|²`. With an unknown device frame the base frame
/// is a choice, and the cost is minimal over motions of all axes (theory.md §6 (27a)). A target that moves with the robot has its position
/// t in the model at home too, `u = (t - t⁰) / max(0.3 m, reach / 4)`, but no orientation (27c).
#[derive(Clone, Debug, PartialEq)]
pub struct Prior {
    axes: Vec<NominalAxis>,
    targets: Vec<NominalTarget>,
    base_free: bool,
    /// Drifts of the clocks of stations with which readings were computed.
    drifts: Vec<f64>,
    terms: Vec<JointTerm>,
    term_priors: Vec<TermPrior>,
    /// True if terms and drifts of clocks have a prior.
    terms_count: bool,
    clocks_count: bool,
}

/// Prior standard deviation of a term of a joint's value, in the unit of its coefficient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TermPrior {
    /// Index of the joint.
    pub joint: usize,
    /// Term.
    pub term: Term,
    /// Standard deviation.
    pub deviation: f64,
}

impl Prior {
    /// Prior of a session's fit: of the robot's axes, and of the targets that move with it and are not open
    /// ([`Unknowns::open_targets`](crate::state::Unknowns::open_targets)).
    #[must_use]
    pub fn from_session(session: &Session<'_>, common: Tolerance) -> Self {
        let Session { robot, data, unknowns, .. } = *session;
        let nominal = nominal_estimate(robot, data);
        let is_shared = |target: usize| {
            (0..nominal.tree.instruments().len()).any(|station| nominal.tree.shared_target(station) == Some(target))
        };
        let bodies = nominal.tree.targets().iter().enumerate();
        let moving = bodies.filter(|(target, body)| body.joint().is_some() && !is_shared(*target));
        let widest_m = (TARGET_SHARE * robot.reach_m()).max(TARGET_LEAST_M);
        let sigma_m = unknowns.target_sigma_m.map_or(widest_m, |sigma| sigma.min(widest_m));
        let targets = moving
            .filter(|(target, _)| !unknowns.open_targets.contains(target))
            .filter_map(|(target, _)| {
                let place = nominal.base_from_target.get(target)?.translation;
                Some(NominalTarget { target, place, sigma_m })
            })
            .collect();
        let drift = |station: usize| data.moving.clock(station).map_or(0.0, |it| it.drift);
        let drifts = (0..data.station_count()).map(drift).collect();
        Prior { targets, drifts, ..Prior::new(robot, common, session.base_free()) }
    }

    /// Prior of a robot's axes alone; a joint's own tolerance replaces the common one. `base_free` is true if the device frame is unknown.
    #[must_use]
    pub fn new(robot: &Robot, common: Tolerance, base_free: bool) -> Self {
        let axes = robot.joints.iter().map(|joint| NominalAxis {
            direction: joint.screw.direction(),
            origin: joint.frame.translation,
            turns: !joint.screw.is_prismatic(),
            // A compliant joint has no axis of its own.
            tolerance: if joint.give_of.is_some() { Tolerance::NONE } else { joint.tolerance.unwrap_or(common) },
        });
        Prior {
            axes: axes.collect(),
            targets: Vec::new(),
            base_free,
            drifts: Vec::new(),
            terms: robot.terms.clone(),
            term_priors: Vec::new(),
            terms_count: true,
            clocks_count: true,
        }
    }

    /// The same prior with these priors of terms; others have those of their types ([`poecal_model::robot::JointKind::deviation_of`]).
    #[must_use]
    pub fn with_terms(mut self, term_priors: Vec<TermPrior>) -> Self {
        self.term_priors = term_priors;
        self
    }

    /// The same prior without terms.
    #[must_use]
    pub fn without_terms(mut self) -> Self {
        self.terms_count = false;
        self
    }

    /// `½ min_G Σ |u|²`: theory.md §6 (27a) for weight 1.
    #[must_use]
    pub fn cost(&self, estimate: &Estimate) -> f64 {
        self.at_best_base(estimate).0.cost()
    }

    /// Mean of `|u|²` for each unknown of the screws, at least 1, which divides the prior's weight (theory.md §6, below (27a)). The prior of
    /// a robot that is farther from nominal than its tolerances has a lower weight.
    #[must_use]
    pub fn looseness(&self, estimate: &Estimate) -> f64 {
        let counted = self.axes.iter().filter(|axis| axis.tolerance != Tolerance::NONE);
        let screws: usize = counted.map(|axis| if axis.turns { 4 } else { 2 }).sum();
        let free = screws.saturating_sub(if self.base_free { 6 } else { 0 }).max(1);
        (2.0 * self.at_best_base(estimate).0.cost_of_axes() / free as f64).max(1.0)
    }

    /// The same prior without targets.
    #[must_use]
    pub fn without_targets(&self) -> Self {
        Prior { targets: Vec::new(), ..self.clone() }
    }

    /// Largest standard deviation of the positions of targets, metres; `None` without a prior of targets.
    #[must_use]
    pub fn target_sigma_m(&self) -> Option<f64> {
        self.targets.iter().map(|target| target.sigma_m).reduce(f64::max)
    }

    /// The prior of the axes alone, and of the terms alone: parts with a weight each.
    pub(crate) fn parts(&self) -> [Self; 2] {
        let without = Prior { targets: Vec::new(), clocks_count: false, ..self.clone() };
        let terms = Prior { axes: Vec::new(), base_free: false, ..without.clone() };
        [without.without_terms(), terms]
    }

    /// Deviations after a motion of the base.
    fn deviations(&self, estimate: &Estimate, motion: Option<&Pose>) -> Deviations {
        let moved = |frame: &Pose| motion.map_or(*frame, |motion| *motion * *frame);
        let frames = estimate.base_from_axis.iter().map(moved);
        let axes: Vec<AxisDeviation> =
            self.axes.iter().zip(frames).map(|(nominal, frame)| AxisDeviation::new(nominal, &frame)).collect();
        let frame = |nominal: &NominalTarget| estimate.base_from_target.get(nominal.target).map(moved);
        let targets = self.targets.iter().filter_map(|it| Some(it.deviation(&frame(it)?))).collect();
        let by_base = self.base_free.then(|| {
            let targets = self.targets.iter().filter_map(|it| Some(it.by_base(&frame(it)?)));
            (axes.iter().map(AxisDeviation::by_base).collect(), targets.collect())
        });
        Deviations { axes, targets, by_base }
    }

    /// Deviations after the best motion of the base, and the factor of that motion's information.
    fn at_best_base(&self, estimate: &Estimate) -> (Deviations, Option<Factor6>) {
        let mut found = self.deviations(estimate, None);
        let mut motion = Pose::identity();
        for _ in 0..ITERATIONS {
            let Some((pull, factor)) = found.of_base() else { return (found, None) };
            let step = factor.solve(&-pull);
            if step.amax() < FOUND || !step.amax().is_finite() {
                return (found, Some(factor));
            }
            motion = (Pose::exp(&Twist::from_vector(&step)) * motion).orthonormalized();
            found = self.deviations(estimate, Some(&motion));
        }
        let factor = found.of_base().map(|(_, factor)| factor);
        (found, factor)
    }

    /// Adds `weight` times `½ Σ ((c - c⁰) / σ)²` of the terms of joint values that are unknown, with their nominal coefficients c⁰.
    fn add_terms(&self, estimate: &Estimate, layout: &Layout, weight: f64, normal: &mut NormalEquations) {
        let n = layout.dim();
        for (parameter, places) in layout.parameters() {
            let Some(&ValueTerm { joint, kind, term }) = parameter.value_term() else { continue };
            let nominal = self.terms.iter().find(|it| it.joint == joint && it.term == term);
            let own = self.term_priors.iter().find(|it| it.joint == joint && it.term == term);
            let sigma = own.map_or_else(|| kind.deviation_of(term), |it| it.deviation);
            let value = (estimate.coefficient(joint, term) - nominal.map_or(0.0, |it| it.coefficient)) / sigma;
            normal.cost += 0.5 * weight * value * value;
            for &(place, scale) in places {
                normal.gradient[place] -= weight * value / (sigma * scale);
                if let Some(information) = normal.gram.get_mut(place * n + place) {
                    *information += weight / (sigma * scale).powi(2);
                }
            }
        }
    }

    /// Adds `weight` times `½ (d / σ)²` of the drifts of clocks that are unknown.
    fn add_clocks(&self, estimate: &Estimate, layout: &Layout, weight: f64, normal: &mut NormalEquations) {
        let (n, sigma) = (layout.dim(), ClockTerm::DRIFT_DEVIATION);
        for (parameter, places) in layout.parameters() {
            let Parameter::ClockUnknown(ClockUnknown { station, term: ClockTerm::Drift }) = *parameter else {
                continue;
            };
            let known = self.drifts.get(station).copied().unwrap_or_default();
            let value = (known + estimate.clock(station).drift) / sigma;
            normal.cost += 0.5 * weight * value * value;
            for &(place, scale) in places {
                normal.gradient[place] -= weight * value / (sigma * scale);
                if let Some(information) = normal.gram.get_mut(place * n + place) {
                    *information += weight / (sigma * scale).powi(2);
                }
            }
        }
    }

    /// Adds `weight` times the prior to the normal information of a layout's unknowns: to the upper triangle of `JᵀJ` (unless that is
    /// empty), to the gradient and to the cost, with the base eliminated (theory.md §6 (27a)).
    pub fn add(&self, estimate: &Estimate, layout: &Layout, weight: f64, normal: &mut NormalEquations) {
        let (deviations, base) = self.at_best_base(estimate);
        let n = layout.dim();
        if self.terms_count {
            self.add_terms(estimate, layout, weight, normal);
        }
        if self.clocks_count {
            self.add_clocks(estimate, layout, weight, normal);
        }
        // Products of each unknown's column with those of the base.
        let by_base = deviations.by_base.as_ref().filter(|_| !normal.gram.is_empty());
        let mut shared: Vec<(usize, Vector6<f64>)> = Vec::new();
        for (parameter, places) in layout.parameters() {
            if let Some(axis) = parameter.screw_axis() {
                let Some(deviation) = deviations.axes.get(axis.joint) else { continue };
                let own = deviation.own_motions();
                add_axis((places, &own), &deviation.value, weight, n, normal);
                if let Some(base) = by_base.and_then(|(axes, _)| axes.get(axis.joint)) {
                    let own = own.columns();
                    shared.extend(
                        places
                            .iter()
                            .zip(&own[4 - places.len()..])
                            .map(|((at, scale), own)| (*at, base.tr_mul(own) / *scale)),
                    );
                }
            } else if let Some((target, motions)) = parameter.target_motions() {
                let Some(at) = deviations.targets.iter().position(|it| it.target == target) else { continue };
                let deviation = &deviations.targets[at];
                // The shifts are the first motions of a target.
                let count = motions.iter().take_while(|motion| **motion < 3).count();
                let (mut own, places) = ([Vector3::zeros(); 3], &places[..count]);
                for (own, &motion) in own.iter_mut().zip(&motions[..count]) {
                    *own = deviation.own.column(motion).into_owned();
                }
                let own = &own[..count];
                add_columns((places, own), &deviation.value, weight, n, normal);
                if let Some(base) = by_base.and_then(|(_, targets)| targets.get(at)) {
                    shared.extend(places.iter().zip(own).map(|((at, scale), own)| (*at, base.tr_mul(own) / *scale)));
                }
            }
        }
        normal.cost += weight * deviations.cost();
        let Some(base) = base else { return };
        let lower = base.l_dirty();
        for (_, pull) in &mut shared {
            lower.solve_lower_triangular_mut(pull);
        }
        for (k, (place, followed)) in shared.iter().enumerate() {
            for (other, also) in &shared[k..] {
                normal.gram[place.min(other) * n + place.max(other)] -= weight * followed.dot(also);
            }
        }
    }
}

/// The same as [`add_columns`] for an axis: with the shifts and turns of a revolute joint, or the turns of a prismatic one.
fn add_axis(
    (places, own): (&[(usize, f64)], &AxisDerivatives),
    value: &Vector6<f64>,
    weight: f64,
    n: usize,
    normal: &mut NormalEquations,
) {
    let first = 4 - places.len().min(4);
    for (k, &(place, scale)) in (first..4).zip(places) {
        normal.gradient[place] -= weight / scale * own.column_product(k, value);
    }
    if normal.gram.is_empty() {
        return;
    }
    for (k, &(place, scale)) in (first..4).zip(places) {
        for (l, &(other, other_scale)) in (first..4).zip(places).skip(k - first) {
            normal.gram[place.min(other) * n + place.max(other)] += weight / (scale * other_scale) * own.product(k, l);
        }
    }
}

/// Adds `weight` times the products of a deviation's columns, each over the scale of its place in a step. Products with each other go to the
/// upper triangle of `JᵀJ` (unless that is empty), those with the deviation to the gradient.
fn add_columns<const N: usize>(
    (places, own): (&[(usize, f64)], &[SVector<f64, N>]),
    value: &SVector<f64, N>,
    weight: f64,
    n: usize,
    normal: &mut NormalEquations,
) {
    for (k, (&(place, scale), column)) in places.iter().zip(own).enumerate() {
        normal.gradient[place] -= weight / scale * column.dot(value);
        if normal.gram.is_empty() {
            continue;
        }
        for (&(other, other_scale), other_column) in places.iter().zip(own).skip(k) {
            normal.gram[place.min(other) * n + place.max(other)] +=
                weight / (scale * other_scale) * column.dot(other_column);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_arm::lie::Screw;
    use poecal_model::robot::Joint;

    #[test]
    fn two_axes_share_their_distance() {
        let joint = |name: &str, x: f64| Joint::revolute(name, Screw::revolute(&Vector3::z(), &(x * Vector3::x())));
        let robot = Robot::new("r", vec![joint("a", 0.0), joint("b", 0.5)], Pose::identity()).unwrap();
        let tolerance = Tolerance { length_m: 0.004, ..Tolerance::default() };
        let prior = Prior::new(&robot, tolerance, true);
        let mut estimate = Estimate::new(&robot, vec![robot.home], Pose::identity());
        // Both axes are 10 mm farther apart: 5 mm each, with a standard deviation of 4 mm.
        estimate.base_from_axis[1].translation.x += 0.01;
        assert!((prior.cost(&estimate) - 2.0 * 0.5 * (0.005_f64 / 0.004).powi(2)).abs() < 1e-9);
    }
}
