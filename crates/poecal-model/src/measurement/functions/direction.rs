//! A fixed direction in the target's axes.

use nalgebra::Vector3;

use super::FunctionRow;
use crate::measurement::columns::{FormCriterion, MeasurementColumns};
use crate::measurement::session::{MeasurementOrigin, SessionKind, SessionTraits, StationLayout};
use crate::measurement::{
    Channel, Channels, Device, InitialGuess, MeasuredValues, Measurement, MeasurementFunction, Quantity, Sensitivity,
};
use poecal_arm::lie::{Freedom, Pose, rotation, series};

/// Channels of two tilts.
pub(crate) const TILTS: [Channel; 2] =
    [Channel { name: "tilt_x", quantity: Quantity::Tilt }, Channel { name: "tilt_y", quantity: Quantity::Tilt }];

static CHANNELS: Channels = Channels::new(&TILTS);

/// The device's z in the target's axes, `u = Rᵀ e_z`, as an inclinometer on the tool measures the upward direction. The residual is the
/// rotation about the target's axes from the measured direction m to the predicted one, in a basis across m (theory.md §4 (16b)).
static DIRECTION: MeasurementFunction = MeasurementFunction {
    name: "direction",
    plural: "directions",
    quantities: &[Quantity::Tilt],
    channels: |_| &CHANNELS,
    residual: |values, predicted, out| [out[0], out[1]] = tilts_between(&direction_of(values), predicted),
    sensitivity: |values, predicted, out| [out[0], out[1]] = turned_by(&direction_of(values), predicted),
    with_angles_times: Some(|values, factor| {
        let tilts = tilts_of(&direction_of(values)).map(|tilt| factor * tilt);
        *Measurement::tilts(tilts).values()
    }),
    device: Device::Direction,
    device_freedom: |_| Freedom::tilt(2),
    target_freedom: |_| Freedom::TURN,
    clue: |values| InitialGuess::Up(direction_of(values)),
    ..MeasurementFunction::USUAL
};

fn direction_of([x, y, z, ..]: &MeasuredValues) -> Vector3<f64> {
    Vector3::new(*x, *y, *z)
}

/// `θ / sin θ` of directions that are opposite but for rounding.
const OPPOSITE: f64 = 1e8;

/// Two unit vectors across a measured direction, which complete a right-handed frame; x and y of the target if it is z.
fn perpendicular_pair(measured: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let turn = rotation::shortest_arc(&Vector3::z(), measured);
    [turn.column(0).into_owned(), turn.column(1).into_owned()]
}

/// Residual of a measured direction of the device's z.
pub(crate) fn tilts_between(measured: &Vector3<f64>, predicted: &Pose) -> [f64; 2] {
    let u = predicted.rotation.row(2).transpose();
    let [a, b] = perpendicular_pair(measured);
    let angle = measured.cross(&u).norm().atan2(measured.dot(&u));
    let scale = 1.0 / series::sinc(angle * angle);
    // For the opposite direction the rotation is about any axis across.
    let is_clear = scale.is_finite() && scale.abs() < OPPOSITE;
    if is_clear { [-u.dot(&b) * scale, u.dot(&a) * scale] } else { [angle, 0.0] }
}

/// Sensitivity of the residual of a direction.
pub(crate) fn turned_by(measured: &Vector3<f64>, predicted: &Pose) -> [Sensitivity; 2] {
    let (turn, u) = (predicted.rotation, predicted.rotation.row(2).transpose());
    let [a, b] = perpendicular_pair(measured);
    let angle = measured.cross(&u).norm().atan2(measured.dot(&u));
    let square = angle * angle;
    let sinc = series::sinc(square);
    let scale = (1.0 / sinc).clamp(-OPPOSITE, OPPOSITE);
    // Derivative of θ / sin θ by cos θ.
    let growth = -(series::cosc(square) - series::sincc(square)) * scale * scale * scale;
    // A rotation ω of the target, device axes, moves `g · u` by `ω · (R g × e_z)`.
    let by_turn = |g: Vector3<f64>| (turn * g).cross(&Vector3::z());
    let along = by_turn(*measured);
    let x = by_turn(b) * scale + along * (u.dot(&b) * growth);
    let y = -by_turn(a) * scale - along * (u.dot(&a) * growth);
    [x, y].map(|w| [0.0, 0.0, 0.0, w.x, w.y, w.z])
}

/// Direction in the axes of a target that is turned by these angles about its x and y, radians: the readings of an inclinometer with two
/// axes.
pub(crate) fn of_tilts([x, y]: [f64; 2]) -> Vector3<f64> {
    rotation::exp(&Vector3::new(-x, -y, 0.0)) * Vector3::z()
}

/// Readings of such an inclinometer, radians.
fn tilts_of(direction: &Vector3<f64>) -> [f64; 2] {
    let turn = rotation::log(&rotation::shortest_arc(direction, &Vector3::z()));
    [turn.x, turn.y]
}

pub(crate) const ROW: FunctionRow = FunctionRow {
    function: &DIRECTION,
    columns: &[MeasurementColumns {
        numbers: &["tilt_x", "tilt_y"],
        places: &["direction"],
        word: None,
        from: FormCriterion::Numbers { above_zero: false },
        of: |numbers| Measurement::tilts([numbers[0], numbers[1]]),
        numbers_of: |measurement| Some(tilts_of(&direction_of(measurement.values())).to_vec()),
    }],
    sessions: &[GRAVITY],
};

const GRAVITY: SessionTraits = SessionTraits {
    word: "direction",
    plural: Some("directions"),
    help: "The direction of gravity, as of an inclinometer",
    function: &DIRECTION,
    places: &["gravity"],
    stands: StationLayout::Upward,
    drawn: MeasurementOrigin::Seen(|target, drawn| {
        let up = (rotation::exp(&drawn.turn) * target.rotation).row(2).transpose();
        Measurement::direction(&up)
    }),
    columns: &["direction", "tilt_x[deg]", "tilt_y[deg]"],
    about: "# direction   the direction that is seen, such as gravity.\n\
            # tilt_x, y   the tilts of the target about its own x and y, as an inclinometer with two axes shows them.\n",
};

impl SessionKind {
    /// The direction of gravity.
    pub const DIRECTION: SessionKind = SessionKind::new(&GRAVITY);
}

impl Measurement {
    /// A direction in the target's axes, from any vector along it, such as an accelerometer's at rest.
    #[must_use]
    pub fn direction(along: &Vector3<f64>) -> Self {
        Measurement::new(&DIRECTION, along.normalize().as_slice())
    }

    /// A direction by the readings of an inclinometer with two axes, radians: the target is turned by them about its x and y.
    #[must_use]
    pub fn tilts(readings: [f64; 2]) -> Self {
        Measurement::new(&DIRECTION, of_tilts(readings).as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tilt_is_measured_minus_predicted() {
        let mut e = [0.0; 2];
        let turned = Pose::from_xyz_rpy([0.0; 3], [0.01, 0.0, 0.0]);
        Measurement::tilts([0.0, 0.0]).residual(&turned, &mut e);
        assert!((e[0] + 0.01).abs() < 1e-15 && e[1] == 0.0);
    }
}
