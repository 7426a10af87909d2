//! Checks of several stations before a fit.

use super::count::measurements_words;
use crate::{CalibrationOptions, DeviceFrameKnowledge};
use poecal_arm::lie::Freedom;
use poecal_fit::state::{Session, Unknowns};
use poecal_model::measurement::Dataset;
use poecal_numerics::error::{ErrorKind, Result};

/// Fewest rows that determine a device frame: three points.
const FEWEST_ROWS: usize = 3;

/// Fewest rows that determine the observable part of a station's frame.
fn minimum_rows(data: &Dataset, station: usize, rows: &[u32]) -> usize {
    let numbers = rows.iter().map(|&row| data.observations[row as usize].measurement.dim()).max();
    let freedom = data.device_freedom(station, rows);
    if freedom == Freedom::FRAME { FEWEST_ROWS } else { freedom.count().div_ceil(numbers.unwrap_or(1)) }
}

/// Refuses stations whose frame cannot be determined, and several stations if measurements are in the base frame.
pub(crate) fn check_stations(
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
        return ErrorKind::Option.refuse(format!(
            "found measurements of {stations} instruments that are to be in the base frame (--device-frame base), expected one of the two: leave \
             the instruments' names out if all measure in the base frame, or --device-frame base if each has a frame of its own"
        ));
    }
    for station in (0..stations).filter(|&station| unknowns.moves_frame(station)) {
        let (own, judging) = (data.seen_from(station, fitted), data.seen_from(station, held_out));
        // A station that only held-out rows name is determined from these.
        let rows = if own.is_empty() { judging } else { own };
        let needed = minimum_rows(data, station, &rows);
        if rows.len() >= needed {
            continue;
        }
        return ErrorKind::Problem.refuse(format!(
            "found {} of {} to find its frame from, expected at least {needed}: measure more from there, hold out fewer, or leave its rows out",
            measurements_words(rows.len()),
            data.station_words(station),
        ));
    }
    Ok(())
}

/// Refuses a fit without a tolerance if no measured quantity has a length: the best-fitting robot is then a point.
pub(crate) fn check_length(session: &Session<'_>, options: &CalibrationOptions, fitted: &[u32]) -> Result<()> {
    let has_tolerance = options.tolerance.is_some() || options.chooses_tolerance;
    if has_tolerance || !session.lacks_length(fitted) {
        return Ok(());
    }
    ErrorKind::Problem.refuse("found no tolerance, and nothing measured that has a length: the robot that fits best would be a point; expected a tolerance \
                   (--tolerance), or a known length, such as the distance of two sockets (--socket-distance)")
}
