//! Noise of a picture, and reasons why a board may not be visible in it.

use crate::gray::Gray;

/// Standard deviation of the noise of a pixel, gray levels: from second differences in both directions, at least half of which must be noise alone.
pub(crate) fn noise(gray: &Gray) -> f64 {
    let (width, height) = (gray.width(), gray.height());
    let mut found: Vec<f32> = Vec::with_capacity(width * height / 16 + 1);
    for row in (1..height.saturating_sub(1)).step_by(4) {
        let [above, own, below] = [row - 1, row, row + 1].map(|it| gray.row(it));
        for x in (1..width.saturating_sub(1)).step_by(4) {
            let sides = own[x - 1] + own[x + 1] + above[x] + below[x];
            let diagonal = above[x - 1] + above[x + 1] + below[x - 1] + below[x + 1];
            let second = (4.0 * own[x] - 2.0 * sides + diagonal).abs();
            // If nothing differs, light or dark is cut off.
            if second > 0.0 {
                found.push(second);
            }
        }
    }
    if found.is_empty() {
        return 0.3;
    }
    let middle = found.len() / 2;
    let (_, median, _) = found.select_nth_unstable_by(middle, f32::total_cmp);
    // The weights have squares of 36; a median of magnitudes is 0.6745 standard deviations. Rounding has 0.29.
    (f64::from(*median) / (6.0 * 0.6745)).clamp(0.3, 255.0)
}

/// Appearance of a picture as a whole.
pub(crate) struct PictureLight {
    /// Level that one pixel in a hundred exceeds.
    pub(crate) lightest: f64,
    /// Part of the pixels that are white.
    pub(crate) white: f64,
    /// Pixels over which the steepest edges rise.
    pub(crate) edge_px: f64,
}

impl PictureLight {
    pub(crate) fn new(gray: &Gray) -> Self {
        let mut counts = [0_usize; 256];
        let mut slopes: Vec<f32> = Vec::new();
        let (width, height) = (gray.width(), gray.height());
        for row in (0..height).step_by(3) {
            let levels = gray.row(row);
            levels.iter().for_each(|level| counts[level.clamp(0.0, 255.0) as usize] += 1);
            // Means of pairs four pixels apart, so that noise is no edge.
            slopes.extend(
                (0..width.saturating_sub(5))
                    .step_by(3)
                    .map(|x| (levels[x + 4] + levels[x + 5] - levels[x] - levels[x + 1]).abs() / 8.0),
            );
        }
        let total: usize = counts.iter().sum();
        let quantile = |part: f64| {
            let mut left = part * total as f64;
            counts.iter().position(|count| {
                left -= *count as f64;
                left < 0.0
            })
        };
        let (darkest, lightest) = (quantile(0.01).unwrap_or(0) as f64, quantile(0.99).unwrap_or(255) as f64);
        let white = counts[252..].iter().sum::<usize>() as f64 / total.max(1) as f64;
        let at = (slopes.len() * 399 / 400).min(slopes.len().saturating_sub(1));
        let steepest =
            if slopes.is_empty() { 0.0 } else { f64::from(*slopes.select_nth_unstable_by(at, f32::total_cmp).1) };
        PictureLight { lightest, white, edge_px: (lightest - darkest) / steepest.max(0.1) }
    }
}
