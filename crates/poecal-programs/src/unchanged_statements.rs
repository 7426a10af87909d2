//! Parts of programs that stay unchanged.

use serde::Serialize;

/// A part of a program that stays unchanged, with the reason.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct UnchangedStatement {
    /// Line of the program, from 1.
    pub line: usize,
    /// The target's name or text.
    pub name: String,
    /// Reason why it stays unchanged.
    pub reason: String,
}
