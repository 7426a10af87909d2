//! One way to write a robot that many numbers describe equally well: the base frame of the nominal model is kept and the screws
//! deviate from nominal as little as the data allow. Predictions do not change (docs/theory.md §8).

use nalgebra::{Matrix3x6, Matrix6, Vector3, Vector6};

use crate::estimate::Estimate;
use crate::lie::{Pose, Screw, Twist, hat, rotation};
use crate::linalg;
use crate::parameters::Parameter;
use crate::problem::Layout;
use crate::robot::Robot;

/// Weight of a target's deviation beside that of the screws: it decides only what the screws leave open.
const TARGET_WEIGHT: f64 = 1e-3;

/// The base motion that brings an estimate's screws nearest to the nominal robot's, rotations counted with `length_m`; apply it
/// with [`Estimate::rebased`]. `nominal_targets` settle what the screws leave open.
#[must_use]
pub fn base_motion(estimate: &Estimate, robot: &Robot, nominal_targets: &[Pose], length_m: f64) -> Pose {
    let mut motion = Pose::identity();
    for _ in 0..50 {
        let moved = estimate.rebased(&motion);
        let mut gram = Matrix6::zeros();
        let mut gradient = Vector6::zeros();
        let mut add = |derivative: Matrix3x6<f64>, residual: Vector3<f64>| {
            gram += derivative.transpose() * derivative;
            gradient -= derivative.transpose() * residual;
        };
        for (screw, joint) in moved.screws().iter().zip(&robot.joints) {
            add_screw(screw, &joint.screw, &joint.frame.translation, length_m, &mut add);
        }
        for (pose, nominal) in moved.base_from_target.iter().zip(nominal_targets) {
            let shift = point_derivative(&pose.translation) * TARGET_WEIGHT;
            add(shift, (pose.translation - nominal.translation) * TARGET_WEIGHT);
            let turn = rotation::log(&(pose.rotation * nominal.rotation.transpose()));
            add(
                turn_derivative(&nalgebra::Matrix3::identity(), TARGET_WEIGHT * length_m),
                turn * (TARGET_WEIGHT * length_m),
            );
        }
        let upper: Vec<f64> = (0..36).map(|k| gram[(k / 6, k % 6)]).collect();
        let Some(factor) = linalg::cholesky(&upper, 6, 1e-12 * gram.trace()) else { break };
        let step = linalg::cholesky_solve(&factor, gradient.as_slice());
        let step = Vector6::from_column_slice(&step);
        motion = (Pose::exp(&Twist::from_vector(&step)) * motion).orthonormalized();
        if step.norm() < 1e-13 {
            break;
        }
    }
    motion
}

/// Adds how far a moved screw is from nominal, with the derivative by a spatial motion of the base.
fn add_screw(
    screw: &Screw,
    nominal: &Screw,
    origin: &Vector3<f64>,
    length_m: f64,
    add: &mut impl FnMut(Matrix3x6<f64>, Vector3<f64>),
) {
    let direction = screw.direction();
    let tilt = (direction - nominal.direction()) * length_m;
    add(turn_derivative(&-hat(&direction), length_m), tilt);
    if !screw.is_prismatic() {
        let at = screw.nearest_point(origin);
        let across = nalgebra::Matrix3::identity() - direction * direction.transpose();
        add(across * point_derivative(&at), at - origin);
    }
}

/// `[I, -p̂]`: a point's motion under a spatial twist.
fn point_derivative(point: &Vector3<f64>) -> Matrix3x6<f64> {
    let mut derivative = Matrix3x6::zeros();
    derivative.fixed_view_mut::<3, 3>(0, 0).fill_with_identity();
    derivative.fixed_view_mut::<3, 3>(0, 3).copy_from(&-hat(point));
    derivative
}

fn turn_derivative(by_turn: &nalgebra::Matrix3<f64>, scale: f64) -> Matrix3x6<f64> {
    let mut derivative = Matrix3x6::zeros();
    derivative.fixed_view_mut::<3, 3>(0, 3).copy_from(&(by_turn * scale));
    derivative
}

/// The step inside the null space of `gram` that brings the screws nearest to nominal, or `None` if there is no null space.
/// `floor` is the share of the largest eigenvalue below which an eigenvalue is zero.
#[must_use]
pub fn null_step(
    estimate: &Estimate,
    robot: &Robot,
    layout: &Layout,
    gram: &[f64],
    floor: f64,
) -> Option<Vec<f64>> {
    let n = layout.dim();
    let (values, vectors) = linalg::symmetric_eigen(gram, n);
    let largest = values.last().copied().unwrap_or(0.0);
    let null = values.iter().take_while(|&&value| value <= floor * largest).count();
    if null == 0 {
        return None;
    }
    let (wanted, weight) = way_to_nominal(estimate, robot, layout);
    // min |W (z - N a)| over a, by normal equations of the few null directions.
    let mut gram = vec![0.0; null * null];
    let mut gradient = vec![0.0; null];
    for i in 0..null {
        for j in i..null {
            gram[i * null + j] = (0..n).map(|k| weight[k] * vectors[(k, i)] * vectors[(k, j)]).sum();
        }
        gradient[i] = (0..n).map(|k| weight[k] * vectors[(k, i)] * wanted[k]).sum();
    }
    let factor = linalg::cholesky(&gram, null, 1e-9)?;
    let coefficients = linalg::cholesky_solve(&factor, &gradient);
    Some((0..n).map(|k| (0..null).map(|i| vectors[(k, i)] * coefficients[i]).sum()).collect())
}

/// The step that would bring each screw to nominal (targets: zero), with the weight of each unknown.
fn way_to_nominal(estimate: &Estimate, robot: &Robot, layout: &Layout) -> (Vec<f64>, Vec<f64>) {
    let mut wanted = vec![0.0; layout.dim()];
    let mut weight = vec![TARGET_WEIGHT * TARGET_WEIGHT; layout.dim()];
    let screws = estimate.screws();
    for (parameter, places) in layout.parameters() {
        let Parameter::ScrewAxis(axis) = parameter else { continue };
        let (screw, nominal) = (&screws[axis.joint], &robot.joints[axis.joint].screw);
        let frame = &estimate.base_from_axis[axis.joint];
        let to_axis = frame.rotation.transpose();
        let turn = to_axis * rotation::log(&rotation::shortest_arc(&screw.direction(), &nominal.direction()));
        let shift = to_axis * (nominal.nearest_point(&frame.translation) - frame.translation);
        let own = if screw.is_prismatic() {
            [turn.x, turn.y, 0.0, 0.0]
        } else {
            [shift.x, shift.y, turn.x, turn.y]
        };
        for (value, &(place, scale)) in own.iter().zip(places) {
            wanted[place] = value * scale;
            weight[place] = 1.0;
        }
    }
    (wanted, weight)
}
