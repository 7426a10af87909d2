//! A disk that has one file: of what is read by its path alone.

use std::ffi::OsString;
use std::io::{self, Cursor, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use poecal::io::disk::{self, Disk, Lock, Object, ObjectKind, Output};

struct OneFile {
    path: PathBuf,
    bytes: Vec<u8>,
}

/// What some work gives where a file of this text is at a path, and nothing else.
pub(crate) fn with_file<T>(path: &str, text: &str, work: impl FnOnce() -> T) -> T {
    disk::on(Arc::new(OneFile { path: path.into(), bytes: text.into() }), work)
}

fn refused<T>() -> io::Result<T> {
    Err(ErrorKind::Unsupported.into())
}

impl Disk for OneFile {
    fn look(&self, path: &Path) -> io::Result<Object> {
        let object = Object { kind: ObjectKind::File, identity: None, is_mine: true };
        if path == self.path { Ok(object) } else { Err(ErrorKind::NotFound.into()) }
    }

    fn follow(&self, path: &Path) -> io::Result<Object> {
        self.look(path)
    }

    fn actual(&self, path: &Path) -> io::Result<PathBuf> {
        self.look(path).map(|_| path.to_owned())
    }

    fn names(&self, _: &Path) -> io::Result<Vec<OsString>> {
        Ok(vec![self.path.clone().into_os_string()])
    }

    fn open(&self, path: &Path) -> io::Result<Box<dyn Read + Send>> {
        self.look(path).map(|_| Box::new(Cursor::new(self.bytes.clone())) as Box<dyn Read + Send>)
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
