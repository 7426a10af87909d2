//! Signs in the residuals: mistakes in the input, changes during the session, noise that contradicts its statement.

use super::noise_doubts::{NoiseDoubt, noise_doubts};
use crate::doubts::doubts;
use crate::moves::{ChangeSearch, DetectedMove, FrameSearch, SeparateFrames, find_move, frames_apart};
use crate::run::CalibrationRun;
use crate::run::fit::is_suspicious;
use crate::steps::calibrated_fit::CalibratedFit;
use crate::steps::figures::Figures;
use crate::steps::summary::FitSummary;
use crate::{Accuracy, CalibratedTarget, Robustness};
use poecal_fit::forensics::{Diagnosis, DiagnosisKind, DiagnosisOptions, diagnose};
use poecal_fit::state::{Estimate, Session};
use poecal_model::measurement::Dataset;

/// Distance of a target from the tip, in reaches, that no tool has.
const FAR_TARGET: f64 = 3.0;
/// Share of the error with freed zeros of distances below which joint terms explain more than these zeros.
const MORE: f64 = 0.8;

/// Signs in the residuals.
pub(crate) struct ResidualDiagnostics {
    /// Mistakes found in all rows.
    pub(crate) diagnosis: Vec<Diagnosis>,
    /// A step, a drift, or different device frames.
    pub(crate) moved: Option<DetectedMove>,
    /// Doubts about the input.
    input: Vec<String>,
    /// Contradictions between residuals and stated noise.
    pub(crate) noise: Vec<NoiseDoubt>,
}

impl ResidualDiagnostics {
    /// Mistakes with which the result must not be used, a sentence each.
    pub(crate) fn mistakes(&self, targets: &[CalibratedTarget], reach_m: f64) -> Vec<String> {
        let grave = self.diagnosis.iter().filter(|it| it.is_of_input() && it.kind != DiagnosisKind::JointZero);
        let grave = grave.map(|it| it.statement.clone()).chain(self.input.iter().cloned());
        let moved = self.moved.iter().filter(|it| it.is_grave).map(|it| it.statement.clone());
        grave.chain(moved).chain(far_targets(targets, reach_m)).collect()
    }

    /// Warnings, a sentence each.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let noise = self.noise.iter().map(|doubt| &doubt.statement);
        let moved = self.moved.iter().map(|it| &it.statement);
        self.input.iter().chain(noise).chain(moved).cloned().collect()
    }
}

impl CalibratedFit<'_> {
    /// Looks for signs of mistakes and changes; for steps and drifts only if `finds_moves`.
    pub(crate) fn signs(&self, summary: &FitSummary, figures: &Figures, finds_moves: bool) -> ResidualDiagnostics {
        let Figures { accuracy, robustness, .. } = figures;
        let apart = self.frames_apart(accuracy);
        let mut diagnosis = match &apart {
            Some(apart) => self.diagnosis(&apart.data, &apart.estimate, None),
            None => self.diagnose_fit(summary),
        };
        // Distance errors that one more unknown explains may be joint effects.
        let corrected = figures.correction.as_ref().filter(|it| it.has_terms());
        let left_mm = corrected.map_or(f64::INFINITY, |it| it.training.lead().rms);
        diagnosis.retain(|it| it.kind != DiagnosisKind::DistanceZero || left_mm > MORE * it.after_mm);
        let of_steps = || finds_moves.then(|| self.find_move()).flatten();
        let moved = apart.as_ref().map(SeparateFrames::to_move).or_else(of_steps);
        let input = self.input_doubts(accuracy, robustness, moved.as_ref());
        ResidualDiagnostics { diagnosis, moved, input, noise: noise_doubts(&summary.remainder, figures.lag_one()) }
    }

    /// A mistake in the input of a session whose rows share one device frame.
    pub(crate) fn mistake(&self, summary: &FitSummary) -> Option<Diagnosis> {
        self.diagnose_fit(summary).into_iter().find(Diagnosis::is_of_input)
    }

    fn diagnose_fit(&self, summary: &FitSummary) -> Vec<Diagnosis> {
        let believed = self.robust.robustness.loss.map(|_| &summary.kept[..]);
        self.diagnosis(&self.run.data, &self.estimate, believed)
    }

    /// Mistakes in all rows, held-out ones too: shifted rows show best in an unbroken series. After a robust fit it looks first in the kept rows,
    /// since single wrong ones hide mistakes in all.
    fn diagnosis(&self, data: &Dataset, calibrated: &Estimate, believed: Option<&[u32]>) -> Vec<Diagnosis> {
        if !self.run.options.diagnose {
            return Vec::new();
        }
        let Session { robot, device_free, .. } = self.session();
        let options = DiagnosisOptions { device_free, calibrated: Some(calibrated) };
        let in_all = || diagnose(robot, data, &data.all_rows(), &options);
        let Some(believed) = believed else { return in_all() };
        let mut found = diagnose(robot, data, believed, &options);
        if !found.iter().any(Diagnosis::is_of_input) {
            // Shifted rows or exchanged names may explain the rows that the fit rejected.
            let known: Vec<DiagnosisKind> = found.iter().map(|it| it.kind).collect();
            found.extend(in_all().into_iter().filter(|it| !known.contains(&it.kind)));
        }
        found
    }

    /// Doubts about the input, by the rows that are not suspected.
    fn input_doubts(&self, accuracy: &Accuracy, robustness: &Robustness, moved: Option<&DetectedMove>) -> Vec<String> {
        // Different device frames make any model misfit.
        if moved.is_some_and(DetectedMove::is_of_frames) {
            return Vec::new();
        }
        let (rows, errors) = match &robustness.training_rest {
            Some(rest) if !robustness.suspects_many() => (robustness.rest(&self.run.fit_rows), rest),
            _ => (self.run.fit_rows.clone(), &accuracy.training),
        };
        doubts(&self.run.data, &rows, &errors.registered, self.run.options.frame)
    }

    /// Different device frames, if a fit with one frame has larger errors than a robot's own.
    fn frames_apart(&self, accuracy: &Accuracy) -> Option<SeparateFrames> {
        let left_m = accuracy.training.calibrated.leading_m();
        let search = self.frame_search(left_m);
        let is_open = search.session.base_free() && is_suspicious(left_m, search.session.length_m);
        is_open.then(|| frames_apart(&search)).flatten()
    }

    fn frame_search(&self, left_m: f64) -> FrameSearch<'_> {
        let (session, noise, CalibrationRun { fit_rows, options, .. }) = (self.session(), self.noise(), &self.run);
        FrameSearch { session, rows: fit_rows, noise, options, left_m }
    }

    /// Change point or drift of the session. Rows held out by chance belong to the session as well; rows with a stated set may belong to another.
    fn find_move(&self) -> Option<DetectedMove> {
        let search = self.frame_search(f64::INFINITY);
        let is_stated = self.run.data.observations.iter().any(|row| row.set.is_some());
        let rows = if is_stated { self.run.fit_rows.clone() } else { self.run.data.all_rows() };
        // Least squares take a part of a move into the screws; a robust loss does not.
        let again = (search.session.base_free() && self.robust.robustness.loss.is_none()).then_some(&search);
        find_move(&ChangeSearch { session: search.session, estimate: &self.estimate, rows: &rows, again })
    }
}

/// Targets that ended farther from the tip than any tool is long: nothing determines them.
fn far_targets(targets: &[CalibratedTarget], reach_m: f64) -> Vec<String> {
    let far = targets.iter().filter(|it| it.tip_from_target.translation.norm() > FAR_TARGET * reach_m);
    let words = far.map(|it| {
        format!(
            "the target{} ended {:.2} m from the tip, more than {FAR_TARGET:.0} times the robot's reach: these rows do not determine it; measure more \
             configurations that turn the last joints",
            it.name.as_ref().map_or_else(String::new, |name| format!(" `{name}`")),
            it.tip_from_target.translation.norm()
        )
    });
    words.collect()
}
