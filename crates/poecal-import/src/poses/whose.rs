//! List of poses to which a name belongs: the arm's or the target's.

use crate::table::roles::{Role, plain};

/// List of poses to which a column belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Whose {
    /// Poses of the arm.
    Arm,
    /// Poses of the target that the camera saw.
    Target,
}

/// The list of poses that a key or the name of a file states.
pub(crate) fn whose_of(name: &str) -> Option<Whose> {
    let whose = |word: String| {
        let words = [(Role::KeyOfArm, Whose::Arm), (Role::KeyOfTarget, Whose::Target)];
        words.into_iter().find(|(role, _)| role.has(&word)).map(|(_, whose)| whose)
    };
    name.split(|it: char| !it.is_alphanumeric()).map(plain).find_map(whose)
}
