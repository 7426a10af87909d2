//! The verdict and the warnings report the faults of a session, and none for a sound one.

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, rotation};
use poecal_calibrate::{Calibration, CalibrationOptions, DeviceFrameKnowledge, Level, calibrate};
use poecal_fit::forensics::DiagnosisKind;
use poecal_model::measurement::{Dataset, Measurement, Noise, Set};
use poecal_model::robot::Robot;
use poecal_model::simulate::{GrossErrors, SessionKind, Simulation, SimulationResult, elbow, scara, seven_axis};
use poecal_testing::sessions::{calibrate_session as fit, geometry, simulate_session};
use poecal_testing::trials::{choose_some, trials};
use rayon::prelude::*;

fn session(count: usize, seed: u64) -> SimulationResult {
    simulate_session(&elbow(), SessionKind::POSE, count, seed)
}

/// The same poses, moved and read as these functions state.
fn change_session(
    made: &SimulationResult,
    shift: impl Fn(usize) -> Vector3<f64>,
    reading: impl Fn(usize, &mut Vec<f64>),
) -> Dataset {
    let mut data = Dataset::new(made.data.reading_names().to_vec());
    for row in 0..made.data.len() {
        let mut pose = made.data.observations[row].measurement.pose();
        pose.translation += shift(row);
        let mut readings = made.data.readings(row).to_vec();
        reading(row, &mut readings);
        data.push(&readings, None, Measurement::of_pose(&pose)).unwrap();
    }
    data
}

fn warns(found: &Calibration, words: &str) -> bool {
    found.warnings.iter().any(|warning| warning.contains(words))
}

#[test]
fn sound_sessions_are_good_and_without_a_warning() {
    let robots = [elbow(), scara(), seven_axis()];
    let sessions = trials(90);
    let faults: Vec<String> = (sessions.seeds())
        .into_par_iter()
        .flat_map_iter(|seed| {
            let simulation = Simulation { count: 80, seed: 300 + seed, ..Simulation::default() };
            let kind = if seed % 2 == 0 { SessionKind::POSE } else { SessionKind::POINT };
            let made = simulation.run(&robots[seed as usize % 3], kind).unwrap();
            let found = fit(&made.nominal, &made.data);
            let words = format!("{seed}: {:?} {:?}", found.verdict, found.warnings);
            (found.verdict.level != Level::Good || !found.warnings.is_empty()).then_some(words)
        })
        .collect();
    println!("{} of {} sound sessions are doubted: {faults:#?}", faults.len(), sessions.count);
    // Chance makes one block in many of a small session look worse than random rows.
    let share = 4.0 / 90.0 + sessions.more_of_a_share(4.0 / 90.0);
    assert!(faults.len() as f64 <= share * sessions.count as f64);
}

#[test]
fn rows_that_are_known_to_be_wrong_do_not_decide() {
    for (share, level) in [(0.1, Level::Good), (0.3, Level::InsideSampledRange)] {
        for seed in trials(5).seeds() {
            let mut made = session(80, 40 + seed);
            let gross = GrossErrors { share, seed, ..GrossErrors::default() };
            gross.spoil(&mut made.data);
            let found = fit(&made.nominal, &made.data);
            println!("{share}: {:?}", found.verdict);
            assert_eq!(found.verdict.level, level);
        }
    }
}

#[test]
fn a_few_rows_of_another_form_do_not_doubt_the_input() {
    for seed in choose_some([71, 72, 73]) {
        let made = session(80, seed);
        // A board whose pose is mistaken for its mirror image: every sixteenth position is on the other side of the device.
        let flipped = |row: usize| match row % 16 {
            0 => -2.0 * made.data.observations[row].measurement.pose().translation,
            _ => Vector3::zeros(),
        };
        let found = fit(&made.nominal, &change_session(&made, flipped, |_, _| {}));
        println!("{:?}", found.verdict);
        assert_eq!(found.robustness.suspects().collect::<Vec<_>>(), [0, 16, 32, 48, 64]);
        assert_eq!(found.verdict.level, Level::Good);
        // Without these rows it would be another robot.
        let error_mm = found.accuracy.training.registered.position_mm().rms;
        assert!(error_mm > 0.15 * 1e3 * made.data.spread_m(&made.data.all_rows()), "{error_mm}");
    }
}

#[test]
fn a_device_that_was_moved_is_named_with_its_place() {
    for (seed, from) in choose_some([(1, 40), (2, 25), (3, 60)]) {
        let made = session(80, seed);
        let moved = Vector3::new(0.0, 4e-3, -3e-3);
        let data = change_session(&made, |row| if row < from { Vector3::zeros() } else { moved }, |_, _| {});
        let found = fit(&made.nominal, &data);
        println!("{:?}", found.warnings);
        assert_eq!(found.verdict.level, Level::DoNotUse);
        assert!(warns(&found, "have been moved"));
    }
}

#[test]
fn noise_in_a_wrong_unit_is_doubted() {
    let made = session(80, 9);
    let smaller = "times smaller than the stated noise";
    // Factors up to 5 cm, 100 m, and the largest numbers.
    for (factor, words) in
        [(1e-3, "times the stated noise"), (1e3, smaller), (2e6, smaller), (1e12, smaller), (1.0, "")]
    {
        let options = CalibrationOptions { sigma: Noise::new(5e-5 * factor, 1.7e-4).map(Some), ..geometry() };
        let found = calibrate(&made.nominal, &made.data, &options).unwrap();
        println!("{factor}: {:?}", found.warnings);
        if words.is_empty() {
            assert!(found.warnings.is_empty());
        } else {
            assert!(warns(&found, words));
        }
    }
}

#[test]
fn a_zero_of_a_joint_is_named_and_taken_in() {
    let made = session(80, 3);
    let data = change_session(&made, |_| Vector3::zeros(), |_, readings| readings[2] += 6f64.to_radians());
    let found = fit(&made.nominal, &data);
    println!("{:?} {:?}", found.verdict, found.diagnosis);
    assert!(found.diagnosis.iter().any(|it| it.kind == DiagnosisKind::JointZero));
    assert_eq!(found.verdict.level, Level::Good);
    assert!(found.trust.joints.iter().all(|joint| joint.suspicious.is_none()));
}

#[test]
fn too_few_rows_are_never_good() {
    let made = session(12, 5);
    let found = fit(&made.nominal, &made.data);
    println!("{:?}", found.verdict);
    assert!(found.verdict.level < Level::Good);
}

/// Two rows at the ends of a joint's range do not make the range sampled.
#[test]
fn stragglers_do_not_count_as_coverage() {
    let mut made =
        Simulation { count: 400, seed: 8, ..Simulation::default() }.run(&elbow(), SessionKind::POSE).unwrap();
    let middle = |row: usize| (made.data.readings(row)[1] - 0.6).abs() < 0.35;
    let far = |row: usize| (made.data.readings(row)[1] - 0.6).abs() > 2.3;
    let mut data = Dataset::new(made.data.reading_names().to_vec());
    let kept: Vec<usize> =
        (0..400).filter(|&row| middle(row)).chain((0..400).filter(|&row| far(row)).take(1)).collect();
    for row in kept {
        let pose = made.data.observations[row].measurement.pose();
        data.push(made.data.readings(row), None, Measurement::of_pose(&pose)).unwrap();
    }
    made.data = data;
    let options = CalibrationOptions { held_out: Some(0.0), ..geometry() };
    let found = calibrate(&made.nominal, &made.data, &options).unwrap();
    let coverage = &found.trust.coverage[1];
    println!("{} rows, {coverage:?}", made.data.len());
    assert!(made.data.len() >= 50 && coverage.isolated_share > 0.4);
    assert!(found.verdict.reasons.iter().any(|reason| reason.contains("joint2 was moved through")));
}

/// Mistakes that a fit absorbs or cannot absorb: none of the results may be used.
#[test]
fn what_is_not_this_robot_is_not_to_be_used() {
    let made = Simulation { count: 80, seed: 12, device_anywhere: true, ..Simulation::default() }
        .run(&elbow(), SessionKind::POSE)
        .unwrap();
    let level = |name: &str, robot: &Robot, data: &Dataset, frame| {
        let options = CalibrationOptions { frame, ..geometry() };
        let found = calibrate(robot, data, &options).unwrap();
        println!("{name}: {:?} {:?}", found.verdict.level, found.verdict.reasons);
        assert_eq!(found.verdict.level, Level::DoNotUse, "{name}");
    };
    let anywhere = DeviceFrameKnowledge::Unknown;
    // Another robot with the same number of joints: its axes are shifted and turned.
    let mut other = elbow();
    for (k, joint) in other.joints.iter_mut().enumerate() {
        let away = 0.15 * Vector3::new((k as f64).sin(), (2.0 * k as f64).cos(), 0.3);
        let turn = rotation::exp(&(Vector3::new(1.0, 2.0, 0.5).normalize() * if k % 2 == 0 { 1.5 } else { 0.0 }));
        let motion = Pose::new(turn, joint.frame.translation + away - turn * joint.frame.translation);
        joint.screw = joint.screw.transform(&motion);
        joint.frame = motion * joint.frame;
    }
    level("another robot", &other, &made.data, anywhere);
    level("a device that is not at the base", &elbow(), &made.data, DeviceFrameKnowledge::Base);
    let turned = |of: &dyn Fn(usize, &Pose) -> nalgebra::Matrix3<f64>| {
        let mut data = Dataset::new(made.data.reading_names().to_vec());
        for row in 0..made.data.len() {
            let pose = made.data.observations[row].measurement.pose();
            let pose = Pose::new(of(row, &pose), pose.translation);
            data.push(made.data.readings(row), None, Measurement::of_pose(&pose)).unwrap();
        }
        data
    };
    level("one orientation for all", &elbow(), &turned(&|_, _| nalgebra::Matrix3::identity()), anywhere);
    // Angles in degrees that were read as radians.
    let scrambled = turned(&|_, pose| rotation::exp(&(rotation::log(&pose.rotation) * 57.3)));
    level("angles of another unit", &elbow(), &scrambled, anywhere);
}

/// Judging rows that are copies of fitted rows are refused, with other digits too.
#[test]
fn copies_are_nothing_to_judge_by() {
    let made = session(40, 7);
    let mut data = made.data.clone();
    for row in 0..40 {
        let mut pose = made.data.observations[row].measurement.pose();
        pose.translation *= 1.0 + 1e-15;
        data.push(made.data.readings(row), None, Measurement::of_pose(&pose)).unwrap();
    }
    for (row, observation) in data.observations.iter_mut().enumerate() {
        observation.set = Some(if row < 40 { Set::Fit } else { Set::HeldOut });
    }
    let error = calibrate(&made.nominal, &data, &geometry()).unwrap_err();
    println!("{error}");
    assert!(error.to_string().contains("40 of 40 held-out rows that repeat fitted rows"));
}

/// The registered figures are the best that tool and frame achieve for positions, for any orientations.
#[test]
fn registered_positions_are_the_best_there_are() {
    for seed in 0..10 {
        let made = Simulation { count: 60, seed, error_rotation_rad: 0.02, ..Simulation::default() }
            .run(&elbow(), SessionKind::POSE)
            .unwrap();
        let mut points = Dataset::new(made.data.reading_names().to_vec());
        for row in 0..made.data.len() {
            let position = made.data.observations[row].measurement.pose().translation;
            let seen = Measurement::point(position);
            points.push(made.data.readings(row), None, seen).unwrap();
        }
        let rms = |data: &Dataset| {
            let options = CalibrationOptions { held_out: Some(0.0), ..geometry() };
            calibrate(&made.nominal, data, &options).unwrap().accuracy.training.registered.position_mm().rms
        };
        let (poses, best) = (rms(&made.data), rms(&points));
        println!("{seed}: registered {poses:.4} mm, the best {best:.4} mm");
        assert!(poses < 1.01 * best);
    }
}
