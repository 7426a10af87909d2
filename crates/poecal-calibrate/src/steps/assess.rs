//! Judgement of the fit, once, at the end.

use std::sync::Arc;

use super::calibrated_fit::CalibratedFit;
use super::corrected_fit::FittedSession;
use super::figures::Figures;
use super::improvement::improvements;
use super::limit_checks::judge_acceptance;
use super::verdict::{LevelObjections, VerdictInput, judge_level};
use crate::doubts::diagnostics::ResidualDiagnostics;
use crate::doubts::single_offset::one_zero;
use crate::events::Events;
use crate::pictures::image_map::image_maps;
use crate::pictures::optics_doubts::{OpticsDoubt, optics_doubt};
use crate::pictures::view_doubts::view_doubts;
use crate::robust::RobustFit;
use crate::run::CalibrationRun;
use crate::run::calibrated_places::{UnmeasuredTip, place_tip, stations};
use crate::run::rounding::describe_rounding;
use crate::{Accuracy, CalibratedTarget, Calibration, Correction, Corrections, Level, RepairedSession, Trust, Verdict};
use poecal_arm::TermGroup;
use poecal_fit::forensics::Diagnosis;
use poecal_model::robot::Robot;
use poecal_numerics::error::Result;
use poecal_numerics::threads;

impl<'a> FittedSession<'a> {
    /// Judges the fit; with `events` if the session was searched for them.
    pub(crate) fn judge(self, events: Option<Events>) -> Result<RepairedSession<'a>> {
        let rows = self.fit.run.data.len();
        let (mut calibration, run) = threads::in_pool(rows, || self.make_calibration(events));
        let improvement = improvements(&calibration, &run.data);
        if let Some(set) = &mut calibration.accuracy.held_out {
            set.improvement = improvement;
        }
        if let Some(accept) = &run.options.accept {
            calibration.acceptance = Some(judge_acceptance(&calibration, &run.data, accept)?);
        }
        Ok(RepairedSession { calibration, data: run.data })
    }

    fn make_calibration(self, events: Option<Events>) -> (Calibration, CalibrationRun<'a>) {
        let FittedSession { fit, corrected, summary, cross_validation } = self;
        // If a corrected model searches for steps and drifts, the residuals of geometry do not.
        let finds_moves = events.is_none() || fit.run.corrections == Corrections::Off;
        let events = events.unwrap_or_default();
        let mut figures = fit.figures(&summary, corrected, cross_validation);
        let signs = fit.signs(&summary, &figures, finds_moves);
        let (robot, targets) = fit.place_targets(&figures);
        let mistakes = signs.mistakes(&targets, fit.reach_m());
        let judged =
            judge_level(&VerdictInput { fit: &fit, summary: &summary, figures: &figures, signs: &signs, mistakes });
        let is_doubtful = judged.of_calibrated(&figures.trust.expected).level == Level::DoNotUse;
        if is_doubtful || signs.diagnosis.iter().any(Diagnosis::is_of_input) {
            // Mistakes in the input are no fault of a joint.
            figures.trust.joints.iter_mut().for_each(|joint| joint.suspicious = None);
        }
        figures.explain_suspicions(&fit.run.robot);
        let optics = optics_doubt(&fit);
        let against_good = optics.as_ref().and_then(|it| it.against_good.clone());
        let warnings = fit.warnings(&figures, &signs, (&events, optics));
        let images = image_maps(&fit, &figures);
        let stations = stations(&fit.session(), &fit.estimate, fit.noise());
        let Figures { models, accuracy, robustness, trust, identifiability, correction } = figures;
        let judged = events.against.into_iter().fold(judged, LevelObjections::with_objection);
        let judged = against_good.into_iter().fold(judged, LevelObjections::against_good);
        let verdict = verdict(&judged, correction.as_ref(), &accuracy, &trust);
        let CalibratedFit { run, robust: RobustFit { fitted, .. }, noise_ratios, .. } = fit;
        let calibration = Calibration {
            nominal: run.robot.clone(),
            robot,
            targets,
            frame: run.options.frame,
            unknowns: run.unknowns.clone(),
            formulation: run.options.formulation,
            chosen_tolerance: run.options.tolerance.filter(|_| run.options.chooses_tolerance),
            base_from_device: models.calibrated.device_from_base.inverse(),
            stations,
            models,
            accuracy,
            solver: fitted.report,
            identifiability,
            trust,
            acceptance: None,
            verdict,
            noise: fitted.noise,
            noise_ratios,
            noise_source: fitted.noise_source,
            robustness,
            warnings,
            diagnosis: signs.diagnosis,
            repairs: events.repairs,
            suspicions: events.suspicions,
            fit_rows: run.fit_rows.clone(),
            held_out_rows: run.held_out_rows.clone(),
            correction: correction.map(Box::new),
            images,
            packed: Arc::clone(&run.packed),
        };
        (calibration, run)
    }
}

impl CalibratedFit<'_> {
    /// The calibrated robot with its tip, and the targets in its frame.
    fn place_targets(&self, figures: &Figures) -> (Robot, Vec<CalibratedTarget>) {
        let CalibrationRun { robot, data, options, fit_rows, .. } = &self.run;
        let frames = data.frames(fit_rows);
        place_tip(robot, data, &frames, &figures.models.calibrated, options.move_tip, UnmeasuredTip::Nominal)
    }

    /// Warnings, a sentence each.
    fn warnings(
        &self,
        figures: &Figures,
        signs: &ResidualDiagnostics,
        (events, optics): (&Events, Option<OpticsDoubt>),
    ) -> Vec<String> {
        let Figures { accuracy, robustness, correction, .. } = figures;
        let mut warnings = signs.warnings();
        warnings.extend(describe_rounding(&self.session(), accuracy.training.calibrated.leading_m()));
        if !signs.moved.as_ref().is_some_and(|it| it.explains(robustness)) {
            warnings.extend(robustness.warning(&self.run.fit_rows, &self.run.held_out_rows));
        }
        warnings.extend(correction.as_ref().and_then(|it| it.doubt.clone()));
        let sags = correction
            .as_ref()
            .is_some_and(|it| [TermGroup::Sag, TermGroup::Tilt].iter().any(|of| it.sizes[*of] > 0.0));
        warnings.extend(self.run.robot.placeholder_masses().filter(|_| sags));
        warnings.extend(self.run.open_targets());
        warnings.extend(figures.unknown_size());
        warnings.extend(one_zero(self));
        warnings.extend(optics.map(|it| it.statement));
        warnings.extend(view_doubts(self));
        warnings.extend(events.early.clone());
        warnings
    }
}

/// The verdict on the delivered model.
fn verdict(judged: &LevelObjections, correction: Option<&Correction>, accuracy: &Accuracy, trust: &Trust) -> Verdict {
    match correction.filter(|it| it.has_terms()) {
        Some(found) => {
            let rows = accuracy.held_out.map_or(accuracy.training.count, |set| set.count);
            judged.of_corrected(&found.judging_error(rows), [&found.expected, &trust.expected])
        }
        None => judged.of_calibrated(&trust.expected),
    }
}
