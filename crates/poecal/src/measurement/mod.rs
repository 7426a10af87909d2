//! What an outside device saw. A measurement knows the pose of the target it saw and nothing of joints or parameters.

mod configurations;
mod dataset;
mod point;
mod pose;
mod residual;
mod spatial_pose;

pub(crate) use configurations::MANY as MANY_ROWS;
pub use dataset::{Dataset, Observation, Set, Source};
pub use point::PointMeasurement;
pub use pose::PoseMeasurement;
pub use residual::{Noise, Residual};
pub use spatial_pose::SpatialPoseMeasurement;

use crate::lie::Pose;

/// How the error of a measured frame is written.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum PoseResidual {
    /// Position and rotation at the target, as a device's data sheet states its noise.
    #[default]
    Tool,
    /// The twist about the device's origin, as in lou2009.
    Spatial,
}

impl PoseResidual {
    /// The stable word used in files and on the command line.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            PoseResidual::Tool => "tool",
            PoseResidual::Spatial => "spatial",
        }
    }
}

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
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Measurement {
    /// Position of a point.
    Point(PointMeasurement),
    /// Position and orientation of a frame.
    Pose(PoseMeasurement),
    /// The same with the residual of lou2009.
    SpatialPose(SpatialPoseMeasurement),
}

impl Measurement {
    /// The residual of this measurement.
    #[must_use]
    pub fn residual_model(&self) -> &dyn Residual {
        match self {
            Measurement::Point(point) => point,
            Measurement::Pose(pose) => pose,
            Measurement::SpatialPose(pose) => pose,
        }
    }

    /// The same measurement with the error of a frame written in this way.
    #[must_use]
    pub fn with_residual(&self, residual: PoseResidual) -> Self {
        match (self, residual) {
            (Measurement::Point(_), _) => *self,
            (_, PoseResidual::Tool) => Measurement::Pose(PoseMeasurement { pose: self.pose() }),
            (_, PoseResidual::Spatial) => {
                Measurement::SpatialPose(SpatialPoseMeasurement { pose: self.pose() })
            }
        }
    }

    /// Whether orientation was measured, so that the target is a frame and not only a point.
    #[must_use]
    pub fn sees_orientation(&self) -> bool {
        match self {
            Measurement::Point(_) => false,
            Measurement::Pose(_) | Measurement::SpatialPose(_) => true,
        }
    }

    /// The measured `device_from_target`, with the identity where orientation was not measured.
    #[must_use]
    pub fn pose(&self) -> Pose {
        match self {
            Measurement::Point(point) => Pose::from_translation(point.position),
            Measurement::Pose(PoseMeasurement { pose })
            | Measurement::SpatialPose(SpatialPoseMeasurement { pose }) => *pose,
        }
    }
}
