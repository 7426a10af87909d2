//! KRL: the language of KUKA.

mod data;
mod motions;
pub(crate) mod status;
mod values;

use super::axes::Axes;
use super::given::Given;
use super::parsed::Parsed;
use super::scan::Rules;
use crate::error::Result;
use motions::Reader;
use values::Variables;

const RULES: Rules = Rules { comments: &[";"], quotes: b"\"'", letters: b"$", is_open_in_brackets: false };

/// How a motion gets to its target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    /// All axes at once.
    Joints,
    /// Straight, by an arc or a curve.
    Straight,
    /// By an amount, not to a target.
    Relative,
}

/// Statements that move the robot.
const MOTIONS: [(&str, Way); 13] = [
    ("PTP", Way::Joints),
    ("SPTP", Way::Joints),
    ("LIN", Way::Straight),
    ("SLIN", Way::Straight),
    ("CIRC", Way::Straight),
    ("SCIRC", Way::Straight),
    ("SPL", Way::Straight),
    ("PTP_REL", Way::Relative),
    ("LIN_REL", Way::Relative),
    ("CIRC_REL", Way::Relative),
    ("SPTP_REL", Way::Relative),
    ("SLIN_REL", Way::Relative),
    ("SCIRC_REL", Way::Relative),
];

mod reason {
    pub(super) const COMPUTED: &str = "it is computed while the program runs";
    pub(super) const ABSENT: &str = "its values are in another file: correct the one that states them";
    pub(super) const SEVERAL: &str = "it is assigned several times, or handed to a routine";
    pub(super) const EXPRESSIONS: &str = "it has words or expressions instead of numbers";
    pub(super) const PARTIAL: &str =
        "it does not state all values: the others are those of the position before";
    pub(super) use super::super::axes::NO_EXTERNAL;
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
}

/// Targets and motions of a program, or of a list of its data.
pub(crate) fn parse(text: &[u8], given: &Given, axes: &Axes) -> Result<Parsed> {
    let variables = Variables::of(text, &RULES, axes);
    if variables.is_data {
        return Ok(data::parse(&variables, given));
    }
    Reader::new(text, given, axes, &variables).read()
}
