//! Choice of the configurations to measure, and a calibration judged by other rows.
//!
//! Before anything is measured, `identify` shows which unknowns the listed configurations would determine. 8 and 40 are compared; the 40 are
//! measured, every row is fitted, and the calibration is judged by 200 held-out rows.
//!
//! | symbol | what | known |
//! |---|---|---|
//! | `θ_k` | joint values of row k, radians | chosen |
//! | `x` | screws of the axes and the point of the reflector, 27 numbers | nominal; fitted |
//! | `H_k` | motion of the reflector of row k by `x` | nominal |
//! | `y_k` | position of the reflector in the tracker | measured |
//!
//! State: `x`; the tracker's position is unknown.
//! Measurement equation: `y_k = D f(θ_k; x)`, and noise; for errors of `x`, `δy_k = H_k δx`.
//! Noise: white, σ = 0.05 mm in each component. Information: `Σ H_kᵀ H_k / σ²`, which determines rank and covariance.
//!
//! Its twin in Python prints the same: `examples/python/04_validate_and_identify.py`.

#![allow(clippy::print_stdout, reason = "an example shows its result")]

use poecal::{
    CalibrationFile, CalibrationOptions, Inputs, Model, PlannedSession, SessionKind, Simulation, calibrate, identify,
};

const ELBOW: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/elbow/robot.urdf");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let nominal = Model::read(ELBOW, &Default::default())?.robot;
    let simulation = Simulation { count: 40, seed: 5, ..Simulation::default() };
    let made = simulation.run(&nominal, SessionKind::POINT)?;
    let others = simulation.held_out(&made, SessionKind::POINT, 200)?;

    let session = PlannedSession { kind: SessionKind::POINT, ..PlannedSession::default() };
    for count in [8, 40] {
        let readings: Vec<f64> = (0..count).flat_map(|row| made.data.readings(row).to_vec()).collect();
        let found = identify(&nominal, &readings, &session)?;
        let expected = found
            .expected
            .mean_m
            .map_or("no prediction".to_owned(), |mean| format!("{:.4} mm expected error", 1e3 * mean));
        println!(
            "{count} points would determine {} of {} unknowns: {expected}",
            found.identifiability.rank, found.identifiability.parameters
        );
    }

    let options = CalibrationOptions { held_out: Some(0.0), ..CalibrationOptions::default() };
    let calibration = calibrate(&nominal, &made.data, &options)?;
    let judgement = CalibrationFile::new(&calibration, &made.data, Inputs::default()).judge(&others, false, false)?;
    let error = judgement.calibrated.position_mm();
    println!("{} other points: error {:.4} mm (RMS), {:.4} mm at most", judgement.count, error.rms, error.max);
    let kept = judgement.promised.ok_or("a calibration has bounds")?.position_mm();
    println!(
        "expected {:.4} mm with noise; {:.1} % are inside their 95 % bounds",
        kept.expected_rms,
        100.0 * kept.inside_bound95
    );
    Ok(())
}
