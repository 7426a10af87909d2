//! List of poses to which a name belongs: the arm's or the target's.

use crate::table::roles::{ColumnRole, plain_letters};

/// List of poses to which a column belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum PoseOwner {
    /// Poses of the arm.
    Arm,
    /// Poses of the target that the camera saw.
    Target,
}

/// The list of poses that a key or the name of a file states.
pub(crate) fn whose_of(name: &str) -> Option<PoseOwner> {
    let whose = |word: String| {
        let words = [(ColumnRole::KeyOfArm, PoseOwner::Arm), (ColumnRole::KeyOfTarget, PoseOwner::Target)];
        words.into_iter().find(|(role, _)| role.has(&word)).map(|(_, whose)| whose)
    };
    name.split(|it: char| !it.is_alphanumeric()).map(plain_letters).find_map(whose)
}
