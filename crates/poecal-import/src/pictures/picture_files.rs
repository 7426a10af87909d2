//! Files of pictures: with corners, or with the joint readings of each picture.

use std::collections::BTreeMap;
use std::path::PathBuf;

use poecal_model::measurement::Set;

/// Error of corners without a stated camera.
pub(crate) const NO_CAMERA: &str =
    "found corners in pixels and no camera, expected --camera FILE with its focal lengths and centre";

/// The configuration of a picture.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PictureConfiguration {
    pub(crate) readings: Vec<f64>,
    pub(crate) set: Option<Set>,
    pub(crate) id: String,
    /// File and line.
    pub(crate) place: (PathBuf, usize),
}

/// Configurations by the names of their pictures.
pub(crate) type ConfigurationsByImage = BTreeMap<String, PictureConfiguration>;
