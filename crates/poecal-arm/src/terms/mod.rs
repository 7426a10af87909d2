//! Terms of joint values: rotation or translation of a joint beyond its reading.
//!
//! `table.rs` is the table of errors of joints beyond their readings, a row a kind of term: function and derivative, prior and group. Their
//! arguments are put together in `poecal-model`'s `robot/term.rs` for rows and in `robot/arm.rs` for arms. `--free`, corrections, files, exports
//! and inverse kinematics iterate over the table; so kernels, covariance and the forms of files have no code for corrections.

mod table;

use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::cmp::Ordering;
use core::fmt;
use core::str::FromStr;

pub use table::{GroupRow, TermArgument, TermFunction, TermGroup, TermKind, TermRow};

/// Largest number of a harmonic, and of any other term.
const MOST: [usize; 2] = [u8::MAX as usize, u16::MAX as usize];

/// A term of a joint's value, `θ ← θ + c b(x)` with a known function b and a coefficient c: a kind, a row of the table, and its number, if it
/// has one.
///
/// ```
/// use poecal_arm::{Term, TermKind};
/// let second: Term = "sin2".parse().unwrap();
/// assert_eq!((second, second.formula().as_str()), (TermKind::Sine.with_number(2), "sin(2 q)"));
/// assert_eq!(second.function(0.3), [0.6f64.sin(), 2.0 * 0.6f64.cos()]);
/// assert_eq!(TermKind::Sag.with_index(0).to_string(), "sag1");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Term {
    kind: TermKind,
    number: usize,
}

impl TermKind {
    /// Term of this kind with a number: the order of a harmonic, or a count from 1. A kind without numbers has one term.
    #[must_use]
    pub fn with_number(self, number: usize) -> Term {
        Term { kind: self, number: if self.row().is_numbered() { number } else { 0 } }
    }

    /// The term of this kind by an index, which counts from 0.
    #[must_use]
    pub fn with_index(self, index: usize) -> Term {
        self.with_number(index + 1)
    }
}

impl Term {
    /// Joint offset.
    pub const OFFSET: Term = Term { kind: TermKind::Offset, number: 0 };
    /// Error of a gear's ratio.
    pub const RATIO: Term = Term { kind: TermKind::Ratio, number: 0 };

    /// Terms without a number that need only a joint's value.
    pub fn unnumbered() -> impl Iterator<Item = Term> {
        let plain = |it: &Term| it.kind.row().argument <= TermArgument::OwnValue && !it.kind.row().is_numbered();
        TermKind::ALL.into_iter().map(|kind| kind.with_number(0)).filter(plain)
    }

    /// Kind.
    #[must_use]
    pub const fn kind(self) -> TermKind {
        self.kind
    }

    /// The order of a harmonic.
    #[must_use]
    pub const fn number(self) -> usize {
        self.number
    }

    /// Index of the weight, the joint or the factor of its number.
    #[must_use]
    pub const fn index(self) -> usize {
        self.number.saturating_sub(1)
    }

    /// Argument of its function.
    #[must_use]
    pub const fn argument(self) -> TermArgument {
        self.kind.row().argument
    }

    /// Function b of the argument, and the derivative.
    #[must_use]
    pub fn function(self, x: f64) -> [f64; 2] {
        self.kind.row().function.evaluate(x, self.number as f64)
    }

    /// Function in words and signs, with q for the joint's value.
    #[must_use]
    pub fn formula(self) -> String {
        self.kind.row().formula.replace("{}", &self.number.to_string())
    }

    /// Standard deviation of its coefficient over robots, for a prismatic or a revolute joint.
    #[must_use]
    pub fn deviation(self, slides: bool) -> f64 {
        self.kind.row().deviation[usize::from(slides)]
    }

    /// True if its function is of the weights that the robot carries.
    #[must_use]
    pub fn needs_gravity(self) -> bool {
        match self.argument() {
            TermArgument::Masses | TermArgument::Weight | TermArgument::Payload => true,
            TermArgument::Nothing | TermArgument::OwnValue | TermArgument::OtherJoint | TermArgument::Factor => false,
        }
    }

    /// True if it can be of a robot with these numbers of joints and factors.
    #[must_use]
    pub fn is_of(self, joints: usize, factors: usize) -> bool {
        match self.argument() {
            TermArgument::OtherJoint => self.index() < joints,
            TermArgument::Factor | TermArgument::Payload => self.index() < factors,
            TermArgument::Nothing | TermArgument::OwnValue | TermArgument::Masses | TermArgument::Weight => true,
        }
    }

    /// The same term with other indices of joints.
    #[must_use]
    pub fn reindex(self, index: impl Fn(usize) -> usize) -> Self {
        if self.argument() == TermArgument::OtherJoint { self.kind.with_index(index(self.index())) } else { self }
    }

    /// Names of all terms as one pattern.
    #[must_use]
    pub fn pattern() -> String {
        let names = |is_numbered: bool| {
            let rows = TermKind::ALL.into_iter().map(TermKind::row);
            rows.filter(|it| it.is_numbered() == is_numbered).map(|it| it.name).collect::<Vec<_>>().join("|")
        };
        alloc::format!("^({}|({})[1-9][0-9]*)$", names(false), names(true))
    }

    /// Names of all terms in words.
    fn names() -> String {
        let mut names = String::new();
        for (at, kind) in TermKind::ALL.into_iter().enumerate() {
            let next = TermKind::ALL.get(at + 1).map(|kind| kind.row());
            names += if next.is_none() {
                " or "
            } else if at > 0 {
                ", "
            } else {
                ""
            };
            names += &kind.with_number(1).to_string();
            // Kinds of one argument have their numbers together.
            let is_followed = next.is_some_and(|it| it.is_numbered() && it.argument == kind.row().argument);
            names += if kind.row().is_numbered() && !is_followed { ", …" } else { "" };
        }
        names
    }
}

impl PartialOrd for Term {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Term {
    /// Order by argument, then by number.
    fn cmp(&self, other: &Self) -> Ordering {
        let key = |it: &Term| (it.argument(), it.number, it.kind);
        key(self).cmp(&key(other))
    }
}

impl fmt::Display for Term {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let row = self.kind.row();
        out.write_str(row.name)?;
        if row.is_numbered() { write!(out, "{}", self.number) } else { Ok(()) }
    }
}

impl FromStr for Term {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let of = |kind: TermKind| {
            let row = kind.row();
            let rest = name.strip_prefix(row.name)?;
            if !row.is_numbered() {
                return rest.is_empty().then(|| kind.with_number(0));
            }
            let most = MOST[usize::from(row.argument != TermArgument::OwnValue)];
            rest.parse().ok().filter(|number| (1..=most).contains(number)).map(|it| kind.with_number(it))
        };
        let found = TermKind::ALL.into_iter().find_map(of);
        found.ok_or_else(|| alloc::format!("found the term `{name}`, expected {}", Term::names()))
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for Term {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for Term {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name: alloc::borrow::Cow<'de, str> = serde::Deserialize::deserialize(deserializer)?;
        name.parse().map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_are_parsed_from_their_names() {
        for (name, term) in [
            ("offset", Term::OFFSET),
            ("ratio", Term::RATIO),
            ("sin2", TermKind::Sine.with_number(2)),
            ("masses", TermKind::Masses.with_number(0)),
            ("sag6", TermKind::Sag.with_index(5)),
            ("coupled4", TermKind::Coupled.with_index(3)),
        ] {
            assert_eq!((name.parse::<Term>(), term.to_string().as_str()), (Ok(term), name));
        }
        let expected = "offset, ratio, sin1, cos1, …, masses, sag1, …, coupled1, …, factor1, … or payload1, …";
        assert_eq!(Term::names(), expected);
        assert!("sin0".parse::<Term>().is_err() && "sin256".parse::<Term>().is_err());
    }

    #[test]
    fn derivatives_are_those_of_the_functions() {
        for kind in TermKind::ALL {
            let term = kind.with_number(2);
            for x in [-0.9, -0.01, 0.02, 0.7] {
                let slope = (term.function(x + 1e-6)[0] - term.function(x - 1e-6)[0]) / 2e-6;
                assert!((slope - term.function(x)[1]).abs() < 1e-7, "{term} at {x}");
            }
        }
    }
}
