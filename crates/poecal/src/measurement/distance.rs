//! Distance of a target from the instrument's origin: a draw-wire, a ball bar to a socket.

use super::{Channel, Channels, Observe, Quantity, Sensitivity};
use crate::lie::{Freedom, Pose};

/// Measured distance, `e = d - |p|`, `S = [pᵀ/|p| 0]`. It shows where its instrument is, and not how it is turned (theory.md §4 (15a)).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct DistanceMeasurement {
    /// Distance, metres.
    pub distance: f64,
    /// Whether the zero of the instrument's readings is unknown, so that only changes count: of an interferometer, of a sphere whose radius
    /// is unknown (theory.md §4 (15d)).
    #[serde(default)]
    pub zero_is_unknown: bool,
}

impl DistanceMeasurement {
    /// A distance from the instrument's origin.
    #[must_use]
    pub fn new(distance: f64) -> Self {
        DistanceMeasurement { distance, zero_is_unknown: false }
    }

    /// A reading of an instrument whose zero is unknown.
    #[must_use]
    pub fn from_unknown_zero(distance: f64) -> Self {
        DistanceMeasurement { distance, zero_is_unknown: true }
    }
}

const DISTANCE: Channels = Channels::new(&[Channel { name: "distance", quantity: Quantity::Distance }]);

impl Observe for DistanceMeasurement {
    fn channels(&self) -> &'static Channels {
        &DISTANCE
    }

    fn residual(&self, predicted: &Pose, out: &mut [f64]) {
        out[0] = self.distance - predicted.translation.norm();
    }

    fn sensitivity(&self, predicted: &Pose, out: &mut [Sensitivity]) {
        let direction = predicted.translation.try_normalize(0.0).unwrap_or_default();
        out[0] = [direction.x, direction.y, direction.z, 0.0, 0.0, 0.0];
    }

    fn range(&self) -> Option<f64> {
        Some(self.distance)
    }

    fn zero_is_unknown(&self) -> bool {
        self.zero_is_unknown
    }

    fn has_length(&self) -> bool {
        self.distance != 0.0
    }

    fn device_word(&self) -> &'static str {
        if self.zero_is_unknown && self.distance == 0.0 { "sphere" } else { "anchor" }
    }

    fn device_freedom(&self) -> Freedom {
        Freedom::PLACE
    }

    fn is_finite(&self) -> bool {
        self.distance.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn a_distance_is_measured_minus_predicted() {
        let mut e = [0.0];
        DistanceMeasurement::new(5.5).residual(&Pose::from_translation(Vector3::new(3.0, 0.0, 4.0)), &mut e);
        assert_eq!(e, [0.5]);
    }
}
