//! Directions of the unknowns that the measurements do not determine, and their causes.

use serde::{Deserialize, Serialize};

/// Cause of an undetermined direction. The words appear in `calibration.json` and do not change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// Structure: along and about its own axis a joint may be moved without effect.
    OwnAxis,
    /// Structure: the device's frame is unknown, so the base frame is a matter of choice.
    BaseFrame,
    /// Structure: joint offsets cannot be separated from screws.
    JointOffsets,
    /// Structure: only positions were measured.
    NoOrientation,
    /// No kinematic chain from an instrument to its target passes the joint.
    Unseen,
    /// A joint did not move, or its reading only jittered.
    StoodStill,
    /// Fewer measured numbers than unknowns.
    TooFew,
    /// A target measured as a point is on the axis of a joint.
    PointOnAxis,
    /// The tool kept one orientation.
    OneOrientation,
    /// The tool turned about one direction only.
    OneTurningDirection,
    /// Joints moved in a fixed relation only.
    MovedTogether,
    /// A joint moved little.
    SmallMotion,
    /// Joints moved in combinations that hide a direction; no simpler cause was found.
    DependentMotion,
    /// No measured quantity has a length, so that the size of the robot is not determined.
    NoLength,
    /// A target was measured once, so that no second measurement checks it.
    SeenOnce,
    /// Another cause.
    #[default]
    Other,
}

impl Cause {
    /// True if other combinations of the same joint values would have determined the direction.
    pub(crate) fn is_combination(self) -> bool {
        match self {
            Cause::OneOrientation | Cause::OneTurningDirection | Cause::MovedTogether | Cause::DependentMotion => true,
            Cause::OwnAxis
            | Cause::BaseFrame
            | Cause::JointOffsets
            | Cause::NoOrientation
            | Cause::Unseen
            | Cause::StoodStill
            | Cause::TooFew
            | Cause::PointOnAxis
            | Cause::SmallMotion
            | Cause::NoLength
            | Cause::SeenOnce
            | Cause::Other => false,
        }
    }
}

/// Unknowns that the measurements do not determine, or only weakly.
///
/// ```
/// # use poecal_fit::analysis::{PlannedSession, identify};
/// # use poecal_model::{measurement::SessionKind, simulate::{Simulation, elbow}};
/// # let made = Simulation { count: 40, ..Simulation::default() }.run(&elbow(), SessionKind::POINT)?;
/// let planned = PlannedSession { kind: SessionKind::POINT, ..PlannedSession::default() };
/// let structural = identify(&elbow(), made.data.all_readings(), &planned)?.identifiability.structural;
/// // Points of a tracker that stands anywhere do not determine the base frame: a choice that changes no prediction.
/// assert!(structural.iter().any(|direction| direction.description.contains("base")));
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Direction {
    /// Description.
    pub description: String,
    /// Joints concerned.
    pub joints: Vec<String>,
    /// Cause.
    #[serde(default)]
    pub cause: Cause,
    /// Number of independent directions.
    #[serde(default = "default_count")]
    pub directions: usize,
}

fn default_count() -> usize {
    1
}
