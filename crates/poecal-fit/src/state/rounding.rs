//! Readings that were written with few digits.

use super::{Session, sample_rows};
use poecal_model::robot::ReadingKind;

/// Steps of readings that are tested, degrees and millimetres, the largest first.
const STEPS: [f64; 4] = [0.1, 0.05, 0.02, 0.01];
/// Largest distance of readings from a multiple of a step, as a share of it.
const NEAR: f64 = 1e-3;
/// Fewest different values of a joint for a step that is no chance, and no series of commanded positions.
const FEWEST: usize = 12;
/// Number of rows in which steps are searched, and of those by which the effect is estimated; and the step of the differences, radians and
/// metres.
const LOOKED: usize = 2000;
const ROWS: usize = 100;
const DIFFERENCE: f64 = 1e-5;
/// Share of the remaining error below which the rounding is no part of it: commanded readings are exact.
const PART: f64 = 0.5;

/// Effect of the digits of the readings.
#[derive(Clone, Debug, PartialEq)]
pub struct Rounding {
    /// Names of the readings with the largest step, which is in degrees or millimetres, and its unit.
    pub names: Vec<String>,
    /// Largest step of a reading, in `unit`.
    pub step: f64,
    /// `deg` or `mm`.
    pub unit: &'static str,
    /// Mean squared error of the tip's position, square metres, and of its orientation, square radians.
    pub place_m2: f64,
    pub(crate) turn_rad2: f64,
}

impl Rounding {
    /// Rounding of a session's readings, if errors of `left_m` (RMS) are no less than half of its effect; `None` if readings are not
    /// rounded.
    pub fn from_session(session: &Session<'_>, left_m: f64) -> Option<Self> {
        let Session { robot, data, .. } = *session;
        let names = data.reading_names();
        let looked = sample_rows(&data.all_rows(), LOOKED);
        let kinds: Vec<ReadingKind> = names.iter().map(|name| robot.reading_kind(name)).collect();
        let steps: Vec<Option<f64>> = kinds
            .iter()
            .enumerate()
            .map(|(at, kind)| {
                let values = looked.iter().map(|row| kind.in_shown_unit(data.readings(*row as usize)[at]));
                (*kind != ReadingKind::Factor).then(|| step_of(values.collect())).flatten()
            })
            .collect();
        let largest = steps.iter().flatten().copied().fold(0.0, f64::max);
        if largest == 0.0 {
            return None;
        }
        let some = sample_rows(&looked, ROWS);
        let (mut place_m2, mut turn_rad2) = (0.0, 0.0);
        for &row in &some {
            let readings = data.readings(row as usize);
            let here = robot.forward_kinematics(readings);
            for (at, step) in steps.iter().enumerate() {
                let Some(step) = step else { continue };
                let mut moved = readings.to_vec();
                moved[at] += DIFFERENCE;
                let there = robot.forward_kinematics(&moved);
                let own = step / kinds[at].in_shown_unit(1.0) / DIFFERENCE;
                let turn = poecal_arm::lie::rotation::log(&(there.rotation * here.rotation.transpose()));
                place_m2 += (own * (there.translation - here.translation)).norm_squared() / 12.0;
                turn_rad2 += (own * turn).norm_squared() / 12.0;
            }
        }
        let count = some.len().max(1) as f64;
        let (place_m2, turn_rad2) = (place_m2 / count, turn_rad2 / count);
        let own = names.iter().zip(&steps).zip(&kinds);
        let own = own.filter(|((_, step), _)| step.is_some_and(|it| it == largest));
        let unit = own.clone().next().map_or("", |(_, kind)| kind.symbol());
        let names = own.map(|((name, _), _)| name.clone()).collect();
        let matters = place_m2 > 0.0 && PART * place_m2.sqrt() <= left_m;
        matters.then_some(Rounding { names, step: largest, unit, place_m2, turn_rad2 })
    }
}

/// Largest step that all values are multiples of.
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
        let of = |step: f64| (0..40).map(|k| ((f64::from(k) * 1.7).sin() * 90.0 / step).round() * step).collect();
        assert_eq!(step_of(of(0.1)), Some(0.1));
        assert_eq!(step_of(of(0.01)), Some(0.01));
        assert_eq!(step_of(of(0.5)), None);
        assert_eq!(step_of(of(1e-4)), None);
        assert_eq!(step_of(vec![0.1; 40]), None);
    }
}
