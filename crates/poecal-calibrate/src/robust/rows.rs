//! Judgement of each row, and which rows are suspected (theory.md §6 (34d) to (34f)).

use super::common_errors::TAILS;
use super::{Loss, RepeatedConfigurations, RobustScale, RowResiduals, parts};
use crate::SetAccuracy;
use crate::run::station_frames::locate_stations;
use crate::run::task::FitTask;
use poecal_fit::analysis::influence;
use poecal_fit::state::Estimate;
use poecal_model::measurement::{ByQuantity, Dataset, Noise};
use poecal_numerics::distributions;
use poecal_numerics::solve::NormalEquations;

/// Probability that normal data have a row beyond the bound.
const FAMILY: f64 = 1e-3;

/// Judgement of one row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowJudgement {
    /// Weight in the fit, 0 to 1; for a held-out row the weight that it would have had (1 without a robust loss).
    pub weight: f64,
    /// True if it is suspected of a gross error.
    pub suspected: bool,
}

/// Treatment of outliers, and the judgement of each row.
#[derive(Clone, Debug, PartialEq)]
pub struct Robustness {
    /// Loss of the fit; `None`: least squares.
    pub loss: Option<Loss>,
    /// One for each row of the data.
    pub rows: Vec<RowJudgement>,
    /// Robust scale of the residuals relative to the calibration's noise, for each quantity: the unit in which rows are judged.
    pub scale: ByQuantity<f64>,
    /// Errors on the fitted rows without suspected ones; `None` if none is suspected.
    pub training_rest: Option<SetAccuracy>,
    /// The same on held-out rows; `None` if none is suspected, or none remains.
    pub held_out_rest: Option<SetAccuracy>,
}

impl Robustness {
    /// The same with the errors on training and held-out rows without the suspected ones; `accuracy` computes those on some rows.
    pub(crate) fn with_accuracy(
        self,
        [fitted, held_out]: [&[u32]; 2],
        accuracy: impl Fn(&[u32]) -> SetAccuracy,
    ) -> Self {
        let of_rest = |rows: &[u32]| {
            let rest = self.rest(rows);
            (rest.len() < rows.len() && !rest.is_empty()).then(|| accuracy(&rest))
        };
        let (training_rest, held_out_rest) = (of_rest(fitted), of_rest(held_out));
        Robustness { training_rest, held_out_rest, ..self }
    }

    /// The same with these rows suspected.
    pub(crate) fn with_suspects(mut self, suspected: &[bool]) -> Self {
        self.rows.iter_mut().zip(suspected).for_each(|(row, suspected)| row.suspected = *suspected);
        self
    }

    /// True if a row is suspected.
    pub(crate) fn suspects_row(&self, row: u32) -> bool {
        self.rows.get(row as usize).is_some_and(|it| it.suspected)
    }

    /// The suspected rows, in the order of the data.
    pub fn suspects(&self) -> impl Iterator<Item = u32> {
        let rows = self.rows.iter().enumerate().filter(|(_, row)| row.suspected);
        rows.filter_map(|(row, _)| u32::try_from(row).ok())
    }

    /// True if so many rows are suspected that the whole session is doubtful.
    pub(crate) fn suspects_many(&self) -> bool {
        self.suspects().count() as f64 > MANY * self.rows.len() as f64
    }

    /// These rows without the suspected ones.
    #[must_use]
    pub fn rest(&self, rows: &[u32]) -> Vec<u32> {
        rows.iter().copied().filter(|&row| !self.suspects_row(row)).collect()
    }

    /// Rows for registering device and targets: these without suspected ones, unless too few remain.
    pub(crate) fn registration_rows(&self, rows: &[u32]) -> Vec<u32> {
        let kept = self.rest(rows);
        if kept.len() * 2 > rows.len() { kept } else { rows.to_vec() }
    }

    /// A sentence about the outliers among training and held-out rows, if there are any.
    pub(crate) fn warning(&self, fit_rows: &[u32], held_out_rows: &[u32]) -> Option<String> {
        let suspected = |rows: &[u32]| rows.len() - self.rest(rows).len();
        let (fitted, held_out) = (suspected(fit_rows), suspected(held_out_rows));
        if fitted + held_out == 0 {
            return None;
        }
        let what = match self.loss {
            Some(loss) => format!("their weight in the fit is almost zero ({} loss, --robust)", loss.word()),
            None if fitted == 0 => "none of them was fitted".to_owned(),
            None => "their weight in the fit is full; use --robust tukey for a robust fit".to_owned(),
        };
        Some(format!(
            "found {} ({fitted} of {} fitted rows, {held_out} of {} held out), too far off for noise: {what}; \
             `outliers` in calibration.json and residuals.csv name the rows",
            if fitted + held_out == 1 { "1 outlier".to_owned() } else { format!("{} outliers", fitted + held_out) },
            fit_rows.len(),
            held_out_rows.len()
        ))
    }
}

/// Factor on the median of held-out rows beyond which one of them is gross, and fewest of these. Predictions of a fit with few rows are uncertain,
/// but all to a similar degree.
const GROSS: f64 = 50.0;
const FEWEST_BESIDE: usize = 5;

/// Share of suspected rows above which the whole session is doubtful.
const MANY: f64 = 0.2;

/// Bounds of a residual's length, by the number of its components.
pub(crate) struct Bounds([f64; 6]);

impl Bounds {
    /// Length that normal noise exceeds in one of a thousand sets of this number of rows, times a factor (theory.md §6 (34f)).
    pub(crate) fn new(rows: usize, factor: f64) -> Self {
        let probability = FAMILY / rows.max(1) as f64;
        Bounds([1, 2, 3, 4, 5, 6].map(|dof| factor * distributions::upper_quantile(probability, dof).sqrt()))
    }

    /// Bounds above which a row is suspected.
    pub(crate) fn suspicion_bounds(rows: usize) -> Self {
        Bounds::new(rows, TAILS)
    }

    pub(crate) fn bound(&self, components: usize) -> f64 {
        self.0[components.clamp(1, 6) - 1]
    }
}

/// True if there are enough numbers for a robust scale: twice the unknowns. Residuals of fewer reflect the fit, not the noise.
pub(crate) fn is_judgeable<'a>(parts: impl Iterator<Item = &'a RowResiduals>, unknowns: f64) -> bool {
    parts.flat_map(RowResiduals::iter).map(|(_, part)| part.components).sum::<usize>() as f64 >= 2.0 * unknowns
}

/// A fit by which rows are judged.
#[derive(Clone, Copy)]
pub(crate) struct JudgingFit<'a> {
    /// Estimate of the fit.
    pub(crate) estimate: &'a Estimate,
    /// Noise of the fit.
    pub(crate) noise: Noise,
    /// Normal information at the estimate.
    pub(crate) normal: &'a NormalEquations,
    /// Number of unknowns that the rows determine.
    pub(crate) unknowns: f64,
}

/// Judges every row of the data by a fit with these weights; held-out rows have weight 0.
pub(crate) fn judge_rows(
    task: &FitTask<'_>,
    configurations: &RepeatedConfigurations,
    fitted: JudgingFit<'_>,
    weights: &[f64],
    loss: Option<Loss>,
) -> Robustness {
    let all: Vec<u32> = task.session.data.all_rows();
    let estimate = &*locate_stations(&task.session, task.rows, fitted.estimate, fitted.noise);
    let mut fit_weights = vec![None; all.len()];
    task.rows.iter().for_each(|&row| fit_weights[row as usize] = Some(weights[row as usize]));
    let rows = JudgedData {
        parts: parts(&task.session, &all, estimate, fitted.noise),
        shares: configurations.shares(&task.session, estimate),
        bounds: Bounds::suspicion_bounds(all.len()),
        weights: fit_weights,
        all,
    };
    let unknowns = configurations.repeats * fitted.unknowns;
    let robustness = |rows, scale: RobustScale| {
        let (training_rest, held_out_rest) = (None, None);
        Robustness { loss, rows, scale: scale.0, training_rest, held_out_rest }
    };
    let of_fit = || task.rows.iter().map(|&row| (row, &rows.parts[row as usize]));
    let scale = RobustScale::from_rows(of_fit().map(|(_, part)| part), unknowns).at_least_rounding(fitted.noise);
    if !is_judgeable(of_fit().map(|(_, part)| part), unknowns) {
        let judged = weights.iter().map(|&weight| RowJudgement { weight, suspected: false }).collect();
        return robustness(rows.with_gross(judged, scale), scale);
    }
    let judged = rows.judge_rows(task, fitted, scale, loss);
    if !judged.iter().any(|row| row.suspected) {
        return robustness(judged, scale);
    }
    // Suspected rows widen their own scale: judge once more without them.
    let kept = of_fit().filter(|(row, _)| !judged[*row as usize].suspected);
    let scale = RobustScale::from_rows(kept.map(|(_, part)| part), unknowns).at_least_rounding(fitted.noise);
    robustness(rows.judge_rows(task, fitted, scale, loss), scale)
}

/// All rows of the data in their judgement.
struct JudgedData {
    all: Vec<u32>,
    parts: Vec<RowResiduals>,
    /// Share of each row's length that counts.
    shares: Vec<f64>,
    /// Weight of each row in the fit; `None` for a held-out row.
    weights: Vec<Option<f64>>,
    bounds: Bounds,
}

impl JudgedData {
    /// Suspects held-out rows that are gross compared with the others, for a fit with too few numbers for a judgement of its own rows: this
    /// comparison needs no scale.
    fn with_gross(&self, mut judged: Vec<RowJudgement>, scale: RobustScale) -> Vec<RowJudgement> {
        let held_out = || self.all.iter().filter(|row| self.weights[**row as usize].is_none());
        let middle = distributions::median(held_out().map(|&row| self.length(row, scale).0));
        let Some(middle) = middle.filter(|_| held_out().count() >= FEWEST_BESIDE) else { return judged };
        for &row in held_out() {
            judged[row as usize].suspected = self.length(row, scale).0 > GROSS * middle;
        }
        judged
    }

    /// The part of a row's length that counts, at a scale, and the number of its components.
    fn length(&self, row: u32, scale: RobustScale) -> (f64, usize) {
        let (length, components) = scale.length(&self.parts[row as usize]);
        (self.shares[row as usize] * length, components)
    }

    /// Every row judged at a scale.
    fn judge_rows(
        &self,
        task: &FitTask<'_>,
        fitted: JudgingFit<'_>,
        scale: RobustScale,
        loss: Option<Loss>,
    ) -> Vec<RowJudgement> {
        let judged = |&row: &u32| {
            let (length, components) = self.length(row, scale);
            let usual = loss.map_or(1.0, |loss| loss.weight(length, components));
            RowJudgement { weight: self.weights[row as usize].unwrap_or(usual), suspected: false }
        };
        let mut rows: Vec<RowJudgement> = self.all.iter().map(judged).collect();
        // Influence is computed only where it may matter: rows with a leverage near 1 have no residual to judge them by.
        let is_near = |row: &u32| {
            let (length, components) = self.length(*row, scale);
            length > 0.5 * self.bounds.bound(components)
        };
        let near: Vec<u32> = self.all.iter().copied().filter(is_near).collect();
        let counted: Vec<f64> = near.iter().map(|&row| self.weights[row as usize].unwrap_or(0.0)).collect();
        let unweighted = FitTask { weights: None, ..*task };
        let problem = unweighted.problem(fitted.estimate, fitted.noise);
        let found = influence(&problem, fitted.estimate, fitted.normal, &near, &counted, |row, component| {
            component_scale(task.session.data, scale.0, row, component)
        });
        for (&row, influence) in near.iter().zip(&found) {
            let studentized = self.shares[row as usize] * influence.studentized;
            let (_, components) = self.length(row, scale);
            rows[row as usize].suspected = studentized > self.bounds.bound(components);
        }
        rows
    }
}

/// Scale of one component of a row's residual.
pub(crate) fn component_scale(data: &Dataset, scale: ByQuantity<f64>, row: u32, component: usize) -> f64 {
    let channels = data.observations[row as usize].measurement.channels();
    channels.get(component).map_or(1.0, |channel| scale[channel.quantity])
}
