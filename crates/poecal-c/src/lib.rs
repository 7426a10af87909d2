//! The kinematics of [`poecal_arm`] for C: an arm is made of numbers (`poecal export CALIBRATION --format c`), then computes without
//! threads, files or allocation. Poses are 16 numbers, the rows of a 4 × 4 matrix; lengths are metres, angles radians.
//!
//! Every function accepts null pointers (and then only reports them); other pointers have to be valid, which C cannot guarantee: this is the meaning
//! of `unsafe` here, and its only use.
//!
//! For programs in C and controllers, as a part of poecal; a test compares the header, which cbindgen writes. `bare.rs` replaces the standard library
//! on targets without one. This crate has no computation of its own.

#![cfg_attr(not(feature = "std"), no_std)]

extern crate alloc;

#[cfg(not(feature = "std"))]
mod bare;

use alloc::boxed::Box;
use core::slice;

use nalgebra::{Matrix3, Vector3};
use poecal_arm::lie::{Pose, rotation};
use poecal_arm::{AllBranches, Arm, CorrectionOutcome, MaxCorrection, ReadingCorrections};

/// Most readings of an arm.
pub const POECAL_MOST_JOINTS: usize = 16;
/// Most branches of an arm of six joints.
pub const POECAL_MOST_BRANCHES: usize = 16;

/// An arm.
pub struct PoecalArm {
    arm: Arm,
    branches: Option<AllBranches>,
}

/// Remainder of an inverse: 0 for a reached pose.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoecalLeft {
    /// Distance, metres.
    pub position_m: f64,
    /// Angle, radians.
    pub rotation_rad: f64,
}

/// The tip is at the intended pose.
pub const POECAL_REACHED: i32 = 0;
/// The tip's point is at the intended position, but its orientation is not, near a singularity.
pub const POECAL_TURNED: i32 = 1;
/// The tip is as near as an arm of fewer than six joints can reach.
pub const POECAL_NEAREST: i32 = 2;
/// The arm does not reach the pose: the readings are the intended ones.
pub const POECAL_OUT_OF_REACH: i32 = 3;
/// A joint would have to move too far: the readings are the intended ones.
pub const POECAL_TOO_FAR: i32 = 4;

/// Corrections of readings.
pub struct PoecalCorrections {
    corrections: ReadingCorrections,
}

/// Outcome of a correction of readings.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoecalCorrected {
    /// Remaining distance, metres.
    pub position_m: f64,
    /// Remaining angle, radians.
    pub rotation_rad: f64,
    /// `POECAL_REACHED` and the following; -1 for null.
    pub outcome: i32,
}

const NOTHING: PoecalLeft = PoecalLeft { position_m: f64::NAN, rotation_rad: f64::NAN };

/// The arm of these numbers; null if they describe none. Allocates; takes some milliseconds for an arm of six joints.
///
/// # Safety
/// `numbers` is null or points to `count` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn poecal_arm_new(numbers: *const f64, count: usize) -> *mut PoecalArm {
    if numbers.is_null() {
        return core::ptr::null_mut();
    }
    // SAFETY: by the contract above.
    let numbers = unsafe { slice::from_raw_parts(numbers, count) };
    let Some(arm) = Arm::from_numbers(numbers) else { return core::ptr::null_mut() };
    let branches = AllBranches::new(&arm);
    Box::into_raw(Box::new(PoecalArm { arm, branches }))
}

/// Frees an arm.
///
/// # Safety
/// `arm` is null or was made by `poecal_arm_new`, and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn poecal_arm_free(arm: *mut PoecalArm) {
    if !arm.is_null() {
        // SAFETY: by the contract above.
        drop(unsafe { Box::from_raw(arm) });
    }
}

/// Number of readings; 0 for null.
///
/// # Safety
/// `arm` is null or was made by `poecal_arm_new`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn poecal_joints(arm: *const PoecalArm) -> usize {
    // SAFETY: by the contract above.
    unsafe { arm.as_ref() }.map_or(0, |it| it.arm.joints())
}

/// The pose of the tip at readings; returns 0, or -1 for null.
///
/// # Safety
/// `arm` is null or was made by `poecal_arm_new`; `q` is null or points to `poecal_joints(arm)` numbers, `pose` to 16.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn poecal_forward(arm: *const PoecalArm, q: *const f64, pose: *mut f64) -> i32 {
    // SAFETY: by the contract above.
    let Some(arm) = (unsafe { arm.as_ref() }) else { return -1 };
    if q.is_null() || pose.is_null() {
        return -1;
    }
    // SAFETY: by the contract above.
    let (q, pose) = unsafe { (slice::from_raw_parts(q, arm.arm.joints()), slice::from_raw_parts_mut(pose, 16)) };
    let tip = arm.arm.forward_kinematics(q);
    for row in 0..3 {
        for column in 0..3 {
            pose[4 * row + column] = tip.rotation[(row, column)];
        }
        pose[4 * row + 3] = tip.translation[row];
    }
    pose[12..].copy_from_slice(&[0.0, 0.0, 0.0, 1.0]);
    0
}

/// Jacobian of the tip, six numbers for each reading: motion of its point (x, y, z), and its turn, in the base; returns 0, or -1 for null.
///
/// # Safety
/// As `poecal_forward`; `jacobian` is null or points to 6 times `poecal_joints(arm)` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn poecal_jacobian(arm: *const PoecalArm, q: *const f64, jacobian: *mut f64) -> i32 {
    // SAFETY: by the contract above.
    let Some(arm) = (unsafe { arm.as_ref() }) else { return -1 };
    if q.is_null() || jacobian.is_null() {
        return -1;
    }
    let joints = arm.arm.joints();
    // SAFETY: by the contract above.
    let (q, out) = unsafe { (slice::from_raw_parts(q, joints), slice::from_raw_parts_mut(jacobian, 6 * joints)) };
    for (out, (v, w)) in out.chunks_exact_mut(6).zip(arm.arm.jacobian(q)) {
        out.copy_from_slice(&[v.x, v.y, v.z, w.x, w.y, w.z]);
    }
    0
}

/// Moves readings to the nearest configuration that has the tip at a pose, or as close to it as possible; returns the remainder, NaN for null.
///
/// # Safety
/// As `poecal_forward`; `pose` is null or points to 16 numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn poecal_nearest(arm: *const PoecalArm, pose: *const f64, q: *mut f64) -> PoecalLeft {
    // SAFETY: by the contract above.
    let (Some(arm), Some(target)) = (unsafe { arm.as_ref() }, unsafe { target(pose) }) else {
        return NOTHING;
    };
    if q.is_null() {
        return NOTHING;
    }
    // SAFETY: by the contract above.
    let q = unsafe { slice::from_raw_parts_mut(q, arm.arm.joints()) };
    solve_nearest(arm, &target, q)
}

fn solve_nearest(arm: &PoecalArm, target: &Pose, q: &mut [f64]) -> PoecalLeft {
    match (&arm.branches, <&mut [f64; 6]>::try_from(&mut *q)) {
        (Some(branches), Ok(six)) => branches.solve_nearest(target, six),
        (None, _) | (_, Err(_)) => arm.arm.solve_nearest(target, q),
    };
    let tip = arm.arm.forward_kinematics(q);
    let turn: Vector3<f64> = rotation::log(&(tip.rotation.transpose() * target.rotation));
    PoecalLeft { position_m: (tip.translation - target.translation).norm(), rotation_rad: turn.norm() }
}

/// All configurations of an arm of six turning joints that have its tip at a pose, six readings (-π to π) each; returns their number, or -1 for null
/// or for another arm.
///
/// # Safety
/// `arm` is null or was made by `poecal_arm_new`; `pose` is null or points to 16 numbers, `q` to 6 times `POECAL_MOST_BRANCHES`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn poecal_branches(arm: *const PoecalArm, pose: *const f64, q: *mut f64) -> i32 {
    // SAFETY: by the contract above.
    let (Some(arm), Some(target)) = (unsafe { arm.as_ref() }, unsafe { target(pose) }) else { return -1 };
    let Some(branches) = arm.branches.as_ref().filter(|_| !q.is_null()) else { return -1 };
    // SAFETY: by the contract above.
    let q = unsafe { slice::from_raw_parts_mut(q, 6 * POECAL_MOST_BRANCHES) };
    let found = branches.branches_at(&target);
    for (out, branch) in q.chunks_exact_mut(6).zip(found.as_slice()) {
        out.copy_from_slice(branch);
    }
    i32::try_from(found.as_slice().len()).unwrap_or(-1)
}

/// Corrections of readings for a nominal and an actual arm; null for null, for arms with different joints, or for limits that are not above 0. The
/// limits are the largest motions of a joint beyond its zero: of one that turns, and of one that slides; 2 degrees and 2 mm are usual. Allocates;
/// takes some hundred microseconds. The arms may be freed afterwards.
///
/// # Safety
/// The arms are null or were made by `poecal_arm_new`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn poecal_corrections_new(
    nominal: *const PoecalArm,
    actual: *const PoecalArm,
    most_turn_rad: f64,
    most_slide_m: f64,
) -> *mut PoecalCorrections {
    // SAFETY: by the contract above.
    let (Some(nominal), Some(actual)) = (unsafe { nominal.as_ref() }, unsafe { actual.as_ref() }) else {
        return core::ptr::null_mut();
    };
    let is_size = |it: f64| it > 0.0 && it.is_finite();
    let most = MaxCorrection { turning_rad: most_turn_rad, sliding_m: most_slide_m };
    let corrections = ReadingCorrections::new(&nominal.arm, &actual.arm, most);
    match corrections.filter(|_| is_size(most_turn_rad) && is_size(most_slide_m)) {
        Some(corrections) => Box::into_raw(Box::new(PoecalCorrections { corrections })),
        None => core::ptr::null_mut(),
    }
}

/// Frees corrections.
///
/// # Safety
/// `corrections` is null or was made by `poecal_corrections_new`, and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn poecal_corrections_free(corrections: *mut PoecalCorrections) {
    if !corrections.is_null() {
        // SAFETY: by the contract above.
        drop(unsafe { Box::from_raw(corrections) });
    }
}

/// Readings with which the actual arm's tip has the pose of the nominal one's at the readings `meant`, on the same branch; if there are none, `q` is
/// `meant`. Returns the outcome, NaN for null.
///
/// # Safety
/// `corrections` is null or was made by `poecal_corrections_new`; `meant` and `q` are null or point to `poecal_joints` of its arms numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn poecal_compensate(
    corrections: *const PoecalCorrections,
    meant: *const f64,
    q: *mut f64,
) -> PoecalCorrected {
    let nothing = PoecalCorrected { position_m: f64::NAN, rotation_rad: f64::NAN, outcome: -1 };
    // SAFETY: by the contract above.
    let Some(it) = (unsafe { corrections.as_ref() }) else { return nothing };
    if meant.is_null() || q.is_null() {
        return nothing;
    }
    let joints = it.corrections.actual_arm().joints();
    let mut all = [0.0; POECAL_MOST_JOINTS];
    // SAFETY: by the contract above; read before written, so that both may be the same.
    all[..joints].copy_from_slice(unsafe { slice::from_raw_parts(meant, joints) });
    // SAFETY: by the contract above.
    let q = unsafe { slice::from_raw_parts_mut(q, joints) };
    let found = it.corrections.correct(&all[..joints], None, q);
    let outcome = match found.outcome {
        CorrectionOutcome::Reached => POECAL_REACHED,
        CorrectionOutcome::Turned => POECAL_TURNED,
        CorrectionOutcome::Nearest if joints < 6 => POECAL_NEAREST,
        CorrectionOutcome::Nearest => POECAL_OUT_OF_REACH,
        CorrectionOutcome::TooFar(..) => POECAL_TOO_FAR,
    };
    if outcome >= POECAL_OUT_OF_REACH {
        q.copy_from_slice(&all[..joints]);
    }
    PoecalCorrected { position_m: found.left_m, rotation_rad: found.left_rad, outcome }
}

/// The pose of 16 numbers.
///
/// # Safety
/// `pose` is null or points to 16 numbers.
unsafe fn target(pose: *const f64) -> Option<Pose> {
    if pose.is_null() {
        return None;
    }
    // SAFETY: by the contract above.
    let it = unsafe { slice::from_raw_parts(pose, 16) };
    let turn = Matrix3::new(it[0], it[1], it[2], it[4], it[5], it[6], it[8], it[9], it[10]);
    let pose = Pose::new(turn, Vector3::new(it[3], it[7], it[11]));
    pose.rotation.iter().chain(pose.translation.iter()).all(|it| it.is_finite()).then_some(pose)
}
