//! What each row means to the fit, and which rows are suspected (theory.md §6 (34d) to (34f)).

use super::{Loss, Parts, Scale, chi_square, parts};
use crate::analysis::{Influence, influence};
use crate::calibration::fit::{Fitted, Task};
use crate::calibration::{SetAccuracy, measurements_words};

/// Probability that clean, normal data show a row beyond the bound of normal noise.
const FAMILY: f64 = 1e-3;
/// A row is suspected beyond so many times that bound: what real robots leave has heavier tails than noise, and no row of these is
/// wrong.
const TAILS: f64 = 2.0;

/// What a fit says of one row.
///
/// ```
/// use poecal::calibration::RowJudgement;
/// let row = RowJudgement { weight: 1.0, leverage: 0.1, studentized: 1.7, suspected: false };
/// assert!(!row.suspected);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowJudgement {
    /// The weight that the row had in the fit, 0 to 1; of a row that was held out, the weight that it would have had (1 without a
    /// robust loss).
    pub weight: f64,
    /// Mean variance of the row's prediction in units of its noise; see [`Influence`](crate::analysis::Influence).
    pub leverage: f64,
    /// Length of its residual in units of the residual's own standard deviation.
    pub studentized: f64,
    /// Whether it is suspected to be grossly wrong.
    pub suspected: bool,
}

/// What a calibration did about outliers, and what it says of each row.
///
/// ```
/// use poecal::calibration::{CalibrationOptions, calibrate};
/// use poecal::simulate::{Kind, Simulation, elbow};
/// let made = Simulation::default().run(&elbow(), Kind::Pose)?;
/// let robustness = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?.robustness;
/// assert_eq!(robustness.loss, None);
/// assert_eq!(robustness.suspects().count(), 0);
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Robustness {
    /// The loss of the fit; none: least squares.
    pub loss: Option<Loss>,
    /// One for each row of the data.
    pub rows: Vec<RowJudgement>,
    /// Errors on the fitted rows without those suspected; none if none is.
    pub training_rest: Option<SetAccuracy>,
    /// Errors on the rows held out without those suspected; none if none is, or none is left.
    pub held_out_rest: Option<SetAccuracy>,
}

impl Robustness {
    /// Puts together what a fit by this loss says of the rows that were fitted and held out; `accuracy` gives the errors on some rows.
    pub(in crate::calibration) fn new(
        loss: Option<Loss>,
        rows: Vec<RowJudgement>,
        [fitted, held_out]: [&[u32]; 2],
        accuracy: impl Fn(&[u32]) -> SetAccuracy,
    ) -> Self {
        let mut robustness = Robustness { loss, rows, training_rest: None, held_out_rest: None };
        let of_rest = |rows: &[u32]| {
            let rest = robustness.rest(rows);
            (rest.len() < rows.len() && !rest.is_empty()).then(|| accuracy(&rest))
        };
        let (training_rest, held_out_rest) = (of_rest(fitted), of_rest(held_out));
        robustness.training_rest = training_rest;
        robustness.held_out_rest = held_out_rest;
        robustness
    }

    /// The suspected rows, in the order of the data.
    pub fn suspects(&self) -> impl Iterator<Item = u32> {
        let rows = self.rows.iter().enumerate().filter(|(_, row)| row.suspected);
        rows.filter_map(|(row, _)| u32::try_from(row).ok())
    }

    /// These rows without the suspected ones.
    #[must_use]
    pub fn rest(&self, rows: &[u32]) -> Vec<u32> {
        let suspected = |row: u32| self.rows.get(row as usize).is_some_and(|judged| judged.suspected);
        rows.iter().copied().filter(|&row| !suspected(row)).collect()
    }

    /// A sentence about the outliers among the fitted rows and those held out, if there are any.
    pub(in crate::calibration) fn warning(&self, fit_rows: &[u32], held_out_rows: &[u32]) -> Option<String> {
        let suspected = |rows: &[u32]| rows.len() - self.rest(rows).len();
        let (fitted, held_out) = (suspected(fit_rows), suspected(held_out_rows));
        if fitted + held_out == 0 {
            return None;
        }
        let what = match self.loss {
            Some(loss) => format!("they hardly count in the fit ({} loss, --robust)", loss.word()),
            None if fitted == 0 => "they were not fitted".to_owned(),
            None => "they count in full; fit robustly with --robust tukey".to_owned(),
        };
        Some(format!(
            "found {} grossly off ({fitted} of {} fitted, {held_out} of {} held out), too far for noise: {what}; \
             `outliers` in calibration.json and residuals.csv name the rows",
            measurements_words(fitted + held_out),
            fit_rows.len(),
            held_out_rows.len()
        ))
    }
}

/// Lengths of residuals that noise does not reach, by the number of a row's components.
pub(super) struct Bounds([f64; 6]);

impl Bounds {
    /// The length that normal noise exceeds in one of a thousand sets of so many rows, times a factor (theory.md §6 (34f)).
    pub(super) fn new(rows: usize, factor: f64) -> Self {
        let probability = FAMILY / rows.max(1) as f64;
        Bounds([1, 2, 3, 4, 5, 6].map(|dof| factor * chi_square::upper_quantile(probability, dof).sqrt()))
    }

    /// Beyond these a row is suspected.
    pub(super) fn suspected(rows: usize) -> Self {
        Bounds::new(rows, TAILS)
    }

    pub(super) fn of(&self, components: usize) -> f64 {
        self.0[components.clamp(1, 6) - 1]
    }
}

/// Whether there are numbers enough to tell a scale by: twice the unknowns. Fewer leave residuals that show the fit, not the noise.
pub(super) fn is_judgeable(parts: &[Parts], unknowns: usize) -> bool {
    parts.iter().flatten().map(|part| part.components).sum::<usize>() >= 2 * unknowns
}

/// Judges every row of the data by a fit with these weights. Rows held out count with weight 0.
pub(super) fn judge_rows(
    task: &Task<'_>,
    fitted: &Fitted,
    weights: &[f64],
    loss: Option<Loss>,
) -> Vec<RowJudgement> {
    let all: Vec<u32> = (0..u32::try_from(task.data.len()).unwrap_or(u32::MAX)).collect();
    let mut own = vec![None; all.len()];
    for &row in task.rows {
        own[row as usize] = Some(weights[row as usize]);
    }
    let counted: Vec<f64> = own.iter().map(|weight| weight.unwrap_or(0.0)).collect();
    let unweighted = Task { weights: None, ..*task };
    let problem = unweighted.problem(&fitted.estimate, fitted.noise);
    let bounds = Bounds::suspected(all.len());
    let fit_parts = parts(task.data, task.packed, task.rows, &fitted.estimate, fitted.noise);
    let unknowns = fitted.normal.dim();
    let judgeable = is_judgeable(&fit_parts, unknowns);
    let judge = |scale: Scale| -> Vec<RowJudgement> {
        let model = |row: u32| task.data.observations[row as usize].measurement.residual_model();
        let of = |row: u32, component: usize| scale.0[usize::from(component >= model(row).rotation_row())];
        let found = influence(&problem, &fitted.estimate, &fitted.normal, &all, &counted, of);
        let rows = all.iter().zip(&own).zip(found);
        rows.map(|((&row, own), Influence { leverage, studentized })| {
            let components = model(row).dim();
            let usual = || loss.map_or(1.0, |loss| loss.weight(studentized, components));
            let suspected = judgeable && studentized > bounds.of(components);
            RowJudgement { weight: own.unwrap_or_else(usual), leverage, studentized, suspected }
        })
        .collect()
    };
    let scale = Scale::of(fit_parts.iter(), unknowns).at_least_rounding(fitted.noise);
    let rows = judge(scale);
    if !rows.iter().any(|row| row.suspected) {
        return rows;
    }
    // Suspected rows widen the scale that they are judged by: once more without them.
    let kept = task.rows.iter().zip(&fit_parts).filter(|(row, _)| !rows[**row as usize].suspected);
    judge(Scale::of(kept.map(|(_, part)| part), unknowns).at_least_rounding(fitted.noise))
}

/// The rows by which devices and targets are registered for the table: without those suspected, unless that would leave too few.
pub(in crate::calibration) fn registrable(robustness: &[RowJudgement], rows: &[u32]) -> Vec<u32> {
    let kept: Vec<u32> = rows.iter().copied().filter(|&row| !robustness[row as usize].suspected).collect();
    if kept.len() * 2 > rows.len() { kept } else { rows.to_vec() }
}
