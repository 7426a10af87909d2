//! Target and instrument of a row.

use poecal_model::measurement::Observation;

/// A pair of target and instrument. A target alone is measured from the first station.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sight {
    /// Index into [`Dataset::stations`](poecal_model::measurement::Dataset::stations).
    pub station: usize,
    /// Index into [`Dataset::targets`](poecal_model::measurement::Dataset::targets).
    pub target: usize,
    /// Instrument's own configuration, if it is not that of the target: index into the data's further configurations.
    pub from: Option<u32>,
}

impl Sight {
    /// True if two sights have all frames in common, though perhaps not the instrument's configuration.
    pub(crate) fn is_like(self, other: Sight) -> bool {
        (self.station, self.target, self.from.is_some()) == (other.station, other.target, other.from.is_some())
    }
}

impl From<usize> for Sight {
    fn from(target: usize) -> Self {
        Sight { station: 0, target, from: None }
    }
}

impl From<&Observation> for Sight {
    fn from(observation: &Observation) -> Self {
        Sight { station: observation.station, target: observation.target, from: observation.from }
    }
}
