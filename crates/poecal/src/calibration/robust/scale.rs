//! Robust scale: the noise by the median of the rows (theory.md §6 (34a)).

use crate::calibration::CalibrationOptions;
use crate::calibration::noise::{ROUNDING, stated};
use crate::distributions::{chi_square_median, median};
use crate::estimate::{Estimate, Session};
use crate::measurement::Noise;

/// Squared whitened residual of one part of a row, position or rotation.
#[derive(Clone, Copy, Default)]
pub(super) struct RowPart {
    pub(super) squares: f64,
    pub(super) components: usize,
    /// Whether the row states this part's noise.
    stated: bool,
}

/// Position and rotation of a row.
pub(super) type RowParts = [RowPart; 2];

/// Whitened parts of some rows.
pub(super) fn parts(session: &Session<'_>, rows: &[u32], estimate: &Estimate, noise: Noise) -> Vec<RowParts> {
    session.map_squares(rows, estimate, |observation, squares| {
        let whitened = observation.whitened(squares.map(|(squares, _)| squares), noise);
        let stated = [observation.sigma_position_m, observation.sigma_rotation_rad];
        [0, 1].map(|side| RowPart {
            squares: whitened[side],
            components: squares[side].1,
            stated: stated[side].is_some(),
        })
    })
}

/// Robust scale over the noise, positions and rotations.
#[derive(Clone, Copy)]
pub(super) struct Scale(pub(super) [f64; 2]);

impl Scale {
    /// Scale of these rows, corrected for the unknowns in proportion: theory.md §6 (34a). 1 for a part that no row has.
    pub(super) fn of<'a>(rows: impl Iterator<Item = &'a RowParts> + Clone, unknowns: f64) -> Self {
        let count: usize = rows.clone().flatten().map(|part| part.components).sum();
        let left = (1.0 - unknowns / count.max(1) as f64).max(0.05);
        Scale([0, 1].map(|side| median_scale(rows.clone().map(|row| &row[side]), left).unwrap_or(1.0)))
    }

    /// Floor for exact data, whose rounding is no scale.
    pub(super) fn at_least_rounding(self, noise: Noise) -> Self {
        let [position, rotation] = self.0;
        Scale([position.max(ROUNDING / noise.position_m), rotation.max(ROUNDING / noise.rotation_rad)])
    }

    /// Length of a row's residual in units of the scaled noise, and its number of components.
    pub(super) fn length(&self, row: &RowParts) -> (f64, usize) {
        let squares: f64 = row.iter().zip(self.0).map(|(part, scale)| part.squares / (scale * scale)).sum();
        (squares.sqrt(), row.iter().map(|part| part.components).sum())
    }
}

/// Replaces the noise of rows that state none, unless the user states it, by their robust scale, and rescales `parts`. Returns the noise
/// and the scale of all rows.
pub(super) fn settle(
    parts: &mut [RowParts],
    unknowns: f64,
    noise: Noise,
    options: Option<&CalibrationOptions>,
) -> (Noise, Scale) {
    let mut settled = noise;
    if let Some(options) = options {
        let count: usize = parts.iter().flatten().map(|part| part.components).sum();
        let left = (1.0 - unknowns / count.max(1) as f64).max(0.05);
        let of = |side: usize, sigma: f64| {
            let open = parts.iter().map(|row| &row[side]).filter(|part| !part.stated);
            median_scale(open, left).map_or(sigma, |scale| (scale * sigma).max(ROUNDING))
        };
        let found = Noise { position_m: of(0, noise.position_m), rotation_rad: of(1, noise.rotation_rad) };
        settled = stated(options, found);
        let ratios = [noise.position_m / settled.position_m, noise.rotation_rad / settled.rotation_rad];
        for part in parts.iter_mut().flat_map(|row| row.iter_mut().zip(ratios)) {
            if !part.0.stated {
                part.0.squares *= part.1 * part.1;
            }
        }
    }
    (settled, Scale::of(parts.iter(), unknowns).at_least_rounding(settled))
}

/// Root of the median of squares over the median of χ²; `left` is the redundant share of the rows.
fn median_scale<'a>(rows: impl Iterator<Item = &'a RowPart>, left: f64) -> Option<f64> {
    let measured = rows.filter(|part| part.components > 0);
    let median = median(measured.map(|part| part.squares / chi_square_median(part.components)))?;
    Some((median / left).sqrt())
}
