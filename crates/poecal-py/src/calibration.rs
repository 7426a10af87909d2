//! A finished calibration.

pub(crate) mod accuracy;
pub(crate) mod findings;
pub(crate) mod recalibrate;
pub(crate) mod residuals;

mod checks;
mod compensation;
mod content;
mod poses;
mod programs;
mod report_place;
mod results;
mod validation;

pub(crate) use content::Calibration;
use content::part;

use std::path::PathBuf;

use numpy::PyArray2;
use poecal_calibrate::AcceptedModel;
use poecal_report as report;
use poecal_report::table::number;
use poecal_results::calibration_file::CalibrationFile;
use poecal_results::model::{Model, ModelSource};
use poecal_results::residuals::Residuals as Rows;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::accuracy::{Accuracy, Verdict};
use crate::arguments as arg;
use crate::arrays::pose_array;
use crate::covariance::Covariance;
use crate::errors::{python_words, raise};
use crate::notebook;
use crate::pickle;
use crate::residuals::Residuals;
use crate::robot::Robot;

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
    ///     The calibration, with the same behaviour as before it was written.
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
        Ok(Calibration::from_files(nominal, robot, file, residuals, summary))
    }

    /// The calibrated robot, with the targets in its tip frame.
    #[getter]
    fn robot(&self) -> PyResult<Robot> {
        Ok(self.calibrated_robot()?.clone())
    }

    /// The corrected robot, with compliant joints and terms beside its joints; None if no terms were requested.
    #[getter]
    fn corrected_robot(&self) -> PyResult<Option<Robot>> {
        Ok(self.optional_corrected_robot()?.cloned())
    }

    /// Screws and terms of the joints, fitted together: `corrected` of calibration.json; None if no terms were requested.
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
        Accuracy::new(self.errors(), self.delivered_model())
    }

    /// Permitted use of the calibration, and the reasons against a wider one; an error for a file that does not state it.
    #[getter]
    fn verdict(&self) -> PyResult<Verdict> {
        self.require_verdict().cloned().map(Verdict)
    }

    /// Result of the requested acceptance limits: `acceptance` of calibration.json; None if none were requested.
    #[getter]
    fn acceptance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        part(py, &self.file().acceptance)
    }

    /// Statements about the session: a dict of texts.
    #[getter]
    fn record<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        part(py, &self.file().record)
    }

    /// True if the fit reached an optimum.
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

    /// Errors of programs for the nominal robot over the workspace, and the corrections that remove them.
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

    /// Unknowns that the measurements determine: `identifiability` of calibration.json.
    #[getter]
    fn identifiability<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        part(py, &self.file().identifiability)
    }

    /// Residuals of each row, fitted or held out; an error if the calibration was read without its residuals.csv.
    #[getter]
    fn residuals(slf: &Bound<'_, Self>) -> PyResult<Residuals> {
        Residuals::from_calibration(slf)
    }

    /// Covariance of the unknowns; an error if there are no more residuals than unknowns.
    #[getter]
    fn covariance(&self) -> PyResult<Covariance> {
        Covariance::from_file(self.file())
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

    /// Seconds that the library took for the fit; None if it was read. Further time of a call is Python's.
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
        let delivered = self.delivered_model();
        let after = match delivered {
            AcceptedModel::Corrected => set.corrected.unwrap_or(set.calibrated),
            AcceptedModel::Calibrated => set.calibrated,
        };
        let [before, error] = [set.registered, after].map(|it| number(it.lead().rms));
        let unit = after.leading_value().map_or("mm", |(quantity, _)| quantity.unit().symbol());
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
        notebook::calibration(self.file(), self.delivered_model(), &self.warnings())
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        let Ok(other) = other.cast::<Calibration>() else { return false };
        let other = other.get();
        let residuals = |it: &Calibration| it.rows().ok().map(Rows::text);
        self.file() == other.file() && self.nominal.model == other.nominal.model && residuals(self) == residuals(other)
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
