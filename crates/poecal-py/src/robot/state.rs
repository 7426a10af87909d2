//! What rebuilds a robot exactly.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use poecal::io::calibration_file::CalibrationFile;
use poecal::io::model::{Model, ModelSource};
use poecal::io::urdf::{ChainSelection, UrdfDocument};
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

use super::Robot;
use crate::errors::raise;

/// A robot and the file that it came from.
#[derive(Serialize, Deserialize)]
pub(crate) struct RobotState {
    robot: poecal::robot::Robot,
    path: PathBuf,
    source: SourceState,
    sha256: BTreeMap<String, String>,
}

#[derive(Serialize, Deserialize)]
enum SourceState {
    Urdf { text: String, base: String, tip: String },
    Toml,
    Calibration { text: String },
}

impl Robot {
    /// The robot as a state.
    pub(crate) fn state(&self) -> PyResult<RobotState> {
        let source = match &self.model.source {
            ModelSource::Urdf(document) => SourceState::Urdf {
                text: document.text().to_owned(),
                base: document.robot().base_name.clone(),
                tip: document.robot().tip_name.clone(),
            },
            ModelSource::Toml => SourceState::Toml,
            ModelSource::Calibration(file) => {
                SourceState::Calibration { text: file.to_text().map_err(raise)? }
            }
        };
        Ok(RobotState {
            robot: self.robot().clone(),
            path: self.model.path.clone(),
            source,
            sha256: (*self.sha256).clone(),
        })
    }

    /// The robot of a state.
    pub(crate) fn of_state(state: RobotState) -> PyResult<Self> {
        let RobotState { robot, path, source, sha256 } = state;
        let source = match source {
            SourceState::Urdf { text, base, tip } => {
                let selection = ChainSelection { base_link: Some(base), tip_link: Some(tip) };
                ModelSource::Urdf(Box::new(UrdfDocument::parse(&text, &path, &selection).map_err(raise)?))
            }
            SourceState::Toml => ModelSource::Toml,
            SourceState::Calibration { text } => {
                ModelSource::Calibration(Box::new(CalibrationFile::parse(&text, &path).map_err(raise)?))
            }
        };
        Ok(Robot { model: Arc::new(Model { robot, source, path }), sha256: Arc::new(sha256) })
    }
}
