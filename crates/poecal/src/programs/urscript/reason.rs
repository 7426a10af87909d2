//! Why targets stay as they are.

pub(super) const COMPUTED: &str = "it is computed while the program runs";
pub(super) const ABSENT: &str = "it is stated in no line of this file";
pub(super) const SEVERAL: &str = "it is assigned several times";
pub(super) const ARGUMENT: &str = "it is handed to a routine";
pub(super) const EXPRESSIONS: &str = "it has words or expressions instead of numbers";
pub(super) const COUNT: &str = "it has another number of values than the robot has joints";
pub(super) const SPEED: &str = "it is a motion without a target";
pub(super) const UNKNOWN: &str = "the motion is none that is known here";
pub(super) const RELATIVE: &str = "it is relative to a target that is corrected itself";
pub(super) const FRAME: &str = "its frame is stated in no line of this file: state it by --frame NAME=";
