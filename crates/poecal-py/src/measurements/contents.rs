//! Measurement files whose bytes Python has: read as files of these names, before those of the disk.

use std::ffi::OsString;
use std::io::{self, Cursor, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use poecal_storage::disk::{self, Disk, Lock, Object, ObjectKind, Output, SystemDisk};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyString};

use crate::errors::argument;

/// Files by their names, with their bytes.
struct Given(Vec<(PathBuf, Vec<u8>)>);

impl Given {
    fn file(&self, path: &Path) -> Option<&[u8]> {
        self.0.iter().find(|it| it.0 == path).map(|it| it.1.as_slice())
    }

    fn object(&self, path: &Path) -> Option<Object> {
        self.file(path).map(|_| Object { kind: ObjectKind::File, identity: None, is_mine: true })
    }
}

/// Only files are read with this disk.
fn refused<T>() -> io::Result<T> {
    Err(ErrorKind::Unsupported.into())
}

impl Disk for Given {
    fn look(&self, path: &Path) -> io::Result<Object> {
        self.object(path).map_or_else(|| SystemDisk.look(path), Ok)
    }

    fn follow(&self, path: &Path) -> io::Result<Object> {
        self.object(path).map_or_else(|| SystemDisk.follow(path), Ok)
    }

    fn actual(&self, path: &Path) -> io::Result<PathBuf> {
        if self.file(path).is_some() { Ok(path.to_owned()) } else { SystemDisk.actual(path) }
    }

    fn names(&self, folder: &Path) -> io::Result<Vec<OsString>> {
        SystemDisk.names(folder)
    }

    fn open(&self, path: &Path) -> io::Result<Box<dyn Read + Send>> {
        match self.file(path) {
            Some(bytes) => Ok(Box::new(Cursor::new(bytes.to_vec()))),
            None => SystemDisk.open(path),
        }
    }

    fn standard_input(&self) -> io::Result<Box<dyn Read + Send>> {
        refused()
    }

    fn create(&self, _: &Path) -> io::Result<Box<dyn Output>> {
        refused()
    }

    fn append(&self, _: &Path) -> io::Result<Box<dyn Output>> {
        refused()
    }

    fn stream(&self, _: &Path) -> io::Result<Box<dyn Output>> {
        refused()
    }

    fn create_folder(&self, _: &Path) -> io::Result<()> {
        refused()
    }

    fn remove_file(&self, _: &Path) -> io::Result<()> {
        refused()
    }

    fn remove_folder(&self, _: &Path) -> io::Result<()> {
        refused()
    }

    fn rename(&self, _: &Path, _: &Path) -> io::Result<()> {
        refused()
    }

    fn rename_new(&self, _: &Path, _: &Path) -> io::Result<()> {
        refused()
    }

    fn exchange(&self, _: &Path, _: &Path) -> io::Result<()> {
        refused()
    }

    fn link(&self, _: &Path, _: &Path) -> io::Result<()> {
        refused()
    }

    fn copy_access(&self, _: &Path, _: &Path) -> io::Result<()> {
        refused()
    }

    fn sync_folder(&self, _: &Path) -> io::Result<()> {
        refused()
    }

    fn lock(&self, _: &Path) -> io::Result<Option<Lock>> {
        refused()
    }

    fn lock_folder(&self, _: &Path) -> io::Result<Lock> {
        refused()
    }
}

/// Does some work with files of these contents, by their names.
pub(super) fn with_contents<'py, T>(
    contents: &Bound<'py, PyDict>,
    work: impl FnOnce(Vec<String>) -> PyResult<T>,
) -> PyResult<T> {
    let expected =
        "expected a dict of names of files to their contents, str or bytes, like {\"points.csv\": text}";
    let mut files = Vec::with_capacity(contents.len());
    let mut names: Vec<String> = Vec::with_capacity(contents.len());
    for (name, content) in contents {
        let name: String = name
            .extract()
            .map_err(|_| argument("contents", format!("found a name that is no text, {expected}")))?;
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
    disk::on(Arc::new(Given(files)), || work(names))
}
