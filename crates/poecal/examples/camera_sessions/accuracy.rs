//! Errors of calibrated poses, compared with the least possible.

use poecal_calibrate::CalibrationOptions;
use poecal_calibrate::Corrections;
use poecal_numerics::error::Error;
use serde_json::{Value, json};

use crate::information::Information;
use crate::session::{all_rows, judge_session, places, register_deviations, rms, session};

/// Both positions of the camera, with the noise of corners alone and with an error of each configuration.
pub(crate) fn run(seed: u64) -> Result<Vec<Value>, Error> {
    let mut lines = Vec::new();
    for in_hand in [true, false] {
        for millis in [0.0, 0.1, 0.5] {
            let session = session(in_hand, millis, 1000 + seed)?;
            let geometry = CalibrationOptions { corrections: Corrections::Off, ..all_rows() };
            let (_, data, geometric) = judge_session(&session, &session.data, &geometry)?;
            let (usual, _, all) = judge_session(&session, &session.data, &all_rows())?;
            let information = Information::from_session(&session, session.simulation.common);
            let (least, least_registered) =
                (information.least_errors(), information.with_registration(&session).least_errors());
            let at = places(&session);
            let shown = |[shift, turn]: [f64; 2]| [1e3 * shift, 1e3 * turn];
            let common = data.pictures.common;
            lines.push(json!({
                "task": "accuracy", "seed": seed, "in_hand": in_hand, "millis": millis,
                "error": shown(rms(&geometric)), "least": shown(least),
                "registered": shown(rms(&register_deviations(&at, &geometric))), "least_registered": shown(least_registered),
                "delivered": shown(rms(&register_deviations(&at, &all))), "level": usual.verdict.level.words(),
                "common": shown([common.shift_m, common.turn_rad]), "about": format!("{:?}", common.about),
                "sigma_px": data.pictures.sigma_px,
            }));
        }
    }
    Ok(lines)
}
