//! `residuals.csv`.

use poecal_results::residuals::Residuals;

use crate::properties::{PATH, certain, text, understood};

/// Residuals: read, written, read again.
pub fn residuals(data: &[u8]) -> bool {
    let Some(text) = text(data) else { return false };
    let Some(residuals) = understood(Residuals::parse(&text, PATH), &text) else { return false };
    same(&residuals);
    true
}

/// Asserts that written text reads back the same.
pub(crate) fn same(residuals: &Residuals) {
    let written = residuals.text();
    let again = certain(Residuals::parse(&written, PATH), &written);
    assert_eq!(again.text(), written);
    // A missing number, such as an empty cell, does not equal itself, but is shown alike.
    assert!(&again == residuals || format!("{again:?}") == format!("{residuals:?}"), "{written}");
}
