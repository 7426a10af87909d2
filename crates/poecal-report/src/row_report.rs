//! A row of a session that is watched.

use std::fmt::Write as _;

use serde::Serialize;

use super::table::number;
use poecal_model::measurement::Dataset;
use poecal_model::robot::{ReadingKind, Robot};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::text::escape_invisible;
use poecal_plan::plan::{ExpectedErrors, Mistake, WatchedRow};

/// A judged row, as a line for a person or a machine.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RowReport {
    /// Number of the row, from 1.
    row: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    id: Option<String>,
    /// True if the row is as expected; null while too few rows are known.
    ok: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mistake: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sentence: Option<String>,
    /// Ratio of the row's deviation from expectation to the named quantity.
    ratio: Option<f64>,
    noticed_mm: Option<f64>,
    expected_calibrated_mm: Option<f64>,
    expected_corrected_mm: Option<f64>,
    after_10_calibrated_mm: Option<f64>,
    after_10_corrected_mm: Option<f64>,
    /// Readings of the configuration that gains most, radians and metres.
    next: Option<Vec<f64>>,
    #[serde(skip)]
    next_words: String,
}

impl RowReport {
    /// A row of some data.
    #[must_use]
    pub fn new(robot: &Robot, data: &Dataset, row: &WatchedRow) -> Self {
        let mm = |errors: Option<ExpectedErrors>, of: fn(&ExpectedErrors) -> f64| errors.map(|it| 1e3 * of(&it));
        let names = robot.reading_names();
        let words = |(name, value): (&String, &f64)| {
            let kind = robot.reading_kind(name);
            format!("{} {}", escape_invisible(name), format_reading(kind, *value))
        };
        let next_words = row
            .next
            .as_ref()
            .map(|next| names.iter().zip(next).map(words).collect::<Vec<_>>().join(", "))
            .unwrap_or_default();
        let judged = row.ratio.is_some() || row.mistake.is_some();
        RowReport {
            row: row.row + 1,
            id: data.ids.get(row.row).filter(|id| !id.is_empty()).map(|id| escape_invisible(id).into_owned()),
            ok: judged.then_some(row.mistake.is_none()),
            mistake: row.mistake.as_ref().map(word),
            sentence: row.mistake.as_ref().map(|mistake| sentence(robot, mistake)),
            ratio: row.ratio,
            noticed_mm: row.noticed_m.map(|it| 1e3 * it),
            expected_calibrated_mm: mm(row.now, ExpectedErrors::calibrated_m),
            expected_corrected_mm: mm(row.now, ExpectedErrors::corrected_m),
            after_10_calibrated_mm: mm(row.after, ExpectedErrors::calibrated_m),
            after_10_corrected_mm: mm(row.after, ExpectedErrors::corrected_m),
            next: row.next.clone(),
            next_words,
        }
    }

    /// As a line of JSON.
    ///
    /// # Errors
    /// [`ErrorKind::Export`] if it cannot be written as JSON.
    pub fn json(&self) -> Result<String> {
        let line = serde_json::to_string(self);
        line.map(|line| line + "\n").map_err(|error| {
            ErrorKind::Export.error(format!("found a row that is no JSON ({error}), expected numbers"))
        })
    }

    /// Comparison of the row with the expectation, in a sentence.
    #[must_use]
    pub fn answer(&self) -> String {
        let named = self.id.as_ref().map_or_else(String::new, |id| format!(" ({id})"));
        let mut out = format!("row {}{named}: ", self.row);
        out.push_str(match (&self.sentence, self.ok) {
            (Some(sentence), _) => sentence,
            (None, Some(_)) => "as expected",
            (None, None) => "too few rows to judge by",
        });
        // Writing to a String cannot fail.
        if let Some(noticed) = self.noticed_mm {
            let _ = write!(out, "; {} mm would be noticed", number(noticed));
        }
        out
    }

    /// As lines of text.
    #[must_use]
    pub fn text(&self) -> String {
        let mut out = self.answer();
        if let (Some(calibrated), Some(corrected)) = (self.expected_calibrated_mm, self.expected_corrected_mm) {
            let _ = write!(
                out,
                "\n  expected now {} mm calibrated, {} mm corrected",
                number(calibrated),
                number(corrected)
            );
        }
        if let (Some(calibrated), Some(corrected)) = (self.after_10_calibrated_mm, self.after_10_corrected_mm) {
            let _ = write!(out, "; 10 more would leave {} and {} mm", number(calibrated), number(corrected));
        }
        if !self.next_words.is_empty() {
            let _ = write!(out, "\n  next best: {}", self.next_words);
        }
        out.push('\n');
        out
    }
}

/// A reading as people read it.
fn format_reading(kind: ReadingKind, value: f64) -> String {
    match kind {
        ReadingKind::Angle | ReadingKind::Length => {
            format!("{:.2} {}", kind.in_shown_unit(value), kind.symbol())
        }
        ReadingKind::Factor => format!("{value}"),
    }
}

/// A mistake as a word.
fn word(mistake: &Mistake) -> &'static str {
    match mistake {
        Mistake::Stale => "stale",
        Mistake::Sign(_) => "sign",
        Mistake::Joint(..) => "joint",
        Mistake::Off(_) => "off",
        Mistake::Repeats => "repeats",
        Mistake::Moved(..) => "moved",
    }
}

/// A mistake in a sentence.
fn sentence(robot: &Robot, mistake: &Mistake) -> String {
    match mistake {
        Mistake::Stale => "WRONG: it is the measurement of the configuration before, measure it again".to_owned(),
        Mistake::Sign(joint) => format!("WRONG: {} has the other sign", escape_invisible(joint)),
        Mistake::Joint(joint, by) => {
            let by = format_reading(robot.reading_kind(joint), *by);
            format!("WRONG: as if {} were {by} further than it was read", escape_invisible(joint))
        }
        Mistake::Off(off_m) => {
            format!("WRONG: the measurement is {} mm off, measure it again", number(1e3 * off_m))
        }
        Mistake::Repeats => "WRONG: it repeats the row before, number by number".to_owned(),
        Mistake::Moved(off_m, ago) => {
            format!(
                "WRONG: the target moved by about {} mm before the last {ago} rows, fasten it and measure these again",
                number(1e3 * off_m)
            )
        }
    }
}
