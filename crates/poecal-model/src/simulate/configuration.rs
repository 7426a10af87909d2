//! Random configurations of a robot.

use rand_chacha::ChaCha8Rng;

use super::random;
use crate::robot::{JointKind, JointLimits, ReadingKind, Robot};

/// Configurations of a robot: the range of each reading (±π and ±0.5 m without limits; for a factor its reference).
///
/// ```
/// # mod poecal {
/// #     pub use poecal_model::simulate;
/// # }
/// use poecal::simulate::{Configurations, elbow};
/// use rand_core::SeedableRng;
/// let mut generator = rand_chacha::ChaCha8Rng::seed_from_u64(1);
/// let readings = Configurations::new(&elbow()).random(&mut generator);
/// assert!(readings.len() == 6 && readings[4].to_degrees() >= -40.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Configurations {
    /// SessionKind, least and greatest value of each reading.
    readings: Vec<(ReadingKind, f64, f64)>,
}

impl Configurations {
    /// Configurations of a robot, readings in the order of [`Robot::reading_names`].
    #[must_use]
    pub fn new(robot: &Robot) -> Self {
        Configurations { readings: robot.reading_names().iter().map(|name| range(robot, name)).collect() }
    }

    /// A random configuration with every joint within its limits, in steps of 0.0001° and 0.001 mm, as on the displays of controllers.
    pub fn random(&self, generator: &mut ChaCha8Rng) -> Vec<f64> {
        let one = |range: &(ReadingKind, f64, f64)| {
            let (_, lower, upper) = *range;
            round_to_step(range, lower + (upper - lower).max(0.0) * random::uniform_number(generator))
        };
        self.readings.iter().map(one).collect()
    }

    /// The same configurations with ranges that keep a distance from both ends, as far as there is room: revolute joints in radians and
    /// prismatic ones in metres.
    #[must_use]
    pub fn shrink_ranges(mut self, margin: [f64; 2]) -> Self {
        for (kind, lower, upper) in &mut self.readings {
            let by = match kind {
                ReadingKind::Angle => margin[0],
                ReadingKind::Length => margin[1],
                ReadingKind::Factor => 0.0,
            };
            let by = by.min(0.5 * (*upper - *lower)).max(0.0);
            (*lower, *upper) = (*lower + by, *upper - by);
        }
        self
    }

    /// Usual distance from the limits at which controllers do not stop yet: 2°, 5 mm.
    pub const MARGIN: [f64; 2] = [2.0 * std::f64::consts::PI / 180.0, 5e-3];

    /// The same configurations with the usual margin and within a turn: those that a robot is asked to reach.
    #[must_use]
    pub fn to_measure(self) -> Self {
        self.shrink_ranges(Self::MARGIN).within_a_turn()
    }

    /// The same configurations with readings of revolute joints within one turn, about zero as far as the range allows: further turns are
    /// the same poses.
    #[must_use]
    pub fn within_a_turn(mut self) -> Self {
        let half = std::f64::consts::PI;
        for (kind, lower, upper) in &mut self.readings {
            if *kind == ReadingKind::Angle && *upper - *lower > 2.0 * half {
                let middle = 0.0_f64.clamp(*lower + half, *upper - half);
                (*lower, *upper) = (middle - half, middle + half);
            }
        }
        self
    }

    /// Configuration within the ranges that is nearest to one, in steps as those of [`Configurations::random`].
    #[must_use]
    pub fn nearest_to(&self, readings: &[f64]) -> Vec<f64> {
        let one = |(range, reading): (&(ReadingKind, f64, f64), &f64)| {
            let &(kind, lower, upper) = range;
            let found = round_to_step(range, reading.min(upper).max(lower));
            // At a limit that is no step, it is the step before it.
            let step = if kind == ReadingKind::Angle { 1e-4_f64.to_radians() } else { 1e-6 };
            let inside = found.min(upper - step).max(lower + step);
            if kind == ReadingKind::Factor || upper - lower < 2.0 * step { found } else { round_to_step(range, inside) }
        };
        self.readings.iter().zip(readings).map(one).collect()
    }

    /// True if all readings are within their ranges.
    #[must_use]
    pub fn contain(&self, readings: &[f64]) -> bool {
        let within =
            |(&(_, lower, upper), reading): (&(ReadingKind, f64, f64), &f64)| (lower..=upper).contains(reading);
        self.readings.len() == readings.len() && self.readings.iter().zip(readings).all(within)
    }
}

/// A value within a range in steps of 0.0001° and 0.001 mm, if a step is within it.
fn round_to_step(&(kind, lower, upper): &(ReadingKind, f64, f64), value: f64) -> f64 {
    let stepped = match kind {
        ReadingKind::Angle => ((value.to_degrees() * 1e4).round() / 1e4).to_radians(),
        ReadingKind::Length => (value * 1e6).round() / 1e3 / 1e3,
        ReadingKind::Factor => value,
    };
    if (lower..=upper).contains(&stepped) { stepped } else { value }
}

/// Range of a reading within the limits of all joints that follow it.
fn range(robot: &Robot, name: &str) -> (ReadingKind, f64, f64) {
    let (mut lower, mut upper) = (f64::NEG_INFINITY, f64::INFINITY);
    let kind = robot.reading_kind(name);
    for joint in robot.joints.iter().filter(|joint| joint.reading.name == name) {
        if let Some(limits) = joint.limits
            && joint.reading.multiplier != 0.0
            && (joint.kind == JointKind::Revolute || limits.upper - limits.lower < JointLimits::PLACEHOLDER_M)
        {
            let at = |value: f64| (value - joint.reading.offset) / joint.reading.multiplier;
            let (a, b) = (at(limits.lower), at(limits.upper));
            lower = lower.max(a.min(b));
            upper = upper.min(a.max(b));
        }
    }
    let span = match kind {
        ReadingKind::Angle => std::f64::consts::PI,
        ReadingKind::Length => 0.5,
        ReadingKind::Factor => 0.0,
    };
    let reference = robot.factors.iter().find(|factor| factor.name == name).map(|factor| factor.reference);
    if let Some(reference) = reference {
        return (kind, reference, reference);
    }
    let lower = if lower.is_finite() { lower } else { -span };
    let upper = if upper.is_finite() { upper } else { span };
    (kind, lower, upper)
}

/// Readings of one random configuration: [`Configurations::random`].
pub fn random_configuration(robot: &Robot, generator: &mut ChaCha8Rng) -> Vec<f64> {
    Configurations::new(robot).random(generator)
}
