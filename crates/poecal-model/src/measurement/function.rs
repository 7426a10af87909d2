//! What can be measured: functions of the pose of a target in the device's frame.

use std::fmt;

use nalgebra::Vector3;

use super::{Channels, Quantity};
use poecal_arm::lie::{Freedom, Pose};

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
    pub(crate) const USUAL: Function = Function {
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
