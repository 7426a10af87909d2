//! Residual of a measured frame in another formulation than that of its function, which the caller supplies.

use std::fmt::Debug;

use super::{Measurement, Sensitivity};
use poecal_arm::lie::Pose;

/// Formulation of the residuals of measured frames as six numbers, of position and rotation. It holds for all frames of a data set
/// ([`Dataset::pose_residual`](super::Dataset::pose_residual)). Such a problem is solved without the full Hessian.
pub trait PoseResidual: Debug + Sync {
    /// Name; residuals of one name are equal.
    fn name(&self) -> &'static str;

    /// As [`Measurement::residual`], for a measured `device_from_target`.
    fn residual(&self, measured: &Pose, predicted: &Pose, out: &mut [f64]);

    /// As [`Measurement::sensitivity`].
    fn sensitivity(&self, measured: &Pose, predicted: &Pose, out: &mut [Sensitivity]);
}

impl PartialEq for dyn PoseResidual {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

/// A measurement with the formulation of its residual.
pub struct FormulatedMeasurement<'a> {
    /// The measurement.
    pub measurement: &'a Measurement,
    /// Another formulation than that of its function, of a frame.
    other: Option<(Pose, &'static dyn PoseResidual)>,
}

impl<'a> FormulatedMeasurement<'a> {
    /// A measurement with the residual of its function, or another one of a frame.
    pub fn new(measurement: &'a Measurement, other: Option<&'static dyn PoseResidual>) -> Self {
        FormulatedMeasurement { measurement, other: other.and_then(|other| Some((measurement.frame()?, other))) }
    }

    /// True if it is that of its function.
    pub fn is_usual(&self) -> bool {
        self.other.is_none()
    }

    /// True if the wrench of its residual has its second derivative.
    pub fn is_wrench(&self) -> bool {
        self.is_usual() && self.measurement.function().is_wrench
    }

    /// Writes the residual.
    pub fn residual(&self, predicted: &Pose, out: &mut [f64]) {
        match self.other {
            Some((measured, other)) => other.residual(&measured, predicted, out),
            None => self.measurement.residual(predicted, out),
        }
    }

    /// Writes the sensitivity.
    pub fn sensitivity(&self, predicted: &Pose, out: &mut [Sensitivity]) {
        match self.other {
            Some((measured, other)) => other.sensitivity(&measured, predicted, out),
            None => self.measurement.sensitivity(predicted, out),
        }
    }
}
