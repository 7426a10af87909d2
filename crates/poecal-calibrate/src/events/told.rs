//! What happened during a session, in words and as files have it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Whether a session is repaired.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Repairs {
    /// What is evident, if the repaired session predicts rows better that are left out.
    #[default]
    Auto,
    /// Nothing: what was found is said.
    Off,
}

/// What happened. The words do not change between versions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EventKind {
    /// The device was moved.
    Device,
    /// The only target was moved on the arm, or all of them together.
    Target,
    /// One of several targets was moved.
    Nest,
    /// The zero of a joint slipped.
    Zero,
    /// The device, or what it stands on, moved steadily.
    Drift,
    /// Configurations are wrong as a whole.
    Rows,
}

/// Something that happened during a session.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Event {
    /// What it is.
    pub kind: EventKind,
    /// What was moved: the instrument, the target, the joint; empty without a name.
    pub name: String,
    /// Number of the first measurement after it, from 1; of wrong configurations the first of them.
    pub from_row: usize,
    /// Where that is: its file and line.
    pub from: String,
    /// Numbers of the measurements of wrong configurations.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rows: Vec<usize>,
    /// How far, millimetres; of a drift from the first measurement to the last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size_mm: Option<f64>,
    /// How far it turned, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size_deg: Option<f64>,
    /// Error of the delivered model in cross-validation (RMS, millimetres, or degrees without positions) before the repair.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_before_mm: Option<f64>,
    /// The same after it; absent where it was not tried.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_after_mm: Option<f64>,
    /// What it is taken as, or what to do, a sentence.
    pub statement: String,
    /// Errors of some rows in their order, by the models before and after the repair, millimetres or degrees; not of what was not repaired.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub residuals: Vec<[f64; 3]>,
}

impl Event {
    /// Whether a calibration is not to be used with which this was not repaired, whose error is this, millimetres.
    pub(crate) fn is_grave(&self, error_mm: f64) -> bool {
        match self.kind {
            EventKind::Rows => false,
            EventKind::Drift => self.size_mm.is_some_and(|size| size > error_mm),
            EventKind::Device | EventKind::Target | EventKind::Nest | EventKind::Zero => true,
        }
    }
}
