//! The steps of a calibration, each from the results of those before.

use std::sync::Arc;

use super::count::check_count;
use super::doubts::doubts;
use super::fit::{self, Task};
use super::found::Fitted;
use super::moves::{ChangeSearch, FrameSearch, FramesApart, Moved, frames_apart, moved};
use super::noise_doubts::noise_doubts;
use super::result::{place_tip, stations};
use super::robust::{self, RobustFit};
use super::stations::check_stations;
use super::trust::{Finished, trust};
use super::verdict::{Grounds, verdict};
use super::{
    Accuracy, Calibration, CalibrationOptions, CoverageCheck, DeviceFrameKnowledge, Level, Models,
    NoiseSource, PredictedUncertainty, Robustness, Trust, delivered, estimate_noise, noise, radian_m,
    set_accuracy, split_rows,
};
use crate::analysis::{Identifiability, Setup, identifiability};
use crate::error::Result;
use crate::estimate::{Estimate, Packed, row_errors};
use crate::forensics::{self, Diagnosis, DiagnosisKind};
use crate::gauge;
use crate::measurement::{Dataset, Noise};
use crate::parameters::Parameter;
use crate::problem::Prior;
use crate::robot::Robot;
use crate::start::{Registration, register, register_again};
use crate::uncertainty::{PriorInformation, Remainder, View, remainder};

/// Factor on the noise of rotations where tool and frame are registered for the best positions.
const POSITIONS_FIRST: f64 = 100.0;
/// Efficiency of the robust losses under normal noise.
const EFFICIENCY: f64 = 0.95;

/// Data and rows, ready for a fit.
pub(super) struct Prepared<'a> {
    robot: &'a Robot,
    data: &'a Dataset,
    options: &'a CalibrationOptions,
    packed: Packed,
    delivered: Estimate,
    length_m: f64,
    /// Prior of the fit.
    prior: Option<Prior>,
    fit_rows: Vec<u32>,
    held_out_rows: Vec<u32>,
}

impl<'a> Prepared<'a> {
    /// Splits the rows and packs the readings; refuses problems that cannot be fitted.
    pub(super) fn new(robot: &'a Robot, data: &'a Dataset, options: &'a CalibrationOptions) -> Result<Self> {
        let (fit_rows, held_out_rows) = split_rows(data, options)?;
        check_stations(data, [&fit_rows, &held_out_rows], options)?;
        check_count(robot, data, &fit_rows)?;
        let packed = Packed::of(robot, data);
        let (delivered, length_m) = (delivered(robot, data), radian_m(robot, &packed));
        let base_free = options.frame == DeviceFrameKnowledge::Unknown;
        let prior = options.tolerance_in_fit().map(|tolerance| Prior::new(robot, tolerance, base_free));
        Ok(Prepared { robot, data, options, packed, delivered, length_m, prior, fit_rows, held_out_rows })
    }

    fn device_free(&self) -> bool {
        self.options.frame == DeviceFrameKnowledge::Unknown
    }

    fn registration<'b>(&'b self, rows: &'b [u32], noise: Noise, targets_free: bool) -> Registration<'b> {
        Registration {
            data: self.data,
            packed: &self.packed,
            rows,
            noise,
            length_m: self.length_m,
            device_free: self.device_free(),
            targets_free,
        }
    }

    /// Device frame and targets with nominal screws, and the noise estimated from their residuals unless stated.
    pub(super) fn register(&self) -> (Estimate, Noise, NoiseSource) {
        let (mut noise, source) = noise::first_guess(self.data, self.options);
        let (mut registered, _) = register(&self.registration(&self.fit_rows, noise, true), &self.delivered);
        if source == NoiseSource::Estimated
            && let Some(found) =
                estimate_noise(self.data, &self.packed, &self.fit_rows, &registered, 6.0, None, noise)
        {
            noise = noise::stated(self.options, found);
            registered = register_again(&self.registration(&self.fit_rows, noise, true), &registered);
        }
        (registered, noise, source)
    }

    /// Fits the screws.
    pub(super) fn fit(&self, registered: &Estimate, noise: Noise, source: NoiseSource) -> Result<RobustFit> {
        let task = Task {
            robot: self.robot,
            data: self.data,
            packed: &self.packed,
            rows: &self.fit_rows,
            weights: None,
            length_m: self.length_m,
            prior: self.prior.as_ref().map(|prior| (prior, 1.0)),
            options: self.options,
        };
        robust::fit(&task, &self.registration(&self.fit_rows, noise, true), registered, source)
    }

    /// Judges a fit.
    pub(super) fn assess(self, registered: Estimate, fit: RobustFit) -> Calibration {
        let RobustFit { fitted, loss, judged } = fit;
        let kept = if loss.is_some() {
            robust::registrable(&judged.rows, &self.fit_rows)
        } else {
            self.fit_rows.clone()
        };
        let models = self.models(registered, &fitted, &kept, loss.is_some());
        let accuracy = self.accuracy(&models);
        let (mut trust, remainder) = self.trust(&fitted, &models, &kept, loss.is_some());
        trust.held_out = self.held_out_coverage(&trust, &models.calibrated);
        let identifiability = self.identifiability(&fitted, &remainder);
        let apart = self.frames_apart(&fitted, &accuracy);
        let diagnosis = match &apart {
            Some(apart) => self.diagnosis(&apart.data, &apart.estimate, None),
            None => self.diagnosis(self.data, &models.calibrated, loss.is_some().then_some(&kept[..])),
        };
        let robustness = Robustness::new(loss, judged, [&self.fit_rows, &self.held_out_rows], |rows| {
            set_accuracy(self.data, &self.packed, rows, &models)
        });
        let moved = apart
            .as_ref()
            .map(FramesApart::moved)
            .or_else(|| self.moved(&models.calibrated, &fitted, robustness.loss.is_some()));
        let input = self.input_doubts(&accuracy, &robustness, moved.as_ref());
        let lag_one = trust.uncertainty.as_ref().and_then(|it| it.discrepancy.lag_one);
        let noise_doubts = noise_doubts(&remainder, lag_one);
        let grave = diagnosis.iter().filter(|it| it.is_of_input() && it.kind != DiagnosisKind::JointZero);
        let grave_move = moved.iter().filter(|it| it.is_grave).map(|it| it.statement.clone());
        let mistakes: Vec<String> =
            grave.map(|it| it.statement.clone()).chain(input.iter().cloned()).chain(grave_move).collect();
        let mut warnings: Vec<String> = input
            .into_iter()
            .chain(noise_doubts.iter().map(|doubt| doubt.statement.clone()))
            .chain(moved.iter().map(|it| it.statement.clone()))
            .collect();
        if !moved.as_ref().is_some_and(|it| it.explains(&robustness)) {
            warnings.extend(robustness.warning(&self.fit_rows, &self.held_out_rows));
        }
        let verdict = verdict(&Grounds {
            accuracy: &accuracy,
            solver: &fitted.report,
            identifiability: &identifiability,
            trust: &trust,
            robot: self.robot,
            robustness: &robustness,
            rows: self.fit_rows.len(),
            numbers: remainder.numbers,
            has_other_zeros: diagnosis.iter().any(|it| it.kind == DiagnosisKind::JointZero),
            noise: &noise_doubts,
            reach_m: 3.0 * self.length_m,
            mistakes: &mistakes,
        });
        if verdict.level == Level::DoNotUse || diagnosis.iter().any(Diagnosis::is_of_input) {
            // Mistakes in the input are not the fault of a joint.
            trust.joints.iter_mut().for_each(|joint| joint.suspicious = None);
        }
        let frames = self.data.frames(&self.fit_rows);
        let (robot, targets) = place_tip(self.robot, self.data, &frames, &models.calibrated);
        Calibration {
            nominal: self.robot.clone(),
            robot,
            targets,
            frame: self.options.frame,
            formulation: self.options.formulation,
            base_from_device: models.calibrated.device_from_base.inverse(),
            stations: stations(self.data, &models.calibrated),
            models,
            accuracy,
            solver: fitted.report,
            identifiability,
            trust,
            verdict,
            noise: fitted.noise,
            noise_source: fitted.noise_source,
            robustness,
            warnings,
            diagnosis,
            fit_rows: self.fit_rows,
            held_out_rows: self.held_out_rows,
            packed: Arc::new(self.packed),
        }
    }

    /// The three models; the first two are registered by the rows that a robust fit keeps, the third in the nominal base frame.
    fn models(&self, registered: Estimate, fitted: &Fitted, kept: &[u32], is_robust: bool) -> Models {
        // Positions decide tool and frame; orientations decide only the directions that positions do not determine.
        let Noise { position_m, rotation_rad } = fitted.noise;
        let positions = Noise { position_m, rotation_rad: POSITIONS_FIRST * rotation_rad };
        let again =
            |targets_free| register(&self.registration(kept, positions, targets_free), &self.delivered).0;
        let found = fitted.estimate.without_offsets();
        let calibrated = if self.device_free() {
            let targets = &self.delivered.base_from_target;
            let motion = gauge::base_motion(&found, self.robot, targets, self.length_m);
            found.rebased(&motion)
        } else {
            found
        };
        Models {
            nominal: again(false),
            registered: if is_robust {
                again(true)
            } else {
                register_again(&self.registration(kept, positions, true), &registered)
            },
            calibrated,
        }
    }

    fn accuracy(&self, models: &Models) -> Accuracy {
        let of = |rows: &[u32]| set_accuracy(self.data, &self.packed, rows, models);
        Accuracy {
            training: of(&self.fit_rows),
            held_out: (!self.held_out_rows.is_empty()).then(|| of(&self.held_out_rows)),
        }
    }

    fn identifiability(&self, fitted: &Fitted, remainder: &Remainder) -> Identifiability {
        let setup = Setup {
            robot: self.robot,
            data: self.data,
            packed: &self.packed,
            rows: &self.fit_rows,
            estimate: &fitted.estimate,
            layout: &fitted.layout,
            noise: fitted.noise,
            length_m: self.length_m,
            device_free: self.device_free(),
        };
        let found = identifiability(&setup, &fitted.normal.gram, remainder.variance);
        Identifiability { effective_unknowns: remainder.effective_unknowns, ..found }
    }

    /// Judges the result in the minimal basis and by the kept rows, whatever the parameterisation and loss of the fit.
    fn trust(&self, fitted: &Fitted, models: &Models, kept: &[u32], is_robust: bool) -> (Trust, Remainder) {
        let (layout, normal) = if fitted.layout.is_minimal() && !is_robust {
            (fitted.layout.clone(), fitted.normal.clone())
        } else {
            fit::minimal(self.data, &self.packed, kept, &models.calibrated, fitted.noise, self.length_m)
        };
        let prior = PriorInformation::new(self.prior.as_ref(), &models.calibrated, &layout, self.length_m);
        let free: Vec<Parameter> = layout.parameters().map(|(parameter, _)| *parameter).collect();
        let mut view = View {
            robot: self.robot,
            data: self.data,
            packed: &self.packed,
            rows: kept,
            free: &free,
            noise: fitted.noise,
            noise_is_stated: noise::is_stated(self.data, self.options),
            prior: &prior,
            variance: 1.0,
            length_m: self.length_m,
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
            base_free: self.device_free(),
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
        let options =
            forensics::DiagnosisOptions { device_free: self.device_free(), calibrated: Some(calibrated) };
        let in_all = || forensics::diagnose(self.robot, data, &data.all_rows(), &options);
        let Some(believed) = believed else { return in_all() };
        let mut found = forensics::diagnose(self.robot, data, believed, &options);
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
        let targets: Vec<usize> = (0..self.data.targets.len()).collect();
        let predicted = PredictedUncertainty { uncertainty, targets: &targets, coverage: &trust.coverage };
        let errors = row_errors(self.data, &self.packed, &self.held_out_rows, calibrated);
        Some(predicted.check(self.robot, self.data, &self.packed, &self.held_out_rows, &errors))
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
        match &robustness.training_rest {
            Some(rest) if !robustness.suspects_many() => {
                doubts(self.data, &robustness.rest(&self.fit_rows), &rest.registered, self.options.frame)
            }
            _ => doubts(self.data, &self.fit_rows, &accuracy.training.registered, self.options.frame),
        }
    }

    /// Different device frames, if a fit with one has larger errors than a robot's own.
    fn frames_apart(&self, fitted: &Fitted, accuracy: &Accuracy) -> Option<FramesApart> {
        let left_m = 1e-3 * accuracy.training.calibrated.position_mm.rms;
        if !self.device_free() || !fit::is_suspicious(left_m, self.length_m) {
            return None;
        }
        frames_apart(&self.frame_search(fitted, left_m))
    }

    fn frame_search(&self, fitted: &Fitted, left_m: f64) -> FrameSearch<'_> {
        FrameSearch {
            robot: self.robot,
            data: self.data,
            packed: &self.packed,
            rows: &self.fit_rows,
            noise: fitted.noise,
            length_m: self.length_m,
            options: self.options,
            left_m,
        }
    }

    /// Change point or drift of the session. Rows held out by chance belong to it as well; rows with a stated set may belong to another.
    fn moved(&self, calibrated: &Estimate, fitted: &Fitted, is_robust: bool) -> Option<Moved> {
        let is_stated = self.data.observations.iter().any(|row| row.set.is_some());
        let rows = if is_stated { self.fit_rows.clone() } else { self.data.all_rows() };
        let (data, packed, device_free) = (self.data, &self.packed, self.device_free());
        // Least squares take a part of a move into the screws; a robust loss does not.
        let again = (device_free && !is_robust).then(|| self.frame_search(fitted, f64::INFINITY));
        moved(&ChangeSearch {
            data,
            packed,
            estimate: calibrated,
            rows: &rows,
            device_free,
            again: again.as_ref(),
        })
    }
}
