//! Errors of calibrated poses, beside the least that is possible.

use poecal::calibration::Corrections;
use poecal::{CalibrationOptions, Error};
use serde_json::{Value, json};

use crate::information::least_errors;
use crate::session::{all_rows, judged, session};

/// Both places of the camera, with the noise of corners alone and with an error of each configuration.
pub(crate) fn run(seed: u64) -> Result<Vec<Value>, Error> {
    let mut lines = Vec::new();
    for in_hand in [true, false] {
        for millis in [0.0, 0.1, 0.5] {
            let session = session(in_hand, millis, 1000 + seed)?;
            let geometry = CalibrationOptions { corrections: Corrections::Off, ..all_rows() };
            let (_, _, [shift, turn]) = judged(&session, &session.data, &geometry)?;
            let (usual, _, [usual_shift, _]) = judged(&session, &session.data, &all_rows())?;
            let [least_shift, least_turn] = least_errors(&session);
            lines.push(json!({
                "task": "accuracy", "seed": seed, "in_hand": in_hand, "millis": millis,
                "mm": 1e3 * shift, "mrad": 1e3 * turn, "usual_mm": 1e3 * usual_shift,
                "least_mm": 1e3 * least_shift, "least_mrad": 1e3 * least_turn,
                "level": usual.verdict.level.words(),
            }));
        }
    }
    Ok(lines)
}
