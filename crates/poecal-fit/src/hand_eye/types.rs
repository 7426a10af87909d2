//! Options and results.

use nalgebra::Vector3;

use super::CameraMounting;
use super::bounds::FrameEstimate;
use super::findings::{Finding, FindingKind};
use super::unknown_lens::FoundLens;

/// Directions of the poses of two lists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Directions {
    /// True if the arm's poses are `flange_from_base`, and not `base_from_flange`.
    pub flange_inverted: bool,
    /// True if the camera's poses are `target_from_camera`, and not `camera_from_target`.
    pub target_inverted: bool,
    /// True if both were stated.
    pub stated: bool,
}

impl Directions {
    /// Words for both.
    #[must_use]
    pub fn words(&self) -> String {
        let flange = if self.flange_inverted { "flange from base" } else { "base from flange" };
        let target = if self.target_inverted { "target from camera" } else { "camera from target" };
        format!("{flange}, {target}")
    }
}

/// Usability of a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum HandEyeLevel {
    /// Not usable: the errors of the frames may exceed their bounds.
    DoNotUse,
    /// Usable within its bounds, which further poses would make smaller.
    WithinBounds,
    /// Usable without reserve.
    Good,
}

impl HandEyeLevel {
    /// The level, with the reasons against any use, else with the reasons against use without its bounds.
    pub(crate) fn from_reasons(against: Vec<String>, weak: Vec<String>) -> (Self, Vec<String>) {
        match (against.is_empty(), weak.is_empty()) {
            (false, _) => (HandEyeLevel::DoNotUse, against),
            (true, false) => (HandEyeLevel::WithinBounds, weak),
            (true, true) => (HandEyeLevel::Good, Vec::new()),
        }
    }

    /// Words in messages.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            HandEyeLevel::DoNotUse => "do not use",
            HandEyeLevel::WithinBounds => "use within its bounds",
            HandEyeLevel::Good => "good",
        }
    }

    /// Word in files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            HandEyeLevel::DoNotUse => "do_not_use",
            HandEyeLevel::WithinBounds => "within_bounds",
            HandEyeLevel::Good => "good",
        }
    }
}

/// Options of a hand-eye calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HandEyeOptions {
    /// Mounting of the camera.
    pub camera: CameraMounting,
    /// True if the arm's poses are `flange_from_base`; determined from the poses if not stated.
    pub flange_inverted: Option<bool>,
    /// True if the camera's poses are `target_from_camera`; determined from the poses if not stated.
    pub target_inverted: Option<bool>,
}

impl HandEyeOptions {
    /// Options with directions that are determined from the poses.
    #[must_use]
    pub fn new(camera: CameraMounting) -> Self {
        HandEyeOptions { camera, flange_inverted: None, target_inverted: None }
    }
}

/// A row that contradicts the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandEyeOutlier {
    /// The row, from 0.
    pub row: usize,
    /// Distance of the target from its position predicted by the others, metres.
    pub shift_m: f64,
    /// Angle of its orientation from the predicted one, radians.
    pub turn_rad: f64,
    /// True if it is the pose of a flat board from the other of its two sides.
    pub is_flipped: bool,
}

/// Error of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandEyeRowError {
    /// Distance of the target from its predicted position, metres.
    pub shift_m: f64,
    /// Angle of its orientation from the predicted one, radians.
    pub turn_rad: f64,
    /// True if the row counts in the fit.
    pub is_fitted: bool,
}

/// Errors of rows, each predicted by a fit without it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeldOutErrors {
    /// Number of rows.
    pub rows: usize,
    /// Root mean square distance, metres.
    pub rms_m: f64,
    /// Root mean square angle, radians.
    pub rms_rad: f64,
}

/// Rotation of the flange between its poses: standard deviations of its rotations about the three directions of greatest, middle and
/// least, and these directions in its own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlangeTurns {
    /// Standard deviations, radians.
    pub spread_rad: [f64; 3],
    /// Directions in the flange's frame.
    pub directions: [Vector3<f64>; 3],
}

/// Poses of camera and target.
#[derive(Clone, Debug, PartialEq)]
pub struct HandEye {
    /// Mounting of the camera.
    pub camera: CameraMounting,
    /// Pose of the mounted object (camera or target), in the flange's frame.
    pub on_flange: FrameEstimate,
    /// Pose of the static object (target or camera), in the base frame.
    pub in_base: FrameEstimate,
    /// Directions of the lists.
    pub directions: Directions,
    /// Usability of the result.
    pub level: HandEyeLevel,
    /// Reasons of the level, a sentence each.
    pub reasons: Vec<String>,
    /// Standard deviations of the camera's poses: across and along the line of sight (metres), tilts and turn about it (radians).
    pub noise: [f64; 4],
    /// Point of the target, in its frame, to which the noise of positions refers.
    pub noise_about: Vector3<f64>,
    /// Root mean square errors of the rows that count, metres and radians.
    pub residual: (f64, f64),
    /// Errors of rows that were predicted by the others; `None` with fewer than six.
    pub held_out: Option<HeldOutErrors>,
    /// Errors of all rows.
    pub rows: Vec<HandEyeRowError>,
    /// Rows that contradict the others.
    pub outliers: Vec<HandEyeOutlier>,
    /// Rotation of the flange.
    pub turns: FlangeTurns,
    /// Findings, a sentence each.
    pub findings: Vec<Finding>,
    /// Lens, if it was unknown.
    pub lens: Option<FoundLens>,
}

impl HandEye {
    /// Frame of the camera: on the flange, or in the base.
    #[must_use]
    pub fn camera_frame(&self) -> &FrameEstimate {
        match self.camera {
            CameraMounting::InHand => &self.on_flange,
            CameraMounting::Beside => &self.in_base,
        }
    }

    /// The result, usable only within its bounds if the pictures contradict their lens; `doubt` states it.
    pub(crate) fn with_lens_doubt(mut self, doubt: Option<&String>) -> Self {
        if let Some(doubt) = doubt {
            self.findings.push(Finding::new(FindingKind::Lens, doubt.clone(), Vec::new()));
            self.weaken(doubt.clone());
        }
        self
    }

    /// Adds a reason for which the result is usable only within its bounds.
    pub fn weaken(&mut self, reason: String) {
        if self.level != HandEyeLevel::DoNotUse {
            self.level = HandEyeLevel::WithinBounds;
            self.reasons.push(reason);
        }
    }
}
