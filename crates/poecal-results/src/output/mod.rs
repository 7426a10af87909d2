//! Output files and folders, written completely or not at all, with every robot model verified.
//!
//! A place is reserved before the work ([`ReservedFolder`], [`ReservedFile`]). Files are written to a staging folder (`staging.rs`), read back
//! and put in place together (`exchange.rs`, `journal.rs`). Remains of an interrupted run are settled by the next one (`leftovers.rs`), or
//! by a signal handler ([`clean_up`]).
//!
//! A folder that holds nothing but results is exchanged whole. In any other folder, files are renamed one by one by a journal. That holds for the
//! current folder too, whose earlier state an open shell or a bind mount would still show. The journal is on the disk before the first rename,
//! together with the journal that undoes it: a full disk may cause a failure. A lock on the staging folder shows whether its run is still active. A
//! signal cleans up at once (`interruption.rs`), but not while files are put in place.

mod calibration;
mod contents;
mod exchange;
mod existing;
mod file;
mod hand_eye;
mod interruption;
mod journal;
mod leftovers;
mod output_folder;
mod photographs;
mod project;
mod reproduction;
mod simulation;
mod staging;
mod validation;

pub use calibration::{Results, write};
pub use contents::{Contents, REPORT};
pub use existing::ExistingFiles;
pub use file::ReservedFile;
pub use hand_eye::write_texts;
pub use leftovers::clean_up;
pub use output_folder::{ReservedFolder, free_folder};
pub use photographs::{PhotographedSession, write_photographs};
pub use project::{Project, write_project};
pub use reproduction::write_reproduction;
pub use simulation::{SimulatedSession, write_simulation};
pub use validation::ValidationOutputs;

use std::borrow::Cow;
use std::io::Write;
use std::path::{Path, PathBuf};

use super::model::{Model, ModelSource};
use super::residuals::ResidualRows;
use poecal_formats::proof::{Difference, ReferencePoses};
use poecal_formats::robot_toml;
use poecal_formats::urdf::{self, ChainSelection};
use poecal_model::robot::Robot;
use poecal_numerics::error::{ErrorKind, Result};

/// Number of configurations in which written models are compared with their robot.
const CONFIGURATIONS: usize = 1000;
/// Largest allowed difference, metres and radians.
const TOLERANCE: f64 = 1e-9;

/// Summary of written files.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenFiles {
    /// The folder.
    pub folder: PathBuf,
    /// Names of the files in it.
    pub files: Vec<String>,
    /// Largest difference of a model read back from its robot.
    pub largest: Difference,
    /// Additions and omissions, a sentence each.
    pub notes: Vec<String>,
}

/// A page in consecutive pieces, so that constant ones need not be copied.
pub type PagePieces = Vec<Cow<'static, str>>;

/// Contents of a file.
enum FileContent<'a> {
    Text(PagePieces),
    /// Rows, written in parts: there may be many.
    Rows(ResidualRows<'a>),
    Bytes(&'a [u8]),
}

/// A file to be written.
pub struct NewFile<'a> {
    name: String,
    content: FileContent<'a>,
    /// The robot of a model file, and the selection that reads it from the file.
    model_of: Option<(Cow<'a, Robot>, ChainSelection)>,
}

impl<'a> NewFile<'a> {
    fn new(name: &str, text: String) -> Self {
        NewFile { name: name.to_owned(), content: FileContent::Text(vec![text.into()]), model_of: None }
    }

    fn of_page(name: &str, page: PagePieces) -> Self {
        NewFile { name: name.to_owned(), content: FileContent::Text(page), model_of: None }
    }

    fn of_rows(name: &str, rows: ResidualRows<'a>) -> Self {
        NewFile { name: name.to_owned(), content: FileContent::Rows(rows), model_of: None }
    }

    fn of_bytes(name: String, bytes: &'a [u8]) -> Self {
        NewFile { name, content: FileContent::Bytes(bytes), model_of: None }
    }

    fn of_robot(name: String, text: String, robot: &'a Robot) -> Self {
        NewFile::of_urdf(name, text, Cow::Borrowed(robot), ChainSelection::default())
    }

    fn of_urdf(name: String, text: String, robot: Cow<'a, Robot>, selection: ChainSelection) -> Self {
        NewFile { name, content: FileContent::Text(vec![text.into()]), model_of: Some((robot, selection)) }
    }

    fn write_to(&self, out: &mut (dyn Write + Send)) -> std::io::Result<()> {
        match &self.content {
            FileContent::Text(pieces) => pieces.iter().try_for_each(|piece| out.write_all(piece.as_bytes())),
            FileContent::Rows(rows) => rows.write_to(out),
            FileContent::Bytes(bytes) => out.write_all(bytes),
        }
    }

    /// The robot of the file, read back from its staging folder.
    fn read_back(&self, selection: &ChainSelection, folder: &Path, final_folder: &Path) -> Result<Robot> {
        let read = Model::read(folder.join(&self.name), selection);
        Ok(read.map_err(|error| error.with_path(&final_folder.join(&self.name)))?.robot)
    }
}

/// Compares the models among the files with their robots; returns the largest difference.
fn prove(files: &[NewFile], folder: &Path, final_folder: &Path) -> Result<Difference> {
    let mut largest = Difference { position_m: 0.0, rotation_rad: 0.0 };
    let mut known: Option<ReferencePoses> = None;
    for file in files {
        let Some((robot, selection)) = &file.model_of else { continue };
        let read = file.read_back(selection, folder, final_folder)?;
        let reference = match known.take() {
            Some(known) if known.is_of(robot) => known,
            _ => ReferencePoses::new(robot, CONFIGURATIONS),
        };
        let difference = reference.difference(&read);
        known = Some(reference);
        if !difference.is_within(TOLERANCE, TOLERANCE) {
            return ErrorKind::Export.refuse(format!(
                "{} read back differs from its robot by {:.1e} m and {:.1e} rad, expected at most 1e-9: nothing was written",
                file.name, difference.position_m, difference.rotation_rad
            ));
        }
        largest.position_m = largest.position_m.max(difference.position_m);
        largest.rotation_rad = largest.rotation_rad.max(difference.rotation_rad);
    }
    Ok(largest)
}

/// A robot in the form of `model`: the same URDF text with other values, or a TOML model and a new URDF. Additions and omissions are
/// appended to `notes`.
fn robot_files<'a>(stem: &str, model: &Model, robot: &'a Robot, notes: &mut Vec<String>) -> Result<Vec<NewFile<'a>>> {
    let urdf = format!("{stem}.urdf");
    let plain = urdf::holdable(robot, notes);
    let (text, selection) = model.urdf_of(&plain, notes)?;
    let new = NewFile::of_urdf(urdf, text, plain, selection);
    Ok(match &model.source {
        ModelSource::Urdf(_) => vec![new],
        ModelSource::Toml | ModelSource::Calibration(_) => {
            vec![NewFile::of_robot(format!("{stem}.toml"), robot_toml::write(robot), robot), new]
        }
    })
}

/// Writes the files to their staging folder, verifies the models, and puts all in place, also `elsewhere`. Other files of an earlier run
/// are removed, so that a folder never mixes two runs.
fn write_files(
    mut place: ReservedFolder,
    files: &[NewFile],
    elsewhere: Option<(ReservedFile, PagePieces)>,
    mut notes: Vec<String>,
) -> Result<WrittenFiles> {
    for file in files {
        place.stage(file)?;
    }
    let folder = place.named.clone();
    let largest = prove(files, &place.staging.new_files(), &folder)?;
    let names: Vec<String> = files.iter().map(|file| file.name.clone()).collect();
    let elsewhere = elsewhere.map(|(mut file, page)| file.stage(page).map(|()| file)).transpose()?;
    let _undisturbed = interruption::hold_clean_up();
    let put = elsewhere.map(ReservedFile::put).transpose()?;
    match place.put(&names) {
        Ok(said) => notes.extend(said),
        Err(error) => {
            return Err(put.into_iter().fold(error, |error, put| put.take_back(error)));
        }
    }
    put.into_iter().for_each(file::ReplacedFile::finish);
    Ok(WrittenFiles { folder, files: names, largest, notes })
}
