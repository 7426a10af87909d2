//! Output of a hand-eye calibration, and of a tool's tip.

use super::{NewFile, ReservedFolder, WrittenFiles, write_files};
use poecal_numerics::error::Result;

/// Writes a result's files, completely or not at all: its JSON by its name, and the texts beside it.
///
/// # Errors
/// [`ErrorKind::File`](poecal_numerics::error::ErrorKind::File) if something cannot be written. Nothing is left behind then.
pub fn write_texts(
    place: ReservedFolder,
    json: (&str, String),
    texts: Vec<(&'static str, String)>,
) -> Result<WrittenFiles> {
    let mut files = vec![NewFile::new(json.0, json.1)];
    files.extend(texts.into_iter().map(|(name, text)| NewFile::new(name, text)));
    write_files(place, &files, None, Vec::new())
}
