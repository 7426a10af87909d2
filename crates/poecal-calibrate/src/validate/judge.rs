//! A finished calibration judged by other measurements.

use serde::Serialize;

use crate::acceptance::{Acceptance, AcceptedModel};
use crate::run::accuracy::{Improvement, ModelAccuracy, model_accuracy};
use crate::run::count::{measurements_words, of_device};
use crate::steps::improvement::paired_improvement;
use crate::steps::repeatability::{RepeatScatter, repeat_scatter};
use crate::trust::coverage_check::{
    CoverageCheck, JudgedPredictions, JudgedRow, PredictedUncertainty, SampledRangeErrors, coverage_checks,
    promised_rows,
};
use crate::{DeviceFrameKnowledge, corner_error, nominal_estimate};
use poecal_arm::lie::{Freedom, Pose};
use poecal_fit::problem::MOST_UNKNOWNS;
use poecal_fit::start::{Registration, free_parameters, register};
use poecal_fit::state::{PackedValues, RangeModel, Session};
use poecal_model::measurement::{Dataset, Noise};
use poecal_model::robot::Robot;
use poecal_numerics::error::{ErrorKind, Result};

/// A calibration to be judged, and its parts to be refitted to the judging measurements.
#[derive(Clone, Copy, Debug)]
pub struct JudgedCalibration<'a> {
    /// The calibrated robot with its named targets.
    pub calibrated: &'a Robot,
    /// The nominal robot.
    pub nominal: &'a Robot,
    /// Device frame of the calibration.
    pub base_from_device: Pose,
    /// Device frames of further stations, in the order of the judging measurements.
    pub further_base_from_device: &'a [Pose],
    /// Zeros and scales of the distances of the stations, in that order; empty if all are plain.
    pub ranges: &'a [RangeModel],
    /// Prior knowledge of the device's frame.
    pub frame: DeviceFrameKnowledge,
    /// Noise by which positions and rotations are weighted in a refit.
    pub noise: Noise,
    /// True if the device frame is refitted.
    pub refit_frame: bool,
    /// True if every measured target is refitted.
    pub refit_tool: bool,
    /// Predicted uncertainty of the calibration; for refitted parts, only the screws' part of it counts.
    pub uncertainty: Option<PredictedUncertainty<'a>>,
}

/// A part that was refitted to the validation measurements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RefittedPart {
    /// Device frame.
    DeviceFrame,
    /// Positions of the targets, and their orientations if measured.
    Tool,
}

/// Errors of a calibration on other measurements.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_model::measurement::{MeasuredQuantities, Quantity};
/// #     pub use poecal_calibrate::{Judgement, Statistic};
/// # }
/// use poecal::{MeasuredQuantities, Quantity, Judgement, Statistic};
/// let errors = Statistic { mean: 0.1, rms: 0.11, p95: 0.2, max: 0.25 };
/// let calibrated = MeasuredQuantities::from_fn(|quantity| (quantity == Quantity::Position).then_some(errors));
/// let judgement = Judgement { count: 20, refitted: vec![], calibrated: calibrated.into(), corrected: None, nominal: None, promised: None,
///     in_sampled_range: None, improvement: None, acceptance: None, moved_device: None, repeats: None,
///     base_from_device: poecal_arm::lie::Pose::identity(),
///     rows: vec![] };
/// assert_eq!(judgement.calibrated.position_mm().max, 0.25);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Judgement {
    /// Number of measurements.
    pub count: usize,
    /// Refitted parts.
    pub refitted: Vec<RefittedPart>,
    /// Errors of the calibrated model.
    pub calibrated: ModelAccuracy,
    /// Errors of the corrected model, with its own coverage; `None` if the calibration has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub corrected: Option<JudgedModel>,
    /// Errors of the nominal model with the same refit; `None` unless tool and an unknown device frame were both refitted.
    pub nominal: Option<ModelAccuracy>,
    /// Coverage of the predicted bounds, if there are any.
    pub promised: Option<CoverageCheck>,
    /// The same for rows inside the sampled range; `None` without such rows or without predicted bounds.
    pub in_sampled_range: Option<SampledRangeErrors>,
    /// Ratio of the error of the nominal model to that of the delivered one on these rows, device frame and targets fitted for both
    /// ([`improvement`]); `None` if the rows are too few for it, or if it was not requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub improvement: Option<Improvement>,
    /// Decision whether the requested limits are kept; `None` without limits.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub acceptance: Option<Acceptance>,
    /// Motion of the device since the calibration, if the rows show it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moved_device: Option<MovedDevice>,
    /// Scatter of the rows of one configuration; `None` if none was measured three times.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub repeats: Option<RepeatScatter>,
    /// Pose of the first device: as in the calibration, or as refitted.
    #[serde(skip)]
    pub base_from_device: Pose,
    /// Errors of each row by the delivered model, in the order read: the corrected one, if there is one.
    #[serde(skip)]
    pub rows: Vec<JudgedRow>,
}

/// Motion of a device from its pose in the calibration.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MovedDevice {
    /// Distance, millimetres.
    pub shift_mm: f64,
    /// Angle, degrees.
    pub turn_deg: f64,
    /// Error of the delivered model (RMS of the leading quantity, millimetres or degrees) with the frame of the calibration.
    pub before_rms: f64,
    /// The same with the frame refitted.
    pub after_rms: f64,
    /// True if it was refitted for that reason.
    pub refitted: bool,
}

/// Errors of a model, and coverage of its predicted bounds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JudgedModel {
    /// Errors of the model.
    #[serde(flatten)]
    pub errors: ModelAccuracy,
    /// Coverage of the predicted bounds, if there are any.
    pub promised: Option<CoverageCheck>,
    /// The same for rows inside the sampled range; `None` without such rows or without predicted bounds.
    pub in_sampled_range: Option<SampledRangeErrors>,
}

/// Judges a calibration by measurements: theory.md §9, *Coverage*. The readings must be those of the robot, and every target one of its
/// targets unless the tool is refitted.
///
/// # Errors
/// [`ErrorKind::Problem`] if there are fewer measured numbers than unknowns to be refitted, or none at all.
///
/// ```
/// use poecal_calibrate::{CalibrationOptions, DeviceFrameKnowledge, JudgedCalibration, calibrate, judge};
/// use poecal_model::simulate::{SessionKind, Simulation, elbow};
/// let exact = Simulation { noise_position_m: 0.0, noise_rotation_rad: 0.0, ..Simulation::default() };
/// let made = exact.run(&elbow(), SessionKind::POINT)?;
/// let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// let calibrated = calibration.robot_with_targets();
/// let subject = JudgedCalibration {
///     calibrated: &calibrated,
///     nominal: &calibration.nominal,
///     base_from_device: calibration.base_from_device,
///     further_base_from_device: &[],
///     ranges: &[],
///     frame: DeviceFrameKnowledge::Unknown,
///     noise: calibration.noise,
///     refit_frame: false,
///     refit_tool: false,
///     uncertainty: None,
/// };
/// let judgement = judge(&subject, &made.data)?;
/// assert!(judgement.calibrated.position_mm().max < 1e-6);
/// assert!(judgement.nominal.is_none());
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
pub fn judge(subject: &JudgedCalibration<'_>, data: &Dataset) -> Result<Judgement> {
    check_count(subject, data)?;
    let mut refitted = Vec::new();
    if subject.refit_frame {
        refitted.push(RefittedPart::DeviceFrame);
    }
    if subject.refit_tool {
        refitted.push(RefittedPart::Tool);
    }
    let frame_is_common = subject.refit_frame || subject.frame == DeviceFrameKnowledge::Base;
    let nominal = (frame_is_common && subject.refit_tool).then(|| {
        let packed = PackedValues::from_dataset(subject.nominal, data);
        model_accuracy(data, &data.all_rows(), &judged_rows(subject, subject.nominal, data, &packed).errors)
    });
    let packed = PackedValues::from_dataset(subject.calibrated, data);
    let rows = judged_rows(subject, subject.calibrated, data, &packed);
    let promised = subject.uncertainty.and_then(|predicted| promised_rows(&predicted, subject.refit_tool, &rows));
    let (promised, in_sampled_range, mut each) = match promised {
        None => (None, None, rows.errors.iter().map(JudgedRow::from_error).collect::<Vec<_>>()),
        Some(each) => {
            let (all, some) = coverage_checks(data, &each, &rows.errors);
            (Some(all), some, each)
        }
    };
    for (row, (judged, error)) in (0..).zip(each.iter_mut().zip(&rows.errors)) {
        judged.corners = corner_error(data, row, error);
    }
    let calibrated = model_accuracy(data, &data.all_rows(), &rows.errors);
    Ok(Judgement {
        count: data.len(),
        refitted,
        calibrated,
        corrected: None,
        nominal,
        promised,
        in_sampled_range,
        improvement: None,
        acceptance: None,
        moved_device: None,
        repeats: repeat_scatter(&rows.session, data, &rows.estimate),
        base_from_device: rows.estimate.device_from_base.inverse(),
        rows: each,
    })
}

/// Ratio of the error of the nominal robot to that of the calibrated one on the same rows, with device frame and targets refitted for both:
/// theory.md §9 (50). `None` if the rows are too few for it.
#[must_use]
pub fn improvement(subject: &JudgedCalibration<'_>, data: &Dataset) -> Option<Improvement> {
    let both =
        JudgedCalibration { refit_frame: subject.frame != DeviceFrameKnowledge::Base, refit_tool: true, ..*subject };
    check_count(&both, data).ok()?;
    let [before, after] = [both.nominal, both.calibrated].map(|robot| {
        let packed = PackedValues::from_dataset(robot, data);
        judged_rows(&both, robot, data, &packed).errors
    });
    let (_, found) = paired_improvement(data, &data.all_rows(), [&before, &after]).leading_value()?;
    Some(found)
}

/// Errors of a robot's predictions, with device frame and targets refitted as requested.
pub(crate) fn judged_rows<'a>(
    subject: &JudgedCalibration<'_>,
    robot: &'a Robot,
    data: &'a Dataset,
    packed: &'a PackedValues,
) -> JudgedPredictions<'a> {
    let session = Session::new(robot, data, packed, subject.refit_frame);
    let rows: Vec<u32> = data.all_rows();
    let mut estimate = nominal_estimate(robot, data);
    estimate.device_from_base = subject.base_from_device.inverse();
    let mut free = Vec::new();
    for (device, base_from_device) in estimate.further_devices.iter_mut().zip(subject.further_base_from_device) {
        *device = base_from_device.inverse();
    }
    estimate.ranges = subject.ranges.to_vec();
    if subject.refit_frame || subject.refit_tool {
        let registration =
            Registration { session, rows: &rows, noise: subject.noise, targets_free: subject.refit_tool, prior: None };
        estimate = register(&registration, &estimate).0;
        free = free_parameters(&registration, &rows);
    }
    let errors = session.errors(&rows, &estimate);
    JudgedPredictions { session, estimate, errors, free }
}

/// Refuses measurements that cannot determine the refitted unknowns, and empty ones.
pub(crate) fn check_count(subject: &JudgedCalibration<'_>, data: &Dataset) -> Result<()> {
    let frames = (0..data.station_count()).map(|station| of_device(data, station, &data.all_rows()));
    let frame: usize = if subject.refit_frame { frames.sum() } else { 0 };
    let targets = data.target_freedoms(&data.all_rows()).into_iter().map(Freedom::count);
    let tool: usize = if subject.refit_tool { targets.sum() } else { 0 };
    if tool > MOST_UNKNOWNS {
        return ErrorKind::Problem.refuse(format!(
            "found {tool} unknowns of {} targets to be refitted, expected at most {MOST_UNKNOWNS} in one fit: \
             leave --refit tool out, or judge fewer targets",
            data.targets.len()
        ));
    }
    let given: usize = data.observations.iter().map(|row| row.measurement.dim()).sum();
    if given > frame + tool {
        return Ok(());
    }
    ErrorKind::Problem.refuse(format!(
        "found {} with {given} measured numbers, expected more than the {} unknowns to be refitted \
             ({frame} of the device frame, {tool} of the targets): measure more configurations, or refit less",
        measurements_words(data.len()),
        frame + tool
    ))
}

/// Relative difference of two equal errors: rounding of two fits of a frame.
const SAME: f64 = 1e-6;

/// Judgement of the delivered model.
#[derive(Clone, Copy, Debug)]
pub struct DeliveredModel<'a> {
    /// Kind of the model.
    pub model: AcceptedModel,
    /// Errors of the model.
    pub errors: &'a ModelAccuracy,
    /// Coverage of its predicted bounds, if there are any.
    pub promised: Option<&'a CoverageCheck>,
    /// The same for rows inside the sampled range.
    pub in_sampled_range: Option<&'a SampledRangeErrors>,
}

impl Judgement {
    /// The corrected model, unless it equals the calibrated one within rounding because it has no terms.
    #[must_use]
    pub fn with_terms(&self) -> Option<&JudgedModel> {
        let other = self.calibrated.lead().rms;
        self.corrected.as_ref().filter(|model| (model.errors.lead().rms - other).abs() > SAME * other)
    }

    /// The delivered model: the corrected one if there is one with terms, otherwise the calibrated one.
    #[must_use]
    pub fn delivered_model(&self) -> DeliveredModel<'_> {
        match self.with_terms() {
            Some(found) => DeliveredModel {
                model: AcceptedModel::Corrected,
                errors: &found.errors,
                promised: found.promised.as_ref(),
                in_sampled_range: found.in_sampled_range.as_ref(),
            },
            None => DeliveredModel {
                model: AcceptedModel::Calibrated,
                errors: &self.calibrated,
                promised: self.promised.as_ref(),
                in_sampled_range: self.in_sampled_range.as_ref(),
            },
        }
    }
}
