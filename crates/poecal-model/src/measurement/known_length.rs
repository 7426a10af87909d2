//! A known distance between two stations.

use serde::{Deserialize, Serialize};

/// Distance between the origins of two stations that is known from another source: of two sockets on a plate, of the ends of
/// a bar (theory.md §6 (27b)). It determines the size of the robot if no measurement has a length.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct KnownLength {
    /// Indices into [`Dataset::stations`](super::Dataset::stations).
    pub stations: [usize; 2],
    /// Distance, metres.
    pub length_m: f64,
    /// Standard deviation, metres.
    pub sigma_m: f64,
}

impl KnownLength {
    /// Standard deviation if none is stated, metres: of machining, or of a bar measured once.
    pub const SIGMA_M: f64 = 1e-5;
}
