//! Verdict: a level with its reasons, the expected errors, and the gain over the nominal model.

use serde::{Deserialize, Serialize};

use crate::AcceptedModel;

/// Level of a verdict: the permitted use of the delivered model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// No use: the input, the fit, or both are wrong.
    #[default]
    DoNotUse,
    /// Location of targets and devices: the axes of the joints were held.
    Located,
    /// Use in configurations like those that were measured.
    MeasuredConfigurations,
    /// Use anywhere inside the sampled range of each joint.
    InsideSampledRange,
    /// Use anywhere within the limits.
    Good,
}

impl Level {
    /// All levels, from the worst to the best, with their words in files and on the command line, and for people.
    pub const TABLE: [(Level, &'static str, &'static str); 5] = [
        (Level::DoNotUse, "do_not_use", "do not use"),
        (Level::Located, "located", "located"),
        (Level::MeasuredConfigurations, "measured_configurations", "use in configurations like those measured"),
        (Level::InsideSampledRange, "inside_sampled_range", "use inside the sampled range"),
        (Level::Good, "good", "good"),
    ];

    /// Message for users.
    #[must_use]
    pub fn words(self) -> &'static str {
        Self::TABLE[self as usize].2
    }

    /// The stable word used in files and on the command line.
    #[must_use]
    pub fn word(self) -> &'static str {
        Self::TABLE[self as usize].1
    }
}

/// Decision whether the delivered model predicts better than the nominal model: anywhere inside the sampled range, or on rows that judge it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Gain {
    /// The 95 % interval of the gain is above zero.
    Clear,
    /// The interval contains zero.
    Unclear,
    /// The interval is below zero.
    Loss,
}

impl Gain {
    /// All gains, with their words in files and on the command line.
    pub const TABLE: [(Gain, &'static str); 3] =
        [(Gain::Clear, "clear"), (Gain::Unclear, "unclear"), (Gain::Loss, "loss")];

    /// The stable word used in files.
    #[must_use]
    pub fn word(self) -> &'static str {
        Self::TABLE[self as usize].1
    }

    /// Gain by the ends of an interval.
    pub(crate) fn of_interval([least, most]: [f64; 2]) -> Self {
        if least > 0.0 {
            Gain::Clear
        } else if most < 0.0 {
            Gain::Loss
        } else {
            Gain::Unclear
        }
    }
}

/// A level, and the reasons against a better one; for the best level, the reasons for it. It includes the expected errors of the delivered model.
///
/// ```
/// use poecal_calibrate::{Level, Verdict};
/// let reasons = vec!["joint2 was moved through 27 % of its range".into()];
/// let verdict = Verdict { level: Level::InsideSampledRange, reasons, ..Verdict::default() };
/// assert!(verdict.level < Level::Good);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Verdict {
    /// Permitted use.
    pub level: Level,
    /// Sentences with the deciding figures.
    pub reasons: Vec<String>,
    /// The delivered model: the corrected one if it has terms. Missing in older files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<AcceptedModel>,
    /// Expected error of its predictions in configurations like those that were measured, millimetres (RMS); absent if no use is advised, or nothing
    /// is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expected_error_mm: Option<f64>,
    /// Mean of the distances that 95 % of its errors do not exceed there, millimetres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bound95_mm: Option<f64>,
    /// Expected error of its predictions anywhere inside the sampled range of each joint, millimetres (RMS); absent if no use is advised, and in
    /// older files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sampled_range_error_mm: Option<f64>,
    /// Distance of the nominal model's predictions from its own there, with targets and devices fitted, millimetres (RMS).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nominal_error_mm: Option<f64>,
    /// Decision whether it predicts better than the nominal model there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain: Option<Gain>,
    /// Statement that the axes of the nominal model are confirmed, with its figures: the fitted ones are the same within their uncertainty.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub confirmed: Option<String>,
}

#[cfg(test)]
mod tests {
    use super::{Gain, Level};

    #[test]
    fn the_tables_are_in_the_order_of_the_levels() {
        for (k, (level, word, _)) in Level::TABLE.into_iter().enumerate() {
            assert_eq!((level as usize, level.word()), (k, word));
        }
        for (k, (gain, word)) in Gain::TABLE.into_iter().enumerate() {
            assert_eq!((gain as usize, gain.word()), (k, word));
        }
        assert!(Level::TABLE.is_sorted_by_key(|(level, ..)| level));
    }
}
