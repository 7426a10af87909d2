//! The contract of every measurement type: its channels, residual, and sensitivity of the prediction.

use nalgebra::{Matrix3, Vector3};

use super::Quantity;
use crate::lie::Pose;

/// Most numbers of one measurement.
pub const NUMBERS: usize = 6;

/// One number of a measurement.
///
/// ```
/// use poecal::measurement::{Observe, PointMeasurement};
/// let seen = PointMeasurement { position: nalgebra::Vector3::zeros() };
/// assert_eq!(seen.channels()[2].name, "z");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Channel {
    /// Name of the number in columns of files.
    pub name: &'static str,
    /// Its quantity. Channels of one quantity follow one another.
    pub quantity: Quantity,
}

/// Change of a predicted number by a motion of the target: by its translation, then by its rotation about its own origin, device axes.
pub type Sensitivity = [f64; 6];

/// Interface of a measurement type: residual `e = measured ⊖ predicted` and sensitivity S of the *prediction*, which moves by `S · twist`
/// under a target twist (theory.md §4 (14) to (17)). Neither is whitened.
pub trait Observe {
    /// The numbers of the measurement, at most [`NUMBERS`].
    fn channels(&self) -> &'static [Channel];

    /// Writes the residual for the predicted `device_from_target`, metres and radians.
    fn residual(&self, predicted: &Pose, out: &mut [f64]);

    /// Writes the sensitivity of each predicted number.
    fn sensitivity(&self, predicted: &Pose, out: &mut [Sensitivity]);

    /// Whether the second derivative of `½ |e|²` along a target twist is that of the target's place and turn, under the whitened residual as
    /// force and torque, to first order in the residual (theory.md §6 (31a)). Without it the solver does not use the full Hessian.
    fn is_wrench(&self) -> bool {
        false
    }

    /// Measured position, metres, device frame, if the measurement tells it.
    fn position(&self) -> Option<Vector3<f64>> {
        None
    }

    /// Measured `device_from_target` rotation, if the measurement tells it.
    fn orientation(&self) -> Option<Matrix3<f64>> {
        None
    }

    /// Measured distance of the target from the device's origin, metres, if that is what the measurement tells.
    fn range(&self) -> Option<f64> {
        None
    }

    /// Whether it depends on the device's axes, so that the device is a frame and not only a point.
    fn sees_device_axes(&self) -> bool {
        true
    }

    /// Whether all measured numbers are finite.
    fn is_finite(&self) -> bool;

    /// Number of measured numbers.
    fn dim(&self) -> usize {
        self.channels().len()
    }

    /// Whether it depends on the target's orientation, so that the target is a frame and not only a point.
    fn sees_orientation(&self) -> bool {
        self.orientation().is_some()
    }
}
