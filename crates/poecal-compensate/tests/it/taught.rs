//! Compensation of robots whose measured target is not the flange of their model, and whose base is unknown.

use poecal_arm::lie::Pose;
use poecal_calibrate::{CalibrationOptions, DeviceFrameKnowledge, calibrate};
use poecal_compensate::{ChangeOptions, Compensation, MaxCorrection};
use poecal_model::robot::Robot;
use poecal_model::simulate::{SessionKind, Simulation, elbow};
use poecal_results::calibration_file::{CalibrationFile, Inputs};

/// A reflector, metres beyond the flange.
const REFLECTOR: [f64; 3] = [0.04, -0.02, 0.1];

/// A calibration of an elbow with axis errors of this size (rad, m), with a model that ends at the flange.
fn calibrate_elbow(off: (f64, f64), kind: SessionKind, frame: DeviceFrameKnowledge) -> (CalibrationFile, Robot) {
    let simulation = Simulation {
        count: 80,
        error_rotation_rad: off.0,
        error_position_m: off.1,
        noise_position_m: 1e-6,
        noise_rotation_rad: 1e-6,
        device_anywhere: frame == DeviceFrameKnowledge::Unknown,
        ..Simulation::default()
    };
    let made = simulation.run(&elbow(), kind).unwrap();
    let flange = Pose::from_translation(REFLECTOR.into()).inverse();
    let model = Robot { home: made.nominal.home * flange, ..made.nominal.clone() };
    let options = CalibrationOptions { frame, move_tip: true, ..CalibrationOptions::default() };
    let calibration = calibrate(&model, &made.data, &options).unwrap();
    let file = CalibrationFile::new(&calibration, &made.data, Inputs::default());
    let file = CalibrationFile::parse(&file.to_text().unwrap(), "calibration.json").unwrap();
    let actual = file.robot().unwrap();
    (file, actual)
}

fn configurations() -> impl Iterator<Item = [f64; 6]> {
    (0..60).map(|k| {
        let k = f64::from(k);
        [
            0.9 * k.sin(),
            0.5 * (1.3 * k).cos(),
            0.3 + 0.4 * (0.7 * k).sin(),
            (1.7 * k).cos(),
            1.0 + 0.5 * k.sin(),
            k.cos(),
        ]
    })
}

/// The median of the largest corrections of a joint, rad (near singularities they are large), and the remaining distance from the intended position
/// of the tip, metres.
fn corrections(nominal: &Robot, actual: &Robot, meant: impl Fn(&Robot, &[f64]) -> Pose) -> (f64, f64) {
    // No limit of changes.
    let most_change = MaxCorrection { turning_rad: 1.5, sliding_m: 1.0 };
    let options = ChangeOptions { most_change, nearest: false };
    let mut compensation = Compensation::new(nominal, actual, &[], &options).unwrap();
    let (mut largest, mut left) = (Vec::new(), 0.0_f64);
    for q in configurations() {
        let found = compensation.joints(&q);
        let changes = found.readings.iter().zip(q).map(|(to, from)| (to - from).abs());
        largest.push(changes.fold(0.0, f64::max));
        let tip = actual.forward_kinematics(found.readings);
        left = left.max((tip.translation - meant(nominal, &q).translation).norm());
    }
    largest.sort_by(f64::total_cmp);
    (largest[largest.len() / 2], left)
}

#[test]
fn a_reflector_off_the_flange_is_no_error_of_the_joints() {
    for kind in [SessionKind::POSE, SessionKind::POINT] {
        for frame in [DeviceFrameKnowledge::Base, DeviceFrameKnowledge::Unknown] {
            let (file, actual) = calibrate_elbow((0.0, 0.0), kind, frame);
            let taught = file.taught_robot(&actual).unwrap();
            let (largest, left) = corrections(&taught.robot, &actual, |robot, q| robot.forward_kinematics(q));
            let (literal, _) =
                corrections(&file.nominal_robot().unwrap(), &actual, |robot, q| robot.forward_kinematics(q));
            println!(
                "{kind:?}, {frame:?}: corrections of {largest:.1e} rad, {left:.1e} m left; without the reflector they would be {literal:.1e} rad"
            );
            // The corrections of the joints are noise of a micrometre; the reflector is 0.11 m away.
            assert!(largest < 1e-4 && left < 1e-9, "{kind:?} {frame:?}");
            assert!(literal > 0.02);
        }
    }
}

#[test]
fn corrected_programs_reach_what_base_and_tool_of_the_actual_robot_make_of_them() {
    for frame in [DeviceFrameKnowledge::Base, DeviceFrameKnowledge::Unknown] {
        let (file, actual) = calibrate_elbow((0.01, 2e-3), SessionKind::POSE, frame);
        let taught = file.taught_robot(&actual).unwrap();
        let nominal = file.nominal_robot().unwrap();
        let by_frames = |_: &Robot, q: &[f64]| taught.base * nominal.forward_kinematics(q) * taught.tool;
        let (largest, left) = corrections(&taught.robot, &actual, by_frames);
        let tool = taught.tool.translation - nalgebra::Vector3::from(REFLECTOR);
        println!(
            "{frame:?}: corrections of {largest:.1e} rad, {left:.1e} m left; the tool is {:.1e} m off",
            tool.norm()
        );
        assert!(left < 1e-9 && largest > 1e-3 && largest < 0.1);
        // Errors of the tip itself have its size, 2 mm, and those of the last axes turn it.
        assert!(tool.norm() < 0.02);
        if frame == DeviceFrameKnowledge::Base {
            assert!(taught.base.translation.norm() == 0.0);
        }
        // A robot corrected by geometry alone has smaller errors than before in every one of these configurations.
        for q in configurations() {
            let (meant, uncorrected) = (by_frames(&nominal, &q), actual.forward_kinematics(&q));
            assert!((meant.translation - uncorrected.translation).norm() < 0.1);
        }
    }
}
