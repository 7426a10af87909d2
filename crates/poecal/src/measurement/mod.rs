//! Measurements by an external device. The residual of a measurement depends on the predicted pose of its target alone, not on joints or
//! parameters.

mod configurations;
mod dataset;
mod other_pose;
mod point;
mod pose;
mod residual;

pub(crate) use configurations::MANY as MANY_ROWS;
pub use dataset::{Dataset, Observation, Set, Source};
pub use other_pose::PoseResidual;
pub(crate) use other_pose::Written;
pub use point::PointMeasurement;
pub use pose::PoseMeasurement;
pub use residual::{Noise, Residual};

use crate::lie::Pose;

/// One measurement of a target in the measuring device's frame.
///
/// A new type is one file with a [`Residual`] and one variant here; the compiler lists the places that have to decide.
///
/// ```
/// use nalgebra::Vector3;
/// use poecal::measurement::{Measurement, PointMeasurement};
/// let seen = Measurement::Point(PointMeasurement { position: Vector3::new(1.0, 2.0, 3.0) });
/// assert_eq!(seen.residual_model().dim(), 3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Measurement {
    /// Position of a point.
    Point(PointMeasurement),
    /// Position and orientation of a frame.
    Pose(PoseMeasurement),
}

impl Measurement {
    /// The residual of this measurement.
    #[must_use]
    pub fn residual_model(&self) -> &dyn Residual {
        match self {
            Measurement::Point(point) => point,
            Measurement::Pose(pose) => pose,
        }
    }

    /// Whether orientation was measured, so that the target is a frame and not only a point.
    #[must_use]
    pub fn sees_orientation(&self) -> bool {
        match self {
            Measurement::Point(_) => false,
            Measurement::Pose(_) => true,
        }
    }

    /// The measured `device_from_target`, with the identity where orientation was not measured.
    #[must_use]
    pub fn pose(&self) -> Pose {
        match self {
            Measurement::Point(point) => Pose::from_translation(point.position),
            Measurement::Pose(PoseMeasurement { pose }) => *pose,
        }
    }
}
