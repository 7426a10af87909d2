//! Simulated sessions.

use std::path::PathBuf;

use numpy::PyArray2;
use poecal_calibrate::DeviceFrameKnowledge;
use poecal_model::robot::{Corrections, Sizes, TermGroup};
use poecal_model::simulate::{self as simulated, SessionKind, SimulationResult};
use poecal_numerics::text::escape_invisible;
use poecal_results::model::{Model, ModelSource};
use poecal_results::output::{self, Contents, ExistingFiles, SimulatedSession};
use pyo3::prelude::*;

use crate::arguments as arg;
use crate::arrays::pose_array;
use crate::errors::raise;
use crate::measurements::Measurements;
use crate::output_places::reserved_folder;
use crate::robot::Robot;
use crate::words::{direction, frame as frame_word, from_mm, kind as kind_word, size};

/// Most rows of a simulation, as in the program.
const MOST: usize = 10_000_000;

/// A simulated session: nominal and actual robot, and measurements of the actual one.
#[pyclass(frozen, module = "poecal", name = "Simulation")]
pub(crate) struct Simulation {
    nominal: Robot,
    simulation: simulated::Simulation,
    kind: SessionKind,
    made: SimulationResult,
    held_out: Option<poecal_model::measurement::Dataset>,
    command: String,
}

#[pymethods]
impl Simulation {
    /// The nominal robot.
    #[getter]
    fn nominal(&self) -> Robot {
        self.nominal.clone()
    }

    /// The actual robot.
    #[getter]
    fn actual(&self) -> Robot {
        let robot = self.made.actual.clone();
        let path = robot.name.clone().into();
        Robot::new(Model { robot, source: ModelSource::Toml, path })
    }

    /// The measurements.
    #[getter]
    fn measurements(&self) -> Measurements {
        Measurements::in_memory(self.made.data.clone(), "simulated")
    }

    /// Further rows, free of noise, for validation of a calibration; None if none were requested.
    #[getter]
    fn held_out(&self) -> Option<Measurements> {
        self.held_out.clone().map(|data| Measurements::in_memory(data, "simulated, held out"))
    }

    /// Pose of the base in the measuring device, shape (4, 4).
    #[getter]
    fn device_from_base<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        pose_array(py, &self.made.device_from_base)
    }

    /// Writes both robots, the measurements and the truth to a folder, as the program does.
    ///
    /// Parameters
    /// ----------
    /// folder
    ///     The folder.
    /// force
    ///     True to overwrite files that exist.
    ///
    /// Returns
    /// -------
    /// list of str
    ///     Names of the files.
    #[pyo3(signature = (folder, *, force=false))]
    fn write(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arg::folder)] folder: PathBuf,
        #[pyo3(from_py_with = arg::force)] force: bool,
    ) -> PyResult<Vec<String>> {
        let session = SimulatedSession {
            simulation: &self.simulation,
            kind: self.kind,
            made: &self.made,
            held_out: self.held_out.as_ref(),
            command: &self.command,
        };
        let model = &self.nominal.model;
        let existing = ExistingFiles::from_switch(force);
        let place = reserved_folder(py, &folder, Contents::Simulation, existing, &[&model.path])?;
        let written = py.detach(|| output::write_simulation(place, model, &session)).map_err(raise)?;
        crate::warn(py, &written.notes)?;
        Ok(written.files)
    }

    fn __repr__(&self) -> String {
        format!("<poecal.Simulation of {}: {} rows>", self.made.nominal.name, self.made.data.len())
    }
}

/// Simulates a robot with errors and its measurements, for tests and for learning.
///
/// Parameters
/// ----------
/// robot
///     The nominal robot, from which the actual one deviates.
/// kind
///     Kind of the measurements: "pose", "point", or "mixed" (both in turn).
/// count
///     Number of measurements.
/// seed
///     Seed of everything random.
/// error_position_mm, error_rotation_deg
///     Distance and angle of the error of every axis, and of the tip.
/// noise_position_mm, noise_rotation_deg
///     Standard deviation of each measured component.
/// device_frame
///     The measuring device's frame: "unknown" or "base".
/// held_out_count
///     Number of further measurements, free of noise, for validation of a calibration.
/// terms
///     Joint effects beyond geometry: "off", or groups of terms with the standard deviations of their coefficients in radians or metres, as a dict
///     (also of texts with a unit) or "sag=1e-3,ratio=1e-4".
/// gravity
///     Direction of gravity in the robot's base frame, default (0, 0, -1).
///
/// Returns
/// -------
/// Simulation
///     Both robots, and the measurements of the actual one.
#[pyfunction]
#[pyo3(signature = (robot, *, kind="pose", count=50, seed=1, error_position_mm=2.0, error_rotation_deg=1.0, noise_position_mm=0.05,
                    noise_rotation_deg=0.01, device_frame="unknown", held_out_count=0, terms=None, gravity=None),
        text_signature = "(robot, *, kind='pose', count=50, seed=1, error_position_mm=2.0, error_rotation_deg=1.0, noise_position_mm=0.05, noise_rotation_deg=0.01, device_frame='unknown', held_out_count=0, terms='off', gravity=(0, 0, -1))")]
#[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
pub(crate) fn simulate(
    py: Python<'_>,
    #[pyo3(from_py_with = arg::robot)] robot: &Robot,
    #[pyo3(from_py_with = arg::kind)] kind: &str,
    #[pyo3(from_py_with = arg::count)] count: usize,
    #[pyo3(from_py_with = arg::seed)] seed: u64,
    #[pyo3(from_py_with = arg::error_position_mm)] error_position_mm: f64,
    #[pyo3(from_py_with = arg::error_rotation_deg)] error_rotation_deg: f64,
    #[pyo3(from_py_with = arg::noise_position_mm)] noise_position_mm: f64,
    #[pyo3(from_py_with = arg::noise_rotation_deg)] noise_rotation_deg: f64,
    #[pyo3(from_py_with = arg::device_frame)] device_frame: &str,
    #[pyo3(from_py_with = arg::held_out_count)] held_out_count: usize,
    #[pyo3(from_py_with = arg::terms)] terms: Option<Corrections>,
    #[pyo3(from_py_with = arg::gravity)] gravity: Option<[f64; 3]>,
) -> PyResult<Simulation> {
    for (name, number, least) in [("count", count, 1), ("held_out_count", held_out_count, 0)] {
        if !(least..=MOST).contains(&number) {
            return Err(crate::errors::argument(name, format!("found {number}, expected {least} to {MOST}")));
        }
    }
    let simulation = simulated::Simulation {
        error_rotation_rad: size("error_rotation_deg", error_rotation_deg, f64::to_radians)?,
        error_position_m: size("error_position_mm", error_position_mm, from_mm)?,
        noise_position_m: size("noise_position_mm", noise_position_mm, from_mm)?,
        noise_rotation_rad: size("noise_rotation_deg", noise_rotation_deg, f64::to_radians)?,
        count,
        seed,
        device_anywhere: frame_word(device_frame)? == DeviceFrameKnowledge::Unknown,
        terms: sizes(terms)?,
        gravity: direction(gravity.unwrap_or([0.0, 0.0, -1.0]))?,
    };
    let kind = kind_word(kind)?;
    let nominal = &robot.model.robot;
    let work = || {
        let made = simulation.run(nominal, kind)?;
        let held_out = match held_out_count {
            0 => None,
            count => Some(simulation.held_out(&made, kind, count)?),
        };
        Ok((made, held_out))
    };
    let (made, held_out) = py.detach(work).map_err(raise)?;
    let command = format!(
        "poecal.simulate({}, kind=\"{}\", count={count}, seed={seed}, error_position_mm={error_position_mm:?}, \
         error_rotation_deg={error_rotation_deg:?}, noise_position_mm={noise_position_mm:?}, noise_rotation_deg={noise_rotation_deg:?}, \
         device_frame=\"{device_frame}\", held_out_count={held_out_count})",
        escape_invisible(&robot.model.path.display().to_string()),
        kind.word()
    );
    let command = with_terms(command, &simulation);
    // With the factors of its terms.
    let nominal = robot.with_robot(made.nominal.clone());
    Ok(Simulation { nominal, simulation, kind, made, held_out, command })
}

/// Sizes of the terms that a simulated robot has.
fn sizes(terms: Option<Corrections>) -> PyResult<Sizes> {
    let word = match terms {
        None | Some(Corrections::Off) => return Ok(Sizes::NONE),
        Some(Corrections::Sizes(sizes)) => return Ok(sizes),
        Some(Corrections::Auto) => "auto",
        Some(Corrections::All) => "all",
    };
    Err(crate::errors::argument("terms", format!("found {word}, expected off, or groups with sizes")))
}

/// The command of a simulation with its terms, if it has any.
fn with_terms(command: String, simulation: &simulated::Simulation) -> String {
    if simulation.terms == Sizes::NONE {
        return command;
    }
    let used = TermGroup::ALL.into_iter().filter(|&group| simulation.terms[group] > 0.0);
    let used: Vec<String> = used.map(|group| format!("{}={:e}", group.name(), simulation.terms[group])).collect();
    let [x, y, z]: [f64; 3] = simulation.gravity.into();
    let command = command.trim_end_matches(')');
    format!("{command}, terms=\"{}\", gravity=({x:?}, {y:?}, {z:?}))", used.join(","))
}
