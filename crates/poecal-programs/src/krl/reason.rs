//! Reasons why targets stay unchanged.

pub(crate) const COMPUTED: &str = "it is computed while the program runs";
pub(crate) const ABSENT: &str = "its values are in another file: correct the one that states them";
pub(crate) const SEVERAL: &str = "it is assigned several times, or handed to a routine";
pub(crate) const EXPRESSIONS: &str = "it has words or expressions instead of numbers";
pub(crate) const PARTIAL: &str = "it does not state all values: the others are those of the position before";
pub(crate) use crate::axes::NO_EXTERNAL;
pub(crate) const EXTERNAL: &str = "external axes that the model does not have are not at zero";
pub(crate) const COUNT: &str = "it has other axes than the robot";
pub(crate) const RELATIVE: &str =
    "the motion is by an amount from where the robot is, which is corrected: a small error of the amount stays";
pub(crate) const ANGLE: &str = "with CA, the arc does not end there";
pub(crate) const FRAME: &str = "a frame: whether motions go there is not in this file";
pub(crate) const PLACE: &str =
    "its tool or base is not known: state them by --tool-data NUMBER= and --work-object NUMBER=";
pub(crate) const FOREIGN: &str = "the tool stands outside (IPO_FRAME #TCP)";
pub(crate) const UNUSED: &str = "no motion of this file goes there";
pub(crate) const UNKNOWN: &str = "its type is not known here";
