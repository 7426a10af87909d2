//! Random set-ups of a camera, calibrated without a guess.

use poecal_calibrate::CalibrationOptions;
use poecal_fit::start::settle_pictures;
use poecal_numerics::error::Error;
use serde_json::{Value, json};

use crate::scene::{CameraMount, CameraScene};
use crate::session::calibrate_session;

pub(crate) fn run(seed: u64) -> Result<Vec<Value>, Error> {
    let CameraScene { place, nominal, mut data } = CameraScene::random(seed)?;
    let said = settle_pictures(&mut data, &nominal).all();
    let right = match place {
        CameraMount::Hand => said.first().is_some_and(|it| it.contains("on the last link, and the board stays")),
        CameraMount::Beside => said.first().is_some_and(|it| it.contains("beside the robot")),
        CameraMount::Head => said.is_empty(),
    };
    let prismatic = nominal.joints.iter().filter(|joint| joint.screw.is_prismatic()).count();
    let mut line = json!({
        "task": "setups", "seed": seed, "place": format!("{place:?}"), "joints": nominal.joints.len(),
        "prismatic": prismatic, "pictures": data.len(), "right": right, "start": said,
    });
    match calibrate_session(&nominal, &data, &CalibrationOptions::default()) {
        Ok((calibration, _)) => {
            let accuracy = &calibration.accuracy;
            let px =
                |of: &poecal_calibrate::ModelAccuracy| of.pixels.map(|it| [it.rms_px, it.median_picture_px, it.rms_mm]);
            line["training"] = json!(px(&accuracy.training.calibrated));
            line["held_out"] = json!(accuracy.held_out.as_ref().map(|it| px(&it.calibrated)));
            line["registered"] = json!(accuracy.held_out.as_ref().map(|it| px(&it.registered)));
            line["unseen"] = json!(accuracy.held_out.as_ref().map(|it| it.calibrated.pixels.map(|it| it.unseen)));
            line["expected_mm"] = json!(calibration.trust.held_out.map(|it| it.position_mm().expected_rms));
            line["error_mm"] = json!(accuracy.held_out.as_ref().map(|it| it.calibrated.position_mm().rms));
            line["level"] = json!(calibration.verdict.level.words());
            line["suspected"] = json!(calibration.robustness.rows.iter().filter(|row| row.suspected).count());
            line["determined"] = json!([calibration.identifiability.rank, calibration.identifiability.parameters]);
        }
        Err(error) => line["refused"] = json!(error.to_string()),
    }
    Ok(vec![line])
}
