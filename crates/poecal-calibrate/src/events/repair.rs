//! Search of a session for events, and repair of the evident ones.

use super::event_reports::{Event, Repairs};
use super::repaired_session::undo_events;
use super::search::{SearchFindings, search};
use super::search_outcome::{SearchOutcome, event};
use crate::run::CalibrationRun;
use crate::steps::corrected_fit::FittedSession;
use crate::{RobustLoss, Statistic};
use poecal_fit::state::RowError;
use poecal_model::measurement::Quantity;
use poecal_numerics::error::Result;

/// Most repairs of one session.
const MOST: usize = 4;
/// Largest share of the error before that a repair leaves.
const BETTER: f64 = 0.8;
/// Largest share of the error of the other rows, if some are left out.
const OTHERS_BETTER: f64 = 0.95;
/// Rows of the plot of a repair.
const DRAWN: usize = 200;

/// Events of a session.
#[derive(Default)]
pub(crate) struct Events {
    /// Repaired events.
    pub(crate) repairs: Vec<Event>,
    /// Suspected events that were not repaired.
    pub(crate) suspicions: Vec<Event>,
    /// Statement about readings that were early in every configuration.
    pub(crate) early: Option<String>,
    /// Reason against use of the session.
    pub(crate) against: Option<String>,
}

/// Searches a session by its corrected model, and repairs evident events. A repair is kept if the repaired session predicts left-out rows better, and
/// no mistake in the input explains more.
pub(crate) fn repair(best: &mut FittedSession<'_>) -> Events {
    let mut events = Events::default();
    for _ in 0..MOST {
        let (happened, early) = next(best);
        events.early = early;
        let Some(happened) = happened else { break };
        let before = error_of(best);
        let run = &best.fit.run;
        let said = event(&happened, &run.data, &run.robot);
        let exceeded = said.exceeded_limit(&run.options.repair_limits, &run.data, best.fit.session().length_m);
        let is_open = exceeded.is_none() && run.options.repair == Repairs::Auto;
        let said = exceeded.iter().fold(said, |said, limit| said.with_limit(limit));
        let Some(repaired) = is_open.then(|| undo_events(run, &happened)).flatten() else {
            let event = said.suspected_event(before, None);
            if happened.matters() && event.is_grave(before) {
                events.against = Some(event.statement.clone());
            }
            events.suspicions.push(event);
            break;
        };
        // A repaired session that cannot be fitted is no reason against a calibration of this one.
        let Ok(other) = repaired.and_then(fit_session) else {
            events.suspicions.push(said.suspected_event(before, None));
            break;
        };
        let after = error_of(&other);
        let left_out = &other.fit.run.left_out;
        let is_better = match happened {
            // Wrong rows have errors of their own in any case: their effect on the other rows decides.
            SearchOutcome::Wrong(_) => kept_error(&other, left_out) <= OTHERS_BETTER * kept_error(best, left_out),
            SearchOutcome::Step(_) => {
                let [before, after] = compare_errors(best, &other);
                after <= BETTER * before
            }
        };
        if !is_better {
            if !happened.is_suspected(&best.fit) {
                events.suspicions.push(said.suspected_event(before, Some(after)));
            }
            break;
        }
        // The mistake is named at the end, since it stays in the session.
        if explains_more(best, &other, after) {
            break;
        }
        events.repairs.push(said.repaired_event([before, after], picture(best, &other)));
        *best = other;
    }
    events
}

/// True if a mistake in the input explains a session better than the repair does, or remains in the repaired session.
fn explains_more(session: &FittedSession<'_>, repaired: &FittedSession<'_>, after: f64) -> bool {
    let mistake = |found: &FittedSession<'_>| found.fit.mistake(&found.summary);
    mistake(session).is_some_and(|it| it.after_mm <= after || mistake(repaired).is_some())
}

/// Fits a session.
fn fit_session(run: CalibrationRun<'_>) -> Result<FittedSession<'_>> {
    let start = run.register();
    run.fit(start)?.correct()
}

/// Next event that is not repaired yet, or else a doubt about all readings.
fn next(found: &FittedSession<'_>) -> (Option<SearchOutcome>, Option<String>) {
    let FittedSession { fit, corrected: Some(corrected), .. } = found else { return (None, None) };
    let run = &fit.run;
    // Rows with a stated set may belong to another session.
    let is_stated = run.data.observations.iter().any(|row| row.set.is_some());
    let mut rows = if is_stated { run.fit_rows.clone() } else { run.data.all_rows() };
    rows.sort_unstable();
    rows.retain(|row| run.left_out.binary_search(row).is_err());
    let Some(SearchFindings { wrong, step, early }) = search(fit, corrected, &rows) else {
        return (None, None);
    };
    let is_fitted = |row: &u32| run.fit_rows.binary_search(row).is_ok();
    // Rows that are suspected already and have no part in the fit need no further fit.
    let is_done = wrong.iter().all(|row| fit.robust.robustness.suspects_row(*row))
        && (!wrong.iter().any(is_fitted)
            || fit.robust.robustness.loss.is_some() && fit.robust.robustness.suspects().count() == wrong.len());
    if !wrong.is_empty() && !is_done && run.options.robust == RobustLoss::Auto {
        return (Some(SearchOutcome::Wrong(wrong)), early);
    }
    (step.map(SearchOutcome::Step), early)
}

/// Errors of two sessions in cross-validation by models of one kind: terms that only one of them has are no merit of a repair.
fn compare_errors(best: &FittedSession<'_>, other: &FittedSession<'_>) -> [f64; 2] {
    let of = if has_terms(best) == has_terms(other) { error_of } else { of_geometry };
    [of(best), of(other)]
}

/// True if the model of a session has terms.
fn has_terms(found: &FittedSession<'_>) -> bool {
    found.corrected.as_ref().is_some_and(|it| it.has_terms())
}

/// Error of geometry alone in cross-validation, millimetres or degrees; NaN without cross-validation.
fn of_geometry(found: &FittedSession<'_>) -> f64 {
    let random = found.cross_validation.as_ref().and_then(|it| it.random.rms.leading_value());
    random.map_or(f64::NAN, |(_, rms)| rms)
}

/// Error of the delivered model in cross-validation, millimetres or degrees; at least its error on the fitted rows that are not left out.
fn error_of(found: &FittedSession<'_>) -> f64 {
    let validated = found.cross_validation.as_ref();
    let corrected = found.corrected.as_ref().filter(|it| it.has_terms());
    let left_out = corrected.and_then(|it| it.left_out_m(validated)).map(|metres| 1e3 * metres);
    let random = validated.and_then(|it| it.random.rms.leading_value());
    let left_out = left_out.or_else(|| random.map(|(_, rms)| rms)).filter(|it| it.is_finite());
    left_out.unwrap_or(0.0).max(kept_error(found, &found.fit.run.left_out))
}

/// Root mean square error of the delivered model on the fitted rows except some, millimetres or degrees.
fn kept_error(found: &FittedSession<'_>, left_out: &[u32]) -> f64 {
    let kept = found.fit.run.fit_rows.iter().copied().filter(|row| left_out.binary_search(row).is_err());
    let errors = errors_of(found, &kept.collect::<Vec<u32>>());
    Statistic::from_errors(errors).map_or(f64::INFINITY, |it| it.rms)
}

/// Errors of the delivered model on some rows, millimetres or degrees.
fn errors_of(found: &FittedSession<'_>, rows: &[u32]) -> Vec<f64> {
    let errors: Vec<RowError> = match found.corrected.as_ref().filter(|it| it.has_terms()) {
        Some(corrected) => corrected.session(&found.fit).errors(rows, &corrected.estimate),
        None => found.fit.session().errors(rows, &found.fit.estimate),
    };
    let shown = |error: &RowError| {
        let quantity = error.leading_quantity().unwrap_or(Quantity::Position);
        error.length(quantity).map_or(0.0, |length| quantity.unit().in_shown_unit(length))
    };
    errors.iter().map(shown).collect()
}

/// Numbers of some rows with the errors of two models.
fn picture(before: &FittedSession<'_>, after: &FittedSession<'_>) -> Vec<[f64; 3]> {
    let rows: Vec<u32> = after.fit.run.data.all_rows();
    let step = rows.len().div_ceil(DRAWN).max(1);
    let some: Vec<u32> = rows.into_iter().step_by(step).collect();
    let both = errors_of(before, &some).into_iter().zip(errors_of(after, &some)).zip(&some);
    both.map(|((before, after), row)| [f64::from(*row) + 1.0, before, after]).collect()
}
