//! Figures of a fit: errors of all models, trust, determined unknowns.

use super::calibrated_fit::CalibratedFit;
use super::summary::FitSummary;
use super::trust::trust;
use crate::corrections::CorrectedFit;
use crate::robust::RobustFit;
use crate::run::CalibrationRun;
use crate::run::accuracy::model_accuracy;
use crate::run::split::too_few_to_hold_out;
use crate::run::station_frames::locate_stations;
use crate::trust::coverage_check::held_out_check;
use crate::trust::domain::Domain;
use crate::{Accuracy, Correction, JointEffect, Models, Robustness, SetAccuracy, Trust, set_accuracy};
use poecal_fit::analysis::{AnalysisSetup, Identifiability, identifiability};
use poecal_fit::start::{register, register_again};
use poecal_fit::state::{Estimate, Session};
use poecal_fit::uncertainty::CrossValidation;
use poecal_model::measurement::ByQuantity;
use poecal_model::robot::Robot;
use poecal_numerics::unit::Unit;

/// Factor on the noise of rotations in the registration of tool and frame for the best positions.
const POSITIONS_FIRST: f64 = 100.0;

/// Figures of a fit.
pub(crate) struct Figures {
    pub(crate) models: Models,
    pub(crate) accuracy: Accuracy,
    pub(crate) robustness: Robustness,
    pub(crate) trust: Trust,
    pub(crate) identifiability: Identifiability,
    pub(crate) correction: Option<Correction>,
}

impl Figures {
    /// Correlation of the residuals of consecutive rows.
    pub(crate) fn lag_one(&self) -> Option<f64> {
        self.trust.uncertainty.as_ref()?.discrepancy.lag_one
    }

    /// States that no measurement determines the size of the robot, and no expected error includes it.
    pub(crate) fn unknown_size(&self) -> Option<String> {
        let of_corrected = self.correction.as_ref().and_then(|it| it.uncertainty.as_ref());
        let sigma = of_corrected.or(self.trust.uncertainty.as_ref())?.size_sigma?;
        Some(format!(
            "the size of the robot shows in no measurement: only the model gives it, to {:.2} % (standard deviation). Expected errors are without it, \
             as errors of contacts are; for places measure one known length, such as the distance of two sockets",
            100.0 * sigma
        ))
    }

    /// Adds the corrected model's findings to each suspicious joint.
    pub(crate) fn explain_suspicions(&mut self, robot: &Robot) {
        let Some(found) = &self.correction else { return };
        for (joint, correction) in robot.joints.iter().zip(&mut self.trust.joints) {
            let own = found.effects.each.iter().filter(|it| it.joint == joint.name && it.is_found()).take(2);
            let found: Vec<String> = own.map(JointEffect::words).collect();
            if let Some(words) = correction.suspicious.as_mut().filter(|_| !found.is_empty()) {
                *words = format!("{words}. By the corrected model {}", found.join(", and "));
            }
        }
    }
}

impl CalibratedFit<'_> {
    /// Computes the figures.
    pub(crate) fn figures(
        &self,
        summary: &FitSummary,
        corrected: Option<CorrectedFit>,
        cross_validation: Option<CrossValidation>,
    ) -> Figures {
        let (run, session, RobustFit { fitted, robustness }) = (&self.run, self.session(), &self.robust);
        let models = self.models(&session, &summary.kept);
        let of = |rows: &[u32]| set_accuracy(&session, rows, &models);
        let mut trust = trust(
            &summary.view(session, &self.estimate),
            summary,
            cross_validation,
            (&models.registered, run.options.seed),
        );
        let correction = corrected.map(|it| it.judge(self, trust.cross_validation.as_ref(), &models.registered));
        if let Some(found) = correction.as_ref().filter(|it| !it.has_terms()) {
            self.allow_for_terms(&session, &mut trust, (found, &models.registered));
        }
        let with_terms = |rows: &[u32]| {
            let errors = correction.as_ref().map(|it| it.errors(&run.data, rows));
            SetAccuracy { corrected: errors.map(|it| model_accuracy(&run.data, rows, &it)), ..of(rows) }
        };
        let robustness = robustness.clone().with_accuracy([&run.fit_rows, &run.held_out_rows], with_terms);
        let predicted = trust.uncertainty.as_ref().map(|it| (it, &trust.coverage[..]));
        let of_calibrated = (&session, &models.calibrated);
        trust.held_out = held_out_check(of_calibrated, (&run.fit_rows, &run.held_out_rows), predicted);
        let held_out = (!run.held_out_rows.is_empty()).then(|| of(&run.held_out_rows));
        let few_configurations = too_few_to_hold_out(&run.data, &run.options, &run.held_out_rows);
        let mut accuracy = Accuracy { training: of(&run.fit_rows), held_out, few_configurations };
        if let Some(found) = &correction {
            accuracy.training.corrected = Some(found.training);
            accuracy.held_out.iter_mut().for_each(|set| set.corrected = found.held_out);
        }
        let setup = AnalysisSetup {
            session,
            rows: &run.fit_rows,
            estimate: &fitted.estimate,
            layout: &fitted.layout,
            noise: fitted.noise,
        };
        let identifiability = identifiability(&setup, &fitted.normal.gram, summary.remainder.variance);
        let effective_unknowns = summary.remainder.effective_unknowns;
        let identifiability = Identifiability { effective_unknowns, ..identifiability };
        Figures { models, accuracy, robustness, trust, identifiability, correction }
    }

    /// The three models; the first two are registered by the rows that a robust fit keeps, the third in the nominal base frame.
    fn models(&self, session: &Session<'_>, kept: &[u32]) -> Models {
        let (run, noise) = (&self.run, self.noise());
        // Positions determine tool and frame; orientations determine only the remaining directions.
        let positions = ByQuantity::from_fn(|quantity| match quantity.unit() {
            Unit::Metre => noise[quantity],
            Unit::Radian | Unit::One | Unit::Second => POSITIONS_FIRST * noise[quantity],
        });
        let start = &self.start.registered;
        let registration = |targets_free| run.registration(*session, kept, positions, targets_free).weighed_by(start);
        let again = |targets_free| register(&registration(targets_free), &run.delivered).0;
        let registered = if self.robust.robustness.loss.is_some() {
            again(true)
        } else {
            register_again(&registration(true), start)
        };
        let [nominal, registered] =
            [again(false), registered].map(|it| locate_stations(session, &run.fit_rows, &it, noise).into_owned());
        Models { nominal, registered, calibrated: self.estimate.clone() }
    }

    /// Adds the possible effect of terms to the uncertainty of geometry if the corrected model has no terms, so that both models are the same.
    fn allow_for_terms(&self, session: &Session<'_>, trust: &mut Trust, (found, registered): (&Correction, &Estimate)) {
        let Some(uncertainty) = trust.uncertainty.as_mut() else { return };
        let CalibrationRun { robot, fit_rows: rows, options, .. } = &self.run;
        let domain =
            Domain { session, rows, coverage: &trust.coverage, nominal: (robot, registered), seed: options.seed };
        let of = (uncertainty, &trust.expected, &found.expected);
        if let Some(expected) = domain.expectations_with_terms(of) {
            trust.expected = expected;
        }
    }
}
