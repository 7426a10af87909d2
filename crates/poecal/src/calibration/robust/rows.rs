//! What each row means to the fit, and which rows are suspected (theory.md §6 (34d) to (34f)).

use super::alike::TAILS;
use super::{Configurations, Loss, Parts, Scale, parts};
use crate::analysis::influence;
use crate::calibration::SetAccuracy;
use crate::calibration::fit::Task;
use crate::calibration::found::Fitted;
use crate::distributions;
use crate::measurement::Dataset;

/// Probability that clean, normal data show a row beyond the bound of normal noise.
const FAMILY: f64 = 1e-3;

/// What a fit says of one row.
///
/// ```
/// use poecal::calibration::RowJudgement;
/// let row = RowJudgement { weight: 1.0, suspected: false };
/// assert!(!row.suspected);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowJudgement {
    /// The weight that the row had in the fit, 0 to 1; of a row that was held out, the weight that it would have had (1 without a
    /// robust loss).
    pub weight: f64,
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
    /// How many times the calibration's noise the residuals in the middle really are, positions and rotations: the scale that rows are
    /// judged by.
    pub scale: [f64; 2],
    /// Errors on the fitted rows without those suspected; none if none is.
    pub training_rest: Option<SetAccuracy>,
    /// Errors on the rows held out without those suspected; none if none is, or none is left.
    pub held_out_rest: Option<SetAccuracy>,
}

impl Robustness {
    /// Puts together what a fit by this loss says of the rows that were fitted and held out; `accuracy` gives the errors on some rows.
    pub(in crate::calibration) fn new(
        loss: Option<Loss>,
        Judged { rows, scale }: Judged,
        [fitted, held_out]: [&[u32]; 2],
        accuracy: impl Fn(&[u32]) -> SetAccuracy,
    ) -> Self {
        let scale = scale.0;
        let mut robustness = Robustness { loss, rows, scale, training_rest: None, held_out_rest: None };
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
            Some(loss) => format!("the fit gives them almost no weight ({} loss, --robust)", loss.word()),
            None if fitted == 0 => "none of them was fitted".to_owned(),
            None => "the fit gives them full weight; use --robust tukey for a robust fit".to_owned(),
        };
        Some(format!(
            "found {} ({fitted} of {} fitted rows, {held_out} of {} held out), too far off for noise: {what}; \
             `outliers` in calibration.json and residuals.csv name the rows",
            if fitted + held_out == 1 {
                "1 outlier".to_owned()
            } else {
                format!("{} outliers", fitted + held_out)
            },
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
        Bounds([1, 2, 3, 4, 5, 6].map(|dof| factor * distributions::upper_quantile(probability, dof).sqrt()))
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
pub(super) fn is_judgeable<'a>(parts: impl Iterator<Item = &'a Parts>, unknowns: f64) -> bool {
    parts.flatten().map(|part| part.components).sum::<usize>() as f64 >= 2.0 * unknowns
}

/// Every row of the data judged, with the scale that they were judged by.
pub(in crate::calibration) struct Judged {
    pub(in crate::calibration) rows: Vec<RowJudgement>,
    scale: Scale,
}

impl Judged {
    /// How many times the noise of the fit the residuals in the middle are, positions and rotations.
    pub(super) fn scale(&self) -> [f64; 2] {
        self.scale.0
    }
}

/// Judges every row of the data by a fit with these weights. Rows held out count with weight 0.
pub(super) fn judge_rows(
    task: &Task<'_>,
    configurations: &Configurations,
    fitted: &Fitted,
    weights: &[f64],
    loss: Option<Loss>,
) -> Judged {
    let all: Vec<u32> = (0..u32::try_from(task.data.len()).unwrap_or(u32::MAX)).collect();
    let mut is_fitted = vec![false; all.len()];
    task.rows.iter().for_each(|&row| is_fitted[row as usize] = true);
    let bounds = Bounds::suspected(all.len());
    let parts = parts(task.data, task.packed, &all, &fitted.estimate, fitted.noise);
    let unknowns = configurations.repeats * fitted.normal.dim() as f64;
    let shares = configurations.shares(task.data, task.packed, &fitted.estimate);
    let judge = |scale: Scale| -> Judged {
        // Influence is worked out only where it may matter: of rows that decide most of their own prediction little can be said.
        let lengths = parts.iter().map(|row| scale.length(row));
        let near: Vec<u32> = all
            .iter()
            .zip(lengths)
            .filter(|(row, (length, components))| {
                shares[**row as usize] * length > 0.5 * bounds.of(*components)
            })
            .map(|(&row, _)| row)
            .collect();
        let mut rows: Vec<RowJudgement> = all
            .iter()
            .map(|&row| {
                let (length, components) = scale.length(&parts[row as usize]);
                let length = shares[row as usize] * length;
                let usual = loss.map_or(1.0, |loss| loss.weight(length, components));
                let weight = if is_fitted[row as usize] { weights[row as usize] } else { usual };
                RowJudgement { weight, suspected: false }
            })
            .collect();
        let counted: Vec<f64> = near
            .iter()
            .map(|&row| if is_fitted[row as usize] { weights[row as usize] } else { 0.0 })
            .collect();
        let problem = Task { weights: None, ..*task };
        let problem = problem.problem(&fitted.estimate, fitted.noise);
        let found =
            influence(&problem, &fitted.estimate, &fitted.normal, &near, &counted, |row, component| {
                component_scale(task.data, scale.0, row, component)
            });
        for (&row, influence) in near.iter().zip(&found) {
            let (_, components) = scale.length(&parts[row as usize]);
            rows[row as usize].suspected =
                shares[row as usize] * influence.studentized > bounds.of(components);
        }
        Judged { rows, scale }
    };
    let of_fit = || task.rows.iter().map(|&row| (row, &parts[row as usize]));
    let scale = Scale::of(of_fit().map(|(_, part)| part), unknowns).at_least_rounding(fitted.noise);
    if !is_judgeable(of_fit().map(|(_, part)| part), unknowns) {
        let rows = weights.iter().map(|&weight| RowJudgement { weight, suspected: false }).collect();
        return Judged { rows, scale };
    }
    let judged = judge(scale);
    if !judged.rows.iter().any(|row| row.suspected) {
        return judged;
    }
    // Suspected rows widen the scale that they are judged by: once more without them.
    let kept = of_fit().filter(|(row, _)| !judged.rows[*row as usize].suspected);
    judge(Scale::of(kept.map(|(_, part)| part), unknowns).at_least_rounding(fitted.noise))
}

/// The scale of one number of a row's residual.
pub(super) fn component_scale(data: &Dataset, scale: [f64; 2], row: u32, component: usize) -> f64 {
    let turns = data.observations[row as usize].measurement.residual_model().rotation_row();
    scale[usize::from(component >= turns)]
}

/// The rows by which devices and targets are registered for the table: without those suspected, unless that would leave too few.
pub(in crate::calibration) fn registrable(robustness: &[RowJudgement], rows: &[u32]) -> Vec<u32> {
    let kept: Vec<u32> = rows.iter().copied().filter(|&row| !robustness[row as usize].suspected).collect();
    if kept.len() * 2 > rows.len() { kept } else { rows.to_vec() }
}
