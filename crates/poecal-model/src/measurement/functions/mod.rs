//! Table of all measured functions.

mod components;
mod direction;
mod distance;
mod flush;
mod height;
mod point;
mod pose;
mod socket;

use super::{MeasurementColumns, MeasurementFunction, Quantity, SessionKind, SessionTraits};

/// Properties of a function: a row of [`FUNCTIONS`].
pub struct FunctionRow {
    /// The function.
    pub function: &'static MeasurementFunction,
    /// Forms in files; empty for a function in the columns of positions and orientations.
    pub columns: &'static [MeasurementColumns],
    /// Sessions of it.
    pub sessions: &'static [SessionTraits],
}

/// All measured functions. A new sensor is a file of this folder, and its row here.
///
/// ```
/// use poecal_model::measurement::FUNCTIONS;
/// let names: Vec<&str> = FUNCTIONS.iter().map(|row| row.function.name).collect();
/// assert!(names.contains(&"distance"));
/// ```
pub static FUNCTIONS: [FunctionRow; 9] = [
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

impl SessionKind {
    /// All kinds, in the order of [`FUNCTIONS`].
    #[must_use]
    pub fn all() -> Vec<SessionKind> {
        FUNCTIONS.iter().flat_map(|row| row.sessions).map(SessionKind::new).collect()
    }
}

/// The function with a name.
pub(crate) fn find_by_name(name: &str) -> Option<&'static MeasurementFunction> {
    FUNCTIONS.iter().map(|row| row.function).find(|it| it.name == name)
}

/// Function that measures these quantities and no others, the plainest if there are several.
pub fn find_by_quantities(quantities: &[Quantity]) -> Option<&'static MeasurementFunction> {
    FUNCTIONS.iter().map(|row| row.function).find(|it| it.quantities == quantities)
}
