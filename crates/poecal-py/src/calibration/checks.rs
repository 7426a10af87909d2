//! A calibration judged by other measurements, and the determination of the unknowns by planned ones.

use std::path::PathBuf;

use poecal_calibrate::AcceptanceLimits;
use poecal_cli::words::{self, RefitChoice};
use poecal_plan::plan::RobotError;
use poecal_results::record::Record;
use poecal_results::validation::ValidationOptions;
use pyo3::prelude::*;

use super::content::Calibration;
use super::report_place::ReportDestination;
use super::validation;
use crate::arguments::{self as arg, WordSet};
use crate::calibrate::accept_limits;
use crate::findings::{self, Findings};
use crate::measurements::Measurements;

#[pymethods]
impl Calibration {
    /// Judges the calibration by measurements that it did not use; every row counts.
    ///
    /// Parameters
    /// ----------
    /// measurements
    ///     The measurements.
    /// refit
    ///     Parts that are refitted to them: "device" (its frame), "tool" (the targets), or a list of both. "auto" refits the device's frame if the
    ///     measurements show that the device moved; otherwise such a move is only reported.
    /// accept
    ///     Limits that the errors must meet, like "0.2mm" or "0.2mm,max:0.5mm,0.05deg"; see `poecal.calibrate`.
    /// accept_model
    ///     Model that must meet them: "corrected", if there is one, or "calibrated".
    /// out
    ///     Folder for the results of the check: validation.json, errors.csv with each row beside its bound, and a report.
    /// force
    ///     True to overwrite existing results of a check and a report.
    /// report
    ///     True to write a report among the results, or the path of another file for it.
    /// record
    ///     Statements of the report about this session, by key; see `poecal.calibrate`.
    /// history
    ///     File to which the check is appended as a line, like the history.jsonl that the program keeps beside a calibration.
    ///
    /// Returns
    /// -------
    /// Validation
    ///     Errors of the nominal and the calibrated robot, their share inside the predicted bounds, and `acceptance`.
    #[pyo3(signature = (measurements, *, refit=None, accept=None, accept_model="corrected", out=None, force=false, report=None,
                        record=None, history=None),
           text_signature = "($self, measurements, *, refit=None, accept=None, accept_model='corrected', out=None, force=False, report=True, record=None, history=None)")]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn validate(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arg::measurements)] measurements: &Measurements,
        #[pyo3(from_py_with = arg::refit)] refit: Option<WordSet>,
        #[pyo3(from_py_with = arg::accept)] accept: Option<AcceptanceLimits>,
        #[pyo3(from_py_with = arg::accept_model)] accept_model: &str,
        #[pyo3(from_py_with = arg::out)] out: Option<PathBuf>,
        #[pyo3(from_py_with = arg::force)] force: bool,
        #[pyo3(from_py_with = arg::report)] report: Option<ReportDestination>,
        #[pyo3(from_py_with = arg::record)] record: Option<Record>,
        #[pyo3(from_py_with = arg::history)] history: Option<PathBuf>,
    ) -> PyResult<Findings> {
        measurements.check_robot(self.calibrated_robot()?)?;
        let limits = accept_limits(accept, accept_model)?;
        let refit = refit.map(|it| it.choose("refit", words::REFIT)).transpose()?;
        let [refit_frame, refit_tool, refit_moved] = [RefitChoice::Device, RefitChoice::Tool, RefitChoice::Auto]
            .map(|what| refit.iter().flatten().any(|it| *it == what));
        let judging = ValidationOptions { refit_frame, refit_moved, refit_tool, accept: limits.as_ref() };
        let places =
            validation::ValidateOutputs::reserve(py, (self, measurements), (out.as_deref(), force), report, history)?;
        places.judge(py, (self, measurements), &judging, record.unwrap_or_default())
    }

    /// Unknowns that measurements of the calibrated robot in stated configurations would determine; see `poecal.identify`.
    ///
    /// Parameters
    /// ----------
    /// joints
    ///     Configurations, shape (m, n), radians and metres, in the order of `robot.reading_names`.
    /// kind
    ///     Kind of the measurements of the tip: "pose", "point", or "mixed" (both in turn).
    /// sigma_position_mm, sigma_rotation_deg
    ///     Standard deviation of each measured component (default 0.05 mm, 0.01 deg).
    /// device_frame
    ///     The measuring device's frame: "unknown" or "base".
    /// robot_error_mm
    ///     Remaining error of the tip (RMS) after a calibration with any number of rows, or that and the one with corrections (default those of this
    ///     calibration).
    ///
    /// Returns
    /// -------
    /// Identification
    ///     The unknowns that would be determined, and the expected error.
    #[pyo3(signature = (joints, *, kind="pose", sigma_position_mm=None, sigma_rotation_deg=None, device_frame="unknown", robot_error_mm=None))]
    #[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
    fn identify(
        &self,
        py: Python<'_>,
        joints: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = arg::kind)] kind: &str,
        #[pyo3(from_py_with = arg::sigma_position_mm)] sigma_position_mm: Option<f64>,
        #[pyo3(from_py_with = arg::sigma_rotation_deg)] sigma_rotation_deg: Option<f64>,
        #[pyo3(from_py_with = arg::device_frame)] device_frame: &str,
        #[pyo3(from_py_with = arg::robot_error_mm)] robot_error_mm: Option<RobotError>,
    ) -> PyResult<Findings> {
        findings::identify(
            py,
            self.calibrated_robot()?,
            joints,
            kind,
            sigma_position_mm,
            sigma_rotation_deg,
            device_frame,
            robot_error_mm.or_else(|| self.file().left_error()),
        )
    }
}
