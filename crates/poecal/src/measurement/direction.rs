//! A direction that does not move, as the target sees it: of gravity, by an inclinometer or a level on the tool.

use nalgebra::Vector3;

use super::{Channel, Channels, Observe, Quantity, Sensitivity};
use crate::lie::{Freedom, Pose, rotation, series};

/// The device's z in the target's axes, `u = Rᵀ e_z`, as an inclinometer on the tool sees the upward direction. The residual is the rotation
/// about the target's axes from the measured direction m to the predicted one, in a basis across m (theory.md §4 (16b)).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct DirectionMeasurement {
    /// The direction in the target's axes, a unit vector.
    pub direction: Vector3<f64>,
}

/// The channels of two tilts.
pub(super) const TILTS: [Channel; 2] = [
    Channel { name: "tilt_x", quantity: Quantity::Tilt },
    Channel { name: "tilt_y", quantity: Quantity::Tilt },
];

const DIRECTION: Channels = Channels::new(&TILTS);

impl DirectionMeasurement {
    /// From the readings of an inclinometer with two axes, radians: the target is turned by them about its x and y.
    #[must_use]
    pub fn of_tilts([x, y]: [f64; 2]) -> Self {
        DirectionMeasurement { direction: rotation::exp(&Vector3::new(-x, -y, 0.0)) * Vector3::z() }
    }

    /// The readings of such an inclinometer, radians.
    #[must_use]
    pub fn tilts(&self) -> [f64; 2] {
        let turn = rotation::log(&rotation::shortest_arc(&self.direction, &Vector3::z()));
        [turn.x, turn.y]
    }

    /// From any vector along it, such as an accelerometer's at rest.
    #[must_use]
    pub fn along(vector: &Vector3<f64>) -> Self {
        DirectionMeasurement { direction: vector.normalize() }
    }

    /// Two unit vectors across the measured direction, which end a right-handed frame; x and y of the target where it is z.
    fn across(&self) -> [Vector3<f64>; 2] {
        let turn = rotation::shortest_arc(&Vector3::z(), &self.direction);
        [turn.column(0).into_owned(), turn.column(1).into_owned()]
    }
}

impl Observe for DirectionMeasurement {
    fn channels(&self) -> &'static Channels {
        &DIRECTION
    }

    fn residual(&self, predicted: &Pose, out: &mut [f64]) {
        let u = predicted.rotation.row(2).transpose();
        let [a, b] = self.across();
        let angle = self.direction.cross(&u).norm().atan2(self.direction.dot(&u));
        let scale = 1.0 / series::sinc(angle * angle);
        if scale.is_finite() && scale.abs() < OPPOSITE {
            (out[0], out[1]) = (-u.dot(&b) * scale, u.dot(&a) * scale);
        } else {
            // The opposite direction: about any axis across.
            (out[0], out[1]) = (angle, 0.0);
        }
    }

    fn sensitivity(&self, predicted: &Pose, out: &mut [Sensitivity]) {
        let (turn, u) = (predicted.rotation, predicted.rotation.row(2).transpose());
        let [a, b] = self.across();
        let angle = self.direction.cross(&u).norm().atan2(self.direction.dot(&u));
        let square = angle * angle;
        let sinc = series::sinc(square);
        let scale = (1.0 / sinc).clamp(-OPPOSITE, OPPOSITE);
        // Of θ / sin θ by cos θ.
        let growth = -(series::cosc(square) - series::sincc(square)) * scale * scale * scale;
        // A rotation ω of the target, device axes, moves `g · u` by `ω · (R g × e_z)`.
        let by_turn = |g: Vector3<f64>| (turn * g).cross(&Vector3::z());
        let along = by_turn(self.direction);
        let x = by_turn(b) * scale + along * (u.dot(&b) * growth);
        let y = -by_turn(a) * scale - along * (u.dot(&a) * growth);
        for (row, w) in out.iter_mut().zip([x, y]) {
            *row = [0.0, 0.0, 0.0, w.x, w.y, w.z];
        }
    }

    fn has_length(&self) -> bool {
        false
    }

    fn device_word(&self) -> &'static str {
        "direction"
    }

    fn device_freedom(&self) -> Freedom {
        Freedom::tilt(2)
    }

    fn target_freedom(&self) -> Freedom {
        Freedom::TURN
    }

    fn is_finite(&self) -> bool {
        self.direction.iter().all(|number| number.is_finite())
    }
}

/// `θ / sin θ` of directions that are opposite but for rounding.
const OPPOSITE: f64 = 1e8;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tilt_is_measured_minus_predicted() {
        let mut e = [0.0; 2];
        let level = DirectionMeasurement::of_tilts([0.0, 0.0]);
        level.residual(&Pose::from_xyz_rpy([0.0; 3], [0.01, 0.0, 0.0]), &mut e);
        assert!((e[0] + 0.01).abs() < 1e-15 && e[1] == 0.0);
    }
}
