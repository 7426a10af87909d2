//! Result of a diagnosis: a mistake with its evidence.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Kind of a mistake. The words do not change between versions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DiagnosisKind {
    /// Degrees for radians or millimetres for metres, of all joints or of single ones.
    JointUnit,
    /// Positions in another unit than stated.
    PositionUnit,
    /// A joint counts in the opposite direction.
    JointSign,
    /// Two joint columns are exchanged.
    JointsSwapped,
    /// The readings of a joint are the sum or the difference of two joints.
    JointsCoupled,
    /// The zero of a joint is at another value.
    JointZero,
    /// Parts of the quaternions are in another order.
    QuaternionOrder,
    /// Poses of the device in the target for those of the target in the device.
    InvertedPose,
    /// Angles of another convention than stated.
    EulerConvention,
    /// Coordinates of a left-handed frame.
    LeftHanded,
    /// Measurements are paired with readings of other rows.
    RowShift,
    /// The names of two targets are exchanged.
    TargetsSwapped,
    /// Several targets were measured under one name.
    TargetsUnnamed,
    /// Joint readings that are too large or too small by a factor of each joint.
    JointScale,
    /// A board that cameras see is of another size than stated.
    BoardSize,
    /// Distances or heights in another unit than stated.
    LengthUnit,
    /// Distances that do not count from their anchor, or a radius that differs from the stated one.
    DistanceZero,
    /// A known distance that differs from the stated one.
    KnownLength,
    /// Heights that count in the opposite direction in some rows.
    HeightSign,
    /// Tilts in another unit than stated.
    TiltUnit,
    /// Rows that name another anchor, socket or plane.
    PlacesSwapped,
    /// Rows that repeat or contradict each other.
    DuplicateRows,
}

/// A mistake in the input, with its evidence.
///
/// ```
/// use poecal_fit::forensics::{DiagnosisKind, DiagnosisOptions, diagnose};
/// use poecal_model::measurement::Dataset;
/// use poecal_model::simulate::{SessionKind, Simulation, elbow};
/// let made = Simulation::default().run(&elbow(), SessionKind::POSE)?;
/// let mut data = Dataset::new(made.data.reading_names().to_vec());
/// for row in 0..made.data.len() {
///     let mut readings = made.data.readings(row).to_vec();
///     readings.swap(3, 4);
///     data.push(&readings, None, made.data.observations[row].measurement)?;
/// }
/// let rows: Vec<u32> = (0..50).collect();
/// let found = diagnose(&made.nominal, &data, &rows, &DiagnosisOptions::default());
/// assert_eq!(found[0].kind, DiagnosisKind::JointsSwapped);
/// assert!(found[0].statement.starts_with("exchanging the readings of joint4 and joint5 lowers the registered"));
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Diagnosis {
    /// Kind of the mistake.
    pub kind: DiagnosisKind,
    /// Evidence and advice, a sentence.
    pub statement: String,
    /// Rows concerned; empty if all are.
    pub rows: Vec<u32>,
    /// Root mean square error of the data as supplied, millimetres; angles count as arcs at a third of the robot's reach.
    pub before_mm: f64,
    /// Root mean square error with the mistake undone, millimetres.
    pub after_mm: f64,
}

impl Diagnosis {
    /// True if it concerns the meaning of numbers, not repeated rows.
    #[must_use]
    pub fn is_of_input(&self) -> bool {
        self.kind != DiagnosisKind::DuplicateRows
    }
}

/// A number with three significant digits.
pub(crate) fn format_short(value: f64) -> String {
    if !value.is_finite() || value == 0.0 {
        return value.to_string();
    }
    let digits = (2 - value.abs().log10().floor() as i32).clamp(0, 6) as usize;
    format!("{value:.digits$}")
}
