//! Sessions with held joints, with all inputs by which another program finds the same frames.

use poecal_calibrate::BlockChoice;
use poecal_calibrate::CalibrationOptions;
use poecal_fit::start::settle_pictures;
use poecal_model::camera::Corner;
use poecal_model::measurement::Set;
use poecal_model::simulate::Simulation;
use poecal_model::simulate::{PictureSimulation, elbow};
use poecal_numerics::error::Error;
use serde_json::{Value, json};

use crate::session::{COUNT, calibrate_session, common_error, hold_out_thirds, rebuild_pictures, simulation};

/// Errors of each configuration, mm and mrad.
const MILLIS: f64 = 0.5;

pub(crate) fn run(seed: u64) -> Result<Vec<Value>, Error> {
    let in_hand = seed.is_multiple_of(2);
    let base = simulation(in_hand, MILLIS, 5000 + seed);
    let session = Simulation { count: COUNT, error_rotation_rad: 0.0, error_position_m: 0.0, ..base.session };
    let simulation = PictureSimulation { session, common: common_error(MILLIS, in_hand), ..base };
    let made = simulation.run(&elbow())?;
    let pictures = &made.data.pictures;
    let mut data = rebuild_pictures(&made.data, 0..COUNT, (&pictures.cameras, &pictures.boards))?;
    hold_out_thirds(&mut data);
    let said = settle_pictures(&mut data, &made.nominal).all();
    let blocks = BlockChoice { fix: vec!["joints".to_owned()], ..BlockChoice::default() };
    let (calibration, fitted) =
        calibrate_session(&made.nominal, &data, &CalibrationOptions { blocks, ..CalibrationOptions::default() })?;
    let lens = simulation.lens;
    let corners = |corners: &[Corner]| -> Vec<[f64; 3]> {
        corners.iter().map(|it| [f64::from(it.point), it.pixel.x, it.pixel.y]).collect()
    };
    let rows: Vec<Value> = fitted
        .pictures
        .all
        .iter()
        .map(|picture| {
            let row = picture.row as usize;
            let tip = made.nominal.forward_kinematics(fitted.readings(row));
            json!({
                "held_out": fitted.observations[row].set == Some(Set::HeldOut),
                "tip": { "rotation": tip.rotation.transpose().as_slice(), "translation": tip.translation.as_slice() },
                "corners": corners(&picture.corners),
            })
        })
        .collect();
    let px = calibration.accuracy.held_out.as_ref().and_then(|it| it.calibrated.pixels);
    Ok(vec![json!({
        "task": "kinematics", "seed": seed, "in_hand": in_hand, "start": said, "px": px.map(|it| it.rms_px), "mm": px.map(|it| it.rms_mm),
        "lens": { "focal": lens.focal_px, "centre": lens.centre_px },
        "board": simulation.board.points.iter().map(|it| [it.x, it.y, it.z]).collect::<Vec<_>>(),
        "pictures": rows,
    })])
}
