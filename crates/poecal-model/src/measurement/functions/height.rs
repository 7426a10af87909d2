//! Height of a point over a plane.

use nalgebra::Vector3;

use super::FunctionRow;
use crate::measurement::columns::{FormCriterion, MeasurementColumns};
use crate::measurement::session::{MeasurementOrigin, SessionKind, SessionTraits, StationLayout};
use crate::measurement::{Channel, Channels, Device, InitialGuess, Kernel, Measurement, MeasurementFunction, Quantity};
use poecal_arm::lie::Freedom;

static CHANNELS: Channels = Channels::new(&[Channel { name: "height", quantity: Quantity::Height }]);

/// Height of a target over a plane, the device's xy, `e = h - p_z`: zero for a probe in contact, the reading of a dial gauge that looks
/// along z. Only height and tilts of the device are determined (theory.md §4 (15c)).
static HEIGHT: MeasurementFunction = MeasurementFunction {
    name: "height",
    plural: "heights",
    quantities: &[Quantity::Height],
    channels: |_| &CHANNELS,
    residual: |[height, ..], predicted, out| out[0] = height - predicted.translation.z,
    sensitivity: |_, _, out| out[0] = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
    is_wrench: true,
    lengths: 1,
    kernel: Kernel::Height,
    device: Device::Plane,
    device_freedom: |_| Freedom::plane(2),
    clue: |[height, ..]| InitialGuess::Height { point: Vector3::zeros(), height: *height, up: None },
    ..MeasurementFunction::USUAL
};

pub(crate) const ROW: FunctionRow = FunctionRow {
    function: &HEIGHT,
    columns: &[MeasurementColumns {
        numbers: &["height"],
        places: &["plane"],
        word: Some(("contact", "point")),
        from: FormCriterion::Name { size: false },
        of: |numbers| Measurement::height(numbers[0]),
        numbers_of: |seen| Some(vec![seen.values()[0]]),
    }],
    sessions: &[PLANES, HEIGHTS],
};

const PLANES: SessionTraits = SessionTraits {
    word: "plane",
    plural: Some("planes"),
    help: "Points of planes",
    function: &HEIGHT,
    places: &["table", "side", "front"],
    stands: StationLayout::Within,
    drawn: MeasurementOrigin::Touched(|drawn| [drawn.length.x, 0.0].map(Measurement::height)),
    columns: &["plane", "contact", "height[mm]"],
    about: "# plane       name of the touched plane; its position is estimated.\n\
            # contact     point, or flush where a face lies on it.\n\
            # height      height of the target over the plane (dial gauge); leave it empty if the target touches the plane.\n",
};

/// Range of the simulated gauge, metres.
const GAUGE_M: f64 = 0.02;

const HEIGHTS: SessionTraits = SessionTraits {
    word: "height",
    plural: Some("heights"),
    help: "Heights over planes, as of a dial gauge",
    drawn: MeasurementOrigin::Touched(|drawn| {
        let height = (drawn.uniform)() * GAUGE_M;
        [height + drawn.length.x, height].map(Measurement::height)
    }),
    ..PLANES
};

impl SessionKind {
    /// Points of three planes.
    pub const PLANE: SessionKind = SessionKind::new(&PLANES);
    /// Heights over three planes.
    pub const HEIGHT: SessionKind = SessionKind::new(&HEIGHTS);
}

impl Measurement {
    /// Height of a target over a plane, metres.
    #[must_use]
    pub fn height(metres: f64) -> Self {
        Measurement::new(&HEIGHT, &[metres])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_arm::lie::Pose;

    #[test]
    fn a_height_is_measured_minus_predicted() {
        let mut e = [0.0];
        Measurement::height(0.0).residual(&Pose::from_translation(Vector3::new(0.3, 0.1, 1e-4)), &mut e);
        assert_eq!(e, [-1e-4]);
    }
}
