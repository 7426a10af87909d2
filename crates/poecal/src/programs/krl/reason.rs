//! Why targets stay as they are.

pub(super) const COMPUTED: &str = "it is computed while the program runs";
pub(super) const ABSENT: &str = "its values are in another file: correct the one that states them";
pub(super) const SEVERAL: &str = "it is assigned several times, or handed to a routine";
pub(super) const EXPRESSIONS: &str = "it has words or expressions instead of numbers";
pub(super) const PARTIAL: &str = "it does not state all values: the others are those of the position before";
pub(super) use crate::programs::axes::NO_EXTERNAL;
pub(super) const EXTERNAL: &str = "external axes that the model does not have are not at zero";
pub(super) const COUNT: &str = "it has other axes than the robot";
pub(super) const RELATIVE: &str = "the motion is by an amount from where the robot is, which is corrected: a small error of the amount stays";
pub(super) const ANGLE: &str = "with CA, the arc does not end there";
pub(super) const FRAME: &str = "a frame: whether motions go there is not in this file";
pub(super) const PLACE: &str =
    "its tool or base is not known: state them by --tool NUMBER= and --frame NUMBER=";
pub(super) const FOREIGN: &str = "the tool stands outside (IPO_FRAME #TCP)";
pub(super) const UNUSED: &str = "no motion of this file goes there";
pub(super) const UNKNOWN: &str = "its type is not known here";
