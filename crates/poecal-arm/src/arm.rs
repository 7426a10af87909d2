//! An arm: joints with their screws in a row, and its forward kinematics.

use alloc::vec::Vec;

use nalgebra::{Matrix3, Vector3};

use crate::lie::{Pose, Screw, rotation};
use crate::trig::cosine_and_sine;

/// Most joints of an arm, so that nothing is allocated where it is computed with.
pub const MOST_JOINTS: usize = 16;

/// A serial arm, `base_from_tip(q) = exp(ξ₁q₁) … exp(ξₙqₙ) M` (lou2009 (2)).
///
/// ```
/// use nalgebra::Vector3;
/// use poecal_arm::{Arm, lie::{Pose, Screw}};
/// let shoulder = Screw::revolute(&Vector3::z(), &Vector3::zeros());
/// let elbow = Screw::revolute(&Vector3::z(), &Vector3::x());
/// let arm = Arm::new(&[shoulder, elbow], &Pose::from_translation(2.0 * Vector3::x())).unwrap();
/// let tip = arm.forward_kinematics(&[0.0, core::f64::consts::FRAC_PI_2]);
/// assert!((tip.translation - Vector3::new(1.0, 1.0, 0.0)).norm() < 1e-15);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Arm {
    screws: Vec<Screw>,
    home: Pose,
    /// Frame of each joint, its axis along z, in that of the joint before (of the first, in the base), at zero.
    frames: Vec<Pose>,
    /// The tip in the frame of the last joint.
    tip: Pose,
    reach_m: f64,
}

/// Where an arm is: axes of its joints and its tip, in the base.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    pub(crate) directions: [Vector3<f64>; MOST_JOINTS],
    pub(crate) origins: [Vector3<f64>; MOST_JOINTS],
    pub(crate) tip: Pose,
}

impl Arm {
    /// The arm of these screws (base frame, at zero) and the pose of its tip there; `None` of no joint, of more than [`MOST_JOINTS`], or of
    /// numbers that are not finite.
    #[must_use]
    pub fn new(screws: &[Screw], home: &Pose) -> Option<Self> {
        let is_finite = |screw: &Screw| screw.v().iter().chain(screw.w().iter()).all(|it| it.is_finite());
        let is_home = home.rotation.iter().chain(home.translation.iter()).all(|it| it.is_finite());
        if screws.is_empty() || screws.len() > MOST_JOINTS || !screws.iter().all(is_finite) || !is_home {
            return None;
        }
        let mut frames = Vec::with_capacity(screws.len());
        let mut base_from_joint = Pose::identity();
        let mut reach_m = 0.0;
        for screw in screws {
            let origin = if screw.is_prismatic() {
                base_from_joint.translation
            } else {
                screw.nearest_point(&base_from_joint.translation)
            };
            if !frames.is_empty() {
                reach_m += (origin - base_from_joint.translation).norm();
            }
            let frame = Pose::new(along(&screw.direction()), origin);
            frames.push(base_from_joint.inverse() * frame);
            base_from_joint = frame;
        }
        reach_m += (home.translation - base_from_joint.translation).norm();
        let tip = base_from_joint.inverse() * *home;
        Some(Arm { screws: screws.to_vec(), home: *home, frames, tip, reach_m: reach_m.max(1e-3) })
    }

    /// Number of joints.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.frames.len()
    }

    /// Screws of the joints in the base, at zero.
    #[must_use]
    pub fn screws(&self) -> &[Screw] {
        &self.screws
    }

    /// The tip in the base, at zero.
    #[must_use]
    pub fn home(&self) -> &Pose {
        &self.home
    }

    /// Length of the path from the first axis over all axes to the tip, metres: lengths are compared with it.
    #[must_use]
    pub fn reach_m(&self) -> f64 {
        self.reach_m
    }

    /// `base_from_tip` at joint values (rad, m); values that are not given are 0.
    #[must_use]
    pub fn forward_kinematics(&self, q: &[f64]) -> Pose {
        self.placed(q).tip
    }

    /// Axes and tip at joint values.
    #[inline]
    pub(crate) fn placed(&self, q: &[f64]) -> Placed {
        let mut out = Placed {
            directions: [Vector3::zeros(); MOST_JOINTS],
            origins: [Vector3::zeros(); MOST_JOINTS],
            tip: Pose::identity(),
        };
        let (mut turned, mut at) = (Matrix3::identity(), Vector3::zeros());
        for (index, (frame, screw)) in self.frames.iter().zip(&self.screws).enumerate() {
            let value = q.get(index).copied().unwrap_or(0.0);
            at += turned * frame.translation;
            turned *= frame.rotation;
            let axis = turned.column(2).into_owned();
            out.directions[index] = axis;
            out.origins[index] = at;
            if screw.is_prismatic() {
                at += axis * value;
            } else {
                let (c, s) = cosine_and_sine(value);
                let (x, y) = (turned.column(0).into_owned(), turned.column(1).into_owned());
                turned.set_column(0, &(x * c + y * s));
                turned.set_column(1, &(y * c - x * s));
            }
        }
        out.tip = Pose::new(turned * self.tip.rotation, at + turned * self.tip.translation);
        out
    }
}

/// A rotation whose third column is a direction.
fn along(direction: &Vector3<f64>) -> Matrix3<f64> {
    let x = rotation::perpendicular(direction).normalize();
    Matrix3::from_columns(&[x, direction.cross(&x), *direction])
}

impl Arm {
    /// The smallest singular value of the Jacobian at joint values, lengths over [`Arm::reach_m`]: 0 at singularities.
    ///
    /// ```
    /// use nalgebra::Vector3;
    /// use poecal_arm::{Arm, lie::{Pose, Screw}};
    /// let arm = Arm::new(&[Screw::revolute(&Vector3::z(), &Vector3::zeros())], &Pose::identity()).unwrap();
    /// assert!(arm.smallest_singular_value(&[0.0]) < 1e-12);
    /// ```
    #[must_use]
    pub fn smallest_singular_value(&self, q: &[f64]) -> f64 {
        let placed = self.placed(q);
        let mut a = nalgebra::Matrix6::<f64>::zeros();
        for (index, screw) in self.screws.iter().enumerate() {
            let (axis, zero) = (placed.directions[index], Vector3::zeros());
            let (v, w) = if screw.is_prismatic() {
                (axis, zero)
            } else {
                (axis.cross(&(placed.tip.translation - placed.origins[index])) / self.reach_m, axis)
            };
            let column = nalgebra::Vector6::new(v.x, v.y, v.z, w.x, w.y, w.z);
            a += column * column.transpose();
        }
        nalgebra::ComplexField::sqrt(a.symmetric_eigenvalues().min().max(0.0))
    }
}
