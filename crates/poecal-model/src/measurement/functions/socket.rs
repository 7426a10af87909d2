//! A ball in a socket: its position from the middle of the socket.

use nalgebra::Vector3;

use super::FunctionRow;
use crate::measurement::columns::{FormCriterion, MeasurementColumns};
use crate::measurement::session::{MeasurementOrigin, SessionKind, SessionTraits, StationLayout};
use crate::measurement::{Channel, Channels, Device, InitialGuess, Kernel, Measurement, MeasurementFunction, Quantity};
use poecal_arm::lie::Freedom;

static CONTACT: Channels = Channels::new(&[
    Channel { name: "contact_x", quantity: Quantity::Contact },
    Channel { name: "contact_y", quantity: Quantity::Contact },
    Channel { name: "contact_z", quantity: Quantity::Contact },
]);

/// A ball that rests in a socket, `e = y - p` with `y = 0`. The socket is a device with a position and without axes, and the ball's
/// centre, the target, is at its origin (theory.md §4 (15b)). A fixed point that is touched in many configurations is the same.
static SOCKET: MeasurementFunction = MeasurementFunction {
    name: "contact",
    plural: "contacts",
    quantities: &[Quantity::Contact],
    channels: |_| &CONTACT,
    residual: |[x, y, z, ..], predicted, out| {
        out[..3].copy_from_slice((Vector3::new(*x, *y, *z) - predicted.translation).as_slice());
    },
    sensitivity: |_, _, out| {
        for (k, row) in out[..3].iter_mut().enumerate() {
            *row = [0.0; 6];
            row[k] = 1.0;
        }
    },
    is_wrench: true,
    lengths: 3,
    kernel: Kernel::Place,
    device: Device::Socket,
    device_freedom: |_| Freedom::PLACE,
    clue: |_| InitialGuess::Middle,
    ..MeasurementFunction::USUAL
};

pub(crate) const ROW: FunctionRow = FunctionRow {
    function: &SOCKET,
    columns: &[MeasurementColumns {
        numbers: &[],
        places: &["place", "socket"],
        word: None,
        from: FormCriterion::Name { size: false },
        of: |_| Measurement::socket(Vector3::zeros()),
        numbers_of: |_| Some(Vec::new()),
    }],
    sessions: &[SOCKETS],
};

const SOCKETS: SessionTraits = SessionTraits {
    word: "socket",
    plural: Some("sockets"),
    help: "A ball in sockets, or a fixed point touched in many ways",
    function: &SOCKET,
    places: &["left", "right"],
    stands: StationLayout::InARow,
    drawn: MeasurementOrigin::Touched(|drawn| [drawn.length, Vector3::zeros()].map(Measurement::socket)),
    columns: &["place", "socket"],
    about: "# place       where the sockets stood; another name whenever they were moved.\n\
            # socket      the socket in which the ball is, or the fixed point that is touched.\n",
};

impl SessionKind {
    /// A ball in one of two sockets.
    pub const SOCKET: SessionKind = SessionKind::new(&SOCKETS);
}

impl Measurement {
    /// Position of a ball from the middle of its socket, metres: zero.
    #[must_use]
    pub fn socket(place: Vector3<f64>) -> Self {
        Measurement::new(&SOCKET, place.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_arm::lie::Pose;

    #[test]
    fn a_ball_in_its_socket_is_at_the_middle() {
        let mut e = [0.0; 3];
        let above = Pose::from_translation(Vector3::new(0.0, 1e-4, 0.0));
        Measurement::socket(Vector3::zeros()).residual(&above, &mut e);
        assert_eq!(e, [0.0, -1e-4, 0.0]);
    }
}
