//! The output folder of a calibration: written whole or not at all, and proven equal to the fit.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use super::calibration_file::{CalibrationFile, Inputs};
use super::model::{Model, ModelSource};
use super::proof::Difference;
use super::urdf::{self, ChainSelection, UrdfDocument};
use super::{residuals, robot_toml};
use crate::calibration::Calibration;
use crate::error::{Error, ErrorKind, Result};
use crate::measurement::Dataset;

/// Configurations on which written files are compared with the fit.
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
    /// Largest difference between the fitted robot and any of the models read back.
    pub largest: Difference,
    /// What had to be added or left out, a sentence each.
    pub notes: Vec<String>,
}

/// Refuses a folder that exists (unless `force`) or that cannot be made: asked before the work begins.
///
/// # Errors
/// [`ErrorKind::File`].
pub fn check_folder(folder: &Path, force: bool) -> Result<()> {
    let error = |message: &str| Err(Error::new(ErrorKind::File, message).in_file(folder));
    if folder.exists() {
        if !folder.is_dir() {
            return error("found a file, expected a folder for the results: choose another with --out");
        }
        if !force {
            return error(
                "the output folder exists, expected a new one: choose another with --out, or overwrite its results with --force",
            );
        }
        return Ok(());
    }
    check_parent(folder)
}

/// Refuses a place whose folder does not exist.
fn check_parent(path: &Path) -> Result<()> {
    if parent(path).is_dir() {
        return Ok(());
    }
    let message = "the folder above does not exist, expected one to write into: create it first";
    Err(Error::new(ErrorKind::File, message).in_file(path))
}

/// Writes a calibration's files. They are written beside the folder first, read back and compared with the fitted robot on 1,000
/// configurations, and only then put in place.
///
/// # Errors
/// [`ErrorKind::File`] if something cannot be written; [`ErrorKind::Export`] if a file read back differs from the fit by more than
/// 1e-9 m or rad. Nothing is left behind then.
pub fn write(
    folder: &Path,
    force: bool,
    model: &Model,
    data: &Dataset,
    calibration: &Calibration,
    inputs: Inputs,
) -> Result<Written> {
    check_folder(folder, force)?;
    let mut notes = Vec::new();
    let mut files =
        vec![("calibration.json".to_owned(), CalibrationFile::new(calibration, data, inputs).to_text()?)];
    let mut tip_link = calibration.robot.tip_name.clone();
    match &model.source {
        ModelSource::Urdf(document) => {
            let patched = document.patched(&calibration.robot)?;
            tip_link = patched.tip_link;
            notes.extend(patched.notes);
            files.push(("calibrated.urdf".to_owned(), patched.text));
        }
        ModelSource::Toml | ModelSource::Calibration(_) => {
            let mut robot = calibration.robot.clone();
            robot.targets = calibration
                .targets
                .iter()
                .filter_map(|target| target.name.clone().map(|name| (name, target.tip_from_target)))
                .collect();
            files.push(("calibrated.toml".to_owned(), robot_toml::write(&robot)));
            let urdf = urdf::write_new(&calibration.robot)?;
            notes.extend(urdf.notes);
            files.push(("calibrated.urdf".to_owned(), urdf.text));
        }
    }
    files.push(("residuals.csv".to_owned(), residuals::text(data, calibration)));
    let staging = Staging::new(folder)?;
    for (name, text) in &files {
        staging.write(name, text)?;
    }
    let largest = prove(&staging.folder, &files, calibration, &tip_link)?;
    staging.put_in_place(folder, &files)?;
    let files = files.into_iter().map(|(name, _)| name).collect();
    Ok(Written { folder: folder.to_path_buf(), files, largest, notes })
}

/// Reads every model back and compares it with the fitted robot.
fn prove(
    folder: &Path,
    files: &[(String, String)],
    calibration: &Calibration,
    tip_link: &str,
) -> Result<Difference> {
    let mut largest = Difference { position_m: 0.0, rotation_rad: 0.0 };
    for (name, _) in files {
        let path = folder.join(name);
        let robot = match name.rsplit('.').next() {
            Some("json") => CalibrationFile::read(&path)?.robot()?,
            Some("toml") => robot_toml::read(&path)?,
            Some("urdf") => {
                let base_link = Some(calibration.robot.base_name.clone());
                let selection = ChainSelection { base_link, tip_link: Some(tip_link.to_owned()) };
                UrdfDocument::read(&path, &selection)?.robot().clone()
            }
            _ => continue,
        };
        let difference = Difference::of(&calibration.robot, &robot, CONFIGURATIONS);
        if !difference.is_within(TOLERANCE, TOLERANCE) {
            return Err(Error::new(
                ErrorKind::Export,
                format!(
                    "{name} read back differs from the fit by {:.1e} m and {:.1e} rad, expected at most 1e-9: nothing was written",
                    difference.position_m, difference.rotation_rad
                ),
            ));
        }
        largest.position_m = largest.position_m.max(difference.position_m);
        largest.rotation_rad = largest.rotation_rad.max(difference.rotation_rad);
    }
    Ok(largest)
}

fn parent(folder: &Path) -> PathBuf {
    match folder.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_path_buf(),
        _ => PathBuf::from("."),
    }
}

/// A folder beside the final one, removed when dropped.
struct Staging {
    folder: PathBuf,
}

impl Staging {
    fn new(final_folder: &Path) -> Result<Self> {
        let name = final_folder.file_name().map_or_else(|| "out".into(), |name| name.to_string_lossy());
        let folder = parent(final_folder).join(format!(".{name}.unfinished-{}", std::process::id()));
        fs::create_dir(&folder).map_err(|error| {
            let message = format!(
                "the folder cannot be written to ({error}), expected one that can: choose another with --out"
            );
            Error::new(ErrorKind::File, message).in_file(final_folder)
        })?;
        Ok(Staging { folder })
    }

    fn write(&self, name: &str, text: &str) -> Result<()> {
        let path = self.folder.join(name);
        let result = fs::File::create(&path).and_then(|mut file| {
            file.write_all(text.as_bytes())?;
            file.sync_all()
        });
        result.map_err(|error| {
            Error::new(ErrorKind::File, format!("{name} cannot be written: {error}")).in_file(&self.folder)
        })
    }

    /// Moves the files to their folder: the whole folder at once if it is new, else file by file over the old ones.
    fn put_in_place(self, folder: &Path, files: &[(String, String)]) -> Result<()> {
        let moved = if folder.exists() {
            files.iter().try_for_each(|(name, _)| fs::rename(self.folder.join(name), folder.join(name)))
        } else {
            fs::rename(&self.folder, folder)
        };
        moved.map_err(|error| {
            Error::new(ErrorKind::File, format!("the results cannot be put in place: {error}"))
                .in_file(folder)
        })
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        // After the whole folder was moved there is nothing left, and nothing to report.
        let _ = fs::remove_dir_all(&self.folder);
    }
}

/// Writes one file whole or not at all: beside its place first, then moved.
///
/// # Errors
/// [`ErrorKind::File`] if it cannot be written.
pub fn write_file(path: &Path, text: &str) -> Result<()> {
    let error = |error: std::io::Error| {
        Error::new(
            ErrorKind::File,
            format!("the file cannot be written ({error}), expected a folder that can be written to: choose another"),
        )
        .in_file(path)
    };
    if path.is_dir() {
        let message = "found a directory, expected a file to write: name the file";
        return Err(Error::new(ErrorKind::File, message).in_file(path));
    }
    check_parent(path)?;
    let name = path.file_name().map_or_else(|| "out".into(), |name| name.to_string_lossy().into_owned());
    let beside = parent(path).join(format!(".{name}.unfinished-{}", std::process::id()));
    fs::write(&beside, text).map_err(error)?;
    fs::rename(&beside, path).map_err(|cause| {
        let _ = fs::remove_file(&beside);
        error(cause)
    })
}
