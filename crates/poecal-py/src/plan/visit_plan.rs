//! `plan` of visits to a calibrated robot: the measured configurations to repeat.

use std::path::PathBuf;

use poecal_calibrate::DeviceFrameKnowledge;
use poecal_cli::words;
use poecal_import::to_measure_again;
use poecal_report as report;
use poecal_results::output::ExistingFiles;
use poecal_results::track::{TrackOptions, witnesses};
use pyo3::prelude::*;
use serde::Serialize;

use crate::arguments::{self as arg, unexpected_error};
use crate::arrays::JointArray;
use crate::calibration::Calibration;
use crate::errors::{argument, raise};
use crate::findings::Findings;
use crate::measurements::Measurements;
use crate::output_places::reserved_file;
use crate::words::{from_mm, one_of, sigma};

/// Most configurations of a visit, as in the program, and their default number.
const MOST: usize = 1000;
const USUAL: usize = 8;

/// Knowledge of the visits.
pub(crate) struct VisitOptions<'a> {
    pub(crate) earlier: Option<&'a Measurements>,
    pub(crate) device: Option<&'a str>,
    pub(crate) tool: Option<&'a str>,
    pub(crate) repeatability_mm: Option<f64>,
    pub(crate) target: Option<&'a str>,
}

/// A plan of visits, its configurations, and the table to fill in.
#[derive(Serialize)]
struct PlannedVisits<'a> {
    #[serde(flatten)]
    told: &'a report::WitnessPlan,
    rows: Vec<VisitRow<'a>>,
    table: String,
}

/// A configuration to measure.
#[derive(Serialize)]
struct VisitRow<'a> {
    /// Readings, radians and metres.
    readings: &'a [f64],
}

impl VisitOptions<'_> {
    /// Refuses statements about visits if none are planned.
    pub(crate) fn refuse(&self) -> PyResult<()> {
        let stated = [
            ("earlier", self.earlier.is_some()),
            ("device", self.device.is_some()),
            ("tool", self.tool.is_some()),
            ("repeatability_mm", self.repeatability_mm.is_some()),
            ("target", self.target.is_some()),
        ];
        match stated.into_iter().find(|it| it.1) {
            Some((name, _)) => Err(argument(name, "found it without purpose=\"drift\", expected both or neither")),
            None => Ok(()),
        }
    }

    /// Chooses the configurations of a calibration's rows, or of candidates.
    pub(crate) fn plan(
        &self,
        py: Python<'_>,
        calibration: &Bound<'_, PyAny>,
        count: Option<usize>,
        candidates: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Findings> {
        let expected = "a poecal.Calibration, as of poecal.calibrate or Calibration.read, with purpose=\"drift\"";
        let calibration =
            calibration.cast::<Calibration>().map_err(|_| unexpected_error("robot", calibration, expected))?;
        let calibration = calibration.get();
        let count = count.unwrap_or(USUAL);
        if !(1..=MOST).contains(&count) {
            return Err(argument("count", format!("found {count}, expected 1 to {MOST}")));
        }
        let (file, robot) = (calibration.file(), &calibration.calibrated_robot()?.model.robot);
        let known = self.device.map(|word| one_of("device", word, words::DEVICE));
        let anew = self.tool.map(|word| one_of("tool", word, words::TOOL));
        let options = TrackOptions {
            device_is_known: known.transpose()?.unwrap_or(file.frame() == DeviceFrameKnowledge::Base),
            tool_is_anew: anew.transpose()?.unwrap_or(false),
            repeatability_m: self.repeatability_mm.map(|it| sigma("repeatability_mm", it, from_mm)).transpose()?,
        };
        let new = candidates.map(|it| JointArray::from_argument(it, robot)).transpose()?;
        let readings = new.as_ref().map(|it| it.readings.as_slice());
        let own;
        let earlier = match self.earlier {
            Some(measurements) => measurements.data(),
            None => {
                own = calibration.own_rows()?;
                &*own
            }
        };
        let work = || {
            let found = witnesses(file, earlier, readings, count, self.target, &options)?;
            let told = report::WitnessPlan::new(&found, &file.robot.name, new.is_some());
            let table = to_measure_again(&found.rows, &found.configurations, robot, new.is_some())?;
            let first = found.configurations.iter().filter_map(|rows| rows.first());
            let rows = first.map(|row| VisitRow { readings: found.rows.readings(*row as usize) }).collect();
            let json = report::json(&PlannedVisits { told: &told, rows, table })?;
            Ok(Findings::of_json("VisitPlan", told.text(), told.answer(), json))
        };
        py.detach(work).map_err(raise)
    }
}

/// Writes a text to a file, as `VisitPlan.write` does.
#[pyfunction]
pub(crate) fn _write_text(
    py: Python<'_>,
    #[pyo3(from_py_with = arg::path)] path: PathBuf,
    #[pyo3(from_py_with = arg::text)] text: String,
    #[pyo3(from_py_with = arg::force)] force: bool,
) -> PyResult<()> {
    let place = reserved_file(py, &path, ExistingFiles::from_switch(force), &[])?;
    py.detach(|| place.write(vec![text.into()])).map_err(raise)
}
