//! Uncertainty of what screws and terms predict: the priors' part, and the errors of the parts that were left out (theory.md §9,
//! *Corrected models*).

use crate::calibration::summary::FitSummary;
use crate::calibration::task::Task;
use crate::estimate::{Estimate, sample_rows};
use crate::measurement::Noise;
use crate::problem::{Prior, Problem};
use crate::solve::{LeastSquares as _, Normal};
use crate::uncertainty::{PriorInformation, Uncertainty, View, discrepancy};

/// Rows of which residuals are searched for structure.
const MANY: usize = 4000;

/// Uncertainty of a fit with all terms that may be there. The priors' weight is that of the number of configurations times the variance of
/// the whitened residuals; `growth` is the mean squared error of parts that were left out over what their fits let expect. `None` with no more
/// numbers than unknowns that they determine.
pub(super) fn uncertainty(
    task: &Task<'_>,
    (estimate, noise): (&Estimate, Noise),
    (prior, [weight, variance]): (&Prior, [f64; 2]),
    growth: f64,
) -> Option<Uncertainty> {
    let measured = Task { prior: None, ..*task };
    let problem = measured.problem(estimate, noise);
    let (layout, normal) = (problem.layout().clone(), problem.normal(estimate));
    let mut believed = Normal::new(layout.dim());
    prior.add(estimate, &layout, 1.0, &mut believed);
    let prior = PriorInformation { normal: believed, is_fitted: true, weight: Some(weight * variance) };
    let of = (&task.session, estimate);
    let summary = FitSummary::new(of, task.rows.to_vec(), (layout, normal), prior, noise, task.options);
    let FitSummary { remainder, normal, .. } = &summary;
    let mut view = summary.view(task.session, estimate);
    if remainder.numbers as f64 <= remainder.effective_unknowns {
        return None;
    }
    let mut found = if view.rows.len() > MANY {
        // Of many rows the priors' weight decides: a sample tells whether their residuals have structure.
        let few = sample_rows(view.rows, MANY);
        let of_few = Problem::new(task.session, few.clone(), view.free.to_vec(), noise).normal(estimate);
        discrepancy(&View { rows: &few, ..view }, &of_few, remainder, None)
    } else {
        discrepancy(&view, normal, remainder, None)
    };
    // What rows share beyond the terms: as the weight of the priors and the parts that were left out have it, or as it scatters.
    view.variance = remainder.variance * (weight * growth).max(found.scatter);
    (found.scatter, found.extrapolation) = (1.0, 1.0);
    let root = growth.sqrt();
    found.standard_deviation.values_mut().for_each(|(_, sigma)| *sigma *= root);
    Uncertainty::new(&view, summary.layout.clone(), &normal.gram, &found)
}
