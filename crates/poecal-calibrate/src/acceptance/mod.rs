//! Decision whether a calibration keeps agreed limits, with the confidence that the rows support: theory.md §9, *Acceptance*.

mod bounds;
mod limits;

pub(crate) use bounds::{BoundedStatistic, ConfigurationErrors, MeasuredError, mean_square};
pub use limits::{AcceptanceLimit, AcceptanceLimits, AcceptedModel, AcceptedStatistic};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use poecal_model::measurement::Quantity;

/// Decision on a limit by measurements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Decision {
    /// The limit is kept: so is the upper bound.
    Pass,
    /// Neither is shown: the limit lies between the bounds.
    NotShown,
    /// The limit is exceeded: so it is by the lower bound.
    Fail,
}

impl Decision {
    /// Words for people.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Decision::Pass => "PASS",
            Decision::NotShown => "NOT SHOWN",
            Decision::Fail => "FAIL",
        }
    }

    /// The word used in files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Decision::Pass => "pass",
            Decision::NotShown => "not_shown",
            Decision::Fail => "fail",
        }
    }

    /// Decision by a limit and the bounds of its statistic; without an upper bound nothing passes.
    #[must_use]
    pub fn from_bounds(limit: f64, from: f64, to: Option<f64>) -> Self {
        if to.is_some_and(|to| to <= limit) {
            Decision::Pass
        } else if from > limit {
            Decision::Fail
        } else {
            Decision::NotShown
        }
    }
}

/// Rows that decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AcceptedRows {
    /// Rows that were held out.
    HeldOut,
    /// The fitted rows, each predicted by a fit without it, since none was held out.
    CrossValidation,
    /// Measurements that judge the calibration.
    Judged,
}

impl AcceptedRows {
    /// Words for people: `rows held out`.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            AcceptedRows::HeldOut => "rows held out",
            AcceptedRows::CrossValidation => "fitted rows, each predicted by a fit without it",
            AcceptedRows::Judged => "rows measured to judge it",
        }
    }
}

/// Limit, observed figure and decision. Numbers are in millimetres or degrees.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AcceptedLimit {
    /// The measured quantity: `position`, `rotation` and so on.
    pub quantity: String,
    /// Unit of the numbers: `mm` or `deg`.
    pub unit: String,
    /// Limited statistic of the errors.
    pub statistic: AcceptedStatistic,
    /// The limit.
    pub limit: f64,
    /// Figure observed on the rows.
    pub found: f64,
    /// Lower bound, with 95 % confidence.
    pub from: f64,
    /// Upper bound, with 95 % confidence; null if the rows are too few for one.
    pub to: Option<f64>,
    /// Decision by these bounds.
    pub decision: Decision,
    /// Number of rows that measured the quantity.
    pub rows: usize,
    /// Number of different configurations among them; these count as independent.
    pub configurations: usize,
}

/// Decision whether a calibration keeps the requested limits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Acceptance {
    /// The worst decision of all limits.
    pub decision: Decision,
    /// Judged model.
    pub model: AcceptedModel,
    /// Rows that decided.
    pub by: AcceptedRows,
    /// Each limit, by quantity.
    pub limits: Vec<AcceptedLimit>,
}

impl Acceptance {
    /// Acceptance by decided limits; at least one.
    pub(crate) fn new(model: AcceptedModel, by: AcceptedRows, limits: Vec<AcceptedLimit>) -> Self {
        let decision = limits.iter().map(|it| it.decision).max().unwrap_or(Decision::NotShown);
        Acceptance { decision, model, by, limits }
    }
}

impl AcceptedLimit {
    /// A decided limit; numbers in metres or radians.
    pub(crate) fn from_finding(
        limit: &AcceptanceLimit,
        quantity: Quantity,
        found: BoundedStatistic,
        counts: [usize; 2],
    ) -> Self {
        let unit = quantity.unit();
        let [limit_shown, value, from] = [limit.most, found.found, found.from].map(|it| unit.in_shown_unit(it));
        let to = found.to.map(|it| unit.in_shown_unit(it));
        AcceptedLimit {
            quantity: quantity.name().to_owned(),
            unit: unit.symbol().to_owned(),
            statistic: limit.statistic,
            limit: limit_shown,
            found: value,
            from,
            to,
            decision: Decision::from_bounds(limit.most, found.from, found.to),
            rows: counts[0],
            configurations: counts[1],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Decision;

    #[test]
    fn a_limit_is_kept_above_the_bounds_and_exceeded_below() {
        assert_eq!(Decision::from_bounds(0.2, 0.08, Some(0.11)), Decision::Pass);
        assert_eq!(Decision::from_bounds(0.1, 0.08, Some(0.11)), Decision::NotShown);
        assert_eq!(Decision::from_bounds(0.07, 0.08, None), Decision::Fail);
    }
}
