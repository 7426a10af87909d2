//! Static intervals in a stream of readings or of measurements.

use std::ops::Range;

use poecal_numerics::distributions::{mean_square_quantile, median};

/// Shortest static interval, and the time that is cut off at both of its ends, seconds.
const SHORTEST_S: f64 = 0.3;
const CUT_S: f64 = 0.1;
/// Share of the shortest time that is enough for one of these.
const SHORT: f64 = 0.75;
/// Least share of the time of a stream that short static intervals alone must have.
const MOSTLY_STILL: f64 = 0.8;
/// Longest time without a row within a window, seconds, and as a number of steps from row to row if that is longer.
const LONGEST_GAP_S: f64 = 0.15;
const LONGEST_GAP_STEPS: f64 = 2.5;
/// Fewest rows of a window.
const FEWEST: usize = 3;
/// Least share of static windows: the scatter at this quantile is the noise.
const QUIET: f64 = 0.1;
/// Standard normal quantiles of that share, and of the largest scatter of a static window.
const QUIET_SCORE: f64 = -1.281_6;
const STILL_SCORE: f64 = 3.3;
/// Largest ratio of a window's scatter to that of the quietest windows, and to that from row to row: noise is neither white nor the same
/// everywhere.
const TIMES: f64 = 1.5;
const TIMES_NOISE: f64 = 4.0;
/// Two static intervals whose means differ by less than this many tolerances are one, which was interrupted.
const SAME: f64 = 2.0;
/// Share of the range of a channel beyond which its tolerance means that there is no static interval.
const LARGEST: f64 = 0.05;

/// A static interval.
#[derive(Clone, Debug, PartialEq)]
pub struct StaticInterval {
    /// Rows, without those at its ends.
    pub rows: Range<usize>,
    /// Begin and end, seconds.
    pub span_s: (f64, f64),
}

/// Numbers of the rows of a stream that move together, such as the coordinates of a point.
#[derive(Clone, Debug)]
pub struct StreamChannels {
    /// Values of each number.
    pub values: Vec<Vec<f64>>,
    /// Number of directions in which they move.
    pub freedom: usize,
    /// Largest change that counts as no motion.
    pub floor: f64,
}

/// Reason why rows that change like those of a recording are no stream.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StreamFailure {
    /// A row has no time.
    NoTime(usize),
    /// The time of a row is before that of the row above it.
    Back(usize),
    /// The usual time from one row to the next is too long, seconds.
    Slow(f64),
}

impl StreamFailure {
    /// The same reason, by other numbers of its rows.
    #[must_use]
    pub fn of_rows(self, rows: &[usize]) -> Self {
        let of = |row: usize| rows.get(row).copied().unwrap_or(row);
        match self {
            StreamFailure::NoTime(row) => StreamFailure::NoTime(of(row)),
            StreamFailure::Back(row) => StreamFailure::Back(of(row)),
            StreamFailure::Slow(_) => self,
        }
    }
}

/// Rows of a stream: times (seconds), and some numbers of each row.
#[derive(Clone, Debug)]
pub struct RowStream {
    times: Vec<f64>,
    channels: Vec<StreamChannels>,
}

impl RowStream {
    /// Stream of the times of rows, and of their channels.
    #[must_use]
    pub fn new(times: Vec<f64>, channels: Vec<StreamChannels>) -> Self {
        RowStream { times, channels }
    }

    /// True if it is a stream: rows in time, at most a quarter of a second from one to the next, and far more of them than static
    /// positions.
    #[must_use]
    pub fn is_dense(&self) -> bool {
        self.is_smooth() && self.no_stream().is_none()
    }

    /// True if most rows are near the ones before them, as in a recording.
    #[must_use]
    pub fn is_smooth(&self) -> bool {
        const ROWS: usize = 50;
        const STEP: f64 = 0.05;
        let mut values = self.channels.iter().flat_map(|it| &it.values);
        self.times.len() >= ROWS
            && values.all(|it| {
                let moved = median(it.windows(2).map(|it| (it[1] - it[0]).abs())).unwrap_or_default();
                moved <= STEP * span(it)
            })
    }

    /// Fault of the times, if rows are those of a recording.
    #[must_use]
    pub fn no_stream(&self) -> Option<StreamFailure> {
        const STEP_S: f64 = 0.25;
        if let Some(row) = self.times.iter().position(|it| !it.is_finite()) {
            return Some(StreamFailure::NoTime(row));
        }
        let steps = self.times.windows(2).map(|it| it[1] - it[0]);
        let step = median(steps.clone().map(f64::abs)).unwrap_or(f64::INFINITY);
        if step > STEP_S || step == 0.0 {
            return Some(StreamFailure::Slow(step));
        }
        self.times.windows(2).position(|it| it[1] < it[0]).map(|at| StreamFailure::Back(at + 1))
    }

    /// Times of 0.3 s or longer in which no channel moves by more than its own noise, without 0.1 s at both ends.
    #[must_use]
    pub fn stands(&self) -> Vec<StaticInterval> {
        let found = self.stands_by(SHORTEST_S);
        if !found.is_empty() {
            return found;
        }
        // Only consecutive static intervals, each as short as possible, are detected by shorter windows.
        let step = median(self.times.windows(2).map(|it| it[1] - it[0])).unwrap_or_default();
        let mut found = self.stands_by(0.5 * SHORTEST_S);
        // A row at an end may be lost in the noise.
        let lasts = |it: &StaticInterval| it.span_s.1 - it.span_s.0 + step;
        found.retain(|it| lasts(it) >= SHORT * SHORTEST_S);
        let still: f64 = found.iter().map(lasts).sum();
        let all = self.times.last().zip(self.times.first()).map_or(0.0, |(last, first)| last - first);
        if still >= MOSTLY_STILL * all { found } else { Vec::new() }
    }

    /// Static intervals by windows of this length, seconds.
    fn stands_by(&self, window_s: f64) -> Vec<StaticInterval> {
        let windows = self.windows(window_s);
        if windows.len() < FEWEST {
            return Vec::new();
        }
        let sums: Vec<Vec<ChannelSums>> =
            self.channels.iter().map(|it| it.values.iter().map(|it| ChannelSums::from_values(it)).collect()).collect();
        let mut still = vec![true; windows.len()];
        let mut tolerances = Vec::with_capacity(self.channels.len());
        for (channels, sums) in self.channels.iter().zip(&sums) {
            let spreads: Vec<f64> = windows.iter().map(|it| deviation(sums, it)).collect();
            let bends = bends(&channels.values, self.times.len());
            let noises: Vec<f64> = windows.iter().map(|it| row_noise(&bends, it)).collect();
            let rows = median(windows.iter().map(|it| it.len() as f64)).unwrap_or_default();
            let freedom = channels.freedom as f64;
            // A window of few rows scatters less than the noise, and more from window to window.
            let (own, steps) = (freedom * (rows - 1.0), freedom * (rows - 2.0).max(1.0));
            let noise = quantile(&spreads, QUIET) / mean_square_quantile(own, QUIET_SCORE).sqrt();
            let row_noise = quantile(&noises, QUIET) / mean_square_quantile(steps, QUIET_SCORE).sqrt();
            let most = mean_square_quantile(own, STILL_SCORE).sqrt();
            let floor = channels.floor;
            let tolerance = floor.max(most * (TIMES * noise).min(TIMES_NOISE * row_noise + floor));
            let widest = channels.values.iter().map(|it| span(it)).fold(0.0, f64::max);
            if tolerance > LARGEST * widest && widest > 10.0 * floor {
                return Vec::new();
            }
            for (still, spread) in still.iter_mut().zip(&spreads) {
                *still &= *spread <= tolerance;
            }
            tolerances.push(tolerance);
        }
        let mut rows: Vec<Range<usize>> = Vec::new();
        for (window, _) in windows.iter().zip(&still).filter(|it| *it.1) {
            match rows.last_mut() {
                Some(last) if window.start < last.end => last.end = window.end,
                _ => rows.push(window.clone()),
            }
        }
        let mut joined: Vec<Range<usize>> = Vec::new();
        for next in rows {
            let is_near = |last: &Range<usize>, (sums, tolerance): (&Vec<ChannelSums>, &f64)| {
                let apart = sums.iter().map(|it| (it.mean(last) - it.mean(&next)).powi(2)).sum::<f64>();
                apart.sqrt() <= SAME * tolerance
            };
            let is_same = joined.last().is_some_and(|last| sums.iter().zip(&tolerances).all(|it| is_near(last, it)));
            match joined.last_mut() {
                Some(last) if is_same => last.end = next.end,
                _ => joined.push(next),
            }
        }
        joined.into_iter().filter_map(|it| self.trim_ends(&it)).collect()
    }

    /// A static interval without its ends.
    fn trim_ends(&self, rows: &Range<usize>) -> Option<StaticInterval> {
        let (first, last) = (*self.times.get(rows.start)?, *self.times.get(rows.end.checked_sub(1)?)?);
        let cut = CUT_S.min(0.25 * (last - first));
        let is_inside = |at: &usize| self.times.get(*at).is_some_and(|it| (first + cut..=last - cut).contains(it));
        let start = rows.clone().find(is_inside)?;
        let end = rows.clone().rev().find(is_inside)? + 1;
        Some(StaticInterval { rows: start..end, span_s: (first, last) })
    }

    /// Windows of this length, seconds, one from each row on, without gaps.
    fn windows(&self, window_s: f64) -> Vec<Range<usize>> {
        let mut found = Vec::new();
        let step = median(self.times.windows(2).map(|it| it[1] - it[0])).unwrap_or_default();
        let longest = LONGEST_GAP_S.max(LONGEST_GAP_STEPS * step);
        let (mut end, mut gap) = (0, None);
        for start in 0..self.times.len() {
            let time = |at: usize| self.times.get(at).copied();
            let Some(begin) = time(start) else { break };
            while let Some(next) = time(end) {
                if end > start && next - time(end - 1).unwrap_or(next) > longest {
                    gap = Some(end);
                }
                if next - begin >= window_s {
                    break;
                }
                end += 1;
            }
            let has_gap = gap.is_some_and(|it| it > start && it <= end);
            if end < self.times.len() && !has_gap && end + 1 - start >= FEWEST {
                found.push(start..end + 1);
            }
        }
        found
    }
}

/// Sums of a channel and of its squares up to each row, about its mean.
struct ChannelSums {
    middle: f64,
    first: Vec<f64>,
    second: Vec<f64>,
}

impl ChannelSums {
    fn from_values(values: &[f64]) -> Self {
        let middle = values.iter().sum::<f64>() / values.len().max(1) as f64;
        let running = |of: &dyn Fn(f64) -> f64| {
            let mut sum = 0.0;
            let rest = values.iter().map(|it| {
                sum += of(it - middle);
                sum
            });
            std::iter::once(0.0).chain(rest.collect::<Vec<_>>()).collect()
        };
        ChannelSums { middle, first: running(&|it| it), second: running(&|it| it * it) }
    }

    fn sum_over(of: &[f64], rows: &Range<usize>) -> f64 {
        of.get(rows.end).zip(of.get(rows.start)).map_or(0.0, |(end, start)| end - start)
    }

    fn mean(&self, rows: &Range<usize>) -> f64 {
        self.middle + Self::sum_over(&self.first, rows) / rows.len().max(1) as f64
    }

    /// Variance of rows.
    fn variance(&self, rows: &Range<usize>) -> f64 {
        let count = rows.len().max(2) as f64;
        let mean = Self::sum_over(&self.first, rows) / count;
        (Self::sum_over(&self.second, rows) - count * mean * mean).max(0.0) / (count - 1.0)
    }
}

/// Standard deviation of numbers in a window, of all together.
fn deviation(sums: &[ChannelSums], rows: &Range<usize>) -> f64 {
    sums.iter().map(|it| it.variance(rows)).sum::<f64>().sqrt()
}

/// Sums of squared second differences of numbers, of all together, up to each row.
fn bends(values: &[Vec<f64>], rows: usize) -> Vec<f64> {
    let square = |at: usize| -> f64 {
        let of = |it: &Vec<f64>| it.get(at..at + 3).map_or(0.0, |it| (it[0] - 2.0 * it[1] + it[2]).powi(2));
        values.iter().map(of).sum()
    };
    let mut sum = 0.0;
    let sums = (0..rows.saturating_sub(2)).map(|at| {
        sum += square(at);
        sum
    });
    std::iter::once(0.0).chain(sums).collect()
}

/// Noise of numbers in a window, of all together, from row to row, by second differences.
fn row_noise(bends: &[f64], rows: &Range<usize>) -> f64 {
    let inner = rows.start..rows.end.saturating_sub(2).max(rows.start);
    // White noise of one unit has second differences of √6.
    (ChannelSums::sum_over(bends, &inner).max(0.0) / inner.len().max(1) as f64 / 6.0).sqrt()
}

/// Quantile of values.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut values = values.to_vec();
    let Some(last) = values.len().checked_sub(1) else { return 0.0 };
    let at = (share * values.len() as f64) as usize;
    *values.select_nth_unstable_by(at.min(last), f64::total_cmp).1
}

fn span(values: &[f64]) -> f64 {
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |it, value| (it.0.min(*value), it.1.max(*value)));
    (high - low).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Five static intervals of one second between moves of half a second, at 100 rows a second, with noise.
    fn stream(noise: f64) -> RowStream {
        let mut values = Vec::new();
        for stand in 0..5 {
            let place = f64::from(stand);
            values.extend((0..100).map(|_| place));
            values.extend((1..50).map(|it| {
                let share = f64::from(it) / 50.0;
                place + share * share * (3.0 - 2.0 * share)
            }));
        }
        // A deterministic noise: digits of multiples of an irrational number.
        let noisy = |(at, value): (usize, f64)| value + noise * ((at as f64 * 0.618_033_988_7).fract() - 0.5);
        let values: Vec<f64> = values.into_iter().enumerate().map(noisy).collect();
        let times = (0..values.len()).map(|it| 0.01 * it as f64).collect();
        single_stream(times, values)
    }

    /// A stream of one number.
    fn single_stream(times: Vec<f64>, values: Vec<f64>) -> RowStream {
        RowStream::new(times, vec![StreamChannels { values: vec![values], freedom: 1, floor: 1e-5 }])
    }

    #[test]
    fn stands_are_found_whatever_the_noise() {
        for noise in [0.0, 1e-4, 1e-3, 1e-2] {
            let stream = stream(noise);
            assert!(stream.is_dense());
            let stands = stream.stands();
            println!("noise {noise}: {:?}", stands.iter().map(|it| it.rows.clone()).collect::<Vec<_>>());
            assert_eq!(stands.len(), 5, "{noise}");
            for (at, stand) in stands.iter().enumerate() {
                let begin = 149 * at;
                assert!(stand.rows.start >= begin && stand.rows.end <= begin + 100, "{noise} {at} {stand:?}");
                assert!(stand.rows.len() > 60, "{noise} {at}");
            }
        }
    }

    #[test]
    fn what_never_stands_has_no_stands() {
        let times: Vec<f64> = (0..2000).map(|it| 0.01 * f64::from(it)).collect();
        let values: Vec<f64> = times.iter().map(|it| (0.7 * it).sin() + 0.3 * (1.9 * it).cos()).collect();
        assert_eq!(single_stream(times, values).stands(), []);
    }

    #[test]
    fn what_is_wrong_with_times_is_said() {
        let RowStream { times, channels } = stream(1e-3);
        let of = |change: &dyn Fn(usize, f64) -> f64| {
            let times = times.iter().enumerate().map(|(at, it)| change(at, *it)).collect();
            let stream = RowStream::new(times, channels.clone());
            assert!(stream.is_smooth());
            stream.no_stream()
        };
        assert_eq!(of(&|_, it| it), None);
        assert_eq!(of(&|at, it| if at == 70 { f64::NAN } else { it }), Some(StreamFailure::NoTime(70)));
        assert_eq!(of(&|at, it| if at == 70 { it - 1.0 } else { it }), Some(StreamFailure::Back(70)));
        assert_eq!(of(&|_, it| -it), Some(StreamFailure::Back(1)));
        assert!(matches!(of(&|_, it| 1e3 * it), Some(StreamFailure::Slow(step)) if (step - 10.0).abs() < 1e-9));
    }

    #[test]
    fn a_list_of_places_is_no_stream() {
        let times: Vec<f64> = (0..100).map(|it| 0.001 * f64::from(it)).collect();
        let values: Vec<f64> = (0..100).map(|it| (f64::from(it) * 0.618).fract()).collect();
        assert!(!single_stream(times, values).is_dense());
    }
}
