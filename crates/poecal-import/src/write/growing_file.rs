//! A measurement file that grows while it is being read.

use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

use crate::read::parse;
use crate::{MeasurementFile, ReadOptions};
use poecal_model::robot::Robot;
use poecal_numerics::error::Result;
use poecal_storage::{disk, source_text};

/// Bytes that show whether a file has text.
const HEAD: u64 = 4096;

/// A measurement file that is read repeatedly while lines are added to it.
///
/// ```no_run
/// use poecal_import::{GrowingFile, ReadOptions};
/// let mut file = GrowingFile::new("measurements.csv");
/// let news = file.news(&poecal_model::simulate::elbow(), &ReadOptions::default())?;
/// assert!(news.is_none_or(|news| !news.is_again));
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct GrowingFile {
    path: PathBuf,
    known: String,
    /// True if a missing, empty or shorter file is waited for.
    is_waited_for: bool,
    /// Number of consecutive reads in which it was shorter than the known text.
    shorter: u32,
}

/// Number of such reads after which the file counts as cut, and not as being written again.
const LOOKS: u32 = 20;

/// Change of a file since the last read.
#[derive(Clone, Debug)]
pub struct NewRows {
    /// All complete rows.
    pub file: MeasurementFile,
    /// True if earlier lines were changed or removed, so that all rows are new.
    pub is_again: bool,
}

impl GrowingFile {
    /// A file of which nothing is read yet.
    #[must_use]
    pub fn new(path: impl AsRef<Path>) -> Self {
        let path = path.as_ref().to_path_buf();
        GrowingFile { path, known: String::new(), is_waited_for: false, shorter: 0 }
    }

    /// Waits for the file: a missing or empty file, or for some reads a shorter one, is no change.
    #[must_use]
    pub fn waited_for(self) -> Self {
        GrowingFile { is_waited_for: true, ..self }
    }

    /// True if there is no file, or one without text.
    #[must_use]
    pub fn is_absent(&self) -> bool {
        let mut head = Vec::new();
        match disk::current_disk().open(&self.path) {
            Err(error) => error.kind() == io::ErrorKind::NotFound,
            Ok(file) => {
                let read = file.take(HEAD).read_to_end(&mut head);
                read.is_ok() && (head.len() as u64) < HEAD && head.iter().all(u8::is_ascii_whitespace)
            }
        }
    }

    /// All rows, if complete lines were added or changed; a last line without an end is waited for.
    ///
    /// # Errors
    /// Those of [`crate::read()`].
    pub fn news(&mut self, robot: &Robot, options: &ReadOptions) -> Result<Option<NewRows>> {
        if self.is_waited_for && self.is_absent() {
            return Ok(None);
        }
        let text = source_text::read(&self.path, "a measurement file (CSV)")?;
        let complete = text.rfind('\n').map_or("", |end| &text[..=end]);
        if complete == self.known {
            return Ok(None);
        }
        if self.is_waited_for && self.known.starts_with(complete) && self.shorter < LOOKS {
            self.shorter += 1;
            return Ok(None);
        }
        self.shorter = 0;
        let is_again = !complete.starts_with(&self.known);
        let is_row = |line: &&str| !line.trim().is_empty() && !line.trim_start().starts_with('#');
        // Names of columns and a row are needed.
        if complete.lines().filter(is_row).nth(1).is_none() {
            return Ok(None);
        }
        let file = parse(complete, &self.path, robot, options)?;
        complete.clone_into(&mut self.known);
        Ok(Some(NewRows { file, is_again }))
    }
}
