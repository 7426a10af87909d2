//! Measurement files whose bytes Python has: read as files of these names, before those of the disk.

use std::path::PathBuf;
use std::sync::Arc;

use poecal_storage::disk::{self, PresetFiles, SystemDisk};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyString};

use crate::errors::argument;

/// Does some work with files of these contents, by their names.
pub(super) fn with_contents<'py, T>(
    contents: &Bound<'py, PyDict>,
    work: impl FnOnce(Vec<String>) -> PyResult<T>,
) -> PyResult<T> {
    let expected = "expected a dict of names of files to their contents, str or bytes, like {\"points.csv\": text}";
    let mut files = Vec::with_capacity(contents.len());
    let mut names: Vec<String> = Vec::with_capacity(contents.len());
    for (name, content) in contents {
        let name: String =
            name.extract().map_err(|_| argument("contents", format!("found a name that is no text, {expected}")))?;
        let bytes = if let Ok(text) = content.cast::<PyString>() {
            text.to_string().into_bytes()
        } else if let Ok(bytes) = content.cast::<PyBytes>() {
            bytes.as_bytes().to_vec()
        } else {
            let found = content.get_type().name()?;
            return Err(argument("contents", format!("found a {found} for `{name}`, {expected}")));
        };
        files.push((PathBuf::from(&name), bytes));
        names.push(name);
    }
    disk::run_on_disk(Arc::new(PresetFiles::new(files, Some(Arc::new(SystemDisk)))), || work(names))
}
