//! The covariance of a calibration's unknowns.

use numpy::{PyArray1, PyArray2, PyArray3};
use poecal_arm::lie::Pose;
use poecal_numerics::unit::Unit;
use poecal_results::calibration_file::CalibrationFile;
use pyo3::prelude::*;

use crate::arrays::{pose_arrays, table};
use crate::errors::raise;

/// Covariance of the unknowns of a calibration: shifts and turns of each joint's axis, and of each target.
///
/// It is the one that `Calibration.predict` uses inside the sampled range (docs/theory.md §9 (39)), with the prior in it, which bounds what
/// the measurements do not determine. With an unknown frame of the measuring device, axes and targets are relative to the device.
#[pyclass(frozen, module = "poecal", name = "Covariance")]
pub(crate) struct Covariance {
    /// Name of each unknown, and its unit.
    unknowns: Vec<(String, Unit)>,
    /// Elements row by row.
    matrix: Vec<f64>,
    axes: Vec<Pose>,
}

impl Covariance {
    pub(crate) fn from_file(file: &CalibrationFile) -> PyResult<Self> {
        let (found, _) = file.uncertainty(&[]).map_err(raise)?;
        let names = file.unknowns().map_err(raise)?;
        let (mut unknowns, mut places) = (Vec::new(), Vec::new());
        for (parameter, own) in found.layout.parameters() {
            let columns = parameter.model().columns();
            for (column, &place) in columns.iter().zip(own) {
                unknowns.push((names.get(place.0).cloned().unwrap_or_default(), column.unit));
                places.push(place);
            }
        }
        let n = found.layout.dim();
        let at = |(i, a): (usize, f64), (j, b): (usize, f64)| {
            found.covariance.get(i * n + j).map_or(f64::NAN, |value| value / (a * b))
        };
        let matrix = places.iter().flat_map(|&a| places.iter().map(move |&b| (a, b))).map(|(a, b)| at(a, b)).collect();
        Ok(Covariance { unknowns, matrix, axes: found.estimate.base_from_axis })
    }
}

#[pymethods]
impl Covariance {
    /// Name of each of the k unknowns: a block and a motion, as "joint1.axis.x" or "target.rz".
    ///
    /// A revolute joint has shifts x and y along and turns rx and ry about the axes of its frame in `axes`, a prismatic one turns; a target
    /// has shifts along its own axes, and turns about them if its orientation was measured.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.unknowns.iter().map(|(name, _)| name.clone()).collect()
    }

    /// Unit of each unknown, "m" or "rad".
    #[getter]
    fn units(&self) -> Vec<&'static str> {
        let word = |unit| match unit {
            Unit::Metre => "m",
            Unit::Radian => "rad",
            Unit::One => "1",
            Unit::Second => "s",
        };
        self.unknowns.iter().map(|(_, unit)| word(*unit)).collect()
    }

    /// The covariance, shape (k, k), in products of `units`.
    #[getter]
    fn matrix<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(py, self.matrix.clone(), self.unknowns.len())
    }

    /// Standard deviation of each unknown, shape (k,), in `units`.
    #[getter]
    fn sigma<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let diagonal = self.matrix.iter().step_by(self.unknowns.len() + 1);
        PyArray1::from_vec(py, diagonal.map(|variance| variance.sqrt()).collect())
    }

    /// Frames base_from_axis at zero joint values, z along the joint, shape (n, 4, 4).
    #[getter]
    fn axes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        pose_arrays(py, &self.axes)
    }

    fn __len__(&self) -> usize {
        self.unknowns.len()
    }

    fn __repr__(&self) -> String {
        format!("<poecal.Covariance of {} unknowns>", self.unknowns.len())
    }
}
