//! Mistakes in the input, named with evidence and never applied (docs/theory.md §9, "Diagnosis of the input").
//!
//! A mistake is a change of readings or measurements. Each supposed one is undone in turn, and it is named if the nominal robot, or
//! a short calibration, then explains the measurements far better than before and better than with any other supposition.

mod change;
mod conventions;
mod euler;
mod few;
mod hypotheses;
mod judge;
mod repeats;
mod session;
mod targets;
mod unnamed;
mod zero;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::estimate::{Estimate, sample_rows};
use crate::measurement::Dataset;
use crate::robot::Robot;
use few::Few;
use repeats::Repeats;
use session::{Session, sampled, taken};

/// A kind of mistake, as a word that does not change between versions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DiagnosisKind {
    /// Degrees for radians or millimetres for metres, of all joints or of single ones.
    JointUnit,
    /// Positions in another unit than stated.
    PositionUnit,
    /// A joint counts the other way.
    JointSign,
    /// Two joint columns are exchanged.
    JointsSwapped,
    /// The readings of a joint are the sum or the difference of two joints.
    JointsCoupled,
    /// A joint's zero is somewhere else.
    JointZero,
    /// Parts of the quaternions stand in another order.
    QuaternionOrder,
    /// Poses of the device in the target for those of the target in the device.
    InvertedPose,
    /// Angles of another convention than stated.
    EulerConvention,
    /// Coordinates of a left-handed frame.
    LeftHanded,
    /// Measurements stand beside readings of other rows.
    RowShift,
    /// The names of two targets are exchanged.
    TargetsSwapped,
    /// Several targets were seen, and no row says which.
    TargetsUnnamed,
    /// Rows that stand in the data more than once, or contradict each other.
    DuplicateRows,
}

/// A mistake that the data show.
///
/// ```
/// use poecal::forensics::{DiagnosisKind, Options, diagnose};
/// use poecal::measurement::Dataset;
/// use poecal::simulate::{Kind, Simulation, elbow};
/// let made = Simulation::default().run(&elbow(), Kind::Pose)?;
/// let mut data = Dataset::new(made.data.reading_names().to_vec());
/// for row in 0..made.data.len() {
///     let mut readings = made.data.readings(row).to_vec();
///     readings.swap(3, 4);
///     data.push(&readings, None, made.data.observations[row].measurement)?;
/// }
/// let rows: Vec<u32> = (0..50).collect();
/// let found = diagnose(&made.nominal, &data, &rows, &Options::default());
/// assert_eq!(found[0].kind, DiagnosisKind::JointsSwapped);
/// assert!(found[0].statement.starts_with("exchanging the readings of joint4 and joint5 lowers the registered"));
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Diagnosis {
    /// What it is.
    pub kind: DiagnosisKind,
    /// The evidence and what to do, a sentence.
    pub statement: String,
    /// The rows concerned; empty if all are.
    pub rows: Vec<u32>,
    /// Root mean square error as the data are, millimetres; angles count as arcs at a third of the robot's reach.
    pub before_mm: f64,
    /// The same without the mistake.
    pub after_mm: f64,
}

impl Diagnosis {
    /// Whether it is about what the numbers mean, and not about rows that stand there twice.
    #[must_use]
    pub fn is_of_input(&self) -> bool {
        self.kind != DiagnosisKind::DuplicateRows
    }
}

/// What is known beside the data.
///
/// ```
/// assert!(poecal::forensics::Options::default().device_free);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Options<'a> {
    /// Whether the measuring device may stand anywhere (otherwise at the base).
    pub device_free: bool,
    /// The calibrated model of these data, if there is one: it tells at once whether anything is wrong.
    pub calibrated: Option<&'a Estimate>,
}

impl Default for Options<'_> {
    fn default() -> Self {
        Options { device_free: true, calibrated: None }
    }
}

/// Readings up to which suppositions are tried: what is tried grows with their square, and each takes the cube.
pub const MOST_READINGS: usize = 32;
/// Fewest rows that can tell a mistake.
const FEWEST_ROWS: usize = 8;
/// Rows that are looked through for single ones that stand out.
const WHOLE: usize = 2000;

/// Looks for mistakes in some rows of the data (in the order of the data; more of them tell more). Nothing is changed. Of robots with
/// more than [`MOST_READINGS`] nothing but repeated rows is told.
#[must_use]
pub fn diagnose(robot: &Robot, data: &Dataset, rows: &[u32], options: &Options<'_>) -> Vec<Diagnosis> {
    let mut rows: Vec<u32> = rows.iter().copied().filter(|&row| (row as usize) < data.len()).collect();
    rows.sort_unstable();
    rows.dedup();
    if rows.len() < FEWEST_ROWS || robot.reading_names() != data.reading_names() {
        return Vec::new();
    }
    if data.station_count() > 1 {
        return station_by_station(robot, data, &rows, options);
    }
    let session = Session::new(robot, data, options.device_free);
    let Repeats { repeated, contradicting, unnamed } = repeats::diagnose(&session, data, &rows);
    let mut found: Vec<Diagnosis> = repeated.into_iter().collect();
    if data.reading_names().len() > MOST_READINGS {
        found.extend(contradicting);
        return found;
    }
    let whole = of_rows(&session, data, &rows, options);
    // Two measurements of one target in one configuration: of two targets, if names are exchanged; otherwise one is wrong, and
    // neither says anything of the other rows.
    let exchanged = whole.as_ref().is_some_and(|one| one.kind == DiagnosisKind::TargetsSwapped);
    match contradicting {
        // Nothing else can be said of rows that are taken for one target.
        _ if unnamed.is_some() && !exchanged => found.extend(unnamed),
        Some(contradicting) if !exchanged => {
            rows.retain(|row| contradicting.rows.binary_search(row).is_err());
            found.push(contradicting);
            if rows.len() >= FEWEST_ROWS {
                found.extend(of_rows(&session, data, &rows, options));
            }
        }
        _ => found.extend(whole),
    }
    found
}

/// Each place of the device by itself: nothing is supposed of how their frames stand to each other.
fn station_by_station(robot: &Robot, data: &Dataset, rows: &[u32], options: &Options<'_>) -> Vec<Diagnosis> {
    let alone = data.without_stations();
    let mut found: Vec<Diagnosis> = Vec::new();
    for station in 0..data.station_count() {
        let calibrated = options.calibrated.map(|it| it.seen_from(station));
        let own = Options { calibrated: calibrated.as_ref(), ..*options };
        for one in diagnose(robot, &alone, &data.seen_from(station, rows), &own) {
            // Of a mistake that all make, the first says it.
            match found.iter_mut().find(|it| it.kind == one.kind) {
                Some(known) if !known.rows.is_empty() => known.rows.extend(one.rows),
                Some(_) => {}
                None => found.push(one),
            }
        }
    }
    found.iter_mut().for_each(|it| it.rows.sort_unstable());
    found
}

/// The mistake that rows show beside repetitions.
fn of_rows(session: &Session<'_>, data: &Dataset, rows: &[u32], options: &Options<'_>) -> Option<Diagnosis> {
    let whole = taken(data, &sample_rows(rows, WHOLE));
    if let Some(estimate) = options.calibrated
        && session.is_sound(&whole, estimate)
    {
        return targets::names(session, data, estimate);
    }
    let all = taken(data, rows);
    let few = Few::of(session, &all);
    let (estimate, base) = few.session.judged(&sampled(&few.data));
    let placed = few.placed(session, &all, &estimate);
    if session.is_sound(&whole, &placed) {
        return targets::names(session, data, &placed);
    }
    targets::rows(session, data, &all, rows, &base).or_else(|| judge::diagnose(&few, &all, &base))
}
