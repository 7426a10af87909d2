//! From a robot and measurements to a calibrated robot: the steps by name.

mod acceptance;
mod accepted;
mod accuracy;
mod blocks;
mod changes;
mod corrections;
mod count;
mod coverage_check;
mod doubts;
mod events;
mod expected;
mod finished;
mod fit;
mod formulation;
mod found;
mod improvement;
mod instrument_noise;
mod judge;
mod located;
mod moves;
mod noise;
mod noise_doubts;
mod options;
mod placed;
mod repeatability;
mod result;
mod robust;
mod rounding;
mod split;
mod stations;
mod steps;
mod suspicion;
mod together;
mod tolerance;
mod trust;
mod verdict;
mod workspace;

pub use crate::robot::{CorrectionModel, Corrections, Sizes, TermGroup};
pub use acceptance::{
    Acceptance, AcceptanceLimits, AcceptedLimit, AcceptedModel, AcceptedRows, AcceptedStatistic, Decision,
    Limit,
};
use accepted::accepted;
pub use accepted::accepted_by;
pub use accuracy::{
    Accuracy, Improvement, Improvements, ModelAccuracy, Models, SetAccuracy, Statistic, set_accuracy,
};
pub use blocks::BlockChoice;
pub(crate) use blocks::names;
use corrections::suspected;
pub use corrections::{
    Correction, Effects, JointEffect, JointErrorPart, JointErrors, SizesReason, TriedSizes, correct,
};
pub use coverage_check::{
    CoverageCheck, InSampledRange, JudgedError, JudgedRow, PartCoverage, PredictedUncertainty, Promise,
};
pub(crate) use events::family;
pub use events::{Event, EventKind, Repaired, Repairs, calibrate_repairing};
pub use expected::{Expectations, Expected, RangePart};
pub use fit::fit_screws;
pub use formulation::{Formulation, FormulationWords, Minimize, Minimum};
pub use found::SolverReport;
pub use judge::{DeliveredModel, JudgedModel, Judgement, MovedDevice, Refitted, Subject, judge};
pub use noise::{NoiseSource, estimate_noise};
pub use options::{CalibrationOptions, DeviceFrameKnowledge};
pub use placed::{CalibratedStation, CalibratedTarget};
pub use repeatability::{RepeatedPose, repeatability};
pub use result::Calibration;
pub(crate) use robust::RowInfluence;
pub use robust::{Loss, Robust, Robustness, RowJudgement, row_influence};
pub use split::{settle_sets, split_rows};
pub use suspicion::JointCorrection;
pub use together::CommonDirection;
pub use trust::Trust;
pub use verdict::{Level, Verdict};
pub(crate) use workspace::{Displacements, Spread, Workspace, workspace};

pub use crate::estimate::{RowError, delivered, radian_m};

use std::borrow::Cow;
use std::sync::Arc;

use crate::error::{Error, ErrorKind, Result};
use crate::estimate::{Packed, Session};
use crate::measurement::{Dataset, PoseResidual};
use crate::robot::{GravityDirection, Robot};
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
    /// Fitting what joints do beyond geometry.
    Corrections,
}

impl Stage {
    /// All stages in order.
    pub const ALL: [Stage; 4] = [Stage::Registration, Stage::Fit, Stage::Analysis, Stage::Corrections];

    /// Message for users.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Stage::Registration => "finding the device frame and the targets",
            Stage::Fit => "fitting the screws",
            Stage::Analysis => "judging the result",
            Stage::Corrections => "fitting what the joints do beyond geometry",
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
    fitted(robot, data, options, Searched::Plainly, progress)
}

/// How a session is searched for what happened in it.
#[derive(Clone, Copy)]
enum Searched<'a> {
    /// By the residuals of geometry alone.
    Plainly,
    /// By the corrected model, afterwards; these rows, in order, are left out as suspected ones.
    Afterwards(&'a [u32]),
}

/// [`calibrate_with_progress`], with the session searched so.
fn fitted(
    robot: &Robot,
    data: &Dataset,
    options: &CalibrationOptions,
    searched: Searched<'_>,
    progress: &mut dyn FnMut(Stage),
) -> Result<Calibration> {
    if let GravityDirection::Known(direction) = options.gravity
        && !GravityDirection::is_direction(&direction)
    {
        let message = "found a gravity without direction, expected three numbers, not all of them 0";
        return Err(Error::new(ErrorKind::Option, message));
    }
    if let Some(name) = data.targets.iter().flatten().next().filter(|_| options.move_tip) {
        let message = format!(
            "found --move-tip beside rows of the target `{name}`, expected rows without a name: leave the column `target` out, or the option"
        );
        return Err(Error::new(ErrorKind::Option, message));
    }
    if options.formulation != Formulation::default() {
        refuse_beside_formulation(options)?;
    }
    if options.chooses_tolerance {
        let tolerance = tolerance::chosen(options, |options| calibrate(robot, data, options))?;
        let options =
            CalibrationOptions { tolerance: Some(tolerance), chooses_tolerance: false, ..options.clone() };
        let found = fitted(robot, data, &options, searched, progress)?;
        return Ok(Calibration { chosen_tolerance: Some(tolerance), ..found });
    }
    let left_out = match searched {
        Searched::Plainly => &[][..],
        Searched::Afterwards(left_out) => left_out,
    };
    let (data, rows) = (&written(data, options.formulation.pose_residual), data.len());
    let robot = &*options.blocks.with_terms(about_mean_factors(robot, data), data, options.gravity)?;
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
    let fit = threads::in_pool(rows, || prepared.fit(&registered, noise, source, left_out))?;
    refuse_without_factors(robot, options)?;
    // Terms beside screws that are held or written otherwise would do what the screws do not.
    let moves_all = (0..robot.joints.len()).all(|joint| unknowns.moves_axis(joint));
    let sizes = match options.corrections {
        Corrections::Auto | Corrections::All if moves_all => Some(None),
        Corrections::All => {
            let message = "found corrections `all` beside axes that are held, expected all axes fitted, or groups of terms by name";
            return Err(Error::new(ErrorKind::Option, message));
        }
        Corrections::Sizes(sizes) => Some(Some(sizes)),
        Corrections::Auto | Corrections::Off => None,
    };
    let sizes = sizes.filter(|_| options.formulation == Formulation::default());
    let finds_moves = sizes.is_none() || matches!(searched, Searched::Plainly);
    let mut found =
        prepared.with_instruments(&registered, fit, (source, left_out), &mut |prepared, fit| {
            progress(Stage::Analysis);
            let assess =
                |fit| prepared.clone().assess(Arc::clone(&packed), registered.clone(), fit, finds_moves);
            let mut calibration = threads::in_pool(rows, || assess(fit.clone()));
            let Some(sizes) = sizes else { return Ok(calibration) };
            progress(Stage::Corrections);
            let correct = |calibration: &Calibration| {
                threads::in_pool(rows, || correct(calibration, data, options.gravity, sizes, options))
            };
            let mut found = correct(&calibration);
            // What joints do beyond geometry makes no outliers.
            for _ in 0..JUDGEMENTS {
                if options.robust != Robust::Auto
                    || !left_out.is_empty()
                    || calibration.robustness.suspects().next().is_none()
                {
                    break;
                }
                let suspected = suspected(&found, &calibration, data, options);
                if !calibration.robustness.differs(&suspected) {
                    break;
                }
                let again = if suspected.contains(&true) {
                    fit.clone()
                } else {
                    threads::in_pool(rows, || prepared.fit_all(&registered, noise, source))?
                };
                calibration = threads::in_pool(rows, || assess(again.suspecting(&suspected)));
                found = correct(&calibration);
            }
            Ok(threads::in_pool(rows, || prepared.beside(calibration, &found)).with_correction(found))
        })?;
    if let Some(improvement) = improvement::improvements(&found, data)
        && let Some(set) = &mut found.accuracy.held_out
    {
        set.improvement = Some(improvement);
    }
    if let Some(accept) = &options.accept {
        found.acceptance = Some(accepted(&found, data, accept)?);
    }
    Ok(found)
}

/// Refuses groups of terms that depend on columns that are not read.
fn refuse_without_factors(robot: &Robot, options: &CalibrationOptions) -> Result<()> {
    let Corrections::Sizes(sizes) = options.corrections else { return Ok(()) };
    let needed = [
        (TermGroup::Backlash, "approach or approach_JOINT"),
        (TermGroup::Payload, "payload"),
        (TermGroup::Factors, "temperature or another column"),
    ];
    for (group, column) in needed {
        if sizes[group] > 0.0 && !robot.factors.iter().any(|it| it.group() == group) {
            let message = format!(
                "found {} among the corrections and no factor for it, expected {column} among the factors (--factors)",
                group.name()
            );
            return Err(Error::new(ErrorKind::Option, message));
        }
    }
    Ok(())
}

/// Refuses what only the usual formulation has.
fn refuse_beside_formulation(options: &CalibrationOptions) -> Result<()> {
    let found = if matches!(options.corrections, Corrections::All | Corrections::Sizes(_)) {
        "terms of the joints (corrections)"
    } else if options.gravity != GravityDirection::default() {
        "a direction of gravity"
    } else if options.chooses_tolerance {
        "a tolerance that cross-validation chooses"
    } else {
        return Ok(());
    };
    let message = format!(
        "found {found} with a formulation of its own, expected the usual formulation: leave one of both out"
    );
    Err(Error::new(ErrorKind::Option, message))
}

/// Most rounds of judging rows by the corrected model.
const JUDGEMENTS: usize = 3;

/// The robot with its factors counted from their mean in all rows; the side of an approach and a payload from 0.
fn about_mean_factors<'a>(robot: &'a Robot, data: &Dataset) -> Cow<'a, Robot> {
    if robot.factors.is_empty() || data.is_empty() {
        return Cow::Borrowed(robot);
    }
    let mut found = robot.clone();
    for (at, factor) in
        found.factors.iter_mut().enumerate().filter(|(_, it)| it.group() == TermGroup::Factors)
    {
        let values = (0..data.len()).filter_map(|row| robot.factors_of(data.readings(row)).get(at));
        factor.reference = values.sum::<f64>() / data.len() as f64;
    }
    Cow::Owned(found)
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
