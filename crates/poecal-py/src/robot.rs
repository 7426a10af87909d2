//! Robots.

mod content;

pub(crate) use content::{Robot, RobotState, form, poses};

use std::path::PathBuf;

use numpy::{PyArray2, PyArray3, PyArrayMethods as _};
use poecal_formats::robot_toml;
use poecal_formats::urdf::UrdfDocument;
use poecal_results::model::{Model, ModelSource};
use poecal_results::output::Existing;
use poecal_results::predictions::{PredictionFrame, predicted};
use pyo3::IntoPyObjectExt as _;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arguments::{self as arg, Links, is_content};
use crate::arrays::{Joints, pose_array, pose_arrays, table};
use crate::build::{DhTable, Naming, from_dh, from_screws};
use crate::errors::{argument, raise};
use crate::places::reserved_file;
use crate::words::shortened;
use crate::{notebook, pickle};

/// Path of a robot that was read from a text.
const TEXT: &str = "text";

#[pymethods]
impl Robot {
    /// Reads a robot model of any form: URDF, MJCF, SDF, TOML, a driver's YAML, a controller's conf, or calibration.json, of which it is the calibrated robot.
    ///
    /// Parameters
    /// ----------
    /// path
    ///     The file; its extension gives the form, or else the beginning of its text.
    /// base_link, tip_link
    ///     The chain of a URDF that has several.
    /// instruments, targets
    ///     Names of instruments on the robot and of targets, with their links in a URDF: the robot is the tree of the joints to these.
    ///
    /// Returns
    /// -------
    /// Robot
    ///     The robot.
    ///
    /// Raises
    /// ------
    /// FileError
    ///     The file cannot be read.
    /// FormatError
    ///     It is no valid XML, TOML or JSON.
    /// ModelError
    ///     It holds no robot that can be used.
    #[staticmethod]
    #[pyo3(signature = (path, *, base_link=None, tip_link=None, instruments=None, targets=None))]
    fn read(
        py: Python<'_>,
        #[pyo3(from_py_with = arg::path)] path: PathBuf,
        #[pyo3(from_py_with = arg::base_link)] base_link: Option<String>,
        #[pyo3(from_py_with = arg::tip_link)] tip_link: Option<String>,
        #[pyo3(from_py_with = arg::instruments)] instruments: Option<Links>,
        #[pyo3(from_py_with = arg::targets)] targets: Option<Links>,
    ) -> PyResult<Self> {
        let selection = arg::selection(base_link, tip_link, instruments, targets);
        Robot::of_file(py.detach(|| Model::read(&path, &selection)).map_err(raise)?)
    }

    /// Reads a chain of a URDF file.
    ///
    /// Parameters
    /// ----------
    /// path
    ///     The file.
    /// base_link, tip_link
    ///     First and last link of the chain, where there are several.
    /// instruments, targets
    ///     Names of instruments on the robot and of targets, with their links in a URDF: the robot is the tree of the joints to these.
    ///
    /// Returns
    /// -------
    /// Robot
    ///     The robot.
    #[staticmethod]
    #[pyo3(signature = (path, *, base_link=None, tip_link=None, instruments=None, targets=None))]
    fn from_urdf(
        py: Python<'_>,
        #[pyo3(from_py_with = arg::path)] path: PathBuf,
        #[pyo3(from_py_with = arg::base_link)] base_link: Option<String>,
        #[pyo3(from_py_with = arg::tip_link)] tip_link: Option<String>,
        #[pyo3(from_py_with = arg::instruments)] instruments: Option<Links>,
        #[pyo3(from_py_with = arg::targets)] targets: Option<Links>,
    ) -> PyResult<Self> {
        let selection = arg::selection(base_link, tip_link, instruments, targets);
        let document = py.detach(|| UrdfDocument::read(&path, &selection)).map_err(raise)?;
        let (robot, source) = (document.robot().clone(), ModelSource::Urdf(Box::new(document)));
        Robot::of_file(Model { robot, source, path })
    }

    /// Reads a TOML model of screws or of Denavit-Hartenberg parameters.
    ///
    /// Parameters
    /// ----------
    /// path
    ///     The file.
    ///
    /// Returns
    /// -------
    /// Robot
    ///     The robot.
    #[staticmethod]
    fn from_toml(#[pyo3(from_py_with = arg::path)] path: PathBuf) -> PyResult<Self> {
        let robot = robot_toml::read(&path).map_err(raise)?;
        Robot::of_file(Model { robot, source: ModelSource::Toml, path })
    }

    /// A robot model of any form from its text, as of the parameter `robot_description` of ROS.
    ///
    /// Parameters
    /// ----------
    /// text
    ///     Text of a URDF, MJCF, SDF, TOML model or calibration.json.
    /// base_link, tip_link
    ///     The chain of a URDF that has several.
    /// instruments, targets
    ///     Names of instruments on the robot and of targets, with their links in a URDF: the robot is the tree of the joints to these.
    ///
    /// Returns
    /// -------
    /// Robot
    ///     The robot; its `path` is "text", by which errors name places too.
    #[staticmethod]
    #[pyo3(signature = (text, *, base_link=None, tip_link=None, instruments=None, targets=None))]
    fn from_text(
        py: Python<'_>,
        #[pyo3(from_py_with = arg::text)] text: &str,
        #[pyo3(from_py_with = arg::base_link)] base_link: Option<String>,
        #[pyo3(from_py_with = arg::tip_link)] tip_link: Option<String>,
        #[pyo3(from_py_with = arg::instruments)] instruments: Option<Links>,
        #[pyo3(from_py_with = arg::targets)] targets: Option<Links>,
    ) -> PyResult<Self> {
        if !is_content(text) {
            let expected = "the text of a model; poecal.Robot.read reads a file";
            return Err(argument("text", format!("found `{}`, expected {expected}", shortened(text))));
        }
        let selection = arg::selection(base_link, tip_link, instruments, targets);
        py.detach(|| Model::parse(text, TEXT, &selection)).map(Robot::new).map_err(raise)
    }

    /// A robot of screws in the base frame at zero joint values.
    ///
    /// Parameters
    /// ----------
    /// screws
    ///     Array of shape (n, 6), a unit twist a joint: linear part v (metres), then angular part w, with |w| = 1 and v·w = 0; a sliding
    ///     joint has w = 0 and |v| = 1.
    /// home
    ///     Pose of the tip in the base at zero joint values, shape (4, 4).
    /// names
    ///     n names of the joints, default joint1, joint2, …
    /// limits
    ///     Array of shape (n, 2), radians or metres; rows of NaN, masked or infinite numbers are joints without limits.
    /// angular_first
    ///     Whether the angular part comes first.
    /// name, base_link, tip_link
    ///     Names of the robot and of its first and last frame.
    ///
    /// Returns
    /// -------
    /// Robot
    ///     The robot.
    #[staticmethod]
    #[pyo3(signature = (screws, home, *, names=None, limits=None, angular_first=false, name="robot", base_link="base", tip_link="tip"))]
    #[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
    fn from_screws(
        screws: &Bound<'_, PyAny>,
        home: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = arg::names)] names: Option<Vec<String>>,
        limits: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = arg::angular_first)] angular_first: bool,
        #[pyo3(from_py_with = arg::name)] name: &str,
        #[pyo3(from_py_with = arg::base_link)] base_link: &str,
        #[pyo3(from_py_with = arg::tip_link)] tip_link: &str,
    ) -> PyResult<Self> {
        let naming = Naming { name, names, limits, base_link, tip_link };
        from_screws(screws, home, angular_first, &naming).map(Robot::new)
    }

    /// A robot of Denavit-Hartenberg parameters.
    ///
    /// Parameters
    /// ----------
    /// a_m, alpha_rad, d_m, theta_rad
    ///     Arrays of shape (n,): link length, link twist, link offset and joint angle at zero reading. A revolute joint's reading adds to
    ///     theta, a prismatic one's to d.
    /// convention
    ///     "standard" (Rz Tz Tx Rx) or "modified" (Craig: Rx Tx Rz Tz, with a and alpha of the same row).
    /// kinds
    ///     "revolute" or "prismatic" for each joint, default all revolute.
    /// names
    ///     n names of the joints, default joint1, joint2, …
    /// limits
    ///     Array of shape (n, 2), radians or metres; rows of NaN, masked or infinite numbers are joints without limits.
    /// base, tool
    ///     Pose of the first frame in the base, and of the tip in the last frame, shape (4, 4) each; default the identity.
    /// name, base_link, tip_link
    ///     Names of the robot and of its first and last frame.
    ///
    /// Returns
    /// -------
    /// Robot
    ///     The robot.
    #[staticmethod]
    #[pyo3(signature = (*, a_m, alpha_rad, d_m, theta_rad, convention="standard", kinds=None, names=None, limits=None, base=None,
                        tool=None, name="robot", base_link="base", tip_link="tip"))]
    #[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
    fn from_dh(
        a_m: &Bound<'_, PyAny>,
        alpha_rad: &Bound<'_, PyAny>,
        d_m: &Bound<'_, PyAny>,
        theta_rad: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = arg::convention)] convention: &str,
        #[pyo3(from_py_with = arg::kinds)] kinds: Option<Vec<String>>,
        #[pyo3(from_py_with = arg::names)] names: Option<Vec<String>>,
        limits: Option<&Bound<'_, PyAny>>,
        base: Option<&Bound<'_, PyAny>>,
        tool: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = arg::name)] name: &str,
        #[pyo3(from_py_with = arg::base_link)] base_link: &str,
        #[pyo3(from_py_with = arg::tip_link)] tip_link: &str,
    ) -> PyResult<Self> {
        let naming = Naming { name, names, limits, base_link, tip_link };
        from_dh(&DhTable { a_m, alpha_rad, d_m, theta_rad, convention, kinds, base, tool }, &naming)
            .map(Robot::new)
    }

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
        let joints = Joints::of(joints, self.robot())?;
        let model = &self.model;
        let found = py
            .detach(|| predicted(model, &joints.readings, PredictionFrame::Base, target, false))
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
        let joints = Joints::of(joints, robot)?;
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

    /// The file that it was read from, as it was named; for robots of arrays their name.
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
    /// "approach" or "approach_JOINT" says from which side joints came, 1 or -1, "payload" which mass hangs at the tip, in kg. They are readings behind those of the joints.
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

    /// Names of the readings that a configuration consists of: those of the joints but for mimic joints, which follow another.
    #[getter]
    fn reading_names(&self) -> Vec<String> {
        self.robot().reading_names()
    }

    /// "revolute" or "prismatic", a joint each.
    #[getter]
    fn kinds(&self) -> Vec<&'static str> {
        self.robot().joints.iter().map(|joint| joint.kind.word()).collect()
    }

    /// Screws in the base frame at zero joint values, shape (n, 6): linear part (metres), then angular part.
    #[getter]
    fn screws<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let numbers: Vec<f64> = self
            .robot()
            .joints
            .iter()
            .flat_map(|joint| <[f64; 6]>::from(joint.screw.twist().to_vector()))
            .collect();
        table(py, numbers, 6)
    }

    /// Frames of the joints in the base at zero joint values, shape (n, 4, 4).
    #[getter]
    fn joint_frames<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let frames: Vec<_> = self.robot().joints.iter().map(|joint| joint.frame).collect();
        pose_arrays(py, &frames)
    }

    /// Lower and upper limits, shape (n, 2), radians or metres; infinite where a joint has none.
    #[getter]
    fn limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let none = [f64::NEG_INFINITY, f64::INFINITY];
        let of = |joint: &poecal_model::robot::Joint| {
            joint.limits.map_or(none, |limits| [limits.lower, limits.upper])
        };
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
    /// to
    ///     "urdf" (a new one, of links, joints and a tip) or "toml" (a table of screws).
    ///
    /// Returns
    /// -------
    /// str
    ///     The text.
    #[pyo3(signature = (to))]
    fn to_text(&self, py: Python<'_>, #[pyo3(from_py_with = arg::to)] to: &str) -> PyResult<String> {
        self.converted(py, form(Some(to), None)?)
    }

    /// Writes the model to a file.
    ///
    /// Parameters
    /// ----------
    /// path
    ///     The file.
    /// to
    ///     "urdf" or "toml", default as the extension says.
    /// force
    ///     Whether to write over a file that exists.
    #[pyo3(signature = (path, *, to=None, force=false))]
    fn write(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arg::path)] path: PathBuf,
        #[pyo3(from_py_with = arg::to)] to: Option<&str>,
        #[pyo3(from_py_with = arg::force)] force: bool,
    ) -> PyResult<()> {
        let form = form(to, Some(&path))?;
        let place = reserved_file(py, &path, Existing::forced(force), &[&self.model.path])?;
        place.write(vec![self.converted(py, form)?.into()]).map_err(raise)
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
