//! `residuals.csv`.

use poecal_results::residuals::Residuals;

use crate::properties::{PATH, certain, check_result, text};

/// Residuals: read, written, read again.
pub fn residuals(data: &[u8]) -> bool {
    let Some(text) = text(data) else { return false };
    let Some(residuals) = check_result(Residuals::parse(&text, PATH), &text) else { return false };
    assert_round_trip(&residuals);
    true
}

/// Asserts that written text reads back the same.
pub(crate) fn assert_round_trip(residuals: &Residuals) {
    let written = residuals.text();
    let again = certain(Residuals::parse(&written, PATH), &written);
    assert_eq!(again.text(), written);
    // A missing number, such as an empty cell, does not equal itself, but is shown alike.
    assert!(&again == residuals || format!("{again:?}") == format!("{residuals:?}"), "{written}");
}
