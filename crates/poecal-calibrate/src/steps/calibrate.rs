//! From a robot and measurements to a calibrated robot: the steps in order.

use std::borrow::Cow;

use crate::events::repair;
use crate::run::CalibrationRun;
use crate::run::option_conflicts::refuse_options;
use crate::{Calibration, CalibrationOptions, CalibrationStage, Corrections, RepairedSession};
use poecal_model::measurement::Dataset;
use poecal_model::robot::Robot;
use poecal_numerics::error::Result;

/// Calibrates a robot from measurements.
///
/// # Errors
/// [`ErrorKind::Problem`](poecal_numerics::error::ErrorKind::Problem) if there are too few measurements,
/// [`ErrorKind::Option`](poecal_numerics::error::ErrorKind::Option) for options out of range,
/// [`ErrorKind::Solver`](poecal_numerics::error::ErrorKind::Solver) if no finite result could be reached.
pub fn calibrate(robot: &Robot, data: &Dataset, options: &CalibrationOptions) -> Result<Calibration> {
    Ok(run_calibration(robot, data, options, false, &mut |_| {})?.calibration)
}

/// [`calibrate`] with the session repaired if an event is evident and the repaired session predicts left-out rows better
/// ([`CalibrationOptions::repair`]); reports each stage as it begins. The results of the calibration refer to [`RepairedSession::data`].
///
/// # Errors
/// As [`calibrate`].
pub fn calibrate_repairing<'a>(
    robot: &Robot,
    data: &'a Dataset,
    options: &CalibrationOptions,
    progress: &mut dyn FnMut(CalibrationStage),
) -> Result<RepairedSession<'a>> {
    run_calibration(robot, data, options, true, progress)
}

/// All steps; `searches` requests the search for events.
fn run_calibration<'a>(
    robot: &Robot,
    data: &'a Dataset,
    options: &CalibrationOptions,
    searches: bool,
    progress: &mut dyn FnMut(CalibrationStage),
) -> Result<RepairedSession<'a>> {
    refuse_options(data, options)?;
    // Rows, unknowns and prior; refuses problems that cannot be fitted.
    let run = CalibrationRun::new(robot, Cow::Borrowed(data), options, Vec::new())?;
    // A loop over fits, if it is requested.
    let run = run.with_best_tolerance()?;
    progress(CalibrationStage::Registration);
    let start = run.register();
    // A session of few rows, without one that alone ruins its start.
    let (run, start) = run.without_ruinous(start);
    progress(CalibrationStage::Fit);
    // A loop if several instruments have different noises: fit, noises, fit.
    let fit = run.fit(start)?;
    if fit.run.corrections != Corrections::Off {
        progress(CalibrationStage::Corrections);
    }
    // A loop if the corrected model suspects other rows than geometry: terms, rows, fit, terms.
    let mut found = fit.correct()?;
    // A loop over sessions with events: search, the session without the event, its fit.
    let events = searches.then(|| repair(&mut found));
    progress(CalibrationStage::Analysis);
    // The complete judgement of the fit, once.
    let RepairedSession { calibration, data: repaired } = found.judge(events)?;
    // Data that a formulation rewrites are returned unchanged.
    let is_as_given = calibration.repairs.is_empty() && data.pictures.is_empty();
    let data = if is_as_given { Cow::Borrowed(data) } else { repaired };
    Ok(RepairedSession { calibration, data })
}
