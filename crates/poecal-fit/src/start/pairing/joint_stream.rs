//! Joint readings in time, interpolated between two of their rows.

use poecal_numerics::distributions::median;

/// Multiple of the usual step, and number of seconds, between two rows from which on there is a gap with unknown readings.
const GAP_STEPS: f64 = 4.5;
const GAP_S: f64 = 0.05;
/// Number of rows on each side of one whose stamps together determine its time, if stamps are late irregularly.
const BESIDE: usize = 25;
/// Scatter of stamps, as a share of the usual step and in seconds at least, from which on they are no clock of the rows. It exceeds the
/// rounding of their digits.
const IRREGULAR: f64 = 0.04;
const IRREGULAR_S: f64 = 5e-4;

/// A stream of joint readings by a clock of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct JointStream {
    times: Vec<f64>,
    readings: Vec<f64>,
    width: usize,
    gap_s: f64,
}

impl JointStream {
    /// Stream of times (seconds) and readings (rad, m), one row of `width` after the other; rows in the order of their times, one for each time.
    /// `None` without times.
    #[must_use]
    pub fn new(times: &[f64], readings: &[f64], width: usize) -> Option<Self> {
        let mut order: Vec<usize> =
            (0..times.len()).filter(|&at| times.get(at).is_some_and(|it| it.is_finite())).collect();
        order.sort_by(|&a, &b| times[a].total_cmp(&times[b]).then(a.cmp(&b)));
        order.dedup_by(|next, known| times[*next] <= times[*known]);
        if order.len() < 4 || width == 0 || readings.len() != width * times.len() || order.len() < times.len() / 2 {
            return None;
        }
        let own: Vec<f64> = order.iter().map(|&at| times[at]).collect();
        let step = median(own.windows(2).map(|it| it[1] - it[0]))?;
        let readings = order.iter().flat_map(|&at| readings[at * width..(at + 1) * width].iter().copied());
        Some(JointStream { times: own, readings: readings.collect(), width, gap_s: (GAP_STEPS * step).max(GAP_S) })
    }

    /// The same stream with each reading replaced by a function of its index and value.
    #[must_use]
    pub fn map(&self, each: impl Fn(usize, f64) -> f64) -> Self {
        let readings = self.readings.iter().enumerate().map(|(at, &value)| each(at % self.width, value));
        JointStream { readings: readings.collect(), ..self.clone() }
    }

    /// Times, seconds.
    #[must_use]
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Readings of a row.
    #[must_use]
    pub fn row(&self, at: usize) -> &[f64] {
        self.readings.get(at * self.width..(at + 1) * self.width).unwrap_or_default()
    }

    /// Writes readings at a time, and their rates, by the cubic through the rows around it with their mean slopes; `false` outside of the stream
    /// and in its gaps.
    pub fn interpolate(&self, time_s: f64, readings: &mut [f64], rates: &mut [f64]) -> bool {
        let after = self.times.partition_point(|it| *it <= time_s);
        if after < 2 || after + 1 >= self.times.len() {
            return false;
        }
        let own = |at: usize| self.times[at];
        let [t0, t1, t2, t3] = [after - 2, after - 1, after, after + 1].map(own);
        if [t1 - t0, t2 - t1, t3 - t2].iter().any(|it| *it > self.gap_s) {
            return false;
        }
        let (h, s) = (t2 - t1, (time_s - t1) / (t2 - t1));
        let rows = [after - 2, after - 1, after, after + 1].map(|at| self.row(at));
        for (k, (reading, rate)) in readings.iter_mut().zip(rates).enumerate().take(self.width) {
            let [a, b, c, d] = rows.map(|row| row[k]);
            // Slopes at the two rows: of the parabola through each and its neighbours.
            let slope = |(p, q, r): (f64, f64, f64), (before, next): (f64, f64)| {
                ((q - p) / before * next + (r - q) / next * before) / (before + next)
            };
            let m1 = slope((a, b, c), (t1 - t0, h));
            let m2 = slope((b, c, d), (h, t3 - t2));
            let (s2, s3) = (s * s, s * s * s);
            *reading = b * (2.0 * s3 - 3.0 * s2 + 1.0)
                + h * m1 * (s3 - 2.0 * s2 + s)
                + c * (3.0 * s2 - 2.0 * s3)
                + h * m2 * (s3 - s2);
            *rate = (b - c) * (6.0 * s2 - 6.0 * s) / h + m1 * (3.0 * s2 - 4.0 * s + 1.0) + m2 * (3.0 * s2 - 2.0 * s);
        }
        true
    }
}

/// Times of rows that come at equal steps, if their stamps are late irregularly: each by the stamps around it. `None` if stamps are regular, or the
/// rows are not.
#[must_use]
pub fn smooth_times(times: &[f64]) -> Option<Vec<f64>> {
    let count = times.len();
    if count < 4 * BESIDE || times.iter().any(|it| !it.is_finite()) {
        return None;
    }
    let step = (times[count - 1] - times[0]) / (count - 1) as f64;
    // Second differences of white noise with σ = 1 have the standard deviation √6.
    let scatter = median(times.windows(3).map(|it| (it[0] - 2.0 * it[1] + it[2]).abs()))? / (0.6745 * 6f64.sqrt());
    if step <= 0.0 || scatter < IRREGULAR_S.max(IRREGULAR * step) {
        return None;
    }
    let of = |at: usize| {
        let (first, next) = (at.saturating_sub(BESIDE), (at + BESIDE + 1).min(count));
        let number = (next - first) as f64;
        let (mut x, mut y, mut xx, mut xy) = (0.0, 0.0, 0.0, 0.0);
        for k in first..next {
            let (row, time) = (k as f64 - at as f64, times[k] - times[at]);
            (x, y, xx, xy) = (x + row, y + time, xx + row * row, xy + row * time);
        }
        let slope = (number * xy - x * y) / (number * xx - x * x);
        times[at] + (y - slope * x) / number
    };
    Some((0..count).map(of).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_between_rows_are_those_of_a_smooth_motion() {
        let times: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k)).collect();
        let of = |t: f64| (2.0 * t).sin();
        let readings: Vec<f64> = times.iter().map(|&t| of(t)).collect();
        let stream = JointStream::new(&times, &readings, 1).unwrap();
        let (mut value, mut rate) = ([0.0], [0.0]);
        let mut worst = (0.0_f64, 0.0_f64);
        for k in 0..150 {
            let t = 0.02 + 0.0123 * f64::from(k);
            assert!(stream.interpolate(t, &mut value, &mut rate));
            worst = (worst.0.max((value[0] - of(t)).abs()), worst.1.max((rate[0] - 2.0 * (2.0 * t).cos()).abs()));
        }
        println!("value {:.1e}, rate {:.1e}", worst.0, worst.1);
        // Third order of the slopes: h³ q''' / 48 and h² q''' / 12.
        assert!(worst.0 < 3e-7 && worst.1 < 3e-4);
        assert!(!stream.interpolate(-0.1, &mut value, &mut rate) && !stream.interpolate(2.5, &mut value, &mut rate));
    }

    #[test]
    fn stamps_that_are_late_irregularly_are_smoothed() {
        let late = |k: u32| -0.01 * (1.0 - (f64::from(k) * 0.618_033_988_75).fract()).ln();
        let times: Vec<f64> = (0..2000).map(|k| 0.01 * f64::from(k) + late(k)).collect();
        let found = smooth_times(&times).unwrap();
        let off: Vec<f64> = found.iter().enumerate().map(|(k, it)| it - 0.01 * k as f64).collect();
        let mean = off.iter().sum::<f64>() / off.len() as f64;
        let spread = (off.iter().map(|it| (it - mean).powi(2)).sum::<f64>() / off.len() as f64).sqrt();
        println!("mean {mean:.4} s, spread {spread:.4} s");
        assert!((mean - 0.01).abs() < 5e-4 && spread < 2e-3);
        let regular: Vec<f64> = (0..2000).map(|k| 0.01 * f64::from(k)).collect();
        assert_eq!(smooth_times(&regular), None);
    }
}
