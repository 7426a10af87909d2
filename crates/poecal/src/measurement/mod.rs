//! What an outside device saw. A measurement knows the pose of the target it saw and nothing of joints or parameters.

mod dataset;
mod point;
mod pose;
mod residual;

pub use dataset::{Dataset, Observation, Set, Source};
pub use point::PointMeasurement;
pub use pose::PoseMeasurement;
pub use residual::{Noise, Residual};

use crate::lie::Pose;

/// One measurement of a target in the measuring device's frame.
///
/// A new type is one file with a [`Residual`] and one variant here; the compiler lists the arms, all in this file.
///
/// ```
/// use nalgebra::Vector3;
/// use poecal::measurement::{Measurement, PointMeasurement};
/// let seen = Measurement::Point(PointMeasurement { position: Vector3::new(1.0, 2.0, 3.0) });
/// assert_eq!(seen.residual_model().dim(), 3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
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
        self.residual_model().orientation().is_some()
    }

    /// The measured `device_from_target`, with the identity where orientation was not measured.
    #[must_use]
    pub fn pose(&self) -> Pose {
        let model = self.residual_model();
        Pose::new(model.orientation().unwrap_or_else(nalgebra::Matrix3::identity), model.position())
    }
}
