//! Newton's iteration from a configuration to one with the tip at its goal.

use nalgebra::Vector3;

use crate::arm::Arm;
use crate::arm_state::{ArmState, MOST_JOINTS};
use crate::lie::{Pose, rotation};
use crate::small_systems;

// The functions of numbers, where there is no standard library.
#[allow(unused_imports)]
use nalgebra::{ComplexField as _, RealField as _};

/// Residual (lengths over reach, rad) below which a further step changes rounding only.
const ROUNDED: f64 = 4e-15;
/// The same limit for an arm whose joint values are more than their readings. Without the share of the weights in the Jacobian, each
/// step leaves some thousandths of the residual, and further ones are not worth their time.
const SMALL: f64 = 2e-13;
/// Residual that counts as reached.
pub(crate) const REACHED: f64 = 2e-11;
/// Longest step of a joint (rad; m over reach) that is taken in full.
const LONGEST_STEP: f64 = 0.5;

/// Remainder from the tip to its goal: position (m) and rotation vector (rad), both in the base.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TipResidual {
    pub(crate) position: Vector3<f64>,
    pub(crate) rotation: Vector3<f64>,
}

impl TipResidual {
    #[inline]
    pub(crate) fn new(tip: &Pose, target: &Pose) -> Self {
        let column = |k: usize| tip.rotation.column(k).cross(&target.rotation.column(k));
        let sine = 0.5 * (column(0) + column(1) + column(2));
        let trace: f64 = tip.rotation.component_mul(&target.rotation).sum();
        let rotation = if trace > 1.0 {
            // Below a right angle it is the sin φ of the direction, as an angle.
            let squared = sine.norm_squared();
            if squared < 1e-6 { sine * (1.0 + squared / 6.0) } else { angle_of(sine, squared) }
        } else {
            rotation::log(&(target.rotation * tip.rotation.transpose()))
        };
        TipResidual { position: target.translation - tip.translation, rotation }
    }

    /// Square of the remainder, lengths over a reach, whose inverse is passed.
    #[inline]
    pub(crate) fn squared_norm(&self, inverse_reach: f64) -> f64 {
        self.position.norm_squared() * (inverse_reach * inverse_reach) + self.rotation.norm_squared()
    }
}

fn angle_of(sine: Vector3<f64>, squared: f64) -> Vector3<f64> {
    let norm = squared.sqrt();
    sine * (norm.min(1.0).asin() / norm)
}

/// Six joints of an arm that has six, or seven with one held.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SixJoints<'a> {
    arm: &'a Arm,
    /// Index of the held joint, and its reading.
    held: Option<(usize, f64)>,
}

impl<'a> SixJoints<'a> {
    /// All joints of an arm of six.
    pub(crate) fn from_arm(arm: &'a Arm) -> Self {
        SixJoints { arm, held: None }
    }

    /// Six joints of an arm of seven, without the held one.
    pub(crate) fn with_held_joint(arm: &'a Arm, joint: usize, reading: f64) -> Self {
        SixJoints { arm, held: Some((joint, reading)) }
    }

    /// Readings including that of the held joint.
    pub(crate) fn all(q: &[f64; 6], (joint, reading): (usize, f64)) -> [f64; 7] {
        core::array::from_fn(|k| match k.cmp(&joint) {
            core::cmp::Ordering::Less => q[k],
            core::cmp::Ordering::Equal => reading,
            core::cmp::Ordering::Greater => q[k - 1],
        })
    }

    /// Index among all joints.
    fn index(&self, joint: usize) -> usize {
        joint + usize::from(self.held.is_some_and(|(held, _)| joint >= held))
    }

    pub(crate) fn reach_m(&self) -> f64 {
        self.arm.reach_m()
    }

    pub(crate) fn is_rigid(&self) -> bool {
        self.arm.is_rigid()
    }

    fn slides(&self, joint: usize) -> bool {
        self.arm.screws()[self.index(joint)].is_prismatic()
    }

    pub(crate) fn tip(&self, q: &[f64; 6]) -> Pose {
        self.placement(q).tip
    }

    #[inline]
    fn placement(&self, q: &[f64; 6]) -> ArmState<6> {
        let Some(held) = self.held else { return self.arm.placed_at(q) };
        let all = self.arm.placed_at(&Self::all(q, held));
        let of = |vectors: &[Vector3<f64>; 7]| core::array::from_fn(|joint| vectors[self.index(joint)]);
        ArmState { v: of(&all.v), w: of(&all.w), tip: all.tip }
    }
}

/// Column of a joint: motion of the tip's point (over the reach) and its rotation.
#[inline]
fn column<const N: usize>(arm: &Arm, placed: &ArmState<N>, joint: usize, inverse_reach: f64) -> [f64; 6] {
    let (mut v, w) = placed.column(joint);
    // A step of a prismatic joint is counted in reaches, so that it is of the size of an angle.
    if !arm.screws()[joint].is_prismatic() {
        v *= inverse_reach;
    }
    [v.x, v.y, v.z, w.x, w.y, w.z]
}

/// Columns of six joints: motion of the tip's point (over the reach) and its rotation.
#[inline(always)]
fn columns_of_six(arm: &SixJoints<'_>, placed: &ArmState<6>, inverse_reach: f64) -> [(Vector3<f64>, Vector3<f64>); 6] {
    let of = |joint: usize| {
        let (v, w) = placed.column(joint);
        // A step of a prismatic joint is counted in reaches, so that it is of the size of an angle.
        (if arm.slides(joint) { v } else { v * inverse_reach }, w)
    };
    [of(0), of(1), of(2), of(3), of(4), of(5)]
}

/// Step of six joints that removes the remainder, to first order.
#[inline]
fn step_of_six(arm: &SixJoints<'_>, placed: &ArmState<6>, left: &TipResidual, inverse_reach: f64) -> Option<[f64; 6]> {
    let p = left.position * inverse_reach;
    let columns = columns_of_six(arm, placed, inverse_reach);
    if let Some(step) = small_systems::solve_halves(&columns, (p, left.rotation), 1e-4) {
        return Some(step);
    }
    let mut a = [[0.0; 6]; 6];
    for (joint, (v, w)) in columns.iter().enumerate() {
        for (row, it) in a.iter_mut().zip([v.x, v.y, v.z, w.x, w.y, w.z]) {
            row[joint] = it;
        }
    }
    let w = left.rotation;
    let mut step = [p.x, p.y, p.z, w.x, w.y, w.z];
    small_systems::solve(&mut a, &mut step, 1e-14)?;
    Some(step)
}

/// Undamped steps of six joints, as long as they bring the tip closer. `q` becomes the best configuration that was met;
/// returns its remainder (lengths over reach, rad).
pub(crate) fn newton(arm: &SixJoints<'_>, target: &Pose, q: &mut [f64; 6], most: u32) -> f64 {
    newton_judged(arm, target, q, most).0
}

/// The same steps, with the ratio of the second step to the first; 1 if the first was too long to be taken. If another configuration is as near
/// to the reached one as the start was, this is about 1 (kantorovich1948).
pub(crate) fn newton_judged(arm: &SixJoints<'_>, target: &Pose, q: &mut [f64; 6], most: u32) -> (f64, f64) {
    let (mut first, mut ratio) = (0.0, 0.0_f64);
    let reach = arm.reach_m();
    let inverse_reach = 1.0 / reach;
    let mut placed = arm.placement(q);
    let mut left = TipResidual::new(&placed.tip, target);
    let mut squared = left.squared_norm(inverse_reach);
    let enough = if arm.is_rigid() { ROUNDED } else { SMALL };
    let mut steps = 0;
    while steps < most && squared > enough * enough {
        let Some(step) = step_of_six(arm, &placed, &left, inverse_reach) else { break };
        let longest = step.iter().fold(0.0_f64, |most, it| most.max(it.abs()));
        match steps {
            0 => (first, ratio) = (longest, if longest > LONGEST_STEP { 1.0 } else { 0.0 }),
            1 => ratio = ratio.max(longest / first),
            _ => {}
        }
        let mut share = if longest > LONGEST_STEP { LONGEST_STEP / longest } else { 1.0 };
        let mut is_closer = false;
        for _ in 0..4 {
            let mut next = *q;
            for (joint, (it, step)) in next.iter_mut().zip(step).enumerate() {
                *it += share * step * if arm.slides(joint) { reach } else { 1.0 };
            }
            let there = arm.placement(&next);
            let left_there = TipResidual::new(&there.tip, target);
            let squared_there = left_there.squared_norm(inverse_reach);
            if squared_there < squared {
                (*q, placed, left, squared) = (next, there, left_there, squared_there);
                is_closer = true;
                break;
            }
            share *= 0.4;
        }
        steps += 1;
        if !is_closer {
            break;
        }
    }
    (squared.sqrt(), ratio)
}

/// Damped steps (Levenberg-Marquardt) of any number of joints, the least motion that brings the tip closer;
/// returns the remainder.
pub(crate) fn solve_damped(arm: &Arm, target: &Pose, q: &mut [f64], most: u32) -> f64 {
    let reach = arm.reach_m();
    let n = arm.joints().min(q.len());
    let mut placed = arm.placement(q);
    let mut left = TipResidual::new(&placed.tip, target);
    let mut squared = left.squared_norm(1.0 / reach);
    let mut damping = 1e-4 * squared.min(1.0);
    let mut steps = 0;
    let enough = if arm.is_rigid() { ROUNDED } else { SMALL };
    while steps < most && squared > enough * enough {
        steps += 1;
        let mut columns = [[0.0; 6]; MOST_JOINTS];
        for (joint, it) in columns.iter_mut().enumerate().take(n) {
            *it = column(arm, &placed, joint, 1.0 / reach);
        }
        let (p, w) = (left.position / reach, left.rotation);
        let e = [p.x, p.y, p.z, w.x, w.y, w.z];
        let Some(step) = damped_step(&columns, e, n, damping) else {
            damping = (damping * 10.0).max(1e-12);
            continue;
        };
        let longest = step.iter().fold(0.0_f64, |most, it| most.max(it.abs()));
        let share = if longest > LONGEST_STEP { LONGEST_STEP / longest } else { 1.0 };
        let mut next = [0.0; MOST_JOINTS];
        for (joint, (it, old)) in next.iter_mut().zip(q.iter()).enumerate().take(n) {
            let unit = if arm.screws()[joint].is_prismatic() { reach } else { 1.0 };
            *it = old + share * step[joint] * unit;
        }
        let there = arm.placement(&next[..n]);
        let left_there = TipResidual::new(&there.tip, target);
        let squared_there = left_there.squared_norm(1.0 / reach);
        if squared_there < squared {
            q[..n].copy_from_slice(&next[..n]);
            damping = (damping * if squared_there < 0.25 * squared { 0.01 } else { 0.3 }).max(1e-18);
            (placed, left, squared) = (there, left_there, squared_there);
        } else {
            if longest < 1e-15 {
                break;
            }
            damping = (damping * 8.0).max(1e-16);
            if damping > 1e6 {
                break;
            }
        }
    }
    squared.sqrt()
}

/// A damped step of `n` joints by their columns, the least motion that removes the remainder; `None` if it cannot be computed.
#[inline]
fn damped_step(columns: &[[f64; 6]; MOST_JOINTS], e: [f64; 6], n: usize, damping: f64) -> Option<[f64; MOST_JOINTS]> {
    let mut step = [0.0; MOST_JOINTS];
    let is_solved = if n >= 6 {
        // Jᵀ (J Jᵀ + λ)⁻¹ e: the least of all steps with the same effect.
        let mut a = [[0.0; 6]; 6];
        for (i, row) in a.iter_mut().enumerate() {
            for (j, it) in row.iter_mut().enumerate() {
                *it = columns.iter().take(n).map(|column| column[i] * column[j]).sum();
            }
            row[i] += damping;
        }
        let mut x = e;
        let is_solved = small_systems::solve_symmetric(&mut a, &mut x, 6).is_some();
        for (it, column) in step.iter_mut().zip(columns).take(n) {
            *it = column.iter().zip(x).map(|(column, x)| column * x).sum();
        }
        is_solved
    } else {
        let mut a = [[0.0; MOST_JOINTS]; MOST_JOINTS];
        for i in 0..n {
            for j in 0..n {
                a[i][j] = columns[i].iter().zip(&columns[j]).map(|(one, other)| one * other).sum();
            }
            a[i][i] += damping;
            step[i] = columns[i].iter().zip(e).map(|(column, e)| column * e).sum();
        }
        small_systems::solve_symmetric(&mut a, &mut step, n).is_some()
    };
    is_solved.then_some(step)
}

/// Largest number of steps of each kind to the nearest configuration.
const MOST_STEPS: u32 = 30;
const MOST_DAMPED: u32 = 200;

impl Arm {
    /// Changes joint values (rad, m) to the nearest configuration with the tip at a pose of the base, or as close to it as the iteration
    /// comes. Steps are undamped; if they fail, they are damped (Levenberg-Marquardt, the least motion of more than six joints). Returns
    /// the remainder: the length over [`Arm::reach_m`] and the angle (rad), as one root of squares; some 1e-15 if the pose is reached.
    ///
    /// ```
    /// use nalgebra::Vector3;
    /// use poecal_arm::{Arm, lie::{Pose, Screw}};
    /// let axes = [Vector3::z(), Vector3::y(), Vector3::y(), Vector3::x(), Vector3::y(), Vector3::x(), Vector3::y()];
    /// let points = [0.0, 0.0, 0.4, 0.4, 0.8, 0.8, 0.9].map(|z| Vector3::new(0.0, 0.0, z));
    /// let screws: Vec<Screw> = axes.iter().zip(&points).map(|(axis, point)| Screw::revolute(axis, point)).collect();
    /// let arm = Arm::new(&screws, &Pose::from_translation(Vector3::new(0.1, 0.0, 1.0))).unwrap();
    /// let target = arm.forward_kinematics(&[0.3, 0.2, 0.4, 0.5, 0.6, 0.7, 0.2]);
    /// let mut q = [0.2; 7];
    /// assert!(arm.solve_nearest(&target, &mut q) < 1e-12);
    /// ```
    pub fn solve_nearest(&self, target: &Pose, q: &mut [f64]) -> f64 {
        if let Ok(six) = <&mut [f64; 6]>::try_from(&mut *q)
            && self.joints() == 6
        {
            let mut undamped = *six;
            let left = newton(&SixJoints::from_arm(self), target, &mut undamped, MOST_STEPS);
            if left < REACHED {
                *six = undamped;
                return left;
            }
        }
        solve_damped(self, target, q, MOST_DAMPED)
    }
}
