//! A gray picture in memory.

use nalgebra::Vector2;

use crate::error::{Error, Result};
use crate::normal::{LANES, lanes};
use crate::vector::run_vectorized;

/// A gray picture: levels from 0 (black) to 255 (white), row by row. Pictures of more than 8 bits keep their fractions.
#[derive(Clone, Debug, PartialEq)]
pub struct Gray {
    width: usize,
    height: usize,
    levels: Vec<f32>,
}

impl Gray {
    /// A picture of levels, row by row.
    ///
    /// # Errors
    /// If their number is not width times height, or zero, or one is not a number.
    pub fn new(width: usize, height: usize, levels: Vec<f32>) -> Result<Self> {
        if width == 0 || width.checked_mul(height) != Some(levels.len()) {
            let found = levels.len();
            return Err(Error::new(format!("found {found} levels, expected {width} × {height} of a picture")));
        }
        if levels.iter().any(|it| !it.is_finite()) {
            return Err(Error::new("found a level that is no number, expected 0 to 255"));
        }
        Ok(Gray { width, height, levels })
    }

    /// A picture of bytes, row by row.
    ///
    /// # Errors
    /// Those of [`Gray::new`].
    pub fn from_bytes(width: usize, height: usize, bytes: &[u8]) -> Result<Self> {
        Gray::new(width, height, bytes.iter().map(|it| f32::from(*it)).collect())
    }

    pub(crate) fn from_level(width: usize, height: usize, level: f32) -> Self {
        Gray { width, height, levels: vec![level; width * height] }
    }

    /// Columns of pixels.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows of pixels.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// All levels, row by row.
    #[must_use]
    pub fn levels(&self) -> &[f32] {
        &self.levels
    }

    pub(crate) fn into_levels(self) -> Vec<f32> {
        self.levels
    }

    pub(crate) fn levels_mut(&mut self) -> &mut [f32] {
        &mut self.levels
    }

    /// The levels of a row.
    #[must_use]
    pub fn row(&self, row: usize) -> &[f32] {
        self.levels.get(row * self.width..(row + 1) * self.width).unwrap_or_default()
    }

    /// Levels rounded to bytes.
    #[must_use]
    pub fn bytes(&self) -> Vec<u8> {
        self.levels.iter().map(|it| it.round().clamp(0.0, 255.0) as u8).collect()
    }

    /// True if a point is at least this far inside the centres of the outermost pixels.
    #[inline]
    pub(crate) fn holds(&self, place: Vector2<f64>, margin_px: f64) -> bool {
        let [right, bottom] = [self.width, self.height].map(|it| it as f64 - 1.0 - margin_px);
        place.x >= margin_px && place.y >= margin_px && place.x <= right && place.y <= bottom
    }

    /// The level at a point between pixels, bilinear; outside the picture that of the nearest border.
    #[inline]
    pub(crate) fn level_at(&self, place: Vector2<f64>) -> f64 {
        let x = place.x.clamp(0.0, self.width as f64 - 1.0);
        let y = place.y.clamp(0.0, self.height as f64 - 1.0);
        // Short integers are converted faster.
        let (column, row) = (x as i32, y as i32);
        let (a, b) = (x - f64::from(column), y - f64::from(row));
        let first = row as usize * self.width + column as usize;
        // At the last column and row the next one has weight zero.
        let [right, below] =
            [(column, self.width), (row, self.height)].map(|(at, size)| (at as usize + 1 < size) as usize);
        let level = |at: usize| f64::from(self.levels[at]);
        let upper = level(first) * (1.0 - a) + level(first + right) * a;
        let first = first + below * self.width;
        let lower = level(first) * (1.0 - a) + level(first + right) * a;
        upper * (1.0 - b) + lower * b
    }

    /// The picture with a Gaussian blur, truncated at this number of standard deviations.
    #[must_use]
    pub fn blur(&self, sigma_px: f64, deviations: f64) -> Self {
        let reach = (deviations * sigma_px).ceil().clamp(0.0, 1000.0) as usize;
        if reach == 0 {
            return self.clone();
        }
        let weight = |k: usize| (-0.5 * ((k as f64 - reach as f64) / sigma_px).powi(2)).exp();
        let total: f64 = (0..=2 * reach).map(weight).sum();
        let weights: Vec<f32> = (0..=2 * reach).map(|k| (weight(k) / total) as f32).collect();
        run_vectorized(
            #[inline(always)]
            || self.convolve(&weights),
        )
    }

    /// Sums over a row of pixels in both directions, with weights.
    #[inline(always)]
    fn convolve(&self, weights: &[f32]) -> Self {
        let (width, height, reach) = (self.width, self.height, weights.len() / 2);
        let mut across = Gray::from_level(width, height, 0.0);
        let mut padded = vec![0.0; width + 2 * reach];
        for (row, target) in across.levels.chunks_exact_mut(width).enumerate() {
            let levels = self.row(row);
            padded[..reach].fill(levels[0]);
            padded[reach..reach + width].copy_from_slice(levels);
            padded[reach + width..].fill(levels[width - 1]);
            sums(target, weights, |k| &padded[k..]);
        }
        let mut whole = Gray::from_level(width, height, 0.0);
        for (row, target) in whole.levels.chunks_exact_mut(width).enumerate() {
            sums(target, weights, |k| across.row((row + k).saturating_sub(reach).min(height - 1)));
        }
        whole
    }
}

/// Weighted sums of levels at the same column of some rows.
#[inline(always)]
fn sums<'a>(target: &mut [f32], weights: &[f32], row: impl Fn(usize) -> &'a [f32]) {
    let (many, rest) = target.as_chunks_mut::<LANES>();
    let count = many.len();
    for (at, target) in many.iter_mut().enumerate() {
        let mut own = [0.0; LANES];
        for (k, weight) in weights.iter().enumerate() {
            let levels = lanes(row(k), at * LANES);
            for lane in 0..LANES {
                own[lane] += weight * levels[lane];
            }
        }
        *target = own;
    }
    for (at, target) in rest.iter_mut().enumerate() {
        let level = |k: usize| row(k).get(count * LANES + at).copied().unwrap_or_default();
        *target = weights.iter().enumerate().fold(0.0, |sum, (k, weight)| sum + weight * level(k));
    }
}
