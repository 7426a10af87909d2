//! Steps and trends of a line: an exponentially weighted moving average of each figure.

use super::{FEWEST, FigureSeries};
use poecal_numerics::distributions::median;

/// Weight of the newest robot.
const NEWEST: f64 = 0.2;
/// Standard deviations of the average beyond which a line has changed, for all figures together.
const LIMIT: f64 = 4.5;
/// Ratio of the median absolute difference of neighbours to their standard deviation, for a normal distribution.
const OF_NEIGHBOURS: f64 = 0.953_872_552;

/// A step of one figure.
#[derive(Clone, Debug, PartialEq)]
pub struct FigureStep {
    /// The figure.
    pub series: String,
    /// Joint, if the figure belongs to one.
    pub joint: Option<String>,
    /// Serial number of the first robot of the changed line.
    pub since: String,
    /// Index of this robot, from 0.
    pub from: usize,
    /// Index of the robot at which the step was certain.
    pub seen_at: usize,
    /// Size, in the figure's unit; for sizes a factor.
    pub size: f64,
    /// The figure's unit; `None` for a factor.
    pub unit: Option<&'static str>,
}

/// The moving average after each value.
#[must_use]
pub fn moving_average(values: &[f64]) -> Vec<f64> {
    let mut average = values.iter().take(FEWEST).sum::<f64>() / values.len().clamp(1, FEWEST) as f64;
    let next = |value: &f64| {
        average += NEWEST * (value - average);
        average
    };
    values.iter().map(next).collect()
}

/// The first step of a figure after its first thirty robots, relative to these; `None` without a step, or with fewer robots.
fn step(series: &FigureSeries) -> Option<FigureStep> {
    if series.values.len() <= FEWEST {
        return None;
    }
    let values: Vec<f64> = series.values.iter().map(|it| series.comparison_value(it).0).collect();
    let neighbours = values.windows(2).map(|it| (it[1] - it[0]).abs());
    let sigma = median(neighbours)? / OF_NEIGHBOURS;
    if sigma <= 0.0 {
        return None;
    }
    let first = &values[..FEWEST];
    let center = median(first.iter().copied())?;
    // Without single outliers of the line.
    let kept: Vec<f64> = first.iter().copied().filter(|it| (it - center).abs() < 4.0 * sigma).collect();
    let center = kept.iter().sum::<f64>() / kept.len().max(1) as f64;
    // The centre is that of thirty robots: its uncertainty counts too.
    let width = sigma * (NEWEST / (2.0 - NEWEST) + 1.0 / kept.len().max(1) as f64).sqrt();
    let (mut average, mut from) = (center, FEWEST);
    for (at, value) in values.iter().enumerate().skip(FEWEST) {
        let away = (value - center).clamp(-4.0 * sigma, 4.0 * sigma);
        let before = average - center;
        average += NEWEST * (center + away - average);
        if (average - center) * before <= 0.0 {
            from = at;
        }
        if (average - center).abs() > LIMIT * width {
            let after = &values[from..=at];
            let size = after.iter().sum::<f64>() / after.len() as f64 - center;
            return Some(FigureStep {
                series: series.name.clone(),
                joint: series.joint.clone(),
                since: series.values[from].serial.clone(),
                from,
                seen_at: at,
                size: if series.is_size { size.exp() } else { size },
                unit: (!series.is_size).then_some(series.unit),
            });
        }
    }
    None
}

/// The steps of all figures, in the order of their detection.
#[must_use]
pub fn steps(all: &[FigureSeries]) -> Vec<FigureStep> {
    let mut found: Vec<FigureStep> = all.iter().filter_map(step).collect();
    found.sort_by_key(|it| it.seen_at);
    found
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_core::SeedableRng;

    use super::*;
    use crate::fleet::FigureValue;
    use poecal_model::simulate::random::normal;

    fn line(generator: &mut ChaCha8Rng, count: usize, at: usize, size: f64) -> FigureSeries {
        let values = (0..count).map(|robot| {
            let value = normal(generator) + if robot >= at { size } else { 0.0 };
            FigureValue { serial: robot.to_string(), value, sigma: 0.0 }
        });
        FigureSeries { name: "a".into(), joint: None, unit: "deg", is_size: false, values: values.collect() }
    }

    #[test]
    fn a_step_is_seen_within_ten_robots_and_steady_lines_have_none() {
        let lines = 500;
        let mut generator = ChaCha8Rng::seed_from_u64(1);
        let seen = (0..lines).filter(|_| {
            let series = line(&mut generator, 100, 70, 3.0);
            step(&series).is_some_and(|it| it.seen_at >= 70 && it.seen_at < 80)
        });
        let seen = seen.count() as f64 / f64::from(lines);
        let steady = (0..lines).filter(|_| (0..18).any(|_| step(&line(&mut generator, 200, 200, 0.0)).is_some()));
        let steady = steady.count() as f64 / f64::from(lines);
        println!(
            "steps of three spreads seen within ten robots: {:.1} %; false ones in 170 robots of 18 figures: {:.1} %",
            100.0 * seen,
            100.0 * steady
        );
        assert!(seen >= 0.9 && steady <= 0.2);
    }
}
