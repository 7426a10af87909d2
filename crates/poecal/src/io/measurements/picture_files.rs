//! Files that are of pictures: of corners, or of the joint readings of each picture.

use std::collections::BTreeMap;
use std::path::PathBuf;

use crate::measurement::Set;

/// What is said of corners where no camera is stated.
pub(super) const NO_CAMERA: &str =
    "found corners in pixels and no camera, expected --camera FILE with its focal lengths and centre";

/// The configuration of a picture.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Taken {
    pub(super) readings: Vec<f64>,
    pub(super) set: Option<Set>,
    pub(super) id: String,
    /// File and line.
    pub(super) place: (PathBuf, usize),
}

/// Configurations by the names of their pictures.
pub(super) type TakenByImage = BTreeMap<String, Taken>;
