//! Shares of errors inside their 95 % bounds.

use nalgebra::{Matrix6, Vector6};
use poecal_arm::lie::Pose;
use poecal_calibrate::CalibrationOptions;
use poecal_fit::uncertainty::bound;
use poecal_model::camera::{CommonError, move_pose};
use poecal_model::measurement::{Dataset, Quantity, deviation};
use poecal_model::simulate::random;
use poecal_numerics::error::Error;
use poecal_results::calibration_file::{CalibrationFile, Inputs};
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;
use serde_json::{Value, json};

use crate::information::Information;
use crate::session::{PictureSession, calibrate_session, delivered_poses, deviations, rms, session, true_pose};

/// One position of the camera for each seed, with three errors of the configurations; each again by the rule of independent corners.
pub(crate) fn run(seed: u64) -> Result<Vec<Value>, Error> {
    let mut lines = Vec::new();
    for millis in [0.0, 0.1, 0.5] {
        let session = session(seed.is_multiple_of(2), millis, 2000 + seed)?;
        // Sessions of the other rule are for comparison.
        for independent in [false, true].into_iter().take(if seed % 4 < 2 { 2 } else { 1 }) {
            let data = if independent { of_independent_corners(&session.data) } else { session.data.clone() };
            let mut line = errors_inside(&session, &data)?;
            line["seed"] = json!(seed);
            line["millis"] = json!(millis);
            line["independent"] = json!(independent);
            lines.push(line);
        }
    }
    Ok(lines)
}

/// Errors of the further poses, which are free of noise, and of their pictures, which are not.
fn errors_inside(session: &PictureSession, data: &Dataset) -> Result<Value, Error> {
    let (calibration, data) = calibrate_session(&session.made.nominal, data, &CalibrationOptions::default())?;
    let (poses, bounds) = delivered_poses(&calibration, &data, session.others.all_readings())?;
    // The arm is in its actual configuration, as in the pictures.
    let mut generator = ChaCha8Rng::seed_from_u64(session.simulation.session.seed ^ 0x0b0e);
    let errors = deviations_with_own(session, &poses, &mut generator);
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
    let exact = deviations(session, &poses);
    let file = CalibrationFile::new(&calibration, &data, Inputs::default());
    let judgement = file.judge(&session.others, false, false)?;
    let kept = judgement.delivered_model().promised;
    let held_out = calibration.trust.held_out;
    let parts = |check: poecal_calibrate::CoverageCheck| {
        [Some(check.position_mm().inside_bound95), check.rotation_deg().map(|it| it.inside_bound95)]
    };
    Ok(json!({
        "task": "bounds", "in_hand": session.simulation.in_hand,
        "inside": within.map(share), "exact_mm": 1e3 * rms(&exact)[0], "inside_by_rule": by_rule(session, &exact), "mm": 1e3 * rms(&errors)[0], "expected_mm": 1e3 * expected.sqrt(),
        "inside_next": kept.copied().map(parts), "inside_held_out": held_out.map(parts),
        "level": calibration.verdict.level.words(),
        "scatter": calibration.trust.uncertainty.as_ref().map(|it| {
            let found = it.discrepancy;
            let own = found.standard_deviation;
            [found.scatter, found.extrapolation, 1e3 * own[Quantity::Position], 1e3 * own[Quantity::Rotation]]
        }),
        "about": format!("{:?}", data.pictures.common.about),
        "common": [1e3 * data.pictures.common.shift_m, 1e3 * data.pictures.common.turn_rad],
    }))
}

/// Shares of the errors of exact poses inside the 95 % bounds that independent corners imply.
fn by_rule(session: &PictureSession, deviations: &[Vector6<f64>]) -> [f64; 2] {
    let none = CommonError { shift_m: 0.0, turn_rad: 0.0, ..session.simulation.common };
    let spreads = Information::from_session(session, none).spreads();
    [0, 3].map(|first| {
        let is_inside = |(spread, error): (&Matrix6<f64>, &Vector6<f64>)| {
            let limit = bound(&spread.fixed_view::<3, 3>(first, first).into_owned());
            f64::from(u8::from(error.fixed_rows::<3>(first).norm() <= limit))
        };
        spreads.iter().zip(deviations).map(is_inside).sum::<f64>() / deviations.len() as f64
    })
}

/// Deviations of poses from the true ones, each with an error of its configuration.
fn deviations_with_own(session: &PictureSession, poses: &[Pose], generator: &mut ChaCha8Rng) -> Vec<Vector6<f64>> {
    let PictureSession { made, others, simulation, .. } = session;
    let of = |(row, pose): (usize, &Pose)| {
        let shift = random::normal_vector(generator) * simulation.common.shift_m;
        let turn = random::normal_vector(generator) * simulation.common.turn_rad;
        let truth = true_pose(made, &made.actual, others.readings(row));
        let own = Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z);
        deviation(pose, &move_pose(&truth, &own))
    };
    poses.iter().enumerate().map(of).collect()
}

/// The same poses without common errors of a picture's corners: each with the noise of its corners alone, as measurements of their own.
fn of_independent_corners(data: &Dataset) -> Dataset {
    let mut found = data.clone();
    found.pictures.common.shift_m = 0.0;
    found.pictures.common.turn_rad = 0.0;
    for at in 0..found.pictures.all.len() {
        let picture = &found.pictures.all[at];
        let pose = picture.directed_measurement(&found.observations[picture.row as usize].measurement.pose());
        let sighting = found.pictures.view(picture).and_then(|view| view.sighting(&pose, true));
        if let Some(sighting) = sighting {
            found.state_picture(at, &sighting);
        }
    }
    found.pictures.all.clear();
    found
}
