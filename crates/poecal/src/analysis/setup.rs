//! What an analysis looks at.

use crate::estimate::{Estimate, Packed};
use crate::measurement::{Dataset, Noise};
use crate::problem::Layout;
use crate::robot::Robot;

/// What was measured and what is unknown: all that an analysis looks at.
///
/// An example is [`super::identify`].
#[derive(Clone, Copy, Debug)]
pub struct Setup<'a> {
    /// The robot, for its names and kinds.
    pub robot: &'a Robot,
    /// The measurements.
    pub data: &'a Dataset,
    /// Their joint values.
    pub packed: &'a Packed,
    /// The rows that count.
    pub rows: &'a [u32],
    /// The estimate at which the information was taken.
    pub estimate: &'a Estimate,
    /// The unknowns.
    pub layout: &'a Layout,
    /// The noise by which rows are whitened that state none.
    pub noise: Noise,
    /// How many metres a radian counts.
    pub length_m: f64,
    /// Whether the device stands anywhere.
    pub device_free: bool,
}
