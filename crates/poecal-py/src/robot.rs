//! Robots.

mod state;

pub(crate) use state::{Robot, RobotState};

use std::path::{Path, PathBuf};

use maud::html;
use numpy::{PyArray2, PyArray3, PyArrayMethods as _};
use poecal::io::model::{Model, ModelFormat, ModelSource, convert};
use poecal::io::output::Existing;
use poecal::io::predictions::{PredictionFrame, predicted};
use poecal::io::robot_toml;
use poecal::io::urdf::{ChainSelection, UrdfDocument};
use poecal::robot::{Joint, JointKind};
use poecal::text::visible_markup;
use pyo3::IntoPyObjectExt as _;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::{Joints, pose_array, pose_arrays, table};
use crate::build::{DhTable, Naming, from_dh, from_screws};
use crate::errors::{argument, raise};
use crate::pickle;
use crate::places::reserved_file;
use crate::words::chosen;

/// The named form, or that of a file's extension.
pub(crate) fn form(to: Option<&str>, path: Option<&Path>) -> PyResult<ModelFormat> {
    if let Some(word) = to {
        return chosen("to", word, &[("urdf", ModelFormat::Urdf), ("toml", ModelFormat::Toml)]);
    }
    path.and_then(ModelFormat::of_path).ok_or_else(|| {
        argument(
            "to",
            match path {
                Some(path) => format!(
                    "found no form in the name `{}`, expected .urdf or .toml, or to=\"urdf\" or \"toml\"",
                    path.display()
                ),
                None => "found none, expected the form to write: \"urdf\" or \"toml\"".to_owned(),
            },
        )
    })
}

#[pymethods]
impl Robot {
    /// Reads a robot model of any form: URDF, TOML or calibration.json (of which it is the calibrated robot).
    ///
    /// `base_link` and `tip_link` choose the chain of a URDF that has several.
    #[staticmethod]
    #[pyo3(signature = (path, *, base_link=None, tip_link=None))]
    fn read(
        py: Python<'_>,
        path: PathBuf,
        base_link: Option<String>,
        tip_link: Option<String>,
    ) -> PyResult<Self> {
        let selection = ChainSelection { base_link, tip_link };
        Robot::of_file(py.detach(|| Model::read(&path, &selection)).map_err(raise)?)
    }

    /// Reads a chain of a URDF: from `base_link` to `tip_link` where there are several.
    #[staticmethod]
    #[pyo3(signature = (path, *, base_link=None, tip_link=None))]
    fn from_urdf(
        py: Python<'_>,
        path: PathBuf,
        base_link: Option<String>,
        tip_link: Option<String>,
    ) -> PyResult<Self> {
        let selection = ChainSelection { base_link, tip_link };
        let document = py.detach(|| UrdfDocument::read(&path, &selection)).map_err(raise)?;
        let (robot, source) = (document.robot().clone(), ModelSource::Urdf(Box::new(document)));
        Robot::of_file(Model { robot, source, path })
    }

    /// Reads a TOML model of screws or of Denavit-Hartenberg parameters.
    #[staticmethod]
    fn from_toml(path: PathBuf) -> PyResult<Self> {
        let robot = robot_toml::read(&path).map_err(raise)?;
        Robot::of_file(Model { robot, source: ModelSource::Toml, path })
    }

    /// A robot of screws in the base frame at zero joint values.
    ///
    /// Parameters
    /// ----------
    /// screws : array of shape (n, 6)
    ///     A unit twist a joint: linear part v (metres), then angular part w, with |w| = 1 and v·w = 0; a sliding joint has w = 0 and
    ///     |v| = 1. With `angular_first` the angular part comes first.
    /// home : array of shape (4, 4)
    ///     Pose of the tip in the base at zero joint values.
    /// names : list of n names, default joint1, joint2, …
    /// limits : array of shape (n, 2), radians or metres; rows of NaN or infinities are joints without limits
    #[staticmethod]
    #[pyo3(signature = (screws, home, *, names=None, limits=None, angular_first=false, name="robot", base_link="base", tip_link="tip"))]
    #[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
    fn from_screws(
        screws: &Bound<'_, PyAny>,
        home: &Bound<'_, PyAny>,
        names: Option<Vec<String>>,
        limits: Option<&Bound<'_, PyAny>>,
        angular_first: bool,
        name: &str,
        base_link: &str,
        tip_link: &str,
    ) -> PyResult<Self> {
        let naming = Naming { name, names, limits, base_link, tip_link };
        from_screws(screws, home, angular_first, &naming).map(Robot::new)
    }

    /// A robot of Denavit-Hartenberg parameters.
    ///
    /// Parameters
    /// ----------
    /// a_m, alpha_rad, d_m, theta_rad : arrays of shape (n,)
    ///     Link length, link twist, link offset and joint angle at zero reading, a joint each. A revolute joint's reading adds to theta,
    ///     a prismatic one's to d.
    /// convention : "standard" (Rz Tz Tx Rx) or "modified" (Craig: Rx Tx Rz Tz, with a and alpha of the same row)
    /// kinds : list of "revolute" or "prismatic", default all revolute
    /// names : list of n names, default joint1, joint2, …
    /// limits : array of shape (n, 2), radians or metres; rows of NaN or infinities are joints without limits
    /// base, tool : arrays of shape (4, 4)
    ///     Pose of the first frame in the base, and of the tip in the last frame; default the identity.
    #[staticmethod]
    #[pyo3(signature = (*, a_m, alpha_rad, d_m, theta_rad, convention="standard", kinds=None, names=None, limits=None, base=None,
                        tool=None, name="robot", base_link="base", tip_link="tip"))]
    #[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
    fn from_dh(
        a_m: &Bound<'_, PyAny>,
        alpha_rad: &Bound<'_, PyAny>,
        d_m: &Bound<'_, PyAny>,
        theta_rad: &Bound<'_, PyAny>,
        convention: &str,
        kinds: Option<Vec<String>>,
        names: Option<Vec<String>>,
        limits: Option<&Bound<'_, PyAny>>,
        base: Option<&Bound<'_, PyAny>>,
        tool: Option<&Bound<'_, PyAny>>,
        name: &str,
        base_link: &str,
        tip_link: &str,
    ) -> PyResult<Self> {
        let naming = Naming { name, names, limits, base_link, tip_link };
        from_dh(&DhTable { a_m, alpha_rad, d_m, theta_rad, convention, kinds, base, tool }, &naming)
            .map(Robot::new)
    }

    /// Poses of the tip, or of a target of the model, in the base frame.
    ///
    /// `joints` is of shape (m, n), radians and metres, in the order of `reading_names`; the result of shape (m, 4, 4). One
    /// configuration of shape (n,) gives one pose of shape (4, 4).
    #[pyo3(signature = (joints, *, target=None))]
    fn forward_kinematics<'py>(
        &self,
        py: Python<'py>,
        joints: &Bound<'py, PyAny>,
        target: Option<&str>,
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
    /// `joints` as for `forward_kinematics`; the result is of shape (m, n, 4, 4), or (n, 4, 4) for one configuration of shape (n,).
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
        let of =
            |joint: &poecal::robot::Joint| joint.limits.map_or(none, |limits| [limits.lower, limits.upper]);
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

    /// The model as a text, `to` "urdf" (a new one, of links, joints and a tip) or "toml" (a table of screws).
    #[pyo3(signature = (to))]
    fn to_text(&self, py: Python<'_>, to: &str) -> PyResult<String> {
        self.converted(py, form(Some(to), None)?)
    }

    /// Writes the model to a file, as `to` says, or else the extension; over one that exists only with `force`.
    #[pyo3(signature = (path, *, to=None, force=false))]
    fn write(&self, py: Python<'_>, path: PathBuf, to: Option<&str>, force: bool) -> PyResult<()> {
        let form = form(to, Some(&path))?;
        let place = reserved_file(py, &path, Existing::forced(force), &[&self.model.path])?;
        place.write(vec![self.converted(py, form)?.into()]).map_err(raise)
    }

    fn __repr__(&self) -> String {
        format!("<poecal.Robot {}>", self.words())
    }

    fn _repr_html_(&self) -> String {
        let ends = |joint: &Joint| {
            let (factor, unit) = match joint.kind {
                JointKind::Revolute => (1f64.to_degrees(), "°"),
                JointKind::Prismatic => (1e3, " mm"),
            };
            let ends = [joint.limits.map(|limits| limits.lower), joint.limits.map(|limits| limits.upper)];
            ends.map(|end| end.map_or("none".to_owned(), |end| format!("{:.1}{unit}", end * factor)))
        };
        visible_markup(html! {
            div {
                p { (self.words()) }
                table {
                    tr { @for name in ["joint", "kind", "lower", "upper", "direction"] { th { (name) } } }
                    @for joint in &self.robot().joints {
                        @let [x, y, z]: [f64; 3] = joint.screw.direction().into();
                        tr {
                            td { (joint.name) }
                            td { (joint.kind.word()) }
                            @for end in ends(joint) { td { (end) } }
                            td { (format_args!("({x:.4}, {y:.4}, {z:.4})")) }
                        }
                    }
                }
            }
        })
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

impl Robot {
    fn converted(&self, py: Python<'_>, form: ModelFormat) -> PyResult<String> {
        let converted = py.detach(|| convert(&self.model, form)).map_err(raise)?;
        crate::warn(py, &converted.notes)?;
        Ok(converted.text)
    }

    fn words(&self) -> String {
        let robot = self.robot();
        let names = self.joint_names().join(", ");
        format!(
            "{}: {} joints ({names}) from {} to {}",
            robot.name,
            robot.joints.len(),
            robot.base_name,
            robot.tip_name
        )
    }
}

/// Poses as an array, of shape (4, 4) for one configuration alone.
pub(crate) fn poses<'py>(
    py: Python<'py>,
    poses: &[poecal::lie::Pose],
    single: bool,
) -> PyResult<Bound<'py, PyAny>> {
    match poses {
        [pose] if single => pose_array(py, pose)?.into_bound_py_any(py),
        poses => pose_arrays(py, poses)?.into_bound_py_any(py),
    }
}
