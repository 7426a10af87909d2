//! A measurement file that grows while it is read.

use std::path::{Path, PathBuf};

use crate::read::parse;
use crate::{MeasurementFile, ReadOptions};
use poecal_model::robot::Robot;
use poecal_numerics::error::Result;
use poecal_storage::source_text;

/// A measurement file that is read again and again while lines are added to it.
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
}

/// What a file has become.
#[derive(Clone, Debug)]
pub struct News {
    /// All complete rows.
    pub file: MeasurementFile,
    /// Whether lines that were read before were changed or are gone, so that all rows are new.
    pub is_again: bool,
}

impl GrowingFile {
    /// A file of which nothing is read yet.
    #[must_use]
    pub fn new(path: impl AsRef<Path>) -> Self {
        GrowingFile { path: path.as_ref().to_path_buf(), known: String::new() }
    }

    /// All rows, if there are other complete lines than before; a last line without an end is waited for.
    ///
    /// # Errors
    /// As [`crate::read()`].
    pub fn news(&mut self, robot: &Robot, options: &ReadOptions) -> Result<Option<News>> {
        let text = source_text::read(&self.path, "a measurement file (CSV)")?;
        let complete = text.rfind('\n').map_or("", |end| &text[..=end]);
        if complete == self.known {
            return Ok(None);
        }
        let is_again = !complete.starts_with(&self.known);
        complete.clone_into(&mut self.known);
        let is_row = |line: &&str| !line.trim().is_empty() && !line.trim_start().starts_with('#');
        // Names of columns, and a row.
        if complete.lines().filter(is_row).nth(1).is_none() {
            return Ok(None);
        }
        let file = parse(complete, &self.path, robot, options)?;
        Ok(Some(News { file, is_again }))
    }
}
