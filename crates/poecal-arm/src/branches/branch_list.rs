//! Configurations that were found, without duplicates.

use core::f64::consts::TAU;

// The functions of numbers, where there is no standard library.
#[allow(unused_imports)]
use nalgebra::{ComplexField as _, RealField as _};

use crate::trig::wrap_angle;

/// Difference of all joints (rad) below which two configurations are one.
pub(super) const SAME: f64 = 1e-7;

/// Largest number of branches of an arm of six axes (primrose1986).
pub const MOST_BRANCHES: usize = 16;

/// Configurations with the tip at a pose, joint values (rad) in (-π, π]: those of [`AllBranches::branches_at`](super::AllBranches::branches_at).
///
/// ```
/// use nalgebra::Vector3;
/// use poecal_arm::{AllBranches, Arm, lie::{Pose, Screw}};
/// let axes = [Vector3::z(), Vector3::y(), Vector3::y(), Vector3::x(), Vector3::y(), Vector3::x()];
/// let points = [0.0, 0.0, 0.4, 0.4, 0.8, 0.8].map(|z| Vector3::new(0.0, 0.0, z));
/// let screws: Vec<Screw> = axes.iter().zip(&points).map(|(axis, point)| Screw::revolute(axis, point)).collect();
/// let arm = Arm::new(&screws, &Pose::from_translation(Vector3::new(0.1, 0.0, 0.8))).unwrap();
/// let far = Pose::from_translation(Vector3::new(9.0, 0.0, 0.0));
/// assert!(AllBranches::new(&arm).unwrap().branches_at(&far).as_slice().is_empty());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branches<const N: usize = 6> {
    pub(super) values: [[f64; N]; MOST_BRANCHES],
    pub(super) count: usize,
}

impl<const N: usize> Branches<N> {
    pub(super) const EMPTY: Self = Branches { values: [[0.0; N]; MOST_BRANCHES], count: 0 };

    /// The configurations.
    #[must_use]
    pub fn as_slice(&self) -> &[[f64; N]] {
        &self.values[..self.count]
    }

    /// Adds a configuration, unless it is there or there is no room.
    pub(super) fn add(&mut self, q: &[f64; N], same: f64) {
        if self.count < MOST_BRANCHES && !self.as_slice().iter().any(|other| largest_difference(q, other) < same) {
            self.values[self.count] = *q;
            self.count += 1;
        }
    }
}

/// Largest difference of a joint, rad.
pub(super) fn largest_difference<const N: usize>(one: &[f64; N], other: &[f64; N]) -> f64 {
    one.iter().zip(other).map(|(a, b)| wrap_angle(a - b).abs()).fold(0.0, f64::max)
}

/// A configuration turned by whole turns, nearest to `near` and within limits; `None` if there is none.
pub(super) fn unwind_turns<const N: usize>(
    branch: &[f64; N],
    near: &[f64; N],
    limits: &[(f64, f64)],
) -> Option<[f64; N]> {
    let mut q = *branch;
    for ((q, near), &(low, high)) in q.iter_mut().zip(near).zip(limits) {
        let turns = ((near - *q) / TAU).round();
        let turned = *q + turns * TAU;
        // Limits that are met except for rounding count as met.
        let least = ((low - SAME - turned) / TAU).ceil();
        let most = ((high + SAME - turned) / TAU).floor();
        if least > most {
            return None;
        }
        *q = turned + TAU * 0.0_f64.clamp(least, most);
    }
    Some(q)
}

/// Sorts configurations by the joint that has to move most.
pub(super) fn sort<const N: usize>(found: &mut Branches<N>, near: &[f64; N]) {
    let far = |q: &[f64; N]| q.iter().zip(near).map(|(q, near)| (q - near).abs()).fold(0.0, f64::max);
    found.values[..found.count].sort_unstable_by(|one, other| far(one).total_cmp(&far(other)));
}
