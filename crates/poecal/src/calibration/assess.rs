//! The judgement of what was fitted, once, at the end.

use std::sync::Arc;

use super::accepted::accepted;
use super::corrected::Found;
use super::events::Events;
use super::figures::Figures;
use super::improvement::improvements;
use super::placed::{place_tip, stations};
use super::rounding::rounded;
use super::run::{CalibratedFit, Run};
use super::signs::Signs;
use super::summary::FitSummary;
use super::verdict::{Grounds, Judged, judged};
use super::{CalibratedTarget, Calibration, Corrections, Level, Repaired, Verdict};
use crate::error::Result;
use crate::forensics::{Diagnosis, DiagnosisKind};
use crate::robot::Robot;
use crate::threads;

impl<'a> Found<'a> {
    /// Judges what was fitted; with `events` if the session was searched for them.
    pub(super) fn judge(self, events: Option<Events>) -> Result<Repaired<'a>> {
        let rows = self.run.data.len();
        let (mut calibration, run) = threads::in_pool(rows, || self.judged(events));
        let improvement = improvements(&calibration, &run.data);
        if let Some(set) = &mut calibration.accuracy.held_out {
            set.improvement = improvement;
        }
        if let Some(accept) = &run.options.accept {
            calibration.acceptance = Some(accepted(&calibration, &run.data, accept)?);
        }
        Ok(Repaired { calibration, data: run.data })
    }

    fn judged(self, events: Option<Events>) -> (Calibration, Run<'a>) {
        let Found { run, fit, corrected, summary, cross_validation } = self;
        // Where a corrected model searches for steps and drifts, the residuals of geometry do not.
        let finds_moves = events.is_none() || run.corrections == Corrections::Off;
        let events = events.unwrap_or_default();
        let mut figures = run.figures(&fit, &summary, corrected, cross_validation);
        let signs = run.signs(&fit, &summary, &figures, finds_moves);
        let frames = run.data.frames(&run.fit_rows);
        let calibrated = &figures.models.calibrated;
        let placed = place_tip(&run.robot, &run.data, &frames, calibrated, run.options.move_tip);
        let judged = run.judged_by(&fit, &summary, &figures, &signs, &placed.1);
        let is_doubtful = judged.of_calibrated(&figures.trust.expected).level == Level::DoNotUse;
        if is_doubtful || signs.diagnosis.iter().any(Diagnosis::is_of_input) {
            // Mistakes in the input are not the fault of a joint.
            figures.trust.joints.iter_mut().for_each(|joint| joint.suspicious = None);
        }
        figures.explain_suspicions(&run.robot);
        let judged = events.against.iter().cloned().fold(judged, Judged::against);
        let verdict = match figures.correction.as_ref().filter(|it| it.has_terms()) {
            Some(found) => judged.of_corrected(found.judging_errors(), &found.expected),
            None => judged.of_calibrated(&figures.trust.expected),
        };
        let mut warnings = signs.warnings();
        let session = run.session(&fit.noise_ratios);
        warnings.extend(rounded(&session, figures.accuracy.training.calibrated.leading_m()));
        if !signs.moved.as_ref().is_some_and(|it| it.explains(&figures.robustness)) {
            warnings.extend(figures.robustness.warning(&run.fit_rows, &run.held_out_rows));
        }
        warnings.extend(figures.correction.as_ref().and_then(|it| it.doubt.clone()));
        warnings.extend(events.early.clone());
        let sentences = Sentences { verdict, warnings, events, diagnosis: signs.diagnosis };
        (run.calibration(fit, figures, placed, sentences), run)
    }
}

impl Run<'_> {
    /// What speaks against use.
    fn judged_by(
        &self,
        fit: &CalibratedFit,
        summary: &FitSummary,
        figures: &Figures,
        signs: &Signs,
        targets: &[CalibratedTarget],
    ) -> Judged {
        let reach_m = 3.0 * self.session(&[]).length_m;
        judged(&Grounds {
            accuracy: &figures.accuracy,
            solver: &fit.robust.fitted.report,
            identifiability: &figures.identifiability,
            trust: &figures.trust,
            robot: &self.robot,
            robustness: &figures.robustness,
            rows: self.fit_rows.len(),
            numbers: summary.remainder.numbers,
            has_other_zeros: signs.diagnosis.iter().any(|it| it.kind == DiagnosisKind::JointZero),
            noise: &signs.noise,
            reach_m,
            mistakes: &signs.mistakes(targets, reach_m),
            moves_joints: self.unknowns.moves_joints(self.robot.joints.len()),
        })
    }

    /// The finished calibration, before its rows held out are compared.
    fn calibration(
        &self,
        fit: CalibratedFit,
        figures: Figures,
        (robot, targets): (Robot, Vec<CalibratedTarget>),
        sentences: Sentences,
    ) -> Calibration {
        let Figures { models, accuracy, robustness, trust, identifiability, correction } = figures;
        let Sentences { verdict, warnings, diagnosis, events } = sentences;
        let session = self.session(&fit.noise_ratios);
        let fitted = fit.robust.fitted;
        Calibration {
            nominal: self.robot.clone(),
            robot,
            targets,
            frame: self.options.frame,
            unknowns: self.unknowns.clone(),
            formulation: self.options.formulation,
            chosen_tolerance: self.options.tolerance.filter(|_| self.options.chooses_tolerance),
            base_from_device: models.calibrated.device_from_base.inverse(),
            stations: stations(&session, &models.calibrated, fitted.noise),
            models,
            accuracy,
            solver: fitted.report,
            identifiability,
            trust,
            acceptance: None,
            verdict,
            noise: fitted.noise,
            noise_source: fitted.noise_source,
            noise_ratios: fit.noise_ratios,
            robustness,
            warnings,
            diagnosis,
            correction: correction.map(Box::new),
            repairs: events.repairs,
            suspicions: events.suspicions,
            fit_rows: self.fit_rows.clone(),
            held_out_rows: self.held_out_rows.clone(),
            packed: Arc::clone(&self.packed),
        }
    }
}

/// What is said of a calibration.
struct Sentences {
    verdict: Verdict,
    warnings: Vec<String>,
    diagnosis: Vec<Diagnosis>,
    events: Events,
}
