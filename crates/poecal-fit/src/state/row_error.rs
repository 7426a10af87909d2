//! Error of one row.

use nalgebra::{Matrix3, Vector3};

use poecal_arm::lie::Pose;
use poecal_model::measurement::{ByQuantity, Channel, Channels, Measurement, NUMBERS, NoiseShape, Quantity};
use poecal_numerics::unit::Unit;

/// Error of one row: measured minus predicted, in the device's axes; `y - p` and `log(Y Rᵀ)` of theory.md §4 (16). One number for each
/// channel of the measurement, metres and radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowError {
    channels: &'static Channels,
    values: [f64; NUMBERS],
}

impl RowError {
    /// Error of a measurement and the predicted `device_from_target`.
    #[must_use]
    pub fn new(seen: &Measurement, predicted: &Pose) -> Self {
        let mut values = [0.0; NUMBERS];
        seen.residual(predicted, &mut values);
        RowError { channels: seen.channels(), values }
    }

    /// Error of a measurement with these numbers.
    pub(crate) fn from_values(seen: &Measurement, values: [f64; NUMBERS]) -> Self {
        RowError { channels: seen.channels(), values }
    }

    /// Error of a measured position, metres.
    #[must_use]
    pub fn of_position(error: Vector3<f64>) -> Self {
        let seen = Measurement::point(error);
        RowError::new(&seen, &Pose::identity())
    }

    /// This error plus `times` its change to another one of the same row.
    pub(crate) fn interpolate(&self, other: &RowError, times: f64) -> Self {
        let mut values = self.values;
        values.iter_mut().zip(other.values).for_each(|(value, other)| *value += times * (other - *value));
        RowError { channels: self.channels, values }
    }

    /// Numbers with their channels.
    pub fn numbers(&self) -> impl Iterator<Item = (&'static Channel, f64)> {
        self.channels.iter().zip(self.values)
    }

    /// Number of values.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.channels.len()
    }

    /// Numbers of one quantity; empty if it was not measured.
    #[must_use]
    #[inline]
    pub fn part(&self, quantity: Quantity) -> &[f64] {
        &self.values[self.channels.range(quantity)]
    }

    /// Length of the error of one quantity, metres or radians, if it was measured.
    #[must_use]
    pub fn length(&self, quantity: Quantity) -> Option<f64> {
        let part = self.part(quantity);
        (!part.is_empty()).then(|| squared_norm(part).sqrt())
    }

    /// Squared length of the error of one quantity, 0 if it was not measured.
    #[must_use]
    pub fn square(&self, quantity: Quantity) -> f64 {
        squared_norm(self.part(quantity))
    }

    /// Squared length of the error of each quantity, and its number of values.
    pub(crate) fn squares(&self) -> ByQuantity<(f64, usize)> {
        ByQuantity::from_fn(|quantity| {
            let part = self.part(quantity);
            (part.iter().map(|value| value * value).sum(), part.len())
        })
    }

    /// Components of a quantity as a vector, zero where one was not measured and beyond those that it has.
    #[must_use]
    pub fn vector(&self, quantity: Quantity) -> Vector3<f64> {
        let mut vector = Vector3::zeros();
        self.channels.components(quantity).for_each(|(k, component)| vector[component] = self.values[k]);
        vector
    }

    /// For each component of a quantity, true if it was measured.
    pub fn measured_components(&self, quantity: Quantity) -> [bool; Quantity::MOST_COMPONENTS] {
        let mut found = [false; Quantity::MOST_COMPONENTS];
        self.channels.components(quantity).for_each(|(_, component)| found[component] = true);
        found
    }

    /// Error of a measured position, metres; zero if none was measured.
    #[must_use]
    pub fn position_m(&self) -> Vector3<f64> {
        self.vector(Quantity::Position)
    }

    /// Error of a measured orientation, a rotation vector in radians.
    #[must_use]
    pub fn rotation_rad(&self) -> Option<Vector3<f64>> {
        self.channels.has(Quantity::Rotation).then(|| self.vector(Quantity::Rotation))
    }

    /// First quantity, by which rows of one kind are compared.
    #[must_use]
    pub fn leading_quantity(&self) -> Option<Quantity> {
        self.channels.first().map(|channel| channel.quantity)
    }

    /// Error of the first quantity as a vector, zero beyond its components.
    #[must_use]
    pub fn lead(&self) -> Vector3<f64> {
        self.leading_quantity().map_or_else(Vector3::zeros, |quantity| self.vector(quantity))
    }

    /// Error of all numbers that are lengths, metres: of the position, of a distance.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.square_m2().sqrt()
    }

    /// Square of the error of all numbers that are lengths, square metres.
    pub(crate) fn square_m2(&self) -> f64 {
        self.square_of(Unit::Metre)
    }

    /// Square of the error of all numbers that are angles, such as the rotation's, square radians.
    pub(crate) fn square_rad2(&self) -> f64 {
        self.square_of(Unit::Radian)
    }

    /// True if a number is an angle.
    pub(crate) fn has_angle(&self) -> bool {
        let is_angle = |quantity: Quantity| quantity.unit() == Unit::Radian && self.channels.has(quantity);
        Quantity::ALL.into_iter().any(is_angle)
    }

    /// Error of all numbers that are lengths but no position, metres: of a distance, a contact, a height.
    pub fn constraint_m(&self) -> Option<f64> {
        let is_own = |quantity: &Quantity| quantity.unit() == Unit::Metre && !quantity.is_of_pose();
        let own = Quantity::ALL.into_iter().filter(is_own).filter(|quantity| self.channels.has(*quantity));
        own.map(|quantity| self.square(quantity)).reduce(|a, b| a + b).map(f64::sqrt)
    }

    /// The same error with noise of its position that is the same in all directions.
    pub(crate) fn whiten(mut self, shape: &NoiseShape) -> Self {
        shape.whiten(self.channels, self.values.as_chunks_mut::<1>().0);
        self
    }

    fn square_of(&self, unit: Unit) -> f64 {
        let own = Quantity::ALL.into_iter().filter(|quantity| quantity.unit() == unit);
        own.map(|quantity| self.square(quantity)).sum()
    }

    /// The same error in other axes, turned by a rotation; a quantity that is no vector stays.
    pub(crate) fn rotate(mut self, turn: &Matrix3<f64>) -> Self {
        for quantity in Quantity::ALL {
            if let [x, y, z] = &mut self.values[self.channels.range(quantity)] {
                let turned = turn * Vector3::new(*x, *y, *z);
                (*x, *y, *z) = (turned.x, turned.y, turned.z);
            }
        }
        self
    }
}

fn squared_norm(part: &[f64]) -> f64 {
    match *part {
        // The order of nalgebra's norm.
        [x, y, z] => Vector3::new(x, y, z).norm_squared(),
        _ => part.iter().map(|value| value * value).sum(),
    }
}

/// Root mean square of all errors that are lengths, metres: theory.md §9. 0 without errors.
pub fn rms_m(errors: &[RowError]) -> f64 {
    let squares: f64 = errors.iter().map(RowError::square_m2).sum();
    (squares / errors.len().max(1) as f64).sqrt()
}
