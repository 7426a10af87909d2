//! Outlying robots of a line.

use super::FigureSeries;

/// Distance, in spreads of the line, beyond which a robot is an outlier.
const FAR: f64 = 6.0;
/// Distance that an outlier must also have, in standard deviations of line and measurement together.
const CERTAIN: f64 = 4.0;

/// A robot beyond the line's spread.
#[derive(Clone, Debug, PartialEq)]
pub struct OutlyingRobot {
    /// Serial number.
    pub serial: String,
    /// The figure.
    pub series: String,
    /// Joint, if the figure belongs to one.
    pub joint: Option<String>,
    /// Distance from the line's centre, spreads of the line.
    pub spreads: f64,
}

/// Robots more than six spreads of the line away in a figure, the farthest first; only those whose distance exceeds the uncertainty of the
/// measurement.
#[must_use]
pub fn outliers(all: &[FigureSeries]) -> Vec<OutlyingRobot> {
    let of = |series: &FigureSeries| {
        let spread = series.spread().filter(|it| series.is_enough() && it.seen > 0.0);
        let found = spread.map(|spread| {
            let each = series.values.iter().filter_map(move |value| {
                let (own, sigma) = series.comparison_value(value);
                let away = own - spread.center;
                let away = if series.is_size || series.is_sum() { away.max(0.0) } else { away.abs() };
                let line = spread.own.max(0.5 * spread.seen);
                let is_far = away > FAR * line && away > CERTAIN * line.hypot(sigma);
                is_far.then(|| OutlyingRobot {
                    serial: value.serial.clone(),
                    series: series.name.clone(),
                    joint: series.joint.clone(),
                    spreads: away / line,
                })
            });
            each.collect::<Vec<_>>()
        });
        found.unwrap_or_default()
    };
    let mut found: Vec<OutlyingRobot> = all.iter().flat_map(of).collect();
    found.sort_by(|a, b| b.spreads.total_cmp(&a.spreads).then_with(|| a.serial.cmp(&b.serial)));
    found
}
