//! The expected error of each prediction, compared with the true one.
//!
//! A calibrated model predicts the pose of the tool, with its uncertainty. Here the truth is known: the predictions of 1,000 further configurations
//! are compared with it.
//!
//! | symbol | what | known |
//! |---|---|---|
//! | `θ_k` | joint values, radians | read |
//! | `f(θ)` | pose of the tool by the calibrated screws | fitted |
//! | `f*(θ)` | pose of the tool of the actual robot | known to the simulation alone |
//! | `C` | covariance of all unknowns | fitted with them |
//! | `J(θ)` | motion of the tool by the unknowns | from the screws |
//!
//! State: 30 unknowns, of six axes and the tool, from 35 poses of 50 (the others are held out); the device frame is unknown.
//! Measurement equation: `Y_k = D f*(θ_k)`, and noise.
//! Noise: white, 0.05 mm and 0.01° in each component. Prediction: `cov f(θ) = J(θ) C J(θ)ᵀ` (docs/theory.md §9).
//!
//! Its twin in Python prints the same: `examples/python/03_predict_with_uncertainty.py`.

#![allow(clippy::print_stdout, reason = "an example shows its result")]

use poecal::{
    CalibrationFile, CalibrationOptions, Inputs, Model, ModelSource, PredictionFrame, SessionKind, Simulation,
    calibrate, predict_readings,
};

const ELBOW: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/elbow/robot.urdf");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let nominal = Model::read(ELBOW, &Default::default())?.robot;
    let simulation = Simulation { count: 50, seed: 3, ..Simulation::default() };
    let made = simulation.run(&nominal, SessionKind::POSE)?;
    let truth = simulation.held_out(&made, SessionKind::POSE, 1000)?;
    let calibration = calibrate(&nominal, &made.data, &CalibrationOptions::default())?;

    // The calibration in the form of its file: robot, device and covariance, those of the corrected model.
    let file = CalibrationFile::new(&calibration, &made.data, Inputs::default());
    let file = file.corrected_file().unwrap_or(file);
    let model = Model {
        robot: file.robot()?,
        source: ModelSource::Calibration(Box::new(file)),
        path: "calibration.json".into(),
    };
    let found = predict_readings(&model, truth.all_readings(), PredictionFrame::Device, None, true)?;
    let doubts = found.doubts.ok_or("a calibration has expected errors")?;

    let seen = truth.observations.iter().map(|row| row.measurement.pose().translation);
    let errors_mm: Vec<f64> =
        found.poses.iter().zip(seen).map(|(pose, seen)| 1e3 * (pose.translation - seen).norm()).collect();
    let rms = |values: &[f64]| (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt();
    let expected_mm: Vec<f64> = doubts.iter().map(|(error, _)| 1e3 * error.sigma_position_m()).collect();
    let inside_bound =
        doubts.iter().zip(&errors_mm).filter(|((error, _), mm)| **mm <= 1e3 * error.bound_position_m()).count();
    println!("expected     {:.4} mm (RMS) in {} configurations", rms(&expected_mm), expected_mm.len());
    println!("true         {:.4} mm (RMS)", rms(&errors_mm));
    println!("inside their 95 % bounds: {inside_bound}");
    println!("inside the sampled range: {}", doubts.iter().filter(|(_, inside)| *inside).count());
    for row in 0..3 {
        println!("row {row}        expected {:.4} mm, true {:.4} mm", expected_mm[row], errors_mm[row]);
    }
    Ok(())
}
