//! A ball in a socket: its place from the middle of the socket.

use nalgebra::Vector3;

use super::{Channel, Channels, Observe, Quantity, Sensitivity};
use crate::lie::{Freedom, Pose};

/// A ball that rests in a socket, `e = y - p` with `y = 0`: the socket is a device that shows where it is and has no axes, and the ball's
/// centre, the target, is at its origin (theory.md §4 (15b)). A fixed point that is touched in many configurations is the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SocketMeasurement {
    /// Where the ball is, from the middle of the socket, metres: zero.
    pub place: Vector3<f64>,
}

const CONTACT: Channels = Channels::new(&[
    Channel { name: "contact_x", quantity: Quantity::Contact },
    Channel { name: "contact_y", quantity: Quantity::Contact },
    Channel { name: "contact_z", quantity: Quantity::Contact },
]);

impl Observe for SocketMeasurement {
    fn channels(&self) -> &'static Channels {
        &CONTACT
    }

    fn residual(&self, predicted: &Pose, out: &mut [f64]) {
        out[..3].copy_from_slice((self.place - predicted.translation).as_slice());
    }

    fn sensitivity(&self, _: &Pose, out: &mut [Sensitivity]) {
        for (k, row) in out[..3].iter_mut().enumerate() {
            *row = [0.0; 6];
            row[k] = 1.0;
        }
    }

    fn is_wrench(&self) -> bool {
        true
    }

    fn has_length(&self) -> bool {
        self.place != Vector3::zeros()
    }

    fn device_word(&self) -> &'static str {
        "socket"
    }

    fn device_freedom(&self) -> Freedom {
        Freedom::PLACE
    }

    fn is_finite(&self) -> bool {
        self.place.iter().all(|number| number.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_in_its_socket_is_at_the_middle() {
        let mut e = [0.0; 3];
        SocketMeasurement::default().residual(&Pose::from_translation(Vector3::new(0.0, 1e-4, 0.0)), &mut e);
        assert_eq!(e, [0.0, -1e-4, 0.0]);
    }
}
