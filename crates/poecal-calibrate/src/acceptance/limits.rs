//! Requested limits of errors.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::unit::Unit;

/// Statistic of the errors that is limited.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AcceptedStatistic {
    /// Root mean square over all configurations of which those that decide are a sample.
    #[default]
    Rms,
    /// The error that 95 % of them do not exceed.
    P95,
    /// The largest error of the rows that decide.
    Max,
}

impl AcceptedStatistic {
    /// All statistics, in the order of tables.
    pub const ALL: [AcceptedStatistic; 3] = [AcceptedStatistic::Rms, AcceptedStatistic::P95, AcceptedStatistic::Max];

    /// The word used in files and for limits.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            AcceptedStatistic::Rms => "rms",
            AcceptedStatistic::P95 => "p95",
            AcceptedStatistic::Max => "max",
        }
    }

    /// Words for people: `RMS`.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            AcceptedStatistic::Rms => "RMS",
            AcceptedStatistic::P95 => "95 %",
            AcceptedStatistic::Max => "max",
        }
    }
}

/// Which model is judged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AcceptedModel {
    /// The corrected model, with joint effects beyond geometry; the calibrated one if there is no other.
    #[default]
    Corrected,
    /// The calibrated model: geometry alone, as a URDF holds it.
    Calibrated,
}

impl AcceptedModel {
    /// The word used in files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            AcceptedModel::Corrected => "corrected",
            AcceptedModel::Calibrated => "calibrated",
        }
    }
}

/// Largest permitted error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AcceptanceLimit {
    /// Limited statistic.
    pub statistic: AcceptedStatistic,
    /// Unit: the limit is for all measured quantities of this unit.
    pub unit: Unit,
    /// Metres or radians.
    pub most: f64,
}

/// Limits, and the model that they are for.
#[derive(Clone, Debug, PartialEq)]
pub struct AcceptanceLimits {
    /// At least one; no two of one statistic and unit.
    pub limits: Vec<AcceptanceLimit>,
    /// Which model.
    pub model: AcceptedModel,
}

impl AcceptanceLimits {
    /// Limits for a model.
    ///
    /// # Errors
    /// [`ErrorKind::Option`] if there are none, or two of one statistic and unit.
    pub fn new(limits: Vec<AcceptanceLimit>, model: AcceptedModel) -> Result<Self> {
        if limits.is_empty() {
            return ErrorKind::Option
                .refuse("found no limit to accept, expected at least one, like 0.2mm or max:0.5mm");
        }
        for (k, limit) in limits.iter().enumerate() {
            let same = |other: &&AcceptanceLimit| (other.statistic, other.unit) == (limit.statistic, limit.unit);
            if let Some(other) = limits[..k].iter().find(same) {
                let [other, own] = [other, limit].map(|it| it.words());
                return ErrorKind::Option
                    .refuse(format!("found two limits of one kind, {other} and {own}, expected one of them"));
            }
        }
        Ok(AcceptanceLimits { limits, model })
    }

    /// Limits for a model that was named or not; none if there are no limits.
    ///
    /// # Errors
    /// As [`AcceptanceLimits::new`]; [`ErrorKind::Option`] also if a model was named that has no limit to keep.
    pub fn from_choice(limits: Vec<AcceptanceLimit>, model: Option<AcceptedModel>) -> Result<Option<Self>> {
        if !limits.is_empty() {
            return AcceptanceLimits::new(limits, model.unwrap_or_default()).map(Some);
        }
        let Some(model) = model else { return Ok(None) };
        ErrorKind::Option.refuse(format!(
            "found `{}` as the model that shall keep limits, but no limit, expected one, like 0.2mm or max:0.5mm",
            model.word()
        ))
    }
}

impl AcceptanceLimit {
    /// As it may be typed, to six digits: `max:0.5mm`.
    #[must_use]
    pub fn words(&self) -> String {
        let shown = self.unit.in_shown_unit(self.most);
        let shown: f64 = format!("{shown:.5e}").parse().unwrap_or(shown);
        format!("{}:{shown}{}", self.statistic.word(), self.unit.symbol())
    }
}
