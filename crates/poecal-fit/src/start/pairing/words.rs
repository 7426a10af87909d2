//! Lengths and lines in words.

use poecal_numerics::error::first_few;

/// A length in words.
#[must_use]
pub fn mm(metres: f64) -> String {
    format!("{:.3} mm", 1e3 * metres)
}

/// Lines in words.
#[must_use]
pub fn number_lines(lines: &[String]) -> String {
    numbered_as("line", lines)
}

/// The same lines as rows of a sheet.
#[must_use]
pub fn numbered_as(word: &str, lines: &[String]) -> String {
    format!("{word}{} {}", if lines.len() == 1 { "" } else { "s" }, first_few(lines))
}
