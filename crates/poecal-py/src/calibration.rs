//! A finished calibration.

mod content;

pub(crate) use content::Calibration;
use content::part;

use std::path::{Path, PathBuf};

use maud::html;
use numpy::PyArray2;
use poecal::io::calibration_file::CalibrationFile;
use poecal::io::model::{Model, ModelSource};
use poecal::io::output::{self, Contents, Existing, Results};
use poecal::io::predictions::{PredictionFrame, predicted};
use poecal::io::residuals::{ResidualRows, Residuals};
use poecal::report;
use poecal::text::visible_markup;
use pyo3::IntoPyObjectExt as _;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::accuracy::{Accuracy, Verdict};
use crate::arrays::{Joints, pose_array};
use crate::errors::{python_words, raise};
use crate::findings::{self, Findings};
use crate::measurements::Measurements;
use crate::pickle;
use crate::places::{reserved_file, reserved_folder, said};
use crate::prediction::Prediction;
use crate::robot::{Robot, poses};
use crate::words::chosen;

/// Place of a report: among the results, a file, or none.
#[derive(FromPyObject)]
enum ReportPlace {
    Among(bool),
    File(PathBuf),
}

#[pymethods]
impl Calibration {
    /// Reads a calibration.json, and the residuals.csv beside it (or `residuals`) if there is one.
    #[staticmethod]
    #[pyo3(signature = (path, *, residuals=None))]
    fn read(path: PathBuf, residuals: Option<PathBuf>) -> PyResult<Self> {
        let file = CalibrationFile::read(&path).map_err(raise)?;
        let in_file = |error: poecal::Error| raise(error.in_file(&path));
        let robot = file.robot().map_err(in_file)?;
        let nominal = file.nominal_robot().map_err(in_file)?;
        let beside = path.with_file_name("residuals.csv");
        let residuals = residuals.or_else(|| beside.is_file().then_some(beside));
        let residuals = residuals.map(Residuals::read).transpose().map_err(raise)?;
        let summary = report::summary(&file, report::Detail::Short);
        let nominal = Robot::new(Model { robot: nominal, source: ModelSource::Toml, path });
        Ok(Calibration::written(nominal, robot, file, residuals, summary))
    }

    /// The calibrated robot, with the targets in its tip frame.
    #[getter]
    fn robot(&self) -> PyResult<Robot> {
        Ok(self.calibrated()?.clone())
    }

    /// The nominal robot.
    #[getter]
    fn nominal(&self) -> Robot {
        self.nominal.clone()
    }

    /// Errors of the nominal, registered and calibrated model on fitted and held-out rows.
    #[getter]
    fn accuracy(&self) -> Accuracy {
        self.errors().into()
    }

    /// Verdict; None for a file without one.
    #[getter]
    fn verdict(&self) -> Option<Verdict> {
        self.judged().cloned().map(Verdict)
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

    /// The whole calibration.json as dicts and lists.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        part(py, self.file())
    }

    /// The text of calibration.json.
    fn to_json(&self) -> PyResult<String> {
        self.file().to_text().map_err(raise)
    }

    /// The text of residuals.csv: residuals of each row.
    fn residuals_csv(&self) -> PyResult<String> {
        Ok(self.residuals()?.text())
    }

    /// Writes the results to a folder, as the program does: calibration.json, the calibrated model, residuals.csv and report.html.
    ///
    /// All is written or nothing, and the models are read back and compared with the fit. `report` may be False, or another file.
    /// Gives the names of the files.
    #[pyo3(signature = (folder, *, force=false, report=None), text_signature = "($self, folder, *, force=False, report=True)")]
    fn write(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        force: bool,
        report: Option<ReportPlace>,
    ) -> PyResult<Vec<String>> {
        let report = report.unwrap_or(ReportPlace::Among(true));
        let (file, residuals) = (self.file(), self.residuals()?);
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
                    Some(report::calibration_page(file, residuals)?)
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

    /// Writes the report, one HTML file; over a file that is no report of poecal only with `force`.
    #[pyo3(signature = (path, *, force=false))]
    fn report(&self, py: Python<'_>, path: PathBuf, force: bool) -> PyResult<()> {
        let (file, residuals) = (self.file(), self.residuals()?);
        let existing = if force { Existing::Replaced } else { Existing::Own };
        let place = reserved_file(py, &path, existing, &[])?;
        py.detach(|| place.write(report::calibration_page(file, residuals)?)).map_err(raise)
    }

    /// Poses of the calibrated tip, or of a target.
    ///
    /// `joints` is of shape (m, n), radians and metres, or (n,) for one configuration. Gives poses of shape (m, 4, 4), or (4, 4), in
    /// the `frame` "base" or "device"; with `with_uncertainty` a `Prediction`, with the expected error of each.
    #[pyo3(signature = (joints, *, with_uncertainty=false, frame="base", target=None))]
    fn predict<'py>(
        &self,
        py: Python<'py>,
        joints: &Bound<'py, PyAny>,
        with_uncertainty: bool,
        frame: &str,
        target: Option<&str>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let frame =
            chosen("frame", frame, &[("base", PredictionFrame::Base), ("device", PredictionFrame::Device)])?;
        let model = &self.calibrated()?.model;
        let joints = Joints::of(joints, &model.robot)?;
        let found = py
            .detach(|| predicted(model, &joints.readings, frame, target, with_uncertainty))
            .map_err(raise)?;
        match found.doubts {
            Some(doubts) => Prediction { poses: found.poses, doubts }.into_bound_py_any(py),
            None => poses(py, &found.poses, joints.single),
        }
    }

    /// Judges the calibration by measurements that it did not see; every row counts.
    ///
    /// `refit_frame` refits the device's frame to them, `refit_tool` the targets.
    #[pyo3(signature = (measurements, *, refit_frame=false, refit_tool=false))]
    fn validate(
        &self,
        py: Python<'_>,
        measurements: &Measurements,
        refit_frame: bool,
        refit_tool: bool,
    ) -> PyResult<Findings> {
        measurements.check_robot(self.calibrated()?)?;
        let file = self.file();
        let data = measurements.data();
        let judgement = py.detach(|| file.judge(data, refit_frame, refit_tool)).map_err(raise)?;
        let names = measurements.source.names.join(", ");
        let text =
            report::judgement(&self.calibrated()?.model.path.display().to_string(), &names, &judgement);
        let doubts: Vec<String> = file.doubt(&judgement).into_iter().collect();
        crate::warn(py, &doubts)?;
        Findings::new(text, &judgement, doubts)
    }

    /// Which unknowns measurements of the calibrated robot in these configurations would determine; see `identify`.
    #[pyo3(signature = (joints, *, kind="pose", sigma_position_mm=None, sigma_rotation_deg=None, frame="unknown"))]
    fn identify(
        &self,
        py: Python<'_>,
        joints: &Bound<'_, PyAny>,
        kind: &str,
        sigma_position_mm: Option<f64>,
        sigma_rotation_deg: Option<f64>,
        frame: &str,
    ) -> PyResult<Findings> {
        findings::identify(py, self.calibrated()?, joints, kind, sigma_position_mm, sigma_rotation_deg, frame)
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
        let verdict = file.verdict.as_ref().map_or("", |verdict| verdict.level.words());
        format!(
            "<poecal.Calibration of {}: {:.4} mm (RMS) on {} {name} rows, nominal {:.4} mm; verdict {verdict}>",
            file.robot.name, set.calibrated.position_mm.rms, set.count, set.nominal.position_mm.rms
        )
    }

    fn _repr_html_(&self) -> String {
        let file = self.file();
        let fitted = ("fitted", &file.accuracy.training);
        let sets = std::iter::once(fitted).chain(file.accuracy.held_out.iter().map(|set| ("held out", set)));
        visible_markup(html! {
            div {
                @if let Some(verdict) = &file.verdict {
                    p { (file.robot.name) ": " (verdict.level.words()) " (" (verdict.reasons.join("; ")) ")" }
                }
                table {
                    tr { @for name in ["error (RMS)", "rows", "nominal", "registered", "calibrated"] { th { (name) } } }
                    @for (name, set) in sets {
                        @let models = [&set.nominal, &set.registered, &set.calibrated];
                        tr {
                            td { "position, " (name) } td { (set.count) }
                            @for model in models { td { (format_args!("{:.4} mm", model.position_mm.rms)) } }
                        }
                        @if let [Some(a), Some(b), Some(c)] = models.map(|model| model.rotation_deg) {
                            tr {
                                td { "rotation, " (name) } td { (set.count) }
                                @for it in [a, b, c] { td { (format_args!("{:.4}°", it.rms)) } }
                            }
                        }
                    }
                }
                @for warning in self.warnings() { p { "warning: " (warning) } }
            }
        })
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        let Ok(other) = other.cast::<Calibration>() else { return false };
        let other = other.get();
        let residuals = |it: &Calibration| it.residuals().ok().map(Residuals::text);
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
