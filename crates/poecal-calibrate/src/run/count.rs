//! Numbers measured and unknowns of a problem.

use poecal_fit::problem::MOST_UNKNOWNS;
use poecal_fit::start::device_parameter;
use poecal_fit::state::Session;
use poecal_model::measurement::Dataset;
use poecal_model::robot::{JointKind, MEASURED};
use poecal_numerics::error::{ErrorKind, Result};

/// Refuses problems with fewer measured numbers than unknowns that data of this kind can determine.
pub(crate) fn check_count(session: &Session<'_>, fit_rows: &[u32]) -> Result<()> {
    let Session { robot, data, unknowns, .. } = *session;
    let joints = robot.joints.iter().enumerate().filter(|(joint, _)| unknowns.moves_axis(*joint));
    let screws: usize = joints.map(|(_, joint)| if joint.kind == JointKind::Revolute { 4 } else { 2 }).sum::<usize>()
        + unknowns.terms.len();
    let mut is_seen = vec![false; data.targets.len()];
    fit_rows.iter().for_each(|&row| is_seen[data.observations[row as usize].target] = true);
    for (is_seen, name) in is_seen.into_iter().zip(&data.targets) {
        if !is_seen {
            let name = name.as_deref().unwrap_or(MEASURED);
            return ErrorKind::Problem.refuse(format!(
                    "found no measurement of target `{name}` to fit, expected at least one of every target: fit some of its rows, or leave its rows out"
                ));
        }
    }
    let targets = data.target_freedoms(fit_rows).into_iter().enumerate();
    let targets = targets.filter(|(target, _)| unknowns.moves_target(*target));
    let targets: usize = targets.map(|(_, freedom)| freedom.count()).sum();
    // If axes are free, the first frame is no further unknown.
    let held = session.held_station(fit_rows);
    let devices = (0..data.station_count()).filter(|&at| Some(at) != held && unknowns.moves_frame(at));
    let devices: usize = devices.map(|at| of_device(data, at, fit_rows)).sum();
    let needed = screws + targets + devices;
    if needed == 0 {
        return ErrorKind::Option.refuse("found nothing that is unknown, expected at least one block to fit: fix fewer, or leave --device-frame base out");
    }
    if needed > MOST_UNKNOWNS {
        return ErrorKind::Problem.refuse(format!(
                "found {needed} unknowns ({screws} of the screws, {targets} of {} targets{}), expected at most {MOST_UNKNOWNS} in one fit: calibrate with fewer targets, or a shorter chain",
                data.targets.len(),
                of_devices(devices)
            ));
    }
    let given: usize = fit_rows.iter().map(|&row| data.observations[row as usize].measurement.dim()).sum();
    if given < needed {
        return ErrorKind::Problem.refuse(format!(
            "found {} to fit with {given} measured numbers, expected at least {needed} numbers \
                 ({screws} of the screws, {targets} of the targets{}): measure more configurations, or hold out fewer",
            measurements_words(fit_rows.len()),
            of_devices(devices)
        ));
    }
    Ok(())
}

/// Unknowns of a station's frame in some rows.
pub(crate) fn of_device(data: &Dataset, station: usize, rows: &[u32]) -> usize {
    device_parameter(data, station, rows).model().columns().len()
}

/// Unknowns of further device frames as part of a list, if there are any.
fn of_devices(unknowns: usize) -> String {
    if unknowns > 0 { format!(", {unknowns} of device frames") } else { String::new() }
}

/// A number of measurements in words.
pub(crate) fn measurements_words(count: usize) -> String {
    if count == 1 { "1 measurement".to_owned() } else { format!("{count} measurements") }
}
