//! Measurements by an external device. The residual of a measurement depends on the predicted pose of its target alone, not on joints or
//! parameters.

mod configurations;
mod dataset;
mod observe;
mod other_pose;
mod point;
mod pose;
mod quantity;

pub(crate) use configurations::MANY as MANY_ROWS;
pub use dataset::{Dataset, Observation, Set, Source};
pub use observe::{Channel, NUMBERS, Observe, Sensitivity};
pub use other_pose::PoseResidual;
pub(crate) use other_pose::Written;
pub use point::PointMeasurement;
pub use pose::PoseMeasurement;
pub use quantity::{ByQuantity, Measured, Noise, Quantity};

use crate::lie::Pose;

/// One measurement of a target in the measuring device's frame.
///
/// A new type is one file with [`Observe`] and one variant here.
///
/// ```
/// use nalgebra::Vector3;
/// use poecal::measurement::{Measurement, PointMeasurement};
/// let seen = Measurement::Point(PointMeasurement { position: Vector3::new(1.0, 2.0, 3.0) });
/// assert_eq!(seen.observe().dim(), 3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Measurement {
    /// Position of a point.
    Point(PointMeasurement),
    /// Position and orientation of a frame.
    Pose(PoseMeasurement),
}

impl Measurement {
    /// What was measured, by its type.
    #[must_use]
    pub fn observe(&self) -> &dyn Observe {
        match self {
            Measurement::Point(point) => point,
            Measurement::Pose(pose) => pose,
        }
    }

    /// Whether it depends on the target's orientation, so that the target is a frame and not only a point.
    #[must_use]
    pub fn sees_orientation(&self) -> bool {
        self.observe().sees_orientation()
    }

    /// Whether a number of this quantity was measured.
    #[must_use]
    pub fn has(&self, quantity: Quantity) -> bool {
        self.observe().channels().iter().any(|channel| channel.quantity == quantity)
    }

    /// The measured `device_from_target`, with the identity for what was not measured.
    #[must_use]
    pub fn pose(&self) -> Pose {
        if let Measurement::Pose(PoseMeasurement { pose }) = self {
            return *pose;
        }
        let (seen, none) = (self.observe(), Pose::identity());
        Pose::new(seen.orientation().unwrap_or(none.rotation), seen.position().unwrap_or(none.translation))
    }
}
