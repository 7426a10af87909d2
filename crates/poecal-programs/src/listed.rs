//! Places of programs that are left as they are.

use serde::Serialize;

/// A place of a program that stays as it is, and why.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Listed {
    /// Line of the program, from 1.
    pub line: usize,
    /// The target's name or text.
    pub name: String,
    /// Why it stays as it is.
    pub reason: String,
}
