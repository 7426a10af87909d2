//! The compiled half of the Python package `poecal`: conversions between Python and the library, and nothing else.

mod accuracy;
mod arguments;
mod arrays;
mod build;
mod calibrate;
mod calibration;
mod convert;
mod covariance;
mod errors;
mod findings;
mod from_arrays;
mod from_dataframe;
mod hand_eye;
mod measurements;
mod notebook;
mod paths;
mod pickle;
mod places;
mod plan;
mod prediction;
mod project;
mod reach;
mod residuals;
mod robot;
mod rows;
mod simulation;
mod words;

use pyo3::prelude::*;

/// Warns as the program does on standard error, a sentence each.
fn warn(py: Python<'_>, sentences: &[String]) -> PyResult<()> {
    if sentences.is_empty() {
        return Ok(());
    }
    let category = py.import("poecal._errors")?.getattr("PoecalWarning")?;
    let warn = py.import("warnings")?.getattr("warn")?;
    for sentence in sentences {
        warn.call1((errors::python_words(sentence), &category, 1))?;
    }
    Ok(())
}

/// The compiled half of the Python package `poecal`.
#[pymodule]
mod _poecal {
    use std::ffi::OsString;

    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::accuracy::{Accuracy, ModelAccuracy, SetAccuracy, Statistic, Verdict};
    #[pymodule_export]
    use crate::calibrate::calibrate;
    #[pymodule_export]
    use crate::calibration::Calibration;
    #[pymodule_export]
    use crate::convert::{convert, read_joints, schema};
    #[pymodule_export]
    use crate::covariance::Covariance;
    #[pymodule_export]
    use crate::findings::{Findings, check, compare, identify, offsets, reproduce, track};
    #[pymodule_export]
    use crate::hand_eye::{hand_eye, tcp};
    #[pymodule_export]
    use crate::measurements::Measurements;
    #[pymodule_export]
    use crate::plan::{Plan, Watch, plan};
    #[pymodule_export]
    use crate::prediction::Prediction;
    #[pymodule_export]
    use crate::project::init;
    #[pymodule_export]
    use crate::residuals::Residuals;
    #[pymodule_export]
    use crate::robot::Robot;
    #[pymodule_export]
    use crate::simulation::{Simulation, simulate};

    /// A level of vector instructions that `POECAL_SIMD` names and this machine does not have is refused before anything is computed.
    #[pymodule_init]
    fn check_level(_module: &Bound<'_, PyModule>) -> PyResult<()> {
        let refused = |sentence| crate::errors::raise(poecal::ErrorKind::Option.error(sentence));
        poecal::problem::stated_level().map(drop).map_err(refused)
    }

    /// The version of poecal.
    ///
    /// Returns
    /// -------
    /// str
    ///     The version that this module was built from.
    #[pyfunction]
    fn version() -> &'static str {
        env!("CARGO_PKG_VERSION")
    }

    /// Sets the number of threads that all work shares; results do not depend on it.
    ///
    /// Parameters
    /// ----------
    /// count
    ///     From 1 to 256. It can be set once, before anything is computed.
    #[pyfunction]
    fn set_threads(#[pyo3(from_py_with = crate::arguments::count)] count: usize) -> PyResult<()> {
        if !(1..=poecal::MOST_THREADS).contains(&count) {
            let message = format!("found {count}, expected a number from 1 to {}", poecal::MOST_THREADS);
            return Err(crate::errors::argument("count", message));
        }
        rayon::ThreadPoolBuilder::new().num_threads(count).build_global().map_err(|_| {
            crate::errors::argument(
                "count",
                "found threads at work already, expected a call before anything is computed",
            )
        })
    }

    /// Runs the program `poecal`.
    ///
    /// Parameters
    /// ----------
    /// arguments
    ///     The program's name, and its arguments.
    ///
    /// Returns
    /// -------
    /// int
    ///     The exit code.
    #[pyfunction]
    fn run_program(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
        py.detach(|| poecal_cli::run_process(arguments))
    }

    #[pyfunction]
    fn _robot(state: &[u8]) -> PyResult<Robot> {
        Robot::of_state(crate::pickle::value(state)?)
    }

    #[pyfunction]
    fn _measurements(state: &[u8]) -> PyResult<Measurements> {
        Measurements::of_state(state)
    }

    #[pyfunction]
    fn _calibration(state: &[u8]) -> PyResult<Calibration> {
        Calibration::of_state(crate::pickle::value(state)?)
    }

    #[pyfunction]
    fn _findings(state: &[u8]) -> PyResult<Findings> {
        crate::pickle::value(state)
    }
}
