//! Cp and Cpk, with intervals.

use super::FigureSeries;

/// 97.5 % quantile of the normal distribution: 5 % lie beyond both sides.
const NORMAL: f64 = 1.959_963_985;

/// A value with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The value.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Capability of a line with respect to limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capability {
    /// Width of the limits over six spreads; `None` with one limit.
    pub cp: Option<Interval>,
    /// Distance of the mean from the nearer limit over three spreads.
    pub cpk: Interval,
}

impl Capability {
    /// Capability of a series with a lower and an upper limit, either of which may be missing: by the line's own spread, whose uncertainty is that of
    /// the observed spread times the squared ratio of both. `None` with fewer robots than [`FEWEST`](super::FEWEST), or without a spread.
    #[must_use]
    pub fn from_series(series: &FigureSeries, low: Option<f64>, high: Option<f64>) -> Option<Self> {
        let plain = FigureSeries { is_size: false, ..series.clone() };
        let spread = plain.spread().filter(|it| series.is_enough() && it.own > 0.0)?;
        let count = spread.count as f64;
        let mean = spread.center;
        // Standard deviation of a median of n normal values: √(π/2) times that of their mean.
        let of_center = std::f64::consts::FRAC_PI_2 * (spread.seen / spread.own).powi(2) / (9.0 * count);
        let relative = (spread.seen / spread.own).powi(4) / (2.0 * (count - 1.0));
        let with = |value: f64, variance: f64| {
            let half = NORMAL * variance.sqrt();
            Interval { value, low: value - half, high: value + half }
        };
        let each = [low.map(|low| mean - low), high.map(|high| high - mean)];
        let nearer = each.into_iter().flatten().fold(f64::INFINITY, f64::min);
        if !nearer.is_finite() {
            return None;
        }
        let cpk = nearer / (3.0 * spread.own);
        let cp = low.zip(high).map(|(low, high)| (high - low) / (6.0 * spread.own));
        Some(Capability {
            cp: cp.map(|cp| with(cp, cp * cp * relative)),
            cpk: with(cpk, of_center + cpk * cpk * relative),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fleet::series::tests::draw_line;

    #[test]
    fn intervals_hold_what_they_say() {
        for share in [0.0, 0.7] {
            let (mut inside, lines) = (0, 1000);
            for seed in 0..lines {
                let series = draw_line(seed, 100, share);
                let found = Capability::from_series(&series, Some(-4.0), Some(4.5)).unwrap().cpk;
                inside += usize::from(found.low <= 4.0 / 3.0 && 4.0 / 3.0 <= found.high);
            }
            let share_inside = inside as f64 / lines as f64;
            println!(
                "stated deviation {share}: Cpk within its 95 % interval in {:.1} % of {lines} lines",
                100.0 * share_inside
            );
            assert!((0.92..=0.98).contains(&share_inside));
        }
    }
}
