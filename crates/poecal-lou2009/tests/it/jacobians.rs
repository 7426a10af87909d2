//! Free screws and the spatial residual: their derivatives against central differences of tenth order.

use std::f64::consts::PI;

use crate::reference;
use nalgebra::Vector3;
use poecal_arm::lie::{Pose, Screw, rotation};
use poecal_fit::parameters::{DeviceFrame, Parameter, ScrewAxis, TargetFrame, ValueTerm};
use poecal_fit::problem::Problem;
use poecal_fit::state::{Estimate, Linkage, PackedValues, RowChain, Session};
use poecal_lou2009::{FreeScrew, PaperFormulation, PaperResidual};
use poecal_model::measurement::{Dataset, Measurement, Noise};
use poecal_model::robot::{Joint, Robot, Term};
use poecal_numerics::solve::LeastSquares as _;

/// Resolution of the differences: their truncation error is some (0.2 rad)¹⁰ / 2772, far less.
const RELATIVE: f64 = 1e-6;
/// Rounding of one whitened residual of order one, which differences magnify by the inverse of their step.
const ROUNDING: f64 = 2e-15;
/// Different noise for position and rotation, so that a mix-up shows.
const NOISE: Noise = Noise::new(0.5, 0.8);
const LENGTH_M: f64 = 0.7;

fn robot() -> Robot {
    let turning = |name: &str, w: [f64; 3], q: [f64; 3]| Joint::revolute(name, Screw::revolute(&w.into(), &q.into()));
    let joints = vec![
        turning("a", [0.1, -0.2, 0.9], [0.05, 0.1, 0.0]),
        Joint::prismatic("b", Screw::prismatic(&Vector3::new(0.7, 0.2, -0.4))),
        turning("c", [-0.3, 0.8, 0.2], [0.1, -0.05, 0.2]),
    ];
    Robot::new("r_p_r", joints, Pose::from_xyz_rpy([0.25, 0.15, 0.3], [0.4, -0.3, 0.8])).unwrap()
}

/// A measurement that differs from the estimate's prediction by a shift and a turn.
fn data(robot: &Robot, estimate: &Estimate, readings: &[f64], residual: Option<PaperResidual>, turn: f64) -> Dataset {
    let packed = PackedValues::new(robot, readings, readings.len());
    let mut chain = RowChain::default();
    chain.evaluate(&Linkage::new(estimate), &packed, 0, 0);
    let turn = rotation::exp(&(Vector3::new(0.6, -0.48, 0.64) * turn));
    let position = chain.target.translation + Vector3::new(0.02, -0.01, 0.03);
    let mut data = Dataset::new(robot.reading_names());
    let measurement = match residual {
        None => Measurement::point(position),
        Some(_) => Measurement::of_pose(&Pose::new(turn * chain.target.rotation, position)),
    };
    data.push(readings, None, measurement).unwrap();
    data.pose_residual = residual.and_then(PaperResidual::model);
    data
}

/// The whitened Jacobian of the prediction, row-major, and the residual.
fn row(problem: &Problem<'_>, state: &Estimate) -> (Vec<f64>, Vec<f64>) {
    let mut found = None;
    reference::for_rows(problem, state, &[0], |_, jacobian, e| found = Some((jacobian.to_vec(), e.to_vec())));
    found.unwrap()
}

/// Central differences of the prediction by one unknown.
fn differences(problem: &Problem<'_>, state: &Estimate, unknown: usize, step: f64) -> Vec<f64> {
    let weights = [5.0 / 6.0, -5.0 / 21.0, 5.0 / 84.0, -5.0 / 504.0, 1.0 / 1260.0];
    let mut sum = vec![0.0; row(problem, state).1.len()];
    for (k, weight) in weights.into_iter().enumerate() {
        for sign in [1.0, -1.0] {
            let mut delta = vec![0.0; problem.dim()];
            delta[unknown] = sign * step * (k + 1) as f64;
            let (_, moved) = row(problem, &problem.retract(state, &delta));
            for (sum, e) in sum.iter_mut().zip(moved) {
                *sum -= sign * weight * e / step;
            }
        }
    }
    sum
}

#[test]
fn jacobians_agree_with_differences() {
    let robot = robot();
    let device = Pose::from_xyz_rpy([0.3, -0.2, 0.1], [-0.5, 0.9, 2.0]);
    let state = Estimate::new(&robot, vec![robot.home], device);
    let mut parameters = vec![("target frame", Parameter::TargetFrame(TargetFrame::new(0)))];
    for (joint, it) in robot.joints.iter().enumerate() {
        parameters.push(("free screw", FreeScrew::parameter(joint, it.kind)));
        parameters.push(("screw axis", Parameter::ScrewAxis(ScrewAxis { joint, kind: it.kind })));
        parameters.push(("offset", Parameter::ValueTerm(ValueTerm { joint, kind: it.kind, term: Term::OFFSET })));
    }
    let mut compared = 0;
    for (seen, residual) in
        [("point", None), ("pose", Some(PaperResidual::Tool)), ("spatial pose", Some(PaperResidual::Spatial))]
    {
        for &(name, parameter) in &parameters {
            let mut worst = 0.0;
            for value in [0.0, 1e-8, 0.9, PI - 1e-8] {
                for angle in [0.0, 1e-8, 1.1, PI - 1e-3] {
                    let data = data(&robot, &state, &[value; 3], residual, angle);
                    let packed = PackedValues::new(&robot, &[value; 3], 3);
                    let session = Session::new(&robot, &data, &packed, false).with_length(LENGTH_M);
                    let problem = Problem::new(session, vec![0], vec![parameter], NOISE);
                    // No step must carry the residual over half a turn, where its logarithm jumps. Free screws are normalised, which
                    // is no polynomial: their steps are shorter.
                    let longest = if matches!(parameter, Parameter::OtherScrew(_)) { 0.03 } else { 0.1 };
                    let step = f64::min(longest, (PI - angle) / 20.0);
                    let (jacobian, e) = row(&problem, &state);
                    // Unknowns that the retraction drops are checked against the paper's own columns.
                    let mut kept = vec![1.0; problem.dim()];
                    parameter.model().project_constraints(&mut kept);
                    for unknown in (0..problem.dim()).filter(|&k| problem_keeps(&problem, &kept, k)) {
                        let numeric = differences(&problem, &state, unknown, step);
                        let column = (0..e.len()).map(|k| jacobian[k * problem.dim() + unknown]);
                        let (mut apart, mut size) = (0.0, 0.0);
                        for (a, b) in column.zip(&numeric) {
                            apart += (a - b) * (a - b);
                            size += a * a;
                        }
                        let floor = ROUNDING / step / RELATIVE;
                        let relative = f64::sqrt(apart) / f64::sqrt(size).max(floor);
                        assert!(relative < RELATIVE, "{seen} by {name}, unknown {unknown}: {relative:e}");
                        worst = f64::max(worst, relative);
                        compared += 1;
                    }
                }
            }
            println!("{seen:12} by {name:13} {worst:.1e}");
        }
    }
    // Compared columns of each of 16 cases and 3 kinds: 6 of the target, 4 of a turning axis by either form, 2 of a sliding one, an offset each.
    assert_eq!(compared, 16 * 3 * (6 + 2 * (4 + 4 + 2) + 3));
}

/// True if the retraction keeps the unknown at an index of a step.
fn problem_keeps(problem: &Problem<'_>, kept: &[f64], place: usize) -> bool {
    let own = problem.layout().parameters().flat_map(|(_, places)| places);
    own.zip(kept).any(|(&(other, _), &kept)| other == place && kept != 0.0)
}

/// The kernels treat the paper's residual as any function of the target's pose, and its screws as columns supplied by rows.
#[test]
fn the_kernels_sum_them_as_their_formulas_do() {
    let simulation = poecal_model::simulate::Simulation { count: 60, ..poecal_model::simulate::Simulation::default() };
    for (robot, kind) in [
        (poecal_model::simulate::elbow(), poecal_model::measurement::SessionKind::POSE),
        (poecal_model::simulate::gantry(), poecal_model::measurement::SessionKind::MIXED),
        (poecal_model::simulate::scara(), poecal_model::measurement::SessionKind::POINT),
    ] {
        for (formulation, residual) in [
            (PaperFormulation::Adjoint, PaperResidual::Spatial),
            (PaperFormulation::ScrewOffsets, PaperResidual::Tool),
            (PaperFormulation::Screw, PaperResidual::Spatial),
        ] {
            let mut made = simulation.run(&robot, kind).unwrap();
            made.data.write_poses_by(residual.model());
            let packed = poecal_fit::state::PackedValues::from_dataset(&robot, &made.data);
            let seen = poecal_fit::state::Session::new(&robot, &made.data, &packed, true);
            let about = Vector3::new(0.3, 0.1, 0.2);
            let mut free = vec![Parameter::DeviceFrame(DeviceFrame::new(0, about))];
            free.extend(formulation.joint_parameters(&robot.joints.iter().map(|it| it.kind).collect::<Vec<_>>()));
            free.push(Parameter::TargetFrame(TargetFrame::new(0)));
            let noise = Noise::new(5e-5, 2e-4);
            let problem = Problem::new(seen, made.data.all_rows(), free, noise);
            let estimate = Estimate::new(&robot, vec![robot.home], made.device_from_base);
            let (fast, rows) = (problem.normal(&estimate), reference::normal(&problem, &estimate));
            let n = problem.dim();
            // The column of an unknown without effect is only rounding.
            let size = |k: usize| rows.gram[k * n + k].sqrt().max(1e-3);
            let mut worst = (fast.cost - rows.cost).abs() / rows.cost;
            for a in 0..n {
                let length = (2.0 * rows.cost).sqrt();
                worst = worst.max((fast.gradient[a] - rows.gradient[a]).abs() / (size(a) * length));
                for b in a..n {
                    let apart = (fast.gram[a * n + b] - rows.gram[a * n + b]).abs();
                    worst = worst.max(apart / (size(a) * size(b)));
                }
            }
            println!("{} {formulation:?} {residual:?}: {worst:.1e}", robot.name);
            // Rounding of sums of sixty rows of six numbers, in units of their own size.
            assert!(worst < 1e-11);
        }
    }
}
