//! Expected error of one predicted pose.

use nalgebra::Matrix3;

use poecal_model::measurement::{ByQuantity, Quantity};
use poecal_numerics::distributions::f_quantile;

/// Covariances of a predicted target's position (square metres) and rotation (square radians), device axes (theory.md §9 (40)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictedError {
    /// Covariance of the position, square metres.
    pub position: Matrix3<f64>,
    /// Covariance of the rotation vector, square radians.
    pub rotation: Matrix3<f64>,
    /// For each quantity, growth of its 95 % bounds, since its variance is estimated.
    pub quantiles: ByQuantity<Quantile>,
}

impl PredictedError {
    /// Expected distance, root mean square in metres: `√tr P_p` of theory.md §9 (40).
    #[must_use]
    pub fn sigma_position_m(&self) -> f64 {
        self.position.trace().max(0.0).sqrt()
    }

    /// Expected angle, root mean square in radians: `√tr P_R` of theory.md §9 (40).
    #[must_use]
    pub fn sigma_rotation_rad(&self) -> f64 {
        self.rotation.trace().max(0.0).sqrt()
    }

    /// 95 % bound of the distance, metres: [`Quantile::bound`] of the `P_p` of theory.md §9 (40).
    #[must_use]
    pub fn bound_position_m(&self) -> f64 {
        self.quantiles[Quantity::Position].bound(&self.position)
    }

    /// 95 % bound of the angle, radians: [`Quantile::bound`] of the `P_R` of theory.md §9 (40).
    #[must_use]
    pub fn bound_rotation_rad(&self) -> f64 {
        self.quantiles[Quantity::Rotation].bound(&self.rotation)
    }
}

/// 95 % quantile of the length of a normal vector with this covariance, in the root of its unit. The squared length is approximated
/// by a scaled χ² of equal mean and variance (satterthwaite1946), whose quantile follows wilson1931.
#[must_use]
pub fn bound(covariance: &Matrix3<f64>) -> f64 {
    const Z: f64 = 1.644_853_626_951_472_7;
    let trace = covariance.trace();
    let squares = covariance.norm_squared();
    if trace <= 0.0 || squares <= 0.0 {
        return 0.0;
    }
    let freedom = trace * trace / squares;
    let spread = 2.0 / (9.0 * freedom);
    let quantile = freedom * (1.0 - spread + Z * spread.sqrt()).powi(3);
    (squares / trace * quantile).sqrt()
}

/// Growth of 95 % bounds if the variance was estimated from few residuals: quantiles of F instead of χ² (abramowitz1964).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantile {
    /// Squares of the factors for distributions of 1, 2 and 3 degrees of freedom.
    growth: [f64; 3],
}

impl Quantile {
    /// A variance that is known.
    pub const KNOWN: Quantile = Quantile { growth: [1.0; 3] };

    /// Quantile of a variance that was estimated with these degrees of freedom: 95 % quantiles of F over those of χ² over its degrees
    /// of freedom (theory.md §9, below (40)).
    #[must_use]
    pub fn new(freedom: f64) -> Self {
        const MANY: f64 = 1e5;
        if freedom >= MANY {
            return Quantile::KNOWN;
        }
        let freedom = freedom.max(1.0);
        let known = [3.841_458_820_694_124, 2.995_732_273_553_991, 2.604_909_302_600_548];
        Quantile { growth: std::array::from_fn(|k| f_quantile(0.05, (k + 1) as f64, freedom) / known[k]) }
    }

    /// [`bound`] of a covariance whose scale was estimated with these degrees of freedom, in the root of its unit (theory.md §9, below
    /// (40)).
    #[must_use]
    pub fn bound(&self, covariance: &Matrix3<f64>) -> f64 {
        let (trace, squares) = (covariance.trace(), covariance.norm_squared());
        let freedom = if squares > 0.0 { (trace * trace / squares).clamp(1.0, 3.0) } else { 3.0 };
        // The growth is a parabola through the three.
        let [one, two, three] = self.growth;
        let t = freedom - 2.0;
        let growth = two + 0.5 * t * (three - one) + 0.5 * t * t * (three - 2.0 * two + one);
        bound(covariance) * growth.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_those_of_chi_square() {
        let quantiles = ByQuantity::from_fn(|_| Quantile::KNOWN);
        let position = Matrix3::identity() * 1e-8;
        let error = PredictedError { position, rotation: Matrix3::zeros(), quantiles };
        assert!((error.sigma_position_m() - 3f64.sqrt() * 1e-4).abs() < 1e-15);
        // With three equal components, the distance is below 2.7955 standard deviations in 95 % of all cases.
        assert!((error.bound_position_m() - 2.7955e-4).abs() < 1e-6);
    }

    #[test]
    fn bounds_of_few_residuals_are_those_of_f() {
        let covariance = Matrix3::identity();
        // F of 3 and 9 degrees of freedom is 3.863 at 95 %, χ² of 3 over 3 is 2.605.
        let ratio = Quantile::new(9.0).bound(&covariance) / Quantile::KNOWN.bound(&covariance);
        assert!((ratio - (3.863f64 / 2.605).sqrt()).abs() < 1e-3);
    }
}
