//! A finished calibration.

mod content;
mod validated;

pub(crate) use content::Calibration;
use content::part;

use std::path::{Path, PathBuf};

use numpy::PyArray2;
use poecal_calibrate::{AcceptanceLimits, AcceptedModel};
use poecal_compensate::{Language, ProgramOptions};
use poecal_model::robot::ThirdAxis;
use poecal_plan::plan::RobotError;
use poecal_report as report;
use poecal_report::table::number;
use poecal_results::calibration_file::{CalibrationFile, Counted};
use poecal_results::export::{ExportFormat, ExportOptions, export};
use poecal_results::model::{Model, ModelSource};
use poecal_results::output::{self, Contents, Existing, Results};
use poecal_results::predictions::{PredictionFrame, predicted};
use poecal_results::record::Record;
use poecal_results::residuals::{ResidualRows, Residuals as Rows};
use poecal_results::shapes::Shapes;
use poecal_results::validation::Judging;
use pyo3::IntoPyObjectExt as _;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};

use crate::accuracy::{Accuracy, Verdict};
use crate::arguments::{self as arg, Argument, unexpected};
use crate::arrays::{Joints, pose_array};
use crate::calibrate::accept_limits;
use crate::covariance::Covariance;
use crate::errors::{argument, python_words, raise};
use crate::findings::{self, Findings};
use crate::measurements::Measurements;
use crate::places::{reserved_file, reserved_folder, said};
use crate::prediction::Prediction;
use crate::residuals::Residuals;
use crate::robot::{Robot, poses};
use crate::words::chosen;
use crate::{notebook, pickle, reach};

/// Place of a report: among the results, a file, or none.
enum ReportPlace {
    Among(bool),
    File(PathBuf),
}

impl<'a, 'py> Argument<'a, 'py> for ReportPlace {
    fn of(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        match value.extract() {
            Ok(among) => Ok(ReportPlace::Among(among)),
            Err(_) if value.extract::<PathBuf>().is_ok() => PathBuf::of(value, name).map(ReportPlace::File),
            Err(_) => Err(unexpected(name, value, "True, False, or the path of a file")),
        }
    }
}

#[pymethods]
impl Calibration {
    /// Reads a calibration.json, and the residuals.csv beside it if there is one.
    ///
    /// Parameters
    /// ----------
    /// path
    ///     The calibration.json.
    /// residuals
    ///     Another residuals.csv.
    ///
    /// Returns
    /// -------
    /// Calibration
    ///     The calibration, which does what it did before it was written.
    #[staticmethod]
    #[pyo3(signature = (path, *, residuals=None))]
    fn read(
        #[pyo3(from_py_with = arg::path)] path: PathBuf,
        #[pyo3(from_py_with = arg::residuals)] residuals: Option<PathBuf>,
    ) -> PyResult<Self> {
        let file = CalibrationFile::read(&path).map_err(raise)?;
        let in_file = |error: poecal_numerics::error::Error| raise(error.in_file(&path));
        let robot = file.robot().map_err(in_file)?;
        let nominal = file.nominal_robot().map_err(in_file)?;
        let beside = path.with_file_name("residuals.csv");
        let residuals = residuals.or_else(|| beside.is_file().then_some(beside));
        let residuals = residuals.map(Rows::read).transpose().map_err(raise)?;
        let summary = report::summary(&file, report::Detail::Short);
        let urdf = file.original_urdf(&path).map_err(raise)?;
        let source = urdf.map_or(ModelSource::Toml, |document| ModelSource::Urdf(Box::new(document)));
        let nominal = Robot::new(Model { robot: nominal, source, path });
        Ok(Calibration::written(nominal, robot, file, residuals, summary))
    }

    /// The calibrated robot, with the targets in its tip frame.
    #[getter]
    fn robot(&self) -> PyResult<Robot> {
        Ok(self.calibrated()?.clone())
    }

    /// The corrected robot, with gives and terms beside its joints; None if no terms were asked for.
    #[getter]
    fn corrected_robot(&self) -> PyResult<Option<Robot>> {
        Ok(self.corrected()?.cloned())
    }

    /// Screws and terms of the joints, fitted together: `corrected` of calibration.json; None if no terms were asked for.
    #[getter(corrected)]
    fn corrected_model<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        part(py, &self.file().corrected)
    }

    /// The nominal robot.
    #[getter]
    fn nominal(&self) -> Robot {
        self.nominal.clone()
    }

    /// Errors of the nominal, registered, calibrated and corrected model on fitted and held-out rows.
    #[getter]
    fn accuracy(&self) -> Accuracy {
        Accuracy::new(self.errors(), self.delivered())
    }

    /// How far the calibration may be used, and why no farther; an error for a file that does not say so.
    #[getter]
    fn verdict(&self) -> PyResult<Verdict> {
        self.judged().cloned().map(Verdict)
    }

    /// Whether the limits that were asked for are kept: `acceptance` of calibration.json; None if none were.
    #[getter]
    fn acceptance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        part(py, &self.file().acceptance)
    }

    /// What is stated of the session: a dict of texts.
    #[getter]
    fn record<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        part(py, &self.file().record)
    }

    /// Whether the fit reached an optimum.
    #[getter]
    fn converged(&self) -> bool {
        self.file().solver.converged
    }

    /// Warnings, and mistakes in the input, a sentence each.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        let file = self.file();
        let found = file.diagnosis.iter().map(|found| &found.statement);
        file.warnings.iter().chain(found).map(|warning| python_words(warning)).collect()
    }

    /// Pose of the measuring device in the base, shape (4, 4).
    #[getter]
    fn base_from_device<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        pose_array(py, &self.file().base_from_device().map_err(raise)?)
    }

    /// Frames of the instruments: `stations` of calibration.json; empty if no row names one.
    #[getter]
    fn stations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        part(py, &self.file().stations)
    }

    /// Each joint's correction, its uncertainty and its effect: `corrections` of calibration.json.
    #[getter]
    fn corrections<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        part(py, &self.file().corrections)
    }

    /// How far programs for the nominal robot miss over the workspace, and which corrections mend it.
    ///
    /// `compensation` of calibration.json; None if the calibration is not to be used.
    #[getter]
    fn compensation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        part(py, &self.file().compensation)
    }

    /// Expected errors of predictions: `uncertainty` of calibration.json; None if there are no more residuals than unknowns.
    #[getter]
    fn uncertainty<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        part(py, &self.file().uncertainty)
    }

    /// Which unknowns the measurements determine: `identifiability` of calibration.json.
    #[getter]
    fn identifiability<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        part(py, &self.file().identifiability)
    }

    /// Residuals of each row, fitted or held out; an error if the calibration was read without its residuals.csv.
    #[getter]
    fn residuals(slf: &Bound<'_, Self>) -> PyResult<Residuals> {
        Residuals::of(slf)
    }

    /// Covariance of the unknowns; an error if there are no more residuals than unknowns.
    #[getter]
    fn covariance(&self) -> PyResult<Covariance> {
        Covariance::of(self.file())
    }

    /// Draws the errors before and after, and those of each row: of position, if it was measured. Needs matplotlib.
    ///
    /// Parameters
    /// ----------
    /// axes
    ///     Two axes of matplotlib to draw into, default those of a new figure.
    ///
    /// Returns
    /// -------
    /// matplotlib.figure.Figure
    ///     The figure, which is not shown: notebooks show it, `savefig` writes it.
    #[pyo3(signature = (axes=None))]
    fn plot<'py>(slf: &Bound<'py, Self>, axes: Option<&Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("poecal._plot")?.call_method1("plot", (slf, axes))
    }

    /// The whole calibration.json as dicts and lists.
    ///
    /// Returns
    /// -------
    /// dict
    ///     The contents.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        part(py, self.file())
    }

    /// The calibration.json as a text.
    ///
    /// Returns
    /// -------
    /// str
    ///     The text.
    fn to_json(&self) -> PyResult<String> {
        self.file().to_text().map_err(raise)
    }

    /// The residuals.csv as a text.
    ///
    /// Returns
    /// -------
    /// str
    ///     The text.
    fn residuals_csv(&self) -> PyResult<String> {
        Ok(self.rows()?.text())
    }

    /// Writes the results to a folder, as the program does: calibration.json, the calibrated model, residuals.csv and report.html.
    ///
    /// All is written or nothing, and the models are read back and compared with the fit.
    ///
    /// Parameters
    /// ----------
    /// folder
    ///     The folder.
    /// force
    ///     Whether to write over files that exist.
    /// report
    ///     Whether to write the report too, or the path of another file for it.
    ///
    /// Returns
    /// -------
    /// list of str
    ///     Names of the files.
    ///
    /// Raises
    /// ------
    /// FileError
    ///     The folder exists, and `force` is not set.
    /// ExportError
    ///     Written files did not reproduce what was fitted.
    #[pyo3(signature = (folder, *, force=false, report=None), text_signature = "($self, folder, *, force=False, report=True)")]
    fn write(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arg::folder)] folder: PathBuf,
        #[pyo3(from_py_with = arg::force)] force: bool,
        #[pyo3(from_py_with = arg::report)] report: Option<ReportPlace>,
    ) -> PyResult<Vec<String>> {
        let report = report.unwrap_or(ReportPlace::Among(true));
        let (file, residuals) = (self.file(), self.rows()?);
        let (robot, model) = (self.as_fitted(), &self.nominal.model);
        let existing = Existing::forced(force);
        let measured = file.inputs.measurements.iter().map(Path::new);
        let inputs: Vec<&Path> = std::iter::once(model.path.as_path()).chain(measured).collect();
        let place = reserved_folder(py, &folder, Contents::Calibration, existing, &inputs)?;
        let elsewhere = match &report {
            ReportPlace::File(path) => said(py, |say| place.reserve_report(path, &inputs, say))?,
            ReportPlace::Among(_) => None,
        };
        let written = py.detach(|| {
            let page = match &report {
                ReportPlace::Among(false) => None,
                ReportPlace::Among(true) | ReportPlace::File(_) => {
                    let shapes = Shapes::read(file, &folder.join("calibration.json"));
                    Some(report::calibration_page_with(file, residuals, &shapes)?)
                }
            };
            let results =
                Results { file: file.clone(), residuals: ResidualRows::AtHand(residuals), report: page };
            output::write(place, elsewhere, model, &robot, results)
        });
        let written = written.map_err(raise)?;
        crate::warn(py, &written.notes)?;
        Ok(written.files)
    }

    /// The calibrated robot in the form of a controller, a driver or a simulator, read back and compared on 1,000 configurations.
    ///
    /// Parameters
    /// ----------
    /// format
    ///     "urdf" (the one that was calibrated, with other numbers), "toml", "poe", "dh", "mdh", "hayati", "origins", "ur", "xarm", "franka",
    ///     "pal", "lerobot", "mjcf", "sdf", "usd", "csv" or "offsets".
    /// model
    ///     "calibrated", geometry alone, or "corrected", whose terms of the joints a form of geometry leaves out, with a warning.
    /// hash
    ///     The controller's checksum, for "ur".
    /// motors
    ///     The text of the calibration of motors that LeRobot has, for "lerobot".
    ///
    /// Returns
    /// -------
    /// str
    ///     The text. What the form cannot say is a warning.
    ///
    /// Raises
    /// ------
    /// ExportError
    ///     The form cannot hold this robot.
    #[pyo3(signature = (format, *, model="calibrated", hash=None, motors=None))]
    fn export(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arg::format)] format: &str,
        #[pyo3(from_py_with = arg::model)] model: &str,
        #[pyo3(from_py_with = arg::hash)] hash: Option<String>,
        #[pyo3(from_py_with = arg::motors)] motors: Option<String>,
    ) -> PyResult<String> {
        let words = ExportFormat::ALL.map(|format| (format.word(), format));
        let format = chosen("format", format, &words)?;
        let robot = match chosen("model", model, &[("calibrated", false), ("corrected", true)])? {
            true => self.corrected()?.unwrap_or(self.calibrated()?),
            false => self.calibrated()?,
        };
        let options = ExportOptions { hash, motors };
        let exported = py.detach(|| export(&robot.model, format, &options)).map_err(raise)?;
        crate::warn(py, &exported.notes)?;
        Ok(exported.text)
    }

    /// The URDF that was calibrated, with the calibrated numbers; a new one if the model was no URDF.
    ///
    /// Returns
    /// -------
    /// str
    ///     The text.
    fn to_urdf(&self, py: Python<'_>) -> PyResult<String> {
        self.export(py, ExportFormat::Urdf.word(), "calibrated", None, None)
    }

    /// Writes the report, one HTML file.
    ///
    /// Parameters
    /// ----------
    /// path
    ///     The file.
    /// force
    ///     Whether to write over a file that is no report of poecal.
    #[pyo3(signature = (path, *, force=false))]
    fn report(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arg::path)] path: PathBuf,
        #[pyo3(from_py_with = arg::force)] force: bool,
    ) -> PyResult<()> {
        let (file, residuals) = (self.file(), self.rows()?);
        let existing = if force { Existing::Replaced } else { Existing::Own };
        let place = reserved_file(py, &path, existing, &[])?;
        let page = || {
            let shapes = Shapes::read(file, &path);
            place.write(report::calibration_page_with(file, residuals, &shapes)?)
        };
        py.detach(page).map_err(raise)
    }

    /// Writes the certificate, one page of paper (HTML).
    ///
    /// Parameters
    /// ----------
    /// path
    ///     The file.
    /// logo
    ///     Picture for its head: PNG, JPEG or SVG.
    /// valid_until
    ///     Day until which it is valid, like "2027-11-28".
    /// record
    ///     What it states beside and in place of what the calibration's record states, as {"serial": "4711"}.
    /// force
    ///     Whether to write over a file that is none of poecal.
    #[pyo3(signature = (path, *, logo=None, valid_until=None, record=None, force=false))]
    fn certificate(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arg::path)] path: PathBuf,
        #[pyo3(from_py_with = arg::logo)] logo: Option<PathBuf>,
        #[pyo3(from_py_with = arg::valid_until)] valid_until: Option<String>,
        #[pyo3(from_py_with = arg::record)] record: Option<Record>,
        #[pyo3(from_py_with = arg::force)] force: bool,
    ) -> PyResult<()> {
        let file = self.file();
        let until = valid_until.as_deref().map(|day| ("valid_until", day));
        let stated = file.record.clone().overridden(&record.unwrap_or_default());
        let stated = stated.overridden(&Record::of(until).map_err(raise)?);
        let logo = logo.as_deref().map(poecal_formats::logo::read).transpose().map_err(raise)?;
        let existing = if force { Existing::Replaced } else { Existing::Own };
        let place = reserved_file(py, &path, existing, &[])?;
        // The checksum is that of calibration.json as it is written.
        let sha256 = file.sha256().map_err(raise)?;
        let attest = report::Attest { sha256: Some(sha256), logo };
        py.detach(|| place.write(report::certificate_page(file, &stated, &attest))).map_err(raise)
    }

    /// Poses of the tip, or of a target.
    ///
    /// Parameters
    /// ----------
    /// joints
    ///     Configurations, shape (m, n), radians and metres, in the order of `robot.reading_names`; or one, shape (n,).
    /// with_uncertainty
    ///     Whether to give the expected error of each pose too.
    /// frame
    ///     Frame of the poses: "base" or "device".
    /// target
    ///     Name of a target, default the tip.
    /// model
    ///     Which model predicts: "corrected", where there is one, or "calibrated", geometry alone.
    /// readings
    ///     What the arrays are: "model", readings of the model, or "controller", what the controller counts, as the calibration's mapping said; needed where
    ///     these differ.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray or Prediction
    ///     Poses of shape (m, 4, 4), or (4, 4) for one configuration; with `with_uncertainty` a `Prediction`, always of m poses.
    #[pyo3(signature = (joints, *, with_uncertainty=false, frame="base", target=None, model="corrected", readings=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn predict<'py>(
        &self,
        py: Python<'py>,
        joints: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = arg::with_uncertainty)] with_uncertainty: bool,
        #[pyo3(from_py_with = arg::frame)] frame: &str,
        #[pyo3(from_py_with = arg::target)] target: Option<&str>,
        #[pyo3(from_py_with = arg::model)] model: &str,
        #[pyo3(from_py_with = arg::readings)] readings: Option<&str>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let counting = reach::counting(self.file(), readings)?;
        let frame =
            chosen("frame", frame, &[("base", PredictionFrame::Base), ("device", PredictionFrame::Device)])?;
        let model = &self.actual(model)?.model;
        let joints = Joints::of(joints, &model.robot)?;
        let width = model.robot.reading_names().len();
        let found = py
            .detach(|| {
                let readings = reach::to_model(counting.as_ref(), &joints.readings, width);
                predicted(model, &readings, frame, target, with_uncertainty)
            })
            .map_err(raise)?;
        match found.doubts {
            Some(doubts) => Prediction { poses: found.poses, doubts }.into_bound_py_any(py),
            None => poses(py, &found.poses, joints.single),
        }
    }

    /// Poses of the tip in the base, by all threads: those of `predict`, at chosen values of factors.
    ///
    /// Parameters
    /// ----------
    /// joints
    ///     Configurations, shape (m, n), radians and metres, in the order of `robot.reading_names` without factors; or one, shape (n,).
    /// factors
    ///     Values of the corrected model's factors by their names, default their references.
    /// model
    ///     Which model is the robot as it is: "corrected", where there is one, or "calibrated", geometry alone.
    /// readings
    ///     What the arrays are: "model", readings of the model, or "controller", what the controller counts, as the calibration's mapping said; needed where
    ///     these differ.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Poses of shape (m, 4, 4), or (4, 4) for one configuration.
    #[pyo3(signature = (joints, *, factors=None, model="corrected", readings=None))]
    fn forward_kinematics<'py>(
        &self,
        py: Python<'py>,
        joints: &Bound<'py, PyAny>,
        factors: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arg::model)] model: &str,
        #[pyo3(from_py_with = arg::readings)] readings: Option<&str>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let robot = &self.actual(model)?.model.robot;
        let counting = reach::counting(self.file(), readings)?;
        reach::forward(py, robot, (joints, counting.as_ref()), &reach::factors(robot, factors)?)
    }

    /// How the tip moves with each reading: the motion of its point, then its turn, in the axes of the base. What weights add is in it.
    ///
    /// Parameters
    /// ----------
    /// joints
    ///     Configurations, shape (m, n), radians and metres, in the order of `robot.reading_names` without factors; or one, shape (n,).
    /// factors
    ///     Values of the corrected model's factors by their names, default their references.
    /// model
    ///     Which model is the robot as it is: "corrected", where there is one, or "calibrated", geometry alone.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Shape (m, 6, n), or (6, n) for one configuration: three rows in m/rad (m/m of sliding joints), then three in rad/rad (rad/m).
    #[pyo3(signature = (joints, *, factors=None, model="corrected"))]
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        joints: &Bound<'py, PyAny>,
        factors: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arg::model)] model: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let robot = &self.actual(model)?.model.robot;
        reach::jacobian(py, robot, joints, &reach::factors(robot, factors)?)
    }

    /// What weights move the tip, from where it would be without what joints and links give under weights.
    ///
    /// How far its point is shifted and how far it is turned, in the axes of the base. Zero where the model has no such terms.
    ///
    /// Parameters
    /// ----------
    /// joints
    ///     Configurations, shape (m, n), radians and metres, in the order of `robot.reading_names` without factors; or one, shape (n,).
    /// factors
    ///     Values of the corrected model's factors by their names, default their references.
    /// model
    ///     Which model is the robot as it is: "corrected", where there is one, or "calibrated", geometry alone.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Shape (m, 6), or (6,) for one configuration: the shift in metres, then the turn as a rotation vector in radians.
    #[pyo3(signature = (joints, *, factors=None, model="corrected"))]
    fn sag<'py>(
        &self,
        py: Python<'py>,
        joints: &Bound<'py, PyAny>,
        factors: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arg::model)] model: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let robot = &self.actual(model)?.model.robot;
        reach::sag(py, robot, joints, &reach::factors(robot, factors)?)
    }

    /// Joint readings to command so that the robot as it is has its tip where a program for the nominal robot meant it.
    ///
    /// Parameters
    /// ----------
    /// joints
    ///     Readings of the program, shape (m, n), radians and metres, in the order of `robot.reading_names` without factors; or one, shape (n,).
    /// factors
    ///     Values of the corrected model's factors by their names, default their references.
    /// nearest
    ///     Whether to give the nearest configuration where a pose cannot be reached, instead of leaving the row as it is.
    /// most_turn_deg, most_slide_mm
    ///     How far a joint that turns, or slides, may be moved beyond its zero, default 2 degrees and 2 mm. A row that takes more, at a singularity, stays as it is.
    /// most_turn_rad, most_slide_m
    ///     The same in radians and metres.
    /// summary
    ///     Whether to give the summary as well.
    /// model
    ///     Which model is the robot as it is: "corrected", where there is one, or "calibrated", geometry alone.
    /// readings
    ///     What the arrays are: "model", readings of the model, or "controller", what the controller counts, as the calibration's mapping said; needed where
    ///     these differ.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Readings to command, of the same shape. Rows that stay as they are are named by a PoecalWarning. With summary=True a tuple of these and a
    ///     `Compensation`: `targets` has every row that is corrected, by its index (`line`), `listed` every other one and why.
    #[pyo3(signature = (joints, *, factors=None, nearest=false, most_turn_deg=None, most_slide_mm=None, most_turn_rad=None, most_slide_m=None, summary=false, model="corrected", readings=None))]
    #[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
    fn compensate<'py>(
        &self,
        py: Python<'py>,
        joints: &Bound<'py, PyAny>,
        factors: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arg::nearest)] nearest: bool,
        #[pyo3(from_py_with = arg::most_turn_deg)] most_turn_deg: Option<f64>,
        #[pyo3(from_py_with = arg::most_slide_mm)] most_slide_mm: Option<f64>,
        #[pyo3(from_py_with = arg::most_turn_rad)] most_turn_rad: Option<f64>,
        #[pyo3(from_py_with = arg::most_slide_m)] most_slide_m: Option<f64>,
        #[pyo3(from_py_with = arg::summary)] summary: bool,
        #[pyo3(from_py_with = arg::model)] model: &str,
        #[pyo3(from_py_with = arg::readings)] readings: Option<&str>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let actual = self.actual(model)?;
        let taught = self.file().taught(&actual.model.robot).map_err(raise)?;
        let factors = reach::factors(&actual.model.robot, factors)?;
        let most = reach::Most {
            turn_deg: most_turn_deg,
            slide_mm: most_slide_mm,
            turn_rad: most_turn_rad,
            slide_m: most_slide_m,
        };
        let options = reach::change(nearest, most)?;
        let counting = reach::counting(self.file(), readings)?;
        let joints = (joints, counting.as_ref());
        reach::compensate(py, (&taught.robot, &actual.model.robot), joints, &factors, &options, summary)
    }

    /// The nominal robot with base and tool of the actual one: corrected programs take the actual robot to where this one would be.
    ///
    /// Parameters
    /// ----------
    /// model
    ///     Which model is the robot as it is: "corrected", where there is one, or "calibrated", geometry alone.
    ///
    /// Returns
    /// -------
    /// Robot
    ///     That robot.
    #[pyo3(signature = (*, model="corrected"))]
    fn taught(&self, #[pyo3(from_py_with = arg::model)] model: &str) -> PyResult<Robot> {
        let actual = self.actual(model)?;
        let taught = self.file().taught(&actual.model.robot).map_err(raise)?;
        Ok(actual.with_robot(taught.robot))
    }

    /// A robot program with its targets corrected in place, everything else as it was, byte for byte.
    ///
    /// Parameters
    /// ----------
    /// path
    ///     The program for the nominal robot: URScript (.script), RAPID (.mod, .prg, .sys), KRL (.src, .dat) or of FANUC (.ls).
    /// language
    ///     Its language, default by the end of its name.
    /// tools
    ///     Tools in the controller's flange, each "NUMBERS", the tool of programs that set none, or "NAME=NUMBERS"; numbers as the language writes poses.
    /// frames
    ///     Frames of poses (work object, base, user frame) in the controller's base, as tools.
    /// base
    ///     The controller's base in the model's, default the same.
    /// flange
    ///     The controller's flange in the model's tip, default the same.
    /// start
    ///     Readings where the robot is before the first motion, "J1,J2,…" as the language writes joints: of programs that begin with a pose and state no configuration.
    /// factors
    ///     Values of the corrected model's factors by their names, default their references.
    /// nearest
    ///     Whether to write the nearest configuration where the robot cannot reach a target, instead of leaving it as it is.
    /// most_turn_deg, most_slide_mm
    ///     How far a joint that turns, or slides, may be moved beyond its zero, default 2 degrees and 2 mm. A target that takes more, at a singularity, stays as it is and is listed.
    /// most_turn_rad, most_slide_m
    ///     The same in radians and metres.
    /// third_axis
    ///     From where J3 of a program of FANUC counts: "level" or "arm"; default as the calibration's mapping says and its rows show.
    /// check
    ///     Whether to compute what is left once more, from the written text.
    /// model
    ///     Which model is the robot as it is: "corrected", where there is one, or "calibrated", geometry alone.
    ///
    /// Returns
    /// -------
    /// tuple of bytes and Compensation
    ///     The program, and the summary: how many targets are corrected, which are listed as they are and why, the largest corrections, and what is left.
    #[pyo3(signature = (path, *, language=None, tools=None, frames=None, base=None, flange=None, start=None, factors=None, nearest=false, most_turn_deg=None, most_slide_mm=None, most_turn_rad=None, most_slide_m=None, third_axis=None, check=false, model="corrected"))]
    #[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
    fn compensate_program<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = arg::path)] path: PathBuf,
        #[pyo3(from_py_with = arg::language)] language: Option<String>,
        #[pyo3(from_py_with = arg::tools)] tools: Option<Vec<String>>,
        #[pyo3(from_py_with = arg::frames)] frames: Option<Vec<String>>,
        #[pyo3(from_py_with = arg::base)] base: Option<String>,
        #[pyo3(from_py_with = arg::flange)] flange: Option<String>,
        #[pyo3(from_py_with = arg::start)] start: Option<String>,
        factors: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arg::nearest)] nearest: bool,
        #[pyo3(from_py_with = arg::most_turn_deg)] most_turn_deg: Option<f64>,
        #[pyo3(from_py_with = arg::most_slide_mm)] most_slide_mm: Option<f64>,
        #[pyo3(from_py_with = arg::most_turn_rad)] most_turn_rad: Option<f64>,
        #[pyo3(from_py_with = arg::most_slide_m)] most_slide_m: Option<f64>,
        #[pyo3(from_py_with = arg::third_axis)] third_axis: Option<&str>,
        #[pyo3(from_py_with = arg::check)] check: bool,
        #[pyo3(from_py_with = arg::model)] model: &str,
    ) -> PyResult<(Bound<'py, PyBytes>, Bound<'py, PyAny>)> {
        let actual = self.actual(model)?;
        let taught = self.file().taught(&actual.model.robot).map_err(raise)?;
        let factors = reach::factors(&actual.model.robot, factors)?;
        let language = reach::language(&path, language.as_deref())?;
        let most = reach::Most {
            turn_deg: most_turn_deg,
            slide_mm: most_slide_mm,
            turn_rad: most_turn_rad,
            slide_m: most_slide_m,
        };
        let change = reach::change(nearest, most)?;
        let third_axis = third_axis
            .map(|word| chosen("third_axis", word, &[("level", ThirdAxis::Level), ("arm", ThirdAxis::Arm)]))
            .transpose()?;
        if third_axis.is_some() && language != Language::Fanuc {
            return Err(argument(
                "third_axis",
                format!("found it for {}, expected a program of FANUC", language.title()),
            ));
        }
        let Counted { controller, is_third_axis_open } =
            self.file().counted(&taught.robot, third_axis).map_err(raise)?;
        let mut options = ProgramOptions {
            change,
            check,
            each: true,
            controller,
            is_third_axis_open,
            ..ProgramOptions::of(language)
        };
        for words in tools.iter().flatten() {
            options.given.add_tool(words, language).map_err(raise)?;
        }
        for words in frames.iter().flatten() {
            options.given.add_frame(words, language).map_err(raise)?;
        }
        if let Some(words) = base {
            options.given.set_base(&words, language).map_err(raise)?;
        }
        if let Some(words) = flange {
            options.given.set_flange(&words, language).map_err(raise)?;
        }
        if let Some(words) = start {
            options.given.set_start(&words, language).map_err(raise)?;
        }
        options.given = options.given.taught(&taught.base, &taught.tool);
        reach::program(py, (&taught.robot, &actual.model.robot), &path, &factors, &options)
    }

    /// Configurations that have the tip at poses.
    ///
    /// Parameters
    /// ----------
    /// poses
    ///     Poses of the tip in the base, shape (m, 4, 4), or one, (4, 4).
    /// near
    ///     Configurations to which the found ones are nearest, shape (m, n), or one for all, (n,); default all branches, of a robot with six turning joints.
    /// held
    ///     Of a robot with seven turning joints: a mapping from the reading that is held to its value (rad), or to one for each pose, shape (m,); then all branches
    ///     of the others are found.
    /// limits
    ///     Whether to keep the joints' limits.
    /// factors
    ///     Values of the corrected model's factors by their names, default their references.
    /// model
    ///     Which model is the robot as it is: "corrected", where there is one, or "calibrated", geometry alone.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray or list of numpy.ndarray
    ///     With `near` the nearest configuration of each pose, shape (m, n), or (n,) for one pose, NaN where there is none; without, the branches of each
    ///     pose, a list of arrays of shape (k, n), or one array for one pose.
    #[pyo3(signature = (poses, *, near=None, held=None, limits=true, factors=None, model="corrected"))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn ik<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        near: Option<&Bound<'py, PyAny>>,
        held: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arg::limits)] limits: bool,
        factors: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arg::model)] model: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let actual = self.actual(model)?;
        let factors = reach::factors(&actual.model.robot, factors)?;
        reach::inverse(py, actual, poses, (near, held), &factors, limits)
    }

    /// Judges the calibration by measurements that it did not see; every row counts.
    ///
    /// Parameters
    /// ----------
    /// measurements
    ///     The measurements.
    /// refit_frame
    ///     Whether to refit the device's frame to them.
    /// refit_tool
    ///     Whether to refit the targets to them.
    /// refit
    ///     "auto" refits the device's frame where the measurements show that the device stands elsewhere; "never" says it.
    /// accept
    ///     Limits that the errors must meet, like "0.2mm" or "0.2mm,max:0.5mm,0.05deg"; see `poecal.calibrate`.
    /// accept_model
    ///     Which model must meet them: "corrected", if there is one, or "calibrated".
    /// out
    ///     Folder for the results of the check: validation.json, errors.csv with each row beside its bound, and a report.
    /// force
    ///     Whether to write over results of a check and a report that exist.
    /// report
    ///     Whether to write a report among the results, or the path of another file for it.
    /// record
    ///     What the report states of this session, by key; see `poecal.calibrate`.
    /// history
    ///     File to which the check is appended as a line, like the history.jsonl that the program keeps beside a calibration.
    ///
    /// Returns
    /// -------
    /// Validation
    ///     Errors of the nominal and the calibrated robot, their share inside the predicted bounds, and `acceptance`.
    #[pyo3(signature = (measurements, *, refit_frame=false, refit_tool=false, refit="never", accept=None, accept_model="corrected", out=None, force=false, report=None,
                        record=None, history=None),
           text_signature = "($self, measurements, *, refit_frame=False, refit_tool=False, refit='never', accept=None, accept_model='corrected', out=None, force=False, report=True, record=None, history=None)")]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn validate(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arg::measurements)] measurements: &Measurements,
        #[pyo3(from_py_with = arg::refit_frame)] refit_frame: bool,
        #[pyo3(from_py_with = arg::refit_tool)] refit_tool: bool,
        #[pyo3(from_py_with = arg::refit)] refit: &str,
        #[pyo3(from_py_with = arg::accept)] accept: Option<AcceptanceLimits>,
        #[pyo3(from_py_with = arg::accept_model)] accept_model: &str,
        #[pyo3(from_py_with = arg::out)] out: Option<PathBuf>,
        #[pyo3(from_py_with = arg::force)] force: bool,
        #[pyo3(from_py_with = arg::report)] report: Option<ReportPlace>,
        #[pyo3(from_py_with = arg::record)] record: Option<Record>,
        #[pyo3(from_py_with = arg::history)] history: Option<PathBuf>,
    ) -> PyResult<Findings> {
        measurements.check_robot(self.calibrated()?)?;
        let limits = accept_limits(accept, accept_model)?;
        let refit_moved = chosen("refit", refit, &[("never", false), ("auto", true)])?;
        let judging = Judging { refit_frame, refit_moved, refit_tool, accept: limits.as_ref() };
        let places =
            validated::Places::reserve(py, (self, measurements), (out.as_deref(), force), report, history)?;
        places.judge(py, (self, measurements), &judging, record.unwrap_or_default())
    }

    /// Which unknowns measurements of the calibrated robot in given configurations would determine; see `poecal.identify`.
    ///
    /// Parameters
    /// ----------
    /// joints
    ///     Configurations, shape (m, n), radians and metres, in the order of `robot.reading_names`.
    /// kind
    ///     Kind of the measurements of the tip: "pose", "point", or "mixed" (both in turn).
    /// sigma_position_mm, sigma_rotation_deg
    ///     Standard deviation of each measured component (default 0.05 mm, 0.01 deg).
    /// frame
    ///     The measuring device's frame: "unknown" or "base".
    /// robot_error_mm
    ///     Error of the tip (RMS) that a calibration leaves however much is measured, or that and the one with corrections (default what this calibration left).
    ///
    /// Returns
    /// -------
    /// Identification
    ///     What would be determined, and the expected error.
    #[pyo3(signature = (joints, *, kind="pose", sigma_position_mm=None, sigma_rotation_deg=None, frame="unknown", robot_error_mm=None))]
    #[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
    fn identify(
        &self,
        py: Python<'_>,
        joints: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = arg::kind)] kind: &str,
        #[pyo3(from_py_with = arg::sigma_position_mm)] sigma_position_mm: Option<f64>,
        #[pyo3(from_py_with = arg::sigma_rotation_deg)] sigma_rotation_deg: Option<f64>,
        #[pyo3(from_py_with = arg::frame)] frame: &str,
        #[pyo3(from_py_with = arg::robot_error_mm)] robot_error_mm: Option<RobotError>,
    ) -> PyResult<Findings> {
        findings::identify(
            py,
            self.calibrated()?,
            joints,
            kind,
            sigma_position_mm,
            sigma_rotation_deg,
            frame,
            robot_error_mm.or_else(|| self.file().left_error()),
        )
    }

    /// Seconds that the library took for the fit; None if it was read. What a call took beyond them is Python's.
    #[getter]
    fn library_seconds(&self) -> Option<f64> {
        self.seconds()
    }

    fn __str__(&self) -> String {
        self.summary().to_owned()
    }

    fn __repr__(&self) -> String {
        let file = self.file();
        let (set, name) = match &file.accuracy.held_out {
            Some(set) => (set, "held-out"),
            None => (&file.accuracy.training, "fitted"),
        };
        let verdict = file.verdict.as_ref().map_or("no verdict", |verdict| verdict.level.words());
        let delivered = self.delivered();
        let after = match delivered {
            AcceptedModel::Corrected => set.corrected.unwrap_or(set.calibrated),
            AcceptedModel::Calibrated => set.calibrated,
        };
        let [before, error] = [set.registered, after].map(|it| number(it.lead().rms));
        let unit = after.leading().map_or("mm", |(quantity, _)| quantity.unit().symbol());
        let expected = file.verdict.as_ref().and_then(|verdict| verdict.expected_error_mm);
        let expected = expected.map_or_else(String::new, |it| format!(", {} mm expected", number(it)));
        format!(
            "<poecal.Calibration of {}: {verdict}, {} model {error} {unit} RMS on {} {name} rows{expected} (your model, tool and device located: {before})>",
            file.robot.name,
            delivered.word(),
            set.count
        )
    }

    fn _repr_html_(&self) -> String {
        notebook::calibration(self.file(), self.delivered(), &self.warnings())
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        let Ok(other) = other.cast::<Calibration>() else { return false };
        let other = other.get();
        let residuals = |it: &Calibration| it.rows().ok().map(Rows::text);
        self.file() == other.file()
            && self.nominal.model == other.nominal.model
            && residuals(self) == residuals(other)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        pickle::reduce(py, "_calibration", &self.state()?)
    }

    fn __copy__(slf: Bound<'_, Self>) -> Bound<'_, Self> {
        slf
    }

    fn __deepcopy__<'py>(slf: Bound<'py, Self>, _memo: &Bound<'_, PyAny>) -> Bound<'py, Self> {
        slf
    }
}
