//! A board of another size than stated: the only lengths that pixels have.

use nalgebra::Vector3;

use super::DiagnosisKind;
use super::change::RowChange;
use super::diagnosis::format_short;
use super::fitter::Fitter;
use super::hypotheses::MistakeHypothesis;
use poecal_model::camera::{Board, Pictures};
use poecal_model::measurement::{Dataset, Observation, Quantity};

/// Largest factor that is searched.
const LARGEST: f64 = 6.0;
/// Factor from one size to the next that are compared.
const STEP: f64 = 1.1;
/// Smallest difference from 1 that counts as a mistake: a calibration corrects a smaller one.
const LEAST: f64 = 0.02;
/// Relative accuracy of the size.
const FINE: f64 = 1e-3;

/// Size of the boards with which the nominal robot fits the pictures best. `None` if some rows are no pictures, or if the size is the
/// stated one.
pub(crate) fn board_size(fitter: &Fitter<'_>, sample: &Dataset) -> Option<MistakeHypothesis> {
    let Pictures { boards, cameras, .. } = &sample.pictures;
    // The rows have lost their pictures, but not the names of the boards and cameras.
    let names: Vec<&str> =
        boards.iter().map(|it| it.name.as_str()).chain(cameras.iter().map(|it| it.name.as_str())).collect();
    let is_picture = |row: &Observation| {
        let target = sample.targets.get(row.target).and_then(Option::as_deref);
        target.is_some_and(|name| names.contains(&name)) && row.measurement.frame().is_some()
    };
    if boards.is_empty() || !sample.observations.iter().all(is_picture) {
        return None;
    }
    let change = |log: f64| RowChange::Resize(log.exp(), Quantity::Position, true);
    // The misfit is in lengths of the robot, which are the same for all sizes of the board.
    let misfit = |log: f64| fitter.roughly_registered(&change(log).apply(sample)).1.total_m;
    let steps = (LARGEST.ln() / STEP.ln()).ceil() as i32;
    let coarse = (-steps..=steps).map(|step| f64::from(step) * STEP.ln());
    let (_, near) = coarse.map(|log| (misfit(log), log)).min_by(|a, b| a.0.total_cmp(&b.0))?;
    let log = minimize_golden(misfit, near - STEP.ln(), near + STEP.ln());
    let factor = log.exp();
    if (factor - 1.0).abs() < LEAST {
        return None;
    }
    let stated_m = boards.iter().map(nearest_m).fold(f64::INFINITY, f64::min);
    let (stated, found) = (format_short(1e3 * stated_m), format_short(1e3 * stated_m * factor));
    Some(MistakeHypothesis::new(
        DiagnosisKind::BoardSize,
        change(log),
        format!("taking the board as {factor:.3} times as large"),
        format!(
            "by the lengths of the robot its squares, or the distance of its nearest points, measure {found} mm, stated are {stated} mm; \
             measure the print with a ruler over many squares, and state what it measures"
        ),
    ))
}

/// Argument of the lowest value of a function between two arguments, by golden-section search.
fn minimize_golden(value: impl Fn(f64) -> f64, mut from: f64, mut to: f64) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut a, mut b) = (to - golden * (to - from), from + golden * (to - from));
    let (mut at_a, mut at_b) = (value(a), value(b));
    while to - from > FINE {
        if at_a < at_b {
            (to, b, at_b) = (b, a, at_a);
            a = to - golden * (to - from);
            at_a = value(a);
        } else {
            (from, a, at_a) = (a, b, at_b);
            b = from + golden * (to - from);
            at_b = value(b);
        }
    }
    0.5 * (from + to)
}

/// Distance of the two points of a board that are nearest to each other, metres.
fn nearest_m(board: &Board) -> f64 {
    let points = &board.points;
    let of = |(at, point): (usize, &Vector3<f64>)| {
        points.iter().skip(at + 1).map(|other| (other - point).norm()).fold(f64::INFINITY, f64::min)
    };
    points.iter().enumerate().map(of).fold(f64::INFINITY, f64::min)
}
