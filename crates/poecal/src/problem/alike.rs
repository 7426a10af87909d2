//! Rows that are computed alike: those of one target, seen from one place, with or without orientation.

use super::Problem;
use crate::estimate::Sight;
use crate::measurement::{Noise, Observation};
use crate::threads;

/// Rows that one thread sorts at a time.
const CHUNK: usize = 8192;
/// Relative difference of two ratios that differ by rounding only.
const SAME_RATIO: f64 = 1e-14;

/// Rows that are computed alike, in the order given.
pub(super) struct Alike {
    pub(super) sight: Sight,
    /// Whether orientation was measured.
    pub(super) framed: bool,
    /// Position over rotation noise in m/rad, if it is the same in all rows.
    pub(super) ratio: Option<f64>,
    /// The rows, or their places in what was sorted.
    pub(super) rows: Vec<u32>,
}

impl Alike {
    /// Sorts the rows of a problem.
    pub(super) fn sorted(problem: &Problem<'_>) -> Vec<Alike> {
        if problem.rows.len() <= CHUNK {
            return Alike::of(problem, &problem.rows, |_, row| row);
        }
        let parts =
            threads::map_chunks(&problem.rows, CHUNK, |_, rows| Alike::of(problem, rows, |_, row| row));
        let mut sorted: Vec<Alike> = Vec::new();
        for other in parts.into_iter().flatten() {
            match sorted.iter_mut().find(|alike| alike.holds(other.sight, other.framed)) {
                Some(alike) => {
                    alike.ratio = same(alike.ratio, other.ratio);
                    alike.rows.extend(other.rows);
                }
                None => sorted.push(other),
            }
        }
        sorted
    }

    /// Sorts some rows of the data; each is held by the name that `name` gives it, told its place among these rows and its number.
    pub(super) fn of(problem: &Problem<'_>, rows: &[u32], name: impl Fn(u32, u32) -> u32) -> Vec<Alike> {
        let mut sorted: Vec<Alike> = Vec::new();
        let usual = Whitening::new(problem.noise);
        let mut at = 0;
        for (place, &row) in (0..).zip(rows) {
            let observation = &problem.data.observations[row as usize];
            let framed = problem.measurement(row as usize).sees_orientation();
            let sight = Sight::from(observation);
            // Most rows are like the one before.
            if !sorted.get(at).is_some_and(|alike| alike.holds(sight, framed)) {
                at = sorted.iter().position(|alike| alike.holds(sight, framed)).unwrap_or(sorted.len());
            }
            let ratio = framed.then(|| usual.of(observation, problem.noise).ratio);
            match sorted.get_mut(at) {
                Some(alike) => {
                    alike.ratio = same(alike.ratio, ratio);
                    alike.rows.push(name(place, row));
                }
                None => sorted.push(Alike { sight, framed, ratio, rows: vec![name(place, row)] }),
            }
        }
        sorted
    }

    fn holds(&self, sight: Sight, framed: bool) -> bool {
        self.sight == sight && self.framed == framed
    }
}

/// The one ratio that both are, but for rounding.
fn same(known: Option<f64>, other: Option<f64>) -> Option<f64> {
    known.zip(other).and_then(|(known, other)| ((other - known).abs() <= SAME_RATIO * known).then_some(known))
}

/// What makes a row's residuals comparable.
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

    /// That of a row, which may state its own noise; `self` is that of the `usual` noise.
    #[inline(always)]
    pub(super) fn of(self, observation: &Observation, usual: Noise) -> Self {
        match (observation.sigma_position_m, observation.sigma_rotation_rad) {
            (None, None) => self,
            _ => Whitening::new(observation.noise_or(usual)),
        }
    }
}
