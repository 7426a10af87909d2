//! Words of the language.

use crate::scan::Rules;

pub(crate) const RULES: Rules =
    Rules { comments: &[";"], quotes: b"\"'", letters: b"$", is_open_in_brackets: false };

/// Path of a motion to its target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// All axes at once.
    Joints,
    /// A line, an arc or a curve.
    Straight,
    /// Relative motion, not to a target.
    Relative,
}

/// Statements that move the robot.
pub(crate) const MOTIONS: [(&str, Way); 13] = [
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
