//! Noise that is not the same in all directions.

use nalgebra::{Matrix3, Matrix6, Vector3};
use serde::{Deserialize, Serialize};

use super::{Channels, NUMBERS, Quantity};

/// Shape of the covariance Σ of a position, or of a whole pose: `σ Σ^{-1/2}`, which transforms the noise to one standard deviation σ in all
/// directions (theory.md §4 (17a)). For a pose it is `diag(σ_p, σ_r) Σ^{-1/2}`, of the shift and then the turn about the target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NoiseShape(Matrix6<f64>);

impl NoiseShape {
    /// Shape of a covariance with these standard deviations of its components, metres, `None` for those that were not measured. Returns the
    /// σ of all of them, their geometric mean, and the shape. `None` without a component.
    #[must_use]
    pub fn by_component(sigmas: [Option<f64>; 3]) -> Option<(f64, NoiseShape)> {
        let measured: Vec<f64> = sigmas.into_iter().flatten().collect();
        let mean = (measured.iter().map(|sigma| sigma.ln()).sum::<f64>() / measured.len() as f64).exp();
        let factors = sigmas.map(|sigma| sigma.map_or(0.0, |sigma| mean / sigma));
        (!measured.is_empty()).then(|| (mean, NoiseShape::of_position(&Matrix3::from_diagonal(&factors.into()))))
    }

    /// Standard deviations of the components of a position, metres, by the σ of all of them: the inverse of [`NoiseShape::by_component`].
    #[must_use]
    pub fn component_sigmas(&self, sigma_m: f64) -> [Option<f64>; 3] {
        [0, 1, 2].map(|at| Some(self.0[(at, at)]).filter(|it| *it > 0.0).map(|factor| sigma_m / factor))
    }

    /// Shape of a standard deviation along a unit vector and another one across it, metres: the σ of both, with their geometric mean, and
    /// the shape.
    #[must_use]
    pub fn from_sight(sight: &Vector3<f64>, along_m: f64, across_m: f64) -> (f64, NoiseShape) {
        let mean = (along_m * across_m * across_m).cbrt();
        let along = sight * sight.transpose();
        let shape = along * (mean / along_m) + (Matrix3::identity() - along) * (mean / across_m);
        (mean, NoiseShape::of_position(&shape))
    }

    /// Shape of the whitening of a pose, `Σ^{-1/2}` (1/m and 1/rad), with the standard deviations of its components, m and rad.
    #[must_use]
    pub fn of_pose(whitening: &Matrix6<f64>, [shift_m, turn_rad]: [f64; 2]) -> NoiseShape {
        let mut shape = *whitening;
        shape.fixed_rows_mut::<3>(0).scale_mut(shift_m);
        shape.fixed_rows_mut::<3>(3).scale_mut(turn_rad);
        NoiseShape(shape)
    }

    /// Whitening of a pose, by the standard deviations of its components: the inverse of [`NoiseShape::of_pose`].
    #[must_use]
    pub fn whitening(&self, [shift_m, turn_rad]: [f64; 2]) -> Matrix6<f64> {
        let mut whitening = self.0;
        whitening.fixed_rows_mut::<3>(0).scale_mut(1.0 / shift_m);
        whitening.fixed_rows_mut::<3>(3).scale_mut(1.0 / turn_rad);
        whitening
    }

    fn of_position(shape: &Matrix3<f64>) -> Self {
        let mut whole = Matrix6::identity();
        whole.fixed_view_mut::<3, 3>(0, 0).copy_from(shape);
        NoiseShape(whole)
    }

    /// A vector whose noise has this shape, transformed to equal noise in all directions.
    #[must_use]
    pub fn whiten_vector(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        self.0.fixed_view::<3, 3>(0, 0) * vector
    }

    /// The same transformation for numbers of a measurement: those of its pose change, others stay. Each of them has `N` parts.
    pub fn whiten<const N: usize>(&self, channels: &Channels, numbers: &mut [[f64; N]]) {
        let mut before = [[0.0; N]; NUMBERS];
        before[..channels.len()].copy_from_slice(&numbers[..channels.len()]);
        // Numbers of the pose, each with its row of the shape.
        let (mut rows, mut count) = ([(0, 0); NUMBERS], 0);
        for (quantity, first) in [(Quantity::Position, 0), (Quantity::Rotation, 3)] {
            for (k, component) in channels.components(quantity) {
                rows[count] = (k, first + component);
                count += 1;
            }
        }
        for &(k, row) in &rows[..count] {
            numbers[k] = [0.0; N];
            for &(l, column) in &rows[..count] {
                let factor = self.0[(row, column)];
                numbers[k].iter_mut().zip(before[l]).for_each(|(sum, value)| *sum += factor * value);
            }
        }
    }
}
