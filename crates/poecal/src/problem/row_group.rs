//! Groups of rows that one kernel call can take: rows of one target and one station, all with or all without orientation.

use super::Problem;
use crate::estimate::Sight;
use crate::measurement::{Noise, Observation};
use crate::threads;

/// Rows that one thread groups at a time.
const CHUNK: usize = 8192;
/// Relative difference of two ratios that differ by rounding only.
const SAME_RATIO: f64 = 1e-14;

/// Rows of one target, station and kind, in the order given.
pub(super) struct RowGroup {
    pub(super) sight: Sight,
    /// Whether orientation was measured.
    pub(super) framed: bool,
    /// Position over rotation noise in m/rad, if it is the same in all rows.
    pub(super) ratio: Option<f64>,
    /// The rows, or another key of each.
    pub(super) rows: Vec<u32>,
}

impl RowGroup {
    /// Groups the rows of a problem.
    pub(super) fn of_problem(problem: &Problem<'_>) -> Vec<RowGroup> {
        if problem.rows.len() <= CHUNK {
            return RowGroup::of(problem, &problem.rows, |_, row| row);
        }
        let parts =
            threads::map_chunks(&problem.rows, CHUNK, |_, rows| RowGroup::of(problem, rows, |_, row| row));
        let mut groups: Vec<RowGroup> = Vec::new();
        for other in parts.into_iter().flatten() {
            match groups.iter_mut().find(|group| group.holds(other.sight, other.framed)) {
                Some(group) => {
                    group.ratio = same(group.ratio, other.ratio);
                    group.rows.extend(other.rows);
                }
                None => groups.push(other),
            }
        }
        groups
    }

    /// Groups rows by target, station and kind; stores `key(position, row)` of each.
    pub(super) fn of(problem: &Problem<'_>, rows: &[u32], key: impl Fn(u32, u32) -> u32) -> Vec<RowGroup> {
        let mut groups: Vec<RowGroup> = Vec::new();
        let usual = Whitening::new(problem.noise);
        let mut at = 0;
        for (position, &row) in (0..).zip(rows) {
            let observation = problem.session.observation(row);
            let framed = problem.measurement(row as usize).sees_orientation();
            let sight = Sight::from(observation);
            // Most rows are like the one before.
            if !groups.get(at).is_some_and(|group| group.holds(sight, framed)) {
                at = groups.iter().position(|group| group.holds(sight, framed)).unwrap_or(groups.len());
            }
            let ratio = framed.then(|| usual.of(observation, problem.noise).ratio);
            match groups.get_mut(at) {
                Some(group) => {
                    group.ratio = same(group.ratio, ratio);
                    group.rows.push(key(position, row));
                }
                None => groups.push(RowGroup { sight, framed, ratio, rows: vec![key(position, row)] }),
            }
        }
        groups
    }

    fn holds(&self, sight: Sight, framed: bool) -> bool {
        self.sight.is_like(sight) && self.framed == framed
    }
}

/// The one ratio that both are, but for rounding.
fn same(known: Option<f64>, other: Option<f64>) -> Option<f64> {
    known.zip(other).and_then(|(known, other)| ((other - known).abs() <= SAME_RATIO * known).then_some(known))
}

/// Weights that whiten a row's residual.
#[derive(Clone, Copy)]
pub(super) struct Whitening {
    /// `1/σ` of a position component.
    pub(super) weight: f64,
    /// Position over rotation noise.
    pub(super) ratio: f64,
}

impl Whitening {
    pub(super) fn new(noise: Noise) -> Self {
        Whitening { weight: 1.0 / noise.position_m, ratio: noise.position_m / noise.rotation_rad }
    }

    /// Whitening of a row, which may state its own noise; `self` is the whitening by the `usual` noise.
    #[inline(always)]
    pub(super) fn of(self, observation: &Observation, usual: Noise) -> Self {
        match (observation.sigma_position_m, observation.sigma_rotation_rad) {
            (None, None) => self,
            _ => Whitening::new(observation.noise_or(usual)),
        }
    }
}
