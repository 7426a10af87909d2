//! An elbow with known errors, calibrated from poses.
//!
//! A device at an unknown position measures the pose of the tool of a six-axis arm in m = 50 random configurations. The arm differs from nominal:
//! every axis, and the tool, is turned by 1° and shifted by 2 mm.
//!
//! | symbol | what | known |
//! |---|---|---|
//! | `θ_k` | joint values of row k, radians | read |
//! | `ξ_1 … ξ_6` | screws of the joints, base frame | nominal; fitted |
//! | `M` | pose of the tool in the base at zero | nominal; fitted |
//! | `D` | pose of the base in the device | fitted |
//! | `Y_k` | pose of the tool in the device | measured |
//!
//! State: 4 unknowns an axis, 6 of the tool; `D` has 6 more, which the screws absorb (docs/theory.md §8): 30 in all.
//! Measurement equation: `Y_k = D exp(ξ_1 θ_1k) … exp(ξ_6 θ_6k) M`, and noise.
//! Noise: white, 0.05 mm in each component of position and 0.01° in each of rotation. The fit estimates it.
//!
//! Its twin in Python prints the same: `examples/python/01_simulate_and_calibrate.py`.

#![allow(clippy::print_stdout, reason = "an example shows its result")]

use poecal::{CalibrationOptions, Model, Quantity, SessionKind, Simulation, calibrate};

const ELBOW: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/elbow/robot.urdf");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = Model::read(ELBOW, &Default::default())?;
    let simulation = Simulation { count: 50, seed: 1, ..Simulation::default() };
    let made = simulation.run(&model.robot, SessionKind::POSE)?;

    let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
    let held_out = calibration.accuracy.held_out.ok_or("no rows were held out")?;
    println!("{} poses fitted, {} held out", calibration.accuracy.training.count, held_out.count);
    for (name, model) in
        [("nominal", held_out.nominal), ("registered", held_out.registered), ("calibrated", held_out.calibrated)]
    {
        let rotation = model.rotation_deg().ok_or("no orientation was measured")?;
        println!("{name:<12} {:8.4} mm {:8.4} deg (RMS)", model.position_mm().rms, rotation.rms);
    }
    println!(
        "noise        {:8.4} mm each component, as the fit estimates it",
        calibration.noise[Quantity::Position] * 1e3
    );
    println!("verdict      {}", calibration.verdict.level.word());
    for (joint, found) in made.nominal.joints.iter().zip(&calibration.trust.joints) {
        println!("{:<12} {}", joint.name, found.change.words());
    }
    Ok(())
}
