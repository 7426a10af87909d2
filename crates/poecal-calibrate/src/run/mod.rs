//! A session, ready for a fit, and the fit of its screws.

pub(crate) mod accuracy;
pub(crate) mod blocks;
pub(crate) mod calibrated_places;
pub(crate) mod count;
pub(crate) mod fit;
pub(crate) mod formulation;
pub(crate) mod instrument_noise;
pub(crate) mod noise;
pub(crate) mod option_conflicts;
pub(crate) mod options;
pub(crate) mod pixels;
pub(crate) mod prior_bias;
pub(crate) mod restart;
pub(crate) mod rounding;
mod ruinous_rows;
pub(crate) mod split;
pub(crate) mod stage;
pub(crate) mod station_frames;
pub(crate) mod stations;
pub(crate) mod target_prior;
pub(crate) mod task;

use std::borrow::Cow;
use std::sync::Arc;

use super::{
    CalibrationOptions, Corrections, DeviceFrameKnowledge, NoiseSource, estimate_noise, nominal_estimate, split_rows,
};
use crate::run::blocks::refuse_frames;
use crate::run::count::check_count;
use crate::run::option_conflicts::allowed_corrections;
use crate::run::stations::{check_length, check_stations};
use crate::steps::fit_progress::RegisteredStart;
use poecal_fit::problem::Prior;
use poecal_fit::start::{Registration, register, register_again};
use poecal_fit::state::{Estimate, PackedValues, Session, Unknowns};
use poecal_model::measurement::{Dataset, Noise, PoseResidual};
use poecal_model::robot::{Robot, TermGroup, Tolerance};
use poecal_numerics::error::Result;
use poecal_numerics::threads;

/// A session, ready for a fit.
#[derive(Clone)]
pub(crate) struct CalibrationRun<'a> {
    /// The measurements as they are fitted: the supplied ones, or as they would be without events.
    pub(crate) data: Cow<'a, Dataset>,
    /// The nominal robot.
    pub(crate) robot: Robot,
    pub(crate) options: CalibrationOptions,
    /// Terms that are fitted beside the screws.
    pub(crate) corrections: Corrections,
    /// Joint values of the measurements with their sines and cosines.
    pub(crate) packed: Arc<PackedValues>,
    pub(crate) unknowns: Unknowns,
    pub(crate) delivered: Estimate,
    /// Prior of the fit.
    pub(crate) prior: Option<Prior>,
    pub(crate) fit_rows: Vec<u32>,
    pub(crate) held_out_rows: Vec<u32>,
    /// Standard deviation of the positions of targets by the rows, metres, if these leave them undetermined and a narrower prior was used.
    pub(crate) open_targets_m: Option<f64>,
    /// Rows that are left out as suspected, in order.
    pub(crate) left_out: Vec<u32>,
    length_m: f64,
    device_free: bool,
}

/// The nominal estimate, with held frames as in an earlier calibration.
fn initial_estimate(robot: &Robot, data: &Dataset, (options, unknowns): (&CalibrationOptions, &Unknowns)) -> Estimate {
    let mut start = nominal_estimate(robot, data);
    for (station, device) in options.devices.iter().enumerate().take(data.station_count()) {
        if !unknowns.moves_frame(station) {
            *start.device_mut(station) = device.inverse();
        }
    }
    start
}

impl<'a> CalibrationRun<'a> {
    /// Splits the rows; refuses problems that cannot be fitted. The rows `left_out`, in order, are suspected from the beginning.
    pub(crate) fn new(
        robot: &Robot,
        data: Cow<'a, Dataset>,
        options: &CalibrationOptions,
        left_out: Vec<u32>,
    ) -> Result<Self> {
        let data = formulate_data(data, options.formulation.pose_residual);
        let robot = about_mean_factors(robot, &data);
        let robot = options.blocks.with_terms(robot, &data, options.gravity)?;
        let packed = Arc::new(threads::in_pool(data.len(), || PackedValues::from_dataset(&robot, &data)));
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
        Ok(CalibrationRun {
            corrections: allowed_corrections(&robot, &unknowns, options)?,
            delivered: initial_estimate(&robot, &data, (options, &unknowns)),
            prior: options.prior(&session),
            length_m: session.length_m,
            open_targets_m: None,
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
    pub(crate) fn with_tolerance(&self, tolerance: Tolerance) -> Self {
        let options = CalibrationOptions { tolerance: Some(tolerance), ..self.options.clone() };
        CalibrationRun { prior: options.prior(&self.session(&[])), options, ..self.clone() }
    }

    /// The same with these rows left out, in order.
    pub(crate) fn leaving_out(&self, left_out: Vec<u32>) -> Self {
        CalibrationRun { left_out, ..self.clone() }
    }

    /// Robot and measurements, with the noises of the instruments.
    pub(crate) fn session<'s>(&'s self, noise_ratios: &'s [Noise]) -> Session<'s> {
        let CalibrationRun { robot, data, packed, length_m, device_free, unknowns, .. } = self;
        Session { robot, data, packed, length_m: *length_m, device_free: *device_free, noise_ratios, unknowns }
    }

    /// Runs a step on a thread of the pool.
    pub(crate) fn in_pool<T: Send>(&self, step: impl FnOnce() -> T + Send) -> T {
        threads::in_pool(self.data.len(), step)
    }

    pub(crate) fn registration<'s>(
        &'s self,
        session: Session<'s>,
        rows: &'s [u32],
        noise: Noise,
        targets_free: bool,
    ) -> Registration<'s> {
        Registration { session, rows, noise, targets_free, prior: self.prior.as_ref().map(|it| (it, 1.0)) }
    }

    /// Device frame and targets with nominal screws, and the noise estimated from their residuals unless stated.
    pub(crate) fn register(&self) -> RegisteredStart {
        self.register_by(&self.fit_rows)
    }

    /// The same by some of the rows.
    fn register_by(&self, rows: &[u32]) -> RegisteredStart {
        self.in_pool(|| {
            let session = self.session(&[]);
            let (mut noise, source) = noise::first_guess(&self.data, &self.options);
            let of = |noise| self.registration(session, rows, noise, true);
            let (registered, _) = register(&of(noise), &self.delivered);
            if source == NoiseSource::Estimated
                && let Some(found) = estimate_noise(&session, rows, &registered, 6.0, None, noise)
            {
                noise = noise::merge_stated_noise(&self.options, found);
            }
            let registered = register_again(&of(noise).weighed_by(&registered), &registered);
            RegisteredStart { registered, noise, source }
        })
    }
}

/// The robot with its factors relative to their mean in all rows; the side of an approach and a payload relative to 0.
fn about_mean_factors(robot: &Robot, data: &Dataset) -> Robot {
    let mut found = robot.clone();
    if data.is_empty() {
        return found;
    }
    for (at, factor) in found.factors.iter_mut().enumerate().filter(|(_, it)| it.group() == TermGroup::Factors) {
        let values = (0..data.len()).filter_map(|row| robot.factors_of(data.readings(row)).get(at));
        factor.reference = values.sum::<f64>() / data.len() as f64;
    }
    found
}

/// The data with the residual of measured frames replaced.
pub(crate) fn formulate_data<'a>(
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
