//! What is measured, as a function of the pose of a target in the device's frame and the numbers that were read.

use std::fmt;

use nalgebra::{Matrix3, Vector3};

use super::{Channels, Quantity};
use crate::lie::{Freedom, Pose, rotation};

/// The numbers that a function needs of a measurement, metres and radians; zero where it needs fewer. A pose is the one that needs all: its
/// place, then the columns of its rotation.
pub type Values = [f64; 12];

/// Change of a predicted number by a motion of the target: by its translation, then by its rotation about its own origin, device axes.
pub type Sensitivity = [f64; 6];

/// A function that is measured: residual `e = measured ⊖ predicted` and sensitivity S of the *prediction*, which moves by `S · twist` under a
/// target twist (theory.md §4 (14) to (17)), neither of them whitened; and what else must be known of it. Its row in
/// [`FUNCTIONS`](super::FUNCTIONS) adds columns of files and simulated sessions; everything else asks these two.
pub struct Function {
    /// Its name: what one of them is.
    pub name: &'static str,
    /// What several of them are.
    pub plural: &'static str,
    /// The quantities of its numbers.
    pub quantities: &'static [Quantity],
    /// The numbers of a measurement.
    pub channels: fn(&Values) -> &'static Channels,
    /// Writes the residual for the predicted `device_from_target`, metres and radians.
    pub residual: fn(&Values, &Pose, &mut [f64]),
    /// Writes the sensitivity of each predicted number.
    pub sensitivity: fn(&Values, &Pose, &mut [Sensitivity]),
    /// Whether the second derivative of `½ |e|²` along a target twist is that of the target's place and turn, under the whitened residual as
    /// force and torque, to first order in the residual (theory.md §6 (31a)). Without it the solver does not use the full Hessian.
    pub is_wrench: bool,
    /// How many of the values, the first ones, are lengths that were read.
    pub lengths: usize,
    /// The same measurement with its angles times a factor, where these are what was read.
    pub with_angles_times: Option<fn(&Values, f64) -> Values>,
    /// The form in which kernels take it.
    pub kernel: Kernel,
    /// What the device is.
    pub device: Device,
    /// Whether the zero of the readings is an unknown of the device.
    pub zero_is_unknown: bool,
    /// The motions of the device that a measurement shows.
    pub device_freedom: fn(&Values) -> Freedom,
    /// The motions of the target that a measurement shows.
    pub target_freedom: fn(&Values) -> Freedom,
    /// What a measurement says by itself, from which a fit starts in closed form.
    pub clue: fn(&Values) -> Clue,
}

impl Function {
    /// What most have: a device and a target of which the whole frame is seen, numbers that kernels take as they come, and no clue.
    pub(super) const USUAL: Function = Function {
        name: "",
        plural: "",
        quantities: &[],
        channels: |_| &NO_CHANNELS,
        residual: |_, _, _| {},
        sensitivity: |_, _, _| {},
        is_wrench: false,
        lengths: 0,
        with_angles_times: None,
        kernel: Kernel::Any,
        device: Device::Instrument,
        zero_is_unknown: false,
        device_freedom: |_| Freedom::FRAME,
        target_freedom: |_| Freedom::PLACE,
        clue: |_| Clue::None,
    };

    /// Whether it depends on the target's orientation, at some numbers at least.
    #[must_use]
    pub fn sees_orientation(&self) -> bool {
        (self.target_freedom)(&[0.0; 12]).turns()
    }

    /// The quantity of its first number.
    #[must_use]
    pub fn leading(&self) -> Quantity {
        self.quantities.first().copied().unwrap_or(Quantity::Position)
    }
}

static NO_CHANNELS: Channels = Channels::new(&[]);

impl PartialEq for Function {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

impl fmt::Debug for Function {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name)
    }
}

/// The form in which kernels take a function's rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kernel {
    /// A pose.
    Pose,
    /// Three numbers of a target's place, the first three values.
    Place,
    /// The first value, along the device's z.
    Height,
    /// The first value, from the device's origin.
    Distance,
    /// Residual and sensitivity of each row.
    Any,
}

/// What a device is. A station of which all rows say the same is called so.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Device {
    /// Something with a frame of its own.
    Instrument,
    /// A place from which distances are measured.
    Anchor,
    /// Where a ball rests, or a fixed point.
    Socket,
    /// A plane, the device's xy.
    Plane,
    /// A ball that is touched.
    Sphere,
    /// A direction, the device's z.
    Direction,
    /// The target in another configuration.
    Pair,
}

impl Device {
    /// All of them.
    pub const ALL: [Device; 7] = [
        Device::Instrument,
        Device::Anchor,
        Device::Socket,
        Device::Plane,
        Device::Sphere,
        Device::Direction,
        Device::Pair,
    ];

    /// Its word in files.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Device::Instrument => "instrument",
            Device::Anchor => "anchor",
            Device::Socket => "socket",
            Device::Plane => "plane",
            Device::Sphere => "sphere",
            Device::Direction => "direction",
            Device::Pair => "pair",
        }
    }
}

/// What a measurement says by itself of its target and its device: for starts in closed form, and for all that moves or draws measured
/// places and orientations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Clue {
    /// The target's frame in the device's.
    Frame(Pose),
    /// Components of the target's place in the device's frame, metres; none of those that were not measured.
    Place([Option<f64>; 3]),
    /// The target's distance from the device's origin, metres.
    Range(f64),
    /// The target is at the device's origin, but for this, metres; the device has no axes.
    Middle,
    /// A point of the target, metres in its axes, is at this height over the device's xy, metres; the device's z in the target's axes, if it
    /// is seen.
    Height {
        /// The point.
        point: Vector3<f64>,
        /// Its height.
        height: f64,
        /// The direction.
        up: Option<Vector3<f64>>,
    },
    /// The device's z in the target's axes.
    Up(Vector3<f64>),
    /// Nothing by itself.
    None,
}

/// One measurement of a target in the measuring device's frame: a function and its numbers. What it shows depends on the predicted pose of the
/// target alone, not on joints or parameters.
///
/// ```
/// use nalgebra::Vector3;
/// use poecal::measurement::Measurement;
/// let seen = Measurement::point(Vector3::new(1.0, 2.0, 3.0));
/// assert_eq!((seen.dim(), seen.function().name), (3, "point"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    function: &'static Function,
    values: Values,
}

impl Measurement {
    /// Of a function, with its first numbers.
    pub(super) fn new(function: &'static Function, first: &[f64]) -> Self {
        let mut values = [0.0; 12];
        values.iter_mut().zip(first).for_each(|(value, first)| *value = *first);
        Measurement { function, values }
    }

    /// What was measured.
    #[must_use]
    #[inline]
    pub fn function(&self) -> &'static Function {
        self.function
    }

    /// Its numbers.
    #[must_use]
    #[inline]
    pub fn values(&self) -> &Values {
        &self.values
    }

    /// Its numbers, to change them.
    #[inline]
    pub fn values_mut(&mut self) -> &mut Values {
        &mut self.values
    }

    /// The same numbers of another function.
    pub(crate) fn of(self, function: &'static Function) -> Self {
        Measurement { function, ..self }
    }

    /// The numbers that are compared with predicted ones.
    #[must_use]
    #[inline]
    pub fn channels(&self) -> &'static Channels {
        (self.function.channels)(&self.values)
    }

    /// How many of them there are.
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

    /// The motions of the device that it shows.
    #[must_use]
    #[inline]
    pub fn device_freedom(&self) -> Freedom {
        (self.function.device_freedom)(&self.values)
    }

    /// The motions of the target that it shows.
    #[must_use]
    #[inline]
    pub fn target_freedom(&self) -> Freedom {
        (self.function.target_freedom)(&self.values)
    }

    /// Whether it depends on the target's orientation, so that the target is a frame and not only a point.
    #[must_use]
    #[inline]
    pub fn sees_orientation(&self) -> bool {
        self.target_freedom().turns()
    }

    /// Whether a number of this quantity was measured.
    #[must_use]
    #[inline]
    pub fn has(&self, quantity: Quantity) -> bool {
        self.channels().has(quantity)
    }

    /// What it says by itself.
    #[must_use]
    #[inline]
    pub fn clue(&self) -> Clue {
        (self.function.clue)(&self.values)
    }

    /// Measured components of the position, metres, device frame; none of those that were not measured.
    #[must_use]
    pub fn position_components(&self) -> [Option<f64>; 3] {
        match self.clue() {
            Clue::Frame(pose) => [0, 1, 2].map(|k| Some(pose.translation[k])),
            Clue::Place(components) => components,
            Clue::Range(_) | Clue::Middle | Clue::Height { .. } | Clue::Up(_) | Clue::None => [None; 3],
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
            Clue::Frame(pose) => Some(pose),
            Clue::Place(_)
            | Clue::Range(_)
            | Clue::Middle
            | Clue::Height { .. }
            | Clue::Up(_)
            | Clue::None => None,
        }
    }

    /// Measured `device_from_target` rotation, if it was measured.
    #[must_use]
    pub fn orientation(&self) -> Option<Matrix3<f64>> {
        self.frame().map(|pose| pose.rotation)
    }

    /// The measured `device_from_target`, with the identity for what was not measured.
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.frame().unwrap_or_else(|| self.position().map_or_else(Pose::identity, Pose::from_translation))
    }

    /// Measured distance of the target from the device's origin, metres, if that is what was measured.
    #[must_use]
    pub fn range(&self) -> Option<f64> {
        match self.clue() {
            Clue::Range(distance) => Some(distance),
            Clue::Frame(_)
            | Clue::Place(_)
            | Clue::Middle
            | Clue::Height { .. }
            | Clue::Up(_)
            | Clue::None => None,
        }
    }

    /// Lengths that were read, metres.
    #[must_use]
    pub fn lengths(&self) -> &[f64] {
        self.values.get(..self.function.lengths).unwrap_or_default()
    }

    /// Whether what it measures has a length, by which the size of the robot shows: a place, or a length other than zero.
    #[must_use]
    pub fn has_length(&self) -> bool {
        self.has(Quantity::Position) || self.lengths().iter().any(|length| *length != 0.0)
    }

    /// Whether it has a length of this quantity, which its first numbers are of.
    #[must_use]
    pub(crate) fn has_length_of(&self, quantity: Quantity) -> bool {
        self.function.leading() == quantity && self.has_length()
    }

    /// The lengths that were read, to change them.
    pub(crate) fn lengths_mut(&mut self) -> &mut [f64] {
        self.values.get_mut(..self.function.lengths).unwrap_or_default()
    }

    /// The same with the angles that were read times a factor; as it is where none were.
    #[must_use]
    pub fn with_angles_times(self, factor: f64) -> Self {
        let values = self.function.with_angles_times.map_or(self.values, |times| times(&self.values, factor));
        Measurement { values, ..self }
    }

    /// What the device is.
    #[must_use]
    pub fn device(&self) -> Device {
        let is_sphere = self.function.zero_is_unknown && self.range() == Some(0.0);
        if is_sphere { Device::Sphere } else { self.function.device }
    }

    /// How far apart two measurements of the same numbers are: metres, and radians of orientations. `None` of different ones.
    #[must_use]
    pub fn apart(&self, other: &Measurement) -> Option<(f64, f64)> {
        let angle = |a: Vector3<f64>, b: Vector3<f64>| a.cross(&b).norm().atan2(a.dot(&b));
        let metres = || {
            let both = self.lengths().iter().zip(other.lengths());
            Vector3::from_iterator(both.map(|(a, b)| a - b).chain([0.0; 3])).norm()
        };
        let turned = match (self.clue(), other.clue()) {
            (Clue::Frame(a), Clue::Frame(b)) => rotation::log(&(a.rotation * b.rotation.transpose())).norm(),
            (Clue::Up(a), Clue::Up(b))
            | (Clue::Height { up: Some(a), .. }, Clue::Height { up: Some(b), .. }) => angle(a, b),
            _ => 0.0,
        };
        let are_places = self.position().is_some() && other.position().is_some();
        let are_alike = self.channels().as_ptr() == other.channels().as_ptr();
        (are_places || are_alike).then(|| (metres(), turned))
    }

    /// Whether all numbers are finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.values.iter().all(|number| number.is_finite())
    }
}
