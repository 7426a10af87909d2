//! From a robot and measurements to a calibrated robot: the steps by name.

mod accuracy;
mod blocks;
mod corrections;
mod count;
mod coverage_check;
mod doubts;
mod fit;
mod formulation;
mod found;
mod instrument_noise;
mod judge;
mod moves;
mod noise;
mod noise_doubts;
mod options;
mod repeatability;
mod result;
mod robust;
mod split;
mod stations;
mod steps;
mod suspicion;
mod trust;
mod verdict;

pub use accuracy::{Accuracy, ModelAccuracy, Models, SetAccuracy, Statistic, set_accuracy};
pub use blocks::BlockChoice;
pub(crate) use blocks::names;
pub use corrections::{Correction, CorrectionModel, Sizes, TermGroup, TriedSizes, correct};
pub use coverage_check::{CoverageCheck, InSampledRange, PartCoverage, PredictedUncertainty};
pub use fit::fit_screws;
pub use formulation::{Formulation, FormulationWords, Minimize, Minimum};
pub use found::SolverReport;
pub use judge::{Judgement, Refitted, Subject, judge};
pub use noise::{NoiseSource, estimate_noise};
pub use options::{CalibrationOptions, DeviceFrameKnowledge};
pub use repeatability::{RepeatedPose, repeatability};
pub use result::{CalibratedStation, CalibratedTarget, Calibration};
pub(crate) use robust::RowInfluence;
pub use robust::{Loss, Robust, Robustness, RowJudgement, row_influence};
pub use split::{settle_sets, split_rows};
pub use suspicion::JointCorrection;
pub use trust::{Expected, RangePart, Trust};
pub use verdict::{Level, Verdict};

pub use crate::estimate::{RowError, delivered, radian_m};

use std::borrow::Cow;
use std::sync::Arc;

use crate::error::Result;
use crate::estimate::{Packed, Session};
use crate::measurement::{Dataset, PoseResidual};
use crate::robot::Robot;
use crate::threads;
use steps::Prepared;

/// Calibrates a robot from measurements.
///
/// # Errors
/// [`ErrorKind::Problem`](crate::ErrorKind::Problem) if there are too few measurements,
/// [`ErrorKind::Option`](crate::ErrorKind::Option) for options out of range, [`ErrorKind::Solver`](crate::ErrorKind::Solver)
/// if no finite result could be reached.
pub fn calibrate(robot: &Robot, data: &Dataset, options: &CalibrationOptions) -> Result<Calibration> {
    calibrate_with_progress(robot, data, options, &mut |_| {})
}

/// A step of a calibration, for progress messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Fitting device frame and targets.
    Registration,
    /// Fitting the screws.
    Fit,
    /// Judging the three models.
    Analysis,
}

impl Stage {
    /// All stages in order.
    pub const ALL: [Stage; 3] = [Stage::Registration, Stage::Fit, Stage::Analysis];

    /// Message for users.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Stage::Registration => "finding the device frame and the targets",
            Stage::Fit => "fitting the screws",
            Stage::Analysis => "judging the result",
        }
    }
}

/// [`calibrate`], reporting each stage as it begins.
///
/// # Errors
/// As [`calibrate`].
pub fn calibrate_with_progress(
    robot: &Robot,
    data: &Dataset,
    options: &CalibrationOptions,
    progress: &mut dyn FnMut(Stage),
) -> Result<Calibration> {
    let (data, rows) = (&written(data, options.formulation.pose_residual), data.len());
    let packed = Arc::new(threads::in_pool(rows, || Packed::of(robot, data)));
    if options.frame == DeviceFrameKnowledge::Base {
        blocks::refuse_frames(&options.blocks, robot, data)?;
    }
    let unknowns = options.blocks.unknowns(robot, data)?;
    let device_free = options.frame == DeviceFrameKnowledge::Unknown
        && (0..data.station_count()).any(|station| unknowns.moves_frame(station));
    let session = Session::new(robot, data, &packed, device_free).with_unknowns(&unknowns);
    let prepared = threads::in_pool(rows, || Prepared::new(session, options))?;
    progress(Stage::Registration);
    let (registered, noise, source) = threads::in_pool(rows, || prepared.register());
    progress(Stage::Fit);
    let fit = threads::in_pool(rows, || prepared.fit(&registered, noise, source))?;
    prepared.with_instruments(&registered, fit, source, &mut |prepared, fit| {
        progress(Stage::Analysis);
        threads::in_pool(rows, || prepared.assess(Arc::clone(&packed), registered.clone(), fit))
    })
}

/// The data with the residual of measured frames replaced.
fn written<'a>(data: &'a Dataset, pose_residual: Option<&'static dyn PoseResidual>) -> Cow<'a, Dataset> {
    if data.pose_residual == pose_residual {
        return Cow::Borrowed(data);
    }
    let mut written = data.clone();
    written.write_poses_by(pose_residual);
    Cow::Owned(written)
}

/// A number of measurements in words.
fn measurements_words(count: usize) -> String {
    if count == 1 { "1 measurement".to_owned() } else { format!("{count} measurements") }
}
