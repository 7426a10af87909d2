//! What is asked, and what is found.

use nalgebra::Vector3;

use super::CameraPlace;
use super::bounds::Placed;
use super::findings::{Finding, FindingKind};
use super::unknown_lens::FoundLens;

/// Directions of the poses of two lists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Directions {
    /// Whether the arm's poses are `flange_from_base`, and not `base_from_flange`.
    pub flange_inverted: bool,
    /// Whether the camera's poses are `target_from_camera`, and not `camera_from_target`.
    pub target_inverted: bool,
    /// Whether both were stated.
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

/// How far a result may be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Not at all: the frames may be off by more than their bounds.
    DoNotUse,
    /// Within its bounds, which further poses would make smaller.
    WithinBounds,
    /// As it is.
    Good,
}

impl Level {
    /// The level, with what speaks against any use, else with what speaks against use without its bounds.
    pub(crate) fn from_reasons(against: Vec<String>, weak: Vec<String>) -> (Self, Vec<String>) {
        match (against.is_empty(), weak.is_empty()) {
            (false, _) => (Level::DoNotUse, against),
            (true, false) => (Level::WithinBounds, weak),
            (true, true) => (Level::Good, Vec::new()),
        }
    }

    /// Words for people.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Level::DoNotUse => "do not use",
            Level::WithinBounds => "use within its bounds",
            Level::Good => "good",
        }
    }

    /// The word in files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Level::DoNotUse => "do_not_use",
            Level::WithinBounds => "within_bounds",
            Level::Good => "good",
        }
    }
}

/// What is asked, and what is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HandEyeOptions {
    /// Where the camera is.
    pub camera: CameraPlace,
    /// Whether the arm's poses are `flange_from_base`; found if it is not stated.
    pub flange_inverted: Option<bool>,
    /// Whether the camera's poses are `target_from_camera`; found if it is not stated.
    pub target_inverted: Option<bool>,
}

impl HandEyeOptions {
    /// With directions that are found.
    #[must_use]
    pub fn new(camera: CameraPlace) -> Self {
        HandEyeOptions { camera, flange_inverted: None, target_inverted: None }
    }
}

/// A row that contradicts the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlier {
    /// The row, from 0.
    pub row: usize,
    /// How far the target is from where the others predict it, metres.
    pub shift_m: f64,
    /// By which angle it is turned, radians.
    pub turn_rad: f64,
    /// Whether it is the pose of a flat board from the other of its two sides.
    pub is_flipped: bool,
}

/// Error of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowError {
    /// How far the target is from where it is predicted, metres.
    pub shift_m: f64,
    /// By which angle it is turned, radians.
    pub turn_rad: f64,
    /// Whether the row counts in the fit.
    pub is_fitted: bool,
}

/// Errors of rows, each predicted by a fit without it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeldOut {
    /// Number of rows.
    pub rows: usize,
    /// Root mean square distance, metres.
    pub rms_m: f64,
    /// Root mean square angle, radians.
    pub rms_rad: f64,
}

/// How far the flange turned between its poses: standard deviations of its turns about the three directions of greatest, middle and least,
/// and these directions in its own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turns {
    /// Standard deviations, radians.
    pub spread_rad: [f64; 3],
    /// Directions in the flange's frame.
    pub directions: [Vector3<f64>; 3],
}

/// Where camera and target are.
#[derive(Clone, Debug, PartialEq)]
pub struct HandEye {
    /// Where the camera is.
    pub camera: CameraPlace,
    /// What is on the flange: camera or target, in the flange's frame.
    pub on_flange: Placed,
    /// What stays: target or camera, in the base frame.
    pub in_base: Placed,
    /// Which way round the lists were.
    pub directions: Directions,
    /// How far to use it.
    pub level: Level,
    /// Why, a sentence each.
    pub reasons: Vec<String>,
    /// Standard deviations of the camera's poses: across and along the line of sight (metres), tilts and turn about it (radians).
    pub noise: [f64; 4],
    /// The point of the target, in its frame, of which the noise of the place is.
    pub noise_about: Vector3<f64>,
    /// Root mean square errors of the rows that count, metres and radians.
    pub residual: (f64, f64),
    /// Errors of rows that were left out in turn; none with fewer than six.
    pub held_out: Option<HeldOut>,
    /// Errors of all rows.
    pub rows: Vec<RowError>,
    /// Rows that contradict the others.
    pub outliers: Vec<Outlier>,
    /// How far the flange turned.
    pub turns: Turns,
    /// What was found beside, a sentence each.
    pub findings: Vec<Finding>,
    /// The lens, if it was unknown.
    pub lens: Option<FoundLens>,
}

impl HandEye {
    /// The frame of the camera: on the flange, or in the base.
    #[must_use]
    pub fn camera_frame(&self) -> &Placed {
        match self.camera {
            CameraPlace::InHand => &self.on_flange,
            CameraPlace::Beside => &self.in_base,
        }
    }

    /// The same, no better than within its bounds if the pictures contradict the lens that they were seen through, as a sentence says.
    pub(crate) fn with_lens_doubt(mut self, doubt: Option<&String>) -> Self {
        if let Some(doubt) = doubt {
            self.findings.push(Finding::new(FindingKind::Lens, doubt.clone(), Vec::new()));
            self.weaken(doubt.clone());
        }
        self
    }

    /// Adds a reason for which the result is no better than within its bounds.
    pub fn weaken(&mut self, reason: String) {
        if self.level != Level::DoNotUse {
            self.level = Level::WithinBounds;
            self.reasons.push(reason);
        }
    }
}
