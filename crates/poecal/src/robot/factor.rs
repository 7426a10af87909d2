//! What joints owe to something else that was read: temperature, the side from which they were approached, or a payload.

use std::borrow::Cow;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::joint::JointKind;
use super::sizes::TermGroup;
use super::term_model::{Situation, TermModel, unit_of_value};
use crate::unit::Unit;

/// What a joint turns or slides with each unit of a factor ([`Robot::factors`](super::Robot)) from its reference, `θ ← θ + c (f - f₀)`: warmth, or half the backlash
/// where the factor says from which side the joint came, +1 or -1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Factor {
    /// Index among the robot's factors.
    pub index: usize,
}

/// Something else that is read in each configuration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FactorReading {
    /// Name of its column.
    pub name: String,
    /// Value at which its terms are zero.
    pub reference: f64,
}

impl FactorReading {
    /// A factor whose terms are zero where it is.
    #[must_use]
    pub fn new(name: &str) -> Self {
        FactorReading { name: name.to_owned(), reference: 0.0 }
    }

    /// The joint of which it says from which side it was approached, empty of all joints; none of another factor.
    #[must_use]
    pub fn approached(&self) -> Option<&str> {
        Some(self.name.strip_prefix(Factor::APPROACH)?.trim_start_matches(['_', '.', ' ']))
    }

    /// The group of the terms that depend on it.
    #[must_use]
    pub fn group(&self) -> TermGroup {
        match self.approached() {
            Some(_) => TermGroup::Backlash,
            None if self.is_payload() => TermGroup::Payload,
            None => TermGroup::Factors,
        }
    }

    /// Whether it is the mass that hangs at the tip, kg.
    #[must_use]
    pub fn is_payload(&self) -> bool {
        self.name == Factor::PAYLOAD
    }
}

impl Factor {
    /// Word with which the name of a factor begins that is the side from which joints are approached.
    pub(crate) const APPROACH: &str = "approach";
    /// Name of the factor that is the mass of a payload.
    pub(crate) const PAYLOAD: &str = "payload";
}

impl TermModel for Factor {
    fn name(&self) -> Cow<'static, str> {
        format!("factor{}", self.index + 1).into()
    }

    fn formula(&self) -> Cow<'static, str> {
        format!("factor {} from its reference", self.index + 1).into()
    }

    fn unit(&self, kind: JointKind) -> Unit {
        unit_of_value(kind)
    }

    fn basis(&self, _: usize, at: &Situation<'_>) -> f64 {
        at.factors.get(self.index).copied().unwrap_or_default()
    }

    /// 0.01°, or 0.02 mm, each unit.
    fn deviation(&self, kind: JointKind) -> f64 {
        match kind {
            JointKind::Revolute => 0.01f64.to_radians(),
            JointKind::Prismatic => 2e-5,
        }
    }
}
