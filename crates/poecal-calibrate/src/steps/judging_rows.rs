//! Rows that judge the models, and the decision whether they show that the calibrated model is no better: theory.md §9, *Verdict*.

use super::calibrated_fit::CalibratedFit;
use super::figures::Figures;
use super::improvement::improvement;
use crate::Improvement;
use crate::run::accuracy::{JudgingError, model_accuracy};
use poecal_fit::state::RowError;
use poecal_model::measurement::Dataset;

/// Least relative reduction of the error.
pub(crate) const WORTH: f64 = 0.02;
/// Upper end of the interval of the improvement below which *no better* is stated. Held-out rows must have been able to show a gain of a quarter;
/// cross-validation, whose fits have fewer rows than the model, must show a loss.
const SEEN: f64 = 1.25;
const LOST: f64 = 1.0;

/// Rows that judge: those held out, or if there are none the fitted ones, each predicted by a fit of others.
pub(crate) struct JudgingRows {
    /// Origin of these errors.
    pub(crate) place: &'static str,
    /// Errors of the nominal model, with targets and devices fitted, and of the calibrated one.
    pub(crate) errors: [JudgingError; 2],
    /// Ratio of the former to the latter; `None` with fewer than two configurations.
    improvement: Option<Improvement>,
    /// Upper end of its interval below which the latter is no better; `None` if the rows were fitted.
    least: Option<f64>,
}

impl JudgingRows {
    /// Judging rows of a fit. Suspected rows do not count.
    pub(crate) fn from_fit(fit: &CalibratedFit<'_>, figures: &Figures) -> Self {
        let (run, session) = (&fit.run, fit.session());
        let suspected = |row: &u32| figures.robustness.rows.get(*row as usize).is_some_and(|it| it.suspected);
        let kept = |rows: &[u32]| -> Vec<u32> {
            let rest: Vec<u32> = rows.iter().copied().filter(|row| !suspected(row)).collect();
            if rest.is_empty() { rows.to_vec() } else { rest }
        };
        let errors_of = |rows: &[u32]| {
            let rows = kept(rows);
            let after = session.errors(&rows, &figures.models.calibrated);
            (rows, after)
        };
        let is_held_out = !run.held_out_rows.is_empty();
        let left_out = figures.trust.cross_validation.as_ref().filter(|_| !is_held_out);
        let (place, least, (rows, after)): (_, _, (Vec<u32>, Vec<RowError>)) = match left_out {
            Some(found) => ("in cross-validation", Some(LOST), found.errors.iter().copied().unzip()),
            None if is_held_out => ("on held-out rows", Some(SEEN), errors_of(&run.held_out_rows)),
            None => ("on fitted rows", None, errors_of(&run.fit_rows)),
        };
        let before = session.errors(&rows, &figures.models.registered);
        let both = [&before[..], &after[..]];
        let errors = both.map(|errors| model_accuracy(session.data, &rows, errors).judging_error(rows.len()));
        JudgingRows { place, errors, improvement: improvement_between(session.data, &rows, both), least }
    }

    /// States that the calibrated model is no better, if its rows would have shown an improvement; or else, if no improvement is visible, that they
    /// are too few to decide.
    pub(crate) fn no_better(&self) -> [Option<String>; 2] {
        let [before, after] = &self.errors;
        if after.rms <= (1.0 - WORTH) * before.rms {
            return [None, None];
        }
        let (unit, place) = (after.unit.symbol(), self.place);
        let words = format!("({:.3} {unit} against {:.3} {unit}", after.rms, before.rms);
        let shows = |least: f64| self.improvement.is_some_and(|it| it.to < least);
        if self.least.is_none_or(shows) {
            let words = format!("{place} the calibrated screws are no better than the nominal ones {words})");
            return [Some(words), None];
        }
        let most = self
            .improvement
            .map_or_else(String::new, |it| format!("; up to {:.2} times better with 95 % confidence", it.to));
        let words =
            format!("{place} the calibrated screws are not seen to be better than the nominal ones {words}{most})");
        [None, Some(words)]
    }
}

/// Improvement by (50) of the errors that judge the models.
fn improvement_between(data: &Dataset, rows: &[u32], both: [&[RowError]; 2]) -> Option<Improvement> {
    let of_group = |group: &Vec<u32>| {
        let at: Vec<usize> = group.iter().filter_map(|row| rows.binary_search(row).ok()).collect();
        let own: Vec<u32> = at.iter().filter_map(|at| rows.get(*at).copied()).collect();
        both.map(|errors| {
            let errors: Vec<RowError> = at.iter().filter_map(|at| errors.get(*at).copied()).collect();
            own.len() as f64 * model_accuracy(data, &own, &errors).judging_error(own.len()).rms.powi(2)
        })
    };
    let sums: Vec<[f64; 2]> = data.configurations(rows).iter().map(of_group).collect();
    improvement(&sums, true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_numerics::unit::Unit;

    /// Marks of the two statements about a model whose errors are smaller by `factor`, at most by `to`.
    fn judge_both(place: &'static str, least: Option<f64>, factor: f64, to: f64) -> [bool; 2] {
        let error = |rms| JudgingError { what: "position error".to_owned(), rms, unit: Unit::Metre };
        let improvement = Some(Improvement { factor, from: factor * factor / to, to });
        let judging = JudgingRows { place, errors: [error(factor), error(1.0)], improvement, least };
        judging.no_better().map(|it| it.is_some())
    }

    #[test]
    fn no_better_is_said_where_a_gain_would_have_been_seen() {
        let [no_better, unclear, better] = [[true, false], [false, true], [false, false]];
        for (least, factor, to, expected) in [
            (Some(SEEN), 1.3, 1.5, better),
            (Some(SEEN), 0.9, 1.1, no_better),
            (Some(SEEN), 0.9, 1.4, unclear),
            (Some(LOST), 0.9, 1.1, unclear),
            (Some(LOST), 0.8, 0.95, no_better),
            (None, 0.9, 1.4, no_better),
        ] {
            assert_eq!(judge_both("on some rows", least, factor, to), expected, "{least:?} {factor} {to}");
        }
    }
}
