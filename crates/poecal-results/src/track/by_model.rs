//! Rows that repeat no earlier configuration, judged by the delivered model: changes must exceed its own errors.

use std::collections::BTreeSet;

use nalgebra::{DMatrix, DVector};
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::explain::{HypothesisTests, NoiseLevel, ProjectedChanges, leave_unseen_out, ratio};
use super::hypotheses::{find_free_columns, hypotheses};
use super::model::VisitModel;
use super::options::TrackOptions;
use super::pairs::VisitChanges;
use super::visit::Visit;
use poecal_model::measurement::{Dataset, Quantity};
use poecal_model::simulate::random::uniform_number;
use poecal_numerics::error::Result;
use poecal_numerics::linalg;

/// Number of visits drawn from the calibration's own rows, and the share of them that may be called changed.
const DRAWN: usize = 300;
const CHANCE: f64 = 0.01;
/// Largest ratio of squared errors elsewhere to the largest of the calibration's own rows, if the model is geometry alone.
const OF_GEOMETRY: f64 = 1.3;
/// Most configurations that are judged by the model: their errors are one covariance.
pub(crate) const MOST: usize = 40;
/// Level by which errors of the model exceed those that the calibration states, if its rows are not available to determine it.
const UNKNOWN: f64 = 1.5;

/// Covariance of the errors of predictions and measurements of some numbers: of the calibration's unknowns, of its stated model error (common to all
/// targets of a configuration), and of noise.
fn covariance(model: &VisitModel, visit: &Visit, rows: &[u32], groups: &[usize]) -> Option<DMatrix<f64>> {
    let numbers: Vec<usize> =
        rows.iter().flat_map(|&row| visit.starts[row as usize]..visit.starts[row as usize + 1]).collect();
    let entry = model.file.uncertainty.as_ref()?;
    let by_known = visit.by_known.as_ref()?.select_rows(&numbers);
    let mut all = &by_known * by_known.transpose();
    let shown = |quantity: Quantity, value: Option<f64>| quantity.unit().from_shown(value.unwrap_or_default());
    let place: Vec<(usize, usize)> = rows
        .iter()
        .zip(groups)
        .flat_map(|(&row, &group)| {
            let count = visit.starts[row as usize + 1] - visit.starts[row as usize];
            (0..count).map(move |at| (group, at))
        })
        .collect();
    for (i, &number) in numbers.iter().enumerate() {
        let quantity = visit.quantities[number];
        let error = shown(quantity, entry.discrepancy.get(quantity));
        all[(i, i)] += visit.sigma[number].powi(2) + error.powi(2);
        for j in 0..i {
            if place[j] == place[i] {
                all[(i, j)] += error.powi(2);
                all[(j, i)] += error.powi(2);
            }
        }
    }
    Some(all)
}

/// Configuration of each row, by readings.
fn configurations(data: &Dataset) -> Vec<Vec<u32>> {
    data.configurations(&data.all_rows())
}

/// Changes of some rows from the model's prediction, in its standard deviations; `None` if the calibration states no uncertainty.
fn of_rows(model: &VisitModel, visit: &Visit, rows: &[u32], groups: &[usize]) -> Option<VisitChanges> {
    let numbers: Vec<usize> =
        rows.iter().flat_map(|&row| visit.starts[row as usize]..visit.starts[row as usize + 1]).collect();
    let all = covariance(model, visit, rows, groups)?;
    // Variances of a single coordinate: noise, and the errors that the calibration states.
    let entry = model.file.uncertainty.as_ref()?;
    let own = |number: &usize| {
        let quantity = visit.quantities[*number];
        let error = entry.discrepancy.get(quantity).unwrap_or_default();
        visit.sigma[*number].hypot(quantity.unit().from_shown(error))
    };
    let sigma = DVector::from_iterator(numbers.len(), numbers.iter().map(own));
    let jacobian = visit.jacobian.select_rows(&numbers);
    let residual = visit.residual.select_rows(&numbers);
    let k = jacobian.ncols();
    let mut both = DMatrix::zeros(numbers.len(), k + 1);
    both.columns_mut(0, k).copy_from(&jacobian);
    both.set_column(k, &residual);
    let both = linalg::whiten_columns(all, &both)?;
    Some(VisitChanges {
        residual: both.column(k).into_owned(),
        jacobian: both.columns(0, k).into_owned(),
        sigma,
        scatter: (0.0, 0.0),
        rows: rows.to_vec(),
    })
}

/// At most [`MOST`] of them, evenly selected.
fn some_of(all: Vec<Vec<u32>>) -> Vec<Vec<u32>> {
    let step = all.len().div_ceil(MOST).max(1);
    all.into_iter().step_by(step).collect()
}

/// Rows of groups in sequence, with the group of each row.
fn group_rows(configurations: &[Vec<u32>]) -> (Vec<u32>, Vec<usize>) {
    let each = configurations.iter().enumerate().flat_map(|(group, rows)| rows.iter().map(move |row| (*row, group)));
    each.unzip()
}

/// Changes of a visit from the model's prediction.
pub(crate) fn changes(model: &VisitModel, visit: &Visit, data: &Dataset) -> Option<VisitChanges> {
    let (rows, groups) = group_rows(&some_of(configurations(data)));
    of_rows(model, visit, &rows, &groups)
}

/// The level of the model's errors: the value that visits of as many configurations, drawn from the rows of the calibration, rarely exceed.
pub(crate) fn level(
    model: &VisitModel,
    earlier: Option<(&Visit, &Dataset)>,
    count: usize,
    options: &TrackOptions,
) -> Result<(NoiseLevel, bool)> {
    let Some((visit, data)) = earlier else { return Ok((NoiseLevel::Known(UNKNOWN * UNKNOWN), false)) };
    let (all, count) = (configurations(data), count.min(MOST));
    if all.len() < 2 * count {
        return Ok((NoiseLevel::Known(UNKNOWN * UNKNOWN), false));
    }
    let mut generator = ChaCha8Rng::seed_from_u64(1);
    let mut ratios = Vec::with_capacity(DRAWN);
    // The rows of the calibration are treated as if its device were anywhere.
    let as_anew = Visit { device_is_known: options.device_is_known, ..visit.clone() };
    for _ in 0..DRAWN {
        let mut chosen = BTreeSet::new();
        while chosen.len() < count {
            let drawn = (uniform_number(&mut generator) * all.len() as f64) as usize;
            chosen.insert(drawn.min(all.len() - 1));
        }
        let some: Vec<Vec<u32>> = chosen.iter().map(|at| all[*at].clone()).collect();
        let (rows, groups) = group_rows(&some);
        let Some(found) = of_rows(model, &as_anew, &rows, &groups) else { continue };
        let evidence = ProjectedChanges::new(&found.residual, &find_free_columns(&found.jacobian, &as_anew, options));
        let mut hypotheses = hypotheses(&found.jacobian, &as_anew, options);
        leave_unseen_out(&mut hypotheses, &evidence, NoiseLevel::Known(1.0));
        let tests = HypothesisTests::new(&hypotheses);
        ratios.push(ratio(&evidence, &hypotheses, &tests));
    }
    ratios.sort_by(f64::total_cmp);
    // Errors of geometry alone have few large values, which few rows may miss: then the level is the largest.
    let (chance, beyond) = if model.is_corrected { (CHANCE, 1.0) } else { (0.0, OF_GEOMETRY) };
    let at = ((1.0 - chance) * ratios.len() as f64) as usize;
    let found = ratios.get(at.min(ratios.len().saturating_sub(1))).copied().unwrap_or(1.0);
    Ok((NoiseLevel::Known(found.max(1.0) * beyond * shrinkage_factor(model, visit)), true))
}

/// Ratio of squared errors of rows outside the calibration to those of its own rows.
fn shrinkage_factor(model: &VisitModel, visit: &Visit) -> f64 {
    let accuracy = &model.file.accuracy;
    let set = accuracy.held_out.as_ref().unwrap_or(&accuracy.training);
    let corrected = set.corrected.as_ref().filter(|_| model.is_corrected);
    let Some((quantity, _)) = corrected.unwrap_or(&set.calibrated).leading_value() else { return 1.0 };
    let rms = model.own_rms();
    let own = visit.residual.iter().zip(&visit.quantities).filter(|(_, it)| **it == quantity);
    let (squares, count) = own.fold((0.0, 0.0), |(sum, count), (value, _)| (sum + value * value, count + 1.0));
    let components = quantity.components() as f64;
    let own = quantity.unit().in_shown_unit((components * squares / f64::max(count, 1.0)).sqrt());
    if own > 0.0 { (rms / own).powi(2).max(1.0) } else { 1.0 }
}
