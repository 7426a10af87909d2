//! Robots.

mod content;
mod sources;

pub(crate) use content::{Robot, RobotState, form, poses};

use std::path::PathBuf;

use numpy::{PyArray2, PyArray3, PyArrayMethods as _};
use poecal_results::output::ExistingFiles;
use poecal_results::predictions::{PredictionFrame, predict_readings};
use pyo3::IntoPyObjectExt as _;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arguments as arg;
use crate::arrays::{JointArray, pose_array, pose_arrays, table};
use crate::errors::raise;
use crate::notebook;
use crate::output_places::reserved_file;
use crate::pickle;

#[pymethods]
impl Robot {
    /// Poses of the tip, or of a target of the model, in the base frame.
    ///
    /// Parameters
    /// ----------
    /// joints
    ///     Configurations, shape (m, n), radians and metres, in the order of `reading_names`; or one, shape (n,).
    /// target
    ///     Name of a target of the model, default the tip.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Poses of shape (m, 4, 4), or (4, 4) for one configuration.
    #[pyo3(signature = (joints, *, target=None))]
    fn forward_kinematics<'py>(
        &self,
        py: Python<'py>,
        joints: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = arg::target)] target: Option<&str>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let joints = JointArray::from_argument(joints, self.robot())?;
        let model = &self.model;
        let found = py
            .detach(|| predict_readings(model, &joints.readings, PredictionFrame::Base, target, false))
            .map_err(raise)?;
        poses(py, &found.poses, joints.single)
    }

    /// Frames of the joints in the base frame, as a drawing of the robot needs them.
    ///
    /// Parameters
    /// ----------
    /// joints
    ///     Configurations, as for `forward_kinematics`.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Poses of shape (m, n, 4, 4), or (n, 4, 4) for one configuration.
    fn joint_poses<'py>(&self, py: Python<'py>, joints: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let robot = self.robot();
        let joints = JointArray::from_argument(joints, robot)?;
        let configurations = joints.readings.chunks_exact(robot.reading_names().len().max(1));
        let rows = configurations.len();
        let frames: Vec<_> = configurations.flat_map(|readings| robot.joint_poses(readings)).collect();
        let frames = pose_arrays(py, &frames)?;
        if joints.single {
            return frames.into_bound_py_any(py);
        }
        frames.reshape([rows, robot.joints.len(), 4, 4])?.into_bound_py_any(py)
    }

    /// The robot's name.
    #[getter]
    fn name(&self) -> &str {
        &self.robot().name
    }

    /// Name of the base frame.
    #[getter]
    fn base_link(&self) -> &str {
        &self.robot().base_name
    }

    /// Name of the tip frame.
    #[getter]
    fn tip_link(&self) -> &str {
        &self.robot().tip_name
    }

    /// The file from which it was read, as it was named; for robots of arrays their name.
    #[getter]
    fn path(&self) -> String {
        self.model.path.display().to_string()
    }

    /// Names of the n moving joints from base to tip.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.robot().joints.iter().map(|joint| joint.name.clone()).collect()
    }

    /// The same robot with further columns of the measurements on which terms of its joints may depend, like temperature.
    ///
    /// "approach" or "approach_JOINT" states from which side joints came, 1 or -1, "payload" the mass at the tip, in kg. They are readings behind
    /// those of the joints.
    ///
    /// Parameters
    /// ----------
    /// names
    ///     Names of the columns.
    ///
    /// Returns
    /// -------
    /// Robot
    ///     The robot.
    fn with_factors(&self, names: Vec<String>) -> PyResult<Self> {
        Ok(self.with_robot(self.robot().with_factors(&names).map_err(raise)?))
    }

    /// Names of the readings that a configuration consists of: those of the joints except mimic joints, which follow another.
    #[getter]
    fn reading_names(&self) -> Vec<String> {
        self.robot().reading_names()
    }

    /// "revolute" or "prismatic" for each joint.
    #[getter]
    fn kinds(&self) -> Vec<&'static str> {
        self.robot().joints.iter().map(|joint| joint.kind.word()).collect()
    }

    /// Screws in the base frame at zero joint values, shape (n, 6): linear part (metres), then angular part.
    #[getter]
    fn screws<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let numbers: Vec<f64> =
            self.robot().joints.iter().flat_map(|joint| <[f64; 6]>::from(joint.screw.twist().to_vector())).collect();
        table(py, numbers, 6)
    }

    /// Frames of the joints in the base at zero joint values, shape (n, 4, 4).
    #[getter]
    fn joint_frames<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let frames: Vec<_> = self.robot().joints.iter().map(|joint| joint.frame).collect();
        pose_arrays(py, &frames)
    }

    /// Lower and upper limits, shape (n, 2), radians or metres; infinite for a joint without limits.
    #[getter]
    fn limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let none = [f64::NEG_INFINITY, f64::INFINITY];
        let of = |joint: &poecal_model::robot::Joint| joint.limits.map_or(none, |limits| [limits.lower, limits.upper]);
        table(py, self.robot().joints.iter().flat_map(of).collect(), 2)
    }

    /// Pose of the tip in the base at zero joint values, shape (4, 4).
    #[getter]
    fn home<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        pose_array(py, &self.robot().home)
    }

    /// Poses of the model's targets in the tip frame, by name, shape (4, 4) each.
    #[getter]
    fn targets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let targets = PyDict::new(py);
        for (name, pose) in &self.robot().targets {
            targets.set_item(name, pose_array(py, pose)?)?;
        }
        Ok(targets)
    }

    /// The model as a text.
    ///
    /// Parameters
    /// ----------
    /// format
    ///     "urdf" (a new one, of links, joints and a tip) or "toml" (a table of screws).
    ///
    /// Returns
    /// -------
    /// str
    ///     The text.
    #[pyo3(signature = (format))]
    fn to_text(&self, py: Python<'_>, #[pyo3(from_py_with = arg::format)] format: &str) -> PyResult<String> {
        self.convert_to(py, form(Some(format), None)?)
    }

    /// Writes the model to a file.
    ///
    /// Parameters
    /// ----------
    /// path
    ///     The file.
    /// format
    ///     "urdf" or "toml", by default from the extension.
    /// force
    ///     True to overwrite a file that exists.
    #[pyo3(signature = (path, *, format=None, force=false))]
    fn write(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arg::path)] path: PathBuf,
        #[pyo3(from_py_with = arg::format)] format: Option<&str>,
        #[pyo3(from_py_with = arg::force)] force: bool,
    ) -> PyResult<()> {
        let form = form(format, Some(&path))?;
        let place = reserved_file(py, &path, ExistingFiles::from_switch(force), &[&self.model.path])?;
        place.write(vec![self.convert_to(py, form)?.into()]).map_err(raise)
    }

    fn __repr__(&self) -> String {
        format!("<poecal.Robot {}>", self.words())
    }

    fn _repr_html_(&self) -> String {
        notebook::robot(self.robot(), &self.words())
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Robot>().is_ok_and(|other| {
            let other = other.get();
            *self.model == *other.model && self.sha256 == other.sha256
        })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        pickle::reduce(py, "_robot", &self.state()?)
    }

    fn __copy__(&self) -> Self {
        self.clone()
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Self {
        self.clone()
    }
}
