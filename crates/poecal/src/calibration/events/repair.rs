//! A session as it would have been without what happened: rows left out, another device frame, another target, readings of before as those
//! of after.

use std::borrow::Cow;

use nalgebra::Vector3;

use super::happened::{Happened, event};
use super::hypotheses::Moved;
use super::names::{DEVICE, next_of};
use super::search::{Events, Search, Step, search};
use super::told::{Event, Repairs};
use crate::calibration::{
    Calibration, CalibrationOptions, DeviceFrameKnowledge, Robust, Searched, Stage, Statistic, fitted,
};
use crate::error::Result;
use crate::estimate::RowError;
use crate::lie::{Pose, rotation};
use crate::measurement::{Dataset, Quantity};
use crate::robot::{Body, MEASURED, Robot};

/// Most repairs of one session.
const MOST: usize = 4;
/// Largest share of the error before that a repair leaves.
const BETTER: f64 = 0.8;
/// The same of the error of the other rows, where some are left out.
const OTHERS_BETTER: f64 = 0.95;
/// Rows of the picture of a repair.
const DRAWN: usize = 200;

/// A calibration, and the session that it is of.
#[derive(Clone, Debug)]
pub struct Repaired<'a> {
    /// The calibration, with what was repaired and what is suspected.
    pub calibration: Calibration,
    /// The measurements as they were fitted: those given where nothing was repaired but rows left out.
    pub data: Cow<'a, Dataset>,
}

/// [`calibrate`](crate::calibrate) with the session repaired where something evidently happened in it and the repaired one predicts rows better
/// that are left out ([`CalibrationOptions::repair`]). All that belongs to the calibration belongs to [`Repaired::data`].
///
/// ```
/// use poecal::calibration::{CalibrationOptions, EventKind, calibrate_repairing};
/// use poecal::simulate::{Kind, Simulation, elbow};
/// let mut made = Simulation { count: 80, noise_position_m: 5e-5, ..Simulation::default() }.run(&elbow(), Kind::POINT)?;
/// // Somebody leans on the tracker.
/// for row in &mut made.data.observations[40..] {
///     row.measurement.values_mut()[0] += 2e-3;
/// }
/// let found = calibrate_repairing(&made.nominal, &made.data, &CalibrationOptions::default(), &mut |_| {})?;
/// let [moved] = &found.calibration.repairs[..] else { panic!("{:?}", found.calibration.suspicions) };
/// assert!(moved.kind == EventKind::Device && moved.from_row == 41);
/// assert!((moved.size_mm.unwrap_or(0.0) - 2.0).abs() < 0.3);
/// # Ok::<(), poecal::Error>(())
/// ```
///
/// # Errors
/// As [`calibrate`](crate::calibrate).
pub fn calibrate_repairing<'a>(
    robot: &Robot,
    data: &'a Dataset,
    options: &CalibrationOptions,
    progress: &mut dyn FnMut(Stage),
) -> Result<Repaired<'a>> {
    let mut best = fitted(robot, data, options, Searched::Afterwards(&[]), progress)?;
    let mut session = Session { data: Cow::Borrowed(data), left_out: Vec::new() };
    // A tolerance is chosen once.
    let chosen = best.chosen_tolerance;
    let options = &CalibrationOptions {
        tolerance: chosen.or(options.tolerance),
        chooses_tolerance: false,
        ..options.clone()
    };
    let (mut repairs, mut suspicions, mut early) = (Vec::new(), Vec::new(), None);
    for _ in 0..MOST {
        let (happened, doubt) = session.next(&best, options);
        early = doubt;
        let Some(happened) = happened else { break };
        let before = error_of(&best, &session);
        let event = event(&happened, &session.data, robot);
        let matters = happened.matters();
        let repaired = match options.repair {
            Repairs::Auto if matters => session.without(&happened, robot, options),
            Repairs::Auto | Repairs::Off => None,
        };
        let Some(repaired) = repaired else {
            let event = event.suspected(before, None);
            if matters && event.is_grave(before) {
                best = best.against(event.statement.clone());
            }
            suspicions.push(event);
            break;
        };
        // Where the other session cannot be fitted, that is no reason to have no calibration of this one.
        let Ok(other) =
            fitted(robot, &repaired.data, options, Searched::Afterwards(&repaired.left_out), &mut |_| {})
        else {
            suspicions.push(event.suspected(before, None));
            break;
        };
        let after = error_of(&other, &repaired);
        let is_better = match happened {
            // Rows that are wrong have errors of their own in any case: they matter by what they do to the others.
            Happened::Wrong(_) => {
                kept_error(&other, &repaired) <= OTHERS_BETTER * kept_error(&best, &repaired)
            }
            Happened::Step(_) => after <= BETTER * before,
        };
        if !is_better {
            if !happened.is_suspected(&best) {
                suspicions.push(event.suspected(before, Some(after)));
            }
            break;
        }
        let residuals = picture((&best, &session.data), (&other, &repaired.data));
        repairs.push(Event {
            error_before_mm: Some(before),
            error_after_mm: Some(after),
            residuals,
            ..event.0
        });
        (best, session) = (other, repaired);
    }
    best.warnings.extend(early);
    let calibration = Calibration { repairs, suspicions, chosen_tolerance: chosen, ..best };
    Ok(Repaired { calibration, data: session.data })
}

/// A session, and the rows of it that are left out.
struct Session<'a> {
    data: Cow<'a, Dataset>,
    left_out: Vec<u32>,
}

impl<'a> Session<'a> {
    /// What happened that is not repaired yet, and a doubt about all readings where nothing did.
    fn next(&self, best: &Calibration, options: &CalibrationOptions) -> (Option<Happened>, Option<String>) {
        let Some(found) = best.correction.as_deref() else { return (None, None) };
        let data = &*self.data;
        // Rows with a stated set may belong to another session.
        let is_stated = data.observations.iter().any(|row| row.set.is_some());
        let mut rows = if is_stated { best.fit_rows.clone() } else { data.all_rows() };
        rows.sort_unstable();
        rows.retain(|row| self.left_out.binary_search(row).is_err());
        let all = Search { calibration: best, found, data, options, rows: &rows };
        let Some(Events { wrong, step, early }) = search(&all) else { return (None, None) };
        let is_fitted = |row: &u32| best.fit_rows.binary_search(row).is_ok();
        // Rows that are suspected already and have no part in the fit need no other one.
        let is_done = wrong.iter().all(|row| best.robustness.suspects_row(*row))
            && (!wrong.iter().any(is_fitted)
                || best.robustness.loss.is_some() && best.robustness.suspects().count() == wrong.len());
        if !wrong.is_empty() && !is_done && options.robust == Robust::Auto {
            return (Some(Happened::Wrong(wrong)), early);
        }
        (step.map(Happened::Step), early)
    }

    /// The session without what happened; `None` where that is not possible.
    fn without(
        &self,
        happened: &Happened,
        robot: &Robot,
        options: &CalibrationOptions,
    ) -> Option<Session<'a>> {
        let left_out = self.left_out.clone();
        let step = match happened {
            Happened::Wrong(rows) => {
                let mut left_out: Vec<u32> = left_out.into_iter().chain(rows.iter().copied()).collect();
                left_out.sort_unstable();
                left_out.dedup();
                return Some(Session { data: self.data.clone(), left_out });
            }
            Happened::Step(step) => step,
        };
        let mut data = self.data.clone().into_owned();
        match step.moved {
            Moved::Device(station) => {
                let is_free = options.frame == DeviceFrameKnowledge::Unknown;
                let name = data.stations.get(station).cloned().flatten();
                let is_mounted = robot.instruments.iter().any(|it| Some(&it.name) == name.as_ref());
                let is_plain =
                    data.lengths.is_empty() && !data.is_ranging(station) && sees_places(&data, station);
                if !is_free || is_mounted || !is_plain {
                    return None;
                }
                if data.stations.is_empty() {
                    data.stations = vec![None];
                }
                let name = name.unwrap_or_else(|| DEVICE.to_owned());
                let next = next_of(&name, data.stations.iter().flatten());
                data.stations[station] = Some(name);
                data.stations.push(Some(next));
                let other = data.stations.len() - 1;
                let moved = data.observations.iter_mut().skip(step.first as usize);
                moved.filter(|row| row.station == station).for_each(|row| row.station = other);
            }
            Moved::Target(target) => move_targets(&mut data, &[target], step.first, robot, options)?,
            Moved::Tool => {
                let all: Vec<usize> = (0..data.targets.len()).collect();
                move_targets(&mut data, &all, step.first, robot, options)?;
            }
            Moved::Zero(joint) => {
                // The robot is what it is now: readings of before are as those of after would have been.
                let name = robot.joints.get(joint)?.reading.name.clone();
                let at = data.reading_names().iter().position(|it| *it == name)?;
                let factor = robot.joints.get(joint)?.reading.multiplier;
                let is_own = robot.joints.iter().filter(|it| it.reading.name == name).count() == 1;
                if !is_own
                    || data.controller.is_some()
                    || !data.further_readings().is_empty()
                    || factor == 0.0
                {
                    return None;
                }
                let shift = *step.size.first()? / factor;
                data.change_readings(step.first, |readings| {
                    if let Some(value) = readings.get_mut(at) {
                        *value -= shift;
                    }
                });
            }
            Moved::Drift(station) => still(&mut data, step, station)?,
        }
        Some(Session { data: Cow::Owned(data), left_out })
    }
}

/// Whether all rows of a station measured places.
fn sees_places(data: &Dataset, station: usize) -> bool {
    let mut own = data.observations.iter().filter(|row| row.station == station);
    own.all(|row| row.measurement.is_place())
}

/// Gives targets another name from a row on; `None` where they are of the model.
fn move_targets(
    data: &mut Dataset,
    targets: &[usize],
    first: u32,
    robot: &Robot,
    options: &CalibrationOptions,
) -> Option<()> {
    if options.move_tip {
        return None;
    }
    for &target in targets {
        let name = data.targets.get(target)?.clone().unwrap_or_else(|| MEASURED.to_owned());
        let is_elsewhere = robot.mounted.iter().any(|it| it.name == name && it.body == Body::Base);
        let is_shared = data.stations.iter().flatten().any(|it| *it == name);
        let on_other = robot.mounted.iter().any(|it| it.name == name && it.body != robot.tip_body());
        if is_elsewhere || is_shared || on_other {
            return None;
        }
        let next = next_of(&name, data.targets.iter().flatten());
        data.targets[target] = Some(name);
        data.targets.push(Some(next));
        let other = data.targets.len() - 1;
        let moved = data.observations.iter_mut().skip(first as usize);
        moved.filter(|row| row.target == target).for_each(|row| row.target = other);
    }
    Some(())
}

/// Takes a drift of a device out of its measurements.
fn still(data: &mut Dataset, step: &Step, station: usize) -> Option<()> {
    let [x, y, z, rx, ry, rz] = *<&[f64; 6]>::try_from(step.size.as_slice()).ok()?;
    if !sees_places(data, station) {
        return None;
    }
    let rows = data.seen_from(station, &data.all_rows());
    let about = data.mean_position(&rows);
    let last = (rows.len().max(2) - 1) as f64;
    for (place, &row) in rows.iter().enumerate() {
        let share = place as f64 / last - 0.5;
        let back = rotation::exp(&(Vector3::new(rx, ry, rz) * -share));
        let shift = Vector3::new(x, y, z) * share;
        let of = |position: &Vector3<f64>| back * (position - shift - about) + about;
        let measurement = &mut data.observations.get_mut(row as usize)?.measurement;
        *measurement = measurement.changed(|pose| Pose::new(back * pose.rotation, of(&pose.translation)))?;
    }
    Some(())
}

/// Error of the delivered model in cross-validation, millimetres or degrees; at least that of the fitted rows that are not left out.
fn error_of(found: &Calibration, session: &Session<'_>) -> f64 {
    let corrected = found.correction.as_deref().filter(|it| it.has_terms());
    let left_out = corrected.and_then(|it| it.left_out_m).map(|metres| 1e3 * metres);
    let random = found.trust.cross_validation.as_ref().and_then(|it| it.random.rms.leading());
    let left_out = left_out.or_else(|| random.map(|(_, rms)| rms)).filter(|it| it.is_finite());
    left_out.unwrap_or(0.0).max(kept_error(found, session))
}

/// Root mean square error of the delivered model on the fitted rows that a session does not leave out, millimetres or degrees.
fn kept_error(found: &Calibration, session: &Session<'_>) -> f64 {
    let kept = found.fit_rows.iter().copied().filter(|row| session.left_out.binary_search(row).is_err());
    let kept: Vec<u32> = kept.collect();
    let errors = errors_of(found, &session.data, &kept);
    Statistic::of(errors).map_or(f64::INFINITY, |it| it.rms)
}

/// Errors of the delivered model on some rows, millimetres or degrees.
fn errors_of(found: &Calibration, data: &Dataset, rows: &[u32]) -> Vec<f64> {
    let errors: Vec<RowError> = match found.correction.as_deref().filter(|it| it.has_terms()) {
        Some(corrected) => corrected.errors(data, rows),
        None => {
            let packed = found.packed(data);
            found.session(data, &packed).errors(rows, &found.models.calibrated)
        }
    };
    let shown = |error: &RowError| {
        let quantity = error.leading().unwrap_or(Quantity::Position);
        error.length(quantity).map_or(0.0, |length| quantity.unit().shown(length))
    };
    errors.iter().map(shown).collect()
}

/// Row numbers with the errors of two models, of some rows.
fn picture(before: (&Calibration, &Dataset), after: (&Calibration, &Dataset)) -> Vec<[f64; 3]> {
    let rows: Vec<u32> = after.1.all_rows();
    let step = rows.len().div_ceil(DRAWN).max(1);
    let some: Vec<u32> = rows.into_iter().step_by(step).collect();
    let errors = |(found, data): (&Calibration, &Dataset)| errors_of(found, data, &some);
    let both = errors(before).into_iter().zip(errors(after)).zip(&some);
    both.map(|((before, after), row)| [f64::from(*row) + 1.0, before, after]).collect()
}
