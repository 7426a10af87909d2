//! A face of the target that lies on a plane.

use nalgebra::Vector3;

use super::FunctionRow;
use super::direction::{TILTS, tilts_between, turned_by};
use crate::measurement::columns::{FormCriterion, MeasurementColumns};
use crate::measurement::session::{MeasurementOrigin, SessionKind, SessionTraits, StationLayout};
use crate::measurement::{
    Channel, Channels, Device, InitialGuess, MeasuredValues, Measurement, MeasurementFunction, Quantity,
};
use poecal_arm::lie::Freedom;

static CHANNELS: Channels =
    Channels::new(&[Channel { name: "height", quantity: Quantity::Height }, TILTS[0], TILTS[1]]);

/// A face of the target, across one of its axes, flush on a plane, the device's xy: the height of the target and two tilts, all zero,
/// theory.md §4 (15c) and (16b). Only height and tilts of both are determined. After the height, the values are the plane's z in the target's
/// axes: an axis of the target, forward or backward.
static FLUSH: MeasurementFunction = MeasurementFunction {
    name: "flush face",
    plural: "flush faces",
    quantities: &[Quantity::Height, Quantity::Tilt],
    channels: |_| &CHANNELS,
    residual: |values, predicted, out| {
        out[0] = values[0] - predicted.translation.z;
        [out[1], out[2]] = tilts_between(&normal(values), predicted);
    },
    sensitivity: |values, predicted, out| {
        out[0] = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
        [out[1], out[2]] = turned_by(&normal(values), predicted);
    },
    lengths: 1,
    device: Device::Plane,
    device_freedom: |_| Freedom::plane(2),
    target_freedom: |values| {
        let axis = (0..3).find(|&k| values[1 + k].abs() == 1.0);
        axis.map_or(Freedom::FRAME, Freedom::plane)
    },
    clue: |values| InitialGuess::Height { point: Vector3::zeros(), height: values[0], up: Some(normal(values)) },
    ..MeasurementFunction::USUAL
};

fn normal(values: &MeasuredValues) -> Vector3<f64> {
    Vector3::new(values[1], values[2], values[3])
}

pub(crate) const ROW: FunctionRow = FunctionRow {
    function: &FLUSH,
    columns: &[MeasurementColumns {
        numbers: &["height"],
        places: &["plane"],
        word: Some(("contact", "flush")),
        from: FormCriterion::Name { size: false },
        of: |numbers| Measurement::flush(numbers[0], &Vector3::z()),
        numbers_of: |seen| Some(vec![seen.values()[0]]),
    }],
    sessions: &[FACES],
};

const FACES: SessionTraits = SessionTraits {
    word: "flush",
    plural: Some("flush"),
    help: "A face that lies flush on planes",
    function: &FLUSH,
    places: &["table", "side", "front"],
    stands: StationLayout::Within,
    drawn: MeasurementOrigin::Touched(|drawn| {
        let normal = super::direction::of_tilts([drawn.turn.x, drawn.turn.y]);
        [Measurement::flush(drawn.length.x, &normal), Measurement::flush(0.0, &Vector3::z())]
    }),
    columns: &["plane", "contact"],
    about: "# plane       name of the plane on which a face of the tool lies; its position is estimated.\n\
            # contact     flush, or point where a point touches it.\n",
};

impl SessionKind {
    /// A face that lies flush on one of three planes.
    pub const FLUSH: SessionKind = SessionKind::new(&FACES);
}

impl Measurement {
    /// A face that lies flush on a plane: its height, metres, zero; and the plane's z in the target's axes.
    #[must_use]
    pub fn flush(height: f64, normal: &Vector3<f64>) -> Self {
        Measurement::new(&FLUSH, &[height, normal.x, normal.y, normal.z])
    }

    /// The plane's z in the target's axes, for a face that lies flush.
    pub fn face_normal(&self) -> Option<Vector3<f64>> {
        (*self.function() == FLUSH).then(|| normal(self.values()))
    }

    /// Replaces the normal, if the measurement is a face that lies flush.
    pub fn set_face_normal(&mut self, normal: &Vector3<f64>) {
        if *self.function() == FLUSH {
            *self = Measurement::flush(self.values()[0], normal);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_arm::lie::Pose;

    #[test]
    fn a_flush_face_may_turn_and_shift_on_its_plane() {
        let mut e = [0.0; 3];
        let above = Pose::from_xyz_rpy([0.2, 0.1, 1e-4], [0.0, 0.0, 2.0]);
        Measurement::flush(0.0, &Vector3::z()).residual(&above, &mut e);
        assert!(e[0] == -1e-4 && e[1].abs() + e[2].abs() < 1e-15);
    }
}
