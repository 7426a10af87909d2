//! Statements with an effect on motions.

use crate::parsed_program::ActiveFrame;
use crate::stated_configuration::StatedConfiguration;
use poecal_arm::lie::Pose;

/// Path of a motion to its target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum UrScriptMotionType {
    Joints,
    Straight,
    /// Many targets in short steps, not all of which are reached.
    Stream,
    Unknown,
}

/// A frame of a pose.
#[derive(Clone, Debug)]
pub(crate) enum PoseFrame {
    Is(Pose),
    /// A frame by its variable.
    Named(String),
}

/// A statement with an effect on motions.
#[derive(Clone, Debug)]
pub(crate) enum UrScriptStep {
    /// A motion to the target with this index, in these frames.
    Move { aim: MotionArgument, line: usize, way: UrScriptMotionType },
    /// Sets the tool.
    Tool(ActiveFrame),
    /// True if poses are in a moving frame from here on, false if no longer.
    Moving(bool),
    /// The position of the robot becomes unknown.
    Away,
}

/// Target and settings in the argument of a motion.
#[derive(Clone, Debug)]
pub(crate) struct MotionArgument {
    pub(crate) target: usize,
    pub(crate) frames: Vec<PoseFrame>,
    pub(crate) stated: StatedConfiguration,
    pub(crate) tool: Option<ActiveFrame>,
    /// True if it is converted to a configuration before the motion: the nearest, whatever the path.
    pub(crate) is_inverse: bool,
}
