//! Pose of a camera on a robot's flange, or beside the robot, from poses of the flange and measured poses of the target, without joint
//! readings.
//!
//! The arm is taken as exact, so that the problem has twelve unknowns: two frames between known motions (`equations`). Beside the general
//! fit of `calibrate`, it models more of a camera. Errors along the line of sight differ from those across it (`noise`), and a board is
//! measured best in its middle (`fit`). Frequent mistakes with two lists of poses are recognised (`directions`, `readings`, `moved`). An
//! unknown lens of pictures is estimated with the frames (`lens`).
//!
//! `result.rs` has the steps in order, `tip.rs` and `touches.rs` those of a tool's tip. The input is lists of poses; this module knows no
//! robots and no files.

mod bound_simulation;
mod bounds;
mod directions;
mod draw;
#[cfg(test)]
mod end_tests;
mod equations;
mod findings;
mod fit;
mod flange_turns;
mod lens;
#[cfg(test)]
mod lens_tests;
mod noise;
mod other_lens;
mod other_poses;
mod readings;
mod result;
mod scale;
mod session_motion;
#[cfg(test)]
mod tests;
mod tip;
mod tip_errors;
#[cfg(test)]
mod tip_tests;
mod touches;
mod types;
mod unknown_lens;
mod verdict;

pub use bounds::FrameEstimate;
pub use findings::{Finding, FindingKind};
pub use readings::{ListReading, PoseList};
pub use result::hand_eye;
pub use tip::{TouchedTip, TouchedTool, tool_tip};
pub use touches::Touches;
pub use types::{
    Directions, FlangeTurns, HandEye, HandEyeLevel, HandEyeOptions, HandEyeOutlier, HandEyeRowError, HeldOutErrors,
};
pub use unknown_lens::{FoundLens, UnknownLens};

/// Mounting of the camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraMounting {
    /// On the flange; the target stays.
    InHand,
    /// Beside the robot; the target is on the flange.
    Beside,
}

impl CameraMounting {
    /// Word in files and on the command line.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            CameraMounting::InHand => "in-hand",
            CameraMounting::Beside => "beside",
        }
    }

    /// Name of the frame on the flange.
    #[must_use]
    pub fn on_flange(self) -> &'static str {
        match self {
            CameraMounting::InHand => "camera",
            CameraMounting::Beside => "target",
        }
    }

    /// Name of the static frame.
    #[must_use]
    pub fn in_base(self) -> &'static str {
        match self {
            CameraMounting::InHand => "target",
            CameraMounting::Beside => "camera",
        }
    }
}
