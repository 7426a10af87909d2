//! Whose poses something has, by its name.

use crate::table::roles::{Role, plain};

/// Whose poses a column belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Whose {
    /// The arm's.
    Arm,
    /// What the camera saw.
    Target,
}

/// Whose poses a key or the name of a file says that it has.
pub(crate) fn whose_of(name: &str) -> Option<Whose> {
    let whose = |word: String| {
        let words = [(Role::KeyOfArm, Whose::Arm), (Role::KeyOfTarget, Whose::Target)];
        words.into_iter().find(|(role, _)| role.has(&word)).map(|(_, whose)| whose)
    };
    name.split(|it: char| !it.is_alphanumeric()).map(plain).find_map(whose)
}
