//! Gauge freedom: predictions are the same in all parameterisations of one robot, and the chosen one is nearest to nominal.

use poecal_arm::lie::{Pose, rotation};
use poecal_calibrate::{Calibration, CalibrationOptions, calibrate, nominal_estimate, radian_m};
use poecal_fit::gauge::base_motion;
use poecal_fit::state::{Estimate, Linkage, PackedValues, RowChain};
use poecal_model::measurement::{Dataset, Measurement};
use poecal_model::offsets::TaughtFrames;
use poecal_model::robot::{Robot, Sizes};
use poecal_model::simulate::{
    SessionKind, Simulation, SimulationResult, elbow, gantry, random, random_chain, random_configuration, scara,
    seven_axis,
};
use poecal_testing::largest::larger_or_nan;
use poecal_testing::sessions as common;
use poecal_testing::sessions::geometry;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

/// Far above rounding at some metres, far below any device.
const SAME: f64 = 1e-9;
/// A gauge is settled to the tolerance of its own iteration.
const SETTLED: f64 = 1e-9;
/// Undetermined directions are settled in a few rounds, each a thousandth of the one before; the last may leave nanometres.
const STAYS: f64 = 1e-7;

fn robots() -> Vec<Robot> {
    vec![elbow(), scara(), gantry(), seven_axis(), random_chain(5, 2), random_chain(9, 4)]
}

fn simulate_case(robot: &Robot, kind: SessionKind) -> SimulationResult {
    common::simulate_session(robot, kind, 80, 3)
}

fn calibrate_made(made: &SimulationResult) -> Calibration {
    calibrate(&made.nominal, &made.data, &CalibrationOptions { tolerance: None, ..geometry() }).unwrap()
}

fn pack_values(robot: &Robot, data: &Dataset) -> PackedValues {
    PackedValues::from_dataset(robot, data)
}

/// Largest distance and angle between predictions of two estimates.
fn difference(a: &Estimate, b: &Estimate, data: &Dataset, packed: &PackedValues) -> (f64, f64) {
    let (a, b) = (Linkage::new(a), Linkage::new(b));
    let (mut at_a, mut at_b) = (RowChain::default(), RowChain::default());
    (0..packed.rows()).fold((0.0, 0.0), |(shift, turn), row| {
        let target = data.observations[row].target;
        at_a.evaluate(&a, packed, row, target);
        at_b.evaluate(&b, packed, row, target);
        pose_difference(&at_a.target, &at_b.target, (shift, turn))
    })
}

fn pose_difference(a: &Pose, b: &Pose, (shift, turn): (f64, f64)) -> (f64, f64) {
    let angle = rotation::log(&(a.rotation * b.rotation.transpose())).norm();
    (larger_or_nan(shift, (a.translation - b.translation).norm()), larger_or_nan(turn, angle))
}

/// Objective of the gauge: tilts of the screws as arcs, and shifts seen from the nominal joint's origin (m²).
fn deviation(estimate: &Estimate, robot: &Robot) -> f64 {
    let length_m = robot.reach_m() / 3.0;
    estimate.screws().iter().zip(&robot.joints).fold(0.0, |sum, (screw, joint)| {
        let tilt = (screw.direction() - joint.screw.direction()).norm() * length_m;
        let shift = screw.nearest_point(&joint.frame.translation) - joint.frame.translation;
        sum + tilt.powi(2) + shift.norm_squared()
    })
}

#[test]
fn predictions_do_not_depend_on_the_gauge() {
    let mut generator = ChaCha8Rng::seed_from_u64(1);
    for robot in robots() {
        let made = simulate_case(&robot, SessionKind::MIXED);
        let estimate = calibrate_made(&made).models.calibrated;
        let rows = pack_values(&robot, &made.data);
        let motion = Pose::new(random::rotation(&mut generator), random::direction(&mut generator) * 2.0);
        let (shift, turn) = difference(&estimate, &estimate.rebase(&motion), &made.data, &rows);
        println!("{:12} {shift:.1e} m, {turn:.1e} rad", robot.name);
        assert!(shift < SAME && turn < SAME);
    }
}

#[test]
fn gauge_brings_the_screws_nearest_to_nominal_once_and_for_all() {
    let mut generator = ChaCha8Rng::seed_from_u64(2);
    for robot in robots() {
        let made = simulate_case(&robot, SessionKind::POSE);
        let chosen = calibrate_made(&made).models.calibrated;
        let packed = PackedValues::from_dataset(&robot, &made.data);
        let length_m = radian_m(&robot, &packed);
        let targets = nominal_estimate(&robot, &made.data).base_from_target;
        let again = base_motion(&chosen, &robot, &targets, length_m).log().to_vector().norm();
        let other = chosen.rebase(&Pose::exp(&common::random_twist(0.3, 0.2, &mut generator)));
        let back = other.rebase(&base_motion(&other, &robot, &targets, length_m));
        let [least, before, after] = [&chosen, &other, &back].map(|it| deviation(it, &robot).sqrt());
        println!(
            "{:12} second motion {again:.1e}; deviation {:.3} mm, moved away {:.1} mm, back {:.3} mm",
            robot.name,
            least * 1e3,
            before * 1e3,
            after * 1e3
        );
        assert!(again < SETTLED);
        assert!(least < before && (after - least).abs() < SETTLED);
    }
}

/// Deviation of one joint's screw from nominal.
fn joint_deviation(result: &Calibration, joint: usize) -> f64 {
    let screw = result.robot.joints[joint].screw.twist().to_vector();
    (screw - result.nominal.joints[joint].screw.twist().to_vector()).norm()
}

/// A joint that does not move leaves its own axis undetermined, or some combination with its neighbours: nominal is kept there.
#[test]
fn what_the_data_leave_open_stays_nominal() {
    for (value, joint) in [(0.0, 2), (0.6, 2), (0.6, 0), (-1.1, 5)] {
        let mut made = simulate_case(&elbow(), SessionKind::POSE);
        let mut still = Dataset::new(made.nominal.reading_names());
        let exact = made.device_from_base;
        for row in 0..made.data.len() {
            let mut readings = made.data.readings(row).to_vec();
            readings[joint] = value;
            let pose = exact * made.actual.forward_kinematics(&readings);
            still.push(&readings, None, Measurement::of_pose(&pose)).unwrap();
        }
        made.data = still;
        let result = calibrate_made(&made);
        let held_out_m = result.accuracy.held_out.unwrap().calibrated.position_mm().max * 1e-3;
        let deviation = joint_deviation(&result, joint);
        // At zero only the joint's own axis is undetermined: it is exactly nominal. Elsewhere the later axes follow it.
        assert!(value != 0.0 || deviation < STAYS, "{deviation:e}");
        println!(
            "joint {} at {value}: rank {} of {}, held out {held_out_m:.1e} m, its screw {deviation:.1e} off nominal",
            joint + 1,
            result.identifiability.rank,
            result.identifiability.parameters
        );
        assert!(held_out_m < SAME);
        assert!(result.identifiability.rank < result.identifiability.parameters);
        let open = &result.identifiability.unidentifiable;
        assert!(open.iter().any(|it| it.joints.contains(&format!("joint{}", joint + 1))), "{open:?}");
    }
}

/// Targets of a session: name, whether a frame, and pose in the tip frame.
type Target = (Option<&'static str>, bool, Pose);

fn session(robot: &Robot, targets: &[Target]) -> SimulationResult {
    let simulation = Simulation { count: 0, seed: 5, ..Simulation::default() };
    let mut made = simulation.run(robot, SessionKind::POSE).unwrap();
    let mut generator = ChaCha8Rng::seed_from_u64(5);
    for _ in 0..60 {
        let readings = random_configuration(robot, &mut generator);
        for (name, is_frame, tip_from_target) in targets {
            let mut pose = made.device_from_base * made.actual.forward_kinematics(&readings) * *tip_from_target;
            pose.translation += random::normal_vector(&mut generator) * 5e-5;
            let measurement =
                if *is_frame { Measurement::of_pose(&pose) } else { Measurement::point(pose.translation) };
            made.data.push(&readings, *name, measurement).unwrap();
        }
    }
    made
}

/// The written robot, its tip and its targets, compared with the fitted estimate.
#[test]
fn calibrated_robot_predicts_what_the_estimate_predicts() {
    let shifted = |x: f64| Pose::from_xyz_rpy([x, 0.1, 0.2], [0.3, -1.0, 2.0]);
    let cases: [&[Target]; 4] = [
        &[(None, true, shifted(0.0))],
        &[(None, false, shifted(0.1))],
        &[(Some("a"), false, shifted(0.0)), (Some("b"), true, shifted(0.2)), (Some("c"), false, shifted(-0.1))],
        &[(None, true, shifted(0.0)), (Some("ball"), false, shifted(0.15))],
    ];
    for robot in [elbow(), gantry(), random_chain(7, 1)] {
        for targets in cases {
            let made = session(&robot, targets);
            let result = calibrate_made(&made);
            let device_from_base = result.base_from_device.inverse();
            let rows = pack_values(&robot, &made.data);
            let (linkage, mut chain) = (Linkage::new(&result.models.calibrated), RowChain::default());
            let mut largest = (0.0, 0.0);
            for row in 0..made.data.len() {
                let target = &result.targets[made.data.observations[row].target];
                chain.evaluate(&linkage, &rows, row, made.data.observations[row].target);
                let tip = device_from_base * result.robot.forward_kinematics(made.data.readings(row));
                let mut predicted = tip * target.tip_from_target;
                if !target.is_frame {
                    predicted.rotation = chain.target.rotation;
                }
                largest = pose_difference(&predicted, &chain.target, largest);
            }
            let names: Vec<_> = targets.iter().map(|it| (it.0.unwrap_or("tip"), it.1)).collect();
            println!("{:12} {names:?}: {:.1e} m, {:.1e} rad", robot.name, largest.0, largest.1);
            assert!(largest.0 < SAME && largest.1 < SAME);
            check_tip(&result, targets);
        }
    }
}

/// An unnamed target is the tip; otherwise the tip stays on the last joint as nominally.
fn check_tip(result: &Calibration, targets: &[Target]) {
    let unnamed = result.targets.iter().find(|target| target.name.is_none());
    let nominal = result.nominal.last_joint_from_tip();
    let found = result.robot.last_joint_from_tip();
    let (_, turn) = pose_difference(&found, &nominal, (0.0, 0.0));
    match unnamed {
        Some(target) => {
            assert!(pose_difference(&target.tip_from_target, &Pose::identity(), (0.0, 0.0)).0 < SAME);
            // Its position was some 0.2 m from the nominal tip.
            assert!((found.translation - nominal.translation).norm() > 0.1);
            assert!(targets[0].1 || turn < SAME);
        }
        None => {
            assert!((found.translation - nominal.translation).norm() < SAME && turn < SAME);
            let placed = result.targets.iter().zip(targets);
            for (target, (_, _, truth)) in placed {
                let off = target.tip_from_target.translation - truth.translation;
                // The error of the target, seen from the nominal tip, equals that of the tip itself.
                assert!(off.norm() < 0.05, "{off}");
            }
        }
    }
}

/// Share by which the distances of two models may exceed those after a rigid motion of one: tip and target have one base.
const OF_THE_BASE: f64 = 1.1;

/// Distances (RMS, metres) between the tips and between the targets of the calibrated and the corrected model of a session in the base frame, each
/// with the remaining distance after the best rigid motion. The last number is the difference of the corrected robot's predictions from the fit's in
/// the device's frame.
fn both_models(robot: &Robot, kind: SessionKind, seed: u64, move_tip: bool) -> ([(f64, f64); 2], f64) {
    let simulation = Simulation { count: 60, seed, terms: Sizes::COMMON, ..Simulation::default() };
    let made = simulation.run(robot, kind).unwrap();
    let options = CalibrationOptions { move_tip, ..CalibrationOptions::default() };
    let found = calibrate(&made.nominal, &made.data, &options).unwrap();
    let corrected = found.correction.as_deref().unwrap();
    assert!(corrected.has_terms());
    let target = [found.targets[0].tip_from_target, corrected.targets[0].tip_from_target];
    let tips = |robot: &Robot| -> Vec<Pose> {
        found.fit_rows.iter().map(|&row| robot.forward_kinematics(made.data.readings(row as usize))).collect()
    };
    let [calibrated, with_terms] = [tips(&found.robot), tips(&corrected.robot)];
    let places = |of: fn(&Pose, &Pose) -> Pose| {
        let pairs = with_terms.iter().zip(&calibrated);
        let pairs: Vec<_> =
            pairs.map(|(a, b)| (of(a, &target[1]).translation, of(b, &target[0]).translation)).collect();
        let rms = |motion: &Pose| {
            let squares: f64 = pairs.iter().map(|(a, b)| (motion.act(a) - b).norm_squared()).sum();
            (squares / pairs.len() as f64).sqrt()
        };
        let rigid = TaughtFrames::with_points(&[], &pairs, 1.0, false).base;
        (rms(&Pose::identity()), rms(&rigid))
    };
    let device_from_base = corrected.stations[0].base_from_device.inverse();
    let errors = corrected.errors(&made.data, &found.fit_rows);
    let differences = with_terms.iter().zip(&found.fit_rows).zip(errors).map(|((tip, &row), error)| {
        let predicted = (device_from_base * *tip * target[1]).translation;
        let measured = made.data.observations[row as usize].measurement.pose().translation;
        (measured - predicted - error.position_m()).norm()
    });
    ([places(|tip, _| *tip), places(|tip, target| *tip * *target)], differences.fold(0.0, larger_or_nan))
}

#[test]
fn the_corrected_and_the_calibrated_model_have_one_base_and_one_tip() {
    for (robot, kind, move_tip) in [
        (elbow(), SessionKind::POINT, false),
        (elbow(), SessionKind::POSE, false),
        (seven_axis(), SessionKind::POINT, false),
        (seven_axis(), SessionKind::POINT, true),
    ] {
        let (both, otherwise) = both_models(&robot, kind, 5, move_tip);
        println!("{:12} move_tip {move_tip}: {both:?}, otherwise {otherwise:.1e}", robot.name);
        for (apart, left) in both {
            assert!(apart < OF_THE_BASE * left);
        }
        assert!(otherwise < SAME);
    }
}
