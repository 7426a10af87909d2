//! Statements that matter.

use crate::parsed::Setting;
use crate::stated::Stated;
use poecal_arm::lie::Pose;

/// How a motion gets to its target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Way {
    Joints,
    Straight,
    /// Many targets in short steps, not each of which is reached.
    Stream,
    Unknown,
}

/// A frame of a pose.
#[derive(Clone, Debug)]
pub(crate) enum Frame {
    Is(Pose),
    /// By the variable that has it.
    Named(String),
}

/// A statement that matters.
#[derive(Clone, Debug)]
pub(crate) enum Step {
    /// A motion to the target with this index, in these frames.
    Move { aim: Aim, line: usize, way: Way },
    /// The tool is set.
    Tool(Setting),
    /// Poses are those of a frame that moves; or no longer.
    Moving(bool),
    /// Nobody knows where the robot is.
    Away,
}

/// What the argument of a motion says.
#[derive(Clone, Debug)]
pub(crate) struct Aim {
    pub(crate) target: usize,
    pub(crate) frames: Vec<Frame>,
    pub(crate) stated: Stated,
    pub(crate) tool: Option<Setting>,
    /// Whether it is made a configuration before the motion: the nearest, whatever the way.
    pub(crate) is_inverse: bool,
}
