//! What a row of data sees, and from where.

use crate::measurement::Observation;

/// A target, seen from one of the places that the device stood at. A target alone is seen from the first.
///
/// ```
/// use poecal::estimate::Sight;
/// assert_eq!(Sight::from(2), Sight { station: 0, target: 2 });
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sight {
    /// Index into [`Dataset::stations`](crate::measurement::Dataset::stations).
    pub station: usize,
    /// Index into [`Dataset::targets`](crate::measurement::Dataset::targets).
    pub target: usize,
}

impl From<usize> for Sight {
    fn from(target: usize) -> Self {
        Sight { station: 0, target }
    }
}

impl From<&Observation> for Sight {
    fn from(observation: &Observation) -> Self {
        Sight { station: observation.station, target: observation.target }
    }
}
