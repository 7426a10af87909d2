//! Input of an analysis.

use crate::estimate::{Estimate, Packed};
use crate::measurement::{Dataset, Noise};
use crate::problem::Layout;
use crate::robot::Robot;

/// Input of an analysis: robot, measurements, unknowns.
///
/// An example is [`super::identify`].
#[derive(Clone, Copy, Debug)]
pub struct Setup<'a> {
    /// The robot, for names and kinds of its joints.
    pub robot: &'a Robot,
    /// The measurements.
    pub data: &'a Dataset,
    /// Their joint values.
    pub packed: &'a Packed,
    /// The rows of the fit.
    pub rows: &'a [u32],
    /// The estimate at which the information was computed.
    pub estimate: &'a Estimate,
    /// The unknowns.
    pub layout: &'a Layout,
    /// Noise of rows that state none.
    pub noise: Noise,
    /// Metres that a radian counts.
    pub length_m: f64,
    /// Whether the device frame is unknown.
    pub device_free: bool,
}
