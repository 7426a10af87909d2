//! Errors of the nominal robot on joined data that are so large that the data may not belong together.

use crate::forensics::{DiagnosisKind, DiagnosisOptions, diagnose};
use poecal_model::measurement::Dataset;
use poecal_model::robot::Robot;

/// Share of the reach beyond which a diagnosis is made, and beyond which unexplained data are refused.
const ODD: f64 = 0.01;
const DOUBTFUL: f64 = 0.05;
/// Remedy if a diagnosis finds nothing.
const LOOK: &str = "look at the units, the signs and the order of joints and measurements";

/// Diagnosis of mistakes in joined data.
#[must_use]
pub fn diagnosis(robot: &Robot, joined: &Dataset) -> Option<String> {
    let found = diagnose(robot, joined, &joined.all_rows(), &DiagnosisOptions::default());
    // Rows that repeat others explain no error.
    let mut known = found.iter().filter(|it| it.kind != DiagnosisKind::DuplicateRows);
    known.next().map(|it| it.statement.clone())
}

/// The diagnosis, or the general remedy.
#[must_use]
pub fn reason(robot: &Robot, joined: &Dataset) -> String {
    diagnosis(robot, joined).unwrap_or_else(|| LOOK.to_owned())
}

/// True if the error of a robot is so large that it no longer fits the data.
#[must_use]
pub fn is_doubtful(robot: &Robot, missed_m: f64) -> bool {
    missed_m > DOUBTFUL * robot.reach_m()
}

/// Warning of an unusual error, with its explanation.
///
/// # Errors
/// An error that exceeds that of any robot and is not explained.
pub fn warning(
    robot: &Robot,
    missed_m: f64,
    joined: impl FnOnce() -> Dataset,
    how: &str,
) -> Result<Option<String>, String> {
    let is_odd = missed_m > ODD * robot.reach_m();
    if !is_odd {
        return Ok(None);
    }
    let data = joined();
    // Errors of directions are no lengths.
    if data.observations.iter().any(|it| it.measurement.position().is_none()) {
        return Ok(None);
    }
    let share = 100.0 * missed_m / robot.reach_m();
    let missed = format!(
        "the nominal robot misses the measurements by {:.3} mm (median) if they are joined {how}, which is {share:.1} % of its reach",
        1e3 * missed_m
    );
    match diagnosis(robot, &data) {
        Some(statement) => Ok(Some(format!("{missed}: {statement}"))),
        None if is_doubtful(robot, missed_m) => Err(format!(
            "found measurements that do not fit the joint readings: {missed}, expected at most {:.0} %: {LOOK}; what does belong together is read as \
             one table",
            100.0 * DOUBTFUL
        )),
        None => Ok(None),
    }
}
