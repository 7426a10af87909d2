//! Parameters: groups of unknowns of a robot, its targets and the device. A parameter provides the motion of the target by each of its
//! unknowns, and depends on no measurement.
//!
//! A [`Parameter`] is a block with a name: the axis of a joint, a term of its value, a target, a frame (`block.rs` names blocks and their unknowns).
//! The covariance in `calibration.json` is by these names. Measured functions, weights and solver are elsewhere.

mod block;
mod clock_unknown;
mod columns;
mod device_frame;
mod other_screw;
mod range_unknown;
mod screw_axis;
mod target_frame;
mod target_place;
mod value_term;

pub use block::{Block, BlockNames};
pub use clock_unknown::ClockUnknown;
pub use columns::{Column, ParameterColumns, ParameterSubject, Wrench};
pub use device_frame::DeviceFrame;
pub use other_screw::{OtherScrew, ScrewModel};
pub use poecal_numerics::unit::Unit;
pub use range_unknown::RangeUnknown;
pub use screw_axis::ScrewAxis;
pub use target_frame::TargetFrame;
pub use target_place::TargetPlace;
pub use value_term::ValueTerm;

use poecal_model::robot::JointKind;

/// A group of unknowns. A list of parameters has the order of the chain: device frame, joints from base to tip, targets. A new parameter
/// is one file with [`ParameterColumns`] and one variant here; the compiler lists the places that have to decide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Parameter {
    /// A joint's screw in the minimal basis: a revolute axis (4 unknowns), or a prismatic direction (2).
    ScrewAxis(ScrewAxis),
    /// A joint's screw in a parameterisation that the caller supplies.
    OtherScrew(OtherScrew),
    /// Coefficient of a term of a joint's value, such as its offset (1).
    ValueTerm(ValueTerm),
    /// Position of a target point on the last link (3).
    TargetPlace(TargetPlace),
    /// Position and orientation of a target frame on the last link (6).
    TargetFrame(TargetFrame),
    /// Device frame: the base in the measuring device's frame (6).
    DeviceFrame(DeviceFrame),
    /// Zero or scale of an instrument's distances (1).
    RangeUnknown(RangeUnknown),
    /// Lag or drift of an instrument's clock (1).
    ClockUnknown(ClockUnknown),
}

/// The screws of joints of these kinds as unknowns, in the minimal basis: `ξ ← Ad_exp(η) ξ` without constraints or offsets (lou2009 (16)
/// to (18); theory.md §5 (18)).
#[must_use]
pub fn screw_axes(kinds: &[JointKind]) -> Vec<Parameter> {
    let axis = |(joint, &kind)| Parameter::ScrewAxis(ScrewAxis { joint, kind });
    kinds.iter().enumerate().map(axis).collect()
}

impl Parameter {
    /// Columns of this parameter.
    #[must_use]
    pub fn model(&self) -> &dyn ParameterColumns {
        match self {
            Parameter::ScrewAxis(axis) => axis,
            Parameter::OtherScrew(screw) => screw,
            Parameter::ValueTerm(term) => term,
            Parameter::TargetPlace(place) => place,
            Parameter::TargetFrame(frame) => frame,
            Parameter::DeviceFrame(frame) => frame,
            Parameter::RangeUnknown(range) => range,
            Parameter::ClockUnknown(clock) => clock,
        }
    }

    /// Term of a joint's value, if the parameter is one.
    pub fn value_term(&self) -> Option<&ValueTerm> {
        match self {
            Parameter::ValueTerm(term) => Some(term),
            Parameter::ScrewAxis(_)
            | Parameter::OtherScrew(_)
            | Parameter::TargetPlace(_)
            | Parameter::TargetFrame(_)
            | Parameter::DeviceFrame(_)
            | Parameter::RangeUnknown(_)
            | Parameter::ClockUnknown(_) => None,
        }
    }

    /// Screw axis, if the parameter is one.
    pub fn screw_axis(&self) -> Option<&ScrewAxis> {
        match self {
            Parameter::ScrewAxis(axis) => Some(axis),
            Parameter::OtherScrew(_)
            | Parameter::ValueTerm(_)
            | Parameter::TargetPlace(_)
            | Parameter::TargetFrame(_)
            | Parameter::DeviceFrame(_)
            | Parameter::RangeUnknown(_)
            | Parameter::ClockUnknown(_) => None,
        }
    }

    /// Target that a parameter moves, and its motions in the target's own axes: 0 to 2 are shifts, 3 to 5 turns.
    pub fn target_motions(&self) -> Option<(usize, &'static [usize])> {
        match self {
            Parameter::TargetPlace(place) => Some((place.target, &[0, 1, 2])),
            Parameter::TargetFrame(frame) => Some((frame.target, frame.freedom.motions())),
            Parameter::ScrewAxis(_)
            | Parameter::OtherScrew(_)
            | Parameter::ValueTerm(_)
            | Parameter::DeviceFrame(_)
            | Parameter::RangeUnknown(_)
            | Parameter::ClockUnknown(_) => None,
        }
    }
}
