//! `Plan`: a planned list of configurations.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use numpy::{PyArray1, PyArray2, PyArrayMethods as _};
use poecal_import::planned_table;
use poecal_plan::plan::PlanOptions;
use poecal_report as report;
use poecal_results::model::Model;
use poecal_results::output::ExistingFiles;
use poecal_results::plan_program::plan_program;
use pyo3::prelude::*;

use crate::arguments as arg;
use crate::errors::raise;
use crate::output_places::reserved_file;

/// A planned list of configurations. `str` is the program's table, `to_dict` the program's output with `--json`.
#[pyclass(frozen, module = "poecal", name = "Plan")]
pub(crate) struct Plan {
    pub(crate) model: Arc<Model>,
    pub(crate) options: PlanOptions,
    pub(crate) found: poecal_plan::plan::Plan,
    pub(crate) told: report::PlanReport,
}

#[pymethods]
impl Plan {
    /// The configurations in the order in which to measure them, shape (m, n), radians and metres, in the order of `robot.reading_names`.
    #[getter]
    fn joints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let width = self.model.robot.reading_names().len();
        let all: Vec<f64> = self.found.rows.iter().flat_map(|row| row.readings.clone()).collect();
        PyArray1::from_vec(py, all).reshape([self.found.rows.len(), width])
    }

    /// Purpose of each row: "fit" or "held_out".
    #[getter]
    fn sets(&self) -> Vec<&'static str> {
        self.found.rows.iter().map(|row| row.part.set()).collect()
    }

    /// Returns, a bool for each row: True if it is the first configuration again.
    #[getter]
    fn returns(&self) -> Vec<bool> {
        self.found.rows.iter().map(|row| row.returns).collect()
    }

    /// Index of each row among the candidates, if these were stated.
    #[getter]
    fn candidates(&self) -> Vec<Option<usize>> {
        self.found.rows.iter().map(|row| row.candidate).collect()
    }

    /// Expected error of the calibrated model (RMS over the workspace), millimetres.
    #[getter]
    fn expected_calibrated_mm(&self) -> f64 {
        1e3 * self.found.expected.calibrated_m()
    }

    /// Expected error of the corrected model (RMS over the workspace), millimetres.
    #[getter]
    fn expected_corrected_mm(&self) -> f64 {
        1e3 * self.found.expected.corrected_m()
    }

    /// Number of configurations from which ten more gain less than 5 %; None if that is more than 100.
    #[getter]
    fn enough(&self) -> Option<usize> {
        self.found.enough
    }

    /// The plan as dicts and lists: the program's output with `--json`.
    ///
    /// Returns
    /// -------
    /// dict
    ///     The plan, with "curve" and "rows".
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("json")?.call_method1("loads", (self.to_json()?,))
    }

    /// The plan as JSON.
    ///
    /// Returns
    /// -------
    /// str
    ///     The text.
    fn to_json(&self) -> PyResult<String> {
        report::json(&self.told).map_err(raise)
    }

    /// The rows as a data frame of pandas, which has to be installed.
    ///
    /// Returns
    /// -------
    /// pandas.DataFrame
    ///     The table that `write` writes: "id", "set", "returns", and the readings in degrees and millimetres.
    fn to_dataframe<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("poecal._findings")?.call_method1("table", (self.table()?,))
    }

    /// Writes the list as a table that `poecal.Measurements` reads once the measured quantities are filled in.
    ///
    /// Parameters
    /// ----------
    /// path
    ///     The file (CSV).
    /// force
    ///     True to overwrite a file that exists.
    #[pyo3(signature = (path, *, force=false))]
    fn write(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arg::path)] path: PathBuf,
        #[pyo3(from_py_with = arg::force)] force: bool,
    ) -> PyResult<()> {
        self.put(py, &path, force, vec![self.table()?.into()])
    }

    /// Writes the list as a program of slow joint motions with a stop at each row.
    ///
    /// Parameters
    /// ----------
    /// path
    ///     The file: its name ends in .script (Universal Robots), .mod (ABB), .src (KUKA) or .ls (FANUC).
    /// force
    ///     True to overwrite a file that exists.
    #[pyo3(signature = (path, *, force=false))]
    fn write_program(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arg::path)] path: PathBuf,
        #[pyo3(from_py_with = arg::force)] force: bool,
    ) -> PyResult<()> {
        let text = plan_program(&path, &self.model.robot, &self.found.rows).map_err(raise)?;
        self.put(py, &path, force, vec![text.into()])
    }

    /// Writes a page of the plan: the targets of all configurations, some arms, the device, errors by number, the sampled part of each joint's range.
    ///
    /// Parameters
    /// ----------
    /// path
    ///     The file (HTML).
    /// force
    ///     True to overwrite a file that exists.
    #[pyo3(signature = (path, *, force=false))]
    fn write_report(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arg::path)] path: PathBuf,
        #[pyo3(from_py_with = arg::force)] force: bool,
    ) -> PyResult<()> {
        let page = report::plan_page(&self.model, &self.options, &self.found, &self.told);
        self.put(py, &path, force, page)
    }

    fn __len__(&self) -> usize {
        self.found.rows.len()
    }

    fn __str__(&self) -> String {
        self.told.text()
    }

    fn __repr__(&self) -> String {
        format!("<poecal.Plan of {}: {}>", self.model.robot.name, self.told.answer().trim_end_matches('.'))
    }
}

impl Plan {
    /// The table of the rows.
    fn table(&self) -> PyResult<String> {
        planned_table(&self.model.robot, &self.found).map_err(raise)
    }

    fn put(&self, py: Python<'_>, path: &Path, force: bool, page: poecal_results::output::PagePieces) -> PyResult<()> {
        let place = reserved_file(py, path, ExistingFiles::from_switch(force), &[&self.model.path])?;
        py.detach(|| place.write(page)).map_err(raise)
    }
}
