//! Eigenvalues of the information, judged against the noise.

use nalgebra::DMatrix;

use poecal_numerics::linalg;

/// Singular values below this share of the largest are rounding of the normal equations.
pub(crate) const ROUNDING: f64 = 3e-7;
/// A direction is determined if its standard deviation is below this share of the length that a radian counts (about 2°, or 10 to 20 mm on
/// an arm of ordinary size): nominal models are better than that.
pub const PLAUSIBLE: f64 = 0.03;
/// A direction is weakly determined above this share of that length (some 1 to 2 mm, or 0.2°). That is about the accuracy of a nominal
/// model, so that a calibration adds little.
pub(crate) const WEAK: f64 = 0.003;
/// An unknown is determined if at most this share of it (as a cosine) lies in undetermined directions. Uncertain by [`PLAUSIBLE`], these
/// then move it by less than 0.1 mm on an arm of ordinary size.
const UNDETERMINED_SHARE: f64 = 0.01;

/// Eigenvalues and eigenvectors of the scaled, whitened information `N`, and its rank (theory.md §7 (36)). Steps are in metres; a radian
/// counts as the length in the layout.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// Eigenvalues, the smallest first, 1/m².
    pub values: Vec<f64>,
    /// Eigenvectors, a column each, in the order of a step ([`crate::problem::Layout`]).
    pub vectors: DMatrix<f64>,
    /// Number of undetermined directions: the first eigenvalues, below noise or rounding.
    pub undetermined: usize,
    /// Variance of a whitened residual, estimated or stated.
    pub variance: f64,
}

impl Spectrum {
    /// Decomposes the information (upper triangle, row-major) of `n` unknowns and judges its rank by the noise: theory.md §7 (36).
    /// `length_m` is the number of metres that a radian counts.
    #[must_use]
    pub fn new(gram: &[f64], n: usize, variance: f64, length_m: f64) -> Self {
        if !gram.iter().all(|value| value.is_finite()) {
            // After an overflow no unknown is determined.
            return Spectrum { values: vec![0.0; n], vectors: DMatrix::identity(n, n), undetermined: n, variance };
        }
        let (values, vectors) = linalg::symmetric_eigen(gram, n);
        let least = rounding(&values).max(variance / (PLAUSIBLE * length_m).powi(2));
        let undetermined = values.iter().take_while(|&&value| value <= least || value <= 0.0).count();
        Spectrum { values, vectors, undetermined, variance }
    }

    /// Standard deviation along an eigenvector, metres: theory.md §7 (36). Infinite where the eigenvalue is not above zero.
    #[must_use]
    pub fn sigma_m(&self, k: usize) -> f64 {
        match self.values.get(k) {
            Some(&value) if value > 0.0 => (self.variance / value).sqrt(),
            _ => f64::INFINITY,
        }
    }

    /// For each unknown in the order of a step, true if the measurements determine it: theory.md §7, below (36).
    #[must_use]
    pub fn determined_unknowns(&self) -> Vec<bool> {
        let n = self.vectors.nrows();
        (0..n)
            .map(|row| {
                let unit: Vec<f64> = (0..n).map(|k| if k == row { 1.0 } else { 0.0 }).collect();
                self.variance_along(&unit).is_some()
            })
            .collect()
    }

    /// Variance of a linear function of the unknowns (its derivative in the order of a step), `Σ_k σ_k² (v_kᵀ d)²` over determined
    /// directions (theory.md §7 (36c)). `None` if undetermined directions have a part in it.
    #[must_use]
    pub fn variance_along(&self, derivative: &[f64]) -> Option<f64> {
        let length: f64 = derivative.iter().map(|d| d * d).sum();
        let (mut undetermined, mut variance) = (0.0, 0.0);
        for (k, (&value, vector)) in self.values.iter().zip(self.vectors.column_iter()).enumerate() {
            let along: f64 = vector.iter().zip(derivative).map(|(v, d)| v * d).sum();
            if k < self.undetermined {
                undetermined += along * along;
            } else {
                variance += along * along / value * self.variance;
            }
        }
        (undetermined <= UNDETERMINED_SHARE * UNDETERMINED_SHARE * length).then_some(variance)
    }
}

/// Largest eigenvalue that is rounding of the normal equations.
pub(crate) fn rounding(values: &[f64]) -> f64 {
    values.last().copied().unwrap_or(0.0).max(0.0) * ROUNDING * ROUNDING
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn undetermined_directions_have_no_variance() {
        let vectors = DMatrix::identity(2, 2);
        let found = Spectrum { values: vec![0.0, 4.0], vectors, undetermined: 1, variance: 1.0 };
        assert_eq!(found.determined_unknowns(), [false, true]);
        assert_eq!(found.variance_along(&[0.0, 1.0]), Some(0.25));
        assert_eq!(found.variance_along(&[1.0, 1.0]), None);
    }
}
