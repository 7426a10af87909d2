//! Medians, and distributions of squares: quantiles of χ² and F.

mod beta;
mod chi_square;

pub use beta::{binomial_at_most, f_quantile};
pub use chi_square::{
    chi_square_median, is_within_band, lower_mean_square, mean_square_quantile, upper_mean_square, upper_quantile,
};

use nalgebra::Vector3;

/// Median; of an even number of values the larger of the middle two; `None` without values.
pub fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    let half = values.len() / 2;
    (half < values.len()).then(|| *values.select_nth_unstable_by(half, f64::total_cmp).1)
}

/// Median of each coordinate, which a few wrong points do not change; zero without points.
pub fn median_point(points: &[Vector3<f64>]) -> Vector3<f64> {
    Vector3::from_fn(|k, _| median(points.iter().map(|point| point[k])).unwrap_or(0.0))
}
