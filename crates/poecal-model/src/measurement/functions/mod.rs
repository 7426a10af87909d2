//! Table of all measured functions.

mod components;
mod direction;
mod distance;
mod flush;
mod height;
mod point;
mod pose;
mod socket;

use super::{Columns, Function, Kind, Quantity, Session};

/// Properties of a function: a row of [`FUNCTIONS`].
pub struct Row {
    /// The function.
    pub function: &'static Function,
    /// Forms in files; empty for a function in the columns of positions and orientations.
    pub columns: &'static [Columns],
    /// Sessions of it.
    pub sessions: &'static [Session],
}

/// All measured functions. A new sensor is a file of this folder, and its row here.
///
/// ```
/// use poecal_model::measurement::FUNCTIONS;
/// let names: Vec<&str> = FUNCTIONS.iter().map(|row| row.function.name).collect();
/// assert!(names.contains(&"distance"));
/// ```
pub static FUNCTIONS: [Row; 9] = [
    pose::ROW,
    point::ROW,
    components::ROW,
    distance::ROW,
    distance::CHANGE_ROW,
    socket::ROW,
    height::ROW,
    flush::ROW,
    direction::ROW,
];

impl Kind {
    /// All kinds, in the order of [`FUNCTIONS`].
    #[must_use]
    pub fn all() -> Vec<Kind> {
        FUNCTIONS.iter().flat_map(|row| row.sessions).map(Kind::new).collect()
    }
}

/// The function with a name.
pub(crate) fn named(name: &str) -> Option<&'static Function> {
    FUNCTIONS.iter().map(|row| row.function).find(|it| it.name == name)
}

/// Function that measures these quantities and no others, the plainest if there are several.
pub fn measuring(quantities: &[Quantity]) -> Option<&'static Function> {
    FUNCTIONS.iter().map(|row| row.function).find(|it| it.quantities == quantities)
}
