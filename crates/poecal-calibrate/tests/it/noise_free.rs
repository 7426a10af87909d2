//! Without noise a calibration is exact: it predicts configurations that it has not seen, and its rank is that of theory.

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, Screw, Twist};
use poecal_calibrate::{Calibration, CalibrationOptions, DeviceFrameKnowledge, calibrate, nominal_estimate};
use poecal_fit::analysis::{AnalysisSetup, identifiability};
use poecal_fit::parameters::{Parameter, ScrewAxis, TargetPlace};
use poecal_fit::problem::Problem;
use poecal_fit::state::{PackedValues, Session};
use poecal_model::measurement::Noise;
use poecal_model::robot::{JointKind, Robot, Sizes};
use poecal_model::simulate::{
    SessionKind, Simulation, SimulationResult, elbow, gantry, random_chain, scara, seven_axis,
};
use poecal_numerics::solve::LeastSquares;
use poecal_testing::sessions::geometry;
use poecal_testing::trials::choose_some;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;
use rayon::prelude::*;

/// Rounding of positions some metres away, magnified by a condition number of up to a few thousand.
const HELD_OUT_M: f64 = 1e-9;
/// Table II of lou2009, right column, mm: `(v, ω)` of the six screws.
const IDENTIFIED: [[f64; 6]; 6] = [
    [0.0222, -0.0144, 0.0009, 0.0194, -0.0317, 0.9993],
    [0.1764, 2.8933, 151.2188, 0.0504, 0.9985, -0.0192],
    [583.8102, 14.9619, -154.0245, 0.0307, -0.9993, 0.0195],
    [60.3165, -690.8776, 1.7673, -0.9958, -0.0870, -0.0290],
    [-733.2256, -29.1784, 798.2115, -0.0143, 0.9996, 0.0234],
    [-17.1142, -702.2271, -0.9022, -0.9984, 0.0244, -0.0517],
];
/// The same table's last row: the point on the tool, m.
const IDENTIFIED_POINT: [f64; 3] = [0.839_010_0, -0.005_030_0, 0.724_974_0];
/// Iterations reported by lou2009 are 6 and 10; the step here is the same, in better coordinates.
const ELBOW_ITERATIONS: [(SessionKind, usize, usize); 2] = [(SessionKind::POSE, 30, 5), (SessionKind::POINT, 100, 7)];

/// Exact points of the elbow whose tool is displaced by this across the last axis, on which the nominal one lies: they hardly determine the axis, so
/// that the prior biases it. lou2009 needs 10 iterations for its points.
const TOOL_ERROR_M: f64 = 9e-3;
const POINTS: usize = 80;
const POINT_ITERATIONS: usize = 7;

const EXACT: Simulation = Simulation {
    error_rotation_rad: 0.017,
    error_position_m: 2e-3,
    noise_position_m: 0.0,
    noise_rotation_rad: 0.0,
    count: 150,
    seed: 1,
    device_anywhere: true,
    terms: Sizes::NONE,
    gravity: Vector3::new(0.0, 0.0, -1.0),
};

/// The elbow as lou2009 identified it. The paper states no orientation of its tip: the nominal one is used.
fn actual_elbow() -> Robot {
    let screws: Vec<Screw> = IDENTIFIED
        .iter()
        .map(|row| {
            let [a, b, c, x, y, z] = *row;
            let twist = Twist::new(Vector3::new(a, b, c) * 1e-3, Vector3::new(x, y, z));
            Screw::project(&twist).unwrap()
        })
        .collect();
    let mut robot = elbow().with_screws(&screws);
    robot.home = Pose::new(elbow().home.rotation, IDENTIFIED_POINT.into());
    robot
}

fn simulated_elbow(kind: SessionKind, count: usize) -> SimulationResult {
    let simulation = Simulation { count, device_anywhere: false, ..EXACT };
    simulation.measure(&elbow(), actual_elbow(), kind, &mut ChaCha8Rng::seed_from_u64(7)).unwrap()
}

/// Structural rank: 4r+2p+6 for poses and 4r+2p+3 for points.
fn structural_rank(robot: &Robot, kind: SessionKind) -> usize {
    let screws: usize = robot.joints.iter().map(|j| if j.kind == JointKind::Revolute { 4 } else { 2 }).sum();
    screws + if kind == SessionKind::POINT { 3 } else { 6 }
}

fn held_out_m(calibration: &Calibration) -> f64 {
    calibration.accuracy.held_out.unwrap().calibrated.position_mm().max * 1e-3
}

#[test]
fn papers_elbow_is_calibrated_in_fewer_iterations_than_in_the_paper() {
    for (kind, fitted, most) in ELBOW_ITERATIONS {
        let made = simulated_elbow(kind, fitted + 50);
        let options = CalibrationOptions {
            frame: DeviceFrameKnowledge::Base,
            held_out: Some(50.0 / (fitted + 50) as f64),
            // The paper has no prior.
            tolerance: None,
            ..Default::default()
        };
        let result = calibrate(&made.nominal, &made.data, &options).unwrap();
        println!(
            "{kind:?}, m = {fitted}: {} iterations ({:?}), held out {:.1e} m, rank {}",
            result.solver.iterations,
            result.solver.termination,
            held_out_m(&result),
            result.identifiability.rank
        );
        assert_eq!(result.fit_rows.len(), fitted);
        assert!(held_out_m(&result) < HELD_OUT_M);
        assert!(result.solver.iterations <= most && result.solver.termination.is_success());
        assert_eq!(result.identifiability.rank, structural_rank(&elbow(), kind));
    }
}

#[test]
fn exact_points_of_the_elbow_take_few_iterations_whatever_its_errors() {
    let nominal = elbow();
    let most = (1..=12).map(|seed| {
        let simulation = Simulation { count: POINTS, device_anywhere: false, seed, ..EXACT };
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        let mut actual = simulation.perturb(&nominal, &mut generator);
        actual.home.translation.z += TOOL_ERROR_M;
        let made = simulation.measure(&nominal, actual, SessionKind::POINT, &mut generator).unwrap();
        let options = CalibrationOptions { frame: DeviceFrameKnowledge::Base, held_out: Some(0.0), ..geometry() };
        let result = calibrate(&made.nominal, &made.data, &options).unwrap();
        let off_m = result.accuracy.training.calibrated.position_mm().max * 1e-3;
        let solver = &result.solver;
        println!("seed {seed}: {} iterations ({:?}), left {off_m:.1e} m", solver.iterations, solver.termination);
        assert!(solver.termination.is_success());
        assert!(off_m < HELD_OUT_M);
        solver.iterations
    });
    assert!(most.max().unwrap() <= POINT_ITERATIONS);
}

/// The nominal point lies on nominal axis 6: turning and shifting that axis have the same effect on the point.
#[test]
fn elbow_has_rank_25_where_a_fit_of_points_starts() {
    let made = simulated_elbow(SessionKind::POINT, 100);
    let robot = &made.nominal;
    let packed = PackedValues::new(robot, made.data.all_readings(), robot.joints.len());
    let screws = robot.joints.iter().enumerate();
    let mut free: Vec<Parameter> =
        screws.map(|(joint, it)| Parameter::ScrewAxis(ScrewAxis { joint, kind: it.kind })).collect();
    free.push(Parameter::TargetPlace(TargetPlace { target: 0 }));
    let noise = Noise::new(1e-3, 1e-3);
    let session = Session::new(robot, &made.data, &packed, false).with_length(robot.reach_m() / 3.0);
    let problem = Problem::new(session, (0..100).collect(), free, noise);
    let estimate = nominal_estimate(robot, &made.data);
    let setup = AnalysisSetup { session, rows: problem.rows(), estimate: &estimate, layout: problem.layout(), noise };
    // The residual at the start is not noise: the rank is that of the Jacobian itself.
    let found = identifiability(&setup, &problem.normal(&estimate).gram, 0.0);
    println!("rank {} of {}", found.rank, found.parameters);
    found.unidentifiable.iter().for_each(|direction| println!("    {}", direction.description));
    assert_eq!((found.rank, found.parameters), (25, 27));
    assert!(found.unidentifiable.iter().all(|direction| direction.joints == ["joint6"]));
}

#[test]
fn robots_of_every_structure_are_recovered_from_anywhere() {
    let mut robots = vec![elbow(), scara(), gantry(), seven_axis()];
    for joints in 2..=12 {
        robots.extend((0..4).map(|seed| random_chain(joints, seed)));
    }
    let cases: Vec<(&Robot, SessionKind)> = robots
        .iter()
        .flat_map(|robot| [SessionKind::POSE, SessionKind::POINT, SessionKind::MIXED].map(|kind| (robot, kind)))
        .collect();
    let cases = choose_some(cases);
    let failures: Vec<String> = cases
        .par_iter()
        .filter_map(|&(robot, kind)| {
            let made = EXACT.run(robot, kind).unwrap();
            let result = calibrate(robot, &made.data, &geometry()).unwrap();
            let expected = structural_rank(robot, kind);
            let line = format!(
                "{:12} {kind:?}: held out {:.1e} m, rank {} of {expected}, {} iterations, condition {:.0}",
                robot.name,
                held_out_m(&result),
                result.identifiability.rank,
                result.solver.iterations,
                result.identifiability.condition
            );
            println!("{line}");
            let good = held_out_m(&result) < HELD_OUT_M && result.identifiability.rank == expected;
            (!good).then_some(line)
        })
        .collect();
    println!("{} cases, {} failed", cases.len(), failures.len());
    assert!(failures.is_empty(), "{failures:#?}");
}
