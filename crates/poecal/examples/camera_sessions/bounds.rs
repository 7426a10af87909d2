//! Shares of errors inside their 95 % bounds.

use poecal::measurement::Dataset;
use poecal::{CalibrationFile, CalibrationOptions, Error, Inputs};
use serde_json::{Value, json};

use crate::session::{Session, calibrated, delivered, deviations, rms, session};

/// One place of the camera for each seed, with three errors of the configurations; each again by the rule of independent corners.
pub(crate) fn run(seed: u64) -> Result<Vec<Value>, Error> {
    let mut lines = Vec::new();
    for millis in [0.0, 0.1, 0.5] {
        let session = session(seed % 2 == 0, millis, 2000 + seed)?;
        for independent in [false, true] {
            let data = if independent { of_independent_corners(&session.data) } else { session.data.clone() };
            let mut line = inside(&session, &data)?;
            line["seed"] = json!(seed);
            line["millis"] = json!(millis);
            line["independent"] = json!(independent);
            lines.push(line);
        }
    }
    Ok(lines)
}

/// Errors of the further poses, which are free of noise, and of their pictures, which are not.
fn inside(session: &Session, data: &Dataset) -> Result<Value, Error> {
    let (calibration, data) = calibrated(&session.made.nominal, data, &CalibrationOptions::default())?;
    let (poses, bounds) = delivered(&calibration, &data, session.others.all_readings())?;
    let errors = deviations(session, &poses);
    let mut within = [0usize; 2];
    let mut expected = 0.0;
    for (error, bound) in errors.iter().zip(&bounds) {
        let limits = [bound.bound_position_m(), bound.bound_rotation_rad()];
        for (part, limit) in limits.into_iter().enumerate() {
            within[part] += usize::from(error.fixed_rows::<3>(3 * part).norm() <= limit);
        }
        expected += bound.sigma_position_m().powi(2) / errors.len() as f64;
    }
    let share = |count: usize| count as f64 / errors.len() as f64;
    let file = CalibrationFile::new(&calibration, &data, Inputs::default());
    let judgement = file.judge(&session.others, false, false)?;
    let kept = judgement.delivered().promised;
    let held_out = calibration.trust.held_out;
    let parts = |check: poecal::calibration::CoverageCheck| {
        [Some(check.position_mm().inside_bound95), check.rotation_deg().map(|it| it.inside_bound95)]
    };
    Ok(json!({
        "task": "bounds", "in_hand": session.simulation.in_hand,
        "inside": within.map(share), "mm": 1e3 * rms(&errors)[0], "expected_mm": 1e3 * expected.sqrt(),
        "inside_next": kept.copied().map(parts), "inside_held_out": held_out.map(parts),
        "level": calibration.verdict.level.words(),
    }))
}

/// The same poses as if nothing were common to the corners of a picture: each with the noise of its corners alone, as measurements of their own.
fn of_independent_corners(data: &Dataset) -> Dataset {
    let mut found = data.clone();
    found.pictures.common.shift_m = 0.0;
    found.pictures.common.turn_rad = 0.0;
    for at in 0..found.pictures.all.len() {
        let picture = &found.pictures.all[at];
        let pose = picture.directed(&found.observations[picture.row as usize].measurement.pose());
        let sighting = found.pictures.view(picture).and_then(|view| view.sighting(&pose, true));
        if let Some(sighting) = sighting {
            found.state_picture(at, &sighting);
        }
    }
    found.pictures.all.clear();
    found
}
