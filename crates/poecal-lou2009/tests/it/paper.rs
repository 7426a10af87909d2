//! The Jacobians of lou2009 as printed compared with quadrature, differences, the telescoping form and the solver's columns; and their ranks.

use crate::formula::{Formula, differences, steps};
use nalgebra::{DMatrix, Matrix3, Matrix6, Vector3, Vector6};
use poecal_arm::lie::{Pose, Twist, hat};
use poecal_fit::parameters::{Parameter, ParameterColumns, ScrewAxis, TargetPlace, ValueTerm};
use poecal_fit::state::{Estimate, Linkage, PackedValues, RowChain};
use poecal_lou2009::literal::{
    AdjointErrors, PaperMatrix, adjoint_jacobian, jacobian, point_rows, singular_values, stack_matrices,
};
use poecal_lou2009::{FreeScrew, MeasurementKind, PaperFormulation, tables};
use poecal_model::robot::{JointLimits, Robot, Term};
use poecal_model::simulate::{random, random_chain};
use poecal_testing::largest::larger_or_nan;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;
use std::f64::consts::{PI, TAU};

/// Rounding of products of a few 6×6 matrices with elements of order one to ten.
const RELATIVE: f64 = 1e-12;
/// Rounding of a difference over a step of 0.01, with some margin.
const DIFFERENCES: f64 = 1e-10;

/// All joints at these (radians, metres), and one configuration of different values.
const JOINT_VALUES: [f64; 5] = [0.0, 1e-8, PI - 1e-8, TAU, 6.0];

fn configurations(robot: &Robot) -> Vec<Vec<f64>> {
    let n = robot.joints.len();
    let mut all: Vec<Vec<f64>> = JOINT_VALUES.iter().map(|&value| vec![value; n]).collect();
    all.push((0..n).map(|k| 2.5 * (k as f64 * 1.9 + 0.3).sin()).collect());
    all
}

/// The elbow, and chains with sliding joints among turning ones.
fn robots() -> Vec<Robot> {
    let mut robots = vec![tables::nominal_robot(), tables::prescribed_robot()];
    robots.extend((0..40).map(|seed| random_chain(6, seed)).filter(has_sliding_joint).take(3));
    assert_eq!(robots.len(), 5);
    robots
}

fn has_sliding_joint(robot: &Robot) -> bool {
    robot.joints.iter().any(|joint| joint.screw.is_prismatic())
}

/// No errors, and errors of tenths of a metre and radian.
fn errors(robot: &Robot) -> [AdjointErrors; 2] {
    let twist = |k: f64| Twist::from_vector(&Vector6::from_fn(|row, _| 0.3 * (k * 2.3 + row as f64 * 1.7 + 0.5).sin()));
    let eta = (0..robot.joints.len()).map(|k| twist(k as f64)).collect();
    [AdjointErrors::zero(robot), AdjointErrors { eta, upsilon: twist(9.0) }]
}

/// `T_0 … T_n`.
fn prefixes(robot: &Robot, values: &[f64]) -> Vec<Pose> {
    let mut prefixes = vec![Pose::identity()];
    for (joint, &value) in robot.joints.iter().zip(values) {
        prefixes.push(prefixes[prefixes.len() - 1] * joint.screw.exp(value));
    }
    prefixes
}

/// `∫₀¹ Ad(exp(ξ s)) ds` as printed in (5), (8) and (18): Gauss-Legendre with 5 points on 32 panels.
fn quadrature(twist: &Twist) -> Matrix6<f64> {
    let nodes = [0.0, 0.538_469_310_105_683_1, 0.906_179_845_938_664];
    let weights = [0.568_888_888_888_888_9, 0.478_628_670_499_366_47, 0.236_926_885_056_189_08];
    let mut integral = Matrix6::zeros();
    for panel in 0..32 {
        for (node, weight) in nodes.into_iter().zip(weights) {
            for sign in if node == 0.0 { &[1.0][..] } else { &[-1.0, 1.0][..] } {
                let s = (f64::from(panel) + 0.5 + 0.5 * sign * node) / 32.0;
                integral += Pose::exp(&Twist::new(twist.v * s, twist.w * s)).adjoint() * (weight / 64.0);
            }
        }
    }
    integral
}

#[test]
fn closed_form_is_the_printed_integral() {
    let mut worst: f64 = 0.0;
    for robot in robots() {
        for values in configurations(&robot) {
            let literal = PaperMatrix::new(&robot, &values);
            let prefixes = prefixes(&robot, &values);
            for (k, joint) in robot.joints.iter().enumerate() {
                let xi = joint.screw.twist();
                let integral = quadrature(&Twist::new(xi.v * values[k], xi.w * values[k]));
                let printed = prefixes[k].adjoint() * integral * values[k];
                let scale = prefixes[k].adjoint().norm() * integral.norm() * values[k].abs().max(1.0);
                worst = larger_or_nan(worst, (literal.screw_blocks[k] - printed).norm() / scale);
            }
            let home = prefixes[prefixes.len() - 1].adjoint() * quadrature(&robot.home.log());
            worst = larger_or_nan(worst, (literal.home_block - home).norm() / home.norm());
        }
    }
    println!("Q_k and Q_M against quadrature: {worst:.1e}");
    assert!(worst < RELATIVE);
}

/// The adjoint formulation's matrix by theory.md §3 (12) and (12a), at non-zero errors by (10b).
fn telescoping(nominal: &Robot, errors: &AdjointErrors, values: &[f64], seen: MeasurementKind) -> DMatrix<f64> {
    let robot = errors.apply(nominal);
    let prefixes = prefixes(&robot, values);
    let last = prefixes[prefixes.len() - 1];
    let mut blocks: Vec<Matrix6<f64>> = (errors.eta.iter().zip(prefixes.windows(2)))
        .map(|(eta, pair)| (pair[0].adjoint() - pair[1].adjoint()) * eta.left_jacobian())
        .collect();
    // The tool has as many own columns as rows.
    let rows = if seen == MeasurementKind::Poses { 6 } else { 3 };
    let mut all = DMatrix::zeros(rows, 6 * blocks.len() + rows);
    if seen == MeasurementKind::Poses {
        blocks.push(last.adjoint() * errors.upsilon.left_jacobian());
    } else {
        all.columns_mut(6 * blocks.len(), 3).copy_from(&last.rotation);
    }
    let at = point_rows(&last.act(&robot.home.translation));
    for (k, block) in blocks.iter().enumerate() {
        match seen {
            MeasurementKind::Poses => all.columns_mut(6 * k, 6).copy_from(block),
            MeasurementKind::Points => all.columns_mut(6 * k, 6).copy_from(&(at * block)),
        }
    }
    all
}

#[test]
fn telescoping_jacobian_is_that_of_the_paper() {
    let mut worst: f64 = 0.0;
    for robot in robots() {
        for errors in errors(&robot) {
            for values in configurations(&robot) {
                for seen in [MeasurementKind::Poses, MeasurementKind::Points] {
                    let literal = adjoint_jacobian(&robot, &errors, &values, false, seen);
                    let expected = telescoping(&robot, &errors, &values, seen);
                    // At a whole turn a joint's block vanishes: the terms of its difference set the scale.
                    let scale = expected.norm().max(1.0);
                    worst = larger_or_nan(worst, (literal - expected).norm() / scale);
                }
            }
        }
    }
    println!("literal against telescoping: {worst:.1e}");
    assert!(worst < RELATIVE);
}

#[test]
fn literal_jacobians_are_the_derivatives_of_the_formula() {
    for formulation in PaperFormulation::ALL {
        for seen in [MeasurementKind::Poses, MeasurementKind::Points] {
            let mut worst: f64 = 0.0;
            for robot in robots() {
                for values in configurations(&robot) {
                    let [none, some] = errors(&robot);
                    let cases = if formulation.has_free_screws() { vec![none] } else { vec![none, some] };
                    for errors in cases {
                        let literal = if errors == AdjointErrors::zero(&robot) {
                            jacobian(&robot, &values, formulation, seen)
                        } else {
                            adjoint_jacobian(&robot, &errors, &values, formulation.has_offsets(), seen)
                        };
                        let at = Formula::new(&errors.apply(&robot), &values);
                        let steps = steps(&robot, &errors, formulation, seen);
                        let numeric = differences(&at, &steps, seen);
                        worst = larger_or_nan(worst, (&literal - &numeric).norm() / numeric.norm());
                    }
                }
            }
            println!("{:15} {:6} {worst:.1e}", formulation.word(), seen.word());
            assert!(worst < DIFFERENCES);
        }
    }
}

/// A base in a device's frame, for the columns of the solver.
fn device() -> Pose {
    Pose::from_xyz_rpy([0.3, -0.2, 0.1], [-0.5, 0.9, 2.0])
}

/// theory.md §5 (21), (22) and (23) are the paper's blocks in the axis' own frame, carried to the target by lou2009 (23).
#[test]
fn columns_of_the_solver_are_the_blocks_of_the_paper_seen_at_the_target() {
    let mut worst: f64 = 0.0;
    for robot in robots() {
        let estimate = Estimate::new(&robot, vec![robot.home], device());
        for values in configurations(&robot) {
            let literal = jacobian(&robot, &values, PaperFormulation::Adjoint, MeasurementKind::Poses);
            let packed = PackedValues::new(&robot, &values, values.len());
            let mut chain = RowChain::default();
            chain.evaluate(&Linkage::new(&estimate), &packed, 0, 0);
            let mut to_target = Matrix6::identity();
            to_target.fixed_view_mut::<3, 3>(0, 3).copy_from(&-hat(&chain.target.translation));
            for (i, joint) in robot.joints.iter().enumerate() {
                let block = to_target * device().adjoint() * literal.fixed_columns::<6>(6 * i);
                let in_axis = block * estimate.base_from_axis[i].adjoint();
                let parameter = Parameter::ScrewAxis(ScrewAxis { joint: i, kind: joint.kind });
                let unknowns = if joint.screw.is_prismatic() { vec![3, 4] } else { vec![0, 1, 3, 4] };
                let mut twists = vec![(Vector3::zeros(), Vector3::zeros()); unknowns.len()];
                parameter.model().target_twists(&chain, 0, &mut twists);
                for ((v, w), unknown) in twists.into_iter().zip(unknowns) {
                    let error = (Twist::new(v, w).to_vector() - in_axis.column(unknown)).norm();
                    worst = larger_or_nan(worst, error / block.norm().max(1.0));
                }
            }
            // The solver moves a point along the target's own axes, the paper along those of the base at zero.
            let points = jacobian(&robot, &values, PaperFormulation::Adjoint, MeasurementKind::Points);
            let own = device().rotation * points.columns(points.ncols() - 3, 3) * robot.home.rotation;
            let mut twists = [(Vector3::zeros(), Vector3::zeros()); 3];
            TargetPlace { target: 0 }.target_twists(&chain, 0, &mut twists);
            for ((v, _), column) in twists.into_iter().zip(own.column_iter()) {
                worst = larger_or_nan(worst, (v - column).norm());
            }
        }
    }
    println!("solver against paper: {worst:.1e}");
    assert!(worst < RELATIVE);
}

/// All columns of free screws, including those that the retraction drops, and of offsets: Q_k and r_k of lou2009 (8) in the axis' own frame, also for
/// values beyond a turn and with offsets in the estimate.
#[test]
fn free_screws_and_offsets_of_the_solver_are_those_of_the_paper() {
    let mut worst: f64 = 0.0;
    for robot in robots() {
        for offset in [0.0, 0.3] {
            let mut estimate = Estimate::new(&robot, vec![robot.home], device());
            estimate = estimate.with_offsets(&vec![offset; robot.joints.len()]);
            for readings in configurations(&robot) {
                let values: Vec<f64> = readings.iter().map(|reading| reading + offset).collect();
                let literal = PaperMatrix::new(&robot, &values);
                let packed = PackedValues::new(&robot, &readings, readings.len());
                let mut chain = RowChain::default();
                chain.evaluate(&Linkage::new(&estimate), &packed, 0, 0);
                let mut to_target = Matrix6::identity();
                to_target.fixed_view_mut::<3, 3>(0, 3).copy_from(&-hat(&chain.target.translation));
                let seen = to_target * device().adjoint();
                for (i, joint) in robot.joints.iter().enumerate() {
                    let screw = seen * literal.screw_blocks[i] * estimate.base_from_axis[i].adjoint();
                    let free = FreeScrew::parameter(i, joint.kind);
                    let shift = Parameter::ValueTerm(ValueTerm { joint: i, kind: joint.kind, term: Term::OFFSET });
                    let mut twists = [(Vector3::zeros(), Vector3::zeros()); 6];
                    let dim = free.model().columns().len();
                    free.model().target_twists(&chain, 0, &mut twists[..dim]);
                    for (k, &(v, w)) in twists[..dim].iter().enumerate() {
                        let error = (Twist::new(v, w).to_vector() - screw.column(k)).norm();
                        worst = larger_or_nan(worst, error / screw.norm().max(1.0));
                    }
                    shift.model().target_twists(&chain, 0, &mut twists[..1]);
                    let (v, w) = twists[0];
                    let column = seen * literal.offset_columns[i];
                    worst =
                        larger_or_nan(worst, (Twist::new(v, w).to_vector() - column).norm() / column.norm().max(1.0));
                }
            }
        }
    }
    println!("solver against paper: {worst:.1e}");
    assert!(worst < RELATIVE);
}

/// Random configurations within the robot's limits.
fn within_limits(robot: &Robot, count: usize) -> Vec<Vec<f64>> {
    let mut generator = ChaCha8Rng::seed_from_u64(2009);
    let mut draw =
        |limits: JointLimits| limits.lower + (limits.upper - limits.lower) * random::uniform_number(&mut generator);
    (0..count).map(|_| robot.joints.iter().filter_map(|joint| joint.limits).map(&mut draw).collect()).collect()
}

/// Rank and columns on 60 configurations. Prints the last counted singular value and the first uncounted one, as shares of the largest.
fn rank(robot: &Robot, formulation: PaperFormulation, seen: MeasurementKind) -> (usize, usize) {
    let length_m = robot.reach_m() / 3.0;
    let matrix = stack_matrices(robot, &within_limits(robot, 60), formulation, seen, length_m);
    let (values, rank) = singular_values(&matrix);
    let share = |k: usize| values.get(k).map_or(0.0, |value| value / values[0]);
    let (last, next) = (share(rank - 1), share(rank));
    let what = format!("{} {} {}", robot.name, formulation.word(), seen.word());
    println!("{what}: {rank} of {}, gap {last:.1e} to {next:.1e}", values.len());
    (rank, values.len())
}

/// theory.md §7. At the nominal robot the point is on axis 6.
#[test]
fn ranks_of_the_elbow_are_those_of_the_theory() {
    use PaperFormulation::{Adjoint, AdjointOffsets, Screw, ScrewOffsets};
    let expected = [
        (Adjoint, (30, 42), (27, 39), (25, 39)),
        (Screw, (42, 42), (39, 39), (36, 39)),
        (ScrewOffsets, (42, 48), (39, 45), (36, 45)),
        (AdjointOffsets, (30, 48), (27, 45), (25, 45)),
    ];
    for (formulation, poses, points, points_at_nominal) in expected {
        assert_eq!(rank(&tables::prescribed_robot(), formulation, MeasurementKind::Poses), poses);
        assert_eq!(rank(&tables::nominal_robot(), formulation, MeasurementKind::Poses), poses);
        assert_eq!(rank(&tables::prescribed_robot(), formulation, MeasurementKind::Points), points);
        assert_eq!(rank(&tables::nominal_robot(), formulation, MeasurementKind::Points), points_at_nominal);
    }
}

/// theory.md §7 (35) and (35a) for chains with sliding joints.
#[test]
fn ranks_of_mixed_chains_are_those_of_the_theory() {
    for robot in robots().iter().filter(|robot| has_sliding_joint(robot)) {
        let p = robot.joints.iter().filter(|joint| joint.screw.is_prismatic()).count();
        let r = robot.joints.len() - p;
        for (seen, tool) in [(MeasurementKind::Poses, 6), (MeasurementKind::Points, 3)] {
            for formulation in PaperFormulation::ALL {
                let joints = if formulation.has_free_screws() { 6 * r + 3 * p } else { 4 * r + 2 * p };
                assert_eq!(rank(robot, formulation, seen).0, joints + tool);
            }
        }
    }
}

/// (22a): in the axis' own frame the paper's `θ J_l(ξ θ)` is made of the sine and cosine of θ alone.
#[test]
fn free_screws_are_elementary_in_the_axis_frame() {
    let mut worst: f64 = 0.0;
    for seed in 0..10 {
        let robot = random_chain(6, seed);
        let estimate = Estimate::new(&robot, vec![robot.home], Pose::identity());
        let values = [0.0, 1e-8, 0.4, -2.1, 6.0, 0.9];
        let literal = PaperMatrix::new(&robot, &values);
        for (i, joint) in robot.joints.iter().enumerate() {
            let before = robot.motion(&values[..i]) * estimate.base_from_axis[i];
            let free = before.inverse().adjoint() * literal.screw_blocks[i] * estimate.base_from_axis[i].adjoint();
            let (sine, cosine) = values[i].sin_cos();
            let versine = 1.0 - cosine;
            let turning = Matrix3::new(sine, -versine, 0.0, versine, sine, 0.0, 0.0, 0.0, values[i]);
            if joint.screw.is_prismatic() {
                let shift = free.fixed_view::<3, 3>(0, 0) - Matrix3::identity() * values[i];
                worst = larger_or_nan(worst, shift.norm());
            } else {
                let mut expected = Matrix6::zeros();
                expected.fixed_view_mut::<3, 3>(0, 0).copy_from(&turning);
                expected.fixed_view_mut::<3, 3>(3, 3).copy_from(&turning);
                worst = larger_or_nan(worst, (free - expected).norm());
            }
        }
    }
    println!("largest difference {worst:.1e}");
    assert!(worst < 1e-13);
}
