//! A session, ready for a fit, and the fit of its screws.

use std::borrow::Cow;
use std::sync::Arc;

use super::blocks::refuse_frames;
use super::corrections::Geometry;
use super::count::check_count;
use super::fit::Task;
use super::instrument_noise::{ROUNDS, noise_ratios};
use super::located::located;
use super::refused::allowed_corrections;
use super::robust::{self, RobustFit};
use super::stations::{check_length, check_stations};
use super::{
    CalibrationOptions, Corrections, DeviceFrameKnowledge, Formulation, NoiseSource, Robust, delivered,
    estimate_noise, noise, split_rows,
};
use crate::error::Result;
use crate::estimate::{Estimate, Packed, Session, Unknowns};
use crate::gauge;
use crate::measurement::{Dataset, Noise, PoseResidual};
use crate::problem::Prior;
use crate::robot::{Robot, TermGroup, Tolerance};
use crate::start::{Registration, register, register_again};
use crate::threads;

/// A session, ready for a fit.
#[derive(Clone)]
pub(super) struct Run<'a> {
    /// The measurements as they are fitted: those given, or as they would be without what happened.
    pub(super) data: Cow<'a, Dataset>,
    /// The nominal robot.
    pub(super) robot: Robot,
    pub(super) options: CalibrationOptions,
    /// Which terms are fitted beside the screws.
    pub(super) corrections: Corrections,
    /// Joint values of the measurements with their sines and cosines.
    pub(super) packed: Arc<Packed>,
    pub(super) unknowns: Unknowns,
    pub(super) delivered: Estimate,
    /// Prior of the fit.
    pub(super) prior: Option<Prior>,
    pub(super) fit_rows: Vec<u32>,
    pub(super) held_out_rows: Vec<u32>,
    /// Rows that are left out as suspected ones, in order.
    pub(super) left_out: Vec<u32>,
    length_m: f64,
    device_free: bool,
}

/// Device frame and targets with nominal screws, and the noise that they leave.
#[derive(Clone)]
pub(super) struct Start {
    pub(super) registered: Estimate,
    noise: Noise,
    source: NoiseSource,
}

/// The screws fitted, and every row judged by the fit.
pub(super) struct CalibratedFit {
    pub(super) start: Start,
    pub(super) robust: RobustFit,
    /// Noise of each instrument in units of the first one's; empty if all are alike.
    pub(super) noise_ratios: Vec<Noise>,
    /// The calibrated model: the fit in the nominal base frame, with the frames of all stations.
    pub(super) calibrated: Estimate,
}

impl<'a> Run<'a> {
    /// Splits the rows; refuses problems that cannot be fitted. The rows `left_out`, in order, are suspected from the beginning.
    pub(super) fn new(
        robot: &Robot,
        data: Cow<'a, Dataset>,
        options: &CalibrationOptions,
        left_out: Vec<u32>,
    ) -> Result<Self> {
        let data = written(data, options.formulation.pose_residual);
        let robot = about_mean_factors(robot, &data);
        let packed = Arc::new(threads::in_pool(data.len(), || Packed::of(&robot, &data)));
        if options.frame == DeviceFrameKnowledge::Base {
            refuse_frames(&options.blocks, &robot, &data)?;
        }
        let unknowns = options.blocks.unknowns(&robot, &data)?;
        let device_free = options.frame == DeviceFrameKnowledge::Unknown
            && (0..data.station_count()).any(|station| unknowns.moves_frame(station));
        let session = Session::new(&robot, &data, &packed, device_free).with_unknowns(&unknowns);
        let (fit_rows, held_out_rows) = threads::in_pool(data.len(), || split_rows(&data, options))?;
        check_stations(&data, [&fit_rows, &held_out_rows], options, &unknowns)?;
        check_count(&session, &fit_rows)?;
        check_length(&session, options, &fit_rows)?;
        Ok(Run {
            corrections: allowed_corrections(&robot, &unknowns, options)?,
            delivered: delivered(&robot, &data),
            prior: options.prior(&session),
            length_m: session.length_m,
            options: options.clone(),
            fit_rows,
            held_out_rows,
            left_out,
            device_free,
            packed,
            data,
            robot,
            unknowns,
        })
    }

    /// The same with another tolerance.
    pub(super) fn with_tolerance(&self, tolerance: Tolerance) -> Self {
        let options = CalibrationOptions { tolerance: Some(tolerance), ..self.options.clone() };
        Run { prior: options.prior(&self.session(&[])), options, ..self.clone() }
    }

    /// The same with these rows left out, in order.
    pub(super) fn leaving_out(&self, left_out: Vec<u32>) -> Self {
        Run { left_out, ..self.clone() }
    }

    /// Robot and measurements, with the noises of the instruments.
    pub(super) fn session<'s>(&'s self, noise_ratios: &'s [Noise]) -> Session<'s> {
        let Run { robot, data, packed, length_m, device_free, unknowns, .. } = self;
        Session {
            robot,
            data,
            packed,
            length_m: *length_m,
            device_free: *device_free,
            noise_ratios,
            unknowns,
        }
    }

    /// Runs a step on a thread of the pool.
    pub(super) fn in_pool<T: Send>(&self, step: impl FnOnce() -> T + Send) -> T {
        threads::in_pool(self.data.len(), step)
    }

    /// A fit, as corrections begin with it.
    pub(super) fn geometry<'s>(&'s self, fit: &'s CalibratedFit) -> Geometry<'s> {
        Geometry {
            session: self.session(&fit.noise_ratios),
            options: &self.options,
            estimate: &fit.calibrated,
            noise: fit.robust.fitted.noise,
            noise_source: fit.robust.fitted.noise_source,
            loss: fit.robust.loss,
            judged: &fit.robust.judged.rows,
            fit_rows: &self.fit_rows,
            held_out_rows: &self.held_out_rows,
        }
    }

    pub(super) fn registration<'s>(
        &'s self,
        session: Session<'s>,
        rows: &'s [u32],
        noise: Noise,
        targets_free: bool,
    ) -> Registration<'s> {
        Registration { session, rows, noise, targets_free, prior: self.prior.as_ref().map(|it| (it, 1.0)) }
    }

    /// Device frame and targets with nominal screws, and the noise estimated from their residuals unless stated.
    pub(super) fn register(&self) -> Start {
        self.in_pool(|| {
            let session = self.session(&[]);
            let (mut noise, source) = noise::first_guess(&self.data, &self.options);
            let of = |noise| self.registration(session, &self.fit_rows, noise, true);
            let (registered, _) = register(&of(noise), &self.delivered);
            if source == NoiseSource::Estimated
                && let Some(found) = estimate_noise(&session, &self.fit_rows, &registered, 6.0, None, noise)
            {
                noise = noise::stated(&self.options, found);
            }
            let registered = register_again(&of(noise).weighed_by(&registered), &registered);
            Start { registered, noise, source }
        })
    }

    /// Fits the screws; where several instruments have different noises, again with these until they do not change.
    pub(super) fn fit(&self, start: Start) -> Result<CalibratedFit> {
        let mut ratios = Vec::new();
        let mut fit = self.fit_with(&ratios, &start, self.options.robust)?;
        let is_open = start.source == NoiseSource::Estimated && self.data.station_count() > 1;
        for _ in 0..if is_open { ROUNDS } else { 0 } {
            let Some(found) = noise_ratios(&self.session(&ratios), &self.fit_rows, &fit) else { break };
            ratios = found;
            let again = Start { noise: fit.fitted.noise, ..start.clone() };
            fit = self.fit_with(&ratios, &again, self.options.robust)?;
        }
        let calibrated = self.calibrated(&fit, &ratios);
        Ok(CalibratedFit { start, robust: fit, noise_ratios: ratios, calibrated })
    }

    /// The fit with other rows suspected; of all rows at full weight where none is.
    pub(super) fn suspecting(&self, fit: CalibratedFit, suspected: &[bool]) -> Result<CalibratedFit> {
        if suspected.contains(&true) {
            return Ok(CalibratedFit { robust: fit.robust.suspecting(suspected), ..fit });
        }
        let robust = self.fit_with(&fit.noise_ratios, &fit.start, Robust::Off)?.suspecting(suspected);
        Ok(CalibratedFit { calibrated: self.calibrated(&robust, &fit.noise_ratios), robust, ..fit })
    }

    /// One fit of the screws.
    fn fit_with(&self, ratios: &[Noise], start: &Start, robust: Robust) -> Result<RobustFit> {
        let session = self.session(ratios);
        let Start { registered, noise, source } = start;
        let options = CalibrationOptions { robust, ..self.options.clone() };
        let (rows, prior) = (&self.fit_rows, self.prior.as_ref().map(|prior| (prior, 1.0)));
        let task = Task { session, rows, weights: None, prior, options: &options };
        self.in_pool(|| {
            if !self.left_out.is_empty() {
                return robust::fit_without(&task, registered, (*noise, *source), &self.left_out);
            }
            robust::fit(&task, &self.registration(session, rows, *noise, true), registered, *source)
        })
    }

    /// The calibrated model of a fit.
    fn calibrated(&self, fit: &RobustFit, ratios: &[Noise]) -> Estimate {
        let session = self.session(ratios);
        // Offsets that were asked for stay; those of a formulation are a way to write the screws.
        let found = if self.options.formulation == Formulation::default() {
            fit.fitted.estimate.clone()
        } else {
            fit.fitted.estimate.without_offsets()
        };
        let found = if session.base_free() {
            let targets = &self.delivered.base_from_target;
            let motion = gauge::base_motion(&found, &self.robot, targets, self.length_m);
            found.rebased(&motion)
        } else {
            found
        };
        located(&session, &self.fit_rows, &found, fit.fitted.noise).into_owned()
    }
}

/// The robot with its factors counted from their mean in all rows; the side of an approach and a payload from 0.
fn about_mean_factors(robot: &Robot, data: &Dataset) -> Robot {
    let mut found = robot.clone();
    if data.is_empty() {
        return found;
    }
    for (at, factor) in
        found.factors.iter_mut().enumerate().filter(|(_, it)| it.group() == TermGroup::Factors)
    {
        let values = (0..data.len()).filter_map(|row| robot.factors_of(data.readings(row)).get(at));
        factor.reference = values.sum::<f64>() / data.len() as f64;
    }
    found
}

/// The data with the residual of measured frames replaced.
pub(super) fn written<'a>(
    data: Cow<'a, Dataset>,
    pose_residual: Option<&'static dyn PoseResidual>,
) -> Cow<'a, Dataset> {
    if data.pose_residual == pose_residual {
        return data;
    }
    let mut written = data.into_owned();
    written.write_poses_by(pose_residual);
    Cow::Owned(written)
}
