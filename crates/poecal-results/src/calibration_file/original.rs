//! The URDF that was calibrated, kept in its result.

use std::collections::BTreeMap;
use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{CalibrationFile, Inputs};
use crate::model::{Model, ModelSource};
use poecal_formats::urdf::{ChainSelection, UrdfDocument};
use poecal_numerics::error::Result;
use poecal_storage::hashes::sha256_of;

/// The URDF that was calibrated, with the selection of its chain. Every URDF form of the result is this text with other numbers, so that meshes,
/// comments and links outside the chain remain.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct OriginalUrdf {
    /// SHA-256 of the text.
    pub sha256: String,
    /// First link of the chain.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base_link: Option<String>,
    /// Last link of the chain.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tip_link: Option<String>,
    /// Instruments on the robot, each with its link.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub instruments: BTreeMap<String, String>,
    /// Targets on any link, each with it.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub targets: BTreeMap<String, String>,
    /// The whole text.
    pub text: String,
}

impl OriginalUrdf {
    /// Copy of a document.
    fn from_document(document: &UrdfDocument) -> Self {
        let ChainSelection { base_link, tip_link, instruments, targets } = document.selection();
        OriginalUrdf {
            sha256: sha256_of(document.text()),
            base_link,
            tip_link,
            instruments: instruments.into_iter().collect(),
            targets: targets.into_iter().collect(),
            text: document.text().to_owned(),
        }
    }

    /// The calibrated part of the text.
    #[must_use]
    pub fn selection(&self) -> ChainSelection {
        ChainSelection {
            base_link: self.base_link.clone(),
            tip_link: self.tip_link.clone(),
            instruments: self.instruments.clone().into_iter().collect(),
            targets: self.targets.clone().into_iter().collect(),
        }
    }
}

impl Inputs {
    /// The model, with its text if it is a URDF or the calibration of one.
    #[must_use]
    pub fn of_model(model: &Model) -> Self {
        let urdf = match &model.source {
            ModelSource::Urdf(document) => Some(OriginalUrdf::from_document(document)),
            ModelSource::Calibration(file) => file.inputs.urdf.clone(),
            ModelSource::Toml => None,
        };
        Inputs { model: model.path.display().to_string(), urdf, ..Inputs::default() }
    }
}

impl CalibrationFile {
    /// The URDF that was calibrated. `None` if the model was no URDF, or if the file is of an earlier version.
    ///
    /// # Errors
    /// [`ErrorKind::Model`](poecal_numerics::error::ErrorKind::Model) or
    /// [`ErrorKind::Syntax`](poecal_numerics::error::ErrorKind::Syntax) if the text in the file is no such URDF.
    pub fn original_urdf(&self, path: &Path) -> Result<Option<UrdfDocument>> {
        let read = |kept: &OriginalUrdf| UrdfDocument::parse(&kept.text, path, &kept.selection());
        self.inputs.urdf.as_ref().map(read).transpose()
    }
}
