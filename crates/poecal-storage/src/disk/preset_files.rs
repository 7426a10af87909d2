//! A disk for reading only: files whose bytes are supplied, and those of another disk.

use std::ffi::OsString;
use std::io::{self, Cursor, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{Disk, DiskObject, Lock, ObjectKind, Output};

/// Files by their paths, which precede those of another disk, if there is one.
pub struct PresetFiles {
    files: Vec<(PathBuf, Vec<u8>)>,
    others: Option<Arc<dyn Disk>>,
}

impl PresetFiles {
    /// A disk of these files, and of the `others`.
    #[must_use]
    pub fn new(files: Vec<(PathBuf, Vec<u8>)>, others: Option<Arc<dyn Disk>>) -> Self {
        PresetFiles { files, others }
    }

    fn file(&self, path: &Path) -> Option<&[u8]> {
        self.files.iter().find(|it| it.0 == path).map(|it| it.1.as_slice())
    }

    /// The answer for a supplied file, else that of the other disk.
    fn answer<T>(
        &self,
        path: &Path,
        own: impl FnOnce(&[u8]) -> T,
        other: impl FnOnce(&dyn Disk) -> io::Result<T>,
    ) -> io::Result<T> {
        match (self.file(path), &self.others) {
            (Some(bytes), _) => Ok(own(bytes)),
            (None, Some(disk)) => other(disk.as_ref()),
            (None, None) => Err(ErrorKind::NotFound.into()),
        }
    }
}

/// Object of a supplied file.
const FILE: DiskObject = DiskObject { kind: ObjectKind::File, identity: None, is_mine: true };

fn refuse_change<T>() -> io::Result<T> {
    Err(ErrorKind::Unsupported.into())
}

impl Disk for PresetFiles {
    fn look(&self, path: &Path) -> io::Result<DiskObject> {
        self.answer(path, |_| FILE, |disk| disk.look(path))
    }

    fn follow(&self, path: &Path) -> io::Result<DiskObject> {
        self.answer(path, |_| FILE, |disk| disk.follow(path))
    }

    fn canonical_path(&self, path: &Path) -> io::Result<PathBuf> {
        self.answer(path, |_| path.to_owned(), |disk| disk.canonical_path(path))
    }

    fn names(&self, folder: &Path) -> io::Result<Vec<OsString>> {
        match &self.others {
            Some(disk) => disk.names(folder),
            None => Ok(self.files.iter().map(|it| it.0.clone().into_os_string()).collect()),
        }
    }

    fn open(&self, path: &Path) -> io::Result<Box<dyn Read + Send>> {
        let own = |bytes: &[u8]| Box::new(Cursor::new(bytes.to_vec())) as Box<dyn Read + Send>;
        self.answer(path, own, |disk| disk.open(path))
    }

    fn standard_input(&self) -> io::Result<Box<dyn Read + Send>> {
        refuse_change()
    }

    fn create(&self, _: &Path) -> io::Result<Box<dyn Output>> {
        refuse_change()
    }

    fn append(&self, _: &Path) -> io::Result<Box<dyn Output>> {
        refuse_change()
    }

    fn stream(&self, _: &Path) -> io::Result<Box<dyn Output>> {
        refuse_change()
    }

    fn create_folder(&self, _: &Path) -> io::Result<()> {
        refuse_change()
    }

    fn remove_file(&self, _: &Path) -> io::Result<()> {
        refuse_change()
    }

    fn remove_folder(&self, _: &Path) -> io::Result<()> {
        refuse_change()
    }

    fn rename(&self, _: &Path, _: &Path) -> io::Result<()> {
        refuse_change()
    }

    fn rename_new(&self, _: &Path, _: &Path) -> io::Result<()> {
        refuse_change()
    }

    fn exchange(&self, _: &Path, _: &Path) -> io::Result<()> {
        refuse_change()
    }

    fn link(&self, _: &Path, _: &Path) -> io::Result<()> {
        refuse_change()
    }

    fn copy_access(&self, _: &Path, _: &Path) -> io::Result<()> {
        refuse_change()
    }

    fn sync_folder(&self, _: &Path) -> io::Result<()> {
        refuse_change()
    }

    fn lock(&self, _: &Path) -> io::Result<Option<Lock>> {
        refuse_change()
    }

    fn lock_folder(&self, _: &Path) -> io::Result<Lock> {
        refuse_change()
    }
}
