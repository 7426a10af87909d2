//! A robot and its file, their pickled state, and their reading and writing.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use poecal_compensate::Inverse;
use poecal_formats::urdf::{ChainSelection, UrdfDocument};
use poecal_results::calibration_file::{CalibrationFile, Inputs};
use poecal_results::model::{Model, ModelFormat, ModelSource, convert};
use pyo3::IntoPyObjectExt as _;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

use crate::arguments::{Argument, unexpected_error};
use crate::arrays::{pose_array, pose_arrays};
use crate::errors::{argument, raise};
use crate::words::choose_word;

/// Inverse kinematics at these values of the factors.
type CachedInverse = (Vec<f64>, Arc<Inverse>);

/// A serial robot: joints with screws, and a home pose. It never changes.
///
/// Make one by `Robot.read` (any file), `from_urdf`, `from_toml`, `from_screws` or `from_dh`. Lengths are in metres, angles in
/// radians. Robots compare by value, and can be copied and pickled.
#[pyclass(frozen, module = "poecal", name = "Robot")]
#[derive(Clone)]
pub(crate) struct Robot {
    pub(crate) model: Arc<Model>,
    /// SHA-256 of the file from which it was read, by its name.
    pub(crate) sha256: Arc<BTreeMap<String, String>>,
    /// Its inverse kinematics at the factors of the last call.
    inverse: Arc<Mutex<Option<CachedInverse>>>,
}

impl Robot {
    pub(crate) fn new(model: Model) -> Self {
        Robot { model: Arc::new(model), sha256: Arc::default(), inverse: Arc::default() }
    }

    /// The same file with another robot.
    pub(crate) fn with_robot(&self, robot: poecal_model::robot::Robot) -> Self {
        let model = Model { robot, source: self.model.source.clone(), path: self.model.path.clone() };
        Robot { model: Arc::new(model), sha256: Arc::clone(&self.sha256), inverse: Arc::default() }
    }

    /// A model from a file, with the file's checksum.
    pub(super) fn of_file(model: Model) -> PyResult<Self> {
        let sha256 = Inputs::checksums([model.path.as_path()].into_iter()).map_err(raise)?;
        Ok(Robot { model: Arc::new(model), sha256: Arc::new(sha256), inverse: Arc::default() })
    }

    /// Its inverse kinematics at these factors: computed once while they stay the same, since that takes longer than many poses.
    pub(crate) fn inverse(&self, factors: &[f64]) -> poecal_numerics::error::Result<Arc<Inverse>> {
        let mut kept = self.inverse.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((of, inverse)) = &*kept
            && of == factors
        {
            return Ok(Arc::clone(inverse));
        }
        let made = Arc::new(Inverse::new(&self.model.robot, factors)?);
        *kept = Some((factors.to_vec(), Arc::clone(&made)));
        Ok(made)
    }

    pub(super) fn robot(&self) -> &poecal_model::robot::Robot {
        &self.model.robot
    }

    /// The robot as a state.
    pub(crate) fn state(&self) -> PyResult<RobotState> {
        let source = match &self.model.source {
            ModelSource::Urdf(document) => SourceState::Urdf {
                text: document.text().to_owned(),
                base: document.robot().base_name.clone(),
                tip: document.robot().tip_name.clone(),
                instruments: document.selection().instruments,
                targets: document.selection().targets,
            },
            ModelSource::Toml => SourceState::Toml,
            ModelSource::Calibration(file) => SourceState::Calibration { text: file.to_text().map_err(raise)? },
        };
        Ok(RobotState {
            robot: self.robot().clone(),
            path: self.model.path.clone(),
            source,
            sha256: (*self.sha256).clone(),
        })
    }

    /// The robot from a state.
    pub(crate) fn of_state(state: RobotState) -> PyResult<Self> {
        let RobotState { robot, path, source, sha256 } = state;
        let source = match source {
            SourceState::Urdf { text, base, tip, instruments, targets } => {
                let (base_link, tip_link) = (Some(base), Some(tip));
                let selection = ChainSelection { base_link, tip_link, instruments, targets };
                ModelSource::Urdf(Box::new(UrdfDocument::parse(&text, &path, &selection).map_err(raise)?))
            }
            SourceState::Toml => ModelSource::Toml,
            SourceState::Calibration { text } => {
                ModelSource::Calibration(Box::new(CalibrationFile::parse(&text, &path).map_err(raise)?))
            }
        };
        Ok(Robot { model: Arc::new(Model { robot, source, path }), sha256: Arc::new(sha256), inverse: Arc::default() })
    }
}

/// A robot and its file.
#[derive(Serialize, Deserialize)]
pub(crate) struct RobotState {
    robot: poecal_model::robot::Robot,
    path: PathBuf,
    source: SourceState,
    sha256: BTreeMap<String, String>,
}

#[derive(Serialize, Deserialize)]
enum SourceState {
    Urdf {
        text: String,
        base: String,
        tip: String,
        #[serde(default)]
        instruments: Vec<(String, String)>,
        #[serde(default)]
        targets: Vec<(String, String)>,
    },
    Toml,
    Calibration {
        text: String,
    },
}

impl Robot {
    pub(super) fn convert_to(&self, py: Python<'_>, form: ModelFormat) -> PyResult<String> {
        let converted = py.detach(|| convert(&self.model, form)).map_err(raise)?;
        crate::warn(py, &converted.notes)?;
        Ok(converted.text)
    }

    pub(super) fn words(&self) -> String {
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
    poses: &[poecal_arm::lie::Pose],
    single: bool,
) -> PyResult<Bound<'py, PyAny>> {
    match poses {
        [pose] if single => pose_array(py, pose)?.into_bound_py_any(py),
        poses => pose_arrays(py, poses)?.into_bound_py_any(py),
    }
}

/// The named form, or that of a file's extension.
pub(crate) fn form(format: Option<&str>, path: Option<&Path>) -> PyResult<ModelFormat> {
    if let Some(word) = format {
        return choose_word("format", word, &[("urdf", ModelFormat::Urdf), ("toml", ModelFormat::Toml)]);
    }
    path.and_then(ModelFormat::of_path).ok_or_else(|| {
        argument(
            "format",
            match path {
                Some(path) => format!(
                    "found no form in the name `{}`, expected .urdf or .toml, or format=\"urdf\" or \"toml\"",
                    path.display()
                ),
                None => "found none, expected the form to write: \"urdf\" or \"toml\"".to_owned(),
            },
        )
    })
}

impl<'a, 'py> Argument<'a, 'py> for &'a Robot {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        let expected = "a poecal.Robot; poecal.Robot.read reads one from a file";
        value.cast::<Robot>().map(Bound::get).map_err(|_| unexpected_error(name, value, expected))
    }
}
