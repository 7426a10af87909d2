//! Numbers measured and unknowns of a problem.

use super::measurements_words;
use crate::error::{Error, ErrorKind, Result};
use crate::measurement::Dataset;
use crate::problem::MOST_UNKNOWNS;
use crate::robot::{JointKind, Robot};

/// Refuses problems with fewer measured numbers than unknowns that data of this kind can determine.
pub(super) fn check_count(robot: &Robot, data: &Dataset, fit_rows: &[u32]) -> Result<()> {
    let screws: usize =
        robot.joints.iter().map(|joint| if joint.kind == JointKind::Revolute { 4 } else { 2 }).sum();
    let mut is_seen = vec![false; data.targets.len()];
    fit_rows.iter().for_each(|&row| is_seen[data.observations[row as usize].target] = true);
    for (is_seen, name) in is_seen.into_iter().zip(&data.targets) {
        if !is_seen {
            let name = name.as_deref().unwrap_or("the tip");
            return Err(Error::new(
                ErrorKind::Problem,
                format!(
                    "found no measurement of target `{name}` to fit, expected at least one of every target: fit some of its rows, or leave its rows out"
                ),
            ));
        }
    }
    let targets: usize = data.frames(fit_rows).iter().map(|&is_frame| if is_frame { 6 } else { 3 }).sum();
    let devices = 6 * (data.station_count() - 1);
    let needed = screws + targets + devices;
    if needed > MOST_UNKNOWNS {
        return Err(Error::new(
            ErrorKind::Problem,
            format!(
                "found {needed} unknowns ({screws} of the screws, {targets} of {} targets{}), expected at most {MOST_UNKNOWNS} in one fit: calibrate with fewer targets, or a shorter chain",
                data.targets.len(),
                of_devices(devices)
            ),
        ));
    }
    let given: usize =
        fit_rows.iter().map(|&row| data.observations[row as usize].measurement.observe().dim()).sum();
    if given < needed {
        return Err(Error::new(
            ErrorKind::Problem,
            format!(
                "found {} to fit with {given} measured numbers, expected at least {needed} numbers \
                 ({screws} of the screws, {targets} of the targets{}): measure more configurations, or hold out fewer",
                measurements_words(fit_rows.len()),
                of_devices(devices)
            ),
        ));
    }
    Ok(())
}

/// Unknowns of further device frames as part of a list, if there are any.
fn of_devices(unknowns: usize) -> String {
    if unknowns > 0 { format!(", {unknowns} of further device frames") } else { String::new() }
}
