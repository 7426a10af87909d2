//! Height of a point over a plane.

use super::{Channel, Channels, Observe, Quantity, Sensitivity};
use crate::lie::{Freedom, Pose};

/// Height of a target over a plane, the device's xy, `e = h - p_z`: zero of a probe that touches, the reading of a dial gauge that looks
/// along z. The device shows its height and its tilts alone (theory.md §4 (15c)).
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct HeightMeasurement {
    /// Height, metres.
    pub height: f64,
}

const HEIGHT: Channels = Channels::new(&[Channel { name: "height", quantity: Quantity::Height }]);

impl Observe for HeightMeasurement {
    fn channels(&self) -> &'static Channels {
        &HEIGHT
    }

    fn residual(&self, predicted: &Pose, out: &mut [f64]) {
        out[0] = self.height - predicted.translation.z;
    }

    fn sensitivity(&self, _: &Pose, out: &mut [Sensitivity]) {
        out[0] = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    }

    fn is_wrench(&self) -> bool {
        true
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

    fn is_finite(&self) -> bool {
        self.height.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn a_height_is_measured_minus_predicted() {
        let mut e = [0.0];
        HeightMeasurement::default().residual(&Pose::from_translation(Vector3::new(0.3, 0.1, 1e-4)), &mut e);
        assert_eq!(e, [-1e-4]);
    }
}
