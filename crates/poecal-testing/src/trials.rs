//! Number of trials of a test as a part of its weekly number, by `POECAL_TRIALS`: unset, a twelfth; `quick`, a twentieth; `weekly`, all; `full`, a
//! hundred times as many; or a number.

/// A number of trials, from which follows the additional tolerance of their figures relative to the weekly number.
#[derive(Clone, Copy, Debug)]
pub struct Trials {
    /// The number.
    pub count: usize,
    weekly: usize,
}

/// The fewest meaningful trials.
const FEWEST: usize = 2;
/// Part of the weekly number for every change. The scatter of a mean is 3.5 times as large, and its tolerance grows by three of the added standard
/// errors ([`Trials::tolerance_factor`]): a fault shows if it is 3.5 times as large as the smallest that the weekly number shows.
const OF_A_CHANGE: usize = 12;
/// The same part for `quick`.
const OF_A_QUICK_LOOK: usize = 20;

/// Number of trials by `POECAL_TRIALS` and the weekly number.
pub fn trials(weekly: usize) -> Trials {
    let said = std::env::var("POECAL_TRIALS").ok();
    let part = |of: usize| (weekly / of).max(FEWEST).min(weekly);
    let count = match said.as_deref() {
        None | Some("") => part(OF_A_CHANGE),
        Some("quick") => part(OF_A_QUICK_LOOK),
        Some("weekly") => weekly,
        Some("full") => 100 * weekly,
        Some(number) => number.parse().ok().filter(|&count| count > 0).unwrap_or_else(|| {
            panic!("POECAL_TRIALS: found `{number}`, expected `quick`, `weekly`, `full`, or a number from 1")
        }),
    };
    Trials { count, weekly }
}

/// Selection of independent cases that are no trials: all, or with `quick` every fifth.
pub fn choose_some<T>(all: impl IntoIterator<Item = T>) -> Vec<T> {
    let is_quick = std::env::var("POECAL_TRIALS").is_ok_and(|said| said == "quick");
    all.into_iter().step_by(if is_quick { 5 } else { 1 }).collect()
}

impl Trials {
    /// At least this number of trials, unless the weekly number is below it.
    pub fn at_least(self, fewest: usize) -> Self {
        Trials { count: self.count.max(fewest.min(self.weekly)), ..self }
    }

    /// Numbers of the trials, as seeds are.
    pub fn seeds(self) -> std::ops::Range<u64> {
        0..self.count as u64
    }

    /// Increase of the tolerance of a mean over the trials: three standard errors, less those of the weekly number. Zero for the weekly number and
    /// more. `sigma` is the standard deviation of one trial.
    pub fn tolerance_factor(self, sigma: f64) -> f64 {
        let root = |count: usize| (count as f64).sqrt();
        3.0 * sigma * (1.0 / root(self.count) - 1.0 / root(self.weekly)).max(0.0)
    }

    /// Increase of the tolerance of a share of the trials.
    pub fn more_of_a_share(self, share: f64) -> f64 {
        self.tolerance_factor((share * (1.0 - share)).sqrt())
    }
}
