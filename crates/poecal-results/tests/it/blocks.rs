//! Fits of some blocks of unknowns only: held numbers stay equal to the bit, and the others are found.

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, rotation};
use poecal_calibrate::{BlockChoice, Calibration, CalibrationOptions, DeviceFrameKnowledge, Level, calibrate};
use poecal_fit::analysis::{Cause, Direction};
use poecal_fit::state::PackedValues;
use poecal_formats::proof::Difference;
use poecal_formats::robot_toml;
use poecal_model::measurement::Dataset;
use poecal_model::robot::{Body, CorrectionExtent, CorrectionModel, Gravity, JointTerm, Mass, Robot, Term};
use poecal_model::simulate::{SessionKind, Simulation, elbow};
use poecal_results::calibration_file::{CalibrationFile, Inputs};
use poecal_results::export::{ExportFormat, ExportOptions, export};
use poecal_results::model::{Model, ModelFormat, ModelSource, convert};
use poecal_testing::sessions::geometry;

fn words(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| (*word).to_owned()).collect()
}

fn choice(fix: &[&str], free: &[&str]) -> BlockChoice {
    BlockChoice { fix: words(fix), free: words(free) }
}

fn calibrate_blocks(robot: &Robot, data: &Dataset, blocks: BlockChoice, has_prior: bool) -> Calibration {
    let options = CalibrationOptions { blocks, diagnose: false, ..geometry() };
    let options = if has_prior { options } else { CalibrationOptions { tolerance: None, ..options } };
    calibrate(robot, data, &options).unwrap()
}

/// An arm whose tip lies beside its last axis.
fn arm_with_offset_tip() -> Robot {
    let robot = elbow();
    Robot { home: robot.home * Pose::from_translation(nalgebra::Vector3::new(0.08, 0.0, 0.05)), ..robot }
}

/// Measurements of a robot without noise, by a device at an arbitrary pose; its nominal model has these errors.
fn exact_session(kind: SessionKind, error: f64) -> (Robot, Dataset) {
    exact_of(&arm_with_offset_tip(), kind, error)
}

fn exact_of(robot: &Robot, kind: SessionKind, error: f64) -> (Robot, Dataset) {
    let made = Simulation {
        count: 80,
        error_rotation_rad: error,
        error_position_m: error,
        noise_position_m: 0.0,
        noise_rotation_rad: 0.0,
        ..Simulation::default()
    };
    let made = made.run(robot, kind).unwrap();
    (made.nominal, made.data)
}

fn held_out_mm(calibration: &Calibration) -> f64 {
    calibration.accuracy.held_out.unwrap().calibrated.position_mm().max
}

#[test]
fn what_is_held_stays_and_the_rest_is_found() {
    // The robot as built, and a nominal model in which joint 3 alone is wrong.
    for kind in [SessionKind::POINT, SessionKind::POSE] {
        let (built, data) = exact_session(kind, 0.0);
        let mut nominal = built.clone();
        let screw = nominal.joints[2].screw;
        let tilted = Pose::from_xyz_rpy([0.003, -0.002, 0.001], [0.004, 0.002, -0.003]);
        nominal.joints[2].screw = screw.transform(&tilted);
        for has_prior in [true, false] {
            let found = calibrate_blocks(&nominal, &data, choice(&["joints"], &["joint3"]), has_prior);
            let held = (0..6).filter(|&joint| joint != 2);
            for joint in held {
                assert_eq!(found.robot.joints[joint].screw, nominal.joints[joint].screw, "joint {joint}");
            }
            let target = if kind == SessionKind::POINT { 3 } else { 6 };
            let Identified { parameters, rank } = identified_counts(&found);
            println!("{kind:?} prior {has_prior}: {parameters} {rank}, held out {:.1e} mm", held_out_mm(&found));
            // The axis, the device's frame and the target.
            assert_eq!((parameters, rank), (4 + 6 + target, 4 + 6 + target));
            // A prior biases the result by its share of an exact fit's noise, which is rounding.
            assert!(held_out_mm(&found) < 1e-6, "{}", held_out_mm(&found));
        }
    }
}

struct Identified {
    parameters: usize,
    rank: usize,
}

fn identified_counts(calibration: &Calibration) -> Identified {
    let found = &calibration.identifiability;
    Identified { parameters: found.parameters, rank: found.rank }
}

#[test]
fn held_axes_leave_those_motions_of_the_base_that_they_do_not_see() {
    let (built, exact_data) = exact_session(SessionKind::POINT, 0.0);
    // Held blocks, unknowns in the layout, and motions of the base that do not affect the held blocks.
    let cases: [(&[&str], usize, usize); 6] = [
        // One axis: turning about it and sliding along it.
        (&["joint1"], 20 + 6 + 3, 2),
        // Two that are not parallel: none.
        (&["joint1", "joint2"], 16 + 6 + 3, 0),
        // Two parallel ones: sliding along them.
        (&["joint2", "joint3"], 16 + 6 + 3, 1),
        // A position: turns about it.
        (&["targets"], 24 + 6, 3),
        (&["frames"], 24 + 3, 0),
        (&["joints"], 6 + 3, 0),
    ];
    for (held, unknowns, motions) in cases {
        let found = calibrate_blocks(&built, &exact_data, choice(held, &[]), true);
        let Identified { parameters, rank } = identified_counts(&found);
        println!("{held:?} held: {parameters} unknowns, rank {rank}, {:.1e} mm", held_out_mm(&found));
        assert_eq!((parameters, rank), (unknowns - motions, unknowns - motions), "{held:?}");
        let told = found.identifiability.structural.iter().any(|it| it.description.contains("base frame"));
        assert_eq!(told, motions > 0, "{held:?}");
    }
    let (nominal, data) = exact_session(SessionKind::POINT, 0.001);
    // One held axis, or a held position, does not restrict the set of models.
    for held in [&["joint1"][..], &["targets"]] {
        for has_prior in [true, false] {
            let found = calibrate_blocks(&nominal, &data, choice(held, &[]), has_prior);
            assert!(held_out_mm(&found) < 1e-6, "{held:?}: {}", held_out_mm(&found));
        }
    }
}

#[test]
fn joint_zeros_alone_are_found_and_kept_as_offsets() {
    let (built, data) = exact_session(SessionKind::POINT, 0.0);
    let zeros = [0.0, 0.01, -0.02, 0.005, 0.015, 0.0];
    // Readings without these offsets: the nominal robot reads θ where the joint stands at θ + c.
    let mut nominal = built.clone();
    for (joint, zero) in nominal.joints.iter_mut().zip(zeros) {
        joint.reading.offset -= zero;
    }
    let found = calibrate_blocks(&nominal, &data, choice(&["joints"], &["joint?.offset"]), true);
    // The zeros of the first and the last joint are those of the device and the point.
    println!("{:?}: {:.1e} mm", found.robot.terms, held_out_mm(&found));
    assert!(held_out_mm(&found) < 1e-6, "{}", held_out_mm(&found));
    let of = |joint: usize| {
        let term = |it: &&JointTerm| it.joint == joint && it.term == Term::OFFSET;
        found.robot.terms.iter().find(term).map_or(0.0, |it| it.coefficient)
    };
    for (joint, zero) in zeros.iter().enumerate().skip(1).take(4) {
        assert!((of(joint) - zero).abs() < 1e-8, "joint {joint}: {} instead of {zero}", of(joint));
    }
    assert_eq!(found.robot.joints[3].screw, nominal.joints[3].screw);
}

#[test]
fn words_that_name_nothing_are_refused() {
    let (nominal, data) = exact_session(SessionKind::POINT, 0.001);
    let refused = |blocks: BlockChoice| blocks.unknowns(&nominal, &data).unwrap_err().to_string();
    let message = refused(choice(&["jiont2.*"], &[]));
    println!("{message}");
    assert!(message.starts_with("found `jiont2.*`, expected what to free or fix: joints, targets, frames"));
    assert!(message.contains("joint1.axis, joint1.offset"));
    assert!(refused(choice(&["*"], &[])).starts_with("found that every block is held"));
}

#[test]
fn files_hold_what_was_held_and_the_terms_that_were_found() {
    let made =
        Simulation { count: 80, ..Simulation::default() }.run(&arm_with_offset_tip(), SessionKind::POSE).unwrap();
    let found = calibrate_blocks(&made.nominal, &made.data, choice(&["joint1", "joint5"], &["joint3.offset"]), true);
    let term = found.robot.terms[0];
    assert_eq!((term.joint, term.term), (2, Term::OFFSET));
    let file = CalibrationFile::new(&found, &made.data, Inputs::default());
    let again = CalibrationFile::parse(&file.to_text().unwrap(), "calibration.json").unwrap();
    assert_eq!(again, file);
    let blocks = again.blocks.clone().unwrap();
    assert_eq!(blocks.held, ["joint1.axis", "joint5.axis"]);
    assert!(blocks.free.contains(&"joint3.offset".to_owned()) && blocks.free.contains(&"frame".to_owned()));

    // The robot, and the uncertainty with the device's frame and the term among its unknowns.
    let robot = again.robot().unwrap();
    assert!(Difference::from_robots(&found.robot, &robot, 100).is_within(1e-12, 1e-12));
    let before = found.trust.uncertainty.as_ref().unwrap();
    let (after, _) = again.uncertainty(&[None]).unwrap();
    let unknowns = again.unknowns().unwrap();
    println!("{unknowns:?}");
    assert_eq!(unknowns, file.uncertainty.as_ref().unwrap().unknowns);
    assert!(unknowns.contains(&"joint3.offset".to_owned()) && unknowns.contains(&"frame.rx".to_owned()));
    assert!(!unknowns.iter().any(|name| name.starts_with("joint1.")));
    let packed = PackedValues::from_dataset(&made.nominal, &made.data);
    for (a, b) in before.predictions(&packed, 0).iter().zip(after.predictions(&packed, 0)) {
        // Texts hold numbers to the last digit.
        assert!((a.position - b.position).norm() <= 1e-9 * a.position.norm());
    }

    // A TOML model has the term; a URDF has it in its screws.
    let model = Model {
        path: "calibration.json".into(),
        robot: robot.clone(),
        source: ModelSource::Calibration(Box::new(again)),
    };
    let toml = convert(&model, ModelFormat::Toml).unwrap();
    let read = robot_toml::parse(&toml.text, "r.toml").unwrap();
    assert_eq!(read.terms, robot.terms);
    let urdf = convert(&model, ModelFormat::Urdf).unwrap();
    println!("{:?}", urdf.notes);
    let plain = robot.without_offsets();
    assert!(plain.terms.is_empty() && Difference::from_robots(&robot, &plain, 100).is_within(1e-12, 1e-12));
}

/// Terms with a coefficient to be found.
const TERMS: &[(&str, f64)] = &[
    // Terms of joint3, one line each.
    ("offset", 0.01),
    ("ratio", 0.002),
    ("sin2", 0.001),
    ("masses", 0.002),
];

/// The same arm with masses on its links.
fn arm_with_masses() -> Robot {
    let mut robot = arm_with_offset_tip();
    let masses = [(1, 9.0, 0.3), (2, 6.0, 0.72), (4, 2.0, 0.7)];
    robot.masses =
        masses.map(|(joint, kg, z)| Mass { body: Body::Link(joint), place: Vector3::new(0.3, 0.02, z), kg }).into();
    robot
}

#[test]
fn terms_of_joint_values_are_found_and_written() {
    for &(term, coefficient) in TERMS {
        let name = format!("joint3.{term}");
        let term: Term = term.parse().unwrap();
        let mut built = arm_with_masses();
        built.gravity = Some(Gravity::of_unit_weights(&built, -Vector3::z()));
        built.terms.push(JointTerm { joint: 2, term, coefficient });
        let (actual, data) = exact_of(&built, SessionKind::POINT, 0.0);
        let nominal = Robot { terms: Vec::new(), gravity: None, ..actual };
        let found = calibrate_blocks(&nominal, &data, choice(&["joints"], &[&name]), true);
        let own = found.robot.terms.iter().map(|it| (it.joint, it.term, it.coefficient)).collect::<Vec<_>>();
        println!("{name} = {coefficient}: {own:?}, held out {:.1e} mm", held_out_mm(&found));
        assert_eq!((own.len(), own[0].0, own[0].1), (1, 2, term));
        assert!((own[0].2 - coefficient).abs() < 1e-9 && held_out_mm(&found) < 1e-6);

        let file = CalibrationFile::new(&found, &data, Inputs::default());
        let text = file.to_text().unwrap();
        let read = CalibrationFile::parse(&text, "calibration.json").unwrap().robot().unwrap();
        assert_eq!(read.terms, found.robot.terms);
        // TOML has no weights.
        if !term.needs_gravity() {
            let read = robot_toml::parse(&robot_toml::write(&read), "r.toml").unwrap();
            assert_eq!(read.terms, found.robot.terms);
        }
        reaches_its_own_poses(&read);
        let path = "calibration.json".into();
        let model = Model { path, robot: read, source: ModelSource::Calibration(Box::new(file)) };
        // The arrays are read back and compared.
        export(&model, ExportFormat::C, &ExportOptions::default()).unwrap();
        let urdf = convert(&model, ModelFormat::Urdf).unwrap();
        // Losses of URDF are stated.
        let lost = !found.robot.without_offsets().terms.is_empty();
        assert_eq!(urdf.notes.iter().any(|note| note.contains(&name)), lost, "{:?}", urdf.notes);

        let model = CorrectionModel::new(&nominal, -Vector3::z(), &[true; 6], CorrectionExtent::default());
        let is_corrected = model.terms().any(|it| it == (model.places[2], term));
        assert_eq!(is_corrected, term.kind().row().groups[0].is_some());
    }
}

/// Inverse kinematics with the derivatives of the terms.
fn reaches_its_own_poses(robot: &Robot) {
    let (arm, _) = robot.arm(&[]).unwrap();
    for turn in 0..20 {
        let q: [f64; 6] = std::array::from_fn(|joint| (1.7 * f64::from(turn) + 0.9 * joint as f64).sin());
        let target = robot.forward_kinematics(&q);
        let mut found = q.map(|it| it + 0.02);
        let left = arm.solve_nearest(&target, &mut found);
        assert!(left < 1e-11, "{q:?}: {left:.1e}");
        for (joint, (moves, turns)) in arm.jacobian(&q).into_iter().take(6).enumerate() {
            let at = |by: f64| {
                let mut moved = q;
                moved[joint] += by;
                arm.forward_kinematics(&moved)
            };
            let (after, before) = (at(1e-6), at(-1e-6));
            let shift = (after.translation - before.translation) / 2e-6;
            let turn = rotation::log(&(after.rotation * before.rotation.transpose())) / 2e-6;
            assert!((shift - moves).norm() < 1e-8 && (turn - turns).norm() < 1e-8);
        }
    }
}

#[test]
fn a_fit_without_unknowns_is_refused_and_registration_alone_is_judged_by_its_errors() {
    let (built, data) = exact_session(SessionKind::POINT, 0.0);
    let blocks = choice(&["joints", "targets"], &[]);
    let options = CalibrationOptions { blocks, frame: DeviceFrameKnowledge::Base, ..Default::default() };
    let message = calibrate(&built, &data, &options).unwrap_err().to_string();
    println!("{message}");
    assert!(message.starts_with("found nothing that is unknown"));

    let blocks = choice(&[], &["frames"]);
    let options = CalibrationOptions { blocks, frame: DeviceFrameKnowledge::Base, ..Default::default() };
    let message = calibrate(&built, &data, &options).unwrap_err().to_string();
    assert!(message.starts_with("found `frames` to be fitted beside measurements in the base"), "{message}");

    let made = Simulation { error_rotation_rad: 0.0, error_position_m: 0.0, ..Simulation::default() };
    let made = made.run(&arm_with_offset_tip(), SessionKind::POINT).unwrap();
    let found = calibrate_blocks(&made.nominal, &made.data, choice(&["joints"], &[]), true);
    println!("{:?}", found.verdict);
    assert_ne!(found.verdict.level, Level::DoNotUse);
}

#[test]
fn offsets_beside_free_axes_are_no_unknowns_of_their_own() {
    let made =
        Simulation { count: 80, ..Simulation::default() }.run(&arm_with_offset_tip(), SessionKind::POSE).unwrap();
    let found = calibrate_blocks(&made.nominal, &made.data, choice(&[], &["*.offset"]), true);
    let Identified { parameters, rank } = identified_counts(&found);
    println!("{parameters} {rank} {:?}", found.identifiability.structural.last());
    assert_eq!((parameters, rank), (30, 30));
    let told = |it: &Direction| it.cause == Cause::JointOffsets && it.directions == 6;
    assert!(found.identifiability.structural.iter().any(told));
}
