//! `iso9283`: accuracy and repeatability as a data sheet states them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use poecal_calibrate::FigureLimit;
use poecal_cli::words;
use poecal_import::ReadOptions;
use poecal_report as report;
use poecal_results::iso9283::{StatedTest, TestOptions, judge_test};
use poecal_results::output::ExistingFiles;
use poecal_results::record::Record;
use pyo3::prelude::*;

use crate::arguments as arg;
use crate::errors::{argument, raise};
use crate::findings::Findings;
use crate::output_places::reserved_file;
use crate::paths;
use crate::words::{one_of, sigmas};

/// Accuracy and repeatability of a robot after ISO 9283:1998, each figure with its 95 % interval.
///
/// Parameters
/// ----------
/// measurements
///     Path of the rows: commanded and measured poses, and the columns pose, cycle, approach, series, arm, speed, payload as far as there are any.
/// robot
///     The robot whose joint readings the rows have instead of commanded_x, commanded_y, commanded_z, or the path of its model; of a calibration.json also
///     the accuracy of corrected commands is predicted.
/// device_frame
///     The measuring device's frame: "unknown", "base" or "calibration".
/// sigma_position_mm, sigma_rotation_deg
///     Standard deviation of the instrument in each component, for rows that state none.
/// units
///     Units of columns that state none, like "mm,deg".
/// accept
///     Limits that figures must keep, like "AP:0.5mm,RP:0.05mm".
/// record
///     What is stated of the test, by the keys of `poecal calibrate --record`.
/// earlier
///     Path of the rows of the same test before the calibration, whose figures stand beside; with a calibration.json also what they predict.
/// report
///     File for a page (HTML) with all figures, the cube and the scatter of each pose; its print begins with a certificate.
/// certificate
///     Whether that page is the certificate alone, one page of A4.
/// force
///     Whether to write over a file that exists.
///
/// Returns
/// -------
/// Iso9283
///     The "figures", each with "found", "from" and "to" in "unit", and the "decision" on the limits.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
#[pyo3(signature = (measurements, robot=None, *, device_frame="unknown", sigma_position_mm=None, sigma_rotation_deg=None, units=None, accept=None, record=None,
                    earlier=None, report=None, certificate=false, force=false))]
pub(crate) fn iso9283(
    py: Python<'_>,
    #[pyo3(from_py_with = arg::measurements)] measurements: PathBuf,
    robot: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = arg::device_frame)] device_frame: &str,
    #[pyo3(from_py_with = arg::sigma_position_mm)] sigma_position_mm: Option<f64>,
    #[pyo3(from_py_with = arg::sigma_rotation_deg)] sigma_rotation_deg: Option<f64>,
    #[pyo3(from_py_with = arg::units)] units: Option<&str>,
    #[pyo3(from_py_with = arg::accept)] accept: Option<&str>,
    #[pyo3(from_py_with = arg::record)] record: Option<Record>,
    #[pyo3(from_py_with = arg::earlier)] earlier: Option<PathBuf>,
    #[pyo3(from_py_with = arg::report)] report: Option<PathBuf>,
    #[pyo3(from_py_with = arg::certificate)] certificate: bool,
    #[pyo3(from_py_with = arg::force)] force: bool,
) -> PyResult<Findings> {
    if certificate && report.is_none() {
        return Err(argument("certificate", "found it without report, expected the file of the page beside it"));
    }
    let robot = robot.map(paths::robot).transpose()?;
    let model = robot.as_ref().map(|robot| &*robot.get().model);
    let frame = one_of("device_frame", device_frame, words::TEST_FRAME)?;
    let limits = accept
        .map_or(Ok(Vec::new()), |words| words.split(',').map(str::parse).collect::<Result<Vec<FigureLimit>, _>>());
    let limits = limits.map_err(|error| argument("accept", error.message()))?;
    let [sigma_position_m, sigma_rotation_rad] = sigmas(sigma_position_mm, sigma_rotation_deg)?;
    let mut reading = ReadOptions::default();
    units.map_or(Ok(()), |units| reading.state_units(units)).map_err(raise)?;
    let options = TestOptions { reading, frame, sigma_position_m, sigma_rotation_rad };
    let paths: Vec<&Path> = std::iter::once(&measurements).chain(&earlier).map(PathBuf::as_path).collect();
    let page = report.map(|path| reserved_file(py, &path, ExistingFiles::from_switch(force), &paths)).transpose()?;
    let record = record.unwrap_or_default();
    let robot = model.map(|model| (model.path.clone(), BTreeMap::new()));
    let stated = StatedTest { limits, record, robot, command: None };
    let files = (std::slice::from_ref(&measurements), earlier.as_slice());
    let found = py.detach(|| {
        let test = judge_test(files, model, &options, stated)?;
        if let Some(page) = page {
            let make = if certificate { report::test_certificate_page } else { report::test_page };
            page.write(make(&test.result, &test.found, test.before.as_ref()))?;
        }
        Ok((test.result.to_text()?, test.result))
    });
    let (json, test) = found.map_err(raise)?;
    let told = Findings::of_json("Iso9283", report::iso9283(&test), report::iso9283_answer(&test), json);
    Ok(told.with_warnings(&test.warnings))
}
