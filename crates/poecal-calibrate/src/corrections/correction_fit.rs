//! Fits of screws and terms, with their accuracy and uncertainty.

use std::ops::Deref;

use super::choice::{SizesReason, TriedSizes};
use super::effect::Effects;
use super::effects::effects;
use super::frames::{SessionModel, frames};
use crate::run::CalibrationRun;
use crate::run::accuracy::{JudgingError, ModelAccuracy};
use crate::run::calibrated_places::{CalibratedStation, CalibratedTarget, UnmeasuredTip, place_tip, stations};
use crate::run::options::DeviceFrameKnowledge;
use crate::steps::calibrated_fit::CalibratedFit;
use crate::trust::coverage_check::{CoverageCheck, held_out_check};
use crate::trust::domain::Domain;
use crate::trust::expected_errors::Expectations;
use poecal_fit::analysis::coverage;
use poecal_fit::state::{Estimate, PackedValues, RowError, Session, Unknowns};
use poecal_fit::uncertainty::{CrossValidation, Uncertainty};
use poecal_model::measurement::{Dataset, Noise, Quantity};
use poecal_model::robot::{CorrectionModel, Robot, Sizes};

/// A fit of screws and terms together.
#[derive(Clone, Debug, PartialEq)]
pub struct CorrectedFit {
    /// The robot with its compliant joints and terms, as in the model.
    pub model: CorrectionModel,
    /// Prior sizes of the groups of terms.
    pub sizes: Sizes,
    /// Reason for the sizes of its terms.
    pub reason: SizesReason,
    /// Sizes that cross-validation tried, if it chose.
    pub tried: Vec<TriedSizes>,
    /// Fitted unknowns.
    pub unknowns: Unknowns,
    /// Fitted estimate.
    pub estimate: Estimate,
    /// Noise of the fit.
    pub noise: Noise,
    /// Errors on the training rows.
    pub training: ModelAccuracy,
    /// Errors on the held-out rows.
    pub held_out: Option<ModelAccuracy>,
    /// Covariance of the unknowns and of terms that may be present, and model error.
    pub uncertainty: Option<Uncertainty>,
    /// Doubt about a direction of gravity that was not found, a sentence.
    pub doubt: Option<String>,
    /// Sizes of all terms that may be present.
    pub(crate) possible: Sizes,
    /// Weight of the priors in the fit.
    pub(crate) prior_weight: f64,
    pub(crate) packed: PackedValues,
}

impl CorrectedFit {
    /// True if the fit has terms, rather than geometry alone.
    #[must_use]
    pub fn has_terms(&self) -> bool {
        self.sizes != Sizes::NONE
    }

    /// Its robot with the measurements.
    pub(crate) fn session<'a>(&'a self, geometry: &'a CalibratedFit<'_>) -> Session<'a> {
        let CorrectedFit { model, packed, unknowns, .. } = self;
        Session { robot: &model.robot, packed, unknowns, ..geometry.session() }
    }

    /// Error of positions in cross-validation (metres, RMS): the error of geometry alone times the share that terms leave on left-out rows.
    pub(crate) fn left_out_m(&self, of_geometry: Option<&CrossValidation>) -> Option<f64> {
        let of = |sizes: &Sizes| self.tried.iter().find(|it| it.sizes == *sizes).map(|it| it.left_out);
        let geometry_m = of_geometry?.random.rms.get(Quantity::Position)?;
        let left = (0.5 * (of(&self.sizes)? - of(&Sizes::NONE)?)).exp();
        Some(geometry_m * left).filter(|it| it.is_finite())
    }

    /// The fit with its accuracy and uncertainty, compared with the cross-validation of geometry, in the base frame of geometry.
    pub(crate) fn judge(
        mut self,
        geometry: &CalibratedFit<'_>,
        of_geometry: Option<&CrossValidation>,
        registered: &Estimate,
    ) -> Correction {
        let CalibrationRun { options, held_out_rows, .. } = &geometry.run;
        let left_out_m = self.left_out_m(of_geometry);
        let mut uncertainty = self.uncertainty.take();
        let (session, rows) = (self.session(geometry), &geometry.weighted_rows());
        let CorrectedFit { model, estimate, noise, .. } = &self;
        let coverage = coverage(&session, rows);
        let domain = Domain {
            session: &session,
            rows,
            coverage: &coverage,
            nominal: (&geometry.run.robot, registered),
            seed: options.seed,
        };
        let expected = uncertainty
            .as_mut()
            .map_or_else(Expectations::default, |uncertainty| domain.expectations_beside(uncertainty, left_out_m));
        let found = uncertainty.as_ref().filter(|_| self.has_terms()).map(|uncertainty| {
            let deviations: Vec<f64> = model.deviations(&self.possible).collect();
            let before = (&geometry.session(), &geometry.estimate);
            effects(model, (&session, estimate), before, rows, (uncertainty, &deviations), *noise)
        });
        let predicted = uncertainty.as_ref().map(|it| (it, &coverage[..]));
        let kept = held_out_check((&session, estimate), (rows, held_out_rows), predicted);
        let models = [
            SessionModel { session, estimate },
            SessionModel { session: geometry.session(), estimate: &geometry.estimate },
        ];
        let (mut estimate, mut tip) = (estimate.clone(), UnmeasuredTip::Nominal);
        // Without terms both models are the same.
        if self.has_terms() {
            let (base, at) = frames(models, rows, options.move_tip);
            (estimate, tip) = (estimate.rebase(&base), UnmeasuredTip::At(at));
            if let Some(uncertainty) = &mut uncertainty {
                uncertainty.estimate = estimate.clone();
            }
        }
        let data = session.data;
        let (robot, targets) = place_tip(&model.robot, data, &data.frames(rows), &estimate, options.move_tip, tip);
        Correction {
            robot: Robot { terms: estimate.terms.clone(), ..robot },
            targets,
            stations: stations(&session, &estimate, *noise),
            frame: options.frame,
            effects: found.unwrap_or_default(),
            expected,
            left_out_m,
            kept,
            fit: CorrectedFit { uncertainty, estimate, ..self },
        }
    }
}

/// Result of a fit of screws and terms: the fitted robot, with everything that predicts rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Correction {
    /// The fit.
    pub fit: CorrectedFit,
    /// The fitted robot, with its compliant joints and its terms, and its tip as that of [`Calibration::robot`](crate::Calibration). It predicts as
    /// the fit does.
    pub robot: Robot,
    /// The targets.
    pub targets: Vec<CalibratedTarget>,
    /// All stations.
    pub stations: Vec<CalibratedStation>,
    /// Prior knowledge of the device's frame.
    pub frame: DeviceFrameKnowledge,
    /// Effects of the terms; empty without terms.
    pub effects: Effects,
    /// Expected errors.
    pub expected: Expectations,
    /// Error of positions in cross-validation (metres, RMS): the error of geometry alone times the share that terms leave. `None` if no sizes were
    /// tried.
    pub left_out_m: Option<f64>,
    /// Coverage on the held-out rows.
    pub kept: Option<CoverageCheck>,
}

impl Deref for Correction {
    type Target = CorrectedFit;

    fn deref(&self) -> &CorrectedFit {
        &self.fit
    }
}

impl Correction {
    /// Errors of rows of the data that were fitted ([`Session::errors`]).
    #[must_use]
    pub fn errors(&self, data: &Dataset, rows: &[u32]) -> Vec<RowError> {
        Session::new(&self.model.robot, data, &self.packed, true).errors(rows, &self.estimate)
    }

    /// Error that judges the fit on this number of rows: on the held-out rows, or if there are none on the fitted rows as cross-validation predicts
    /// their positions.
    pub(crate) fn judging_error(&self, rows: usize) -> JudgingError {
        if let Some(errors) = &self.held_out {
            return errors.judging_error(rows);
        }
        let found = self.training.judging_error(rows);
        let is_position = self.training.leading_value().is_some_and(|(it, _)| it == Quantity::Position);
        let left_out_m = self.left_out_m.filter(|_| is_position && self.training.of_pictures(rows).is_none());
        JudgingError { rms: left_out_m.map_or(found.rms, |it| 1e3 * it), ..found }
    }
}
