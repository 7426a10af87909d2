//! Reasons of the end of a minimisation.

/// Reason of the end of a minimisation: data, not an error string.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_numerics::solve;
/// # }
/// use poecal::solve::Termination;
/// assert!(Termination::Optimum.is_success() && !Termination::IterationLimit.is_success());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Termination {
    /// The undamped step would lower the cost by less than [`super::Options::decrement`] times the mean squared residual: the
    /// estimate is at the optimum, within the noise.
    Optimum,
    /// The undamped step is shorter than [`super::Options::step`]: the residual is rounding error (noise-free data).
    StepVanished,
    /// No step lowers the cost although one should: at rounding level.
    NoProgress,
    /// The limit of iterations was reached before.
    IterationLimit,
    /// The residuals are not finite numbers.
    NotFinite,
}

impl Termination {
    /// True if the result is an optimum.
    #[must_use]
    pub fn is_success(self) -> bool {
        matches!(self, Termination::Optimum | Termination::StepVanished | Termination::NoProgress)
    }

    /// Stable word used in files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Termination::Optimum => "optimum",
            Termination::StepVanished => "step_vanished",
            Termination::NoProgress => "no_progress",
            Termination::IterationLimit => "iteration_limit",
            Termination::NotFinite => "not_finite",
        }
    }
}
