//! A finished calibration judged on measurements that it did not see.

use serde::Serialize;

use super::accuracy::{ModelAccuracy, model_accuracy};
use super::expectation::{Kept, KeptPart, Promise};
use super::promised::{InSampledRange, ROUNDING, Seen, promised};
use super::verdict::Level;
use super::{DeviceFrameKnowledge, delivered, measurements_words, radian_m};
use crate::error::{Error, ErrorKind, Result};
use crate::estimate::{Packed, row_errors};
use crate::lie::Pose;
use crate::measurement::{Dataset, Noise};
use crate::problem::MOST_UNKNOWNS;
use crate::robot::Robot;
use crate::start::{Registration, free_parameters, register};

/// Share of the errors inside their 95 % bounds that a promise asks for at least.
const INSIDE: f64 = 0.8;
/// Most times the expected error that the error may be.
const TIMES: f64 = 2.0;

/// What is judged, and what of it is found anew from the measurements that judge it.
///
/// ```
/// use poecal::calibration::{CalibrationOptions, DeviceFrameKnowledge, Subject, calibrate, judge};
/// use poecal::simulate::{Kind, Simulation, elbow};
/// let exact = Simulation { noise_position_m: 0.0, noise_rotation_rad: 0.0, ..Simulation::default() };
/// let made = exact.run(&elbow(), Kind::Point)?;
/// let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// let subject = Subject {
///     calibrated: &calibration.robot,
///     nominal: &calibration.nominal,
///     base_from_device: calibration.base_from_device,
///     further_base_from_device: &[],
///     frame: DeviceFrameKnowledge::Unknown,
///     noise: calibration.noise,
///     refit_frame: false,
///     refit_tool: false,
///     promise: None,
/// };
/// let judgement = judge(&subject, &made.data)?;
/// assert!(judgement.calibrated.position_mm.max < 1e-6);
/// assert!(judgement.nominal.is_none());
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// The calibrated robot with its named targets.
    pub calibrated: &'a Robot,
    /// The nominal robot.
    pub nominal: &'a Robot,
    /// Where the calibration found the measuring device.
    pub base_from_device: Pose,
    /// The same for each further place that it stood at when the judging measurements were taken.
    pub further_base_from_device: &'a [Pose],
    /// What was known of the device's frame.
    pub frame: DeviceFrameKnowledge,
    /// Noise by which positions and rotations are weighted where something is found anew.
    pub noise: Noise,
    /// Find the device's frame anew.
    pub refit_frame: bool,
    /// Find every target that was measured anew.
    pub refit_tool: bool,
    /// What the calibration promises of its predictions. Of what is found anew it promises what the screws leave.
    pub promise: Option<Promise<'a>>,
}

/// What was found anew from the judging measurements themselves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Refitted {
    /// Where the measuring device stands.
    DeviceFrame,
    /// The targets' places, and their orientations where measured.
    Tool,
}

/// How good a calibration is on measurements that it did not see.
///
/// ```
/// use poecal::calibration::{Judgement, ModelAccuracy, Statistic};
/// let position_mm = Statistic { mean: 0.1, rms: 0.11, p95: 0.2, max: 0.25 };
/// let calibrated = ModelAccuracy { position_mm, rotation_deg: None };
/// let judgement = Judgement { count: 20, refitted: vec![], calibrated, nominal: None, promised: None, in_sampled_range: None };
/// assert_eq!(judgement.calibrated.position_mm.max, 0.25);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Judgement {
    /// Number of measurements.
    pub count: usize,
    /// What was found anew from them.
    pub refitted: Vec<Refitted>,
    /// Errors of the calibrated model.
    pub calibrated: ModelAccuracy,
    /// Errors of the nominal screws with the same found anew; none unless that takes in all that the nominal model cannot know, the
    /// tool and a device frame that was unknown.
    pub nominal: Option<ModelAccuracy>,
    /// Whether the errors are what the calibration promised, if it promised something.
    pub promised: Option<Kept>,
    /// The same of the rows inside the range that was sampled for the calibration; none if there is no such row, or no promise.
    pub in_sampled_range: Option<InSampledRange>,
}

/// Judges a calibration by measurements. The readings must be those of the robot, and every target must be one of its targets unless
/// the tool is found anew.
///
/// # Errors
/// [`ErrorKind::Problem`] if there are fewer measured numbers than unknowns to be refitted, or none at all.
pub fn judge(subject: &Subject<'_>, data: &Dataset) -> Result<Judgement> {
    check_count(subject, data)?;
    let mut refitted = Vec::new();
    if subject.refit_frame {
        refitted.push(Refitted::DeviceFrame);
    }
    if subject.refit_tool {
        refitted.push(Refitted::Tool);
    }
    let frame_is_common = subject.refit_frame || subject.frame == DeviceFrameKnowledge::Base;
    let nominal = (frame_is_common && subject.refit_tool)
        .then(|| model_accuracy(&seen(subject, subject.nominal, data).errors));
    let seen = seen(subject, subject.calibrated, data);
    let promised = subject
        .promise
        .and_then(|promise| promised(&promise, subject.calibrated, subject.refit_tool, data, &seen));
    let (promised, in_sampled_range) = promised.map_or((None, None), |(all, some)| (Some(all), some));
    let calibrated = model_accuracy(&seen.errors);
    Ok(Judgement { count: data.len(), refitted, calibrated, nominal, promised, in_sampled_range })
}

/// Joint values, and the errors of a robot's screws with device frame and targets found anew as asked.
fn seen(subject: &Subject<'_>, robot: &Robot, data: &Dataset) -> Seen {
    let packed = Packed::of(robot, data);
    let rows: Vec<u32> = data.all_rows();
    let mut estimate = delivered(robot, data);
    estimate.device_from_base = subject.base_from_device.inverse();
    let mut free = Vec::new();
    for (device, base_from_device) in
        estimate.further_devices.iter_mut().zip(subject.further_base_from_device)
    {
        *device = base_from_device.inverse();
    }
    if subject.refit_frame || subject.refit_tool {
        let registration = Registration {
            data,
            packed: &packed,
            rows: &rows,
            noise: subject.noise,
            length_m: radian_m(robot, &packed),
            device_free: subject.refit_frame,
            targets_free: subject.refit_tool,
        };
        estimate = register(&registration, &estimate).0;
        free = free_parameters(&registration, &rows);
    }
    let errors = row_errors(data, &packed, &rows, &estimate);
    Seen { packed, estimate, errors, free }
}

/// Refuses measurements that cannot determine what is found anew, and none at all.
fn check_count(subject: &Subject<'_>, data: &Dataset) -> Result<()> {
    let frame = if subject.refit_frame { 6 * data.station_count() } else { 0 };
    let targets = data.frames(&data.all_rows()).into_iter().map(|is_frame| if is_frame { 6 } else { 3 });
    let tool: usize = if subject.refit_tool { targets.sum() } else { 0 };
    if tool > MOST_UNKNOWNS {
        let message = format!(
            "found {tool} unknowns of {} targets to be refitted, expected at most {MOST_UNKNOWNS} in one fit: \
             leave --refit-tool out, or judge fewer targets",
            data.targets.len()
        );
        return Err(Error::new(ErrorKind::Problem, message));
    }
    let given: usize = data.observations.iter().map(|row| row.measurement.residual_model().dim()).sum();
    if given > frame + tool {
        return Ok(());
    }
    Err(Error::new(
        ErrorKind::Problem,
        format!(
            "found {} with {given} measured numbers, expected more than the {} unknowns to be refitted \
             ({frame} of the device frame, {tool} of the targets): measure more configurations, or refit less",
            measurements_words(data.len()),
            frame + tool
        ),
    ))
}

impl Judgement {
    /// Why the measurements do not show the calibration to be as good as this; none if they do. *Good* is a promise kept by all rows,
    /// *inside the sampled range* one kept by those inside it: at least 80 % of the errors inside their 95 % bounds, and the error (RMS) at most
    /// twice the expected one.
    #[must_use]
    pub fn falls_short(&self, required: Level) -> Option<String> {
        let (which, found) = match required {
            Level::DoNotUse => return None,
            Level::InsideSampledRange => {
                let some = self.in_sampled_range.as_ref();
                ("inside the sampled range", some.map(|some| (&some.calibrated, &some.promised)))
            }
            Level::Good => ("of these rows", self.promised.as_ref().map(|kept| (&self.calibrated, kept))),
        };
        let Some((errors, kept)) = found else {
            return Some(match self.promised {
                None => "the calibration has no uncertainty, so there are no bounds to test".to_owned(),
                Some(_) => "no row lies inside the sampled range".to_owned(),
            });
        };
        let rotation = kept
            .rotation_deg
            .zip(errors.rotation_deg)
            .map(|(part, found)| ("rotation", part, found.rms, "deg"));
        let position = ("position", kept.position_mm, errors.position_mm.rms, "mm");
        std::iter::once(position).chain(rotation).find_map(|(what, part, rms, unit)| {
            let KeptPart { expected_rms, inside_bound95 } = part;
            // Of exact data nothing but rounding is left.
            if rms <= ROUNDING * 1e6 {
                None
            } else if inside_bound95 < INSIDE {
                Some(format!(
                    "{:.0} % of the {what} errors {which} are inside their 95 % bounds, {:.0} % are required",
                    100.0 * inside_bound95,
                    100.0 * INSIDE
                ))
            } else if rms > TIMES * expected_rms {
                Some(format!(
                    "the {what} error {which} is {rms:.3} {unit} (RMS), more than twice the expected {expected_rms:.3} {unit}"
                ))
            } else {
                None
            }
        })
    }
}
