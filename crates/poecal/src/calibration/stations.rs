//! Checks of several stations before a fit.

use super::{CalibrationOptions, DeviceFrameKnowledge, measurements_words};
use crate::error::{Error, ErrorKind, Result};
use crate::estimate::Unknowns;
use crate::measurement::Dataset;

/// Fewest rows that determine a device frame: three points.
const FEWEST_ROWS: usize = 3;

/// Refuses stations whose frame cannot be determined, and several stations if measurements are in the base frame.
pub(super) fn check_stations(
    data: &Dataset,
    [fitted, held_out]: [&[u32]; 2],
    options: &CalibrationOptions,
    unknowns: &Unknowns,
) -> Result<()> {
    let stations = data.station_count();
    if stations == 1 {
        return Ok(());
    }
    if options.frame == DeviceFrameKnowledge::Base {
        let message = format!(
            "found measurements of {stations} instruments that are to be in the base frame (--frame base), expected one of the two: leave \
             the instruments' names out if all measure in the base frame, or --frame base if each has a frame of its own"
        );
        return Err(Error::new(ErrorKind::Option, message));
    }
    for station in (0..stations).filter(|&station| unknowns.moves_frame(station)) {
        let rows = data.seen_from(station, fitted).len();
        if rows >= FEWEST_ROWS {
            continue;
        }
        let name = data.station_words(station);
        let judging = data.seen_from(station, held_out).len();
        let message = if rows == 0 && judging > 0 {
            format!(
                "found {} of {name} held out and none to fit, expected at least {FEWEST_ROWS} to find its frame from: fit some of them, or \
                 judge by `poecal validate --refit-frame` afterwards",
                measurements_words(judging)
            )
        } else {
            format!(
                "found {} of {name} to fit, expected at least {FEWEST_ROWS} to find its frame from: measure more from there, hold out \
                 fewer, or leave its rows out",
                measurements_words(rows)
            )
        };
        return Err(Error::new(ErrorKind::Problem, message));
    }
    Ok(())
}
