//! The contract of every measurement type: its channels, residual, and sensitivity of the prediction.

use std::ops::{Deref, Range};

use nalgebra::{Matrix3, Vector3};

use super::{ByQuantity, Quantity};
use crate::lie::{Freedom, Pose};

/// Most numbers of one measurement.
pub const NUMBERS: usize = 6;

/// One number of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Channel {
    /// Name of the number in columns of files.
    pub name: &'static str,
    /// Its quantity.
    pub quantity: Quantity,
}

impl Channel {
    /// Its place among the components of its quantity.
    #[must_use]
    pub fn component(&self) -> usize {
        self.quantity.component_names().iter().position(|name| *name == self.name).unwrap_or_default()
    }
}

/// The numbers of a measurement type, and where those of each quantity are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Channels {
    all: &'static [Channel],
    /// First place of each quantity, and how many follow.
    parts: ByQuantity<(u8, u8)>,
}

impl Channels {
    /// The channels of a type.
    ///
    /// # Panics
    /// With more than [`NUMBERS`] channels, or those of one quantity not one after the other: a constant of these does not compile.
    #[must_use]
    pub const fn new(all: &'static [Channel]) -> Self {
        assert!(all.len() <= NUMBERS, "a measurement has at most six numbers");
        let mut parts = [(0, 0); Quantity::ALL.len()];
        let mut k = 0;
        while k < all.len() {
            let (first, count) = &mut parts[all[k].quantity as usize];
            if *count == 0 {
                *first = k as u8;
            }
            assert!((*first + *count) as usize == k, "channels of one quantity follow one another");
            *count += 1;
            k += 1;
        }
        Channels { all, parts: ByQuantity::of_values(parts) }
    }

    /// Places of the numbers of a quantity; empty if it is not measured.
    #[must_use]
    #[inline]
    pub fn of(&self, quantity: Quantity) -> Range<usize> {
        let (first, count) = self.parts[quantity];
        usize::from(first)..usize::from(first + count)
    }

    /// Whether a number of this quantity is measured.
    #[must_use]
    #[inline]
    pub fn has(&self, quantity: Quantity) -> bool {
        self.parts[quantity].1 > 0
    }
}

impl IntoIterator for &Channels {
    type Item = &'static Channel;
    type IntoIter = std::slice::Iter<'static, Channel>;

    fn into_iter(self) -> Self::IntoIter {
        self.all.iter()
    }
}

impl Deref for Channels {
    type Target = [Channel];

    fn deref(&self) -> &[Channel] {
        self.all
    }
}

/// Change of a predicted number by a motion of the target: by its translation, then by its rotation about its own origin, device axes.
pub type Sensitivity = [f64; 6];

/// Interface of a measurement type: residual `e = measured ⊖ predicted` and sensitivity S of the *prediction*, which moves by `S · twist`
/// under a target twist (theory.md §4 (14) to (17)). Neither is whitened.
pub trait Observe {
    /// The numbers of the measurement.
    fn channels(&self) -> &'static Channels;

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

    /// Measured components of the position, metres, device frame, none of those that the measurement does not tell.
    fn position_components(&self) -> [Option<f64>; 3] {
        self.position().map_or([None; 3], |place| [Some(place.x), Some(place.y), Some(place.z)])
    }

    /// Measured `device_from_target` rotation, if the measurement tells it.
    fn orientation(&self) -> Option<Matrix3<f64>> {
        None
    }

    /// Measured distance of the target from the device's origin, metres, if that is what the measurement tells.
    fn range(&self) -> Option<f64> {
        None
    }

    /// Whether what it measures has a length, by which the size of the robot shows; zero has none.
    fn has_length(&self) -> bool {
        true
    }

    /// What the device is, in a word.
    fn device_word(&self) -> &'static str {
        "instrument"
    }

    /// Whether the zero of the readings is an unknown of the device.
    fn zero_is_unknown(&self) -> bool {
        false
    }

    /// What it shows of the device: its frame, or only where it is.
    fn device_freedom(&self) -> Freedom {
        Freedom::FRAME
    }

    /// What it shows of the target: its frame where an orientation is measured, else its place.
    fn target_freedom(&self) -> Freedom {
        if self.orientation().is_some() { Freedom::FRAME } else { Freedom::PLACE }
    }

    /// Whether all measured numbers are finite.
    fn is_finite(&self) -> bool;

    /// Number of measured numbers.
    fn dim(&self) -> usize {
        self.channels().len()
    }

    /// Whether it depends on the target's orientation, so that the target is a frame and not only a point.
    fn sees_orientation(&self) -> bool {
        self.target_freedom().turns()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measurement::{FlushMeasurement, PointMeasurement};

    #[test]
    fn channels_of_a_quantity_follow_one_another() {
        let point = PointMeasurement { position: Vector3::zeros() }.channels();
        assert_eq!((point.len(), point[2].name), (3, "z"));
        assert_eq!((point.of(Quantity::Position), point.of(Quantity::Rotation)), (0..3, 0..0));
        let flush = FlushMeasurement::default().channels();
        assert_eq!((flush.of(Quantity::Height), flush.of(Quantity::Tilt)), (0..1, 1..3));
    }
}
