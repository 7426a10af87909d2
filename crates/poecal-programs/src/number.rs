//! Numbers of a program, and where they stand.

use std::ops::Range;

/// A number as it is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// Its bytes, sign included.
    pub range: Range<usize>,
    /// Its value.
    pub value: f64,
    /// Digits behind the point.
    pub decimals: usize,
    /// What it is multiplied with to be in the unit of its target.
    pub scale: f64,
}

impl Number {
    /// The value in the unit of its target.
    pub(crate) fn scaled(&self) -> f64 {
        self.value * self.scale
    }
}
