//! Normal information: the solver's input from all residuals, in O(n²) memory.

use crate::linalg;

/// Rounding of the normal equations' small eigenvalues, as a share of the largest diagonal element.
pub(crate) const ROUNDING: f64 = 1e-13;

/// `JᵀJ` (upper triangle, row-major), `Jᵀe` and `½ Σ e²` of whitened residuals, with their number: theory.md §6 (27)
/// and (28).
///
/// ```
/// let mut normal = poecal_numerics::solve::NormalEquations::new(2);
/// normal.add_rows(&[1.0, 0.0, 0.0, 2.0], &[3.0, 4.0], 0);
/// assert_eq!((normal.cost, normal.gradient[1], normal.gram[3]), (12.5, 8.0, 4.0));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct NormalEquations {
    /// Upper triangle of `JᵀJ`, row-major `n × n`.
    pub gram: Vec<f64>,
    /// `Jᵀe`, with J the derivative of the *prediction*: the direction of descent.
    pub gradient: Vec<f64>,
    /// `½ Σ e²`.
    pub cost: f64,
    /// Number of residuals.
    pub residuals: usize,
}

impl NormalEquations {
    /// Information without residuals on `n` unknowns.
    #[must_use]
    pub fn new(n: usize) -> Self {
        NormalEquations { gram: vec![0.0; n * n], gradient: vec![0.0; n], cost: 0.0, residuals: 0 }
    }

    /// Number of unknowns.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.gradient.len()
    }

    /// Adds rows of the Jacobian (`n` numbers each, those before `start` being zero) with their residuals.
    pub fn add_rows(&mut self, rows: &[f64], residuals: &[f64], start: usize) {
        let n = self.dim();
        linalg::add_gram(&mut self.gram, n, rows, start);
        linalg::add_gradient(&mut self.gradient, rows, residuals);
        self.cost += 0.5 * residuals.iter().map(|e| e * e).sum::<f64>();
        self.residuals += residuals.len();
    }

    /// Adds the information of other residuals.
    pub fn add(&mut self, other: &NormalEquations) {
        for (a, b) in self.gram.iter_mut().zip(&other.gram) {
            *a += b;
        }
        for (a, b) in self.gradient.iter_mut().zip(&other.gradient) {
            *a += b;
        }
        self.cost += other.cost;
        self.residuals += other.residuals;
    }

    /// Cost and gradient by the quadratic model after a full step with this predicted reduction.
    pub(crate) fn take_final_step(&mut self, predicted: f64) {
        self.cost -= predicted;
        self.gradient.fill(0.0);
    }

    /// Predicted reduction of a step: the decrease of the cost by the quadratic model, `gᵀδ - ½ δᵀ JᵀJ δ`.
    #[must_use]
    pub fn predicted_reduction(&self, step: &[f64]) -> f64 {
        quadratic(&self.gram, &self.gradient, step)
    }

    /// Step of the normal equations, damped by rounding alone; if they are singular, the one of least length, except for rounding.
    /// `None` if a number is not finite.
    #[must_use]
    pub fn full_step(&self) -> Option<Vec<f64>> {
        let n = self.dim();
        let scale = (0..n).map(|i| self.gram[i * n + i]).fold(0.0, f64::max);
        if n == 0 || scale == 0.0 {
            return Some(vec![0.0; n]);
        }
        let factor = linalg::cholesky(&self.gram, n, ROUNDING * scale)?;
        let step = linalg::cholesky_solve(&factor, &self.gradient);
        (self.cost.is_finite() && linalg::dot(&step, &step).is_finite()).then_some(step)
    }

    /// `2 cost / residuals`: the mean squared whitened residual.
    #[must_use]
    pub fn mean_square(&self) -> f64 {
        2.0 * self.cost / self.residuals.max(1) as f64
    }
}

/// `gᵀδ - ½ δᵀHδ` with H by its upper triangle.
pub(crate) fn quadratic(upper: &[f64], gradient: &[f64], step: &[f64]) -> f64 {
    let n = gradient.len();
    let mut sum = 0.0;
    for (i, (&a, &g)) in step.iter().zip(gradient).enumerate() {
        let row = &upper[i * n..(i + 1) * n];
        let beyond: f64 = row.iter().zip(step).skip(i + 1).map(|(h, b)| h * b).sum();
        sum += a * (g - 0.5 * row[i] * a - beyond);
    }
    sum
}
