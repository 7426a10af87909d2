//! Many fits of one problem: other measurements in the same configurations.

use super::Problem;
use crate::estimate::Estimate;
use crate::measurement::Measurement;
use crate::solve::{LeastSquares, Normal, Options, Summary, WarmStart, minimize_warm};
use crate::threads;

/// Fits that one thread makes in turn, with one copy of the problem.
const TOGETHER: usize = 25;

/// A problem at its optimum, for repeated fits to other measurements in the same configurations (Monte Carlo, bootstrap). All fits share
/// the packed rows and the factorised `JᵀJ` of the first optimum, so that most of them need residuals and gradients alone. A fit that
/// does not converge fast computes `JᵀJ` as usual, and reaches the same optimum (theory.md §6, *Few passes*).
#[derive(Clone, Debug)]
pub struct Refit<'a> {
    problem: Problem<'a>,
    start: WarmStart<Estimate>,
    options: Options,
}

impl<'a> Refit<'a> {
    /// Prepares fits of a problem, from its optimum or a state close by.
    #[must_use]
    pub fn new(problem: Problem<'a>, optimum: Estimate, options: Options) -> Self {
        let normal = problem.normal(&optimum);
        Refit { problem, start: WarmStart::new(optimum, normal), options }
    }

    /// Fits other measurements, one for each row of the data and of the same kind. The returned `JᵀJ` may be frozen, as in
    /// [`crate::solve::minimize`].
    pub fn fit(&mut self, measured: &[Measurement]) -> (Estimate, Normal, Summary) {
        self.problem.set_measurements(measured);
        minimize_warm(&self.problem, &self.start, &self.options)
    }

    /// [`Refit::fit`] of each trial by all threads; returns what `kept` extracts from each, in the order of the trials.
    pub fn fit_all<T: Send>(
        &self,
        trials: &[Vec<Measurement>],
        kept: impl Fn(Estimate, Normal, Summary) -> T + Sync,
    ) -> Vec<T> {
        threads::concat_chunks(trials, TOGETHER, |_, trials| {
            let mut refit = self.clone();
            let fit = |measured: &Vec<Measurement>| {
                let (estimate, normal, summary) = refit.fit(measured);
                kept(estimate, normal, summary)
            };
            trials.iter().map(fit).collect()
        })
    }
}
