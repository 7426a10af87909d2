//! Measurable functions of the pose of a target in the device's frame.

use std::fmt;

use nalgebra::Vector3;

use super::{Channels, Quantity};
use poecal_arm::lie::{Freedom, Pose};

/// Values of a measurement, metres and radians; those that its function does not need are zero. A pose needs all: its position, then the
/// columns of its rotation.
pub type MeasuredValues = [f64; 12];

/// Change of a predicted number by a motion of the target: by its translation, then by its rotation about its own origin, device axes.
pub type Sensitivity = [f64; 6];

/// A measured function: residual `e = measured ⊖ predicted` and sensitivity S of the *prediction*, with further properties. The prediction
/// moves by `S · twist` under a target twist (theory.md §4 (14) to (17)); neither is whitened. Its row in [`FUNCTIONS`](super::FUNCTIONS)
/// adds columns of files and simulated sessions; all other code uses these two.
pub struct MeasurementFunction {
    /// Name of a single measurement.
    pub name: &'static str,
    /// Name of several measurements.
    pub plural: &'static str,
    /// The quantities of its numbers.
    pub quantities: &'static [Quantity],
    /// The numbers of a measurement.
    pub channels: fn(&MeasuredValues) -> &'static Channels,
    /// Writes the residual for the predicted `device_from_target`, metres and radians.
    pub residual: fn(&MeasuredValues, &Pose, &mut [f64]),
    /// Writes the sensitivity of each predicted number.
    pub sensitivity: fn(&MeasuredValues, &Pose, &mut [Sensitivity]),
    /// True if the second derivative of `½ |e|²` along a target twist is that of the target's position and rotation, under the whitened
    /// residual as force and torque. It holds to first order in the residual (theory.md §6 (31a)). Without it the solver does not use the
    /// full Hessian.
    pub is_wrench: bool,
    /// Number of the values, the first ones, that are lengths that were read.
    pub lengths: usize,
    /// The same measurement with its angles times a factor, if angles were read.
    pub with_angles_times: Option<fn(&MeasuredValues, f64) -> MeasuredValues>,
    /// Form of the measurement in kernels.
    pub kernel: Kernel,
    /// Kind of the device.
    pub device: Device,
    /// True if the zero of the readings is an unknown of the device.
    pub zero_is_unknown: bool,
    /// Motions of the device that a measurement determines.
    pub device_freedom: fn(&MeasuredValues) -> Freedom,
    /// Motions of the target that a measurement determines.
    pub target_freedom: fn(&MeasuredValues) -> Freedom,
    /// Information of a single measurement, from which a fit starts in closed form.
    pub clue: fn(&MeasuredValues) -> InitialGuess,
}

impl MeasurementFunction {
    /// Usual properties: the whole frame of device and target is measured, kernels take the numbers unchanged, and there is no clue.
    pub(crate) const USUAL: MeasurementFunction = MeasurementFunction {
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
        clue: |_| InitialGuess::None,
    };

    /// True if it depends on the target's orientation, for some numbers at least.
    #[must_use]
    pub fn sees_orientation(&self) -> bool {
        (self.target_freedom)(&[0.0; 12]).turns()
    }

    /// Quantity of its first number.
    #[must_use]
    pub fn leading_quantity(&self) -> Quantity {
        self.quantities.first().copied().unwrap_or(Quantity::Position)
    }
}

static NO_CHANNELS: Channels = Channels::new(&[]);

impl PartialEq for MeasurementFunction {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

impl fmt::Debug for MeasurementFunction {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name)
    }
}

/// Form of a function's rows in kernels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kernel {
    /// A pose.
    Pose,
    /// Three numbers of a target's position, the first three values.
    Place,
    /// The first value, along the device's z.
    Height,
    /// The first value, from the device's origin.
    Distance,
    /// Residual and sensitivity of each row.
    Any,
}

/// Kind of a device. A station is called by it if all its rows agree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Device {
    /// An instrument with a frame of its own.
    Instrument,
    /// A point from which distances are measured.
    Anchor,
    /// The seat of a ball, or a fixed point.
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

    /// Word in files.
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

/// Information of a single measurement on its target and its device: for starts in closed form, and for all code that moves or plots
/// measured positions and orientations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InitialGuess {
    /// The target's frame in the device's.
    Frame(Pose),
    /// Components of the target's position in the device's frame, metres; `None` for those that were not measured.
    Place([Option<f64>; 3]),
    /// The target's distance from the device's origin, metres.
    Range(f64),
    /// The target is at the device's origin, except for this vector, metres; the device has no axes.
    Middle,
    /// A point of the target, metres in its axes, is at this height over the device's xy, metres; the device's z in the target's axes, if it
    /// is measured.
    Height {
        /// The point.
        point: Vector3<f64>,
        /// Height.
        height: f64,
        /// The direction.
        up: Option<Vector3<f64>>,
    },
    /// The device's z in the target's axes.
    Up(Vector3<f64>),
    /// No information of a single measurement.
    None,
}
