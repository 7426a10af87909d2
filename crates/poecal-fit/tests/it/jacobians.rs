//! Every measurement type against every parameter type: analytic derivatives and differences. A new type is one line in
//! [`MEASUREMENTS`] or [`parameters`].

use nalgebra::{Matrix6, Vector3};
use poecal_arm::lie::{Pose, Screw, rotation};
use poecal_fit::parameters::{DeviceFrame, Parameter, ScrewAxis, TargetFrame, TargetPlace, ValueTerm};
use poecal_fit::problem::{Layout, Problem};
use poecal_fit::state::{Estimate, Linkage, PackedValues, RowChain, Session, Sight};
use poecal_model::measurement::{Dataset, Measurement, Noise};
use poecal_model::robot::{Joint, Robot, Term};
use poecal_numerics::solve::LeastSquares;
use poecal_testing::largest::larger_or_nan;
use std::f64::consts::PI;

/// Accuracy of the differences below: their truncation error is some (0.2 rad)¹⁰ / 2772, far less.
const RELATIVE: f64 = 1e-6;
/// Rounding of one whitened residual of order one, which differences magnify by the inverse of their step.
const ROUNDING: f64 = 2e-15;
/// Metres that a radian counts.
const LENGTH_M: f64 = 0.7;
/// Values differ for position and rotation, so that a mix-up is detected.
const NOISE: Noise = Noise::new(0.5, 0.8);

/// Makes a measurement of a target that was seen at a pose.
type Measure = fn(Pose) -> Measurement;

const MEASUREMENTS: [(&str, Measure); 2] =
    [("point", |seen| Measurement::point(seen.translation)), ("pose", |seen| Measurement::of_pose(&seen))];

/// Parameters in the order of the chain, as a problem takes them.
fn parameters(robot: &Robot) -> Vec<(&'static str, Parameter)> {
    let about = Vector3::new(0.1, -0.2, 0.3);
    let mut all = vec![
        ("device frame", Parameter::DeviceFrame(DeviceFrame::new(0, about))),
        ("other frame", Parameter::DeviceFrame(DeviceFrame::new(1, about))),
    ];
    for (joint, it) in robot.joints.iter().enumerate() {
        all.push((it.kind.word(), Parameter::ScrewAxis(ScrewAxis { joint, kind: it.kind })));
        all.push(("offset", Parameter::ValueTerm(ValueTerm { joint, kind: it.kind, term: Term::OFFSET })));
    }
    all.push(("target place", Parameter::TargetPlace(TargetPlace { target: 0 })));
    all.push(("target frame", Parameter::TargetFrame(TargetFrame::new(0))));
    all
}

/// Joint values and residual rotations (radians; metres for prismatic joints).
const JOINT_VALUES: [f64; 4] = [0.0, 1e-8, 0.9, PI - 1e-8];
const RESIDUAL_ANGLES: [f64; 4] = [0.0, 1e-8, 1.1, PI - 1e-3];

fn robot() -> Robot {
    let turning = |name: &str, w: [f64; 3], q: [f64; 3]| Joint::revolute(name, Screw::revolute(&w.into(), &q.into()));
    let joints = vec![
        turning("a", [0.1, -0.2, 0.9], [0.05, 0.1, 0.0]),
        Joint::prismatic("b", Screw::prismatic(&Vector3::new(0.7, 0.2, -0.4))),
        turning("c", [-0.3, 0.8, 0.2], [0.1, -0.05, 0.2]),
        turning("d", [1.0, 0.1, 0.3], [0.2, 0.1, 0.25]),
    ];
    Robot::new("r_p_r_r", joints, Pose::from_xyz_rpy([0.25, 0.15, 0.3], [0.4, -0.3, 0.8])).unwrap()
}

fn device() -> Pose {
    Pose::from_xyz_rpy([0.3, -0.2, 0.1], [-0.5, 0.9, 2.0])
}

/// An estimate with the device at two stations.
fn estimate(robot: &Robot) -> Estimate {
    let mut estimate = Estimate::new(robot, vec![robot.home], device());
    estimate = estimate.with_further_devices(vec![Pose::from_xyz_rpy([0.2, -0.1, 0.15], [-0.5, 0.9, 1.4])]);
    estimate
}

/// Input of the prediction of one measurement.
struct Row {
    robot: Robot,
    data: Dataset,
    packed: PackedValues,
}

impl Row {
    /// A measurement from one of the stations, with a shift and a turn from the estimate's prediction.
    fn new(robot: &Robot, estimate: &Estimate, readings: &[f64], (make, station): (Measure, usize), turn: f64) -> Self {
        let packed = PackedValues::new(robot, readings, readings.len());
        let mut chain = RowChain::default();
        chain.evaluate(&Linkage::new(estimate), &packed, 0, Sight { station, target: 0, from: None });
        let turn = rotation::exp(&(Vector3::new(0.6, -0.48, 0.64) * turn));
        let seen = Pose::new(turn * chain.target.rotation, chain.target.translation + Vector3::new(0.02, -0.01, 0.03));
        let mut data = Dataset::new(robot.reading_names());
        data.push(readings, None, make(seen)).unwrap();
        data.stations = vec![Some("first".into()), Some("second".into())];
        data.observations[0].station = station;
        Row { robot: robot.clone(), data, packed }
    }

    fn problem(&self, parameters: Vec<Parameter>) -> Problem<'_> {
        let session = Session::new(&self.robot, &self.data, &self.packed, false).with_length(LENGTH_M);
        Problem::new(session, vec![0], parameters, NOISE)
    }

    /// The whitened residual.
    fn residual(&self, estimate: &Estimate) -> Vec<f64> {
        let measurement = self.data.observations[0].measurement;
        let mut chain = RowChain::default();
        chain.evaluate(&Linkage::new(estimate), &self.packed, 0, &self.data.observations[0]);
        let mut out = vec![0.0; measurement.dim()];
        measurement.residual(&chain.target, &mut out);
        let whitened = out.iter().zip(measurement.channels()).map(|(e, channel)| e / NOISE[channel.quantity]);
        whitened.collect()
    }

    /// The whitened sensitivity of the prediction, one column an unknown.
    fn columns(&self, estimate: &Estimate, layout: &Layout) -> Vec<Vec<f64>> {
        let mut chain = RowChain::default();
        chain.evaluate(&Linkage::new(estimate), &self.packed, 0, &self.data.observations[0]);
        let measurement = self.data.observations[0].measurement;
        let mut columns = vec![Vec::new(); layout.dim()];
        for (parameter, places) in layout.parameters() {
            let mut twists = vec![(Vector3::zeros(), Vector3::zeros()); places.len()];
            parameter.model().target_twists(&chain, 0, &mut twists);
            let mut sensitivity = vec![[0.0; 6]; measurement.dim()];
            measurement.sensitivity(&chain.target, &mut sensitivity);
            for ((v, w), &(place, scale)) in twists.iter().zip(places) {
                let rows = sensitivity.iter().zip(measurement.channels());
                let moved = rows.map(|([a, b, c, p, q, r], channel)| {
                    let moved = Vector3::new(*a, *b, *c).dot(v) + Vector3::new(*p, *q, *r).dot(w);
                    moved / NOISE[channel.quantity] / scale
                });
                columns[place] = moved.collect();
            }
        }
        columns
    }

    /// Central differences of tenth order of the prediction (the residual with its sign turned).
    fn differences(&self, estimate: &Estimate, layout: &Layout, unknown: usize, step: f64) -> Vec<f64> {
        let weights = [5.0 / 6.0, -5.0 / 21.0, 5.0 / 84.0, -5.0 / 504.0, 1.0 / 1260.0];
        let mut sum = vec![0.0; self.residual(estimate).len()];
        for (k, weight) in weights.into_iter().enumerate() {
            for sign in [1.0, -1.0] {
                let mut delta = vec![0.0; layout.dim()];
                delta[unknown] = sign * step * (k + 1) as f64;
                let moved = self.residual(&layout.retract(estimate, &delta));
                for (sum, e) in sum.iter_mut().zip(moved) {
                    *sum -= sign * weight * e / step;
                }
            }
        }
        sum
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

fn norm(a: &[f64]) -> f64 {
    a.iter().map(|a| a * a).sum::<f64>().sqrt()
}

#[test]
fn jacobians_agree_with_differences() {
    let robot = robot();
    let estimate = estimate(&robot);
    let mut largest: f64 = 0.0;
    for (measurement, make) in MEASUREMENTS {
        for (name, parameter) in parameters(&robot) {
            let mut worst: f64 = 0.0;
            for (value, station) in JOINT_VALUES.into_iter().flat_map(|value| [(value, 0), (value, 1)]) {
                for angle in RESIDUAL_ANGLES {
                    let row = Row::new(&robot, &estimate, &[value; 4], (make, station), angle);
                    let layout = Layout::new(vec![parameter], LENGTH_M);
                    // All five steps together must not carry the residual over half a turn, where its logarithm jumps
                    // (near it, columns that are themselves only 1e-8 drown in the rounding of such small steps).
                    let step = f64::min(0.1, (PI - angle) / 20.0);
                    for (unknown, column) in row.columns(&estimate, &layout).iter().enumerate() {
                        let numeric = row.differences(&estimate, &layout, unknown, step);
                        let floor = ROUNDING / step / RELATIVE;
                        worst = larger_or_nan(worst, distance(column, &numeric) / norm(column).max(floor));
                    }
                }
            }
            println!("{measurement:12} by {name:13} {worst:.1e}");
            largest = larger_or_nan(largest, worst);
        }
    }
    assert!(largest < RELATIVE, "{largest:e}");
}

/// The problem assembles just these columns: `JᵀJ` and `Jᵀe`.
#[test]
fn normal_information_is_made_of_the_same_columns() {
    let robot = robot();
    let estimate = estimate(&robot);
    for (name, make) in MEASUREMENTS {
        let row = Row::new(&robot, &estimate, &[0.4, 0.2, -1.3, 2.2], (make, 1), 0.3);
        // A target is unknown as a position or as a frame.
        let all = parameters(&robot).into_iter().map(|(_, parameter)| parameter);
        let problem = row.problem(all.filter(|it| !matches!(it, Parameter::TargetPlace(_))).collect());
        let columns = row.columns(&estimate, problem.layout());
        let residual = row.residual(&estimate);
        let normal = problem.normal(&estimate);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut worst: f64 = 0.0;
        for (a, column) in columns.iter().enumerate() {
            worst = larger_or_nan(worst, (normal.gradient[a] - dot(column, &residual)).abs());
            for (b, other) in columns.iter().enumerate().skip(a) {
                worst = larger_or_nan(worst, (normal.gram[a * problem.dim() + b] - dot(column, other)).abs());
            }
        }
        println!("{name:6} {} unknowns: {worst:.1e}", problem.dim());
        // Sums of at most six products of numbers of order one.
        assert!(worst < 1e-14);
    }
}

/// Second differences of fourth order of the cost, over `step` in both unknowns.
fn second_difference(problem: &Problem<'_>, estimate: &Estimate, (a, b): (usize, usize), step: f64) -> f64 {
    let cost = |x: f64, y: f64| {
        let mut delta = vec![0.0; problem.dim()];
        delta[a] += x * step;
        delta[b] += y * step;
        problem.normal(&problem.retract(estimate, &delta)).cost
    };
    let weights = [(1.0, 2.0 / 3.0), (2.0, -1.0 / 12.0), (-1.0, -2.0 / 3.0), (-2.0, 1.0 / 12.0)];
    let mut sum = 0.0;
    for (x, weight_x) in weights {
        for (y, weight_y) in weights {
            sum += weight_x * weight_y * cost(x, y);
        }
    }
    sum / (step * step)
}

/// Largest difference of `JᵀJ + curvature` from second differences, over the largest element.
fn hessian_error(make: Measure, turn: f64) -> f64 {
    [0, 1].map(|station| hessian_error_from(make, station, turn)).into_iter().fold(0.0, larger_or_nan)
}

fn hessian_error_from(make: Measure, station: usize, turn: f64) -> f64 {
    let robot = robot();
    let estimate = estimate(&robot);
    let row = Row::new(&robot, &estimate, &[0.4, 0.2, -1.3, 2.2], (make, station), turn);
    // A position and a frame of the same target are not both free in any problem: their shifts are one and the same.
    let free = parameters(&robot).into_iter().map(|(_, parameter)| parameter);
    let free = free.filter(|it| !matches!(it, Parameter::TargetPlace(_)) && it.model().has_curvature()).collect();
    let problem = row.problem(free);
    let (gram, curvature) = (problem.normal(&estimate).gram, problem.curvature(&estimate).unwrap());
    let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
    for a in 0..problem.dim() {
        for b in a..problem.dim() {
            let at = a * problem.dim() + b;
            let numeric = second_difference(&problem, &estimate, (a, b), 0.01);
            worst = larger_or_nan(worst, (gram[at] + curvature[at] - numeric).abs());
            largest = larger_or_nan(largest, numeric.abs());
        }
    }
    worst / largest
}

#[test]
fn full_hessian_of_points_is_exact() {
    let (_, make) = MEASUREMENTS[0];
    let error = hessian_error(make, 0.0);
    println!("points: {error:.1e} of the largest element");
    // Truncation of the differences: (0.01 / 0.7)⁴.
    assert!(error < 1e-6);
}

#[test]
fn full_hessian_of_poses_is_exact_to_first_order_in_the_residual() {
    let (_, make) = MEASUREMENTS[1];
    let (near, far) = (hessian_error(make, 0.01), hessian_error(make, 0.1));
    println!("poses: {near:.1e} at a residual of 0.01 rad, {far:.1e} at 0.1 rad");
    // The omitted part is of second order: at a tenth of the residual, a hundredth of the error (with room for the next order).
    assert!(far < 0.1_f64.powi(2) && near < far / 50.0);
}

#[test]
fn second_order_along_a_step_agrees_with_differences() {
    let robot = robot();
    let estimate = estimate(&robot);
    for (name, make) in MEASUREMENTS {
        let row = Row::new(&robot, &estimate, &[0.4, 0.2, -1.3, 2.2], (make, 1), 0.3);
        let free = parameters(&robot).into_iter().map(|(_, parameter)| parameter);
        let is_free = |it: &Parameter| it.model().has_curvature() && !matches!(it, Parameter::TargetPlace(_));
        let problem = row.problem(free.filter(is_free).collect());
        let step: Vec<f64> = (0..problem.dim()).map(|k| 0.02 * (k as f64 * 1.7).sin()).collect();
        // Sixth order; a whole step is some 0.03 rad.
        let weights = [1.5, -3.0 / 20.0, 1.0 / 90.0];
        let here = row.residual(&estimate);
        let mut second: Vec<f64> = here.iter().map(|e| -49.0 / 18.0 * e).collect();
        for (k, weight) in weights.into_iter().enumerate() {
            for sign in [1.0, -1.0] {
                let part: Vec<f64> = step.iter().map(|s| sign * (k + 1) as f64 * s).collect();
                let moved = row.residual(&problem.retract(&estimate, &part));
                second.iter_mut().zip(moved).for_each(|(sum, e)| *sum += weight * e);
            }
        }
        let columns = row.columns(&estimate, problem.layout());
        let numeric: Vec<f64> =
            columns.iter().map(|column| column.iter().zip(&second).map(|(j, e)| j * e).sum()).collect();
        let error = distance(&problem.second_order(&estimate, &step), &numeric) / norm(&numeric);
        println!("{name:6} {error:.1e}");
        // The problem's own second difference takes a tenth of the step, all joints together 0.03 rad: an error of 0.03² / 12.
        assert!(error < 1e-4);
    }
}

/// Joint values at which the identities below are tried.
const CONFIGURATIONS: [[f64; 4]; 5] =
    [[0.0; 4], [1e-8; 4], [0.4, 0.2, -1.3, 2.2], [PI - 1e-8; 4], [-3.0, -0.4, 3.1, 0.05]];

/// `T_0 … T_n` of the robot.
fn prefixes(robot: &Robot, values: &[f64]) -> Vec<Pose> {
    let mut prefixes = vec![Pose::identity()];
    for (joint, &value) in robot.joints.iter().zip(values) {
        prefixes.push(prefixes[prefixes.len() - 1] * joint.screw.exp(value));
    }
    prefixes
}

#[test]
fn blocks_of_all_axes_and_of_the_home_pose_sum_to_a_motion_of_the_base() {
    let robot = robot();
    for values in CONFIGURATIONS {
        let prefixes = prefixes(&robot, &values);
        let mut sum = prefixes[4].adjoint();
        for i in 0..4 {
            sum += prefixes[i].adjoint() - prefixes[i + 1].adjoint();
        }
        assert!((sum - Matrix6::identity()).norm() < 1e-14);
    }
}

/// Proposition 1 to first order: an offset of joint i is a motion of all later axes and of the home pose.
#[test]
fn joint_offsets_are_motions_of_the_later_axes() {
    let robot = robot();
    for values in CONFIGURATIONS {
        let prefixes = prefixes(&robot, &values);
        for (i, joint) in robot.joints.iter().enumerate() {
            let offset = prefixes[i].adjoint() * joint.screw.twist().to_vector();
            let mut later = prefixes[4].adjoint();
            for j in i + 1..4 {
                later += prefixes[j].adjoint() - prefixes[j + 1].adjoint();
            }
            let error = (later * joint.screw.twist().to_vector() - offset).norm();
            assert!(error < 1e-14, "{error:e}");
        }
    }
}
