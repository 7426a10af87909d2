//! Levenberg-Marquardt on a manifold with geodesic acceleration and, near the optimum of a curved problem, the full Hessian
//! (theory.md §6 (29) to (31); more1978, transtrum2012, dennis1981).

use super::normal::quadratic;
use super::{LeastSquares, Normal, Options, Summary, Termination};
pub(super) use crate::linalg::dot;
use crate::linalg::{self, Factor};

/// Most a geodesic correction may be of the step that it corrects (transtrum2012).
const LARGEST_ACCELERATION: f64 = 0.75;

/// A step of this length (scaled units: metres) that fails to lower the cost ends the search.
const ROUNDING_STEP: f64 = 1e-9;

/// Share of the largest diagonal element that rounding makes of the normal equations' small eigenvalues.
pub(super) const ROUNDING: f64 = 1e-13;

/// Gain ratios of a problem that is as good as quadratic.
const STRAIGHT: std::ops::Range<f64> = 0.8..1.25;

/// A step that promises less than this share of the cost starts close to the optimum, as far as the residuals can tell: it moves far
/// less than `JᵀJ` would notice.
const NEAR: f64 = 5e-2;

/// Steps with an old `JᵀJ` converge fast if each promises less than this share of what the one before promised.
pub(super) const FAST: f64 = 1e-2;

/// Share of the largest diagonal element which the smallest pivot must exceed for every direction to be firm: unknowns a thousand
/// times less certain than others hang on what small steps change, as the tool does that lies on the last axis.
const FIRM: f64 = 1e-6;

/// Where steps converge fast, the next one promises about as small a share again; if that is below this times what would end the
/// search, the step at hand is the last, and what it does is not computed but taken from the model.
const SURE: f64 = 1e-2;

/// Whether a step is sure to be the last, by what it promises, what the one before did, and what would end the search.
pub(super) fn is_sure(promise: f64, before: f64, end: f64) -> bool {
    let share = promise / before;
    before.is_finite() && share < FAST && share * promise < SURE * end
}

/// Minimises from `start`; gives the state reached, its normal information and a summary.
///
/// Cost and gradient are those of the state reached, or what the quadratic model promises of a last step too small to be worth
/// computing. `JᵀJ` may be that of an earlier state close by, since the last steps do not need it anew, and is
/// [nearly](LeastSquares::nearly_normal) what it should be: who needs it at the optimum asks for [`LeastSquares::normal`] there
/// (theory.md §6, *Few passes*).
pub fn minimize<P: LeastSquares>(
    problem: &P,
    start: P::State,
    options: &Options,
) -> (P::State, Normal, Summary) {
    let mut search = Search::new(problem, start, *options);
    let termination = search.run();
    let summary = Summary { iterations: search.iterations, termination, trace: search.trace };
    (search.state, search.normal, summary)
}

struct Search<'a, P: LeastSquares> {
    problem: &'a P,
    options: Options,
    state: P::State,
    /// Of this state; while `is_old`, with the `JᵀJ` of an earlier one close by.
    normal: Normal,
    is_old: bool,
    /// Upper triangle of what steps are solved with: `JᵀJ`, or the full Hessian where that is known and convex.
    hessian: Vec<f64>,
    /// Its factor with the damping it was last factorised with; none where that failed, or since it changed.
    factor: Option<(f64, Factor)>,
    /// Damping as a multiple of the mean squared residual.
    damping: f64,
    /// Factor of the next increase of the damping (Nielsen): doubles with every rejection in a row.
    increase: f64,
    /// Whether a step has shown a poor quadratic model: from then on steps follow curvature, and damping falls with care.
    nonlinear: bool,
    /// What the step before promised.
    promised: f64,
    /// Whether fast steps so far have led to where residuals are left that the model does not explain, and not on to nothing.
    has_floor: bool,
    iterations: usize,
    trace: Vec<f64>,
}

impl<'a, P: LeastSquares> Search<'a, P> {
    fn new(problem: &'a P, state: P::State, options: Options) -> Self {
        let normal = problem.nearly_normal(&state);
        Search {
            problem,
            options,
            state,
            hessian: normal.gram.clone(),
            factor: None,
            trace: vec![normal.mean_square()],
            normal,
            is_old: false,
            damping: 1.0 / (options.trust * options.trust),
            increase: 2.0,
            nonlinear: false,
            promised: f64::INFINITY,
            has_floor: true,
            iterations: 0,
        }
    }

    fn run(&mut self) -> Termination {
        if !self.normal.cost.is_finite() {
            return Termination::NotFinite;
        }
        loop {
            let mut trial = self.damped_step();
            if self.is_old && trial.as_ref().is_none_or(|trial| trial.predicted > NEAR * self.normal.cost) {
                // Residuals without noise: each step goes as far as `JᵀJ` is right.
                self.has_floor = false;
                self.renew_normal();
                trial = self.damped_step();
            }
            if let Some(termination) = trial.as_ref().and_then(|trial| self.near(trial)) {
                return termination;
            }
            if !trial.as_ref().is_some_and(|trial| self.is_open(trial))
                && let Some(termination) = self.converged()
            {
                return termination;
            }
            if self.iterations >= self.options.iterations {
                return Termination::IterationLimit;
            }
            if !self.iterate(trial) {
                return Termination::NoProgress;
            }
        }
    }

    /// Largest diagonal element of the Gram matrix: the scale of what rounding can tell.
    fn scale(&self) -> f64 {
        let n = self.problem.dim();
        (0..n).map(|i| self.normal.gram[i * n + i]).fold(0.0, f64::max)
    }

    /// Takes the full Hessian where it is convex; far from the optimum it seldom is, and `JᵀJ` leads better there.
    fn renew_hessian(&mut self) {
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

    /// Replaces the `JᵀJ` of an earlier state.
    fn renew_normal(&mut self) {
        self.is_old = false;
        self.normal = self.problem.nearly_normal(&self.state);
        self.renew_hessian();
    }

    /// Judges a step with an old `JᵀJ`, which is undamped; takes it if it is sure to be the last.
    fn near(&mut self, trial: &Trial) -> Option<Termination> {
        if !self.is_old || trial.is_cut {
            return None;
        }
        if let Some(termination) = self.is_last(&trial.step, trial.predicted) {
            return Some(termination);
        }
        let end = self.options.decrement * self.normal.mean_square();
        if !is_sure(trial.predicted, self.promised, end) || self.iterations >= self.options.iterations {
            return None;
        }
        self.iterations += 1;
        self.state = self.problem.retract(&self.state, &trial.step);
        self.normal.end(trial.predicted);
        self.trace.push(self.normal.mean_square());
        Some(Termination::Optimum)
    }

    /// Whether an undamped step that promises `decrement` is not worth taking.
    fn is_last(&self, step: &[f64], decrement: f64) -> Option<Termination> {
        if norm(step) < self.options.step || self.normal.mean_square() < self.problem.rounding() {
            return Some(Termination::StepVanished);
        }
        (decrement < self.options.decrement * self.normal.mean_square()).then_some(Termination::Optimum)
    }

    /// Whether a damped step already shows that the undamped one, which is longer and promises more, is not the last.
    fn is_open(&self, trial: &Trial) -> bool {
        !trial.is_cut
            && trial.damping >= ROUNDING * self.scale()
            && 0.5 * dot(&trial.step, &self.normal.gradient)
                >= self.options.decrement * self.normal.mean_square()
            && norm(&trial.step) >= self.options.step
            && self.normal.mean_square() >= self.problem.rounding()
    }

    /// Judges the undamped step (damped only by rounding).
    fn converged(&self) -> Option<Termination> {
        let n = self.problem.dim();
        let floor = ROUNDING * self.scale();
        if n == 0 || floor == 0.0 {
            return Some(Termination::Optimum);
        }
        let factor = linalg::cholesky(&self.hessian, n, floor)?;
        let step = linalg::cholesky_solve(&factor, &self.normal.gradient);
        let kept = self.kept(&step);
        let (decrement, step) = if kept == step {
            (0.5 * dot(&step, &self.normal.gradient), step)
        } else {
            (quadratic(&self.hessian, &self.normal.gradient, &kept).abs(), kept)
        };
        self.is_last(&step, decrement)
    }

    /// What the retraction keeps of a step, to first order.
    fn kept(&self, step: &[f64]) -> Vec<f64> {
        let mut kept = step.to_vec();
        self.problem.project_constraints(&mut kept);
        kept
    }

    /// One trial step; `false` when steps have become too small to matter without having helped.
    fn iterate(&mut self, trial: Option<Trial>) -> bool {
        self.iterations += 1;
        let Some(trial) = trial.map(|trial| self.bent(trial)) else {
            self.trace.push(self.normal.mean_square());
            self.damping *= 10.0;
            return self.damping.is_finite();
        };
        if trial.predicted <= 0.0 {
            // What the retraction keeps of the step leads upwards; a shorter one is nearer to the gradient.
            self.reject();
            return norm(&trial.step) > ROUNDING_STEP && self.damping.is_finite();
        }
        let state = self.problem.retract(&self.state, &trial.step);
        let old = self.gradient_only(&state, trial.predicted);
        let is_old = old.is_some();
        let normal = old.unwrap_or_else(|| self.problem.nearly_normal(&state));
        let gain = (self.normal.cost - normal.cost) / trial.predicted;
        if normal.cost.is_finite() && gain > 1e-3 {
            // With an old `JᵀJ` the model is not the problem's own, and says nothing of how curved that is.
            let is_fair = !self.is_old;
            self.promised = trial.predicted;
            self.is_old = is_old;
            self.nonlinear |= is_fair && !STRAIGHT.contains(&gain);
            self.accept(state, normal, if trial.shortened { gain.min(0.5) } else { gain });
            return true;
        }
        if self.is_old {
            // The step may have failed by its old `JᵀJ`.
            self.trace.push(self.normal.mean_square());
            self.renew_normal();
            return true;
        }
        let before = self.nonlinear;
        self.reject();
        if !before {
            self.renew_hessian();
        }
        // Steps below a nanometre that do not help, or promise less than rounding, are rounding themselves.
        norm(&trial.step) > ROUNDING_STEP
            && trial.predicted > 1e-15 * self.normal.cost
            && self.damping.is_finite()
    }

    /// Residuals and gradient at a new state beside the `JᵀJ` of the old one, where that will do for a further step: where steps converge
    /// so fast that `JᵀJ` can hardly have changed, or where the model already fits but for a little, so that this step is short.
    fn gradient_only(&self, state: &P::State, predicted: f64) -> Option<Normal> {
        let falls = self.has_floor && self.promised.is_finite() && predicted < FAST * self.promised;
        let is_fast = falls && (self.is_old || self.is_firm());
        let is_near = !self.is_old && predicted < NEAR * self.normal.cost;
        if self.nonlinear || !(is_fast || is_near) {
            return None;
        }
        let mut normal = self.problem.gradient(state)?;
        normal.gram.clone_from(&self.normal.gram);
        Some(normal)
    }

    /// Whether no direction is so weak that `JᵀJ` along it would change with a small step.
    fn is_firm(&self) -> bool {
        self.factor.as_ref().is_some_and(|(_, factor)| factor.smallest_pivot() > FIRM * self.scale())
    }

    /// The damped step as it stands; with an old `JᵀJ`, which is close to the optimum, undamped but for rounding.
    fn damped_step(&mut self) -> Option<Trial> {
        let floor = ROUNDING * self.scale();
        let damping =
            if self.is_old { floor } else { (self.damping * self.normal.mean_square()).max(0.1 * floor) };
        if self.factor.as_ref().is_none_or(|&(before, _)| before != damping) {
            let factor = linalg::cholesky(&self.hessian, self.problem.dim(), damping);
            self.factor = factor.map(|factor| (damping, factor));
        }
        let (_, factor) = self.factor.as_ref()?;
        let velocity = linalg::cholesky_solve(factor, &self.normal.gradient);
        let kept = self.kept(&velocity);
        let is_cut = kept != velocity;
        let damped = damping * dot(&velocity, &velocity);
        let predicted = if is_cut {
            quadratic(&self.hessian, &self.normal.gradient, &kept)
        } else {
            promise(1.0, dot(&velocity, &self.normal.gradient), damped)
        };
        Some(Trial { step: velocity, predicted, shortened: false, damping, is_cut })
    }

    /// The damped step `v`, or the point `t v + t² a / 2` of the parabola that follows the residuals' curvature, with t below one
    /// where the acceleration `a` would overtake `v`.
    fn bent(&self, trial: Trial) -> Trial {
        if !(self.options.acceleration && self.nonlinear) || trial.is_cut {
            return trial;
        }
        let Some((_, factor)) = &self.factor else { return trial };
        let velocity = &trial.step;
        let second = self.problem.second_order(&self.state, velocity);
        let acceleration = linalg::cholesky_solve(factor, &second);
        let t = (LARGEST_ACCELERATION * norm(velocity) / norm(&acceleration)).min(1.0);
        let step = velocity.iter().zip(&acceleration).map(|(v, a)| t * v + 0.5 * t * t * a).collect();
        let predicted =
            promise(t, dot(velocity, &self.normal.gradient), trial.damping * dot(velocity, velocity));
        Trial { step, predicted, shortened: t < 1.0, ..trial }
    }

    fn accept(&mut self, state: P::State, normal: Normal, gain: f64) {
        self.damping *= if gain <= 0.5 {
            (1.0 - (2.0 * gain - 1.0).powi(3)).min(2.0)
        } else if self.nonlinear {
            0.3
        } else {
            0.1
        };
        self.increase = 2.0;
        self.state = state;
        self.normal = normal;
        self.trace.push(self.normal.mean_square());
        if self.is_old && self.nonlinear {
            self.renew_normal();
        } else if !self.is_old {
            self.renew_hessian();
        }
    }

    fn reject(&mut self) {
        self.nonlinear = true;
        self.trace.push(self.normal.mean_square());
        self.damping *= self.increase;
        self.increase *= 2.0;
    }
}

/// A step to try, and the decrease of the cost that the quadratic model promises.
struct Trial {
    step: Vec<f64>,
    predicted: f64,
    shortened: bool,
    damping: f64,
    /// Whether the retraction drops something of the step.
    is_cut: bool,
}

/// What the model promises along the parabola: `t gᵀv - t² vᵀHv / 2`, and vᵀHv is gᵀv less what the damping takes.
fn promise(t: f64, descent: f64, damped: f64) -> f64 {
    t * descent - 0.5 * t * t * (descent - damped)
}

pub(super) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}
