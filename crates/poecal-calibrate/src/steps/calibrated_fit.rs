//! The fit of the screws, and every row judged by it.

use std::borrow::Cow;

use super::fit_progress::RegisteredStart;
use crate::pictures::optics::Optics;
use crate::robust::{self, RobustFit};
use crate::run::CalibrationRun;
use crate::run::instrument_noise::{ROUNDS, noise_ratios};
use crate::run::station_frames::locate_stations;
use crate::run::task::FitTask;
use crate::{CalibrationOptions, Formulation, NoiseSource, RobustLoss, Robustness, RowJudgement, pictures};
use poecal_fit::gauge;
use poecal_fit::state::{Estimate, Session};
use poecal_model::measurement::Noise;
use poecal_numerics::error::Result;

/// A session with its screws fitted.
pub(crate) struct CalibratedFit<'a> {
    pub(crate) run: CalibrationRun<'a>,
    pub(crate) start: RegisteredStart,
    /// The fit, and the judgement of every row.
    pub(crate) robust: RobustFit,
    /// Noise of each instrument in units of the first one's; empty if all are alike.
    pub(crate) noise_ratios: Vec<Noise>,
    /// Fitted unknowns of cameras and boards.
    pub(crate) optics: Option<Optics>,
    /// The calibrated model: the fit in the nominal base frame, with the frames of all stations.
    pub(crate) estimate: Estimate,
}

impl<'a> CalibrationRun<'a> {
    /// Fits the screws; if several instruments have different noises, repeats with these until they do not change.
    pub(crate) fn fit(mut self, mut start: RegisteredStart) -> Result<CalibratedFit<'a>> {
        let mut ratios = Vec::new();
        let mut fit = self.fit_with(&ratios, &start, self.options.robust)?;
        // A loop if the rows leave the positions of targets undetermined: the narrowest prior that they do not contradict.
        if let Some(narrowed) = self.with_narrower_targets(&fit) {
            (self, start, fit) = (narrowed.run, narrowed.start, narrowed.fit);
        }
        let is_open = start.source == NoiseSource::Estimated && self.data.station_count() > 1;
        for _ in 0..if is_open { ROUNDS } else { 0 } {
            let Some(found) = noise_ratios(&self.session(&ratios), &self.fit_rows, &fit) else { break };
            ratios = found;
            let again = RegisteredStart { noise: fit.fitted.noise, ..start.clone() };
            fit = self.fit_with(&ratios, &again, self.options.robust)?;
        }
        // A loop if there are pictures: fit, common error of their corners, fit.
        let (mut optics, mut pace) = (Optics::from_run(&self), pictures::RoundPace::default());
        for _ in 0..pictures::ROUNDS {
            let Some(data) = self.renewed_pictures(&ratios, &fit, (&mut optics, &mut pace)) else { break };
            self.data = Cow::Owned(data);
            start = self.register();
            fit = self.fit_with(&ratios, &start, self.options.robust)?;
        }
        if let Some(optics) = &optics {
            self.data.to_mut().pictures.found = optics.numbers();
        }
        let estimate = self.calibrated_estimate(&fit, &ratios);
        Ok(CalibratedFit { run: self, start, robust: fit, noise_ratios: ratios, optics, estimate })
    }

    /// One fit of the screws.
    pub(crate) fn fit_with(&self, ratios: &[Noise], start: &RegisteredStart, robust: RobustLoss) -> Result<RobustFit> {
        let (session, rows) = (self.session(ratios), &self.fit_rows);
        let options = CalibrationOptions { robust, ..self.options.clone() };
        let prior = self.prior.as_ref().map(|prior| (prior, 1.0));
        let task = FitTask { session, rows, weights: None, prior, options: &options };
        self.in_pool(|| {
            if !self.left_out.is_empty() {
                return robust::fit_without(&task, start, &self.left_out);
            }
            robust::fit(&task, &self.registration(session, rows, start.noise, true), start)
        })
    }

    /// The calibrated model of a fit.
    fn calibrated_estimate(&self, fit: &RobustFit, ratios: &[Noise]) -> Estimate {
        let session = self.session(ratios);
        // Requested offsets stay; those of a formulation are only its parameterisation of the screws.
        let found = if self.options.formulation == Formulation::default() {
            fit.fitted.estimate.clone()
        } else {
            fit.fitted.estimate.without_offsets()
        };
        let found = if session.base_free() {
            let targets = &self.delivered.base_from_target;
            let motion = gauge::base_motion(&found, &self.robot, targets, session.length_m);
            found.rebase(&motion)
        } else {
            found
        };
        locate_stations(&session, &self.fit_rows, &found, fit.fitted.noise).into_owned()
    }
}

impl CalibratedFit<'_> {
    /// Robot and measurements, with the noises of the instruments.
    pub(crate) fn session(&self) -> Session<'_> {
        self.run.session(&self.noise_ratios)
    }

    /// Reach of the robot, metres.
    pub(crate) fn reach_m(&self) -> f64 {
        3.0 * self.session().length_m
    }

    /// Noise by which residuals of rows without a stated noise were whitened.
    pub(crate) fn noise(&self) -> Noise {
        self.robust.fitted.noise
    }

    /// Weights of all rows of the data after a robust fit: those of a requested loss; otherwise only suspected rows lose their weight.
    pub(crate) fn weights(&self) -> Option<Vec<f64>> {
        let is_chosen = matches!(self.run.options.robust, RobustLoss::Loss(_));
        let weight = |row: &RowJudgement| if row.suspected || is_chosen { row.weight } else { 1.0 };
        let Robustness { loss, rows, .. } = &self.robust.robustness;
        loss.map(|_| rows.iter().map(weight).collect())
    }

    /// The fitted rows that have a weight: the others do not inform the noise either.
    pub(crate) fn weighted_rows(&self) -> Vec<u32> {
        let weights = self.weights();
        let weight = |row: u32| weights.as_ref().and_then(|it| it.get(row as usize));
        let counts = |row: &u32| weight(*row).is_none_or(|weight| *weight > 0.0);
        self.run.fit_rows.iter().copied().filter(counts).collect()
    }

    /// The fit with other rows suspected; without any, of all rows at full weight.
    pub(crate) fn refit_with_suspects(self, suspected: &[bool]) -> Result<Self> {
        if suspected.contains(&true) {
            return Ok(self.with_suspects(suspected));
        }
        let CalibratedFit { run, start, noise_ratios, optics, .. } = self;
        let robust = run.fit_with(&noise_ratios, &start, RobustLoss::Off)?;
        let estimate = run.calibrated_estimate(&robust, &noise_ratios);
        Ok(CalibratedFit { run, start, robust, noise_ratios, optics, estimate }.with_suspects(suspected))
    }

    fn with_suspects(mut self, suspected: &[bool]) -> Self {
        self.robust.robustness = self.robust.robustness.with_suspects(suspected);
        self
    }
}
