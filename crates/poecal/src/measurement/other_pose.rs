//! The residual of a measured frame in another formulation than [`PoseMeasurement`](super::PoseMeasurement), which is given from outside.

use std::fmt::Debug;

use nalgebra::{Matrix3, Vector3};

use super::{Measurement, Noise, PoseMeasurement, Residual};
use crate::lie::{Pose, TargetTwist};

/// Formulation of the residuals of measured frames as six numbers, first those that depend on the target's translation. It holds for all
/// frames of a data set ([`Dataset::pose_residual`](super::Dataset::pose_residual)). Such a problem takes the row-by-row path, without the
/// full Hessian.
pub trait PoseResidual: Debug + Sync {
    /// Its name; residuals of one name are equal.
    fn name(&self) -> &'static str;

    /// As [`Residual::residual`], for a measured `device_from_target`.
    fn residual(&self, measured: &Pose, predicted: &Pose, noise: &Noise, out: &mut [f64]);

    /// As [`Residual::project`].
    fn project(
        &self,
        measured: &Pose,
        predicted: &Pose,
        columns: &[TargetTwist],
        noise: &Noise,
        stride: usize,
        out: &mut [f64],
    );
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
        match (measurement, other) {
            (Measurement::Pose(PoseMeasurement { pose }), Some(residual)) => {
                Written::Other(OtherPose { pose: *pose, residual })
            }
            (Measurement::Pose(_), None) | (Measurement::Point(_), _) => Written::Usual(measurement),
        }
    }

    pub(crate) fn model(&self) -> &dyn Residual {
        match self {
            Written::Usual(measurement) => measurement.residual_model(),
            Written::Other(pose) => pose,
        }
    }
}

/// A measured frame with a [`PoseResidual`].
pub(crate) struct OtherPose {
    pose: Pose,
    residual: &'static dyn PoseResidual,
}

impl Residual for OtherPose {
    fn dim(&self) -> usize {
        6
    }

    fn residual(&self, predicted: &Pose, noise: &Noise, out: &mut [f64]) {
        self.residual.residual(&self.pose, predicted, noise, out);
    }

    fn project(
        &self,
        predicted: &Pose,
        columns: &[TargetTwist],
        noise: &Noise,
        stride: usize,
        out: &mut [f64],
    ) {
        self.residual.project(&self.pose, predicted, columns, noise, stride, out);
    }

    fn wrench(&self, _: &Pose, _: &Noise) -> Option<(Vector3<f64>, Vector3<f64>)> {
        None
    }

    fn rotation_row(&self) -> usize {
        3
    }

    fn position(&self) -> Vector3<f64> {
        self.pose.translation
    }

    fn orientation(&self) -> Option<Matrix3<f64>> {
        Some(self.pose.rotation)
    }
}
