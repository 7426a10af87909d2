//! What else is read in each configuration and terms of joint values depend on: temperature, the side from which joints were approached, or
//! a payload.

use poecal_arm::TermGroup;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Something else that is read in each configuration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FactorReading {
    /// Name of its column.
    pub name: String,
    /// Value at which its terms are zero.
    pub reference: f64,
}

impl FactorReading {
    /// Word with which the name of a factor begins that is the side from which joints are approached.
    pub(crate) const APPROACH: &str = "approach";
    /// Name of the factor that is the mass of a payload.
    pub const PAYLOAD: &str = "payload";

    /// A factor whose terms are zero where it is.
    #[must_use]
    pub fn new(name: &str) -> Self {
        FactorReading { name: name.to_owned(), reference: 0.0 }
    }

    /// The joint of which it says from which side it was approached, empty of all joints; none of another factor.
    #[must_use]
    pub fn approached(&self) -> Option<&str> {
        Some(self.name.strip_prefix(Self::APPROACH)?.trim_start_matches(['_', '.', ' ']))
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
        self.name == Self::PAYLOAD
    }
}
