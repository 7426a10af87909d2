//! A disk that has a file or a few: of what is read by its path alone.

use std::ffi::OsString;
use std::io::{self, Cursor, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use poecal_storage::disk::{self, Disk, Lock, Object, ObjectKind, Output};

struct Files(Vec<(PathBuf, Vec<u8>)>);

/// What some work gives where a file of this text is at a path, and nothing else.
pub(crate) fn with_file<T>(path: &str, text: &str, work: impl FnOnce() -> T) -> T {
    with_files(&[(path, text.as_bytes())], work)
}

/// What some work gives where files of these bytes are at these paths, and nothing else.
pub(crate) fn with_files<T>(files: &[(&str, &[u8])], work: impl FnOnce() -> T) -> T {
    let files = files.iter().map(|(path, bytes)| ((*path).into(), bytes.to_vec())).collect();
    disk::on(Arc::new(Files(files)), work)
}

fn refused<T>() -> io::Result<T> {
    Err(ErrorKind::Unsupported.into())
}

impl Disk for Files {
    fn look(&self, path: &Path) -> io::Result<Object> {
        let object = Object { kind: ObjectKind::File, identity: None, is_mine: true };
        if self.0.iter().any(|it| it.0 == path) { Ok(object) } else { Err(ErrorKind::NotFound.into()) }
    }

    fn follow(&self, path: &Path) -> io::Result<Object> {
        self.look(path)
    }

    fn actual(&self, path: &Path) -> io::Result<PathBuf> {
        self.look(path).map(|_| path.to_owned())
    }

    fn names(&self, _: &Path) -> io::Result<Vec<OsString>> {
        Ok(self.0.iter().map(|it| it.0.clone().into_os_string()).collect())
    }

    fn open(&self, path: &Path) -> io::Result<Box<dyn Read + Send>> {
        let file = self.0.iter().find(|it| it.0 == path).ok_or(ErrorKind::NotFound)?;
        Ok(Box::new(Cursor::new(file.1.clone())))
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
