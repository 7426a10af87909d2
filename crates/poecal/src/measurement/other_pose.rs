//! The residual of a measured frame in another formulation than [`PoseMeasurement`](super::PoseMeasurement), which is given from outside.

use std::fmt::Debug;

use nalgebra::{Matrix3, Vector3};

use super::pose::POSE;
use super::{Channels, Measurement, Observe, PoseMeasurement, Seen, Sensitivity};
use crate::lie::Pose;

/// Formulation of the residuals of measured frames as six numbers, of position and rotation. It holds for all frames of a data set
/// ([`Dataset::pose_residual`](super::Dataset::pose_residual)). Such a problem is solved without the full Hessian.
pub trait PoseResidual: Debug + Sync {
    /// Its name; residuals of one name are equal.
    fn name(&self) -> &'static str;

    /// As [`Observe::residual`], for a measured `device_from_target`.
    fn residual(&self, measured: &Pose, predicted: &Pose, out: &mut [f64]);

    /// As [`Observe::sensitivity`].
    fn sensitivity(&self, measured: &Pose, predicted: &Pose, out: &mut [Sensitivity]);
}

impl PartialEq for dyn PoseResidual {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

/// A measurement with the formulation of its residual.
pub(crate) enum Written<'a> {
    /// The formulation of the measurement's type.
    Usual(&'a Measurement),
    /// Another formulation, of a frame.
    Other(OtherPose),
}

impl<'a> Written<'a> {
    pub(crate) fn new(measurement: &'a Measurement, other: Option<&'static dyn PoseResidual>) -> Self {
        match (measurement.seen(), other) {
            (Seen::Frame(pose), Some(residual)) => Written::Other(OtherPose { pose: *pose, residual }),
            (Seen::Frame(_), None) | (Seen::Point(_) | Seen::Other(_), _) => Written::Usual(measurement),
        }
    }

    pub(crate) fn model(&self) -> &dyn Observe {
        match self {
            Written::Usual(measurement) => measurement.observe(),
            Written::Other(pose) => pose,
        }
    }
}

/// A measured frame with a [`PoseResidual`].
pub(crate) struct OtherPose {
    pose: Pose,
    residual: &'static dyn PoseResidual,
}

impl Observe for OtherPose {
    fn channels(&self) -> &'static Channels {
        &POSE
    }

    fn residual(&self, predicted: &Pose, out: &mut [f64]) {
        self.residual.residual(&self.pose, predicted, out);
    }

    fn sensitivity(&self, predicted: &Pose, out: &mut [Sensitivity]) {
        self.residual.sensitivity(&self.pose, predicted, out);
    }

    fn position(&self) -> Option<Vector3<f64>> {
        Some(self.pose.translation)
    }

    fn orientation(&self) -> Option<Matrix3<f64>> {
        Some(self.pose.rotation)
    }

    fn is_finite(&self) -> bool {
        PoseMeasurement { pose: self.pose }.is_finite()
    }
}
