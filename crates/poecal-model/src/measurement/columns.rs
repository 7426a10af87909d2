//! Columns of files for the numbers of a measurement.

use super::Measurement;

/// A form of a measurement in files. Standard deviations are in columns `sigma_` and the name of a quantity.
pub struct MeasurementColumns {
    /// Columns of its numbers, in the unit of the function's first quantity.
    pub numbers: &'static [&'static str],
    /// Columns that name the station of the measurement; two of them together.
    pub places: &'static [&'static str],
    /// Column of a word that distinguishes forms, with the word of this one.
    pub word: Option<(&'static str, &'static str)>,
    /// Source of its numbers.
    pub from: FormCriterion,
    /// Measurement from its numbers, metres and radians; zero if none is in the row.
    pub of: fn(&[f64]) -> Measurement,
    /// Numbers of a measurement in this form, `None` if it has another one; a number that is zero may be omitted if names alone define a row.
    pub numbers_of: fn(&Measurement) -> Option<Vec<f64>>,
}

/// Condition of a row of a form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FormCriterion {
    /// All of its numbers are there; if they are above 0, zero is a beam break.
    Numbers {
        /// True if they are.
        above_zero: bool,
    },
    /// The name of its station is there, in a row without a position; its numbers, if there are any, else zero. A size is above 0.
    Name {
        /// True if its number is a size.
        size: bool,
    },
}
