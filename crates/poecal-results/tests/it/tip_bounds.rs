//! Bounds of a tip that was not measured itself: it is as certain as its link.

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, Screw};
use poecal_calibrate::{CalibrationOptions, Corrections, DeviceFrameKnowledge, calibrate};
use poecal_fit::state::PackedValues;
use poecal_model::robot::Robot;
use poecal_model::simulate::{SessionKind, Simulation, elbow, random_configuration, seven_axis};
use poecal_results::calibration_file::{CalibrationFile, Inputs};
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use poecal_testing::trials::trials;

/// From the tip to the reflector.
const REFLECTOR: [f64; 3] = [0.03, 0.11, -0.06];

/// A robot with errors of its axes, with the links beyond its last joint as in the model.
fn make_robot(nominal: &Robot, seed: u64) -> Robot {
    let errors = Simulation { error_rotation_rad: 0.005, error_position_m: 1e-3, ..Simulation::default() };
    let off = errors.perturb(nominal, &mut ChaCha8Rng::seed_from_u64(seed));
    let screws: Vec<Screw> = off.joints.iter().map(|joint| joint.screw).collect();
    let mut actual = nominal.with_screws(&screws);
    let last = actual.joints.len() - 1;
    actual.home = actual.joints[last].frame * nominal.last_joint_from_tip();
    actual
}

#[test]
fn bounds_of_a_tip_beside_the_reflector_hold() {
    let trials = trials(40).at_least(12);
    let reflector = Pose::from_translation(Vector3::from(REFLECTOR));
    for (nominal, kind) in
        [(elbow(), SessionKind::POINT), (elbow(), SessionKind::POSE), (seven_axis(), SessionKind::POINT)]
    {
        let (mut inside, mut all, mut off, mut expected) = (0, 0, 0.0, 0.0);
        for seed in trials.seeds() {
            let actual = make_robot(&nominal, seed);
            let at_reflector = |robot: &Robot| Robot { home: robot.home * reflector, ..robot.clone() };
            // In the base frame: with the device at an unknown pose, the zero of the last joint is as that of a base that the axes determine.
            let simulation = Simulation { count: 60, device_anywhere: false, ..Simulation::default() };
            let mut generator = ChaCha8Rng::seed_from_u64(500 + seed);
            let seen =
                simulation.measure(&at_reflector(&nominal), at_reflector(&actual), kind, &mut generator).unwrap();
            let options = CalibrationOptions {
                corrections: Corrections::Off,
                frame: DeviceFrameKnowledge::Base,
                ..CalibrationOptions::default()
            };
            let calibration = calibrate(&nominal, &seen.data, &options).unwrap();
            let file = CalibrationFile::new(&calibration, &seen.data, Inputs::default());
            let (uncertainty, targets) = file.uncertainty(&[None]).unwrap();
            let readings: Vec<f64> = (0..30).flat_map(|_| random_configuration(&nominal, &mut generator)).collect();
            let robot = file.robot().unwrap();
            let packed = PackedValues::new(&robot, &readings, nominal.joints.len());
            let bounds = uncertainty.predictions(&packed, targets[0]);
            let device = calibration.base_from_device.inverse();
            for (q, bound) in readings.chunks_exact(nominal.joints.len()).zip(&bounds) {
                let found = device.act(&robot.forward_kinematics(q).translation);
                let truth = seen.device_from_base.act(&actual.forward_kinematics(q).translation);
                let apart = (found - truth).norm();
                inside += usize::from(apart <= bound.bound_position_m());
                all += 1;
                off += apart * apart;
                expected += bound.sigma_position_m().powi(2);
            }
        }
        let (share, ratio) = (f64::from(inside as u32) / f64::from(all), f64::sqrt(off / expected));
        println!(
            "{} {kind:?}: {:.1} % of {all} inside, errors {:.3} mm, {ratio:.2} of what is expected",
            nominal.name,
            100.0 * share,
            1e3 * f64::sqrt(off / f64::from(all))
        );
        // The residual counts as the robot's, so that bounds are wide; errors of one session are similar.
        assert!(share > 0.9 && ratio > 0.2 && ratio < 1.3, "{share} {ratio}");
    }
}
