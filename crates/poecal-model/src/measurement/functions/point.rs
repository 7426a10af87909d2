//! Position of a point: lou2009 (19) to (26).

use nalgebra::Vector3;

use super::FunctionRow;
use crate::measurement::session::{MeasurementOrigin, SessionKind, SessionTraits, StationLayout};
use crate::measurement::{Channel, Channels, InitialGuess, Kernel, Measurement, MeasurementFunction, Quantity};

/// Channels of a position.
pub(crate) const XYZ: [Channel; 3] = [
    Channel { name: "x", quantity: Quantity::Position },
    Channel { name: "y", quantity: Quantity::Position },
    Channel { name: "z", quantity: Quantity::Position },
];

static POSITION: Channels = Channels::new(&XYZ);

/// Measured position y of a target point, `e = y - p`, `S = [I 0]` in target-centred form (theory.md §4 (15)).
pub(crate) static POINT: MeasurementFunction = MeasurementFunction {
    name: "point",
    plural: "points",
    quantities: &[Quantity::Position],
    channels: |_| &POSITION,
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
    clue: |[x, y, z, ..]| InitialGuess::Place([Some(*x), Some(*y), Some(*z)]),
    ..MeasurementFunction::USUAL
};

pub(crate) const ROW: FunctionRow = FunctionRow { function: &POINT, columns: &[], sessions: &[POINTS] };

const POINTS: SessionTraits = SessionTraits {
    word: "point",
    plural: Some("points"),
    help: "Positions of a target, as a laser tracker sees them",
    function: &POINT,
    places: &[""],
    stands: StationLayout::Anywhere,
    drawn: MeasurementOrigin::Seen(|target, drawn| Measurement::point(target.translation + drawn.length)),
    columns: &[],
    about: "",
};

impl SessionKind {
    /// Positions of the tip.
    pub const POINT: SessionKind = SessionKind::new(&POINTS);
}

impl Measurement {
    /// Position of a target in the device's frame, metres.
    ///
    /// ```
    /// # mod poecal {
    /// #     pub use poecal_arm::lie;
    /// #     pub use poecal_model::measurement::Measurement;
    /// # }
    /// use poecal::lie::Pose;
    /// use poecal::Measurement;
    /// use nalgebra::Vector3;
    /// let mut e = [0.0; 3];
    /// Measurement::point(Vector3::new(0.0, 0.0, 0.002)).residual(&Pose::identity(), &mut e);
    /// assert_eq!(e, [0.0, 0.0, 0.002]);
    /// ```
    #[must_use]
    pub fn point(position: Vector3<f64>) -> Self {
        Measurement::new(&POINT, position.as_slice())
    }
}
