//! Measurements of a moving robot with the joint readings of another clock, and the messages on them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::join_entry::JoinEntry;
use super::join_pairs::{JoinedReadings, JointRows};
use super::join_plan::{MotionByLine, ReadingsByLine};
use super::join_words::{mm, several_lags};
use crate::{Join, Lag};
use poecal_fit::input_doubts::joined_rows::{self, is_doubtful, reason};
use poecal_fit::start::{
    JointStream, LagFailure, LaggedMeasurements, MotionMeasurements, MotionRecording, motion_of_target, smooth_times,
};
use poecal_model::measurement::Dataset;
use poecal_model::robot::Robot;
use poecal_numerics::error::{ErrorKind, Result};

/// Ratio of the errors with smoothed and with original stamps below which the original stamps are irregularly late.
const SMOOTHER: f64 = 0.8;

/// Result of a search with some stamps.
type LagResult = std::result::Result<MotionMeasurements, LagFailure>;

/// Times of the rows of both, as stamped or smoothed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct RowStamps {
    joints: bool,
    measured: bool,
}

/// The readings of each line at the lag at which the nominal robot, registered, fits.
///
/// # Errors
/// [`ErrorKind::Measurement`] without times, positions and motion, and if no lag or several lags fit.
pub(crate) fn in_motion(
    joints: &JointRows,
    (path, data, times): (&Path, &Dataset, &[f64]),
    robot: &Robot,
    lag: Option<Lag>,
) -> Result<JoinedReadings> {
    let stated = lag.map(|it| (it.lag_s, it.off_s));
    let refuse = |message: String| refuse_pair(joints, path, message);
    let Some((stamps, found)) = search(joints, (path, data, times), robot, stated)? else {
        return refuse("found no times, expected a column `time` in both files".to_owned());
    };
    let near = if lag.is_some() { " near the stated one" } else { "" };
    let at_rest = |lag_s: f64| {
        let stream = JointStream::new(&joints.times, &joints.readings, joints.turns.len())?;
        MotionRecording::new(robot, &stream, data, times).ok()?.at_rest(lag_s)
    };
    let unfit = |best: &LaggedMeasurements, words: &str| {
        let reason = at_rest(best.lag_s).map_or_else(String::new, |it| format!(": {}", reason(robot, &it)));
        refuse(format!(
            "found measurements that fit the joint readings at no lag of the clocks{near}{words}, best {:.3} s ({}), expected recordings of the same \
             motion of the same robot{reason}",
            best.lag_s,
            mm(best.missed_m)
        ))
    };
    match found {
        Ok(found) => {
            let warning = at_rest(found.clock.lag_s).map(|rows| {
                joined_rows::warning(robot, found.missed_m, || rows, &format!("at a lag of {:.3} s", found.clock.lag_s))
            });
            let mut joined = join_motion(joints, (path, data, times), robot, (stamps, &found));
            match warning.transpose() {
                Ok(warning) => {
                    let files = format!("{}, {}", joints.path.display(), path.display());
                    joined.warnings.extend(warning.flatten().map(|it| format!("{files}: {it}")));
                    Ok(joined)
                }
                Err(message) => refuse(message),
            }
        }
        Err(LagFailure::NoMotion) => refuse(format!(
            "found no lag of the clocks{near} at which both streams move together for 5 s or longer, expected recordings of the same motion"
        )),
        Err(LagFailure::Alike(all)) => match all.first() {
            Some(best) if is_doubtful(robot, best.missed_m) => unfit(best, ""),
            best => {
                let words = |it: &LaggedMeasurements| format!("{:.3} s ({})", it.lag_s, mm(it.missed_m));
                let listed: Vec<String> = all.iter().map(words).collect();
                refuse(several_lags(&listed, best.map_or(0.0, |it| it.lag_s)))
            }
        },
        Err(LagFailure::None(best)) => unfit(&best, " better than by chance"),
    }
}

/// Refuses a file of measurements beside one of joint readings.
fn refuse_pair<T>(joints: &JointRows, path: &Path, message: String) -> Result<T> {
    let words = format!("{message} ({} has the joint readings)", joints.path.display());
    Err(ErrorKind::Measurement.error(words).in_file(path))
}

/// The best result with the stamps of both, original or smoothed.
fn search(
    joints: &JointRows,
    (path, data, times): (&Path, &Dataset, &[f64]),
    robot: &Robot,
    stated: Option<(f64, f64)>,
) -> Result<Option<(RowStamps, LagResult)>> {
    let smooth = (smooth_times(&joints.times), smooth_times(times));
    let mut found: Vec<(RowStamps, LagResult)> = Vec::new();
    for stamps in [(false, false), (true, false), (false, true), (true, true)] {
        let stamps = RowStamps { joints: stamps.0, measured: stamps.1 };
        let own = if stamps.joints { smooth.0.as_ref() } else { Some(&joints.times) };
        let seen = if stamps.measured { smooth.1.as_deref() } else { Some(times) };
        let (Some(own), Some(seen)) = (own, seen) else { continue };
        let Some(stream) = JointStream::new(own, &joints.readings, joints.turns.len()) else {
            return refuse_pair(
                joints,
                path,
                "found joint readings without times of their own, expected a column `time` in both files".to_owned(),
            );
        };
        let motion = MotionRecording::new(robot, &stream, data, seen).map_err(|error| error.in_file(path))?;
        found.push((stamps, motion.find_lag(stated)));
    }
    Ok(choose_stamps(found))
}

/// The result with original stamps, or with smoothed ones if these fit evidently better.
fn choose_stamps(mut found: Vec<(RowStamps, LagResult)>) -> Option<(RowStamps, LagResult)> {
    // The original stamps come first.
    let usual_m = match found.first()? {
        (_, Ok(it)) => it.fitted_m,
        (_, Err(_)) => f64::INFINITY,
    };
    let alike_m = match found.first()? {
        (_, Err(LagFailure::Alike(all))) => all.first().map_or(f64::INFINITY, |it| it.missed_m),
        _ => f64::INFINITY,
    };
    let is_better = |it: &(RowStamps, LagResult)| {
        it.1.as_ref().is_ok_and(|it| it.fitted_m < SMOOTHER * usual_m && it.missed_m < SMOOTHER * alike_m)
    };
    let at = found.iter().position(is_better).unwrap_or_default();
    Some(found.swap_remove(at))
}

fn join_motion(
    joints: &JointRows,
    (path, data, times): (&Path, &Dataset, &[f64]),
    robot: &Robot,
    (stamps, found): (RowStamps, &MotionMeasurements),
) -> JoinedReadings {
    let lines: BTreeSet<u32> = data.observations.iter().map(|it| it.source.line).collect();
    let entry = JoinEntry {
        joints: joints.path.display().to_string(),
        measurements: path.display().to_string(),
        join: Join::Motion,
        joint_rows: joints.lines.len(),
        measured_rows: lines.len(),
        paired: found.rows.len(),
        missed_mm: Some(1e3 * found.missed_m),
        lag_s: Some(found.clock.lag_s),
        pairs: Vec::new(),
        unmeasured: Vec::new(),
        repeated: Vec::new(),
        unread: Vec::new(),
        robot_motion: joints.sampled.as_ref().map(|it| it.of_robot(robot, &[])),
        measured_motion: motion_of_target(data, times, &[]),
    };
    let mut readings = ReadingsByLine { controller: joints.controller.clone(), ..ReadingsByLine::default() };
    let mut rows = BTreeMap::new();
    for row in &found.rows {
        let Some(observation) = data.observations.get(row.row as usize) else { continue };
        let line = observation.source.line as usize;
        readings.lines.insert(line, row.readings.clone());
        rows.insert(line, (row.rates.clone(), row.time_s));
    }
    let (own, path) = (joints.path.display(), path.display());
    let clock = found.clock;
    let mut notes = vec![format!(
        "{own} and {path} were joined in motion: {} rows of {}, at a lag of {:.4} s of the clock of {path} in the middle, which drifts by {:.1} ppm; the nominal robot misses them by {:.3} mm (median)",
        rows.len(),
        data.len(),
        clock.lag_s,
        1e6 * clock.drift,
        1e3 * found.missed_m
    )];
    let late = [(stamps.joints, &own), (stamps.measured, &path)];
    for (_, name) in late.iter().filter(|(is_smoothed, _)| *is_smoothed) {
        notes.push(format!(
            "{name}: its rows come at equal steps and their stamps are late irregularly, so that each time is that of the stamps around it"
        ));
    }
    let mut warnings = Vec::new();
    if found.jitter_s > LARGE_JITTER_S {
        warnings.push(format!(
            "{path}: errors along the motion are as of stamps that scatter by {:.1} ms: let the robot stop at each configuration, or record both by one clock",
            1e3 * found.jitter_s
        ));
    }
    readings.moving = Some(MotionByLine { rows, clock });
    JoinedReadings { entry, readings, unmeasured: Vec::new(), notes, warnings }
}

/// Smallest scatter of single stamps that is reported, seconds.
const LARGE_JITTER_S: f64 = 5e-4;
