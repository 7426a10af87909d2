//! The equation `seen = outer · moved · inner`, its errors in the camera's axes, and one step of Gauss-Newton.
//!
//! A camera in the hand sees a board that stays: `camera_from_target = (flange_from_camera)⁻¹ · (base_from_flange)⁻¹ · base_from_target`.
//! A camera beside the robot sees a board in the hand: `camera_from_target = (base_from_camera)⁻¹ · base_from_flange · flange_from_target`.
//! Both are one known motion between two unknown frames.

use nalgebra::{Matrix3, Vector3};

use crate::start::{mean_rotation, rotation_maximising};
use poecal_arm::lie::{Pose, hat, rotation};
use poecal_numerics::linalg::{cholesky, cholesky_solve, inverse};

/// Number of unknowns: two frames.
pub(crate) const UNKNOWNS: usize = 12;
/// Numbers of a pose: across, across and along the line of sight, then rotations about the same axes.
pub(crate) const NUMBERS: usize = 6;

/// One pose of the arm, and the target pose that the camera measured there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PosePair {
    /// Motion that the arm states.
    pub(crate) moved: Pose,
    /// `camera_from_target`.
    pub(crate) seen: Pose,
}

/// The two unknown frames.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FramePair {
    pub(crate) outer: Pose,
    pub(crate) inner: Pose,
}

impl FramePair {
    /// Predicted measurement of the camera.
    pub(crate) fn predict(&self, moved: &Pose) -> Pose {
        self.outer * *moved * self.inner
    }

    /// Frames after a step. For the outer frame, shift and turn are in the camera's axes. For the inner one, the shift is in its parent's
    /// axes, and the turn in its own.
    pub(crate) fn step_by(&self, step: &[f64]) -> FramePair {
        let at = |k: usize| Vector3::from_fn(|row, _| step.get(k + row).copied().unwrap_or(0.0));
        let outer = Pose::new(rotation::exp(&at(3)) * self.outer.rotation, self.outer.translation + at(0));
        let inner = Pose::new(self.inner.rotation * rotation::exp(&at(9)), self.inner.translation + at(6));
        FramePair { outer: outer.orthonormalized(), inner: inner.orthonormalized() }
    }
}

/// Axes of a picture's errors: two across the line of sight, one along it.
pub(crate) fn sight_axes(seen: &Pose) -> Matrix3<f64> {
    let along = seen.translation.try_normalize(1e-12).unwrap_or_else(Vector3::z);
    let across = rotation::perpendicular_to(&along);
    Matrix3::from_rows(&[across.transpose(), along.cross(&across).transpose(), along.transpose()])
}

/// Measured minus predicted: metres across, across and along the line of sight, then radians about the same axes.
pub(crate) fn errors(pair: &PosePair, frames: &FramePair) -> [f64; NUMBERS] {
    let predicted = frames.predict(&pair.moved);
    let axes = sight_axes(&pair.seen);
    let shift = axes * (pair.seen.translation - predicted.translation);
    let turn = axes * rotation::log(&(pair.seen.rotation * predicted.rotation.transpose()));
    [shift.x, shift.y, shift.z, turn.x, turn.y, turn.z]
}

/// Derivatives of the predicted numbers, row by row.
pub(crate) fn derivatives(pair: &PosePair, frames: &FramePair) -> [[f64; UNKNOWNS]; NUMBERS] {
    let axes = sight_axes(&pair.seen);
    let turned = frames.outer.rotation * pair.moved.rotation;
    let arm = frames.outer.rotation * pair.moved.act(&frames.inner.translation);
    let predicted = turned * frames.inner.rotation;
    let blocks = [
        [axes, -axes * hat(&arm), axes * turned, Matrix3::zeros()],
        [Matrix3::zeros(), axes, Matrix3::zeros(), axes * predicted],
    ];
    let number = |row: usize, column: usize| {
        blocks.get(row / 3).and_then(|it| it.get(column / 3)).map_or(0.0, |it| it[(row % 3, column % 3)])
    };
    std::array::from_fn(|row| std::array::from_fn(|column| number(row, column)))
}

/// Normal equations: the upper triangle of `JᵀWJ` in a square, and `JᵀWe`.
#[derive(Clone, Debug)]
pub(crate) struct FrameEquations {
    pub(crate) gram: Vec<f64>,
    pub(crate) gradient: Vec<f64>,
}

impl FrameEquations {
    pub(crate) fn zero() -> Self {
        FrameEquations { gram: vec![0.0; UNKNOWNS * UNKNOWNS], gradient: vec![0.0; UNKNOWNS] }
    }

    /// Adds a number with its derivatives and weight.
    pub(crate) fn add(&mut self, row: &[f64; UNKNOWNS], error: f64, weight: f64) {
        for (i, (gram, gradient)) in self.gram.chunks_exact_mut(UNKNOWNS).zip(&mut self.gradient).enumerate() {
            *gradient += weight * row[i] * error;
            for (g, other) in gram.iter_mut().zip(row) {
                *g += weight * row[i] * other;
            }
        }
    }

    /// The inverse of `JᵀWJ`, if all unknowns are determined.
    pub(crate) fn covariance(&self) -> Option<Vec<f64>> {
        Some(inverse(&cholesky(&self.gram, UNKNOWNS, 0.0)?))
    }
}

/// Normal equations of rows with their weights of the six numbers.
pub(crate) fn normal<'a>(
    rows: impl Iterator<Item = (&'a PosePair, [f64; NUMBERS])>,
    frames: &FramePair,
) -> FrameEquations {
    let mut normal = FrameEquations::zero();
    for (pair, weights) in rows {
        let errors = errors(pair, frames);
        for ((row, error), weight) in derivatives(pair, frames).iter().zip(errors).zip(weights) {
            normal.add(row, error, weight);
        }
    }
    normal
}

/// Largest number of steps of a fit.
const STEPS: usize = 30;
/// Size of a step, metres and radians, at which a fit ends.
const SMALL: f64 = 1e-13;

/// Frames that fit rows best by the weights of their numbers (Gauss-Newton). `None` if the rows do not determine them.
pub(crate) fn minimize_frames(pairs: &[PosePair], start: FramePair, weights: &[f64; NUMBERS]) -> Option<FramePair> {
    let mut frames = start;
    for _ in 0..STEPS {
        let normal = normal(pairs.iter().map(|pair| (pair, *weights)), &frames);
        // Undetermined directions stay at their start.
        let damping = 1e-12 * (0..UNKNOWNS).map(|k| normal.gram[k * (UNKNOWNS + 1)]).fold(0.0, f64::max);
        let step = cholesky_solve(&cholesky(&normal.gram, UNKNOWNS, damping)?, &normal.gradient);
        frames = frames.step_by(&step);
        if step.iter().all(|it| it.abs() < SMALL) {
            break;
        }
    }
    frames.outer.translation.iter().chain(frames.inner.translation.iter()).all(|it| it.is_finite()).then_some(frames)
}

/// Axis of a rotation times twice the sine of its angle.
fn twice_sine(r: &Matrix3<f64>) -> Vector3<f64> {
    Vector3::new(r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)])
}

/// Frames in closed form: the orientations from relative rotations (park1994handeye), the positions from a linear system. `None` if the
/// positions are not determined at all.
pub(crate) fn in_closed_form(pairs: &[&PosePair]) -> Option<FramePair> {
    let mut correlation = Matrix3::zeros();
    for (k, one) in pairs.iter().enumerate() {
        // All pairs if there are few poses, otherwise those at some distances.
        let steps = if pairs.len() <= 40 { (1..pairs.len()).collect() } else { vec![1, 2, 5, 11, 23, 37] };
        for other in steps.iter().filter_map(|step| pairs.get(k + step)) {
            // Axis times sine: that of half a turn has no sign.
            let from = twice_sine(&(one.moved.rotation * other.moved.rotation.transpose()));
            let to = twice_sine(&(one.seen.rotation * other.seen.rotation.transpose()));
            correlation += from * to.transpose();
        }
    }
    let outer = rotation_maximising(&correlation);
    let inner =
        mean_rotation(pairs.iter().map(|it| it.moved.rotation.transpose() * outer.transpose() * it.seen.rotation));
    // seen = outer (R t_inner + t_moved) + t_outer, linear in both positions.
    let (mut gram, mut right) = ([0.0; 36], [0.0; 6]);
    for pair in pairs {
        let turned = outer * pair.moved.rotation;
        let missing = pair.seen.translation - outer * pair.moved.translation;
        for row in 0..3 {
            let columns: [f64; 6] = std::array::from_fn(|k| match k {
                0..3 => f64::from(u8::from(k == row)),
                _ => turned[(row, k - 3)],
            });
            for i in 0..6 {
                right[i] += columns[i] * missing[row];
                for j in 0..6 {
                    gram[6 * i + j] += columns[i] * columns[j];
                }
            }
        }
    }
    let found = cholesky_solve(&cholesky(&gram, 6, 1e-9 * pairs.len() as f64)?, &right);
    let at = |k: usize| Vector3::from_fn(|row, _| found[k + row]);
    Some(FramePair { outer: Pose::new(outer, at(0)), inner: Pose::new(inner, at(3)) })
}
