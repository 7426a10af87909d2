//! Rows that are suspected by the corrected model.

use super::found::Correction;
use super::unknowns::{priors, weights};
use crate::analysis::effective_unknowns;
use crate::calibration::fit::Task;
use crate::calibration::robust::{Configurations, JudgingFit, judge_rows};
use crate::calibration::{Calibration, CalibrationOptions};
use crate::estimate::Session;
use crate::measurement::Dataset;
use crate::robot::Sizes;
use crate::solve::{LeastSquares as _, Normal};

/// Whether each row is suspected of a gross error, by a corrected model; of one without terms as the calibration has it.
pub(in crate::calibration) fn suspected(
    found: &Correction,
    calibration: &Calibration,
    data: &Dataset,
    options: &CalibrationOptions,
) -> Vec<bool> {
    if found.sizes == Sizes::NONE {
        return calibration.robustness.rows.iter().map(|row| row.suspected).collect();
    }
    let own = calibration.packed(data);
    let session = calibration.session(data, &own).with_noise_ratios(&calibration.noise_ratios);
    let session =
        Session { robot: &found.model.robot, packed: &found.packed, unknowns: &found.unknowns, ..session };
    let rows = &calibration.fit_rows;
    let prior = options.prior_with_terms(&session).with_terms(priors(&found.model, &found.sizes));
    let weight = found.prior_weight;
    let counted = weights(calibration, options);
    let task = Task { session, rows, weights: counted.as_deref(), prior: Some((&prior, weight)), options };
    let problem = task.problem(&found.estimate, found.noise);
    let normal = problem.normal(&found.estimate);
    let mut believed = Normal::new(normal.dim());
    prior.add(&found.estimate, problem.layout(), weight, &mut believed);
    let unknowns = normal.dim() as f64 - effective_unknowns(&normal, &believed);
    let judging = JudgingFit { estimate: &found.estimate, noise: found.noise, normal: &normal, unknowns };
    let all = counted.clone().unwrap_or_else(|| vec![1.0; data.len()]);
    let configurations = Configurations::new(data, rows);
    let judged = judge_rows(&task, &configurations, judging, &all, calibration.robustness.loss);
    judged.rows.iter().map(|row| row.suspected).collect()
}
