//! Distance of a point from the instrument's origin.

use super::FunctionRow;
use crate::measurement::columns::{FormCriterion, MeasurementColumns};
use crate::measurement::session::{MeasurementOrigin, SessionKind, SessionTraits, StationLayout};
use crate::measurement::{Channel, Channels, Device, InitialGuess, Kernel, Measurement, MeasurementFunction, Quantity};
use poecal_arm::lie::Freedom;

static CHANNELS: Channels = Channels::new(&[Channel { name: "distance", quantity: Quantity::Distance }]);

const READ: MeasurementFunction = MeasurementFunction {
    name: "distance",
    plural: "distances",
    quantities: &[Quantity::Distance],
    channels: |_| &CHANNELS,
    residual: |[distance, ..], predicted, out| out[0] = distance - predicted.translation.norm(),
    sensitivity: |_, predicted, out| {
        let direction = predicted.translation.try_normalize(0.0).unwrap_or_default();
        out[0] = [direction.x, direction.y, direction.z, 0.0, 0.0, 0.0];
    },
    lengths: 1,
    kernel: Kernel::Distance,
    device: Device::Anchor,
    device_freedom: |_| Freedom::PLACE,
    clue: |[distance, ..]| InitialGuess::Range(*distance),
    ..MeasurementFunction::USUAL
};

/// Measured distance, `e = d - |p|`, `S = [pᵀ/|p| 0]`. It determines the position of its instrument, and not its orientation (theory.md §4
/// (15a)).
static DISTANCE: MeasurementFunction = READ;

/// The same function with an unknown zero of the instrument's readings, so that only changes count: of an interferometer, of a sphere whose
/// radius is unknown (theory.md §4 (15d)).
static CHANGE: MeasurementFunction = MeasurementFunction { name: "distance change", zero_is_unknown: true, ..READ };

pub(crate) const ROW: FunctionRow = FunctionRow {
    function: &DISTANCE,
    columns: &[MeasurementColumns {
        numbers: &["distance"],
        places: &["anchor"],
        word: None,
        from: FormCriterion::Numbers { above_zero: true },
        of: |numbers| Measurement::distance(numbers[0]),
        numbers_of: |seen| Some(vec![seen.values()[0]]),
    }],
    sessions: &[ANCHORS, BALL_BAR],
};

pub(crate) const CHANGE_ROW: FunctionRow = FunctionRow {
    function: &CHANGE,
    columns: &[
        MeasurementColumns {
            numbers: &["distance_change"],
            places: &["anchor"],
            word: None,
            from: FormCriterion::Numbers { above_zero: false },
            of: |numbers| Measurement::distance_change(numbers[0]),
            numbers_of: |seen| Some(vec![seen.values()[0]]).filter(|it| *it != [0.0]),
        },
        MeasurementColumns {
            numbers: &["radius"],
            places: &["sphere"],
            word: None,
            from: FormCriterion::Name { size: true },
            of: |numbers| {
                let is_known = numbers[0] > 0.0;
                if is_known { Measurement::distance(numbers[0]) } else { Measurement::distance_change(0.0) }
            },
            numbers_of: |_| Some(vec![0.0]),
        },
    ],
    sessions: &[CHANGES, SPHERE],
};

const ANCHORS: SessionTraits = SessionTraits {
    word: "distance",
    plural: Some("distances"),
    help: "Distances from anchors, as of a draw-wire",
    function: &DISTANCE,
    places: &["wall", "floor", "door"],
    stands: StationLayout::Around,
    drawn: MeasurementOrigin::Seen(|target, drawn| Measurement::distance(target.translation.norm() + drawn.length.x)),
    columns: &["anchor", "distance[mm]"],
    about: "# anchor      name of the anchor of the distance; three or more are best. Their positions are estimated.\n\
            # distance    from there to the target.\n",
};

const BALL_BAR: SessionTraits = SessionTraits {
    word: "ball-bar",
    plural: Some("ball-bars"),
    help: "Distances between two configurations",
    places: &["pair"],
    stands: StationLayout::Before,
    columns: &["pair", "distance[mm]"],
    about: "# pair        two rows with the same name are one measurement, of two configurations; the second has the number.\n\
            # distance    of the target between the two.\n",
    ..ANCHORS
};

const CHANGES: SessionTraits = SessionTraits {
    word: "distance-change",
    plural: Some("distance-changes"),
    help: "Changes of distances, as of an interferometer",
    function: &CHANGE,
    drawn: MeasurementOrigin::Seen(|target, drawn| {
        Measurement::distance_change(target.translation.norm() + drawn.length.x + drawn.zero_m)
    }),
    columns: &["anchor", "distance_change[mm]"],
    about: "# anchor           the instrument, or where it stood; another name whenever it was moved or set to zero.\n\
            # distance_change  what it shows: the distance from it, counted from any zero.\n",
    ..ANCHORS
};

/// Radius of the simulated sphere, metres.
const SPHERE_M: f64 = 0.05;

const SPHERE: SessionTraits = SessionTraits {
    word: "sphere",
    plural: Some("spheres"),
    help: "Points of spheres",
    function: &CHANGE,
    places: &["ball"],
    stands: StationLayout::Within,
    drawn: MeasurementOrigin::Touched(|drawn| {
        [Measurement::distance(SPHERE_M + drawn.length.x), Measurement::distance_change(0.0)]
    }),
    columns: &["sphere", "radius[mm]"],
    about: "# sphere      name of the sphere that the target touches; its position is estimated.\n\
            # radius      its radius, and that of the probe; leave it empty if it is unknown (then it is found too).\n",
};

impl SessionKind {
    /// Distances from three anchors.
    pub const DISTANCE: SessionKind = SessionKind::new(&ANCHORS);
    /// Distances of the tip between two configurations.
    pub const BALL_BAR: SessionKind = SessionKind::new(&BALL_BAR);
    /// Changes of the distances from three instruments.
    pub const CHANGE: SessionKind = SessionKind::new(&CHANGES);
    /// Points of a sphere.
    pub const SPHERE: SessionKind = SessionKind::new(&SPHERE);
}

impl Measurement {
    /// Distance of a target from the instrument's origin, metres.
    #[must_use]
    pub fn distance(metres: f64) -> Self {
        Measurement::new(&DISTANCE, &[metres])
    }

    /// A reading of an instrument of distances whose zero is unknown, metres.
    #[must_use]
    pub fn distance_change(metres: f64) -> Self {
        Measurement::new(&CHANGE, &[metres])
    }

    /// The same measurement with an unknown zero of its readings, if it is a distance.
    pub fn with_unknown_zero(self) -> Self {
        if *self.function() == DISTANCE { self.with_function(&CHANGE) } else { self }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use poecal_arm::lie::Pose;

    #[test]
    fn a_distance_is_measured_minus_predicted() {
        let mut e = [0.0];
        Measurement::distance(5.5).residual(&Pose::from_translation(Vector3::new(3.0, 0.0, 4.0)), &mut e);
        assert_eq!(e, [0.5]);
    }
}
