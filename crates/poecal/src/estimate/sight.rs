//! Target and station of a row.

use crate::measurement::Observation;

/// A target with the station from which it is measured. A target alone is measured from the first station.
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
