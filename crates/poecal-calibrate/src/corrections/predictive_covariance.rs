//! Uncertainty of predictions by screws and terms: the priors' part, and the errors of the left-out parts (theory.md §9, *Corrected models*).

use std::collections::BTreeMap;

use crate::pictures::optics::Optics;
use crate::run::task::FitTask;
use crate::steps::summary::FitSummary;
use poecal_fit::problem::{Prior, Problem};
use poecal_fit::state::{Estimate, sample_rows};
use poecal_fit::uncertainty::{FitView, PriorInformation, Uncertainty, discrepancy};
use poecal_model::measurement::{Dataset, Noise};
use poecal_numerics::solve::LeastSquares as _;

/// Rows whose residuals are searched for structure.
const MANY: usize = 4000;
/// Most rows that are summed for the information of all.
const SUMMED: usize = 8000;
/// Fewest rows of each target seen from each station among them.
const FEWEST: usize = 200;

/// Uncertainty of a fit with all terms that may be present. The priors' weight is that of the number of configurations times the variance of the
/// whitened residuals. `growth` is the mean squared error of left-out parts relative to its expectation by their fits. `None` if there are no more
/// numbers than unknowns that they determine.
pub(crate) fn uncertainty(
    task: &FitTask<'_>,
    (estimate, noise): (&Estimate, Noise),
    (prior, [weight, variance]): (&Prior, [f64; 2]),
    (growth, optics): (f64, Option<&Optics>),
) -> Option<Uncertainty> {
    // Thousands of rows determine the information to a few percent.
    let (rows, weights) = choose_representatives(task.session.data, task.rows, task.weights).unzip();
    let weights = weights.as_deref().or(task.weights);
    let measured = FitTask { prior: None, rows: rows.as_deref().unwrap_or(task.rows), weights, ..*task };
    let problem = measured.problem(estimate, noise);
    let (layout, mut normal) = (problem.layout().clone(), problem.normal(estimate));
    if let Some(optics) = optics {
        optics.loosen(task.session.data, &problem, estimate, &mut normal);
    }
    let prior = PriorInformation::of_weight((prior, 1.0), estimate, &layout);
    let prior = PriorInformation { weight: Some(weight * variance), ..prior };
    let of = (&task.session, estimate);
    let summary = FitSummary::new(of, task.rows.to_vec(), (layout, normal), prior, noise, task.options);
    let FitSummary { remainder, normal, .. } = &summary;
    let mut view = summary.view(task.session, estimate);
    if remainder.numbers as f64 <= remainder.effective_unknowns {
        return None;
    }
    let mut found = if view.rows.len() > MANY {
        // With many rows the priors' weight decides: a sample shows whether their residuals have structure.
        let few = sample_rows(view.rows, MANY);
        let of_few = Problem::new(task.session, few.clone(), view.free.to_vec(), noise).normal(estimate);
        discrepancy(&FitView { rows: &few, ..view }, &of_few, remainder, None)
    } else {
        discrepancy(&view, normal, remainder, None)
    };
    // Errors that rows share beyond the terms: estimated by the weight of the priors and the left-out parts, or by their scatter.
    view.variance = remainder.variance * (weight * growth).max(found.scatter);
    (found.scatter, found.extrapolation) = (1.0, 1.0);
    let root = growth.sqrt();
    found.standard_deviation.values_mut().for_each(|(_, sigma)| *sigma *= root);
    Uncertainty::new(&view, summary.layout.clone(), normal, &found)
}

/// Representative rows of every target seen from every station, and weights of all rows with which their information equals that of all; `None` for
/// few rows.
fn choose_representatives(data: &Dataset, rows: &[u32], weights: Option<&[f64]>) -> Option<(Vec<u32>, Vec<f64>)> {
    if rows.len() <= SUMMED {
        return None;
    }
    let mut groups: BTreeMap<(usize, usize), Vec<u32>> = BTreeMap::new();
    for &row in rows {
        let seen = &data.observations[row as usize];
        groups.entry((seen.station, seen.target)).or_default().push(row);
    }
    let mut found = Vec::with_capacity(SUMMED);
    let mut of_rows = vec![0.0; data.len()];
    for group in groups.values() {
        let some = sample_rows(group, (group.len() * SUMMED / rows.len()).max(FEWEST));
        let each = group.len() as f64 / some.len() as f64;
        for &row in &some {
            of_rows[row as usize] = each * weights.map_or(1.0, |weights| weights[row as usize]);
        }
        found.extend(some);
    }
    found.sort_unstable();
    Some((found, of_rows))
}
