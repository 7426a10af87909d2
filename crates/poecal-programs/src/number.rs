//! Numbers of a program, and their positions in the text.

use std::ops::Range;

/// A number in a text.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// Its bytes, sign included.
    pub range: Range<usize>,
    /// Its value.
    pub value: f64,
    /// Number of decimals.
    pub decimals: usize,
    /// Factor that converts it to the unit of its target.
    pub scale: f64,
}

impl Number {
    /// The value in the unit of its target.
    pub(crate) fn scaled_value(&self) -> f64 {
        self.value * self.scale
    }
}
