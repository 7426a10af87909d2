//! Lags at which the speeds of two streams are correlated.

use nalgebra::Vector3;

use poecal_numerics::distributions::median;

/// Step of the times at which speeds are compared, seconds: the fine one, and the largest number of coarse ones.
const FINE_S: f64 = 0.05;
const MOST: usize = 4000;
/// Share of the best correlation above which lags are candidates.
const SHARE: f64 = 0.5;

/// Speeds at equal steps of time; `NaN` where a stream has a gap.
struct Speeds {
    first_s: f64,
    step_s: f64,
    values: Vec<f64>,
}

/// Positions at some times, in order.
pub(crate) struct MotionTrack {
    times: Vec<f64>,
    places: Vec<Vector3<f64>>,
    gap_s: f64,
}

impl MotionTrack {
    /// Track of times in order, and positions.
    pub(crate) fn new(times: Vec<f64>, places: Vec<Vector3<f64>>) -> Self {
        let step = median(times.windows(2).map(|it| it[1] - it[0]).filter(|it| *it > 0.0)).unwrap_or(FINE_S);
        MotionTrack { times, places, gap_s: (4.5 * step).max(0.3) }
    }

    /// Length of the track, seconds.
    pub(crate) fn span_s(&self) -> f64 {
        self.times.last().zip(self.times.first()).map_or(0.0, |(last, first)| last - first)
    }

    fn position_at(&self, time_s: f64) -> Option<Vector3<f64>> {
        let after = self.times.partition_point(|it| *it <= time_s);
        let (from, to) = (after.checked_sub(1)?, after);
        let (a, b) = (*self.times.get(from)?, *self.times.get(to)?);
        if b - a > self.gap_s || b <= a {
            return None;
        }
        let (p, q) = (self.places.get(from)?, self.places.get(to)?);
        Some(p + (q - p) * ((time_s - a) / (b - a)))
    }

    fn speeds(&self, step_s: f64) -> Speeds {
        let first_s = self.times.first().copied().unwrap_or_default();
        let count = (self.span_s() / step_s) as usize + 1;
        let speed = |at: usize| {
            let (from, to) = (first_s + (at as f64 - 0.5) * step_s, first_s + (at as f64 + 0.5) * step_s);
            self.position_at(from).zip(self.position_at(to)).map_or(f64::NAN, |(a, b)| (b - a).norm() / step_s)
        };
        Speeds { first_s, step_s, values: (0..count).map(speed).collect() }
    }
}

/// Correlation of two streams of speeds, the first one's row `k` with the second one's row `k + by`; `None` if too few overlap.
fn correlation(one: &Speeds, other: &Speeds, by: isize, fewest: usize) -> Option<f64> {
    let (mut n, mut x, mut y, mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    let first = usize::try_from(-by).unwrap_or_default();
    let skipped = usize::try_from(by).unwrap_or_default();
    for (a, b) in one.values.iter().skip(first).zip(other.values.iter().skip(skipped)) {
        if a.is_nan() || b.is_nan() {
            continue;
        }
        (n, x, y) = (n + 1.0, x + a, y + b);
        (xx, yy, xy) = (xx + a * a, yy + b * b, xy + a * b);
    }
    if n < fewest as f64 {
        return None;
    }
    let (of_x, of_y) = (n * xx - x * x, n * yy - y * y);
    (of_x > 0.0 && of_y > 0.0).then(|| (n * xy - x * y) / (of_x * of_y).sqrt())
}

/// Lags (time of the second less that of the first) by correlation, the best first. Their largest number, their least distance and the least
/// overlap are limited; with a stated lag (and its largest error) only lags near it count.
pub(crate) fn lags(
    (one, other): (&MotionTrack, &MotionTrack),
    overlap_s: f64,
    (most, apart_s): (usize, f64),
    stated: Option<(f64, f64)>,
) -> Vec<f64> {
    let longest = one.span_s().max(other.span_s());
    let coarse = FINE_S.max(longest / MOST as f64);
    let is_allowed = |lag: f64, more: f64| stated.is_none_or(|(at, off)| (lag - at).abs() <= off + more);
    let (a, b) = (one.speeds(coarse), other.speeds(coarse));
    let fewest = (overlap_s / coarse) as usize;
    let lag_of = |by: isize| other_first(&a, &b) + by as f64 * coarse;
    let limit = |count: usize| isize::try_from(count).unwrap_or(isize::MAX);
    let all: Vec<(f64, f64)> = (-limit(a.values.len())..=limit(b.values.len()))
        .filter(|&by| is_allowed(lag_of(by), coarse))
        .filter_map(|by| Some((correlation(&a, &b, by, fewest)?, lag_of(by))))
        .collect();
    let mut peaks: Vec<(f64, f64)> = (0..all.len())
        .filter(|&k| {
            let beside = |at: Option<usize>| at.and_then(|at| all.get(at)).map_or(f64::NEG_INFINITY, |it| it.0);
            all[k].0 >= beside(k.checked_sub(1)) && all[k].0 > beside(Some(k + 1))
        })
        .map(|k| all[k])
        .collect();
    peaks.sort_by(|a, b| b.0.total_cmp(&a.0));
    let best = peaks.first().map_or(0.0, |it| it.0);
    let mut found: Vec<f64> = Vec::new();
    for (value, lag) in peaks {
        if value < SHARE * best || value <= 0.0 || found.len() >= most {
            break;
        }
        let near = refine_lag((one, other), lag, coarse, overlap_s);
        if found.iter().all(|it| (it - near).abs() >= apart_s) && is_allowed(near, FINE_S) {
            found.push(near);
        }
    }
    found
}

/// Time of the first speed of the second stream less that of the first one.
fn other_first(one: &Speeds, other: &Speeds) -> f64 {
    debug_assert!(one.step_s == other.step_s);
    other.first_s - one.first_s
}

/// Lag near one that was found with coarse steps.
fn refine_lag((one, other): (&MotionTrack, &MotionTrack), lag: f64, coarse: f64, overlap_s: f64) -> f64 {
    if coarse <= FINE_S {
        return lag;
    }
    // A part of the streams is enough.
    let (a, b) = (one.speeds(FINE_S), other.speeds(FINE_S));
    let fewest = (overlap_s.min(0.5 * a.values.len() as f64 * FINE_S) / FINE_S) as usize;
    let around = ((lag - other_first(&a, &b)) / FINE_S).round() as isize;
    let within = (1.5 * coarse / FINE_S).ceil() as isize;
    let best = (around - within..=around + within)
        .filter_map(|by| Some((correlation(&a, &b, by, fewest)?, by)))
        .max_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or(lag, |(_, by)| other_first(&a, &b) + by as f64 * FINE_S)
}
