//! Diagnosis of the input: mistakes named with evidence, never corrected (docs/theory.md §9, *Diagnosis of the input*).
//!
//! A mistake is a change of readings or measurements. Each hypothesis undoes one. It is named if the nominal robot, or a short
//! calibration, then explains the measurements far better than before. It must also be better than any other hypothesis.

mod boards;
mod change;
mod conventions;
mod diagnosis;
mod euler;
mod exchange;
mod few_targets;
mod fitter;
mod hypotheses;
mod judge;
mod partial_mistakes;
mod place_names;
mod repeats;
mod scales;
mod targets;
mod unnamed_targets;
mod zero;

pub(crate) use change::RowChange;
pub use diagnosis::{Diagnosis, DiagnosisKind};
pub(crate) use fitter::{Fitter, Misfit, subsample};
pub(crate) use hypotheses::ReadingColumns;

use std::cell::LazyCell;

use crate::state::{Estimate, sample_rows};
use few_targets::FewTargets;
use fitter::{sample_of, take_rows};
use poecal_model::measurement::Dataset;
use poecal_model::robot::Robot;
use repeats::Repeats;

/// Options of a diagnosis.
#[derive(Clone, Copy, Debug)]
pub struct DiagnosisOptions<'a> {
    /// True if the device frame is unknown (otherwise it is the base frame).
    pub device_free: bool,
    /// Calibrated model of these data, if there is one: a shortcut for data without mistakes.
    pub calibrated: Option<&'a Estimate>,
}

impl Default for DiagnosisOptions<'_> {
    fn default() -> Self {
        DiagnosisOptions { device_free: true, calibrated: None }
    }
}

/// Most readings of a robot for which hypotheses are tested: their number grows with the square, the time of each with the cube.
pub const MOST_READINGS: usize = 32;
/// Fewest rows for a diagnosis.
const FEWEST_ROWS: usize = 8;
/// Rows of the subsample that is searched for single gross errors.
const WHOLE: usize = 2000;

/// Mistakes in some rows of the data, in their order: docs/theory.md §9, *Diagnosis of the input*. For robots with more than
/// [`MOST_READINGS`] only repeated rows are reported.
#[must_use]
pub fn diagnose(robot: &Robot, data: &Dataset, rows: &[u32], options: &DiagnosisOptions<'_>) -> Vec<Diagnosis> {
    let mut rows: Vec<u32> = rows.iter().copied().filter(|&row| (row as usize) < data.len()).collect();
    rows.sort_unstable();
    rows.dedup();
    if rows.len() < FEWEST_ROWS || robot.reading_names() != data.reading_names() {
        return Vec::new();
    }
    let fitter = Fitter::new(robot, data, options.device_free);
    // Frames suffice each by itself; measurements of less suffice only together.
    if data.station_count() > 1 && !fitter.is_constrained() {
        return station_by_station(robot, data, &rows, options);
    }
    let Repeats { repeated, contradicting, unnamed } = repeats::diagnose(&fitter, data, &rows);
    let mut found: Vec<Diagnosis> = repeated.into_iter().collect();
    if data.reading_names().len() > MOST_READINGS {
        found.extend(contradicting);
        return found;
    }
    let whole = of_rows(&fitter, data, &rows, options);
    // Contradicting rows of one configuration belong to two targets if names are exchanged; otherwise one of them is wrong, and they are
    // excluded from the other tests.
    let exchanged = whole.as_ref().is_some_and(|one| one.kind == DiagnosisKind::TargetsSwapped);
    match contradicting {
        // Rows of several targets under one name allow no other diagnosis.
        _ if unnamed.is_some() && !exchanged => found.extend(unnamed),
        Some(contradicting) if !exchanged => {
            rows.retain(|row| contradicting.rows.binary_search(row).is_err());
            found.push(contradicting);
            if rows.len() >= FEWEST_ROWS {
                found.extend(of_rows(&fitter, data, &rows, options));
            }
        }
        _ => found.extend(whole),
    }
    let of_all = found.iter().find(|it| it.is_of_input()).map(|it| 1e-3 * it.after_mm);
    if of_all.is_none_or(|after_m| after_m > judge::POOR * fitter.reach_m())
        && let Some(of_part) = partial_mistakes::diagnose(&fitter, data, &rows, options, of_all)
    {
        found.retain(|it| !it.is_of_input());
        found.push(of_part);
    }
    found
}

/// Diagnosis of each station by itself, with no assumption on their frames.
fn station_by_station(robot: &Robot, data: &Dataset, rows: &[u32], options: &DiagnosisOptions<'_>) -> Vec<Diagnosis> {
    let alone = data.without_stations();
    let mut found: Vec<Diagnosis> = Vec::new();
    for station in 0..data.station_count() {
        let calibrated = options.calibrated.map(|it| it.seen_from(station));
        let own = DiagnosisOptions { calibrated: calibrated.as_ref(), ..*options };
        for one in diagnose(robot, &alone, &data.seen_from(station, rows), &own) {
            // A mistake of several stations is reported once.
            match found.iter_mut().find(|it| it.kind == one.kind) {
                Some(known) if !known.rows.is_empty() => known.rows.extend(one.rows),
                Some(_) => {}
                None => found.push(one),
            }
        }
    }
    found.iter_mut().for_each(|it| it.rows.sort_unstable());
    found
}

/// Mistake of some rows, apart from repeated rows.
fn of_rows(fitter: &Fitter<'_>, data: &Dataset, rows: &[u32], options: &DiagnosisOptions<'_>) -> Option<Diagnosis> {
    let whole = take_rows(data, &sample_rows(rows, WHOLE));
    let of_lengths = || {
        if !fitter.is_constrained() {
            return None;
        }
        let all = take_rows(data, rows);
        let few = FewTargets::new(fitter, &all);
        place_names::known_length(fitter, data, &all).or_else(|| judge::of_lengths(&few, &all))
    };
    if let Some(estimate) = options.calibrated
        && fitter.is_sound(&whole, estimate)
    {
        return targets::names(fitter, data, estimate).or_else(of_lengths);
    }
    // A copy of all rows costs more than the fits.
    let all = LazyCell::new(|| take_rows(data, rows));
    let many = (!FewTargets::are_all(data)).then(|| FewTargets::new(fitter, &all));
    let (estimate, base) = match &many {
        Some(few) => few.fitter.judge(&subsample(&few.data)),
        None => fitter.judge(&sample_of(data, rows)),
    };
    let placed = many.as_ref().map_or_else(|| estimate.clone(), |few| few.place_others(fitter, &all, &estimate));
    if fitter.is_sound(&whole, &placed) {
        return targets::names(fitter, data, &placed).or_else(of_lengths);
    }
    let few = many.unwrap_or_else(|| FewTargets::new(fitter, &all));
    targets::rows(fitter, data, &all, rows, &base)
        .or_else(|| place_names::names(fitter, data, &all, rows, &placed, &base))
        .or_else(|| place_names::known_length(fitter, data, &all))
        .or_else(|| judge::diagnose(&few, &all, &base))
}
