//! Some components of the position of a point.

use nalgebra::Vector3;

use super::FunctionRow;
use super::point::XYZ;
use crate::measurement::session::{MeasurementOrigin, SessionKind, SessionTraits, StationLayout};
use crate::measurement::{Channels, InitialGuess, MeasuredValues, Measurement, MeasurementFunction, Quantity};
use poecal_arm::lie::Freedom;

/// Channels of the components that are measured, by a bit of each.
static CHANNELS: [Channels; 8] = [
    Channels::new(&[]),
    Channels::new(&[XYZ[0]]),
    Channels::new(&[XYZ[1]]),
    Channels::new(&[XYZ[0], XYZ[1]]),
    Channels::new(&[XYZ[2]]),
    Channels::new(&[XYZ[0], XYZ[2]]),
    Channels::new(&[XYZ[1], XYZ[2]]),
    Channels::new(&XYZ),
];

/// Measured components of a target's position, `e = (y - p)` and `S = [I 0]` of those alone: a camera that looks along z measures x and y, a
/// gauge on a rail one of them. They determine the device's frame except its position along the others (theory.md §4 (15)). The fourth value
/// has a bit for each that was measured.
static COMPONENTS: MeasurementFunction = MeasurementFunction {
    name: "component",
    plural: "components",
    quantities: &[Quantity::Position],
    channels: |values| &CHANNELS[bits(values)],
    residual: |values, predicted, out| {
        for (out, k) in out.iter_mut().zip(indices(values)) {
            *out = values[k] - predicted.translation[k];
        }
    },
    sensitivity: |values, _, out| {
        for (out, k) in out.iter_mut().zip(indices(values)) {
            *out = [0.0; 6];
            out[k] = 1.0;
        }
    },
    is_wrench: true,
    lengths: 3,
    device_freedom: |values| match bits(values) {
        0b001 => Freedom::plane(0),
        0b010 => Freedom::plane(1),
        0b100 => Freedom::plane(2),
        0b110 => Freedom::without_slide(0),
        0b101 => Freedom::without_slide(1),
        0b011 => Freedom::without_slide(2),
        _ => Freedom::FRAME,
    },
    clue: |values| InitialGuess::Place([0, 1, 2].map(|k| indices(values).any(|own| own == k).then_some(values[k]))),
    ..MeasurementFunction::USUAL
};

fn bits(values: &MeasuredValues) -> usize {
    values[3] as usize & 0b111
}

/// Indices of the measured components.
fn indices(values: &MeasuredValues) -> impl Iterator<Item = usize> {
    let bits = bits(values);
    (0..3).filter(move |k| bits >> k & 1 == 1)
}

pub(crate) const ROW: FunctionRow = FunctionRow { function: &COMPONENTS, columns: &[], sessions: &[FROM_ABOVE] };

const FROM_ABOVE: SessionTraits = SessionTraits {
    word: "component",
    plural: Some("components"),
    help: "Some of x, y and z, as of a camera or a gauge on a rail",
    function: &COMPONENTS,
    places: &["camera"],
    stands: StationLayout::Within,
    drawn: MeasurementOrigin::Seen(|target, drawn| {
        let seen = target.translation + (drawn.lengths)();
        Measurement::components([Some(seen.x), Some(seen.y), None])
    }),
    columns: &["instrument", "x[mm]", "y[mm]", "z[mm]"],
    about: "# instrument  what measured; each has axes of its own, which are found.\n\
            # x, y, z     position of the target; leave a cell empty where that component was not measured.\n",
};

impl SessionKind {
    /// Two components of the tip's position, as a camera measures them.
    pub const COMPONENT: SessionKind = SessionKind::new(&FROM_ABOVE);
}

impl Measurement {
    /// Components of a target's position in the device's frame, metres; `None` for those that were not measured, and one at least.
    #[must_use]
    pub fn components(components: [Option<f64>; 3]) -> Self {
        let bits = [0, 1, 2].map(|k| f64::from(u8::from(components[k].is_some()) << k));
        let place: Vector3<f64> = components.map(Option::unwrap_or_default).into();
        let sum: f64 = bits.iter().sum();
        let measured = if sum == 0.0 { f64::NAN } else { sum };
        Measurement::new(&COMPONENTS, &[place.x, place.y, place.z, measured])
    }

    /// True if some components of a position were measured, and not all.
    pub fn is_part_of_position(&self) -> bool {
        *self.function() == COMPONENTS
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_arm::lie::Pose;

    #[test]
    fn components_are_measured_minus_predicted_of_those_alone() {
        let seen = Measurement::components([Some(0.3), None, Some(0.1)]);
        let mut e = [0.0; 2];
        seen.residual(&Pose::from_translation(Vector3::new(0.3, 7.0, 0.0)), &mut e);
        assert_eq!((e, seen.channels()[1].name), ([0.0, 0.1], "z"));
        assert!(!Measurement::components([None; 3]).is_finite());
    }
}
