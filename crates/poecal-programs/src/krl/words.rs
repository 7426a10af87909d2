//! Words of the language.

use crate::scan::LexicalRules;

pub(crate) const RULES: LexicalRules =
    LexicalRules { comments: &[";"], quotes: b"\"'", letters: b"$", is_open_in_brackets: false };

/// Path of a motion to its target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum KrlMotionType {
    /// All axes at once.
    Joints,
    /// A line, an arc or a curve.
    Straight,
    /// Relative motion, not to a target.
    Relative,
}

/// Statements that move the robot.
pub(crate) const MOTIONS: [(&str, KrlMotionType); 13] = [
    ("PTP", KrlMotionType::Joints),
    ("SPTP", KrlMotionType::Joints),
    ("LIN", KrlMotionType::Straight),
    ("SLIN", KrlMotionType::Straight),
    ("CIRC", KrlMotionType::Straight),
    ("SCIRC", KrlMotionType::Straight),
    ("SPL", KrlMotionType::Straight),
    ("PTP_REL", KrlMotionType::Relative),
    ("LIN_REL", KrlMotionType::Relative),
    ("CIRC_REL", KrlMotionType::Relative),
    ("SPTP_REL", KrlMotionType::Relative),
    ("SLIN_REL", KrlMotionType::Relative),
    ("SCIRC_REL", KrlMotionType::Relative),
];
