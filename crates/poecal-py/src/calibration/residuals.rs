//! Residuals of each row as arrays and as tables of other packages.

use numpy::{PyArray1, PyArray2};
use poecal_model::measurement::Quantity;
use poecal_results::residuals::{ResidualRow, Residuals as Rows, RowDiagnostics, columns as names, corner_columns};
use pyo3::exceptions::PyModuleNotFoundError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments as arg;
use crate::arrays::table;
use crate::calibration::Calibration;
use crate::errors::no_package;
use crate::of_model::ModelSelector;
use crate::words::quantity as quantity_word;

/// Residuals and diagnostics of each row, fitted or held out, in the order of the measurements.
///
/// Residuals are measured minus predicted, in the measuring device's axes; errors of a model are their lengths. `len` is the number of rows.
#[pyclass(frozen, module = "poecal", name = "Residuals")]
pub(crate) struct Residuals {
    calibration: Py<Calibration>,
}

impl Residuals {
    /// Residuals of a calibration; an error if it was read without them.
    pub(crate) fn from_calibration(calibration: &Bound<'_, Calibration>) -> PyResult<Self> {
        calibration.get().rows()?;
        Ok(Residuals { calibration: calibration.clone().unbind() })
    }

    fn rows(&self) -> PyResult<&Rows> {
        self.calibration.get().rows()
    }

    /// The model that a word names.
    fn model_of(&self, word: &str) -> PyResult<ModelSelector> {
        ModelSelector::from_name(word, self.calibration.get().delivered_model())
    }

    /// A value of each row.
    fn map_rows<T>(&self, of: impl Fn(&Rows, &ResidualRow) -> T) -> PyResult<Vec<T>> {
        let rows = self.rows()?;
        Ok(rows.rows().iter().map(|row| of(rows, row)).collect())
    }

    /// A number of each row, NaN if it has none.
    fn numbers<'py>(
        &self,
        py: Python<'py>,
        of: impl Fn(&ResidualRow) -> Option<f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(PyArray1::from_vec(py, self.map_rows(|_, row| of(row).unwrap_or(f64::NAN))?))
    }

    /// A diagnostic of each row.
    fn diagnostic<'py>(
        &self,
        py: Python<'py>,
        of: impl Fn(&RowDiagnostics) -> f64,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.numbers(py, |row| row.judged.as_ref().map(&of))
    }

    /// Errors of a quantity of a model.
    fn errors_of<'py>(
        &self,
        py: Python<'py>,
        quantity: Quantity,
        model: ModelSelector,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.numbers(py, |row| {
            row.errors.get(quantity).map(|errors| model.select_error(errors.models, errors.corrected))
        })
    }

    /// Residuals of a quantity by component.
    fn components_of<'py>(&self, py: Python<'py>, quantity: Quantity) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let count = quantity.components();
        let of = |row: &ResidualRow| match row.errors.get(quantity) {
            Some(errors) => errors.residual().to_vec(),
            None => vec![f64::NAN; count],
        };
        table(py, self.map_rows(|_, row| of(row))?.concat(), count)
    }

    /// The table in a class of another package.
    fn to_frame<'py>(&self, py: Python<'py>, package: &str) -> PyResult<Bound<'py, PyAny>> {
        make_frame(py, package, &self.to_dict(py)?)
    }
}

/// A data frame of columns, by a package that may not be installed.
fn make_frame<'py>(py: Python<'py>, package: &str, columns: &Bound<'py, PyDict>) -> PyResult<Bound<'py, PyAny>> {
    let found = py
        .import(package)
        .map_err(|error| if error.is_instance_of::<PyModuleNotFoundError>(py) { no_package(package) } else { error })?;
    found.call_method1("DataFrame", (columns,))
}

/// A name, or `None` for an empty one.
fn name_or_none(name: &str) -> Option<String> {
    Some(name.to_owned()).filter(|name| !name.is_empty())
}

#[pymethods]
impl Residuals {
    fn __len__(&self) -> PyResult<usize> {
        Ok(self.rows()?.rows().len())
    }

    /// File of each row; None if it came from memory.
    #[getter]
    fn files(&self) -> PyResult<Vec<Option<String>>> {
        self.map_rows(|rows, row| name_or_none(rows.file(row)))
    }

    /// Line of each row in its file, from 1, shape (m,); 0 if it came from memory.
    #[getter]
    fn lines<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<u32>>> {
        Ok(PyArray1::from_vec(py, self.map_rows(|_, row| row.line)?))
    }

    /// Id of each row; None if it has none.
    #[getter]
    fn ids(&self) -> PyResult<Vec<Option<String>>> {
        self.map_rows(|_, row| name_or_none(&row.id))
    }

    /// Held-out rows, shape (m,): True if the row was held out.
    #[getter]
    fn held_out<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        Ok(PyArray1::from_vec(py, self.map_rows(|_, row| row.held_out)?))
    }

    /// Target of each row; None for the tip itself.
    #[getter]
    fn targets(&self) -> PyResult<Vec<Option<String>>> {
        self.map_rows(|rows, row| rows.targets.get(row.target).and_then(|name| name_or_none(name)))
    }

    /// Instrument of each row; None if there is only one.
    #[getter]
    fn instruments(&self) -> PyResult<Vec<Option<String>>> {
        self.map_rows(|rows, row| rows.stations.get(row.station).and_then(|name| name_or_none(name)))
    }

    /// Residual of position of the delivered model by component, shape (m, 3), millimetres; NaN if no position was measured.
    #[getter]
    fn position_mm<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.components_of(py, Quantity::Position)
    }

    /// Residual of rotation of the delivered model by component, shape (m, 3), degrees; NaN if no orientation was measured.
    #[getter]
    fn rotation_deg<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.components_of(py, Quantity::Rotation)
    }

    /// Error of position of the nominal model, shape (m,), millimetres; NaN if no position was measured.
    #[getter]
    fn position_nominal_mm<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.errors_of(py, Quantity::Position, ModelSelector::Nominal)
    }

    /// Error of position of the registered model, shape (m,), millimetres; NaN if no position was measured.
    #[getter]
    fn position_registered_mm<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.errors_of(py, Quantity::Position, ModelSelector::Registered)
    }

    /// Error of position of the calibrated model, shape (m,), millimetres; NaN if no position was measured.
    #[getter]
    fn position_calibrated_mm<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.errors_of(py, Quantity::Position, ModelSelector::Calibrated)
    }

    /// Error of rotation of the nominal model, shape (m,), degrees; NaN if no orientation was measured.
    #[getter]
    fn rotation_nominal_deg<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.errors_of(py, Quantity::Rotation, ModelSelector::Nominal)
    }

    /// Error of rotation of the registered model, shape (m,), degrees; NaN if no orientation was measured.
    #[getter]
    fn rotation_registered_deg<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.errors_of(py, Quantity::Rotation, ModelSelector::Registered)
    }

    /// Error of position of the corrected model, shape (m,), millimetres; NaN without such a model, or if no position was measured.
    #[getter]
    fn position_corrected_mm<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.errors_of(py, Quantity::Position, ModelSelector::Corrected)
    }

    /// Error of rotation of the corrected model, shape (m,), degrees; NaN without such a model, or if no orientation was measured.
    #[getter]
    fn rotation_corrected_deg<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.errors_of(py, Quantity::Rotation, ModelSelector::Corrected)
    }

    /// Error of rotation of the calibrated model, shape (m,), degrees; NaN if no orientation was measured.
    #[getter]
    fn rotation_calibrated_deg<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.errors_of(py, Quantity::Rotation, ModelSelector::Calibrated)
    }

    /// The delivered model: "corrected" if it has terms, else "calibrated".
    #[getter]
    fn model(&self) -> &'static str {
        self.calibration.get().delivered_model().word()
    }

    /// Quantities that some row measured, such as "position", with their units; first the one that judges the calibration.
    #[getter]
    fn quantities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let rows = self.rows()?;
        let units = PyDict::new(py);
        for quantity in rows.leading_quantity().into_iter().chain(rows.measured_quantities()) {
            units.set_item(quantity.name(), quantity.unit().symbol())?;
        }
        Ok(units)
    }

    /// Residual of any quantity of the delivered model by component.
    ///
    /// Parameters
    /// ----------
    /// quantity
    ///     Its name, as in `quantities`.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Shape (m, n), millimetres or degrees; NaN if it was not measured.
    fn components<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = arg::quantity)] quantity: &str,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.components_of(py, quantity_word(quantity)?)
    }

    /// Error of any quantity of a model.
    ///
    /// Parameters
    /// ----------
    /// quantity
    ///     Its name, as in `quantities`.
    /// model
    ///     "delivered", "nominal", "registered", "calibrated", or "corrected": NaN without such a model.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Shape (m,), millimetres or degrees; NaN if it was not measured.
    #[pyo3(signature = (quantity, *, model="delivered"))]
    fn errors<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = arg::quantity)] quantity: &str,
        #[pyo3(from_py_with = arg::model)] model: &str,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.errors_of(py, quantity_word(quantity)?, self.model_of(model)?)
    }

    /// Root mean square distance of the corners of each picture from a model's predicted positions.
    ///
    /// Parameters
    /// ----------
    /// model
    ///     "delivered", "nominal", "registered", "calibrated", or "corrected": NaN without such a model.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Shape (m,), pixels; NaN for rows that are no pictures.
    #[pyo3(signature = (*, model="delivered"))]
    fn corners_px<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = arg::model)] model: &str,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let model = self.model_of(model)?;
        self.numbers(py, |row| row.corners.map(|corners| model.select_error(corners.models_px, corners.corrected_px)))
    }

    /// Weight of each row in the fit, shape (m,); for a held-out row the weight that it would have had.
    #[getter]
    fn weight<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.diagnostic(py, |judged| judged.weight)
    }

    /// Leverage of each row, shape (m,): its influence on its own prediction.
    #[getter]
    fn leverage<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.diagnostic(py, |judged| judged.leverage)
    }

    /// Studentised residual of each row, shape (m,): its length over its own standard deviation.
    #[getter]
    fn studentized<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.diagnostic(py, |judged| judged.studentized)
    }

    /// Suspected rows, shape (m,): True if the row is suspected of a gross error.
    #[getter]
    fn suspected<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let suspected = self.map_rows(|_, row| row.judged.as_ref().is_some_and(|judged| judged.suspected))?;
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
        columns.set_item("set", self.map_rows(|_, row| if row.held_out { "held_out" } else { "fit" })?)?;
        columns.set_item("target", self.targets()?)?;
        for quantity in rows.quantities() {
            for (at, name) in names(quantity, rows.has_corrected).enumerate() {
                columns.set_item(name, self.numbers(py, |row| row.errors.get(quantity)?.numbers().nth(at))?)?;
            }
        }
        if rows.has_corners {
            for (at, name) in corner_columns(rows.has_corrected).enumerate() {
                columns.set_item(name, self.numbers(py, |row| row.corners?.numbers().nth(at))?)?;
            }
        }
        columns.set_item("weight", self.weight(py)?)?;
        columns.set_item("leverage", self.leverage(py)?)?;
        columns.set_item("studentized", self.studentized(py)?)?;
        columns.set_item("suspected", self.suspected(py)?)?;
        for (at, (name, kind)) in rows.readings.iter().enumerate() {
            let values = (0..rows.rows().len()).map(|row| rows.values(row).get(at).copied().unwrap_or(f64::NAN));
            let unit = kind.symbol();
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
        self.to_frame(py, "pandas")
    }

    /// The columns of residuals.csv as a data frame of polars, which has to be installed.
    ///
    /// Returns
    /// -------
    /// polars.DataFrame
    ///     A line for each row.
    fn to_polars<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.to_frame(py, "polars")
    }

    fn __repr__(&self) -> PyResult<String> {
        let rows = self.rows()?.rows();
        let held_out = rows.iter().filter(|row| row.held_out).count();
        Ok(format!("<poecal.Residuals of {} rows, {held_out} held out>", rows.len()))
    }
}
