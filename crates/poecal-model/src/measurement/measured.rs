//! A measurement: a function and the numbers that were read.

use nalgebra::{Matrix3, Vector3};

use super::{Channels, Device, InitialGuess, MeasuredValues, MeasurementFunction, Quantity, Sensitivity};
use poecal_arm::lie::{Freedom, Pose, rotation};

/// One measurement of a target in the measuring device's frame: a function and its numbers. Its prediction depends on the predicted pose of
/// the target alone, not on joints or parameters.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_model::measurement::Measurement;
/// # }
/// use poecal::Measurement;
/// use nalgebra::Vector3;
/// let seen = Measurement::point(Vector3::new(1.0, 2.0, 3.0));
/// assert_eq!((seen.dim(), seen.function().name), (3, "point"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    function: &'static MeasurementFunction,
    values: MeasuredValues,
}

impl Measurement {
    /// Measurement of a function, with its first numbers.
    pub(crate) fn new(function: &'static MeasurementFunction, first: &[f64]) -> Self {
        let mut values = [0.0; 12];
        values.iter_mut().zip(first).for_each(|(value, first)| *value = *first);
        Measurement { function, values }
    }

    /// Function that was measured.
    #[must_use]
    #[inline]
    pub fn function(&self) -> &'static MeasurementFunction {
        self.function
    }

    /// Numbers.
    #[must_use]
    #[inline]
    pub fn values(&self) -> &MeasuredValues {
        &self.values
    }

    /// Numbers, mutable.
    #[inline]
    pub fn values_mut(&mut self) -> &mut MeasuredValues {
        &mut self.values
    }

    /// The same numbers of another function.
    pub(crate) fn with_function(self, function: &'static MeasurementFunction) -> Self {
        Measurement { function, ..self }
    }

    /// Numbers that are compared with predicted ones.
    #[must_use]
    #[inline]
    pub fn channels(&self) -> &'static Channels {
        (self.function.channels)(&self.values)
    }

    /// Number of these.
    #[must_use]
    #[inline]
    pub fn dim(&self) -> usize {
        self.channels().len()
    }

    /// Writes the residual for the predicted `device_from_target`, metres and radians.
    #[inline]
    pub fn residual(&self, predicted: &Pose, out: &mut [f64]) {
        (self.function.residual)(&self.values, predicted, out);
    }

    /// Writes the sensitivity of each predicted number.
    #[inline]
    pub fn sensitivity(&self, predicted: &Pose, out: &mut [Sensitivity]) {
        (self.function.sensitivity)(&self.values, predicted, out);
    }

    /// Motions of the device that it determines.
    #[must_use]
    #[inline]
    pub fn device_freedom(&self) -> Freedom {
        (self.function.device_freedom)(&self.values)
    }

    /// Motions of the target that it determines.
    #[must_use]
    #[inline]
    pub fn target_freedom(&self) -> Freedom {
        (self.function.target_freedom)(&self.values)
    }

    /// True if it depends on the target's orientation, so that the target is a frame and not only a point.
    #[must_use]
    #[inline]
    pub fn sees_orientation(&self) -> bool {
        self.target_freedom().turns()
    }

    /// True if a number of this quantity was measured.
    #[must_use]
    #[inline]
    pub fn has(&self, quantity: Quantity) -> bool {
        self.channels().has(quantity)
    }

    /// Information of this measurement alone.
    #[must_use]
    #[inline]
    pub fn clue(&self) -> InitialGuess {
        (self.function.clue)(&self.values)
    }

    /// Measured components of the position, metres, device frame; `None` for those that were not measured.
    #[must_use]
    pub fn position_components(&self) -> [Option<f64>; 3] {
        match self.clue() {
            InitialGuess::Frame(pose) => [0, 1, 2].map(|k| Some(pose.translation[k])),
            InitialGuess::Place(components) => components,
            InitialGuess::Range(_)
            | InitialGuess::Middle
            | InitialGuess::Height { .. }
            | InitialGuess::Up(_)
            | InitialGuess::None => [None; 3],
        }
    }

    /// Measured position, metres, device frame, if all of it was measured.
    #[must_use]
    pub fn position(&self) -> Option<Vector3<f64>> {
        match self.position_components() {
            [Some(x), Some(y), Some(z)] => Some(Vector3::new(x, y, z)),
            _ => None,
        }
    }

    /// Measured `device_from_target`, if all of it was measured.
    #[must_use]
    pub fn frame(&self) -> Option<Pose> {
        match self.clue() {
            InitialGuess::Frame(pose) => Some(pose),
            InitialGuess::Place(_)
            | InitialGuess::Range(_)
            | InitialGuess::Middle
            | InitialGuess::Height { .. }
            | InitialGuess::Up(_)
            | InitialGuess::None => None,
        }
    }

    /// Measured `device_from_target` rotation, if it was measured.
    #[must_use]
    pub fn orientation(&self) -> Option<Matrix3<f64>> {
        self.frame().map(|pose| pose.rotation)
    }

    /// Measured `device_from_target`, with the identity for parts that were not measured.
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.frame().unwrap_or_else(|| self.position().map_or_else(Pose::identity, Pose::from_translation))
    }

    /// Measured distance of the target from the device's origin, metres, if it is a distance.
    #[must_use]
    pub fn range(&self) -> Option<f64> {
        match self.clue() {
            InitialGuess::Range(distance) => Some(distance),
            InitialGuess::Frame(_)
            | InitialGuess::Place(_)
            | InitialGuess::Middle
            | InitialGuess::Height { .. }
            | InitialGuess::Up(_)
            | InitialGuess::None => None,
        }
    }

    /// Lengths that were read, metres.
    #[must_use]
    pub fn lengths(&self) -> &[f64] {
        self.values.get(..self.function.lengths).unwrap_or_default()
    }

    /// True if a measured quantity has a length, which determines the size of the robot: a position, or a length other than zero.
    #[must_use]
    pub fn has_length(&self) -> bool {
        self.has(Quantity::Position) || self.lengths().iter().any(|length| *length != 0.0)
    }

    /// True if it has a length of this quantity, which its first numbers are of.
    #[must_use]
    pub fn has_length_of(&self, quantity: Quantity) -> bool {
        self.function.leading_quantity() == quantity && self.has_length()
    }

    /// Lengths that were read, mutable.
    pub fn lengths_mut(&mut self) -> &mut [f64] {
        self.values.get_mut(..self.function.lengths).unwrap_or_default()
    }

    /// The same measurement with the angles that were read times a factor; unchanged if there were none.
    #[must_use]
    pub fn with_angles_times(self, factor: f64) -> Self {
        let values = self.function.with_angles_times.map_or(self.values, |times| times(&self.values, factor));
        Measurement { values, ..self }
    }

    /// Kind of the device.
    #[must_use]
    pub fn device(&self) -> Device {
        let is_sphere = self.function.zero_is_unknown && self.range() == Some(0.0);
        if is_sphere { Device::Sphere } else { self.function.device }
    }

    /// Difference of two measurements of the same numbers: metres, and radians of orientations. `None` if their functions differ.
    #[must_use]
    pub fn distance_and_angle(&self, other: &Measurement) -> Option<(f64, f64)> {
        let angle = |a: Vector3<f64>, b: Vector3<f64>| a.cross(&b).norm().atan2(a.dot(&b));
        let metres = || {
            let both = self.lengths().iter().zip(other.lengths());
            Vector3::from_iterator(both.map(|(a, b)| a - b).chain([0.0; 3])).norm()
        };
        let turned = match (self.clue(), other.clue()) {
            (InitialGuess::Frame(a), InitialGuess::Frame(b)) => {
                rotation::log(&(a.rotation * b.rotation.transpose())).norm()
            }
            (InitialGuess::Up(a), InitialGuess::Up(b))
            | (InitialGuess::Height { up: Some(a), .. }, InitialGuess::Height { up: Some(b), .. }) => angle(a, b),
            _ => 0.0,
        };
        let are_places = self.position().is_some() && other.position().is_some();
        let are_alike = self.channels().as_ptr() == other.channels().as_ptr();
        (are_places || are_alike).then(|| (metres(), turned))
    }

    /// True if all numbers are finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.values.iter().all(|number| number.is_finite())
    }
}
