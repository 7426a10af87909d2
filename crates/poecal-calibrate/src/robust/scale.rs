//! Robust scale: the noise by the median of the rows (theory.md §6 (34a)).

use crate::CalibrationOptions;
use crate::run::noise::{ROUNDING, merge_stated_noise};
use poecal_fit::state::{Estimate, Session};
use poecal_model::measurement::{ByQuantity, Noise, Quantity};
use poecal_numerics::distributions::{chi_square_median, median};

/// Squared whitened residual of one quantity of a row.
#[derive(Clone, Copy, Default)]
pub(crate) struct QuantityResidual {
    pub(crate) squares: f64,
    pub(crate) components: usize,
    /// True if the row states this part's noise.
    stated: bool,
}

/// All quantities of a row.
pub(crate) type RowResiduals = ByQuantity<QuantityResidual>;

/// Whitened squared residuals of some rows, by quantity.
pub(crate) fn parts(session: &Session<'_>, rows: &[u32], estimate: &Estimate, noise: Noise) -> Vec<RowResiduals> {
    session.map_squares(rows, estimate, |observation, squares| {
        let whitened = session.whiten_squares(observation, squares.map(|(squares, _)| squares), noise);
        ByQuantity::from_fn(|quantity| QuantityResidual {
            squares: whitened[quantity],
            components: squares[quantity].1,
            stated: observation.stated.get(quantity).is_some(),
        })
    })
}

/// Number of measured components of some rows.
fn count<'a>(rows: impl Iterator<Item = &'a RowResiduals>) -> usize {
    rows.flat_map(RowResiduals::iter).map(|(_, part)| part.components).sum()
}

/// Robust scale relative to the noise, of each quantity.
#[derive(Clone, Copy)]
pub(crate) struct RobustScale(pub(crate) ByQuantity<f64>);

impl RobustScale {
    /// Scale of these rows, corrected for the unknowns in proportion: theory.md §6 (34a). 1 for a quantity that no row has.
    pub(crate) fn from_rows<'a>(rows: impl Iterator<Item = &'a RowResiduals> + Clone, unknowns: f64) -> Self {
        let left = (1.0 - unknowns / count(rows.clone()).max(1) as f64).max(0.05);
        RobustScale(ByQuantity::from_fn(|quantity| {
            median_scale(rows.clone().map(|row| &row[quantity]), left).unwrap_or(1.0)
        }))
    }

    /// The scale with a floor for exact data, whose rounding is no scale.
    pub(crate) fn at_least_rounding(self, noise: Noise) -> Self {
        RobustScale(ByQuantity::from_fn(|quantity| self.0[quantity].max(ROUNDING / noise[quantity])))
    }

    /// Standard deviation of a component of a length, metres.
    pub(crate) fn of_lengths(self, noise: Noise) -> f64 {
        self.0.of_lengths() * noise.of_lengths()
    }

    /// Length of a row's residual in units of the scaled noise, and its number of components.
    pub(crate) fn length(&self, row: &RowResiduals) -> (f64, usize) {
        let of = |(quantity, part): (Quantity, &QuantityResidual)| part.squares / (self.0[quantity] * self.0[quantity]);
        let squares: f64 = row.iter().map(of).sum();
        (squares.sqrt(), row.iter().map(|(_, part)| part.components).sum())
    }
}

/// Replaces the noise of rows that state none, unless the user states it, by their robust scale, and rescales `parts`. Returns the noise
/// and the scale of all rows.
pub(crate) fn settle(
    parts: &mut [RowResiduals],
    unknowns: f64,
    noise: Noise,
    options: Option<&CalibrationOptions>,
) -> (Noise, RobustScale) {
    let mut settled = noise;
    if let Some(options) = options {
        let left = (1.0 - unknowns / count(parts.iter()).max(1) as f64).max(0.05);
        let found = ByQuantity::from_fn(|quantity| {
            let open = parts.iter().map(|row| &row[quantity]).filter(|part| !part.stated);
            median_scale(open, left).map_or(noise[quantity], |scale| (scale * noise[quantity]).max(ROUNDING))
        });
        settled = merge_stated_noise(options, found);
        for (quantity, part) in parts.iter_mut().flat_map(RowResiduals::values_mut).filter(|(_, part)| !part.stated) {
            let ratio = noise[quantity] / settled[quantity];
            part.squares *= ratio * ratio;
        }
    }
    (settled, RobustScale::from_rows(parts.iter(), unknowns).at_least_rounding(settled))
}

/// Root of the median of squares over the median of χ²; `left` is the redundant share of the rows.
fn median_scale<'a>(rows: impl Iterator<Item = &'a QuantityResidual>, left: f64) -> Option<f64> {
    let measured = rows.filter(|part| part.components > 0);
    let median = median(measured.map(|part| part.squares / chi_square_median(part.components)))?;
    Some((median / left).sqrt())
}
