//! Rows that are suspected by the corrected model.

use super::correction_fit::CorrectedFit;
use super::unknowns::priors;
use crate::robust::{JudgingFit, RepeatedConfigurations, judge_rows};
use crate::run::CalibrationRun;
use crate::run::task::FitTask;
use crate::steps::calibrated_fit::CalibratedFit;
use poecal_fit::analysis::effective_unknowns;
use poecal_model::robot::Sizes;
use poecal_numerics::solve::{LeastSquares as _, NormalEquations};

impl CorrectedFit {
    /// Marks each row suspected of a gross error; `None` if they are the rows that geometry suspects, as they always are without terms.
    pub(crate) fn other_suspects(&self, geometry: &CalibratedFit<'_>) -> Option<Vec<bool>> {
        if self.sizes == Sizes::NONE {
            return None;
        }
        let session = self.session(geometry);
        let (CalibrationRun { fit_rows: rows, options, .. }, weight) = (&geometry.run, self.prior_weight);
        let prior = options.prior_with_terms(&session).with_terms(priors(&self.model, &self.sizes));
        let counted = geometry.weights();
        let prior_of_task = Some((&prior, weight));
        let task = FitTask { session, rows, weights: counted.as_deref(), prior: prior_of_task, options };
        let problem = task.problem(&self.estimate, self.noise);
        let normal = problem.normal(&self.estimate);
        let mut believed = NormalEquations::new(normal.dim());
        prior.add(&self.estimate, problem.layout(), weight, &mut believed);
        let unknowns = normal.dim() as f64 - effective_unknowns(&normal, &believed);
        let judging = JudgingFit { estimate: &self.estimate, noise: self.noise, normal: &normal, unknowns };
        let all = counted.clone().unwrap_or_else(|| vec![1.0; session.data.len()]);
        let configurations = RepeatedConfigurations::new(session.data, rows);
        let judged = judge_rows(&task, &configurations, judging, &all, geometry.robust.robustness.loss);
        let suspected: Vec<bool> = judged.rows.iter().map(|row| row.suspected).collect();
        let differs = geometry.robust.robustness.rows.iter().zip(&suspected).any(|(row, it)| row.suspected != *it);
        differs.then_some(suspected)
    }
}
