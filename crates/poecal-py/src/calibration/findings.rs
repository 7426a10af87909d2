//! Results of `check`, `compare`, `identify`, `offsets` and `track`.

use std::path::{Path, PathBuf};

use poecal_calibrate::DeviceFrameKnowledge;
use poecal_cli::words;
use poecal_fit::analysis::{self, PlannedSession};
use poecal_fit::forensics;
use poecal_model::measurement::{Noise, Quantity};
use poecal_model::offsets::EndConstraint;
use poecal_plan::plan::{PlannedFit, RobotError, expected_errors};
use poecal_report as report;
use poecal_report::Detail;
use poecal_results::compare as compared;
use poecal_results::offsets::ModelOffsets;
use poecal_results::output::{ExistingFiles, ReservedFile};
use poecal_results::record::Record;
use poecal_results::track::{Baseline, TrackOptions, track as tracked};
use poecal_results::validation::{ValidationInputs, current_time};
use pyo3::prelude::*;
use serde::Serialize;

use crate::arguments::{self as arg, Argument, WordSet, unexpected_error};
use crate::arrays::JointArray;
use crate::calibration::Calibration;
use crate::errors::{argument, python_words, raise};
use crate::measurements::Measurements;
use crate::output_places::reserved_file;
use crate::paths;
use crate::robot::Robot;
use crate::words::{frame as frame_word, from_mm, kind as kind_word, one_of, sigma, sigmas};

/// A result on its way to Python: an object of the class of this name in `poecal`.
pub(crate) struct Findings {
    class: &'static str,
    /// The program's table.
    text: String,
    /// The answer in a sentence.
    answer: String,
    /// Text that the program prints with `--json`.
    json: String,
    warnings: Vec<String>,
}

impl Findings {
    /// Findings of a result's own JSON.
    pub(crate) fn of_json(class: &'static str, text: String, answer: impl Into<String>, json: String) -> Self {
        Findings { class, text, answer: answer.into(), json, warnings: Vec::new() }
    }

    pub(crate) fn new(
        class: &'static str,
        text: String,
        answer: impl Into<String>,
        found: &impl Serialize,
    ) -> PyResult<Self> {
        Ok(Self::of_json(class, text, answer, report::json(found).map_err(raise)?))
    }

    pub(crate) fn with_warnings(self, warnings: &[String]) -> Self {
        Findings { warnings: warnings.iter().map(|it| python_words(it)).collect(), ..self }
    }
}

impl<'py> IntoPyObject<'py> for Findings {
    type Target = PyAny;
    type Output = Bound<'py, PyAny>;
    type Error = PyErr;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Self::Output> {
        let class = py.import("poecal")?.getattr(self.class)?;
        class.call1((self.text, python_words(&self.answer), self.json, self.warnings))
    }
}

/// Interpretation of a model and measurements, and the mistakes that they show.
///
/// Parameters
/// ----------
/// robot
///     The nominal robot, or the path of its model.
/// measurements
///     Its measurements, or the path of their file, or several paths; None if there are none yet.
/// device_frame
///     The measuring device's frame; with "base", mistakes in it are searched too.
///
/// Returns
/// -------
/// Check
///     The interpretation, with mistakes under "diagnosis".
#[pyfunction]
#[pyo3(signature = (robot, measurements=None, *, device_frame="unknown"))]
pub(crate) fn check(
    py: Python<'_>,
    robot: &Bound<'_, PyAny>,
    measurements: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = arg::device_frame)] device_frame: &str,
) -> PyResult<Findings> {
    let robot = paths::robot(robot)?;
    let measurements = paths::optional_measurements(measurements, "measurements", &robot)?;
    let (robot, measurements) = (robot.get(), measurements.as_ref().map(Bound::get));
    let device_free = frame_word(device_frame)? == DeviceFrameKnowledge::Unknown;
    if let Some(measurements) = measurements {
        measurements.check_robot(robot)?;
    }
    let file = measurements.map(|measurements| &*measurements.file);
    let check = py.detach(|| {
        let options = forensics::DiagnosisOptions { device_free, ..forensics::DiagnosisOptions::default() };
        let diagnose = |data| forensics::diagnose(&robot.model.robot, data, &data.all_rows(), &options);
        let found = file.map_or_else(Vec::new, |file| diagnose(&file.data));
        report::Check::new(&robot.model, file, &found)
    });
    let warnings = file.map_or(&[][..], |file| &file.warnings);
    Ok(Findings::new("Check", check.text(), check.answer(), &check)?.with_warnings(warnings))
}

/// Unknowns that measurements in stated configurations would determine, before anything is measured.
///
/// Parameters
/// ----------
/// robot
///     The robot.
/// joints
///     Configurations, shape (m, n), radians and metres, in the order of `robot.reading_names`.
/// kind
///     Kind of the measurements of the tip: "pose", "point", or "mixed" (both in turn).
/// sigma_position_mm, sigma_rotation_deg
///     Standard deviation of each measured component (default 0.05 mm, 0.01 deg).
/// device_frame
///     The measuring device's frame: "unknown" or "base".
/// robot_error_mm
///     Remaining error of the tip (RMS) after a calibration with any number of rows, or that and the one with corrections. By default those of a
///     calibration of this robot, else 0.3 mm for each metre of reach, which is a guess.
///
/// Returns
/// -------
/// Identification
///     The unknowns that would be determined, and the expected error.
#[pyfunction]
#[pyo3(signature = (robot, joints, *, kind="pose", sigma_position_mm=None, sigma_rotation_deg=None, device_frame="unknown", robot_error_mm=None))]
#[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
pub(crate) fn identify(
    py: Python<'_>,
    #[pyo3(from_py_with = arg::robot)] robot: &Robot,
    joints: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = arg::kind)] kind: &str,
    #[pyo3(from_py_with = arg::sigma_position_mm)] sigma_position_mm: Option<f64>,
    #[pyo3(from_py_with = arg::sigma_rotation_deg)] sigma_rotation_deg: Option<f64>,
    #[pyo3(from_py_with = arg::device_frame)] device_frame: &str,
    #[pyo3(from_py_with = arg::robot_error_mm)] robot_error_mm: Option<RobotError>,
) -> PyResult<Findings> {
    let model = &robot.model;
    let joints = JointArray::from_argument(joints, &model.robot)?;
    let [position_m, rotation_rad] = sigmas(sigma_position_mm, sigma_rotation_deg)?;
    let usual = PlannedSession::default();
    let session = PlannedSession {
        kind: kind_word(kind)?,
        noise: Noise::new(
            position_m.unwrap_or(usual.noise[Quantity::Position]),
            rotation_rad.unwrap_or(usual.noise[Quantity::Rotation]),
        ),
        device_free: frame_word(device_frame)? == DeviceFrameKnowledge::Unknown,
    };
    let fit =
        PlannedFit { session, robot_error: robot_error_mm.or_else(|| model.left_error()), ..PlannedFit::default() };
    let work = || {
        let found = analysis::identify(&model.robot, &joints.readings, &session)?;
        let is_free = session.kind.is_chosen_freely();
        let expected = is_free.then(|| expected_errors(&model.robot, &joints.readings, &fit)).transpose()?;
        Ok((found, expected))
    };
    let (found, expected) = py.detach(work).map_err(raise)?;
    let report = report::Identify::new(model, &["arrays".to_owned()], &session, (&found, expected));
    Findings::new("Identification", report.text(), report.answer(), &report)
}

/// A robot, or the calibrated one of a calibration.
pub(crate) enum RobotOrCalibration<'a> {
    Robot(&'a Robot),
    Calibration(&'a Calibration),
}

impl<'a, 'py> Argument<'a, 'py> for RobotOrCalibration<'a> {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        match (value.cast::<Robot>(), value.cast::<Calibration>()) {
            (Ok(robot), _) => Ok(RobotOrCalibration::Robot(robot.get())),
            (_, Ok(calibration)) => Ok(RobotOrCalibration::Calibration(calibration.get())),
            _ => Err(unexpected_error(name, value, "a poecal.Robot or a poecal.Calibration")),
        }
    }
}

/// The joint offsets of the best fit of a model's tip to that of a robot, and the remaining errors.
///
/// Parameters
/// ----------
/// nominal
///     The model.
/// actual
///     The robot, or a calibration of it.
/// free, fix
///     Frames "base" and "tip" that are fitted with the offsets, and those that are equal in both; by default those that a calibration fitted are
///     free.
///
/// Returns
/// -------
/// Offsets
///     The offsets, and the errors with and without them.
#[pyfunction]
#[pyo3(signature = (nominal, actual, *, free=None, fix=None))]
pub(crate) fn offsets(
    py: Python<'_>,
    #[pyo3(from_py_with = arg::nominal)] nominal: &Robot,
    #[pyo3(from_py_with = arg::actual)] actual: RobotOrCalibration<'_>,
    #[pyo3(from_py_with = arg::free)] free: Option<WordSet>,
    #[pyo3(from_py_with = arg::fix)] fix: Option<WordSet>,
) -> PyResult<Findings> {
    let actual = match &actual {
        RobotOrCalibration::Robot(robot) => (*robot).clone(),
        RobotOrCalibration::Calibration(calibration) => calibration.calibrated_robot()?.clone(),
    };
    let (nominal, actual) = (&nominal.model, &actual.model);
    let mut ends = [None, None];
    for (name, stated, end) in [("free", free, EndConstraint::Free), ("fix", fix, EndConstraint::Kept)] {
        let frames = stated.map(|it| it.choose(name, words::OUTER_FRAME)).transpose()?;
        for frame in frames.into_iter().flatten() {
            if ends[usize::from(frame == words::OuterFrame::Tip)].replace(end).is_some_and(|it| it != end) {
                return Err(argument(name, "found a frame that is in free too, expected it in one of the two"));
            }
        }
    }
    let explained = py.detach(|| ModelOffsets::from_robots(nominal, actual, ends)).map_err(raise)?;
    let found = report::Offsets::new(nominal, actual, &explained);
    let mut warnings = Vec::new();
    for joint in &nominal.robot.joints {
        let followers = nominal.robot.followers(&joint.name);
        if !followers.is_empty() {
            warnings.push(format!(
                "joint `{}` is read for {} too: each offset is that of the joint's own value, and an error of this encoder is in all of them",
                joint.name,
                followers.join(", ")
            ));
        }
    }
    crate::warn(py, &warnings)?;
    Ok(Findings::new("Offsets", found.text(), found.answer(), &found)?.with_warnings(&warnings))
}

/// Changes between two calibrations of one robot, and their comparison with noise.
///
/// Parameters
/// ----------
/// first, second
///     The calibrations.
/// limit_mm
///     Largest permitted motion of the tip (RMS), default the expected errors of both together.
///
/// Returns
/// -------
/// Comparison
///     Motion of the tip (`tip`), its comparison with the limit (`moved`), the test of all changes against noise (`changed`), and each joint's change
///     with its test.
#[pyfunction]
#[pyo3(signature = (first, second, *, limit_mm=None))]
pub(crate) fn compare(
    py: Python<'_>,
    first: &Calibration,
    second: &Calibration,
    #[pyo3(from_py_with = arg::limit_mm)] limit_mm: Option<f64>,
) -> PyResult<Findings> {
    let limit_m = limit_mm.map(|it| sigma("limit_mm", it, from_mm)).transpose()?;
    let (one, other) = (first.file(), second.file());
    let found = py.detach(|| compared::compare(one, other, limit_m)).map_err(raise)?;
    let told = report::ComparisonReport::new(("first", one), ("second", other), &found).map_err(raise)?;
    Findings::new("Comparison", told.text(Detail::Full), told.answer(), &told)
}

/// Detection of a robot's change since its calibration by a few measurements, with the changed joint.
///
/// Parameters
/// ----------
/// calibration
///     The calibration.
/// measurements
///     Measurements of the visit: best some configurations of the calibration again.
/// earlier
///     The rows of the calibration, or those of an earlier visit: rows that repeat their configurations are compared with them. None: all are judged
///     by the model.
/// device
///     "refit" if the device was set up anew, so that its frame is fitted; "known" if it stands where it stood.
/// tool
///     "same" if the tool stayed on the flange; "refit" if it was mounted anew, so that its targets are fitted.
/// repeatability_mm
///     Standard deviation of one visit and coordinate; None: estimated from repeats within a visit and from the changes that no explanation removes.
/// report
///     File for the page of the visit: then and now, on one page of A4 to sign.
/// record
///     Statements of the page about this visit, as {"operator": "Mia"}.
/// force
///     True to overwrite a file that exists.
///
/// Returns
/// -------
/// Visit
///     The state, the explanation with its size, others that explain the changes nearly as well, joints that are not seen, and the present error.
#[pyfunction]
#[pyo3(signature = (calibration, measurements, earlier=None, *, device="refit", tool="same", repeatability_mm=None, report=None, record=None,
                    force=false))]
#[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
pub(crate) fn track(
    py: Python<'_>,
    calibration: &Calibration,
    #[pyo3(from_py_with = arg::measurements)] measurements: &Measurements,
    #[pyo3(from_py_with = arg::earlier)] earlier: Option<&Measurements>,
    #[pyo3(from_py_with = arg::device)] device: &str,
    #[pyo3(from_py_with = arg::tool)] tool: &str,
    #[pyo3(from_py_with = arg::repeatability_mm)] repeatability_mm: Option<f64>,
    #[pyo3(from_py_with = arg::report)] report: Option<PathBuf>,
    #[pyo3(from_py_with = arg::record)] record: Option<Record>,
    #[pyo3(from_py_with = arg::force)] force: bool,
) -> PyResult<Findings> {
    let file = calibration.file();
    let options = visit_options(device, tool, repeatability_mm)?;
    let page = report.map(|path| visit_place(py, &path, force, (calibration, measurements))).transpose()?;
    let earlier = earlier.map(|it| Baseline { data: it.data(), is_own: true });
    let data = measurements.data();
    let found = py.detach(|| tracked(file, data, earlier, &options)).map_err(raise)?;
    let told = report::TrackReport::new(&found, &file.robot.name, ValidationInputs::default())
        .with_record(record.unwrap_or_default());
    if let Some(page) = page {
        py.detach(|| page.write(report::visit_page(&told, file, current_time().as_deref()))).map_err(raise)?;
    }
    Ok(Findings::new("Visit", told.text(), told.answer(), &told)?.with_warnings(&found.notes))
}

/// The output place of a visit's page, which must not be one of its inputs.
fn visit_place(
    py: Python<'_>,
    path: &Path,
    force: bool,
    (calibration, measurements): (&Calibration, &Measurements),
) -> PyResult<ReservedFile> {
    let names = measurements.source.names.iter().map(Path::new);
    let inputs: Vec<&Path> = calibration.source().into_iter().chain(names).collect();
    reserved_file(py, path, ExistingFiles::from_switch(force), &inputs)
}

/// Knowledge of a visit, by the words of `track` and `recalibrate`.
pub(crate) fn visit_options(device: &str, tool: &str, repeatability_mm: Option<f64>) -> PyResult<TrackOptions> {
    Ok(TrackOptions {
        device_is_known: one_of("device", device, words::DEVICE)?,
        tool_is_anew: one_of("tool", tool, words::TOOL)?,
        repeatability_m: repeatability_mm.map(|it| sigma("repeatability_mm", it, from_mm)).transpose()?,
    })
}
