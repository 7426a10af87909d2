//! Measurements from files, arrays and data frames.

pub(crate) mod from_arrays;
pub(crate) mod from_dataframe;
pub(crate) mod guess;

mod content;
mod contents;
mod db3;
mod read_options;
mod sources;

use content::MeasurementState;
pub(crate) use content::Measurements;

use numpy::{PyArray1, PyArray2, PyArray3};
use poecal_import::MeasurementFile;
use poecal_model::measurement::Set;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arrays::{pose_arrays, table};
use crate::errors::python_words;
use crate::notebook;
use crate::pickle;
use crate::rows;

#[pymethods]
impl Measurements {
    fn __add__(&self, other: &Measurements) -> PyResult<Self> {
        Measurements::join_parts(&[self, other])
    }

    fn __getitem__(&self, rows: &Bound<'_, PyAny>) -> PyResult<Self> {
        self.part(&rows::choose_rows(rows, self.data().len())?)
    }

    fn __iter__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let builtins = slf.py().import("builtins")?;
        let rows = builtins.getattr("range")?.call1((slf.get().data().len(),))?;
        builtins.getattr("map")?.call1((slf.getattr("__getitem__")?, rows))
    }

    fn __len__(&self) -> usize {
        self.data().len()
    }

    /// Names of the readings that a configuration consists of.
    #[getter]
    fn reading_names(&self) -> Vec<String> {
        self.data().reading_names().to_vec()
    }

    /// Readings, shape (m, n), radians and metres.
    #[getter]
    fn joints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(py, self.data().all_readings().to_vec(), self.data().reading_names().len())
    }

    /// Measured positions in the device's frame, shape (m, 3), metres.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let position =
            |row: &poecal_model::measurement::Observation| <[f64; 3]>::from(row.measurement.pose().translation);
        table(py, self.data().observations.iter().flat_map(position).collect(), 3)
    }

    /// Measured poses device_from_target, shape (m, 4, 4); with the identity if a row has no orientation (`has_orientation`).
    #[getter]
    fn poses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let poses: Vec<_> = self.data().observations.iter().map(|row| row.measurement.pose()).collect();
        pose_arrays(py, &poses)
    }

    /// Rows with a measured orientation, shape (m,): True if it was measured.
    #[getter]
    fn has_orientation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        let seen = self.data().observations.iter().map(|row| row.measurement.sees_orientation());
        PyArray1::from_vec(py, seen.collect())
    }

    /// The target of each row; None for the tip itself.
    #[getter]
    fn targets(&self) -> Vec<Option<String>> {
        let data = self.data();
        data.observations.iter().map(|row| data.targets.get(row.target).cloned().flatten()).collect()
    }

    /// The instrument, or its station, that measured each row; None if there is one without a name.
    #[getter]
    fn instruments(&self) -> Vec<Option<String>> {
        let data = self.data();
        data.observations.iter().map(|row| data.stations.get(row.station).cloned().flatten()).collect()
    }

    /// "fit", "held_out", or None, for each row.
    #[getter]
    fn sets(&self) -> Vec<Option<&'static str>> {
        let word = |set| match set {
            Set::Fit => "fit",
            Set::HeldOut => "held_out",
        };
        self.data().observations.iter().map(|row| row.set.map(word)).collect()
    }

    /// The rows' ids; empty if they have none.
    #[getter]
    fn ids(&self) -> Vec<String> {
        self.data().ids.clone()
    }

    /// The files of the rows, as they were named.
    #[getter]
    fn files(&self) -> Vec<String> {
        self.data().files.iter().map(|path| path.display().to_string()).collect()
    }

    /// Findings in the files, such as the position of a camera, a sentence each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.file.notes.iter().map(|note| python_words(note)).collect()
    }

    /// Warnings about the files, a sentence each.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.file.warnings.iter().map(|warning| python_words(warning)).collect()
    }

    fn __repr__(&self) -> String {
        format!("<poecal.Measurements {}>", self.words())
    }

    fn _repr_html_(&self) -> String {
        notebook::measurements(&self.words(), &self.source.names, &self.file.warnings)
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Measurements>().is_ok_and(|other| {
            let other = other.get();
            self.file.data == other.file.data
                && self.file.notes == other.file.notes
                && self.file.warnings == other.file.warnings
                && self.source == other.source
        })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let MeasurementFile { data, notes, warnings, .. } = &*self.file;
        let state = MeasurementState {
            data: data.clone(),
            notes: notes.clone(),
            warnings: warnings.clone(),
            source: (*self.source).clone(),
        };
        pickle::reduce(py, "_measurements", &state)
    }

    fn __copy__(&self) -> Self {
        self.clone()
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Self {
        self.clone()
    }
}
