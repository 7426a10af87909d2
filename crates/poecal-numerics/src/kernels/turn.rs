//! Residual rotations of several rows: the logarithm, and the rows that its derivative adds to the products of columns.

use nalgebra::Matrix3;
use pulp::Simd;

use super::vector::{LaneBlock, Lanes, Vectors};
use poecal_arm::lie::{rotation, series};

/// Squared sine below which the logarithm is a polynomial: residual rotations up to 14°. The first omitted terms are 2e-17 of
/// [`series::ARCSINE`] and 1e-17 of [`series::COTC`].
const SMALL: f64 = 1.0 / 16.0;

/// Residual rotations `r = log(Y Rᵀ)` with the coefficient `k` of `J_r(r)⁻¹ = I + r̂/2 + k r̂²` (theory.md §4 (16)).
pub(crate) struct ResidualRotations<S: Simd> {
    pub(crate) r: Vectors<S>,
    k: Lanes<S>,
}

impl<S: Simd> ResidualRotations<S> {
    /// Logarithm of measured and predicted rotations, by their columns.
    #[inline(always)]
    pub(crate) fn new(simd: S, measured: &[Vectors<S>; 3], predicted: &[Vectors<S>; 3]) -> Self {
        let mut doubled = predicted[0].cross(measured[0]);
        let mut trace = predicted[0].dot(measured[0]);
        for k in 1..3 {
            doubled = doubled + predicted[k].cross(measured[k]);
            trace = trace + predicted[k].dot(measured[k]);
        }
        let sine = doubled.scale(trace.all(0.5));
        let sine_squared = sine.dot(sine);
        // A trace above one means an angle below π/2.
        if !sine_squared.are_below(SMALL, (-trace, -1.0)) {
            return Self::from_rotations(simd, measured, predicted);
        }
        let r = sine.scale(sine_squared.polynomial(series::ARCSINE));
        ResidualRotations { r, k: r.dot(r).polynomial(series::COTC) }
    }

    /// The same row by row, for rotations of any size.
    #[cold]
    #[inline(never)]
    fn from_rotations(simd: S, measured: &[Vectors<S>; 3], predicted: &[Vectors<S>; 3]) -> Self {
        let apart = |columns: &[Vectors<S>; 3]| {
            let mut wide = [[LaneBlock::ZERO; 3]; 3];
            for (wide, column) in wide.iter_mut().zip(columns) {
                column.store(wide, 0);
            }
            wide
        };
        let (measured, predicted) = (apart(measured), apart(predicted));
        let mut out = [LaneBlock::ZERO; 4];
        for lane in 0..S::F64_LANES {
            let matrix = |columns: &[[LaneBlock; 3]; 3]| Matrix3::from_fn(|row, column| columns[column][row].0[lane]);
            let r = rotation::log(&(matrix(&measured) * matrix(&predicted).transpose()));
            for (wide, value) in out.iter_mut().zip([r.x, r.y, r.z, series::cotc(r.norm_squared())]) {
                wide.0[lane] = value;
            }
        }
        let [x, y, z, k] = out;
        ResidualRotations { r: Vectors::load(simd, &[x, y, z], 0), k: Lanes::load(simd, &k, 0) }
    }

    /// `J_r(r)⁻¹ w`.
    #[inline(always)]
    pub(crate) fn apply(&self, w: Vectors<S>) -> Vectors<S> {
        let moved = self.r.cross(w);
        self.r.cross(moved).times_plus(self.k, moved.times_plus(self.k.all(0.5), w))
    }

    /// Two rows `A` with `I + AᵀA = J_r(r)⁻ᵀ J_r(r)⁻¹`, which is `I - q r̂²` with `q = ¼ - 2k + k²|r|²` (theory.md §6 (28a)).
    #[inline(always)]
    pub(crate) fn excess(&self) -> [Vectors<S>; 2] {
        let [a, b, c] = self.r.0;
        let length_squared = self.r.dot(self.r);
        let k = self.k;
        let q = k.times_plus(self.k.all(-2.0), (k * k).times_plus(length_squared, self.k.all(0.25)));
        let (root, length) = (q.sqrt(), length_squared.sqrt());
        let aside = b.times_plus(b, c * c).sqrt();
        let unit_b = b.divide_or(aside, 1.0);
        let unit_c = c.divide_or(aside, 0.0);
        let along = root * length;
        let across = -(root * a);
        [
            Vectors([root * aside, across * unit_b, across * unit_c]),
            Vectors([self.k.all(0.0), along * unit_c, -(along * unit_b)]),
        ]
    }
}
