//! Robots from files, texts and arrays.

use std::path::PathBuf;

use poecal_formats::robot_toml;
use poecal_formats::urdf::UrdfDocument;
use poecal_results::model::{Model, ModelSource};
use pyo3::prelude::*;

use super::content::Robot;
use crate::arguments::{self as arg, NamedLinks, is_content};
use crate::build::{DhArguments, NamingArguments, from_dh, from_screws};
use crate::errors::{argument, raise};
use crate::words::shorten_text;

/// Path of a robot that was read from a text.
const TEXT: &str = "text";

#[pymethods]
impl Robot {
    /// Reads a robot model of any form: URDF, MJCF, SDF, TOML, a driver's YAML, a controller's conf, or the calibrated robot of a calibration.json.
    ///
    /// Parameters
    /// ----------
    /// path
    ///     The file; its extension determines the form, or else the beginning of its text.
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
        #[pyo3(from_py_with = arg::instruments)] instruments: Option<NamedLinks>,
        #[pyo3(from_py_with = arg::targets)] targets: Option<NamedLinks>,
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
    ///     First and last link of the chain, if there are several.
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
        #[pyo3(from_py_with = arg::instruments)] instruments: Option<NamedLinks>,
        #[pyo3(from_py_with = arg::targets)] targets: Option<NamedLinks>,
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
        #[pyo3(from_py_with = arg::instruments)] instruments: Option<NamedLinks>,
        #[pyo3(from_py_with = arg::targets)] targets: Option<NamedLinks>,
    ) -> PyResult<Self> {
        if !is_content(text) {
            let expected = "the text of a model; poecal.Robot.read reads a file";
            return Err(argument("text", format!("found `{}`, expected {expected}", shorten_text(text))));
        }
        let selection = arg::selection(base_link, tip_link, instruments, targets);
        py.detach(|| Model::parse(text, TEXT, &selection)).map(Robot::new).map_err(raise)
    }

    /// A robot of screws in the base frame at zero joint values.
    ///
    /// Parameters
    /// ----------
    /// screws
    ///     Array of shape (n, 6), a unit twist for each joint: linear part v (metres), then angular part w, with |w| = 1 and v·w = 0; a sliding joint
    ///     has w = 0 and |v| = 1.
    /// home
    ///     Pose of the tip in the base at zero joint values, shape (4, 4).
    /// names
    ///     n names of the joints, default joint1, joint2, …
    /// limits
    ///     Array of shape (n, 2), radians or metres; rows of NaN, masked or infinite numbers are joints without limits.
    /// angular_first
    ///     True if the angular part comes first.
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
        let naming = NamingArguments { name, names, limits, base_link, tip_link };
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
        let naming = NamingArguments { name, names, limits, base_link, tip_link };
        from_dh(&DhArguments { a_m, alpha_rad, d_m, theta_rad, convention, kinds, base, tool }, &naming).map(Robot::new)
    }
}
