//! Readings that were written with few digits.

use crate::error::first_few;
use crate::estimate::{Session, sample_rows};
use crate::robot::ReadingKind;

/// Steps of readings that are looked for, degrees and millimetres, the largest first.
const STEPS: [f64; 4] = [0.1, 0.05, 0.02, 0.01];
/// How far readings may be from a multiple of a step, as a share of it.
const NEAR: f64 = 1e-3;
/// Fewest different values of a joint of which that is no chance, and which are no commanded positions of a kind.
const FEWEST: usize = 12;
/// Rows by which the effect is found, and the step of the differences, radians and metres.
const ROWS: usize = 100;
const DIFFERENCE: f64 = 1e-5;
/// Share of the error that is left below which the rounding makes no part of it: commanded readings are exact.
const PART: f64 = 0.5;

/// That readings are rounded, and what that costs at the tip, where `left_m` (RMS) is no less than half of it.
pub(super) fn rounded(session: &Session<'_>, left_m: f64) -> Option<String> {
    let Session { robot, data, .. } = *session;
    let names = data.reading_names();
    let steps: Vec<Option<f64>> = (0..names.len())
        .map(|at| {
            let kind = robot.reading_kind(&names[at]);
            let values = (0..data.len()).map(|row| kind.shown(data.readings(row)[at]));
            (kind != ReadingKind::Factor).then(|| step_of(values.collect())).flatten()
        })
        .collect();
    let some = sample_rows(&data.all_rows(), ROWS);
    let mut squares = 0.0;
    for &row in &some {
        let readings = data.readings(row as usize);
        let place = robot.forward_kinematics(readings).translation;
        for (at, step) in steps.iter().enumerate() {
            let Some(step) = step else { continue };
            let mut moved = readings.to_vec();
            moved[at] += DIFFERENCE;
            let slope = (robot.forward_kinematics(&moved).translation - place).norm() / DIFFERENCE;
            let own = step / robot.reading_kind(&names[at]).shown(1.0) * slope;
            squares += own * own / 12.0;
        }
    }
    let cost_m = (squares / some.len().max(1) as f64).sqrt();
    if cost_m == 0.0 || PART * cost_m > left_m {
        return None;
    }
    let largest = steps.iter().flatten().copied().fold(0.0, f64::max);
    let own = names.iter().zip(&steps).filter(|(_, step)| step.is_some_and(|it| it == largest));
    let own: Vec<&str> = own.map(|(name, _)| name.as_str()).collect();
    let unit = own.first().map_or("", |name| robot.reading_kind(name).symbol());
    Some(format!(
        "the readings of {} are rounded to {largest} {unit}, which alone makes {:.3} mm (RMS) at the tip: write them with more digits",
        first_few(&own),
        1e3 * cost_m
    ))
}

/// The largest step that all values are multiples of.
fn step_of(mut values: Vec<f64>) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    values.dedup();
    if values.len() < FEWEST {
        return None;
    }
    let is_multiple = |step: f64| values.iter().all(|it| (it / step - (it / step).round()).abs() < NEAR);
    // Whole degrees and halves of them are commanded.
    let is_commanded = [0.5, 0.25].into_iter().any(is_multiple);
    STEPS.into_iter().find(|step| is_multiple(*step)).filter(|_| !is_commanded)
}

#[cfg(test)]
mod tests {
    use super::step_of;

    #[test]
    fn steps_of_rounded_values_are_found() {
        let of =
            |step: f64| (0..40).map(|k| ((f64::from(k) * 1.7).sin() * 90.0 / step).round() * step).collect();
        assert_eq!(step_of(of(0.1)), Some(0.1));
        assert_eq!(step_of(of(0.01)), Some(0.01));
        assert_eq!(step_of(of(0.5)), None);
        assert_eq!(step_of(of(1e-4)), None);
        assert_eq!(step_of(vec![0.1; 40]), None);
    }
}
