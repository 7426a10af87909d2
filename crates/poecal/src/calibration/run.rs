//! A session, ready for a fit, and the fit of its screws.

use std::borrow::Cow;
use std::sync::Arc;

use super::blocks::refuse_frames;
use super::count::check_count;
use super::found::Start;
use super::refused::allowed_corrections;
use super::stations::{check_length, check_stations};
use super::{
    CalibrationOptions, Corrections, DeviceFrameKnowledge, NoiseSource, delivered, estimate_noise, noise,
    split_rows,
};
use crate::error::Result;
use crate::estimate::{Estimate, Packed, Session, Unknowns};
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
        let robot = options.blocks.with_terms(robot, &data, options.gravity)?;
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
