//! Columns of files in which a measurement has its numbers.

use super::Measurement;

/// A form of a measurement in files. Standard deviations are in columns `sigma_` and the name of a quantity.
pub struct Columns {
    /// Columns of its numbers, in the unit of the function's first quantity.
    pub numbers: &'static [&'static str],
    /// Columns that name the place from which it is measured; two of them together.
    pub places: &'static [&'static str],
    /// Column of a word that tells forms apart, with the word of this one.
    pub word: Option<(&'static str, &'static str)>,
    /// Where its numbers come from.
    pub from: From,
    /// The measurement from its numbers, metres and radians; zero where none is in the row.
    pub of: fn(&[f64]) -> Measurement,
    /// The numbers of a measurement in this form, `None` where it has another one; a number that is zero need not be written where names alone
    /// make a row.
    pub numbers_of: fn(&Measurement) -> Option<Vec<f64>>,
}

/// What makes a row one of a form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum From {
    /// Its numbers, all of them; where they are above 0, zero is a lost beam.
    Numbers {
        /// Whether they are.
        above_zero: bool,
    },
    /// The name of its place, in a row without a position; its numbers, if there are any, else zero. A size is above 0.
    Name {
        /// Whether its number is one.
        size: bool,
    },
}
