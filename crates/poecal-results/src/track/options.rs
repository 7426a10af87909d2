//! Knowledge of visits, and the reference of their judgement.

use serde::Serialize;

/// Shift beyond which rows are no linear function of it, radians: a new calibration is due.
pub(crate) const MOST_RAD: f64 = 2.0 * std::f64::consts::PI / 180.0;
/// Shift of a slide beyond which rows are no linear function of it, metres.
pub(crate) const MOST_M: f64 = 0.02;

/// Knowledge of the visits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrackOptions {
    /// True if the device stands where it stood at the calibration; otherwise its frame is free.
    pub device_is_known: bool,
    /// True if the tool was mounted anew, so that its targets are free.
    pub tool_is_anew: bool,
    /// Standard deviation of a visit and coordinate, metres; `None`: estimated from repeats within a visit, and from the changes without an
    /// explanation.
    pub repeatability_m: Option<f64>,
}

/// State of the robot since its calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RobotCondition {
    /// The changes are no more than noise.
    Unchanged,
    /// The changes are more than noise.
    Changed,
}

/// Reference by which the rows were judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum JudgingBasis {
    /// Earlier rows of the same configurations.
    Repeats,
    /// The delivered model: the corrected one, if there is one.
    Model,
}
