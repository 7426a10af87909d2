//! Other readings of each configuration on which terms of joint values depend: temperature, the side from which joints were approached, or
//! a payload.

use poecal_arm::TermGroup;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Another reading of each configuration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FactorReading {
    /// Name of its column.
    pub name: String,
    /// Value at which its terms are zero.
    pub reference: f64,
}

impl FactorReading {
    /// First word of the name of a factor that is the side from which joints are approached.
    pub(crate) const APPROACH: &str = "approach";
    /// Name of the factor that is the mass of a payload.
    pub const PAYLOAD: &str = "payload";

    /// A factor with the reference zero.
    #[must_use]
    pub fn new(name: &str) -> Self {
        FactorReading { name: name.to_owned(), reference: 0.0 }
    }

    /// Joint whose side of approach it states, empty for all joints; `None` for another factor.
    #[must_use]
    pub fn approached_joint(&self) -> Option<&str> {
        Some(self.name.strip_prefix(Self::APPROACH)?.trim_start_matches(['_', '.', ' ']))
    }

    /// Group of the terms that depend on it.
    #[must_use]
    pub fn group(&self) -> TermGroup {
        match self.approached_joint() {
            Some(_) => TermGroup::Backlash,
            None if self.is_payload() => TermGroup::Payload,
            None => TermGroup::Factors,
        }
    }

    /// True if it is the mass at the tip, kg.
    #[must_use]
    pub fn is_payload(&self) -> bool {
        self.name == Self::PAYLOAD
    }
}
