//! Results of a calibration as files and texts.

use std::path::{Path, PathBuf};

use poecal_calibrate::AcceptedModel;
use poecal_cli::words;
use poecal_report as report;
use poecal_results::export::{ExportFormat, ExportOptions, export};
use poecal_results::output::{self, Contents, ExistingFiles, Results};
use poecal_results::record::Record;
use poecal_results::residuals::ResidualRows;
use poecal_results::shapes::Shapes;
use pyo3::prelude::*;

use super::content::Calibration;
use super::report_place::ReportDestination;
use crate::arguments as arg;
use crate::errors::raise;
use crate::output_places::{reserved_file, reserved_folder, warn_messages};
use crate::words::{choose_word, one_of};

#[pymethods]
impl Calibration {
    /// Writes the results to a folder, as the program does: calibration.json, the calibrated model, residuals.csv and report.html.
    ///
    /// All is written or nothing, and the models are read back and compared with the fit.
    ///
    /// Parameters
    /// ----------
    /// folder
    ///     The folder.
    /// force
    ///     True to overwrite files that exist.
    /// report
    ///     True to write the report too, or the path of another file for it.
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
    ///     Written files did not reproduce the fitted model.
    #[pyo3(signature = (folder, *, force=false, report=None), text_signature = "($self, folder, *, force=False, report=True)")]
    fn write(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arg::folder)] folder: PathBuf,
        #[pyo3(from_py_with = arg::force)] force: bool,
        #[pyo3(from_py_with = arg::report)] report: Option<ReportDestination>,
    ) -> PyResult<Vec<String>> {
        let report = report.unwrap_or(ReportDestination::Among(true));
        let (file, residuals) = (self.file(), self.rows()?);
        let (robot, model) = (self.as_fitted(), &self.nominal.model);
        let existing = ExistingFiles::from_switch(force);
        let measured = file.inputs.measurements.iter().map(Path::new);
        let inputs: Vec<&Path> = std::iter::once(model.path.as_path()).chain(measured).collect();
        let place = reserved_folder(py, &folder, Contents::Calibration, existing, &inputs)?;
        let elsewhere = match &report {
            ReportDestination::File(path) => warn_messages(py, |say| place.reserve_report(path, &inputs, say))?,
            ReportDestination::Among(_) => None,
        };
        let written = py.detach(|| {
            let page = match &report {
                ReportDestination::Among(false) => None,
                ReportDestination::Among(true) | ReportDestination::File(_) => {
                    let shapes = Shapes::read(file, &folder.join("calibration.json"));
                    Some(report::calibration_page_with(file, residuals, &shapes)?)
                }
            };
            let results = Results { file: file.clone(), residuals: ResidualRows::AtHand(residuals), report: page };
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
    ///     "pal", "lerobot", "mjcf", "sdf", "usd", "csv", "offsets", "tf" or "c".
    /// model
    ///     "calibrated", geometry alone, or "corrected", whose terms of the joints a form of geometry leaves out, with a warning.
    /// hash
    ///     The controller's checksum, for "ur".
    /// motors
    ///     The text of LeRobot's existing calibration of motors, for "lerobot".
    ///
    /// Returns
    /// -------
    /// str
    ///     The text. A warning names the properties that the form cannot hold.
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
        let format = choose_word("format", format, &words)?;
        let robot = match one_of("model", model, words::MODEL)? {
            AcceptedModel::Corrected => self.optional_corrected_robot()?.unwrap_or(self.calibrated_robot()?),
            AcceptedModel::Calibrated => self.calibrated_robot()?,
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
    /// record
    ///     Statements beside and in place of the calibration's record, as {"serial": "4711"}.
    /// force
    ///     True to overwrite a file that is no report of poecal.
    #[pyo3(signature = (path, *, record=None, force=false))]
    fn report(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arg::path)] path: PathBuf,
        #[pyo3(from_py_with = arg::record)] record: Option<Record>,
        #[pyo3(from_py_with = arg::force)] force: bool,
    ) -> PyResult<()> {
        let residuals = self.rows()?;
        let mut file = self.file().clone();
        file.record = file.record.override_with(&record.unwrap_or_default());
        let file = &file;
        let existing = if force { ExistingFiles::Replaced } else { ExistingFiles::Own };
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
    /// record
    ///     Statements beside and in place of the calibration's record, as {"serial": "4711"} or {"valid_until": "2027-11-28"}.
    /// force
    ///     True to overwrite a file that is not poecal's.
    #[pyo3(signature = (path, *, logo=None, record=None, force=false))]
    fn certificate(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arg::path)] path: PathBuf,
        #[pyo3(from_py_with = arg::logo)] logo: Option<PathBuf>,
        #[pyo3(from_py_with = arg::record)] record: Option<Record>,
        #[pyo3(from_py_with = arg::force)] force: bool,
    ) -> PyResult<()> {
        let file = self.file();
        let stated = file.record.clone().override_with(&record.unwrap_or_default());
        let logo = logo.as_deref().map(poecal_formats::logo::read).transpose().map_err(raise)?;
        let existing = if force { ExistingFiles::Replaced } else { ExistingFiles::Own };
        let place = reserved_file(py, &path, existing, &[])?;
        // The checksum is that of the written calibration.json.
        let sha256 = file.sha256().map_err(raise)?;
        let attest = report::CertificateExtras { sha256: Some(sha256), logo };
        py.detach(|| place.write(report::certificate_page(file, &stated, &attest))).map_err(raise)
    }
}
