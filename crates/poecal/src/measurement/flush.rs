//! A face that lies flush on a plane.

use nalgebra::Vector3;

use super::direction::TILTS;
use super::{Channel, Channels, DirectionMeasurement, HeightMeasurement, Observe, Quantity, Sensitivity};
use crate::lie::{Freedom, Pose};

/// A face of the target, across one of its axes, flush on a plane, the device's xy: the height of the target and two tilts, all zero,
/// theory.md §4 (15c) and (16b). Of both, height and tilts are all that shows.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FlushMeasurement {
    /// Height of the face, metres: zero.
    pub height: f64,
    /// The plane's z in the target's axes: an axis of the target, forward or backward.
    pub normal: Vector3<f64>,
}

impl Default for FlushMeasurement {
    fn default() -> Self {
        FlushMeasurement { height: 0.0, normal: Vector3::z() }
    }
}

const FLUSH: Channels =
    Channels::new(&[Channel { name: "height", quantity: Quantity::Height }, TILTS[0], TILTS[1]]);

impl FlushMeasurement {
    fn parts(&self) -> (HeightMeasurement, DirectionMeasurement) {
        (HeightMeasurement { height: self.height }, DirectionMeasurement { direction: self.normal })
    }
}

impl Observe for FlushMeasurement {
    fn channels(&self) -> &'static Channels {
        &FLUSH
    }

    fn residual(&self, predicted: &Pose, out: &mut [f64]) {
        let (height, direction) = self.parts();
        height.residual(predicted, out);
        direction.residual(predicted, &mut out[1..]);
    }

    fn sensitivity(&self, predicted: &Pose, out: &mut [Sensitivity]) {
        let (height, direction) = self.parts();
        height.sensitivity(predicted, out);
        direction.sensitivity(predicted, &mut out[1..]);
    }

    fn has_length(&self) -> bool {
        self.height != 0.0
    }

    fn device_word(&self) -> &'static str {
        "plane"
    }

    fn device_freedom(&self) -> Freedom {
        Freedom::plane(2)
    }

    fn target_freedom(&self) -> Freedom {
        let is_axis = |k: usize| self.normal[k].abs() == 1.0;
        match [0, 1, 2].map(is_axis) {
            [true, ..] => Freedom::plane(0),
            [_, true, _] => Freedom::plane(1),
            [.., true] => Freedom::plane(2),
            _ => Freedom::FRAME,
        }
    }

    fn is_finite(&self) -> bool {
        let (height, direction) = self.parts();
        height.is_finite() && direction.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flush_face_may_turn_and_shift_on_its_plane() {
        let mut e = [0.0; 3];
        let above = Pose::from_xyz_rpy([0.2, 0.1, 1e-4], [0.0, 0.0, 2.0]);
        FlushMeasurement::default().residual(&above, &mut e);
        assert!(e[0] == -1e-4 && e[1].abs() + e[2].abs() < 1e-15);
    }
}
