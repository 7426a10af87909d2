//! Readings and programs that are corrected by a calibration.

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::PyBytes;

use super::content::Calibration;
use super::programs;
use crate::arguments as arg;
use crate::errors::raise;
use crate::reach;
use crate::robot::Robot;
use crate::warn;

#[pymethods]
impl Calibration {
    /// Joint readings by which the actual robot's tip reaches the poses of a program for the nominal robot.
    ///
    /// Parameters
    /// ----------
    /// joints
    ///     Readings of the program, shape (m, n), radians and metres, in the order of `robot.reading_names` without factors; or one, shape (n,).
    /// factors
    ///     Values of the corrected model's factors by their names, default their references.
    /// nearest
    ///     True to return the nearest configuration if a pose cannot be reached, instead of leaving the row unchanged.
    /// max_turn_deg, max_slide_mm
    ///     Largest change of a joint that turns, or slides, beyond its zero, default 2 degrees and 2 mm. A row that needs more, at a singularity, is
    ///     unchanged.
    /// max_turn_rad, max_slide_m
    ///     The same limits in radians and metres.
    /// summary
    ///     True to return the summary as well.
    /// model
    ///     Model of the actual robot: "corrected", if there is one, or "calibrated", geometry alone.
    /// readings
    ///     Meaning of the arrays: "model", readings of the model, or "controller", the controller's counts, by the calibration's mapping; required if
    ///     these differ.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Readings to command, of the same shape. A PoecalWarning names the unchanged rows. With summary=True a tuple of these and a `Compensation`:
    ///     `targets` has every corrected row by its index (`line`), `listed` every other one with the reason.
    #[pyo3(signature = (joints, *, factors=None, nearest=false, max_turn_deg=None, max_slide_mm=None, max_turn_rad=None, max_slide_m=None, summary=false, model="corrected", readings=None))]
    #[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
    fn compensate<'py>(
        &self,
        py: Python<'py>,
        joints: &Bound<'py, PyAny>,
        factors: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arg::nearest)] nearest: bool,
        #[pyo3(from_py_with = arg::max_turn_deg)] max_turn_deg: Option<f64>,
        #[pyo3(from_py_with = arg::max_slide_mm)] max_slide_mm: Option<f64>,
        #[pyo3(from_py_with = arg::max_turn_rad)] max_turn_rad: Option<f64>,
        #[pyo3(from_py_with = arg::max_slide_m)] max_slide_m: Option<f64>,
        #[pyo3(from_py_with = arg::summary)] summary: bool,
        #[pyo3(from_py_with = arg::model)] model: &str,
        #[pyo3(from_py_with = arg::readings)] readings: Option<&str>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.warn_of_gain(py)?;
        let actual = self.actual_robot(model)?;
        let taught = self.file().taught_robot(&actual.model.robot).map_err(raise)?;
        let factors = reach::factors(&actual.model.robot, factors)?;
        let most = reach::MaxCorrectionArgument {
            turn_deg: max_turn_deg,
            slide_mm: max_slide_mm,
            turn_rad: max_turn_rad,
            slide_m: max_slide_m,
        };
        let options = reach::change(nearest, most)?;
        let counting = reach::find_controller_map(self.file(), readings)?;
        let joints = (joints, counting.as_ref());
        reach::compensate(py, (&taught.robot, &actual.model.robot), joints, &factors, &options, summary)
    }

    /// The nominal robot with base and tool of the actual one: corrected programs move the actual robot to the poses of this one.
    ///
    /// Parameters
    /// ----------
    /// model
    ///     Model of the actual robot: "corrected", if there is one, or "calibrated", geometry alone.
    ///
    /// Returns
    /// -------
    /// Robot
    ///     That robot.
    #[pyo3(signature = (*, model="corrected"))]
    fn taught(&self, #[pyo3(from_py_with = arg::model)] model: &str) -> PyResult<Robot> {
        let actual = self.actual_robot(model)?;
        let taught = self.file().taught_robot(&actual.model.robot).map_err(raise)?;
        Ok(actual.with_robot(taught.robot))
    }

    /// A robot program with its targets corrected in place; everything else is unchanged, byte for byte.
    ///
    /// Parameters
    /// ----------
    /// path
    ///     The program for the nominal robot: URScript (.script), RAPID (.mod, .prg, .sys), KRL (.src, .dat) or of FANUC (.ls).
    /// language
    ///     Its language, by default from the extension of its name.
    /// tool_data
    ///     Tools in the controller's flange, each "NUMBERS", the tool of programs that set none, or "NAME=NUMBERS"; numbers in the language's
    ///     notation of poses.
    /// work_objects
    ///     Frames of poses (work object, base, user frame) in the controller's base, as tools.
    /// controller_base
    ///     The controller's base in the model's, default the same.
    /// controller_flange
    ///     The controller's flange in the model's tip, default the same.
    /// start
    ///     Readings of the robot before the first motion, "J1,J2,…" in the language's notation of joints: for programs that begin with a pose and
    ///     state no configuration.
    /// factors
    ///     Values of the corrected model's factors by their names, default their references.
    /// nearest
    ///     True to write the nearest configuration if the robot cannot reach a target, instead of leaving it unchanged.
    /// max_turn_deg, max_slide_mm
    ///     Largest change of a joint that turns, or slides, beyond its zero, default 2 degrees and 2 mm. A target that needs more, at a singularity,
    ///     is unchanged and listed.
    /// max_turn_rad, max_slide_m
    ///     The same limits in radians and metres.
    /// third_axis
    ///     Zero of J3 in a program of FANUC: "level" or "arm"; by default from the calibration's mapping and its rows.
    /// check
    ///     True to compute the remaining error once more, from the written text.
    /// model
    ///     Model of the actual robot: "corrected", if there is one, or "calibrated", geometry alone.
    ///
    /// Returns
    /// -------
    /// tuple of bytes and Compensation
    ///     The program, and the summary: the number of corrected targets, the unchanged ones with the reason, the largest corrections, and the
    ///     remaining error.
    #[pyo3(signature = (path, *, language=None, tool_data=None, work_objects=None, controller_base=None, controller_flange=None, start=None, factors=None, nearest=false, max_turn_deg=None, max_slide_mm=None, max_turn_rad=None, max_slide_m=None, third_axis=None, check=false, model="corrected"))]
    #[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
    fn compensate_program<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = arg::path)] path: PathBuf,
        #[pyo3(from_py_with = arg::language)] language: Option<String>,
        #[pyo3(from_py_with = arg::tool_data)] tool_data: Option<Vec<String>>,
        #[pyo3(from_py_with = arg::work_objects)] work_objects: Option<Vec<String>>,
        #[pyo3(from_py_with = arg::controller_base)] controller_base: Option<String>,
        #[pyo3(from_py_with = arg::controller_flange)] controller_flange: Option<String>,
        #[pyo3(from_py_with = arg::start)] start: Option<String>,
        factors: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arg::nearest)] nearest: bool,
        #[pyo3(from_py_with = arg::max_turn_deg)] max_turn_deg: Option<f64>,
        #[pyo3(from_py_with = arg::max_slide_mm)] max_slide_mm: Option<f64>,
        #[pyo3(from_py_with = arg::max_turn_rad)] max_turn_rad: Option<f64>,
        #[pyo3(from_py_with = arg::max_slide_m)] max_slide_m: Option<f64>,
        #[pyo3(from_py_with = arg::third_axis)] third_axis: Option<&str>,
        #[pyo3(from_py_with = arg::check)] check: bool,
        #[pyo3(from_py_with = arg::model)] model: &str,
    ) -> PyResult<(Bound<'py, PyBytes>, Bound<'py, PyAny>)> {
        let most = reach::MaxCorrectionArgument {
            turn_deg: max_turn_deg,
            slide_mm: max_slide_mm,
            turn_rad: max_turn_rad,
            slide_m: max_slide_m,
        };
        self.warn_of_gain(py)?;
        let stated = programs::ProgramSettings {
            language,
            tools: tool_data,
            frames: work_objects,
            base: controller_base,
            flange: controller_flange,
            start,
            third_axis,
        };
        programs::compensate(py, (self, model), (&path, stated), factors, (nearest, most), check)
    }
}

impl Calibration {
    /// Warns if programs are not to be corrected with this calibration.
    fn warn_of_gain(&self, py: Python<'_>) -> PyResult<()> {
        warn(py, self.file().gain_doubt().as_slice())
    }
}
