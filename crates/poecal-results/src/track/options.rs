//! What is known of visits, and by what they are judged.

use serde::Serialize;

/// Shift beyond which rows are no linear function of it: a new calibration is due, radians.
pub(crate) const MOST_RAD: f64 = 2.0 * std::f64::consts::PI / 180.0;
/// The same of a slide, metres.
pub(crate) const MOST_M: f64 = 0.02;

/// What is known of the visits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrackOptions {
    /// Whether the device stands where it stood at the calibration; otherwise its frame is free.
    pub device_is_known: bool,
    /// Whether the tool was mounted anew, so that its targets are free.
    pub tool_is_anew: bool,
    /// Standard deviation of a visit and coordinate, metres; `None`: what repeats within a visit, and what no change explains.
    pub repeatability_m: Option<f64>,
}

/// Whether the robot is as it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// The changes are no more than noise.
    Unchanged,
    /// They are.
    Changed,
}

/// By what the rows were judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum JudgedBy {
    /// Earlier rows of the same configurations.
    Repeats,
    /// The model that is delivered: the corrected one, if there is one.
    Model,
}
