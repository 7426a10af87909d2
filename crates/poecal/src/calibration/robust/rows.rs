//! Judgement of each row, and which rows are suspected (theory.md §6 (34d) to (34f)).

use super::alike::TAILS;
use super::{Configurations, Loss, RowParts, Scale, parts};
use crate::analysis::influence;
use crate::calibration::SetAccuracy;
use crate::calibration::fit::Task;
use crate::calibration::located::located;
use crate::distributions;
use crate::estimate::Estimate;
use crate::measurement::{ByQuantity, Dataset, Noise};
use crate::solve::Normal;

/// Probability that normal data have a row beyond the bound.
const FAMILY: f64 = 1e-3;

/// Judgement of one row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowJudgement {
    /// Weight in the fit, 0 to 1; of a held-out row the weight that it would have had (1 without a robust loss).
    pub weight: f64,
    /// Whether it is suspected of a gross error.
    pub suspected: bool,
}

/// Treatment of outliers, and the judgement of each row.
#[derive(Clone, Debug, PartialEq)]
pub struct Robustness {
    /// Loss of the fit; `None`: least squares.
    pub loss: Option<Loss>,
    /// One for each row of the data.
    pub rows: Vec<RowJudgement>,
    /// Robust scale of the residuals over the calibration's noise, of each quantity: the unit by which rows are judged.
    pub scale: ByQuantity<f64>,
    /// Errors on the fitted rows without suspected ones; `None` if none is suspected.
    pub training_rest: Option<SetAccuracy>,
    /// The same on held-out rows; `None` if none is suspected, or none remains.
    pub held_out_rest: Option<SetAccuracy>,
}

impl Robustness {
    /// Collects the judgement of training and held-out rows; `accuracy` gives the errors on some rows.
    pub(in crate::calibration) fn new(
        loss: Option<Loss>,
        RowJudgements { rows, scale }: RowJudgements,
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

    /// Whether so many rows are suspected that the whole session is doubtful.
    pub(in crate::calibration) fn suspects_many(&self) -> bool {
        self.suspects().count() as f64 > MANY * self.rows.len() as f64
    }

    /// These rows without the suspected ones.
    #[must_use]
    pub fn rest(&self, rows: &[u32]) -> Vec<u32> {
        let suspected = |row: u32| self.rows.get(row as usize).is_some_and(|judged| judged.suspected);
        rows.iter().copied().filter(|&row| !suspected(row)).collect()
    }

    /// A sentence about the outliers among training and held-out rows, if there are any.
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

/// Share of suspected rows above which the whole session is doubtful.
const MANY: f64 = 0.2;

/// Bounds of a residual's length, by the number of its components.
pub(super) struct Bounds([f64; 6]);

impl Bounds {
    /// Length that normal noise exceeds in one of a thousand sets of so many rows, times a factor (theory.md §6 (34f)).
    pub(super) fn new(rows: usize, factor: f64) -> Self {
        let probability = FAMILY / rows.max(1) as f64;
        Bounds([1, 2, 3, 4, 5, 6].map(|dof| factor * distributions::upper_quantile(probability, dof).sqrt()))
    }

    /// Bounds above which a row is suspected.
    pub(super) fn suspected(rows: usize) -> Self {
        Bounds::new(rows, TAILS)
    }

    pub(super) fn of(&self, components: usize) -> f64 {
        self.0[components.clamp(1, 6) - 1]
    }
}

/// Whether there are numbers enough for a robust scale: twice the unknowns. Residuals of fewer show the fit, not the noise.
pub(super) fn is_judgeable<'a>(parts: impl Iterator<Item = &'a RowParts>, unknowns: f64) -> bool {
    parts.flat_map(RowParts::iter).map(|(_, part)| part.components).sum::<usize>() as f64 >= 2.0 * unknowns
}

/// Judgement of every row of the data, with its scale.
#[derive(Clone)]
pub(in crate::calibration) struct RowJudgements {
    pub(in crate::calibration) rows: Vec<RowJudgement>,
    scale: Scale,
}

impl RowJudgements {
    /// Robust scale over the noise of the fit, of each quantity.
    pub(super) fn scale(&self) -> ByQuantity<f64> {
        self.scale.0
    }
}

/// A fit by which rows are judged.
#[derive(Clone, Copy)]
pub(in crate::calibration) struct JudgingFit<'a> {
    /// Where it ended.
    pub(in crate::calibration) estimate: &'a Estimate,
    /// Its noise.
    pub(in crate::calibration) noise: Noise,
    /// Its information there.
    pub(in crate::calibration) normal: &'a Normal,
    /// Number of unknowns that the rows determine.
    pub(in crate::calibration) unknowns: f64,
}

/// Judges every row of the data by a fit with these weights; held-out rows have weight 0.
pub(in crate::calibration) fn judge_rows(
    task: &Task<'_>,
    configurations: &Configurations,
    fitted: JudgingFit<'_>,
    weights: &[f64],
    loss: Option<Loss>,
) -> RowJudgements {
    let all: Vec<u32> = (0..u32::try_from(task.session.data.len()).unwrap_or(u32::MAX)).collect();
    let estimate = &*located(&task.session, task.rows, fitted.estimate, fitted.noise);
    let mut is_fitted = vec![false; all.len()];
    task.rows.iter().for_each(|&row| is_fitted[row as usize] = true);
    let bounds = Bounds::suspected(all.len());
    let parts = parts(&task.session, &all, estimate, fitted.noise);
    let unknowns = configurations.repeats * fitted.unknowns;
    let shares = configurations.shares(&task.session, estimate);
    let judge = |scale: Scale| -> RowJudgements {
        // Influence is computed only where it may matter: rows with a leverage near 1 have no residual to judge them by.
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
        let problem = problem.problem(fitted.estimate, fitted.noise);
        let found = influence(&problem, fitted.estimate, fitted.normal, &near, &counted, |row, component| {
            component_scale(task.session.data, scale.0, row, component)
        });
        for (&row, influence) in near.iter().zip(&found) {
            let (_, components) = scale.length(&parts[row as usize]);
            rows[row as usize].suspected =
                shares[row as usize] * influence.studentized > bounds.of(components);
        }
        RowJudgements { rows, scale }
    };
    let of_fit = || task.rows.iter().map(|&row| (row, &parts[row as usize]));
    let scale = Scale::of(of_fit().map(|(_, part)| part), unknowns).at_least_rounding(fitted.noise);
    if !is_judgeable(of_fit().map(|(_, part)| part), unknowns) {
        let rows = weights.iter().map(|&weight| RowJudgement { weight, suspected: false }).collect();
        return RowJudgements { rows, scale };
    }
    let judged = judge(scale);
    if !judged.rows.iter().any(|row| row.suspected) {
        return judged;
    }
    // Suspected rows widen their own scale: judge once more without them.
    let kept = of_fit().filter(|(row, _)| !judged.rows[*row as usize].suspected);
    judge(Scale::of(kept.map(|(_, part)| part), unknowns).at_least_rounding(fitted.noise))
}

/// Scale of one component of a row's residual.
pub(super) fn component_scale(data: &Dataset, scale: ByQuantity<f64>, row: u32, component: usize) -> f64 {
    let channels = data.observations[row as usize].measurement.observe().channels();
    channels.get(component).map_or(1.0, |channel| scale[channel.quantity])
}

/// Rows for registering device and targets: without suspected ones, unless too few remain.
pub(in crate::calibration) fn registrable(robustness: &[RowJudgement], rows: &[u32]) -> Vec<u32> {
    let kept: Vec<u32> = rows.iter().copied().filter(|&row| !robustness[row as usize].suspected).collect();
    if kept.len() * 2 > rows.len() { kept } else { rows.to_vec() }
}
