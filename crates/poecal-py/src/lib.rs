//! The compiled half of the Python package `poecal`: conversions between Python and the library, and nothing else.
//!
//! For the Python package, whose interface follows semantic versioning. `calibrate.rs` turns words and units to options, calls the library as the
//! program does, without the interpreter's lock, and keeps the result; file, residuals, arrays and dicts are made on demand. The package calls the
//! program too, as a function of its arguments, so that one wheel installs both. Not here: computation, and rules.

mod arguments;
mod arrays;
mod build;
mod calibrate;
mod calibration;
mod convert;
mod covariance;
mod errors;
mod hand_eye;
mod iso9283;
mod measurements;
mod notebook;
mod of_model;
mod output_places;
mod paths;
mod pickle;
mod plan;
mod prediction;
mod project;
mod reach;
mod reproduce;
mod robot;
mod rows;
mod simulation;
mod units;
mod watch;
mod words;

use measurements::{from_arrays, from_dataframe, guess};

use calibration::{accuracy, findings, recalibrate, residuals};

use plan::{plan_options, plan_result, test_plan, visit_plan};

use pyo3::prelude::*;

/// Warns as the program does on standard error, a sentence each.
fn warn(py: Python<'_>, sentences: &[String]) -> PyResult<()> {
    if sentences.is_empty() {
        return Ok(());
    }
    let category = py.import("poecal._errors")?.getattr("PoecalWarning")?;
    let warn = py.import("warnings")?.getattr("warn")?;
    let level = level_of_caller(py)?;
    for sentence in sentences {
        warn.call1((errors::python_words(sentence), &category, level))?;
    }
    Ok(())
}

/// The level of the frame that calls the package, beyond those of `poecal._keywords`.
fn level_of_caller(py: Python<'_>) -> PyResult<usize> {
    let mut frame = py.import("sys")?.call_method0("_getframe")?;
    let mut level = 1;
    let is_ours = |frame: &Bound<'_, PyAny>| frame.getattr("f_globals")?.get_item("__name__")?.eq("poecal._keywords");
    while !frame.is_none() && is_ours(&frame).unwrap_or(false) {
        frame = frame.getattr("f_back")?;
        level += 1;
    }
    Ok(level)
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
    use crate::convert::{export, read_joints, schema};
    #[pymodule_export]
    use crate::covariance::Covariance;
    #[pymodule_export]
    use crate::findings::{check, compare, identify, offsets, track};
    #[pymodule_export]
    use crate::guess::guess_columns;
    #[pymodule_export]
    use crate::hand_eye::{hand_eye, tcp};
    #[pymodule_export]
    use crate::iso9283::iso9283;
    #[pymodule_export]
    use crate::measurements::Measurements;
    #[pymodule_export]
    use crate::plan::plan;
    #[pymodule_export]
    use crate::plan_result::Plan;
    #[pymodule_export]
    use crate::prediction::Prediction;
    #[pymodule_export]
    use crate::project::init;
    #[pymodule_export]
    use crate::recalibrate::recalibrate;
    #[pymodule_export]
    use crate::reproduce::reproduce;
    #[pymodule_export]
    use crate::residuals::Residuals;
    #[pymodule_export]
    use crate::robot::Robot;
    #[pymodule_export]
    use crate::simulation::{Simulation, simulate};
    #[pymodule_export]
    use crate::test_plan::TestPlan;
    #[pymodule_export]
    use crate::visit_plan::_write_text;
    #[pymodule_export]
    use crate::watch::Watch;

    /// Initialises the module. A level of vector instructions that `POECAL_SIMD` names and this machine does not have is refused before anything is
    /// computed. Keywords that a function does not have are answered with the nearest one.
    #[pymodule_init]
    fn begin(module: &Bound<'_, PyModule>) -> PyResult<()> {
        let refused = |sentence| crate::errors::raise(poecal_numerics::error::ErrorKind::Option.error(sentence));
        poecal_fit::problem::stated_level().map(drop).map_err(refused)?;
        module.py().import("poecal._keywords")?.call_method1("answer", (module,)).map(drop)
    }

    /// The version of poecal.
    ///
    /// Returns
    /// -------
    /// str
    ///     The version from which this module was built.
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
        if !(1..=poecal_numerics::threads::MOST_THREADS).contains(&count) {
            let message =
                format!("found {count}, expected a number from 1 to {}", poecal_numerics::threads::MOST_THREADS);
            return Err(crate::errors::argument("count", message));
        }
        rayon::ThreadPoolBuilder::new().num_threads(count).build_global().map_err(|_| {
            crate::errors::argument(
                "count",
                "found threads at work already, expected a call before anything is computed",
            )
        })
    }

    /// Sets a limit of files, if the default is less than they need.
    ///
    /// Parameters
    /// ----------
    /// name
    ///     The limit: `rows`, `columns`, `text`, `cells`, `bag` and the others of SECURITY.md.
    /// most
    ///     The number, of bytes also as a text such as `"2GiB"`. It holds for all calls from then on.
    #[pyfunction]
    fn set_limit(name: &str, most: &Bound<'_, PyAny>) -> PyResult<()> {
        let typed = format!("{name}={}", most.str()?.to_cow()?);
        let (limit, most) = poecal_storage::limits::parse(&typed).map_err(crate::errors::raise)?;
        poecal_storage::limits::set(limit, most);
        Ok(())
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

    /// A result in the form of a notebook.
    #[pyfunction]
    fn _shown(text: &str, warnings: Vec<String>) -> String {
        crate::notebook::findings(text, &warnings)
    }

    /// The present keyword for an old one, among these.
    #[pyfunction]
    fn _renamed(word: &str, words: Vec<String>) -> Option<String> {
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        poecal_results::renamed_words::new_key(word, &words).map(str::to_owned)
    }

    /// The most similar of some words.
    #[pyfunction]
    fn _nearest(word: &str, words: Vec<String>) -> Option<String> {
        poecal_numerics::error::nearest_word(word, words.iter().map(String::as_str)).map(str::to_owned)
    }
}
