//! The bound of Cramér and Rao of predicted poses, from differences of the kinematics: nothing of the calibration is used.

use nalgebra::{DMatrix, Matrix6xX, Vector6};
use poecal::camera::moved;
use poecal::lie::Pose;
use poecal::measurement::deviation;
use poecal::robot::Robot;
use poecal::simulate::Photographed;

use crate::session::{FURTHER, Session, true_pose, whitenings};

/// Step of the differences, rad and m.
const STEP: f64 = 1e-6;
/// Share of the largest eigenvalue below which a direction is another way to write the same arm.
const SAME: f64 = 1e-9;

/// Root mean squares of shift (m) and turn (rad) that no unbiased estimate from the session's pictures falls below, in the further configurations.
pub(crate) fn least_errors(session: &Session) -> [f64; 2] {
    let Session { data, others, .. } = session;
    let count = 6 * (session.made.actual.joints.len() + 2);
    let mut information = DMatrix::<f64>::zeros(count, count);
    for (row, whitening) in whitenings(session).iter().enumerate() {
        let by = whitening * derivative(&session.made, data.readings(row));
        information += by.transpose() * by;
    }
    let eigen = information.symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    let mut covariance = DMatrix::<f64>::zeros(count, count);
    for (k, value) in eigen.eigenvalues.iter().enumerate().filter(|(_, value)| **value > SAME * largest) {
        let vector = eigen.eigenvectors.column(k);
        covariance += vector * vector.transpose() / *value;
    }
    let mut squares = [0.0; 2];
    for row in 0..others.len() {
        let by = derivative(&session.made, others.readings(row));
        let spread = &by * &covariance * by.transpose();
        for (part, square) in squares.iter_mut().enumerate() {
            *square += (3 * part..3 * part + 3).map(|k| spread[(k, k)]).sum::<f64>() / FURTHER as f64;
        }
    }
    squares.map(f64::sqrt)
}

/// How the pose of what is held, seen from what stays, moves with motions of each axis, of what is held and of what stays.
fn derivative(made: &Photographed, readings: &[f64]) -> Matrix6xX<f64> {
    let joints = made.actual.joints.len();
    let mut found = Matrix6xX::zeros(6 * (joints + 2));
    for unknown in 0..6 * (joints + 2) {
        let at = |step: f64| {
            let changed = changed(made, unknown, step);
            true_pose(&changed, &changed.actual, readings)
        };
        found.set_column(unknown, &(deviation(&at(STEP), &at(-STEP)) / (2.0 * STEP)));
    }
    found
}

fn changed(made: &Photographed, unknown: usize, step: f64) -> Photographed {
    let mut found = made.clone();
    let (part, k) = (unknown / 6, unknown % 6);
    let mut motion = Vector6::zeros();
    motion[k] = step;
    let joints = made.actual.joints.len();
    match part.checked_sub(joints) {
        None => found.actual = with_moved_axis(&made.actual, part, &motion),
        Some(0) => found.tip_from_held = moved(&made.tip_from_held, &motion),
        Some(_) => found.base_from_other = moved(&made.base_from_other, &motion),
    }
    found
}

/// The robot with an axis moved about its own point, and the tip where it was.
fn with_moved_axis(robot: &Robot, joint: usize, motion: &Vector6<f64>) -> Robot {
    let mut found = robot.clone();
    let point = Pose::from_translation(robot.joints[joint].frame.translation);
    let about = moved(&point, motion) * point.inverse();
    found.joints[joint].screw = robot.joints[joint].screw.transformed(&about);
    found
}
