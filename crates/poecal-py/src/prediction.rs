//! Predictions with their expected errors.

use numpy::{PyArray1, PyArray3};
use poecal_arm::lie::Pose;
use poecal_fit::uncertainty::PredictedError;
use pyo3::prelude::*;

use crate::arrays::pose_arrays;

/// Predicted poses of m configurations, and the expected error of each.
#[pyclass(frozen, module = "poecal", name = "Prediction")]
pub(crate) struct Prediction {
    pub(crate) target: Option<String>,
    pub(crate) poses: Vec<Pose>,
    pub(crate) doubts: Vec<(PredictedError, bool)>,
}

impl Prediction {
    fn array<'py>(&self, py: Python<'py>, of: impl Fn(&PredictedError) -> f64) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.doubts.iter().map(|(error, _)| of(error)).collect())
    }
}

#[pymethods]
impl Prediction {
    /// Name of the target that was predicted; None for the tip.
    #[getter]
    fn target(&self) -> Option<&str> {
        self.target.as_deref()
    }

    /// The poses, shape (m, 4, 4), metres.
    #[getter]
    fn poses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        pose_arrays(py, &self.poses)
    }

    /// Expected root mean square distance, shape (m,), metres.
    #[getter]
    fn sigma_position_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.array(py, PredictedError::sigma_position_m)
    }

    /// Expected root mean square angle, shape (m,), radians.
    #[getter]
    fn sigma_rotation_rad<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.array(py, PredictedError::sigma_rotation_rad)
    }

    /// Distance that is not exceeded in 95 % of all cases, shape (m,), metres.
    #[getter]
    fn bound95_position_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.array(py, PredictedError::bound_position_m)
    }

    /// Configurations inside the sampled range, shape (m,): True if every joint is inside its range.
    #[getter]
    fn inside_sampled_range<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_vec(py, self.doubts.iter().map(|(_, inside)| *inside).collect())
    }

    fn __len__(&self) -> usize {
        self.poses.len()
    }

    fn __repr__(&self) -> String {
        format!("<poecal.Prediction of {} poses>", self.poses.len())
    }
}
