//! `recalibrate`: recalibration of one joint.

use poecal_report as report;
use poecal_results::calibration_file::{Inputs, RecalibrationSources, RepairedPart};
use poecal_results::track::{Baseline, recalibrate as repaired};
use pyo3::prelude::*;

use crate::arguments as arg;
use crate::calibration::Calibration;
use crate::errors::raise;
use crate::findings::visit_options;
use crate::measurements::Measurements;

/// Recalibrates the zero or the axis of one joint by the few measurements of a visit, with everything else held.
///
/// Parameters
/// ----------
/// calibration
///     The earlier calibration.
/// measurements
///     Measurements of the visit, as of `track`.
/// earlier
///     The rows of the calibration, or those of an earlier visit; None: the visit is judged by the model.
/// part
///     Recalibrated part: the zero of a joint ("joint2" or "joint2.offset"), or its axis ("joint2.axis").
/// device
///     "refit" if the device was set up anew, so that its frame is fitted; "known" if it stands where it stood.
/// tool
///     "same" if the tool stayed on the flange; "refit" if it was mounted anew, so that its targets are fitted.
/// repeatability_mm
///     Standard deviation of one visit and coordinate; None: estimated from repeats within a visit and from the changes that no explanation removes.
///
/// Returns
/// -------
/// Calibration
///     The calibration with this joint corrected. `write(folder)` writes it.
#[pyfunction]
#[pyo3(signature = (calibration, measurements, earlier=None, *, part, device="refit", tool="same", repeatability_mm=None))]
#[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
pub(crate) fn recalibrate(
    py: Python<'_>,
    calibration: &Calibration,
    #[pyo3(from_py_with = arg::measurements)] measurements: &Measurements,
    #[pyo3(from_py_with = arg::earlier)] earlier: Option<&Measurements>,
    #[pyo3(from_py_with = arg::part)] part: &str,
    #[pyo3(from_py_with = arg::device)] device: &str,
    #[pyo3(from_py_with = arg::tool)] tool: &str,
    #[pyo3(from_py_with = arg::repeatability_mm)] repeatability_mm: Option<f64>,
) -> PyResult<Calibration> {
    let options = visit_options(device, tool, repeatability_mm)?;
    let (joint, what) = RepairedPart::from_name(part);
    let source = calibration.source().filter(|path| path.is_file());
    let own = Inputs::checksums(source.into_iter()).map_err(raise)?;
    let read = [Some(measurements), earlier].into_iter().flatten().map(|it| &it.source);
    let sources = RecalibrationSources {
        measurements: measurements.source.names.clone(),
        calibration: source.map_or_else(String::new, |path| path.display().to_string()),
        sha256: own.into_iter().chain(read.flat_map(|it| it.sha256.clone())).collect(),
    };
    let earlier = earlier.map(|it| Baseline { data: it.data(), is_own: true });
    let (file, data) = (calibration.file(), measurements.data());
    let found = py.detach(|| repaired(file, data, earlier, &options, (joint, what), sources));
    let found = found.map_err(raise)?;
    crate::warn(py, &found.notes)?;
    let summary = report::summary(&found.file, report::Detail::Short);
    let robot = found.file.robot().map_err(raise)?;
    Ok(calibration.with_result(robot, found.file, summary))
}
