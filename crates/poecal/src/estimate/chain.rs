//! The kinematic chain of one row in the device's axes.

use nalgebra::{Matrix3, Vector3};

use super::{Estimate, Packed, Sight};
use crate::lanes::FixedMotion;
use crate::lie::Pose;
use crate::robot::JointKind;

/// An estimate as frames relative to the frame before. A row's prediction `X T_n M Z` of theory.md §4 (13) is then a product of one fixed
/// pose and one elementary motion for each joint.
///
/// ```
/// # use nalgebra::Vector3;
/// # use poecal::{lie::{Pose, Screw}, robot::{Joint, Robot}};
/// use poecal::estimate::{Chain, Estimate, Linkage, Packed};
/// # let joint = Joint::revolute("a", Screw::revolute(&Vector3::y(), &Vector3::x()));
/// # let robot = Robot::new("r", vec![joint], Pose::from_translation(Vector3::new(0.3, 0.2, 0.1)))?;
/// let linkage = Linkage::new(&Estimate::new(&robot, vec![robot.home], Pose::identity()));
/// let mut chain = Chain::default();
/// chain.evaluate(&linkage, &Packed::new(&robot, &[0.7], 1), 0, 0);
/// assert!((chain.target.translation - robot.forward_kinematics(&[0.7]).translation).norm() < 1e-15);
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Linkage {
    kinds: Vec<JointKind>,
    /// `device_from_axis_1`, then `axis_(i-1)_from_axis_i`.
    steps: Vec<Pose>,
    /// `device_from_axis_1` of each further station.
    further_first: Vec<Pose>,
    /// Device frame of the first station in that of each further one.
    further_from_first: Vec<Pose>,
    /// `axis_n_from_target`.
    ends: Vec<Pose>,
    /// Joint offsets, if there are any: `(δ, cos δ, sin δ)`.
    offsets: Vec<(f64, f64, f64)>,
}

impl Linkage {
    /// The relative frames of an estimate: the factors of theory.md §4 (13) between two joints' motions, at zero joint values.
    #[must_use]
    pub fn new(estimate: &Estimate) -> Self {
        let Estimate {
            kinds,
            base_from_axis,
            joint_offset,
            base_from_target,
            device_from_base,
            further_devices,
        } = estimate;
        let mut axis_from_base = *device_from_base;
        let mut steps = Vec::with_capacity(base_from_axis.len());
        for &base_from_axis in base_from_axis {
            steps.push(axis_from_base * base_from_axis);
            axis_from_base = base_from_axis.inverse();
        }
        let first_axis = base_from_axis.first().copied().unwrap_or_else(Pose::identity);
        let further_first = further_devices.iter().map(|&device| device * first_axis).collect();
        let base_from_first = device_from_base.inverse();
        let further_from_first = further_devices.iter().map(|&device| device * base_from_first).collect();
        let ends = base_from_target.iter().map(|&target| axis_from_base * target).collect();
        let offsets = if estimate.has_offsets() {
            joint_offset.iter().map(|&offset| (offset, offset.cos(), offset.sin())).collect()
        } else {
            Vec::new()
        };
        Linkage { kinds: kinds.clone(), steps, further_first, further_from_first, ends, offsets }
    }

    /// `device_from_axis_1`, then `axis_(i-1)_from_axis_i`, at zero joint values.
    pub(crate) fn steps(&self) -> &[Pose] {
        &self.steps
    }

    /// `device_from_axis_1` of a further station; none for the first.
    pub(crate) fn first_step_from(&self, station: usize) -> Option<&Pose> {
        self.further_first.get(station.checked_sub(1)?)
    }

    /// Device frame of the first station in that of a further one; none for the first.
    pub(super) fn station_from_first(&self, station: usize) -> Option<&Pose> {
        self.further_from_first.get(station.checked_sub(1)?)
    }

    /// `axis_n_from_target`.
    pub(crate) fn end(&self, target: usize) -> &Pose {
        &self.ends[target]
    }

    /// Of each joint, whether it is revolute, and its relative frame.
    pub(super) fn turning_steps(&self) -> impl Iterator<Item = (bool, FixedMotion)> {
        let steps = self.kinds.iter().zip(&self.steps);
        steps.map(|(&kind, pose)| (kind == JointKind::Revolute, FixedMotion::from(pose)))
    }

    /// `(θ, cos θ or θ, sin θ or 0)` of a joint, offset included: `θ ← θ + δ` of theory.md §5 (26).
    pub(super) fn joint_value(&self, joint: usize, value: f64, packed: (f64, f64)) -> (f64, f64, f64) {
        let Some(&(offset, cosine, sine)) = self.offsets.get(joint) else {
            return (value, packed.0, packed.1);
        };
        match self.kinds[joint] {
            JointKind::Revolute => {
                let (c, s) = packed;
                (value + offset, c * cosine - s * sine, s * cosine + c * sine)
            }
            JointKind::Prismatic => (value + offset, packed.0 + offset, 0.0),
        }
    }
}

/// One joint in the device's axes, before its own motion: the axis frame's directions and origin (theory.md §5 (19)), and the joint value.
#[derive(Clone, Copy, Debug)]
pub struct JointView {
    /// Revolute or prismatic.
    pub kind: JointKind,
    /// x of the axis frame.
    pub x: Vector3<f64>,
    /// y of the axis frame.
    pub y: Vector3<f64>,
    /// z of the axis frame: the direction of the screw.
    pub z: Vector3<f64>,
    /// Origin of the axis frame, metres.
    pub origin: Vector3<f64>,
    /// Joint value θ, offset included: radians, whole turns counted, or metres.
    pub value: f64,
    /// cos θ (revolute) or θ in metres (prismatic).
    pub cosine_or_value: f64,
    /// sin θ (revolute) or 0 (prismatic).
    pub sine: f64,
}

/// A row's joints and target in the device's axes. Reused from row to row.
#[derive(Clone, Debug)]
pub struct Chain {
    /// The joints from base to tip.
    pub joints: Vec<JointView>,
    /// The last link's frame after all motions (the moved frame of the last axis).
    pub last: Pose,
    /// Predicted `device_from_target`.
    pub target: Pose,
    /// Station of the device, in whose axes all vectors are.
    pub station: usize,
}

impl Default for Chain {
    fn default() -> Self {
        Chain { joints: Vec::new(), last: Pose::identity(), target: Pose::identity(), station: 0 }
    }
}

impl Chain {
    /// Evaluates the chain of a row in the device's axes, metres and radians: `X T_{i-1} A_i` of each joint (theory.md §5 (19)) and the
    /// prediction of theory.md §4 (13). `seen` is an observation, or a target alone, as measured from the first station.
    pub fn evaluate(&mut self, linkage: &Linkage, packed: &Packed, row: usize, seen: impl Into<Sight>) {
        let Sight { station, target } = seen.into();
        self.joints.clear();
        self.station = station;
        let first = linkage.first_step_from(station);
        let mut moved = Pose::identity();
        let values = packed.joint_values(row);
        for (joint, ((step, &kind), &packed)) in
            linkage.steps.iter().zip(&linkage.kinds).zip(packed.row(row)).enumerate()
        {
            let (value, cosine_or_value, sine) = linkage.joint_value(joint, values[joint], packed);
            let frame = moved * *first.filter(|_| joint == 0).unwrap_or(step);
            let x = frame.rotation.column(0).into_owned();
            let y = frame.rotation.column(1).into_owned();
            let z = frame.rotation.column(2).into_owned();
            moved = match kind {
                JointKind::Revolute => Pose::new(
                    Matrix3::from_columns(&[
                        x * cosine_or_value + y * sine,
                        y * cosine_or_value - x * sine,
                        z,
                    ]),
                    frame.translation,
                ),
                JointKind::Prismatic => Pose::new(frame.rotation, frame.translation + z * cosine_or_value),
            };
            let origin = frame.translation;
            self.joints.push(JointView { kind, x, y, z, origin, value, cosine_or_value, sine });
        }
        self.last = moved;
        self.target = moved * linkage.ends[target];
    }
}
