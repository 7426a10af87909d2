//! Events of a session, in words and as in files.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Choice of the repair of a session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Repairs {
    /// Evident events are repaired, if the repaired session predicts left-out rows better.
    #[default]
    Auto,
    /// Nothing is repaired: findings are only reported.
    Off,
}

/// Kind of an event. The words do not change between versions.
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
    /// The device, or its support, moved steadily.
    Drift,
    /// Configurations are wrong as a whole.
    Rows,
}

/// An event during a session.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Event {
    /// Kind of the event.
    pub kind: EventKind,
    /// Moved object: the instrument, the target, the joint; empty without a name.
    pub name: String,
    /// Number of the first measurement after it, from 1; for wrong configurations the first of them.
    pub from_row: usize,
    /// File and line of this measurement.
    pub from: String,
    /// Numbers of the measurements of wrong configurations.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rows: Vec<usize>,
    /// Distance, millimetres; for a drift from the first measurement to the last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size_mm: Option<f64>,
    /// Angle, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size_deg: Option<f64>,
    /// Error of the delivered model in cross-validation (RMS, millimetres, or degrees without positions) before the repair.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_before_mm: Option<f64>,
    /// The same error after the repair; absent if none was tried.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_after_mm: Option<f64>,
    /// Interpretation in the repair, or advice, a sentence.
    pub statement: String,
    /// Errors of some rows in their order, by the models before and after the repair, millimetres or degrees; empty without a repair.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub residuals: Vec<[f64; 3]>,
}

impl Event {
    /// True if a calibration with this unrepaired event must not be used; `error_mm` is its error, millimetres.
    pub(crate) fn is_grave(&self, error_mm: f64) -> bool {
        match self.kind {
            EventKind::Rows => false,
            EventKind::Drift => self.size_mm.is_some_and(|size| size > error_mm),
            EventKind::Device | EventKind::Target | EventKind::Nest | EventKind::Zero => true,
        }
    }
}
