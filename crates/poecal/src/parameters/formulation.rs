//! The four ways to write a robot's errors that lou2009 discusses.

use serde::{Deserialize, Serialize};

/// How the errors of the joints are written as unknowns (lou2009, sections II and III). All describe the same robots; they differ
/// in the number of unknowns, in what becomes of constraints, and in what can be identified.
///
/// ```
/// use poecal::parameters::Formulation;
/// assert_eq!(Formulation::ScrewOffsets.word(), "screw-offsets");
/// assert!(Formulation::ScrewOffsets.has_offsets() && !Formulation::Adjoint.has_offsets());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Formulation {
    /// Each screw moves as a rigid body, `ξ ← Ad_exp(η) ξ`, in the minimal basis: no constraints, no offsets (lou2009 16 to 18).
    #[default]
    Adjoint,
    /// Each screw is six free numbers, made a screw again after every iteration (okamura1996 without offsets).
    Screw,
    /// Free screws and joint offsets, 7n + 6 unknowns (okamura1996, lou2009 3 to 10).
    ScrewOffsets,
    /// Adjoint errors and joint offsets, to show what offsets add: unknowns, and no rank (lou2009 Proposition 1).
    AdjointOffsets,
}

impl Formulation {
    /// All formulations.
    pub const ALL: [Formulation; 4] =
        [Formulation::Adjoint, Formulation::Screw, Formulation::ScrewOffsets, Formulation::AdjointOffsets];

    /// The stable word used in files and on the command line.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Formulation::Adjoint => "adjoint",
            Formulation::Screw => "screw",
            Formulation::ScrewOffsets => "screw-offsets",
            Formulation::AdjointOffsets => "adjoint-offsets",
        }
    }

    /// Whether joint offsets are unknowns.
    #[must_use]
    pub fn has_offsets(self) -> bool {
        matches!(self, Formulation::ScrewOffsets | Formulation::AdjointOffsets)
    }

    /// Whether screws are six free numbers, brought back to screws after every step.
    #[must_use]
    pub fn has_free_screws(self) -> bool {
        matches!(self, Formulation::Screw | Formulation::ScrewOffsets)
    }
}
