//! Levenberg-Marquardt on a manifold with geodesic acceleration (docs/theory.md §6; more1978, transtrum2012).

use super::{LeastSquares, Normal, Termination};
use crate::linalg;

/// How to minimise.
///
/// ```
/// let options = poecal::solve::Options { iterations: 20, ..Default::default() };
/// assert!(options.acceleration);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Most iterations (evaluations of the Jacobian after the first).
    pub iterations: usize,
    /// Ends when the undamped step promises a decrease below this times the mean squared residual.
    pub decrement: f64,
    /// Ends when the undamped step is shorter than this (scaled units: metres).
    pub step: f64,
    /// Standard deviation of a first, weak belief that the start is right (scaled units: metres): the first damping is
    /// `mean squared residual / trust²`. It shrinks with the residual, so that convergence stays quadratic.
    pub trust: f64,
    /// Whether to follow curvature by geodesic acceleration.
    pub acceleration: bool,
}

impl Default for Options {
    fn default() -> Self {
        Options { iterations: 200, decrement: 1e-7, step: 1e-14, trust: 0.3, acceleration: true }
    }
}

/// What a minimisation did.
///
/// ```
/// # use poecal::solve::{Summary, Termination};
/// let summary = Summary { iterations: 4, termination: Termination::Optimum, trace: vec![] };
/// assert!(summary.termination.is_success());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Iterations: accepted and rejected steps.
    pub iterations: usize,
    /// Why it ended.
    pub termination: Termination,
    /// Mean squared whitened residual at the start and after each iteration.
    pub trace: Vec<f64>,
}

/// Most a geodesic correction may be of the step that it corrects (transtrum2012).
const LARGEST_ACCELERATION: f64 = 0.75;

/// A step of this length (scaled units: metres) that fails to lower the cost ends the search.
const ROUNDING_STEP: f64 = 1e-9;

/// Minimises from `start`; gives the state reached, its normal information and a summary.
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
    normal: Normal,
    /// Damping as a multiple of the mean squared residual.
    damping: f64,
    /// Factor of the next increase of the damping (Nielsen): doubles with every rejection in a row.
    increase: f64,
    /// Whether the quadratic model has been poor enough to pay for curvature.
    curved: bool,
    iterations: usize,
    trace: Vec<f64>,
}

impl<'a, P: LeastSquares> Search<'a, P> {
    fn new(problem: &'a P, state: P::State, options: Options) -> Self {
        let normal = problem.normal(&state);
        let trace = vec![normal.mean_square()];
        let damping = 1.0 / (options.trust * options.trust);
        Search {
            problem,
            options,
            state,
            normal,
            damping,
            increase: 4.0,
            curved: false,
            iterations: 0,
            trace,
        }
    }

    fn run(&mut self) -> Termination {
        if !self.normal.cost.is_finite() {
            return Termination::NotFinite;
        }
        loop {
            if let Some(termination) = self.converged() {
                return termination;
            }
            if self.iterations >= self.options.iterations {
                return Termination::IterationLimit;
            }
            if !self.iterate() {
                return Termination::NoProgress;
            }
        }
    }

    /// Largest diagonal element of the Gram matrix: the scale of what rounding can tell.
    fn scale(&self) -> f64 {
        let n = self.problem.dim();
        (0..n).map(|i| self.normal.gram[i * n + i]).fold(0.0, f64::max)
    }

    /// Judges the undamped step (damped only by rounding).
    fn converged(&self) -> Option<Termination> {
        let n = self.problem.dim();
        let floor = 1e-13 * self.scale();
        if n == 0 || floor == 0.0 {
            return Some(Termination::Optimum);
        }
        let factor = linalg::cholesky(&self.normal.gram, n, floor)?;
        let step = linalg::cholesky_solve(&factor, &self.normal.gradient);
        let decrement = 0.5 * dot(&step, &self.normal.gradient);
        if norm(&step) < self.options.step || self.normal.mean_square() < self.problem.rounding() {
            return Some(Termination::StepVanished);
        }
        (decrement < self.options.decrement * self.normal.mean_square()).then_some(Termination::Optimum)
    }

    /// One trial step; `false` when steps have become too small to matter without having helped.
    fn iterate(&mut self) -> bool {
        let n = self.problem.dim();
        let mean_square = self.normal.mean_square();
        let floor = 1e-14 * self.scale();
        let damping = (self.damping * mean_square).max(floor);
        let Some(factor) = linalg::cholesky(&self.normal.gram, n, damping) else {
            self.damping *= 10.0;
            return self.damping.is_finite();
        };
        let mut step = linalg::cholesky_solve(&factor, &self.normal.gradient);
        let predicted = 0.5 * (dot(&step, &self.normal.gradient) + damping * dot(&step, &step));
        let mut too_curved = false;
        if self.options.acceleration && self.curved {
            let second = self.problem.second_order(&self.state, &step);
            let correction = linalg::cholesky_solve(&factor, &second);
            too_curved = norm(&correction) > LARGEST_ACCELERATION * norm(&step);
            for (s, c) in step.iter_mut().zip(&correction) {
                *s += 0.5 * c;
            }
        }
        self.iterations += 1;
        if too_curved {
            self.trace.push(mean_square);
            self.reject();
            return true;
        }
        let state = self.problem.retract(&self.state, &step);
        let normal = self.problem.normal(&state);
        let gain = (self.normal.cost - normal.cost) / predicted;
        if normal.cost.is_finite() && gain > 1e-3 {
            self.accept(state, normal, gain);
            return true;
        }
        self.curved = true;
        self.trace.push(mean_square);
        self.reject();
        // Steps below a nanometre that do not help, or promise less than rounding, are rounding themselves.
        norm(&step) > ROUNDING_STEP && predicted > 1e-15 * self.normal.cost && self.damping.is_finite()
    }

    fn accept(&mut self, state: P::State, normal: Normal, gain: f64) {
        self.curved = !(0.8..1.25).contains(&gain);
        let shrink = if gain > 0.75 { 0.1 } else { (1.0 - (2.0 * gain - 1.0).powi(3)).clamp(0.3, 2.0) };
        self.damping *= shrink;
        self.increase = 4.0;
        self.state = state;
        self.normal = normal;
        self.trace.push(self.normal.mean_square());
    }

    fn reject(&mut self) {
        self.damping *= self.increase;
        self.increase *= 2.0;
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}
