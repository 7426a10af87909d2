//! A laser tracker at an unknown position, and a reflector at an unknown position on the tool.
//!
//! The tracker measures positions alone, of one reflector, in m = 100 configurations. Its own position, and that of the reflector on the tool, are
//! unknown.
//!
//! | symbol | what | known |
//! |---|---|---|
//! | `θ_k` | joint values of row k, radians | read |
//! | `ξ_1 … ξ_6` | screws of the joints, base frame | nominal; fitted |
//! | `p` | the reflector in the base at zero | rough nominal; fitted |
//! | `D` | pose of the base in the tracker | fitted |
//! | `y_k` | position of the reflector in the tracker | measured |
//!
//! State: 4 unknowns an axis and 3 of the reflector; `D` has 6 more, which the screws absorb (docs/theory.md §8): 27 in all.
//! Measurement equation: `y_k = D exp(ξ_1 θ_1k) … exp(ξ_6 θ_6k) p`, and noise.
//! Noise: white, 0.05 mm in each component. The fit estimates it.
//!
//! The rows are those of `examples/elbow/points.csv`. Its twin in Python prints the same:
//! `examples/python/02_points_with_unknown_tool_and_device.py`.

#![allow(clippy::print_stdout, reason = "an example shows its result")]

use poecal::{CalibrationOptions, Model, calibrate, read_measurements};

const ELBOW: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/elbow/robot.urdf");
const POINTS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/elbow/points.csv");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = Model::read(ELBOW, &Default::default())?;
    let measured = read_measurements(&[POINTS], &model.robot, &Default::default())?;
    let calibration = calibrate(&model.robot, &measured.data, &CalibrationOptions::default())?;

    let [x, y, z]: [f64; 3] = (calibration.base_from_device.translation * 1e3).into();
    println!("the tracker stands at ({x:.3}, {y:.3}, {z:.3}) mm in the base");
    let [x, y, z]: [f64; 3] = (calibration.robot.home.translation * 1e3).into();
    let [a, b, c]: [f64; 3] = (model.robot.home.translation * 1e3).into();
    println!("the reflector is at ({x:.3}, {y:.3}, {z:.3}) mm at zero, nominal ({a:.3}, {b:.3}, {c:.3}) mm");
    let held_out = calibration.accuracy.held_out.ok_or("no rows were held out")?;
    for (name, model) in
        [("nominal", held_out.nominal), ("registered", held_out.registered), ("calibrated", held_out.calibrated)]
    {
        println!("{name:<12} {:8.4} mm (RMS) on {} points", model.position_mm().rms, held_out.count);
    }
    let found = &calibration.identifiability;
    println!("determined   {} of {} unknowns", found.rank, found.parameters);
    for direction in &found.weak {
        println!("weak         {}", direction.description);
    }
    Ok(())
}
