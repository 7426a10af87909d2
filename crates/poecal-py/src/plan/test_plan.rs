//! `TestPlan`: poses of a test of ISO 9283.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use numpy::{PyArray1, PyArray2, PyArrayMethods as _};
use poecal_import::test_table;
use poecal_plan::plan::{TestCube, test_cube};
use poecal_report as report;
use poecal_results::model::Model;
use poecal_results::output::ExistingFiles;
use poecal_results::plan_program::plan_program;
use pyo3::prelude::*;

use crate::arguments as arg;
use crate::errors::raise;
use crate::output_places::reserved_file;

/// The poses of a test of ISO 9283. `str` is the program's table, `to_dict` what the program prints with `--json`.
#[pyclass(frozen, module = "poecal", name = "TestPlan")]
pub(crate) struct TestPlan {
    model: Arc<Model>,
    cube: TestCube,
    cycles: usize,
    told: report::TestPlan,
}

impl TestPlan {
    /// The largest cube above a floor, or a stated cube or plane, metres.
    pub(crate) fn new(
        model: &Arc<Model>,
        stated: Option<[[f64; 3]; 2]>,
        floor_m: Option<f64>,
        cycles: usize,
    ) -> PyResult<Self> {
        let cube = test_cube(&model.robot, stated, floor_m).map_err(raise)?;
        let told = report::TestPlan::new(&cube, cycles);
        Ok(TestPlan { model: Arc::clone(model), cube, cycles, told })
    }

    fn put(&self, py: Python<'_>, path: &Path, force: bool, text: String) -> PyResult<()> {
        let place = reserved_file(py, path, ExistingFiles::from_switch(force), &[&self.model.path])?;
        py.detach(|| place.write(vec![text.into()])).map_err(raise)
    }
}

#[pymethods]
impl TestPlan {
    /// The configurations of all cycles in their order, P5 to P1, shape (5 * cycles, n), radians and metres, in the order of `robot.reading_names`.
    #[getter]
    fn joints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let width = self.model.robot.reading_names().len();
        let rows = self.cube.rows(self.cycles);
        let all: Vec<f64> = rows.iter().flat_map(|row| row.readings.clone()).collect();
        PyArray1::from_vec(py, all).reshape([rows.len(), width])
    }

    /// Number of cycles.
    #[getter]
    fn cycles(&self) -> usize {
        self.cycles
    }

    /// The poses as dicts and lists: what the program prints with `--json`.
    ///
    /// Returns
    /// -------
    /// dict
    ///     "middle_mm" and "sides_mm" of the cube or plane, "cycles", and the "poses" P1 to P5.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("json")?.call_method1("loads", (self.to_json()?,))
    }

    /// The poses as JSON.
    ///
    /// Returns
    /// -------
    /// str
    ///     The text.
    fn to_json(&self) -> PyResult<String> {
        report::json(&self.told).map_err(raise)
    }

    /// Writes the table that `poecal.iso9283` reads once it has what was measured.
    ///
    /// Parameters
    /// ----------
    /// path
    ///     The file (CSV).
    /// force
    ///     Whether to write over a file that exists.
    #[pyo3(signature = (path, *, force=false))]
    fn write(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arg::path)] path: PathBuf,
        #[pyo3(from_py_with = arg::force)] force: bool,
    ) -> PyResult<()> {
        let table = test_table(&self.model.robot, &self.cube, self.cycles).map_err(raise)?;
        self.put(py, &path, force, table)
    }

    /// Writes all cycles as a program of slow joint motions with a stop at each pose.
    ///
    /// Parameters
    /// ----------
    /// path
    ///     The file: its name ends in .script (Universal Robots), .mod (ABB), .src (KUKA) or .ls (FANUC).
    /// force
    ///     Whether to write over a file that exists.
    #[pyo3(signature = (path, *, force=false))]
    fn write_program(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arg::path)] path: PathBuf,
        #[pyo3(from_py_with = arg::force)] force: bool,
    ) -> PyResult<()> {
        let text = plan_program(&path, &self.model.robot, &self.cube.rows(self.cycles)).map_err(raise)?;
        self.put(py, &path, force, text)
    }

    fn __str__(&self) -> String {
        self.told.text()
    }

    fn __repr__(&self) -> String {
        format!("<poecal.TestPlan of {}: {}>", self.model.robot.name, self.told.answer())
    }
}
