//! Places of output files, reserved as by the program; messages become warnings.

use std::path::Path;

use poecal_results::output::{Contents, ExistingFiles, ReservedFile, ReservedFolder};
use pyo3::prelude::*;

use crate::errors::raise;

pub(crate) fn reserved_file(
    py: Python<'_>,
    path: &Path,
    existing: ExistingFiles,
    inputs: &[&Path],
) -> PyResult<ReservedFile> {
    warn_messages(py, |say| ReservedFile::reserve(path, existing, inputs, say))
}

pub(crate) fn reserved_folder(
    py: Python<'_>,
    folder: &Path,
    contents: Contents,
    existing: ExistingFiles,
    inputs: &[&Path],
) -> PyResult<ReservedFolder> {
    warn_messages(py, |say| ReservedFolder::reserve(folder, contents, existing, inputs, say))
}

/// Result of `reserve`; its messages become warnings.
pub(crate) fn warn_messages<T>(
    py: Python<'_>,
    reserve: impl FnOnce(&mut dyn FnMut(String)) -> poecal_numerics::error::Result<T>,
) -> PyResult<T> {
    let mut notes = Vec::new();
    let place = reserve(&mut |note| notes.push(note));
    crate::warn(py, &notes)?;
    place.map_err(raise)
}
