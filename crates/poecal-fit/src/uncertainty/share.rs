//! Shares of the measurements and of the prior in an estimate.

use super::{FitView, factor};
use poecal_numerics::linalg::{self, Factor};

/// Shares of the measurements and of the prior in the information on functions of the unknowns (theory.md §9 (39a)).
pub struct Shares<'a> {
    /// Upper triangle of N, the information of the measurements.
    gram: &'a [f64],
    n: usize,
    factor: Factor,
}

impl<'a> Shares<'a> {
    /// Shares of a fit; `None` if it contained no prior.
    pub fn new(view: &FitView<'_>, gram: &'a [f64], n: usize) -> Option<Self> {
        let factor = factor(gram, n, view.prior, view.variance).filter(|_| view.prior.is_fitted)?;
        Some(Shares { gram, n, factor })
    }

    /// Determined share of a vector, by the derivatives of its parts: `Σ xᵀN x / Σ aᵀx` with `x = H⁻¹a`. It is 1 if the measurements
    /// determine all of the vector and 0 if the prior does. `None` if no unknown moves it.
    pub fn of_measurements(&self, derivatives: &[Vec<f64>]) -> Option<f64> {
        let (mut measured, mut all) = (0.0, 0.0);
        for a in derivatives {
            let x = linalg::cholesky_solve(&self.factor, a);
            all += a.iter().zip(&x).map(|(a, x)| a * x).sum::<f64>();
            for i in 0..self.n {
                let row = &self.gram[i * self.n..(i + 1) * self.n];
                let beyond: f64 = row.iter().zip(&x).skip(i + 1).map(|(value, x)| value * x).sum();
                measured += x[i] * (row[i] * x[i] + 2.0 * beyond);
            }
        }
        (all > 0.0).then(|| (measured / all).clamp(0.0, 1.0))
    }
}
