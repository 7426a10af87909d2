//! Sessions that can be simulated and planned: measured quantities, stations, and measurements with noise.

use std::fmt;

use nalgebra::Vector3;

use super::{Measurement, MeasurementFunction, Quantity};
use poecal_arm::lie::Pose;

/// Properties of a kind of session.
pub struct SessionTraits {
    /// Word.
    pub word: &'static str,
    /// Word of the future measurements, if a project can begin with it.
    pub plural: Option<&'static str>,
    /// Short description.
    pub help: &'static str,
    /// Measured function.
    pub function: &'static MeasurementFunction,
    /// Names of the stations.
    pub places: &'static [&'static str],
    /// Positions of the stations.
    pub stands: StationLayout,
    /// Generation of measurements.
    pub drawn: MeasurementOrigin,
    /// Columns of its numbers in a file, with their units.
    pub columns: &'static [&'static str],
    /// Description of the numbers, as comments of a file.
    pub about: &'static str,
}

/// Positions of the stations of a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StationLayout {
    /// One device that measures the whole workspace of the robot.
    Anywhere,
    /// Around the robot, beyond its reach.
    Around,
    /// In the middle of the workspace.
    Within,
    /// In the middle of the workspace, beside each other.
    InARow,
    /// No position: a direction that is nearly the base's z.
    Upward,
    /// At the target itself in another configuration.
    Before,
}

/// Generation of measurements.
#[derive(Clone, Copy)]
pub enum MeasurementOrigin {
    /// In any configuration, from the target's pose in the device's frame.
    Seen(fn(&Pose, &mut RandomDraws<'_>) -> Measurement),
    /// In configurations that fulfil a constraint: the constraint with its noise, and the recorded measurement.
    Touched(fn(&mut RandomDraws<'_>) -> [Measurement; 2]),
}

/// Random numbers of one measurement.
pub struct RandomDraws<'a> {
    /// The row.
    pub row: usize,
    /// Noise of lengths, metres: of a single one, the first.
    pub length: Vector3<f64>,
    /// Noise of a turn, radians.
    pub turn: Vector3<f64>,
    /// Zero of the device's readings, metres.
    pub zero_m: f64,
    /// Further noise of three lengths.
    pub lengths: &'a mut dyn FnMut() -> Vector3<f64>,
    /// A number between 0 and 1.
    pub uniform: &'a mut dyn FnMut() -> f64,
}

/// Kind of a session: measured quantities and stations.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_model::measurement::SessionKind;
/// # }
/// use poecal::SessionKind;
/// assert_eq!((SessionKind::POINT.word(), SessionKind::FLUSH.is_touched()), ("point", true));
/// ```
#[derive(Clone, Copy)]
pub struct SessionKind(&'static SessionTraits);

impl SessionKind {
    /// Kind of a session.
    pub(crate) const fn new(session: &'static SessionTraits) -> Self {
        SessionKind(session)
    }

    /// Session of the kind.
    #[must_use]
    pub fn session(self) -> &'static SessionTraits {
        self.0
    }

    /// The word used in files: `pose`, `point`, `mixed` and so on.
    #[must_use]
    pub fn word(self) -> &'static str {
        self.0.word
    }

    /// True if a device with a frame of its own measures.
    #[must_use]
    pub fn has_device(self) -> bool {
        self.0.stands == StationLayout::Anywhere
    }

    /// True if each measurement is of two configurations.
    #[must_use]
    pub fn is_paired(self) -> bool {
        self.0.stands == StationLayout::Before
    }

    /// True if it is a contact, so that a configuration fulfils a constraint.
    #[must_use]
    pub fn is_touched(self) -> bool {
        matches!(self.0.drawn, MeasurementOrigin::Touched(_))
    }

    /// True if its configurations can be chosen freely: those of contacts and of pairs cannot.
    #[must_use]
    pub fn is_chosen_freely(self) -> bool {
        !self.is_touched() && !self.is_paired()
    }

    /// Measured quantities.
    #[must_use]
    pub fn quantities(self) -> &'static [Quantity] {
        self.0.function.quantities
    }

    /// True if some rows at least measure a quantity.
    #[must_use]
    pub fn has(self, quantity: Quantity) -> bool {
        self.quantities().contains(&quantity)
    }

    /// True if some rows at least measure the orientation of the tip.
    #[must_use]
    pub fn sees_orientation(self) -> bool {
        self.0.function.sees_orientation()
    }
}

impl PartialEq for SessionKind {
    fn eq(&self, other: &Self) -> bool {
        self.word() == other.word()
    }
}

impl Eq for SessionKind {}

impl fmt::Debug for SessionKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.word())
    }
}
