//! Terms of joint values: what a joint really turns or slides beyond its reading.

use serde::{Deserialize, Serialize};

use super::JointKind;
use crate::unit::Unit;

/// A term of a joint's value, `θ ← θ + c b(θ)` with a known function b of the joint values and a coefficient c (theory.md §3).
///
/// ```
/// use poecal::robot::Term;
/// assert_eq!((Term::Offset.name(), Term::Offset.basis(0, &[0.7])), ("offset", 1.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Term {
    /// Joint offset: 1.
    Offset,
}

impl Term {
    /// All terms.
    pub const ALL: [Term; 1] = [Term::Offset];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Term::Offset => "offset",
        }
    }

    /// Unit of its coefficient.
    #[must_use]
    pub fn unit(self, kind: JointKind) -> Unit {
        match (self, kind) {
            (Term::Offset, JointKind::Revolute) => Unit::Radian,
            (Term::Offset, JointKind::Prismatic) => Unit::Metre,
        }
    }

    /// The function b of a joint, from the values of all joints without terms, radians or metres.
    #[must_use]
    pub fn basis(self, _joint: usize, _values: &[f64]) -> f64 {
        match self {
            Term::Offset => 1.0,
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
    /// Its coefficient c, in [`Term::unit`].
    pub coefficient: f64,
}

impl JointTerm {
    /// The sum of all terms of a joint, radians or metres, from the values of all joints without terms.
    #[must_use]
    pub fn sum(terms: &[JointTerm], joint: usize, values: &[f64]) -> f64 {
        let own = terms.iter().filter(|it| it.joint == joint);
        own.map(|it| it.coefficient * it.term.basis(joint, values)).sum()
    }
}
