//! A mistake in a part of the rows, such as half a file that another program wrote.

use super::few_targets::FewTargets;
use super::fitter::{Fitter, sample_of, subsample, take_rows};
use super::{Diagnosis, DiagnosisOptions, WHOLE, of_rows};
use crate::state::sample_rows;
use poecal_model::measurement::Dataset;

/// Fewest rows of a part.
const FEWEST: usize = 16;
/// Least ratio of other errors to the registered error of a part without a mistake. The others are those of all rows, after a mistake of
/// all of them is undone, and of the other part.
const WORSE: f64 = 3.0;

/// Mistake of the first third of the rows or of the last. The other third is then explained far better than it and than all rows. `of_all`
/// is the error that remains after a mistake of all rows is undone, metres.
pub(super) fn diagnose(
    fitter: &Fitter<'_>,
    data: &Dataset,
    rows: &[u32],
    options: &DiagnosisOptions<'_>,
    of_all: Option<f64>,
) -> Option<Diagnosis> {
    let third = rows.len() / 3;
    if third < FEWEST || is_explained(fitter, data, rows, options) {
        return None;
    }
    let parts = [("first", rows.get(..third)?), ("last", rows.get(rows.len() - third..)?)];
    let [first_m, last_m] = parts.map(|(_, part)| registered_m(fitter, data, part));
    let ((which, part), clean_m, other_m) =
        if first_m < last_m { (parts[1], first_m, last_m) } else { (parts[0], last_m, first_m) };
    let whole_m = of_all.unwrap_or_else(|| registered_m(fitter, data, rows));
    if WORSE * clean_m > whole_m.min(other_m) {
        return None;
    }
    let of_part = DiagnosisOptions { calibrated: None, ..*options };
    let found = of_rows(fitter, data, part, &of_part).filter(Diagnosis::is_of_input)?;
    let statement = format!("in the {which} third of the rows alone, {}", found.statement);
    Some(Diagnosis { statement, rows: part.to_vec(), ..found })
}

/// True if a calibration explains all rows.
fn is_explained(fitter: &Fitter<'_>, data: &Dataset, rows: &[u32], options: &DiagnosisOptions<'_>) -> bool {
    let whole = take_rows(data, &sample_rows(rows, WHOLE));
    options.calibrated.is_some_and(|estimate| fitter.is_sound(&whole, estimate))
}

/// Error of the nominal robot on some rows, metres.
fn registered_m(fitter: &Fitter<'_>, data: &Dataset, rows: &[u32]) -> f64 {
    if FewTargets::are_all(data) {
        return fitter.register_nominal(&sample_of(data, rows)).1.total_m;
    }
    let all = take_rows(data, rows);
    let few = FewTargets::new(fitter, &all);
    few.fitter.register_nominal(&subsample(&few.data)).1.total_m
}
