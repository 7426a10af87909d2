//! The information of the measurements by directions: what is told against the noise.

use nalgebra::DMatrix;

use crate::linalg;

/// Singular values below this share of the largest are rounding of the normal equations.
pub(super) const ROUNDING: f64 = 3e-7;
/// A direction is told by the data if its standard deviation is below this share of the length that a radian counts (about 2°,
/// or some 10 to 20 mm on an arm of ordinary size): a robot's drawing is known better than that.
pub(crate) const PLAUSIBLE: f64 = 0.03;
/// A direction is weak if its standard deviation is above this share of that length (some 1 to 2 mm, or 0.2°): about what a robot's
/// drawing is known to, so that a calibration adds little there.
pub(super) const WEAK: f64 = 0.003;
/// An unknown is determined if no more than this share of it (as a cosine) lies in directions that are open: with those uncertain by
/// what is plausible, it is less than the tenth of a millimetre on an arm of ordinary size.
const OPEN_SHARE: f64 = 0.01;

/// Eigenvalues and eigenvectors of the scaled, whitened information `N`, and which of them count: what an uncertainty is computed
/// from. Steps are in metres; a radian counts as the length in the layout.
///
/// ```
/// use nalgebra::DMatrix;
/// use poecal::analysis::Spectrum;
/// let found = Spectrum { values: vec![0.0, 4.0], vectors: DMatrix::identity(2, 2), open: 1, variance: 1.0 };
/// assert_eq!(found.determined(), [false, true]);
/// assert_eq!(found.variance_along(&[0.0, 1.0]), Some(0.25));
/// assert_eq!(found.variance_along(&[1.0, 1.0]), None);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// Eigenvalues, the smallest first, 1/m².
    pub values: Vec<f64>,
    /// Their eigenvectors, a column each, in the order of a step ([`crate::problem::Layout`]).
    pub vectors: DMatrix<f64>,
    /// The first so many are open: below what noise and rounding allow to tell.
    pub open: usize,
    /// Variance of a whitened residual, as found or as given.
    pub variance: f64,
}

impl Spectrum {
    /// Decomposes the information (upper triangle, row-major) of `n` unknowns with the rank judged by the noise; `length_m` is how many
    /// metres a radian counts.
    #[must_use]
    pub fn new(gram: &[f64], n: usize, variance: f64, length_m: f64) -> Self {
        if !gram.iter().all(|value| value.is_finite()) {
            // Numbers that overflowed tell nothing.
            return Spectrum { values: vec![0.0; n], vectors: DMatrix::identity(n, n), open: n, variance };
        }
        let (values, vectors) = linalg::symmetric_eigen(gram, n);
        let least = rounding(&values).max(variance / (PLAUSIBLE * length_m).powi(2));
        let open = values.iter().take_while(|&&value| value <= least || value <= 0.0).count();
        Spectrum { values, vectors, open, variance }
    }

    /// The directions that are open, a column each.
    #[must_use]
    pub fn open_space(&self) -> DMatrix<f64> {
        self.vectors.columns(0, self.open).into_owned()
    }

    /// Standard deviation along an eigenvector, metres; infinite where the eigenvalue is not above zero.
    #[must_use]
    pub fn sigma_m(&self, k: usize) -> f64 {
        match self.values.get(k) {
            Some(&value) if value > 0.0 => (self.variance / value).sqrt(),
            _ => f64::INFINITY,
        }
    }

    /// For each unknown in the order of a step, whether the measurements determine it by itself.
    #[must_use]
    pub fn determined(&self) -> Vec<bool> {
        let n = self.vectors.nrows();
        (0..n)
            .map(|row| {
                let unit: Vec<f64> = (0..n).map(|k| if k == row { 1.0 } else { 0.0 }).collect();
                self.variance_along(&unit).is_some()
            })
            .collect()
    }

    /// Variance of a linear function of the unknowns (its derivative in the order of a step), or `None` if the measurements leave it
    /// open.
    #[must_use]
    pub fn variance_along(&self, derivative: &[f64]) -> Option<f64> {
        let length: f64 = derivative.iter().map(|d| d * d).sum();
        let (mut open, mut variance) = (0.0, 0.0);
        for (k, (&value, vector)) in self.values.iter().zip(self.vectors.column_iter()).enumerate() {
            let along: f64 = vector.iter().zip(derivative).map(|(v, d)| v * d).sum();
            if k < self.open {
                open += along * along;
            } else {
                variance += along * along / value * self.variance;
            }
        }
        (open <= OPEN_SHARE * OPEN_SHARE * length).then_some(variance)
    }
}

/// Eigenvalues below this are rounding.
pub(super) fn rounding(values: &[f64]) -> f64 {
    values.last().copied().unwrap_or(0.0).max(0.0) * ROUNDING * ROUNDING
}
