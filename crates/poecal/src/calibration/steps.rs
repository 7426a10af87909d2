//! The steps of a calibration, each from the results of those before.

use std::sync::Arc;

use super::count::check_count;
use super::doubts::doubts;
use super::expected::expectations_with_terms;
use super::finished::Finished;
use super::fit::{self, Task};
use super::found::Fitted;
use super::instrument_noise::{ROUNDS, noise_ratios};
use super::located::{located, promised_rows};
use super::moves::{ChangeSearch, FrameSearch, FramesApart, Moved, frames_apart, moved};
use super::noise_doubts::noise_doubts;
use super::placed::{place_tip, stations};
use super::robust::{self, RobustFit};
use super::rounding::rounded;
use super::stations::{check_length, check_stations};
use super::trust::trust;
use super::verdict::{Grounds, judged};
use super::{
    Accuracy, CalibratedTarget, Calibration, CalibrationOptions, Correction, CoverageCheck, Formulation,
    Level, Models, NoiseSource, PredictedUncertainty, Robust, Robustness, Trust, delivered, estimate_noise,
    noise, set_accuracy, split_rows,
};
use crate::analysis::{Identifiability, Setup, identifiability};
use crate::error::Result;
use crate::estimate::{Estimate, Packed, Session};
use crate::forensics::{self, Diagnosis, DiagnosisKind};
use crate::gauge;
use crate::measurement::{ByQuantity, Dataset, Noise};
use crate::parameters::Parameter;
use crate::problem::Prior;
use crate::start::{Registration, register, register_again};
use crate::threads;
use crate::uncertainty::{PriorInformation, Remainder, View, remainder};
use crate::unit::Unit;

/// Factor on the noise of rotations where tool and frame are registered for the best positions.
const POSITIONS_FIRST: f64 = 100.0;
/// Distance of a target from the tip, in reaches, that no tool has.
const FAR_TARGET: f64 = 3.0;
/// Efficiency of the robust losses under normal noise.
const EFFICIENCY: f64 = 0.95;

/// Session and rows, ready for a fit.
#[derive(Clone)]
pub(super) struct Prepared<'a> {
    session: Session<'a>,
    options: &'a CalibrationOptions,
    delivered: Estimate,
    /// Prior of the fit.
    prior: Option<Prior>,
    fit_rows: Vec<u32>,
    held_out_rows: Vec<u32>,
}

impl<'a> Prepared<'a> {
    /// Splits the rows; refuses problems that cannot be fitted.
    pub(super) fn new(session: Session<'a>, options: &'a CalibrationOptions) -> Result<Self> {
        let Session { robot, data, .. } = session;
        let (fit_rows, held_out_rows) = split_rows(data, options)?;
        check_stations(data, [&fit_rows, &held_out_rows], options, session.unknowns)?;
        check_count(&session, &fit_rows)?;
        check_length(&session, options, &fit_rows)?;
        let (delivered, prior) = (delivered(robot, data), options.prior(&session));
        Ok(Prepared { session, options, delivered, prior, fit_rows, held_out_rows })
    }

    fn registration<'b>(&'b self, rows: &'b [u32], noise: Noise, targets_free: bool) -> Registration<'b> {
        Registration {
            session: self.session,
            rows,
            noise,
            targets_free,
            prior: self.prior.as_ref().map(|it| (it, 1.0)),
        }
    }

    /// Device frame and targets with nominal screws, and the noise estimated from their residuals unless stated.
    pub(super) fn register(&self) -> (Estimate, Noise, NoiseSource) {
        let (mut noise, source) = noise::first_guess(self.session.data, self.options);
        let (mut registered, _) = register(&self.registration(&self.fit_rows, noise, true), &self.delivered);
        if source == NoiseSource::Estimated
            && let Some(found) = estimate_noise(&self.session, &self.fit_rows, &registered, 6.0, None, noise)
        {
            noise = noise::stated(self.options, found);
        }
        let again = self.registration(&self.fit_rows, noise, true).weighed_by(&registered);
        registered = register_again(&again, &registered);
        (registered, noise, source)
    }

    /// Fits the screws by least squares, whatever the options say of outliers.
    pub(super) fn fit_all(
        &self,
        registered: &Estimate,
        noise: Noise,
        source: NoiseSource,
    ) -> Result<RobustFit> {
        let options = CalibrationOptions { robust: Robust::Off, ..self.options.clone() };
        Prepared { options: &options, ..self.clone() }.fit(registered, noise, source, &[])
    }

    /// Fits the screws; these rows, in order, are left out.
    pub(super) fn fit(
        &self,
        registered: &Estimate,
        noise: Noise,
        source: NoiseSource,
        left_out: &[u32],
    ) -> Result<RobustFit> {
        let task = Task {
            session: self.session,
            rows: &self.fit_rows,
            weights: None,
            prior: self.prior.as_ref().map(|prior| (prior, 1.0)),
            options: self.options,
        };
        if !left_out.is_empty() {
            return robust::fit_without(&task, registered, (noise, source), left_out);
        }
        robust::fit(&task, &self.registration(&self.fit_rows, noise, true), registered, source)
    }

    /// Ends with the fit whose instruments have noises of their own, where these differ: fitted again until they do not change.
    pub(super) fn with_instruments(
        self,
        registered: &Estimate,
        fit: RobustFit,
        of: (NoiseSource, &[u32]),
        end: &mut dyn FnMut(Prepared<'_>, RobustFit) -> Result<Calibration>,
    ) -> Result<Calibration> {
        self.after(registered, fit, of, end, ROUNDS)
    }

    fn after(
        self,
        registered: &Estimate,
        fit: RobustFit,
        of: (NoiseSource, &[u32]),
        end: &mut dyn FnMut(Prepared<'_>, RobustFit) -> Result<Calibration>,
        rounds: usize,
    ) -> Result<Calibration> {
        let (source, left_out) = of;
        let is_open = source == NoiseSource::Estimated && self.session.data.station_count() > 1 && rounds > 0;
        let ratios = is_open.then(|| noise_ratios(&self.session, &self.fit_rows, &fit)).flatten();
        let Some(ratios) = ratios else { return end(self, fit) };
        let again = Prepared { session: self.session.with_noise_ratios(&ratios), ..self };
        let rows = self.session.data.len();
        let fit = threads::in_pool(rows, || again.fit(registered, fit.fitted.noise, source, left_out))?;
        again.after(registered, fit, of, end, rounds - 1)
    }

    /// Judges a fit. The calibration keeps the packed joint values of the session. `finds_moves` if steps and drifts are searched for by its own
    /// residuals.
    pub(super) fn assess(
        self,
        packed: Arc<Packed>,
        registered: Estimate,
        fit: RobustFit,
        finds_moves: bool,
    ) -> Calibration {
        let RobustFit { fitted, loss, judged: rows } = fit;
        let Session { robot: nominal, data, length_m, .. } = self.session;
        let kept = if loss.is_some() {
            robust::registrable(&rows.rows, &self.fit_rows)
        } else {
            self.fit_rows.clone()
        };
        let models = self.models(registered, &fitted, &kept, loss.is_some());
        let models = models.map(|it| located(&self.session, &self.fit_rows, &it, fitted.noise).into_owned());
        let accuracy = self.accuracy(&models);
        let (mut trust, remainder) = self.trust(&fitted, &models, &kept, loss.is_some());
        trust.held_out = self.held_out_coverage(&trust, &models.calibrated);
        let identifiability = self.identifiability(&fitted, &remainder);
        let apart = self.frames_apart(&fitted, &accuracy);
        let diagnosis = match &apart {
            Some(apart) => self.diagnosis(&apart.data, &apart.estimate, None),
            None => self.diagnosis(data, &models.calibrated, loss.is_some().then_some(&kept[..])),
        };
        let robustness = Robustness::new(loss, rows, [&self.fit_rows, &self.held_out_rows], |rows| {
            set_accuracy(&self.session, rows, &models)
        });
        let of_steps = || {
            finds_moves.then(|| self.moved(&models.calibrated, &fitted, robustness.loss.is_some())).flatten()
        };
        let moved = apart.as_ref().map(FramesApart::moved).or_else(of_steps);
        let input = self.input_doubts(&accuracy, &robustness, moved.as_ref());
        let lag_one = trust.uncertainty.as_ref().and_then(|it| it.discrepancy.lag_one);
        let noise_doubts = noise_doubts(&remainder, lag_one);
        let grave = diagnosis.iter().filter(|it| it.is_of_input() && it.kind != DiagnosisKind::JointZero);
        let grave_move = moved.iter().filter(|it| it.is_grave).map(|it| it.statement.clone());
        let frames = data.frames(&self.fit_rows);
        let (robot, targets) = place_tip(nominal, data, &frames, &models.calibrated, self.options.move_tip);
        let far = far_targets(&targets, 3.0 * length_m);
        let mistakes: Vec<String> = grave
            .map(|it| it.statement.clone())
            .chain(input.iter().cloned())
            .chain(grave_move)
            .chain(far)
            .collect();
        let mut warnings: Vec<String> = input
            .into_iter()
            .chain(noise_doubts.iter().map(|doubt| doubt.statement.clone()))
            .chain(moved.iter().map(|it| it.statement.clone()))
            .collect();
        warnings.extend(rounded(&self.session, accuracy.training.calibrated.leading_m()));
        if !moved.as_ref().is_some_and(|it| it.explains(&robustness)) {
            warnings.extend(robustness.warning(&self.fit_rows, &self.held_out_rows));
        }
        let judged = judged(&Grounds {
            accuracy: &accuracy,
            solver: &fitted.report,
            identifiability: &identifiability,
            trust: &trust,
            robot: nominal,
            robustness: &robustness,
            rows: self.fit_rows.len(),
            numbers: remainder.numbers,
            has_other_zeros: diagnosis.iter().any(|it| it.kind == DiagnosisKind::JointZero),
            noise: &noise_doubts,
            reach_m: 3.0 * length_m,
            mistakes: &mistakes,
            moves_joints: self.session.unknowns.moves_joints(nominal.joints.len()),
        });
        let verdict = judged.of_calibrated(&trust.expected);
        if verdict.level == Level::DoNotUse || diagnosis.iter().any(Diagnosis::is_of_input) {
            // Mistakes in the input are not the fault of a joint.
            trust.joints.iter_mut().for_each(|joint| joint.suspicious = None);
        }
        Calibration {
            nominal: nominal.clone(),
            robot,
            targets,
            frame: self.options.frame,
            unknowns: self.session.unknowns.clone(),
            formulation: self.options.formulation,
            chosen_tolerance: None,
            base_from_device: models.calibrated.device_from_base.inverse(),
            stations: stations(&self.session, &models.calibrated, fitted.noise),
            models,
            accuracy,
            solver: fitted.report,
            identifiability,
            trust,
            acceptance: None,
            judged,
            verdict,
            noise: fitted.noise,
            noise_ratios: self.session.noise_ratios.to_vec(),
            noise_source: fitted.noise_source,
            robustness,
            warnings,
            diagnosis,
            correction: None,
            repairs: Vec::new(),
            suspicions: Vec::new(),
            fit_rows: self.fit_rows,
            held_out_rows: self.held_out_rows,
            packed,
        }
    }

    /// The three models; the first two are registered by the rows that a robust fit keeps, the third in the nominal base frame.
    fn models(&self, registered: Estimate, fitted: &Fitted, kept: &[u32], is_robust: bool) -> Models {
        // Positions decide tool and frame; orientations decide only the directions that positions do not determine.
        let positions = ByQuantity::from_fn(|quantity| match quantity.unit() {
            Unit::Metre => fitted.noise[quantity],
            Unit::Radian | Unit::One => POSITIONS_FIRST * fitted.noise[quantity],
        });
        let registration =
            |targets_free| self.registration(kept, positions, targets_free).weighed_by(&registered);
        let again = |targets_free| register(&registration(targets_free), &self.delivered).0;
        // Offsets that were asked for stay; those of a formulation are a way to write the screws.
        let found = if self.options.formulation == Formulation::default() {
            fitted.estimate.clone()
        } else {
            fitted.estimate.without_offsets()
        };
        let calibrated = if self.session.base_free() {
            let targets = &self.delivered.base_from_target;
            let motion = gauge::base_motion(&found, self.session.robot, targets, self.session.length_m);
            found.rebased(&motion)
        } else {
            found
        };
        Models {
            nominal: again(false),
            registered: if is_robust {
                again(true)
            } else {
                register_again(&registration(true), &registered)
            },
            calibrated,
        }
    }

    fn accuracy(&self, models: &Models) -> Accuracy {
        let of = |rows: &[u32]| set_accuracy(&self.session, rows, models);
        Accuracy {
            training: of(&self.fit_rows),
            held_out: (!self.held_out_rows.is_empty()).then(|| of(&self.held_out_rows)),
        }
    }

    fn identifiability(&self, fitted: &Fitted, remainder: &Remainder) -> Identifiability {
        let setup = Setup {
            session: self.session,
            rows: &self.fit_rows,
            estimate: &fitted.estimate,
            layout: &fitted.layout,
            noise: fitted.noise,
        };
        let found = identifiability(&setup, &fitted.normal.gram, remainder.variance);
        Identifiability { effective_unknowns: remainder.effective_unknowns, ..found }
    }

    /// Judges the result in the minimal basis and by the kept rows, whatever the parameterisation and loss of the fit.
    fn trust(&self, fitted: &Fitted, models: &Models, kept: &[u32], is_robust: bool) -> (Trust, Remainder) {
        let is_usual = self.options.formulation == Formulation::default();
        let (layout, normal) = if (is_usual || fitted.layout.is_minimal()) && !is_robust {
            (fitted.layout.clone(), fitted.normal.clone())
        } else {
            fit::minimal(self.session, kept, &models.calibrated, fitted.noise)
        };
        let prior =
            PriorInformation::new(self.prior.as_ref(), &models.calibrated, &layout, self.session.length_m)
                .with_chosen(
                    &layout.motions_without_effect(&models.calibrated, &self.session, kept).directions,
                    self.session.length_m,
                );
        let free: Vec<Parameter> = layout.parameters().map(|(parameter, _)| *parameter).collect();
        let mut view = View {
            session: self.session,
            rows: kept,
            free: &free,
            noise: fitted.noise,
            noise_is_stated: noise::is_stated(self.session.data, self.options),
            prior: &prior,
            variance: 1.0,
            estimate: &models.calibrated,
        };
        let remainder = remainder(&view, &normal, &layout);
        view.variance = remainder.variance / if is_robust { EFFICIENCY } else { 1.0 };
        let found = trust(&Finished {
            view,
            layout: &layout,
            normal: &normal,
            remainder: &remainder,
            models,
            seed: self.options.seed,
        });
        (found, remainder)
    }

    /// Mistakes in all rows, held-out ones too: shifted rows show best in an unbroken series. After a robust fit first in the kept rows,
    /// since single wrong ones hide mistakes in all.
    fn diagnosis(&self, data: &Dataset, calibrated: &Estimate, believed: Option<&[u32]>) -> Vec<Diagnosis> {
        if !self.options.diagnose {
            return Vec::new();
        }
        let Session { robot, device_free, .. } = self.session;
        let options = forensics::DiagnosisOptions { device_free, calibrated: Some(calibrated) };
        let in_all = || forensics::diagnose(robot, data, &data.all_rows(), &options);
        let Some(believed) = believed else { return in_all() };
        let mut found = forensics::diagnose(robot, data, believed, &options);
        if !found.iter().any(Diagnosis::is_of_input) {
            // Shifted rows or exchanged names may be why the fit rejected rows.
            let known: Vec<DiagnosisKind> = found.iter().map(|it| it.kind).collect();
            found.extend(in_all().into_iter().filter(|it| !known.contains(&it.kind)));
        }
        found
    }

    /// Coverage on the held-out rows.
    fn held_out_coverage(&self, trust: &Trust, calibrated: &Estimate) -> Option<CoverageCheck> {
        let uncertainty = trust.uncertainty.as_ref().filter(|_| !self.held_out_rows.is_empty())?;
        let targets: Vec<usize> = (0..self.session.data.targets.len()).collect();
        let predicted = PredictedUncertainty { uncertainty, targets: &targets, coverage: &trust.coverage };
        let rows = promised_rows(self.session.data, &self.fit_rows, &self.held_out_rows);
        let errors = self.session.errors(&rows, calibrated);
        (!rows.is_empty()).then(|| predicted.check(&self.session, calibrated, &rows, &errors))
    }

    /// The calibration beside a corrected model without terms: what terms might be there stays a part of its uncertainty, so that both are one.
    pub(super) fn beside(&self, mut calibration: Calibration, found: &Correction) -> Calibration {
        if found.has_terms() {
            return calibration;
        }
        let trust = &mut calibration.trust;
        let Some(uncertainty) = trust.uncertainty.as_mut() else { return calibration };
        let of = (uncertainty, &trust.expected, &found.expected);
        let seed = self.options.seed;
        if let Some(expected) =
            expectations_with_terms(&self.session, &self.fit_rows, &trust.coverage, of, seed)
        {
            trust.expected = expected;
            calibration.trust.held_out =
                self.held_out_coverage(&calibration.trust, &calibration.models.calibrated);
            calibration.verdict = calibration.judged.of_calibrated(&calibration.trust.expected);
        }
        calibration
    }

    /// Doubts about the input, by the rows that are not suspected.
    fn input_doubts(
        &self,
        accuracy: &Accuracy,
        robustness: &Robustness,
        moved: Option<&Moved>,
    ) -> Vec<String> {
        // Different device frames make any model misfit.
        if moved.is_some_and(Moved::is_of_frames) {
            return Vec::new();
        }
        let (rows, errors) = match &robustness.training_rest {
            Some(rest) if !robustness.suspects_many() => (robustness.rest(&self.fit_rows), rest),
            _ => (self.fit_rows.clone(), &accuracy.training),
        };
        doubts(self.session.data, &rows, &errors.registered, self.options.frame)
    }

    /// Different device frames, if a fit with one has larger errors than a robot's own.
    fn frames_apart(&self, fitted: &Fitted, accuracy: &Accuracy) -> Option<FramesApart> {
        let left_m = accuracy.training.calibrated.leading_m();
        if !self.session.base_free() || !fit::is_suspicious(left_m, self.session.length_m) {
            return None;
        }
        frames_apart(&self.frame_search(fitted, left_m))
    }

    fn frame_search(&self, fitted: &Fitted, left_m: f64) -> FrameSearch<'_> {
        FrameSearch {
            session: self.session,
            rows: &self.fit_rows,
            noise: fitted.noise,
            options: self.options,
            left_m,
        }
    }

    /// Change point or drift of the session. Rows held out by chance belong to it as well; rows with a stated set may belong to another.
    fn moved(&self, calibrated: &Estimate, fitted: &Fitted, is_robust: bool) -> Option<Moved> {
        let is_stated = self.session.data.observations.iter().any(|row| row.set.is_some());
        let rows = if is_stated { self.fit_rows.clone() } else { self.session.data.all_rows() };
        // Least squares take a part of a move into the screws; a robust loss does not.
        let again =
            (self.session.base_free() && !is_robust).then(|| self.frame_search(fitted, f64::INFINITY));
        moved(&ChangeSearch {
            session: self.session,
            estimate: calibrated,
            rows: &rows,
            again: again.as_ref(),
        })
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
