//! Acceptance in words, the same for terminal and page.

use super::table::{line, number};
use poecal_calibrate::{Acceptance, AcceptedLimit, AcceptedModel};

/// The decision and each limit, as labelled lines of a table.
pub(crate) fn lines(out: &mut String, acceptance: &Acceptance) {
    let decision = acceptance.decision.words();
    line(out, "acceptance", &format!("{decision}: the {} model, by {}", model(acceptance), acceptance.by.words()));
    for limit in &acceptance.limits {
        line(out, "", &format!("{}: {}", limit.decision.words(), words(limit)));
    }
}

/// Name of the judged model.
pub(crate) fn model(acceptance: &Acceptance) -> &'static str {
    match acceptance.model {
        AcceptedModel::Corrected => "corrected",
        AcceptedModel::Calibrated => "calibrated",
    }
}

/// `position RMS 0.0871 mm, with 95 % confidence at most 0.1033 mm, limit 0.2 mm (30 rows)`.
fn words(limit: &AcceptedLimit) -> String {
    let unit = &limit.unit;
    format!(
        "{} {} {} {unit}, {}; the limit is {} {unit} ({})",
        limit.quantity,
        limit.statistic.words(),
        number(limit.found),
        bounds(limit),
        format_limit(limit.limit),
        counts(limit)
    )
}

/// Its 95 % confidence bounds in words.
pub(crate) fn bounds(limit: &AcceptedLimit) -> String {
    let unit = &limit.unit;
    match limit.to {
        Some(to) if limit.from == 0.0 => {
            format!("at most {} {unit} with 95 % confidence", number(to))
        }
        Some(to) => {
            format!("between {} and {} {unit} with 95 % confidence each", number(limit.from), number(to))
        }
        None => format!("at least {} {unit}, and too few rows for an upper bound", number(limit.from)),
    }
}

/// Number of rows, and of configurations if these are fewer.
pub(crate) fn counts(limit: &AcceptedLimit) -> String {
    let rows = if limit.rows == 1 { "1 row".to_owned() } else { format!("{} rows", limit.rows) };
    if limit.configurations == limit.rows {
        return rows;
    }
    format!("{rows} in {} configurations", limit.configurations)
}

/// A limit as it was typed, without rounding noise.
pub(crate) fn format_limit(limit: f64) -> String {
    let text = format!("{limit:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text.trim_matches(['0', '.']).is_empty() { format!("{limit:e}") } else { text.to_owned() }
}
