//! Sessions that can be simulated and planned: what is measured, from where, and how numbers with noise come about.

use std::fmt;

use nalgebra::Vector3;

use super::{Function, Measurement, Quantity};
use poecal_arm::lie::Pose;

/// What is known of a kind of session.
pub struct Session {
    /// Its word.
    pub word: &'static str,
    /// The word of what will be measured, where a project can begin with it.
    pub plural: Option<&'static str>,
    /// What it is, in a few words.
    pub help: &'static str,
    /// What is measured.
    pub function: &'static Function,
    /// Names of the places from which it is measured.
    pub places: &'static [&'static str],
    /// Where these are.
    pub stands: Stands,
    /// How measurements come about.
    pub drawn: Draw,
    /// Columns of its numbers in a file, with their units.
    pub columns: &'static [&'static str],
    /// What they are, as comments of a file.
    pub about: &'static str,
}

/// Where the places of a session are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stands {
    /// One device that sees all that the robot does.
    Anywhere,
    /// Around the robot, beyond its reach.
    Around,
    /// In the middle of what it reaches.
    Within,
    /// Likewise, beside each other.
    InARow,
    /// Nowhere: a direction that is nearly the base's z.
    Upward,
    /// Where the target itself was in another configuration.
    Before,
}

/// How measurements come about.
#[derive(Clone, Copy)]
pub enum Draw {
    /// In any configuration, of the target's pose in the device's frame.
    Seen(fn(&Pose, &mut Drawn<'_>) -> Measurement),
    /// In configurations in which a constraint is fulfilled: the constraint with its noise, and what is said of it.
    Touched(fn(&mut Drawn<'_>) -> [Measurement; 2]),
}

/// Random numbers of one measurement.
pub struct Drawn<'a> {
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

/// Kind of a session: what is measured, and from where.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_model::measurement::Kind;
/// # }
/// use poecal::Kind;
/// assert_eq!((Kind::POINT.word(), Kind::FLUSH.is_touched()), ("point", true));
/// ```
#[derive(Clone, Copy)]
pub struct Kind(&'static Session);

impl Kind {
    /// Of a session.
    pub(crate) const fn new(session: &'static Session) -> Self {
        Kind(session)
    }

    /// What is known of it.
    #[must_use]
    pub fn session(self) -> &'static Session {
        self.0
    }

    /// The word used in files: `pose`, `point`, `mixed` and so on.
    #[must_use]
    pub fn word(self) -> &'static str {
        self.0.word
    }

    /// Whether a device with a frame of its own measures.
    #[must_use]
    pub fn has_device(self) -> bool {
        self.0.stands == Stands::Anywhere
    }

    /// Whether each measurement is of two configurations.
    #[must_use]
    pub fn is_paired(self) -> bool {
        self.0.stands == Stands::Before
    }

    /// Whether something is touched, so that a configuration fulfils a constraint.
    #[must_use]
    pub fn is_touched(self) -> bool {
        matches!(self.0.drawn, Draw::Touched(_))
    }

    /// Whether its configurations can be chosen freely: what is touched, or in pairs, is not.
    #[must_use]
    pub fn is_chosen_freely(self) -> bool {
        !self.is_touched() && !self.is_paired()
    }

    /// What it measures.
    #[must_use]
    pub fn quantities(self) -> &'static [Quantity] {
        self.0.function.quantities
    }

    /// Whether some rows at least measure a quantity.
    #[must_use]
    pub fn has(self, quantity: Quantity) -> bool {
        self.quantities().contains(&quantity)
    }

    /// Whether some rows at least measure the orientation of the tip.
    #[must_use]
    pub fn sees_orientation(self) -> bool {
        self.0.function.sees_orientation()
    }
}

impl PartialEq for Kind {
    fn eq(&self, other: &Self) -> bool {
        self.word() == other.word()
    }
}

impl Eq for Kind {}

impl fmt::Debug for Kind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.word())
    }
}
