//! Distributions of squares: quantiles of χ² and F.

mod beta;
mod chi_square;

pub(crate) use beta::f_quantile;
pub(crate) use chi_square::{is_within_band, median, upper_quantile};
