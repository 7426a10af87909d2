//! Terms of joint values: what a joint really turns or slides beyond its reading.

use std::borrow::Cow;
use std::fmt;
use std::str::FromStr;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::coupling::Coupling;
use super::factor::Factor;
use super::harmonic::Harmonic;
use super::offset::Offset;
use super::own_weight::OwnWeight;
use super::payload::Payload;
use super::ratio::Ratio;
use super::sag::Sag;
use super::term_model::TermModel;

/// A term of a joint's value, `θ ← θ + c b(q)` with a known function b of the configuration and a coefficient c (theory.md §3). A new term is
/// one file with [`TermModel`], one variant here and its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Term {
    /// Joint offset: 1.
    Offset,
    /// Error of the gear's ratio: the joint's value.
    Ratio,
    /// A harmonic of the joint's value.
    Harmonic(Harmonic),
    /// What the joint gives under the robot's own weight.
    OwnWeight,
    /// What the joint gives under a weight.
    Sag(Sag),
    /// What another joint turns it.
    Coupling(Coupling),
    /// What it owes to a factor.
    Factor(Factor),
    /// What it gives under a payload.
    Payload(Payload),
}

impl Term {
    /// Terms that need nothing but a joint's value, and that a model may state.
    pub const ALL: [Term; 2] = [Term::Offset, Term::Ratio];

    /// Whether its function is of the weights that the robot carries.
    #[must_use]
    pub fn needs_gravity(&self) -> bool {
        match self {
            Term::OwnWeight | Term::Sag(_) | Term::Payload(_) => true,
            Term::Offset | Term::Ratio | Term::Harmonic(_) | Term::Coupling(_) | Term::Factor(_) => false,
        }
    }

    /// Whether it can be of a robot with so many joints and factors.
    #[must_use]
    pub fn is_of(&self, joints: usize, factors: usize) -> bool {
        match self {
            Term::Coupling(Coupling { joint }) => *joint < joints,
            Term::Factor(Factor { index }) | Term::Payload(Payload { index }) => *index < factors,
            Term::Offset | Term::Ratio | Term::Harmonic(_) | Term::OwnWeight | Term::Sag(_) => true,
        }
    }

    /// The same term where joints have other indices.
    #[must_use]
    pub fn moved(self, index: impl Fn(usize) -> usize) -> Self {
        match self {
            Term::Coupling(Coupling { joint }) => Term::Coupling(Coupling { joint: index(joint) }),
            Term::Offset
            | Term::Ratio
            | Term::Harmonic(_)
            | Term::OwnWeight
            | Term::Sag(_)
            | Term::Factor(_)
            | Term::Payload(_) => self,
        }
    }

    /// What the term is.
    #[must_use]
    pub fn model(&self) -> &dyn TermModel {
        match self {
            Term::Offset => &Offset,
            Term::Ratio => &Ratio,
            Term::Harmonic(harmonic) => harmonic,
            Term::OwnWeight => &OwnWeight,
            Term::Sag(sag) => sag,
            Term::Coupling(coupling) => coupling,
            Term::Factor(factor) => factor,
            Term::Payload(payload) => payload,
        }
    }
}

impl fmt::Display for Term {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.model().name())
    }
}

impl FromStr for Term {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let numbered = |prefix: &str| name.strip_prefix(prefix)?.parse::<u16>().ok().filter(|it| *it > 0);
        let order = |prefix: &str| u8::try_from(numbered(prefix)?).ok();
        let harmonic = |order: u8, cosine: bool| Term::Harmonic(Harmonic { order, cosine });
        let found = Term::ALL.into_iter().find(|term| term.model().name() == name);
        let found = found.or_else(|| (name == "masses").then_some(Term::OwnWeight));
        found
            .or_else(|| Some(harmonic(order("sin")?, false)))
            .or_else(|| Some(harmonic(order("cos")?, true)))
            .or_else(|| Some(Term::Sag(Sag { weight: usize::from(numbered("sag")?) - 1 })))
            .or_else(|| Some(Term::Coupling(Coupling { joint: usize::from(numbered("coupled")?) - 1 })))
            .or_else(|| Some(Term::Factor(Factor { index: usize::from(numbered("factor")?) - 1 })))
            .or_else(|| Some(Term::Payload(Payload { index: usize::from(numbered("payload")?) - 1 })))
            .ok_or_else(|| {
                format!(
                    "found the term `{name}`, expected offset, ratio, sin1, cos1, …, masses, sag1, …, coupled1, …, factor1, … or payload1, …"
                )
            })
    }
}

impl Serialize for Term {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Term {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name: Cow<'de, str> = Deserialize::deserialize(deserializer)?;
        name.parse().map_err(D::Error::custom)
    }
}

impl JsonSchema for Term {
    fn schema_name() -> Cow<'static, str> {
        "Term".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        schemars::json_schema!({
            "type": "string",
            "pattern": "^(offset|ratio|masses|(sin|cos|sag|coupled|factor|payload)[1-9][0-9]*)$",
            "description": "A term of a joint's value.",
        })
    }
}

/// A term of a joint with its coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointTerm {
    /// Index of the joint.
    pub joint: usize,
    /// The term.
    pub term: Term,
    /// Its coefficient c, in [`TermModel::unit`].
    pub coefficient: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Situation;
    use crate::robot::tests::elbow;

    #[test]
    fn terms_are_parsed_from_their_names() {
        for (name, term) in [
            ("offset", Term::Offset),
            ("ratio", Term::Ratio),
            ("sin2", Term::Harmonic(Harmonic { order: 2, cosine: false })),
            ("cos2", Term::Harmonic(Harmonic { order: 2, cosine: true })),
            ("masses", Term::OwnWeight),
            ("sag6", Term::Sag(Sag { weight: 5 })),
            ("coupled4", Term::Coupling(Coupling { joint: 3 })),
            ("factor1", Term::Factor(Factor { index: 0 })),
            ("payload1", Term::Payload(Payload { index: 0 })),
        ] {
            assert_eq!((name.parse::<Term>(), term.to_string().as_str()), (Ok(term), name));
        }
    }

    #[test]
    fn terms_are_functions_of_the_configuration() {
        let at = Situation { factors: &[21.5], ..Situation::of(&[0.7, 0.1, 0.2, 0.3]) };
        for (name, expected) in [
            ("offset", 1.0),
            ("ratio", 0.7),
            ("sin2", 1.4f64.sin()),
            ("cos2", 1.4f64.cos()),
            ("coupled4", 0.3),
            ("factor1", 21.5),
            // Without gravity nothing pulls.
            ("masses", 0.0),
            ("sag6", 0.0),
            ("payload1", 0.0),
        ] {
            assert_eq!(name.parse::<Term>().unwrap().model().basis(0, &at), expected, "{name}");
        }
        let mut robot = elbow();
        robot.terms.push(JointTerm { joint: 1, term: Term::Offset, coefficient: 0.02 });
        assert_eq!(robot.joint_values(&[0.0; 6])[1], 0.02);
    }
}
