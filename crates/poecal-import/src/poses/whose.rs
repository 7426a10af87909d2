//! Whose poses something has, by its name.

use crate::table::roles::plain;

/// Whose poses a column belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Whose {
    /// The arm's.
    Arm,
    /// What the camera saw.
    Target,
}

/// Words of keys and names of files for the arm's poses, and for the target's; the first that one has is meant.
const WORDS: [(Whose, &[&str]); 2] = [
    (
        Whose::Arm,
        &["effector", "robot", "flange", "tcp", "gripper", "hand", "ee", "arm", "base", "fpe", "fme", "rpe"],
    ),
    (
        Whose::Target,
        &["object", "tracking", "target", "board", "marker", "camera", "cam", "pattern", "cpo", "cmo"],
    ),
];
/// Whose poses a key or the name of a file says that it has.
pub(crate) fn whose_of(name: &str) -> Option<Whose> {
    let of = |word: String| WORDS.iter().find(|it| it.1.contains(&word.as_str())).map(|it| it.0);
    name.split(|it: char| !it.is_alphanumeric()).map(plain).find_map(of)
}
