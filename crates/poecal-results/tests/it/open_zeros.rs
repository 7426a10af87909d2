//! Zeros of joints whose axes are held: stated bounds hold, and a zero that a free device or target hides is not determined.

use nalgebra::Vector3;
use poecal_arm::lie::Pose;
use poecal_calibrate::{BlockChoice, Calibration, CalibrationOptions, Level, calibrate};
use poecal_fit::analysis::Cause;
use poecal_model::offsets::into_screws;
use poecal_model::robot::{Robot, Term};
use poecal_model::simulate::{SessionKind, Simulation, SimulationResult, elbow, random, seven_axis};
use poecal_results::calibration_file::{CalibrationFile, Inputs};
use poecal_testing::trials::trials;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

/// A visit to a robot that differs from its model only by its zeros, with a reflector 100 mm beside the tip.
fn visit(robot: &Robot, zeros: &[f64], seed: u64) -> SimulationResult {
    let mut model = robot.clone();
    model.home = model.home * Pose::from_translation(Vector3::new(0.03, 0.1, 0.02));
    let exact = Simulation {
        count: 40,
        seed,
        error_rotation_rad: 0.0,
        error_position_m: 0.0,
        noise_position_m: 5e-5,
        ..Simulation::default()
    };
    let mut made = exact.run(&model, SessionKind::POINT).unwrap();
    let actual = into_screws(&model, zeros).unwrap();
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    for row in 0..made.data.len() {
        let seen = made.device_from_base * actual.forward_kinematics(made.data.readings(row));
        let place = seen.translation + random::normal_vector(&mut generator) * 5e-5;
        made.data.observations[row].measurement = poecal_model::measurement::Measurement::point(place);
    }
    made
}

fn calibrate_made(
    made: &SimulationResult,
    fix: &[&str],
    free: Vec<String>,
    devices: Vec<Pose>,
) -> (Calibration, CalibrationFile) {
    let blocks = BlockChoice { fix: fix.iter().map(|it| (*it).to_owned()).collect(), free };
    let options = CalibrationOptions { blocks, devices, ..CalibrationOptions::default() };
    let found = calibrate(&made.nominal, &made.data, &options).unwrap();
    let file = CalibrationFile::new(&found, &made.data, Inputs::default());
    (found, file)
}

/// The estimate of a joint's zero, with its deviation if there is one, radians.
fn zero(file: &CalibrationFile, joint: &str) -> (f64, Option<f64>) {
    let entry = file.joints.iter().find(|it| it.name == joint).unwrap();
    let value = entry.terms.iter().find(|(term, _)| **term == Term::OFFSET).map_or(0.0, |it| *it.1);
    (value, file.sigma(&format!("{joint}.offset")))
}

/// Arms of five to seven joints, any subset of whose zeros is free with errors of up to 0.3°, behind a free device and a free target.
#[test]
fn no_zero_that_is_hidden_has_a_deviation_and_those_of_others_hold() {
    let sessions = trials(200).at_least(24);
    let five = Robot::new("five", elbow().joints[..5].to_vec(), elbow().home).unwrap();
    let robots = [elbow(), five, seven_axis()];
    let (mut stated, mut open, mut far) = (0, 0, 0);
    for seed in sessions.seeds() {
        let robot = &robots[seed as usize % robots.len()];
        let mut generator = ChaCha8Rng::seed_from_u64(seed + 40);
        let count = robot.joints.len();
        let chosen: Vec<usize> = (0..count).filter(|_| random::uniform_number(&mut generator) < 0.6).collect();
        let chosen = if chosen.is_empty() { vec![count - 1] } else { chosen };
        let mut zeros = vec![0.0; count];
        for &joint in &chosen {
            zeros[joint] = (0.6 * random::uniform_number(&mut generator) - 0.3f64).to_radians();
        }
        let made = visit(robot, &zeros, seed);
        let names: Vec<String> = chosen.iter().map(|&joint| robot.joints[joint].name.clone()).collect();
        let free = names.iter().map(|name| format!("{name}.offset")).collect();
        let (found, file) = calibrate_made(&made, &["joints"], free, Vec::new());
        for (&joint, name) in chosen.iter().zip(&names) {
            let (value, sigma) = zero(&file, name);
            let hidden = file.is_open(&format!("{name}.offset"));
            // The first zero is one of the device, the last one of the target.
            assert_eq!(hidden, joint == 0 || joint + 1 == count, "{seed} {name}");
            assert_eq!(sigma.is_none(), hidden, "{seed} {name}");
            match sigma {
                Some(sigma) => {
                    stated += 1;
                    far += usize::from((value - zeros[joint]).abs() > 4.0 * sigma);
                }
                None => open += 1,
            }
        }
        let is_open = chosen.iter().any(|&joint| joint == 0 || joint + 1 == count);
        assert!(!is_open || found.verdict.level < Level::Good, "{seed}");
    }
    println!(
        "{} sessions: {stated} zeros with a deviation, {far} farther than four of it; {open} hidden",
        sessions.count
    );
    // A session whose noise is estimated from 28 rows: beyond four deviations less than one in a thousand.
    assert!(far as f64 <= 1.0 + 2e-3 * stated as f64);
}

#[test]
fn a_hidden_zero_is_found_once_what_its_sentence_names_is_held() {
    let robot = elbow();
    let zeros = [0.08, 0.12, -0.2, 0.25, -0.15, 0.3].map(f64::to_radians);
    let made = visit(&robot, &zeros, 3);
    let all = || (1..=6).map(|joint| format!("joint{joint}.offset")).collect::<Vec<_>>();
    let (found, _) = calibrate_made(&made, &["joints"], all(), Vec::new());
    let sentences: Vec<&str> = (found.identifiability.unidentifiable.iter())
        .filter(|it| it.cause == Cause::JointOffsets)
        .map(|it| it.description.as_str())
        .collect();
    println!("{} of {}: {sentences:#?}", found.identifiability.rank, found.identifiability.parameters);
    assert_eq!((found.identifiability.rank, found.identifiability.parameters), (13, 15));
    assert!(sentences[0].starts_with("joint1.offset and the place of the device can change together"));
    assert!(sentences[1].starts_with("joint6.offset and the place of the target can change together"));
    let options: Vec<&str> = sentences
        .iter()
        .flat_map(|it| it.split("--fix ").skip(1))
        .filter_map(|it| it.split([')', ' ']).next())
        .collect();
    assert_eq!(options, ["frame", "target"]);
    // The model ends in the reflector, and the device is as in an earlier calibration.
    let device = made.device_from_base.inverse();
    let fix = [&["joints"][..], &options].concat();
    let (found, file) = calibrate_made(&made, &fix, all(), vec![device]);
    assert_eq!((found.identifiability.rank, found.identifiability.parameters), (6, 6));
    for (joint, zero_of) in zeros.iter().enumerate() {
        let (value, sigma) = zero(&file, &format!("joint{}", joint + 1));
        let sigma = sigma.unwrap();
        println!("joint{}: {:.4} ± {:.4} deg", joint + 1, value.to_degrees(), sigma.to_degrees());
        assert!((value - zero_of).abs() < 5.0 * sigma && sigma < 0.02f64.to_radians());
    }
    assert!(found.verdict.level > Level::DoNotUse, "{:?}", found.verdict.reasons);
}
