//! Output of a reproduction.

use super::{NewFile, ReservedFolder, WrittenFiles, write_files};
use poecal_numerics::error::Result;

/// Writes a reproduction's files, each a name and a text as the crate `poecal-lou2009` makes them, completely or not at all. Figures of an earlier
/// run that are not written again are removed.
///
/// # Errors
/// [`ErrorKind::File`](poecal_numerics::error::ErrorKind::File) if something cannot be written; nothing is left behind then.
pub fn write_reproduction(place: ReservedFolder, files: &[(String, String)]) -> Result<WrittenFiles> {
    let files: Vec<NewFile> = files.iter().map(|(name, text)| NewFile::new(name, text.clone())).collect();
    write_files(place, &files, None, Vec::new())
}
