//! Reasons why targets stay unchanged.

pub(crate) const COMPUTED: &str = "it is computed while the program runs";
pub(crate) const ABSENT: &str = "it is stated in no line of this file";
pub(crate) const SEVERAL: &str = "it is assigned several times";
pub(crate) const ARGUMENT: &str = "it is handed to a routine";
pub(crate) const EXPRESSIONS: &str = "it has words or expressions instead of numbers";
pub(crate) const COUNT: &str = "it has another number of values than the robot has joints";
pub(crate) const SPEED: &str = "it is a motion without a target";
pub(crate) const UNKNOWN: &str = "the motion is none that is known here";
pub(crate) const RELATIVE: &str = "it is relative to a target that is corrected itself";
pub(crate) const FRAME: &str = "its frame is stated in no line of this file: state it by --work-object NAME=";
