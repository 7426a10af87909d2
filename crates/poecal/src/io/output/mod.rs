//! Output folders: written whole or not at all, and every robot model in them proven equal to the one it is of.

mod calibration;
mod project;
mod reproduction;
mod simulation;
mod staging;

pub use calibration::{REPORT, Results, write, write_robot};
pub use project::{Project, write_project};
pub use reproduction::write_reproduction;
pub use simulation::{Session, write_simulation};
pub use staging::{check_file, check_folder, write_file};

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use super::model::{Model, ModelSource};
use super::proof::Difference;
use super::residuals::Rows;
use super::robot_toml;
use super::urdf::{self, ChainSelection};
use crate::error::{Error, ErrorKind, Result};
use crate::robot::Robot;
use staging::Staging;

/// Configurations on which written models are compared with their robot.
const CONFIGURATIONS: usize = 1000;
/// Largest difference allowed, metres and radians.
const TOLERANCE: f64 = 1e-9;

/// What was written.
///
/// ```
/// # use poecal::io::{Difference, output::Written};
/// let written = Written { folder: "out".into(), files: vec!["calibration.json".into()], largest: Difference { position_m: 0.0, rotation_rad: 0.0 }, notes: vec![] };
/// assert_eq!(written.files.len(), 1);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// The folder.
    pub folder: PathBuf,
    /// Names of the files in it.
    pub files: Vec<String>,
    /// Largest difference between a robot and any of its models read back.
    pub largest: Difference,
    /// What had to be added or left out, a sentence each.
    pub notes: Vec<String>,
}

/// What a file will hold.
enum Content<'a> {
    Text(String),
    /// Written some at a time: there may be many.
    Rows(Rows<'a>),
}

/// A file to be written.
struct NewFile<'a> {
    name: String,
    content: Content<'a>,
    /// The robot that the file is a model of, and the link that is its tip there.
    model_of: Option<(&'a Robot, String)>,
}

impl<'a> NewFile<'a> {
    fn new(name: &str, text: String) -> Self {
        NewFile { name: name.to_owned(), content: Content::Text(text), model_of: None }
    }

    fn of_rows(name: &str, rows: Rows<'a>) -> Self {
        NewFile { name: name.to_owned(), content: Content::Rows(rows), model_of: None }
    }

    fn of_robot(name: String, text: String, robot: &'a Robot) -> Self {
        NewFile { name, content: Content::Text(text), model_of: Some((robot, robot.tip_name.clone())) }
    }

    fn write_to(&self, out: &mut File) -> std::io::Result<()> {
        match &self.content {
            Content::Text(text) => out.write_all(text.as_bytes()),
            Content::Rows(rows) => rows.write_to(out),
        }
    }

    /// Compares the model, read back, with its robot.
    fn prove(&self, folder: &Path, final_folder: &Path) -> Result<Option<Difference>> {
        let Some((robot, tip_link)) = &self.model_of else { return Ok(None) };
        let path = folder.join(&self.name);
        let selection = if self.name.ends_with(".urdf") {
            ChainSelection { base_link: Some(robot.base_name.clone()), tip_link: Some(tip_link.clone()) }
        } else {
            ChainSelection::default()
        };
        let read = Model::read(&path, &selection);
        let model = read.map_err(|error| error.with_path(&final_folder.join(&self.name)))?;
        let difference = Difference::of(robot, &model.robot, CONFIGURATIONS);
        if difference.is_within(TOLERANCE, TOLERANCE) {
            return Ok(Some(difference));
        }
        Err(Error::new(
            ErrorKind::Export,
            format!(
                "{} read back differs from its robot by {:.1e} m and {:.1e} rad, expected at most 1e-9: nothing was written",
                self.name, difference.position_m, difference.rotation_rad
            ),
        ))
    }
}

/// A robot in the form that `model` was read from: the same URDF text with other values, or else a TOML model and a new URDF.
/// Appends what had to be added or left out to `notes`.
fn robot_files<'a>(
    stem: &str,
    model: &Model,
    robot: &'a Robot,
    notes: &mut Vec<String>,
) -> Result<Vec<NewFile<'a>>> {
    let urdf = format!("{stem}.urdf");
    match &model.source {
        ModelSource::Urdf(document) => {
            let patched = document.patched(robot)?;
            notes.extend(patched.notes);
            let model_of = Some((robot, patched.tip_link));
            Ok(vec![NewFile { name: urdf, content: Content::Text(patched.text), model_of }])
        }
        ModelSource::Toml | ModelSource::Calibration(_) => {
            let toml = NewFile::of_robot(format!("{stem}.toml"), robot_toml::write(robot), robot);
            let new = urdf::write_new(robot)?;
            notes.extend(new.notes);
            Ok(vec![toml, NewFile::of_robot(urdf, new.text, robot)])
        }
    }
}

/// Writes the files beside the folder first, proves the models among them, and only then puts all in place. Of `own_names`, those
/// that an earlier run left and this one does not write go, so that a folder never mixes two runs.
fn write_files(folder: &Path, files: &[NewFile], own_names: &[&str], notes: Vec<String>) -> Result<Written> {
    let staging = Staging::new(folder)?;
    for file in files {
        staging.write(&file.name, |out| file.write_to(out))?;
    }
    let mut largest = Difference { position_m: 0.0, rotation_rad: 0.0 };
    for difference in files.iter().map(|file| file.prove(staging.folder(), folder)) {
        if let Some(difference) = difference? {
            largest.position_m = largest.position_m.max(difference.position_m);
            largest.rotation_rad = largest.rotation_rad.max(difference.rotation_rad);
        }
    }
    let names: Vec<String> = files.iter().map(|file| file.name.clone()).collect();
    staging.put_in_place(&names, own_names)?;
    Ok(Written { folder: folder.to_path_buf(), files: names, largest, notes })
}
