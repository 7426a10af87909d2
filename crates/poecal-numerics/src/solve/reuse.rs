//! Policy for iterations with the `JᵀJ` of an earlier state (theory.md §6, *Few passes*).
//!
//! Building `JᵀJ` is most of the work of an evaluation, and close to the optimum it hardly changes. `JᵀJ` is *frozen* while the search
//! continues with residuals and gradients of new states alone. The gradient is exact, so that a frozen `JᵀJ` changes the rate of
//! convergence, but not the limit. Steps with a frozen `JᵀJ` are undamped.

use crate::linalg::Factor;

/// Largest predicted reduction of a step, as a share of the cost, for its end to lie close to the optimum: so short a step hardly
/// changes `JᵀJ`.
const CLOSE: f64 = 5e-2;

/// Largest ratio of a step's predicted reduction to that of the step before for fast convergence.
const FAST: f64 = 1e-2;

/// Smallest pivot of a well-conditioned `JᵀJ`, as a share of its largest diagonal element. Unknowns with a thousand times the standard
/// deviation of others depend on changes of `JᵀJ` with small steps. An example is a tool on the last axis.
const WELL_CONDITIONED: f64 = 1e-6;

/// Share of the stopping threshold that the predicted reduction of the step after a final one stays below.
const FINAL: f64 = 1e-2;

/// True if a step's predicted reduction is so much smaller than that of the step before that a frozen `JᵀJ` suffices.
pub(crate) fn converges_fast(predicted: f64, before: f64) -> bool {
    predicted < FAST * before
}

/// True if no step will be needed after this one. With fast convergence, reductions fall by about the same ratio again. If the next
/// one is far below the `threshold` that ends the search, this step is the final one, and its cost need not be evaluated.
pub(crate) fn is_final_step(predicted: f64, before: f64, threshold: f64) -> bool {
    let ratio = predicted / before;
    before.is_finite() && ratio < FAST && ratio * predicted < FINAL * threshold
}

/// State of the reuse policy during one search.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reuse {
    is_enabled: bool,
    /// True if the search has the `JᵀJ` of an earlier state.
    is_frozen: bool,
    /// Predicted reduction of the last accepted step; infinite before the first one.
    last_reduction: f64,
    /// True if the search seems to end at residuals that the model does not explain. Without noise there are none: the cost falls towards
    /// zero, and each step goes as far as its `JᵀJ` is right.
    has_noise: bool,
}

impl Reuse {
    /// A policy that freezes nothing unless it is enabled.
    pub(crate) fn new(is_enabled: bool) -> Self {
        Reuse { is_enabled, is_frozen: false, last_reduction: f64::INFINITY, has_noise: true }
    }

    /// True if no direction is so weak that `JᵀJ` along it would change with a small step; `scale` is its largest diagonal element.
    pub(crate) fn is_well_conditioned(factor: &Factor, scale: f64) -> bool {
        factor.smallest_pivot() > WELL_CONDITIONED * scale
    }

    /// True if the search has the `JᵀJ` of an earlier state.
    pub(crate) fn is_frozen(&self) -> bool {
        self.is_frozen
    }

    /// True if the end of a step is to be evaluated without `JᵀJ`, which stays frozen or is frozen from there on. Steps then converge
    /// so fast that `JᵀJ` can hardly have changed, or this step from a state with its own `JᵀJ` is short.
    pub(crate) fn may_freeze(&self, predicted: f64, cost: f64, is_well_conditioned: impl FnOnce() -> bool) -> bool {
        let is_short = !self.is_frozen && predicted < CLOSE * cost;
        let is_fast =
            self.has_noise && self.last_reduction.is_finite() && converges_fast(predicted, self.last_reduction);
        self.is_enabled && (is_short || is_fast && (self.is_frozen || is_well_conditioned()))
    }

    /// True if a new `JᵀJ` must be built before the next step, by its predicted reduction (`None` if there is no step): the step is not
    /// short.
    pub(crate) fn must_rebuild(&mut self, predicted: Option<f64>, cost: f64) -> bool {
        let must = self.is_frozen && predicted.is_none_or(|predicted| predicted > CLOSE * cost);
        self.has_noise &= !must;
        must
    }

    /// True if a step with a frozen `JᵀJ` is the [final one](is_final_step).
    pub(crate) fn is_final_step(&self, predicted: f64, threshold: f64) -> bool {
        self.is_frozen && is_final_step(predicted, self.last_reduction, threshold)
    }

    /// Records an accepted step; its end was evaluated without `JᵀJ` if `is_frozen`.
    pub(crate) fn note_accepted(&mut self, predicted: f64, is_frozen: bool) {
        self.last_reduction = predicted;
        self.is_frozen = is_frozen;
    }

    /// Records a `JᵀJ` that was built for the current state.
    pub(crate) fn note_rebuilt(&mut self) {
        self.is_frozen = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_step_freezes_and_a_long_one_rebuilds() {
        let mut reuse = Reuse::new(true);
        assert!(!reuse.may_freeze(0.9, 1.0, || true), "the first long step");
        assert!(reuse.may_freeze(0.01, 1.0, || false), "a short step");
        reuse.note_accepted(0.01, true);
        assert!(reuse.is_frozen());
        assert!(!reuse.must_rebuild(Some(1e-3), 1.0));
        assert!(reuse.must_rebuild(Some(0.5), 1.0) && reuse.must_rebuild(None, 1.0));
        reuse.note_rebuilt();
        assert!(!reuse.is_frozen() && !reuse.must_rebuild(Some(0.5), 1.0));
    }

    #[test]
    fn fast_convergence_freezes_only_where_jtj_is_well_conditioned() {
        let mut reuse = Reuse::new(true);
        reuse.note_accepted(100.0, false);
        assert!(reuse.may_freeze(0.5, 1.0, || true));
        assert!(!reuse.may_freeze(0.5, 1.0, || false));
        reuse.note_accepted(0.5, true);
        assert!(reuse.may_freeze(1e-3, 1.0, || false), "frozen before");
        assert!(!reuse.may_freeze(1e-2, 1.0, || true), "slow");
    }

    #[test]
    fn a_step_is_final_if_the_one_after_would_be_far_below_the_threshold() {
        let mut reuse = Reuse::new(true);
        reuse.note_accepted(1.0, true);
        // The predicted reduction of the step after is 1e-3 · 1e-3.
        assert!(reuse.is_final_step(1e-3, 1.1e-4));
        assert!(!reuse.is_final_step(1e-3, 0.9e-4));
        reuse.note_rebuilt();
        assert!(!reuse.is_final_step(1e-3, 1.0), "not frozen");
    }

    #[test]
    fn switched_off_nothing_is_frozen() {
        let reuse = Reuse::new(false);
        assert!(!reuse.may_freeze(1e-6, 1.0, || true));
    }
}
