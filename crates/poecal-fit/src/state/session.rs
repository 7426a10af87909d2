//! Measurements of one robot, as all steps of a calibration read them.

use super::unknowns::USUAL;
use super::{PackedValues, Unknowns, radian_m};
use poecal_model::measurement::{ByQuantity, Dataset, Noise, Observation};
use poecal_model::robot::{JointKind, Robot};
use poecal_numerics::unit::Unit;

/// A robot and its measurements: the input of every fit, and of every judgement of a fit.
#[derive(Clone, Copy, Debug)]
pub struct Session<'a> {
    /// Nominal robot; for the judgement of a finished calibration, the calibrated one.
    pub robot: &'a Robot,
    /// Measurements, in the frames of the device.
    pub data: &'a Dataset,
    /// Joint values of the measurements with sines and cosines, one row for each.
    pub packed: &'a PackedValues,
    /// Metres that a radian counts, the L of theory.md §6.
    pub length_m: f64,
    /// True if the device frame is unknown; otherwise it stays as it is.
    pub device_free: bool,
    /// Noise of each instrument in units of the first one's; empty if all are alike.
    pub noise_ratios: &'a [Noise],
    /// Unknowns of a fit.
    pub unknowns: &'a Unknowns,
}

impl<'a> Session<'a> {
    /// A session in which a radian counts a third of the reach ([`radian_m`]).
    #[must_use]
    pub fn new(robot: &'a Robot, data: &'a Dataset, packed: &'a PackedValues, device_free: bool) -> Self {
        let length_m = radian_m(robot, packed);
        Session { robot, data, packed, length_m, device_free, noise_ratios: &[], unknowns: &USUAL }
    }

    /// The same with these unknowns.
    #[must_use]
    pub fn with_unknowns(self, unknowns: &'a Unknowns) -> Self {
        Session { unknowns, ..self }
    }

    /// True if the base frame is a choice: the device frame is unknown, and nothing is held in the base.
    #[must_use]
    pub fn base_free(&self) -> bool {
        self.device_free && self.unknowns.base_is_free()
    }

    /// Station whose frame is no unknown: the first of the rows if the base frame is a choice, or if the device's is known.
    pub fn held_station(&self, rows: &[u32]) -> Option<usize> {
        (!self.device_free || self.base_free()).then(|| self.data.first_station(rows))
    }

    /// The same with another length that a radian counts, metres.
    #[must_use]
    pub fn with_length(self, length_m: f64) -> Self {
        Session { length_m, ..self }
    }

    /// The same with these noises of the instruments, in units of the first one's.
    #[must_use]
    pub fn with_noise_ratios(self, noise_ratios: &'a [Noise]) -> Self {
        Session { noise_ratios, ..self }
    }

    /// True if no measurement of these rows has a length, so that the size of the robot is not determined. Held blocks have a size of their
    /// own.
    pub fn lacks_length(&self, rows: &[u32]) -> bool {
        let seen = |row: &u32| self.observation(*row).measurement;
        let has_length = |row: &u32| seen(row).has_length();
        let is_place = |row: &u32| seen(row).channels().iter().any(|it| it.quantity.unit() == Unit::Metre);
        let bends = |joint: usize| self.robot.joints.get(joint).is_some_and(|it| it.give_of.is_some());
        let slides = || self.robot.joints.iter().any(|joint| joint.kind == JointKind::Prismatic);
        !rows.iter().any(has_length)
            && rows.iter().any(is_place)
            && self.data.lengths.is_empty()
            && self.unknowns.held_axes.iter().filter(|&&joint| !bends(joint)).count() < 2
            && !slides()
    }

    /// Noise of an instrument's rows that state none, where `usual` is that of the first instrument.
    pub fn usual_noise(&self, station: usize, usual: Noise) -> Noise {
        match self.noise_ratios.get(station) {
            Some(ratio) => ByQuantity::from_fn(|quantity| usual[quantity] * ratio[quantity]),
            None => usual,
        }
    }

    /// Noise of a row: the stated one, else that of its instrument.
    pub fn noise_of(&self, observation: &Observation, usual: Noise) -> Noise {
        observation.noise_or(self.usual_noise(observation.station, usual))
    }

    /// Squares of a row's residual (m², rad²) in units of its variances.
    pub fn whiten_squares(&self, observation: &Observation, squares: ByQuantity<f64>, usual: Noise) -> ByQuantity<f64> {
        let noise = self.noise_of(observation, usual);
        ByQuantity::from_fn(|quantity| squares[quantity] / (noise[quantity] * noise[quantity]))
    }

    /// The observation of a row.
    pub fn observation(&self, row: u32) -> &'a Observation {
        &self.data.observations[row as usize]
    }
}
