//! The formulations of lou2009 side by side: their results, and their differences.

use poecal_calibrate::{Calibration, CalibrationOptions, DeviceFrameKnowledge, calibrate};
use poecal_lou2009::{Method, PaperFormulation, PaperResidual, to_formulation};
use poecal_model::measurement::{Noise, Quantity};
use poecal_model::robot::Robot;
use poecal_model::simulate::{
    SessionKind, Simulation, SimulationResult, elbow, gantry, random_chain, scara, seven_axis,
};

/// Noise-free fits end at the truth but for rounding of some hundred operations on metres.
const EXACT_MM: f64 = 1e-7;

fn robots() -> Vec<Robot> {
    vec![elbow(), scara(), gantry(), seven_axis(), random_chain(6, 3), random_chain(8, 5)]
}

fn session(robot: &Robot, kind: SessionKind, noise: Noise, device_anywhere: bool) -> SimulationResult {
    let simulation = Simulation {
        noise_position_m: noise[Quantity::Position],
        noise_rotation_rad: noise[Quantity::Rotation],
        count: 90,
        device_anywhere,
        ..Simulation::default()
    };
    simulation.run(robot, kind).unwrap()
}

fn options(made: &SimulationResult, way: PaperFormulation) -> CalibrationOptions {
    let known = made.device_from_base == poecal_arm::lie::Pose::identity();
    let frame = if known { DeviceFrameKnowledge::Base } else { DeviceFrameKnowledge::Unknown };
    let formulation = to_formulation(way, PaperResidual::Tool, way.usual_method());
    CalibrationOptions { frame, formulation, ..CalibrationOptions::default() }
}

/// Largest held-out position error, millimetres.
fn worst_mm(calibration: &Calibration) -> f64 {
    calibration.accuracy.held_out.unwrap().calibrated.position_mm().max
}

#[test]
fn every_formulation_finds_the_robot_without_noise() {
    let none = Noise::new(0.0, 0.0);
    for robot in robots() {
        for kind in [SessionKind::POSE, SessionKind::POINT] {
            for anywhere in [false, true] {
                let made = session(&robot, kind, none, anywhere);
                for formulation in PaperFormulation::ALL {
                    let found = calibrate(&made.nominal, &made.data, &options(&made, formulation)).unwrap();
                    let worst = worst_mm(&found);
                    println!(
                        "{:14} {:5} anywhere {anywhere:5} {:15} {:2} iterations, {worst:.1e} mm",
                        robot.name,
                        kind.word(),
                        formulation.word(),
                        found.solver.iterations
                    );
                    assert!(found.solver.termination.is_success() && worst < EXACT_MM);
                    assert_eq!(found.solver.joint_offsets.is_some(), formulation.has_offsets());
                }
            }
        }
    }
}

#[test]
fn offsets_of_the_joints_are_found_without_being_unknowns() {
    let none = Noise::new(0.0, 0.0);
    for robot in robots() {
        let mut made = session(&robot, SessionKind::POSE, none, false);
        let offsets: Vec<f64> = (0..robot.joints.len()).map(|k| 0.03 * (k as f64 * 1.3 + 0.4).sin()).collect();
        let shifted = poecal_model::offsets::into_screws(&made.actual, &offsets).unwrap();
        let exact = Simulation {
            noise_position_m: 0.0,
            noise_rotation_rad: 0.0,
            count: 90,
            device_anywhere: false,
            ..Simulation::default()
        };
        let mut generator = rand_chacha::rand_core::SeedableRng::seed_from_u64(4);
        made = exact.measure(&made.nominal, shifted, SessionKind::POSE, &mut generator).unwrap();
        for formulation in PaperFormulation::ALL {
            let found = calibrate(&made.nominal, &made.data, &options(&made, formulation)).unwrap();
            println!("{:14} {:15} {:.1e} mm", robot.name, formulation.word(), worst_mm(&found));
            assert!(worst_mm(&found) < EXACT_MM);
        }
    }
}

/// With noise, the adjoint forms end at one optimum by either method; free screws, normalised after each step, do not.
#[test]
fn formulations_part_with_noise() {
    let noise = Noise::new(5e-5, 2e-4);
    let made = session(&elbow(), SessionKind::POINT, noise, false);
    let fit = |formulation, method| {
        let mut options = options(&made, formulation);
        options.held_out = Some(0.0);
        // None of the formulations for comparison has a prior.
        options.tolerance = None;
        options.formulation = to_formulation(formulation, PaperResidual::Tool, method);
        options.solver.decrement = 1e-14;
        calibrate(&made.nominal, &made.data, &options).unwrap().accuracy.training.calibrated.position_mm().rms
    };
    let best = fit(PaperFormulation::Adjoint, Method::LevenbergMarquardt);
    let others = [
        fit(PaperFormulation::Adjoint, Method::GaussNewton),
        fit(PaperFormulation::AdjointOffsets, Method::LevenbergMarquardt),
        fit(PaperFormulation::AdjointOffsets, Method::GaussNewton),
    ];
    let free = fit(PaperFormulation::Screw, Method::GaussNewton);
    println!("residual, mm: adjoint {best:.9}, others {others:.9?}, free screws {free:.9}");
    // The residual is stationary there: a difference of parameters of 1e-6 changes it by its square.
    assert!(others.iter().all(|other| (other / best - 1.0).abs() < 1e-9));
    assert!(free > best * (1.0 + 1e-6));
}

/// The residual of the paper finds the same robot without noise, and a worse one with it.
#[test]
fn spatial_residual_costs_accuracy() {
    let exact = session(&elbow(), SessionKind::POSE, Noise::new(0.0, 0.0), true);
    let with = |residual| to_formulation(PaperFormulation::Adjoint, residual, Method::LevenbergMarquardt);
    let spatial = CalibrationOptions { formulation: with(PaperResidual::Spatial), ..CalibrationOptions::default() };
    let found = calibrate(&exact.nominal, &exact.data, &spatial).unwrap();
    println!("noise-free {:.1e} mm", worst_mm(&found));
    assert!(worst_mm(&found) < EXACT_MM);
    let noise = Noise::new(5e-5, 2e-4);
    let (mut with_spatial, mut with_tool) = (0.0, 0.0);
    for seed in 0..20 {
        let simulation = Simulation {
            noise_position_m: noise[Quantity::Position],
            noise_rotation_rad: noise[Quantity::Rotation],
            count: 60,
            seed,
            device_anywhere: false,
            ..Simulation::default()
        };
        let made = simulation.run(&elbow(), SessionKind::POSE).unwrap();
        let unseen = simulation.held_out(&made, SessionKind::POSE, 100).unwrap();
        for (residual, sum) in [(PaperResidual::Spatial, &mut with_spatial), (PaperResidual::Tool, &mut with_tool)] {
            let options = CalibrationOptions {
                frame: DeviceFrameKnowledge::Base,
                formulation: with(residual),
                sigma: noise.map(Some),
                held_out: Some(0.0),
                move_tip: true,
                ..CalibrationOptions::default()
            };
            let robot = calibrate(&made.nominal, &made.data, &options).unwrap().robot;
            for row in 0..unseen.len() {
                let truth = unseen.observations[row].measurement.pose().translation;
                *sum += (robot.forward_kinematics(unseen.readings(row)).translation - truth).norm_squared();
            }
        }
    }
    let ratio = f64::sqrt(with_spatial / with_tool);
    println!("RMS held-out error: spatial over tool {ratio:.2}");
    assert!(ratio > 1.5);
}
