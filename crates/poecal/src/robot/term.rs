//! Terms of joint values: what a joint really turns or slides beyond its reading.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::offset::Offset;
use super::ratio::Ratio;
use super::term_model::TermModel;

/// A term of a joint's value, `θ ← θ + c b(θ)` with a known function b of the joint values and a coefficient c (theory.md §3). A new term is
/// one file with [`TermModel`], one variant here and its line in [`Term::ALL`].
///
/// ```
/// use poecal::robot::Term;
/// let offset = Term::Offset.model();
/// assert_eq!((offset.name(), offset.basis(0, &[0.7])), ("offset", 1.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Term {
    /// Joint offset: 1.
    Offset,
    /// Error of the gear's ratio: the joint's value.
    Ratio,
}

impl Term {
    /// All terms.
    pub const ALL: [Term; 2] = [Term::Offset, Term::Ratio];

    /// What the term is.
    #[must_use]
    pub fn model(self) -> &'static dyn TermModel {
        match self {
            Term::Offset => &Offset,
            Term::Ratio => &Ratio,
        }
    }
}

/// A term of a joint with its coefficient.
///
/// ```
/// use poecal::robot::{JointTerm, Term};
/// let late = JointTerm { joint: 1, term: Term::Offset, coefficient: 0.02 };
/// assert_eq!(JointTerm::sum(&[late], 1, &[0.0, 0.5]), 0.02);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointTerm {
    /// Index of the joint.
    pub joint: usize,
    /// The term.
    pub term: Term,
    /// Its coefficient c, in [`TermModel::unit`].
    pub coefficient: f64,
}

impl JointTerm {
    /// The sum of all terms of a joint, radians or metres, from the values of all joints without terms.
    #[must_use]
    pub fn sum(terms: &[JointTerm], joint: usize, values: &[f64]) -> f64 {
        let own = terms.iter().filter(|it| it.joint == joint);
        own.map(|it| it.coefficient * it.term.model().basis(joint, values)).sum()
    }
}
