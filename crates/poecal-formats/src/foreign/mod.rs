//! Models in forms of simulators and makers. Each is read as links and joints, and the equivalent URDF is the robot's document. So chains are
//! selected, and results written, as for any URDF.
//!
//! A new form is a module that makes links and joints, and a variant of [`ForeignForm`].

mod driver_yaml;
mod links;
mod mjcf;
mod sdf;
mod ur_conf;

use std::path::{Path, PathBuf};

use super::urdf::{ChainSelection, UrdfDocument};
use poecal_numerics::error::Result;
use poecal_storage::xml::root_name;

/// A form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForeignForm {
    /// MuJoCo's model.
    Mjcf,
    /// Gazebo's model.
    Sdf,
    /// Origins of joints, in files of drivers and descriptions of arms.
    DriverYaml,
    /// `calibration.conf` and `urcontrol.conf` of a controller of Universal Robots.
    UrConf,
}

impl ForeignForm {
    /// The form of a text; `None` for others.
    pub fn from_text(text: &str, path: &Path) -> Option<Self> {
        let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
        match extension.to_ascii_lowercase().as_str() {
            "yaml" | "yml" => return Some(ForeignForm::DriverYaml),
            "conf" => return Some(ForeignForm::UrConf),
            _ => {}
        }
        match root_name(text)? {
            "mujoco" | "mujocoinclude" => Some(ForeignForm::Mjcf),
            "sdf" | "gazebo" => Some(ForeignForm::Sdf),
            _ => None,
        }
    }

    /// Its name.
    pub(crate) fn name(self) -> &'static str {
        match self {
            ForeignForm::Mjcf => "MJCF",
            ForeignForm::Sdf => "SDF",
            ForeignForm::DriverYaml => "YAML",
            ForeignForm::UrConf => "controller's DH table",
        }
    }

    /// The file beside that an incomplete text needs.
    pub fn sibling(self, text: &str, path: &Path) -> Option<PathBuf> {
        (self == ForeignForm::UrConf).then(|| ur_conf::sibling(text, path)).flatten()
    }

    /// The URDF that is equivalent to a text and its sibling.
    pub fn read(
        self,
        text: &str,
        path: &Path,
        beside: Option<(&str, &Path)>,
        selection: &ChainSelection,
    ) -> Result<UrdfDocument> {
        let named: Vec<&str> = selection
            .base_link
            .iter()
            .chain(&selection.tip_link)
            .chain(selection.instruments.iter().chain(&selection.targets).map(|(_, link)| link))
            .map(String::as_str)
            .collect();
        let links = match self {
            ForeignForm::Mjcf => mjcf::read(text, path, &named),
            ForeignForm::Sdf => sdf::read(text, path, &named),
            ForeignForm::DriverYaml => driver_yaml::read(text, path),
            ForeignForm::UrConf => ur_conf::read(text, path, beside),
        }?;
        // Its lines are in no file.
        UrdfDocument::parse(&links.urdf(), path, selection)
            .map(|document| document.made_from(self.name(), links.unread.clone()))
            .map_err(|error| error.without_line())
    }
}
