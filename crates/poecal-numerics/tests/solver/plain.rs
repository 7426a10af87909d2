//! Plain problems `min Σ f(x)²` of numbers, by the solver's trait.

use poecal_numerics::solve::{LeastSquares, NormalEquations, Options, Scaling, Summary, minimize};
use std::cell::Cell;

/// Residuals `f` and their Jacobian, row after row.
pub(crate) type Evaluation = (Vec<f64>, Vec<f64>);

/// A function of `dim` unknowns.
pub(crate) struct Plain<F> {
    dim: usize,
    function: F,
    has_curvature: bool,
    /// Number of points at which residuals were computed.
    evaluations: Cell<usize>,
    /// Number of times that `JᵀJ` was built.
    products: Cell<usize>,
}

impl<F: Fn(&[f64]) -> Evaluation> Plain<F> {
    pub(crate) fn new(dim: usize, function: F) -> Self {
        Plain { dim, function, has_curvature: false, evaluations: Cell::new(0), products: Cell::new(0) }
    }

    /// The same problem with the full Hessian.
    pub(crate) fn with_curvature(mut self) -> Self {
        self.has_curvature = true;
        self
    }

    /// Minimises to the last digits.
    pub(crate) fn solve(&self, start: &[f64], reuse: bool) -> Found {
        let (x, _, summary) = minimize(self, start.to_vec(), &to_the_last_digits(reuse));
        let (evaluations, products) = (self.evaluations.get(), self.products.get());
        let sum = (self.function)(&x).0.iter().map(|f| f * f).sum();
        Found { x, sum, summary, evaluations, products }
    }

    fn evaluate(&self, x: &[f64]) -> Evaluation {
        self.evaluations.set(self.evaluations.get() + 1);
        (self.function)(x)
    }
}

impl<F: Fn(&[f64]) -> Evaluation> LeastSquares for Plain<F> {
    type State = Vec<f64>;

    fn dim(&self) -> usize {
        self.dim
    }

    /// Here `f` is the prediction, and zero was measured.
    fn normal(&self, x: &Vec<f64>) -> NormalEquations {
        self.products.set(self.products.get() + 1);
        let (f, jacobian) = self.evaluate(x);
        let residuals: Vec<f64> = f.iter().map(|f| -f).collect();
        let mut normal = NormalEquations::new(self.dim);
        normal.add_rows(&jacobian, &residuals, 0);
        normal
    }

    fn gradient(&self, x: &Vec<f64>) -> Option<NormalEquations> {
        let (f, jacobian) = self.evaluate(x);
        let mut gradient = vec![0.0; self.dim];
        for (f, row) in f.iter().zip(jacobian.chunks(self.dim)) {
            gradient.iter_mut().zip(row).for_each(|(g, r)| *g -= r * f);
        }
        let cost = 0.5 * f.iter().map(|f| f * f).sum::<f64>();
        Some(NormalEquations { gram: Vec::new(), gradient, cost, residuals: f.len() })
    }

    /// Central difference over a tenth of the step.
    fn second_order(&self, x: &Vec<f64>, step: &[f64]) -> Vec<f64> {
        const FRACTION: f64 = 0.1;
        let (here, jacobian) = self.evaluate(x);
        let along = |sign: f64| {
            let part: Vec<f64> = step.iter().map(|s| sign * FRACTION * s).collect();
            self.evaluate(&self.retract(x, &part)).0
        };
        let (ahead, behind) = (along(1.0), along(-1.0));
        let mut total = vec![0.0; self.dim];
        for (k, row) in jacobian.chunks(self.dim).enumerate() {
            let second = (2.0 * here[k] - ahead[k] - behind[k]) / (FRACTION * FRACTION);
            total.iter_mut().zip(row).for_each(|(sum, r)| *sum += r * second);
        }
        total
    }

    /// Central differences of the Jacobian, if requested.
    fn curvature(&self, x: &Vec<f64>) -> Option<Vec<f64>> {
        const STEP: f64 = 1e-4;
        if !self.has_curvature {
            return None;
        }
        let n = self.dim;
        let (f, _) = self.evaluate(x);
        let mut curvature = vec![0.0; n * n];
        for b in 0..n {
            let h = STEP * magnitude(x[b]);
            let at = |sign: f64| {
                let mut moved = x.clone();
                moved[b] += sign * h;
                self.evaluate(&moved).1
            };
            let (ahead, behind) = (at(1.0), at(-1.0));
            for a in 0..=b {
                let sum = (0..f.len()).map(|k| f[k] * (ahead[k * n + a] - behind[k * n + a])).sum::<f64>();
                curvature[a * n + b] = sum / (2.0 * h);
            }
        }
        Some(curvature)
    }

    /// Limit below the square of the rounding of residuals of about one.
    fn rounding(&self) -> f64 {
        f64::EPSILON * f64::EPSILON
    }

    fn retract(&self, x: &Vec<f64>, step: &[f64]) -> Vec<f64> {
        x.iter().zip(step).map(|(x, s)| x + s).collect()
    }
}

/// Result and cost of a minimisation.
pub(crate) struct Found {
    pub(crate) x: Vec<f64>,
    /// `Σ f²`.
    pub(crate) sum: f64,
    pub(crate) summary: Summary,
    pub(crate) evaluations: usize,
    pub(crate) products: usize,
}

/// Options with unknowns of any units, where only rounding ends the search.
pub(crate) fn to_the_last_digits(reuse: bool) -> Options {
    Options {
        iterations: 10_000,
        decrement: 1e-30,
        step: 0.0,
        rejected_step: 0.0,
        shortest: 0.1,
        scaling: Scaling::Columns { damping: 1e-3 },
        reuse,
        ..Options::default()
    }
}

/// Minimises to the last digits.
pub(crate) fn solve(dim: usize, start: &[f64], function: impl Fn(&[f64]) -> Evaluation, reuse: bool) -> Found {
    Plain::new(dim, function).solve(start, reuse)
}

/// Size of an unknown; zero has no size, and counts as 1e-2.
fn magnitude(x: f64) -> f64 {
    if x == 0.0 { 1e-2 } else { x.abs() }
}

/// Largest difference of the Jacobian from central differences of sixth order, as a share of the largest element of each column.
#[allow(clippy::needless_range_loop, reason = "rows and columns of several matrices")]
pub(crate) fn jacobian_error(x: &[f64], function: impl Fn(&[f64]) -> Evaluation) -> f64 {
    // Errors of the step's sixth power and rounding, magnified by its inverse, are about as large here.
    const STEP: f64 = 5e-4;
    let n = x.len();
    let (f, jacobian) = function(x);
    let largest_f = f.iter().fold(0.0, |most: f64, f| most.max(f.abs()));
    let mut worst: f64 = 0.0;
    for column in 0..n {
        let h = STEP * magnitude(x[column]);
        let at = |steps: f64| {
            let mut moved = x.to_vec();
            moved[column] += steps * h;
            function(&moved).0
        };
        let values = [at(1.0), at(-1.0), at(2.0), at(-2.0), at(3.0), at(-3.0)];
        let of_column = |row: usize| jacobian[row * n + column];
        let largest = (0..f.len()).fold(0.0, |most: f64, row| most.max(of_column(row).abs()));
        for row in 0..f.len() {
            let apart = |k: usize| values[2 * k][row] - values[2 * k + 1][row];
            let difference = (45.0 * apart(0) - 9.0 * apart(1) + apart(2)) / (60.0 * h);
            let scale = largest.max(1e-6 * largest_f / h).max(f64::MIN_POSITIVE);
            worst = worst.max((difference - of_column(row)).abs() / scale);
        }
    }
    worst
}
