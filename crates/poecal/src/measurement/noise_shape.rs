//! Noise that is not the same in all directions.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use super::{Channels, NUMBERS, Quantity};

/// Shape of the covariance Σ of a position: `σ Σ^{-1/2}`, which makes noise of one standard deviation σ in all directions of it
/// (theory.md §4 (17a)).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NoiseShape(Matrix3<f64>);

impl NoiseShape {
    /// Of a covariance with these standard deviations of its components, metres, none of those that were not measured: the σ of all of them,
    /// their geometric mean, and the shape. `None` without a component.
    #[must_use]
    pub fn by_component(sigmas: [Option<f64>; 3]) -> Option<(f64, NoiseShape)> {
        let measured: Vec<f64> = sigmas.into_iter().flatten().collect();
        let mean = (measured.iter().map(|sigma| sigma.ln()).sum::<f64>() / measured.len() as f64).exp();
        let factors = sigmas.map(|sigma| sigma.map_or(0.0, |sigma| mean / sigma));
        (!measured.is_empty()).then(|| (mean, NoiseShape(Matrix3::from_diagonal(&factors.into()))))
    }

    /// Of a standard deviation along a unit vector and another one across it, metres: the σ of both, with their geometric mean, and the shape.
    #[must_use]
    pub fn across(sight: &Vector3<f64>, along_m: f64, across_m: f64) -> (f64, NoiseShape) {
        let mean = (along_m * across_m * across_m).cbrt();
        let along = sight * sight.transpose();
        (mean, NoiseShape(along * (mean / along_m) + (Matrix3::identity() - along) * (mean / across_m)))
    }

    /// A vector whose noise has this shape, as one whose noise has none.
    #[must_use]
    pub fn whitened(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        self.0 * vector
    }

    /// The same for numbers of a measurement: those of its position change, others stay. Each of them has `N` parts.
    pub(crate) fn whiten<const N: usize>(&self, channels: &Channels, numbers: &mut [[f64; N]]) {
        let own = channels.of(Quantity::Position);
        let mut before = [[0.0; N]; NUMBERS];
        before[own.clone()].copy_from_slice(&numbers[own.clone()]);
        for k in own.clone() {
            let row = channels[k].component();
            numbers[k] = std::array::from_fn(|part| {
                own.clone().map(|l| self.0[(row, channels[l].component())] * before[l][part]).sum()
            });
        }
    }
}
