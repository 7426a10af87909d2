//! Levenberg-Marquardt on a manifold with geodesic acceleration and, near the optimum of a curved problem, the full Hessian
//! (theory.md §6 (29) to (31); more1978, transtrum2012, dennis1981).

use super::normal::{ROUNDING, quadratic};
use super::reuse::Reuse;
use super::scaling::ScaledProblem;
use super::{LeastSquares, NormalEquations, Options, Scaling, Summary, Termination, refine};
pub(crate) use crate::linalg::dot;
use crate::linalg::{self, Factor};

/// Largest ratio of a geodesic correction to the step that it corrects (transtrum2012).
const LARGEST_ACCELERATION: f64 = 0.75;

/// Share of the cost that is its rounding: a smaller reduction is invisible.
const COST_ROUNDING: f64 = 1e-15;

/// Smallest gain ratio of an accepted step.
const ACCEPTED: f64 = 1e-3;

/// Gain ratios of a nearly quadratic problem.
const STRAIGHT: std::ops::Range<f64> = 0.8..1.25;

/// Minimises from `start`; returns the final state, its normal information and a summary.
///
/// Cost and gradient are those of the final state, or the prediction of the quadratic model for a final step too small to be evaluated.
/// `JᵀJ` may be that of an earlier state close by ([`Options::reuse`]), and is only [nearly](LeastSquares::nearly_normal) exact. At the
/// optimum, [`LeastSquares::normal`] computes it exactly (theory.md §6, *Few passes*).
pub fn minimize<P: LeastSquares>(
    problem: &P,
    start: P::State,
    options: &Options,
) -> (P::State, NormalEquations, Summary) {
    let mut search = LevenbergMarquardtSearch::new(problem, start, *options);
    let termination = search.run();
    search.problem.restore(&mut search.normal);
    let summary = Summary { iterations: search.iterations, termination, trace: search.trace };
    (search.state, search.normal, summary)
}

struct LevenbergMarquardtSearch<'a, P: LeastSquares> {
    problem: ScaledProblem<'a, P>,
    options: Options,
    state: P::State,
    /// Normal information of this state; with the `JᵀJ` of an earlier one while that is frozen.
    normal: NormalEquations,
    /// State of the policy that freezes `JᵀJ`.
    reuse: Reuse,
    /// Upper triangle of the matrix that steps are solved with: `JᵀJ`, or the full Hessian if that is known and convex.
    hessian: Vec<f64>,
    /// Factor of this matrix with the last damping; `None` if that failed, or since it changed.
    factor: Option<(f64, Factor)>,
    /// Damping as a multiple of the mean squared residual.
    damping: f64,
    /// Factor of the next increase of the damping (nielsen1999): doubles with every rejection in a row.
    increase: f64,
    /// True if a step has revealed a poor quadratic model: from then on steps follow curvature, and damping falls with care.
    nonlinear: bool,
    iterations: usize,
    trace: Vec<f64>,
}

impl<'a, P: LeastSquares> LevenbergMarquardtSearch<'a, P> {
    fn new(problem: &'a P, state: P::State, options: Options) -> Self {
        let mut problem = ScaledProblem::new(problem, options.scaling);
        let mut normal = problem.nearly_normal(&state);
        problem.adapt(&mut normal);
        let damping = match options.scaling {
            Scaling::Given => 1.0 / (options.trust * options.trust),
            Scaling::Columns { damping } => damping / normal.mean_square(),
        };
        LevenbergMarquardtSearch {
            problem,
            options,
            state,
            hessian: normal.gram.clone(),
            factor: None,
            trace: vec![normal.mean_square()],
            normal,
            reuse: Reuse::new(options.reuse),
            damping,
            increase: 2.0,
            nonlinear: false,
            iterations: 0,
        }
    }

    fn run(&mut self) -> Termination {
        if !self.normal.cost.is_finite() {
            return Termination::NotFinite;
        }
        loop {
            let mut trial = self.damped_step();
            if self.reuse.must_rebuild(trial.as_ref().map(|trial| trial.predicted), self.normal.cost) {
                self.rebuild_normal();
                trial = self.damped_step();
            }
            if let Some(termination) = trial.as_ref().and_then(|trial| self.end_with_frozen_jtj(trial)) {
                return termination;
            }
            if !trial.as_ref().is_some_and(|trial| self.rules_out_convergence(trial))
                && let Some(termination) = self.check_convergence()
            {
                return termination;
            }
            if self.iterations >= self.options.iterations {
                return Termination::IterationLimit;
            }
            if !self.try_step(trial) {
                self.refine();
                return Termination::NoProgress;
            }
        }
    }

    /// Largest diagonal element of `JᵀJ`, to which rounding errors are proportional.
    fn scale(&self) -> f64 {
        let n = self.problem.dim();
        (0..n).map(|i| self.normal.gram[i * n + i]).fold(0.0, f64::max)
    }

    // Matrix of the normal equations.

    /// Takes the full Hessian if it is convex; far from the optimum it seldom is, and `JᵀJ` leads better there.
    fn rebuild_hessian(&mut self) {
        self.factor = None;
        self.hessian.copy_from_slice(&self.normal.gram);
        if !(self.nonlinear && self.options.acceleration) {
            return;
        }
        let n = self.problem.dim();
        let Some(curvature) = self.problem.curvature(&self.state) else { return };
        let full: Vec<f64> = self.normal.gram.iter().zip(&curvature).map(|(gram, s)| gram + s).collect();
        if linalg::cholesky(&full, n, ROUNDING * self.scale()).is_some() {
            self.hessian = full;
        }
    }

    /// Replaces a frozen `JᵀJ` by that of the state.
    fn rebuild_normal(&mut self) {
        self.reuse.note_rebuilt();
        self.normal = self.problem.nearly_normal(&self.state);
        self.problem.adapt(&mut self.normal);
        self.rebuild_hessian();
    }

    /// True if no direction is so weak that `JᵀJ` along it would change with a small step.
    fn is_well_conditioned(&self) -> bool {
        self.factor.as_ref().is_some_and(|(_, factor)| Reuse::is_well_conditioned(factor, self.scale()))
    }

    // Step.

    /// Step of the damped normal equations; with a frozen `JᵀJ`, which is close to the optimum, damped by rounding alone. `None` if
    /// they are not positive definite.
    fn damped_step(&mut self) -> Option<TrialStep> {
        let floor = ROUNDING * self.scale();
        let damping =
            if self.reuse.is_frozen() { floor } else { (self.damping * self.normal.mean_square()).max(0.1 * floor) };
        if self.factor.as_ref().is_none_or(|&(before, _)| before != damping) {
            let factor = linalg::cholesky(&self.hessian, self.problem.dim(), damping);
            self.factor = factor.map(|factor| (damping, factor));
        }
        let (_, factor) = self.factor.as_ref()?;
        let velocity = linalg::cholesky_solve(factor, &self.normal.gradient);
        let kept = self.kept_step(&velocity);
        let is_cut = kept != velocity;
        let damped = damping * dot(&velocity, &velocity);
        let predicted = if is_cut {
            quadratic(&self.hessian, &self.normal.gradient, &kept)
        } else {
            predicted_reduction(1.0, dot(&velocity, &self.normal.gradient), damped)
        };
        Some(TrialStep { step: velocity, predicted, shortened: false, damping, is_cut })
    }

    /// Damped step `v`, or the point `t v + t² a / 2` of the parabola that follows the residuals' curvature. Here t is below one
    /// if the acceleration `a` would overtake `v`. `None` if less than the shortest part remains.
    fn geodesic_step(&self, trial: TrialStep) -> Option<TrialStep> {
        if !(self.options.acceleration && self.nonlinear) || trial.is_cut {
            return Some(trial);
        }
        let Some((_, factor)) = &self.factor else { return Some(trial) };
        let velocity = &trial.step;
        let second = self.problem.second_order(&self.state, velocity);
        let acceleration = linalg::cholesky_solve(factor, &second);
        let t = (LARGEST_ACCELERATION * norm(velocity) / norm(&acceleration)).min(1.0);
        if t < self.options.shortest || norm(&acceleration).is_nan() {
            return None;
        }
        let step = velocity.iter().zip(&acceleration).map(|(v, a)| t * v + 0.5 * t * t * a).collect();
        let descent = dot(velocity, &self.normal.gradient);
        let predicted = predicted_reduction(t, descent, trial.damping * dot(velocity, velocity));
        Some(TrialStep { step, predicted, shortened: t < 1.0, ..trial })
    }

    /// Part of a step that the retraction keeps, to first order.
    fn kept_step(&self, step: &[f64]) -> Vec<f64> {
        let mut kept = step.to_vec();
        self.problem.project_constraints(&mut kept);
        kept
    }

    // Judgement of the step.

    /// Tries one step; `false` if steps have become too small to matter without success.
    fn try_step(&mut self, trial: Option<TrialStep>) -> bool {
        self.iterations += 1;
        let Some(trial) = trial else {
            self.trace.push(self.normal.mean_square());
            self.damping *= 10.0;
            return self.damping.is_finite();
        };
        let Some(trial) = self.geodesic_step(trial) else {
            self.reject();
            return self.damping.is_finite();
        };
        if trial.predicted <= 0.0 {
            // The part of the step that the retraction keeps leads upwards; a shorter step is nearer to the gradient.
            self.reject();
            return norm(&trial.step) > self.options.rejected_step && self.damping.is_finite();
        }
        let state = self.problem.retract(&self.state, &trial.step);
        let without_jtj = self.evaluate_without_jtj(&state, trial.predicted);
        let is_frozen = without_jtj.is_some();
        let normal = without_jtj.unwrap_or_else(|| self.problem.nearly_normal(&state));
        let gain = (self.normal.cost - normal.cost) / trial.predicted;
        if normal.cost.is_finite() && gain > ACCEPTED {
            // With a frozen `JᵀJ` the model is not the problem's own, and its gain ratio has no information on the problem's curvature.
            self.nonlinear |= !self.reuse.is_frozen() && !STRAIGHT.contains(&gain);
            self.reuse.note_accepted(trial.predicted, is_frozen);
            self.accept(state, normal, if trial.shortened { gain.min(0.5) } else { gain });
            return true;
        }
        if self.reuse.is_frozen() {
            // The step may have failed because of its frozen `JᵀJ`.
            self.trace.push(self.normal.mean_square());
            self.rebuild_normal();
            return true;
        }
        let before = self.nonlinear;
        self.reject();
        if !before {
            self.rebuild_hessian();
        }
        // Shorter steps that do not help, or whose predicted reduction the cost cannot show, are rounding themselves.
        norm(&trial.step) > self.options.rejected_step
            && trial.predicted > COST_ROUNDING * self.normal.cost
            && self.damping.is_finite()
    }

    /// Residuals and gradient at the end of a step, for the `JᵀJ` of its start; `None` if the end needs its own.
    fn evaluate_without_jtj(&self, state: &P::State, predicted: f64) -> Option<NormalEquations> {
        let cost = self.normal.cost;
        if self.nonlinear || !self.reuse.may_freeze(predicted, cost, || self.is_well_conditioned()) {
            return None;
        }
        self.problem.gradient(state)
    }

    /// Accepts the step, and lowers the damping more for a better prediction of the reduction (nielsen1999).
    fn accept(&mut self, state: P::State, mut normal: NormalEquations, gain: f64) {
        self.damping *= if gain <= 0.5 {
            (1.0 - (2.0 * gain - 1.0).powi(3)).min(2.0)
        } else if self.nonlinear {
            0.3
        } else {
            0.1
        };
        self.increase = 2.0;
        self.state = state;
        if self.reuse.is_frozen() {
            normal.gram = std::mem::take(&mut self.normal.gram);
        }
        self.normal = normal;
        self.trace.push(self.normal.mean_square());
        if !self.reuse.is_frozen() {
            self.problem.adapt(&mut self.normal);
            self.rebuild_hessian();
        } else if self.nonlinear {
            self.rebuild_normal();
        }
    }

    /// Rejects the step, and raises the damping.
    fn reject(&mut self) {
        self.nonlinear = true;
        self.trace.push(self.normal.mean_square());
        self.damping *= self.increase;
        self.increase *= 2.0;
    }

    // End of the search.

    /// Continues by the gradient if the cost cannot resolve the reductions of the stopping rule.
    fn refine(&mut self) {
        if self.options.decrement * self.normal.mean_square() < COST_ROUNDING * self.normal.cost {
            let most = self.options.iterations.saturating_sub(self.iterations);
            let floor = ROUNDING * self.scale();
            let steps = refine::refine(&self.problem, &mut self.state, &mut self.normal, &self.hessian, floor, most);
            self.iterations += steps;
            self.trace.extend(std::iter::repeat_n(self.normal.mean_square(), steps));
        }
    }

    /// Reason why an undamped step is not worth taking; `None` if it is.
    fn stopping_rule(&self, step: &[f64], predicted: f64) -> Option<Termination> {
        if norm(step) < self.options.step || self.normal.mean_square() < self.problem.rounding() {
            return Some(Termination::StepVanished);
        }
        (predicted < self.options.decrement * self.normal.mean_square()).then_some(Termination::Optimum)
    }

    /// True if a damped step already proves that the stopping rule does not hold for the undamped one. That one is longer and has
    /// the larger predicted reduction.
    fn rules_out_convergence(&self, trial: &TrialStep) -> bool {
        !trial.is_cut
            && trial.damping >= ROUNDING * self.scale()
            && 0.5 * dot(&trial.step, &self.normal.gradient) >= self.options.decrement * self.normal.mean_square()
            && norm(&trial.step) >= self.options.step
            && self.normal.mean_square() >= self.problem.rounding()
    }

    /// Applies the stopping rule to the undamped step (damped by rounding alone).
    fn check_convergence(&self) -> Option<Termination> {
        let n = self.problem.dim();
        let floor = ROUNDING * self.scale();
        if n == 0 || floor == 0.0 {
            return Some(Termination::Optimum);
        }
        let factor = linalg::cholesky(&self.hessian, n, floor)?;
        let step = linalg::cholesky_solve(&factor, &self.normal.gradient);
        let kept = self.kept_step(&step);
        let (predicted, step) = if kept == step {
            (0.5 * dot(&step, &self.normal.gradient), step)
        } else {
            (quadratic(&self.hessian, &self.normal.gradient, &kept).abs(), kept)
        };
        self.stopping_rule(&step, predicted)
    }

    /// Applies the stopping rule to a step with a frozen `JᵀJ`, which is undamped; takes it without an evaluation if it is the final one.
    fn end_with_frozen_jtj(&mut self, trial: &TrialStep) -> Option<Termination> {
        if !self.reuse.is_frozen() || trial.is_cut {
            return None;
        }
        if let Some(termination) = self.stopping_rule(&trial.step, trial.predicted) {
            return Some(termination);
        }
        let threshold = self.options.decrement * self.normal.mean_square();
        if !self.reuse.is_final_step(trial.predicted, threshold) || self.iterations >= self.options.iterations {
            return None;
        }
        self.iterations += 1;
        self.state = self.problem.retract(&self.state, &trial.step);
        self.normal.take_final_step(trial.predicted);
        self.trace.push(self.normal.mean_square());
        Some(Termination::Optimum)
    }
}

/// A step to try.
struct TrialStep {
    step: Vec<f64>,
    /// Predicted reduction: the decrease of the cost by the quadratic model.
    predicted: f64,
    /// True if the step ends before `v + a / 2`.
    shortened: bool,
    damping: f64,
    /// True if the retraction drops a part of the step.
    is_cut: bool,
}

/// Predicted reduction at t of the parabola: `t gᵀv - t² vᵀHv / 2`, where vᵀHv is gᵀv less the part of the damping.
fn predicted_reduction(t: f64, descent: f64, damped: f64) -> f64 {
    t * descent - 0.5 * t * t * (descent - damped)
}

pub(crate) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}
