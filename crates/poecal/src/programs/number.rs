//! Numbers of a program, and where they stand.

use std::ops::Range;

/// A number as it is written.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Number {
    /// Its bytes, sign included.
    pub(crate) range: Range<usize>,
    /// Its value.
    pub(crate) value: f64,
    /// Digits behind the point.
    pub(crate) decimals: usize,
    /// What it is multiplied with to be in the unit of its target.
    pub(crate) scale: f64,
}

impl Number {
    /// The value in the unit of its target.
    pub(crate) fn scaled(&self) -> f64 {
        self.value * self.scale
    }
}
