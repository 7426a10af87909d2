//! Residuals of each row as arrays and as tables of other packages.

use numpy::{PyArray1, PyArray2};
use poecal::io::residuals::{ModelErrors, ResidualRow, Residuals as Rows, RowDiagnostics};
use poecal::robot::JointKind;
use pyo3::exceptions::PyModuleNotFoundError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::table;
use crate::calibration::Calibration;
use crate::errors::no_package;

/// Residuals and diagnostics of each row, fitted or held out, in the order of the measurements.
///
/// Residuals are measured minus predicted, in the measuring device's axes; errors of a model are their lengths. `len` is the number of rows.
#[pyclass(frozen, module = "poecal", name = "Residuals")]
pub(crate) struct Residuals {
    calibration: Py<Calibration>,
}

/// Index of a model in [`ModelErrors::models`].
#[derive(Clone, Copy)]
enum OfModel {
    Nominal,
    Registered,
    Calibrated,
}

impl Residuals {
    /// Those of a calibration; an error if it was read without them.
    pub(crate) fn of(calibration: &Bound<'_, Calibration>) -> PyResult<Self> {
        calibration.get().rows()?;
        Ok(Residuals { calibration: calibration.clone().unbind() })
    }

    fn rows(&self) -> PyResult<&Rows> {
        self.calibration.get().rows()
    }

    /// A value of each row.
    fn each<T>(&self, of: impl Fn(&Rows, &ResidualRow) -> T) -> PyResult<Vec<T>> {
        let rows = self.rows()?;
        Ok(rows.rows.iter().map(|row| of(rows, row)).collect())
    }

    /// A number of each row, NaN where there is none.
    fn numbers<'py>(
        &self,
        py: Python<'py>,
        of: impl Fn(&ResidualRow) -> Option<f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(PyArray1::from_vec(py, self.each(|_, row| of(row).unwrap_or(f64::NAN))?))
    }

    /// A diagnostic of each row.
    fn judged<'py>(
        &self,
        py: Python<'py>,
        of: impl Fn(&RowDiagnostics) -> f64,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.numbers(py, |row| row.judged.as_ref().map(&of))
    }

    /// Errors of position of a model.
    fn position<'py>(&self, py: Python<'py>, model: OfModel) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.numbers(py, |row| Some(model.of(&row.position_mm)))
    }

    /// Errors of rotation of a model.
    fn rotation<'py>(&self, py: Python<'py>, model: OfModel) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.numbers(py, |row| row.rotation_deg.as_ref().map(|errors| model.of(errors)))
    }

    /// The table in a class of another package.
    fn framed<'py>(&self, py: Python<'py>, package: &str) -> PyResult<Bound<'py, PyAny>> {
        framed(py, package, &self.to_dict(py)?)
    }
}

impl OfModel {
    fn of(self, errors: &ModelErrors) -> f64 {
        let [nominal, registered, calibrated] = errors.models;
        match self {
            OfModel::Nominal => nominal,
            OfModel::Registered => registered,
            OfModel::Calibrated => calibrated,
        }
    }
}

/// A data frame of columns, by a package that may not be installed.
fn framed<'py>(py: Python<'py>, package: &str, columns: &Bound<'py, PyDict>) -> PyResult<Bound<'py, PyAny>> {
    let found = py.import(package).map_err(|error| {
        if error.is_instance_of::<PyModuleNotFoundError>(py) { no_package(package) } else { error }
    })?;
    found.call_method1("DataFrame", (columns,))
}

/// A name, or none for an empty one.
fn named(name: &str) -> Option<String> {
    Some(name.to_owned()).filter(|name| !name.is_empty())
}

#[pymethods]
impl Residuals {
    fn __len__(&self) -> PyResult<usize> {
        Ok(self.rows()?.rows.len())
    }

    /// File of each row; None where it came from memory.
    #[getter]
    fn files(&self) -> PyResult<Vec<Option<String>>> {
        self.each(|rows, row| named(rows.file(row)))
    }

    /// Line of each row in its file, from 1, shape (m,); 0 where it came from memory.
    #[getter]
    fn lines<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<u32>>> {
        Ok(PyArray1::from_vec(py, self.each(|_, row| row.line)?))
    }

    /// Id of each row; None where it has none.
    #[getter]
    fn ids(&self) -> PyResult<Vec<Option<String>>> {
        self.each(|_, row| named(&row.id))
    }

    /// Whether each row was held out, shape (m,).
    #[getter]
    fn held_out<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        Ok(PyArray1::from_vec(py, self.each(|_, row| row.held_out)?))
    }

    /// Target of each row; None for the tip itself.
    #[getter]
    fn targets(&self) -> PyResult<Vec<Option<String>>> {
        self.each(|rows, row| rows.targets.get(row.target).and_then(|name| named(name)))
    }

    /// Instrument of each row; None where there is only one.
    #[getter]
    fn instruments(&self) -> PyResult<Vec<Option<String>>> {
        self.each(|rows, row| rows.stations.get(row.station).and_then(|name| named(name)))
    }

    /// Residual of position by component, shape (m, 3), millimetres.
    #[getter]
    fn position_mm<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(py, self.each(|_, row| row.position_mm.residual)?.concat(), 3)
    }

    /// Residual of rotation by component, shape (m, 3), degrees; NaN where no orientation was measured.
    #[getter]
    fn rotation_deg<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let of = |row: &ResidualRow| row.rotation_deg.map_or([f64::NAN; 3], |errors| errors.residual);
        table(py, self.each(|_, row| of(row))?.concat(), 3)
    }

    /// Error of position of the nominal model, shape (m,), millimetres.
    #[getter]
    fn position_nominal_mm<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.position(py, OfModel::Nominal)
    }

    /// Error of position of the registered model, shape (m,), millimetres.
    #[getter]
    fn position_registered_mm<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.position(py, OfModel::Registered)
    }

    /// Error of position of the calibrated model, shape (m,), millimetres.
    #[getter]
    fn position_calibrated_mm<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.position(py, OfModel::Calibrated)
    }

    /// Error of rotation of the nominal model, shape (m,), degrees; NaN where no orientation was measured.
    #[getter]
    fn rotation_nominal_deg<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.rotation(py, OfModel::Nominal)
    }

    /// Error of rotation of the registered model, shape (m,), degrees; NaN where no orientation was measured.
    #[getter]
    fn rotation_registered_deg<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.rotation(py, OfModel::Registered)
    }

    /// Error of rotation of the calibrated model, shape (m,), degrees; NaN where no orientation was measured.
    #[getter]
    fn rotation_calibrated_deg<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.rotation(py, OfModel::Calibrated)
    }

    /// Weight of each row in the fit, shape (m,); of a held-out row the weight that it would have had.
    #[getter]
    fn weight<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.judged(py, |judged| judged.weight)
    }

    /// Leverage of each row, shape (m,): how much it decides its own prediction.
    #[getter]
    fn leverage<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.judged(py, |judged| judged.leverage)
    }

    /// Studentised residual of each row, shape (m,): its length over its own standard deviation.
    #[getter]
    fn studentized<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.judged(py, |judged| judged.studentized)
    }

    /// Whether each row is suspected of a gross error, shape (m,).
    #[getter]
    fn suspected<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let suspected = self.each(|_, row| row.judged.as_ref().is_some_and(|judged| judged.suspected))?;
        Ok(PyArray1::from_vec(py, suspected))
    }

    /// The columns of residuals.csv by their names there, with the readings of each row.
    ///
    /// Returns
    /// -------
    /// dict
    ///     Arrays of shape (m,), and lists of names.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let rows = self.rows()?;
        let columns = PyDict::new(py);
        columns.set_item("file", self.files()?)?;
        columns.set_item("line", self.lines(py)?)?;
        columns.set_item("id", self.ids()?)?;
        columns.set_item("set", self.each(|_, row| if row.held_out { "held_out" } else { "fit" })?)?;
        columns.set_item("target", self.targets()?)?;
        let models = [
            (OfModel::Nominal, "nominal"),
            (OfModel::Registered, "registered"),
            (OfModel::Calibrated, "calibrated"),
        ];
        for (model, name) in models {
            columns.set_item(format!("position_{name}[mm]"), self.position(py, model)?)?;
        }
        for (at, name) in ["x[mm]", "y[mm]", "z[mm]"].into_iter().enumerate() {
            columns.set_item(name, self.numbers(py, |row| row.position_mm.residual.get(at).copied())?)?;
        }
        for (model, name) in models {
            columns.set_item(format!("rotation_{name}[deg]"), self.rotation(py, model)?)?;
        }
        for (at, name) in ["rx[deg]", "ry[deg]", "rz[deg]"].into_iter().enumerate() {
            columns.set_item(name, self.numbers(py, |row| row.rotation_deg?.residual.get(at).copied())?)?;
        }
        columns.set_item("weight", self.weight(py)?)?;
        columns.set_item("leverage", self.leverage(py)?)?;
        columns.set_item("studentized", self.studentized(py)?)?;
        columns.set_item("suspected", self.suspected(py)?)?;
        for (at, (name, kind)) in rows.readings.iter().enumerate() {
            let values =
                (0..rows.rows.len()).map(|row| rows.values(row).get(at).copied().unwrap_or(f64::NAN));
            let unit = match kind {
                JointKind::Revolute => "deg",
                JointKind::Prismatic => "mm",
            };
            columns.set_item(format!("{name}[{unit}]"), PyArray1::from_vec(py, values.collect()))?;
        }
        if !rows.stations.is_empty() {
            columns.set_item("instrument", self.instruments()?)?;
        }
        Ok(columns)
    }

    /// The columns of residuals.csv as a data frame of pandas, which has to be installed.
    ///
    /// Returns
    /// -------
    /// pandas.DataFrame
    ///     A line for each row.
    fn to_dataframe<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.framed(py, "pandas")
    }

    /// The columns of residuals.csv as a data frame of polars, which has to be installed.
    ///
    /// Returns
    /// -------
    /// polars.DataFrame
    ///     A line for each row.
    fn to_polars<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.framed(py, "polars")
    }

    fn __repr__(&self) -> PyResult<String> {
        let rows = &self.rows()?.rows;
        let held_out = rows.iter().filter(|row| row.held_out).count();
        Ok(format!("<poecal.Residuals of {} rows, {held_out} held out>", rows.len()))
    }
}
