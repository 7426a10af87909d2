//! A disk in memory.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use poecal_storage::disk::{Disk, DiskObject, Lock, ObjectKind, Output};

use crate::names::{PathEntry, PathNames, whole_path};

#[derive(Debug)]
struct DiskState {
    names: PathNames,
    /// The bytes of each file that ever existed; empty for one without a name.
    files: Vec<Arc<Vec<u8>>>,
    /// The files that were put here, by their paths and numbers.
    put: BTreeMap<PathBuf, usize>,
    locks: BTreeSet<PathBuf>,
    input: Option<Vec<u8>>,
}

/// Folders and files in memory; the current folder is the root. Clones are the same disk. Written data are there at once, so that there is nothing to
/// sync, and errors are those of a system.
#[derive(Clone, Debug)]
pub struct MemoryDisk(Arc<Mutex<DiskState>>);

/// A file being read: its bytes when it was opened.
struct MemoryReader {
    bytes: Arc<Vec<u8>>,
    at: usize,
}

impl Read for MemoryReader {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let count = into.len().min(rest.len());
        into[..count].copy_from_slice(&rest[..count]);
        self.at += count;
        Ok(count)
    }
}

/// A file being written.
struct MemoryWriter {
    disk: MemoryDisk,
    number: usize,
}

impl Write for MemoryWriter {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.disk.append(self.number, bytes)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Output for MemoryWriter {
    fn sync(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A lock, until it is dropped.
struct MemoryLock(MemoryDisk, PathBuf);

impl Drop for MemoryLock {
    fn drop(&mut self) {
        self.0.state().locks.remove(&self.1);
    }
}

impl MemoryDisk {
    /// An empty disk, with this standard input.
    #[must_use]
    pub fn new(input: Vec<u8>) -> Self {
        MemoryDisk(Arc::new(Mutex::new(DiskState {
            names: PathNames::new(),
            files: Vec::new(),
            put: BTreeMap::new(),
            locks: BTreeSet::new(),
            input: Some(input),
        })))
    }

    fn state(&self) -> MutexGuard<'_, DiskState> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Puts a file here, with the folders of its path; a folder if its path ends in `/`.
    ///
    /// # Errors
    /// [`ErrorKind::AlreadyExists`] if something is at its path, [`ErrorKind::NotADirectory`] if a file is within its path.
    pub fn put(&self, path: &Path, bytes: Vec<u8>) -> io::Result<()> {
        let is_folder = path.as_os_str().as_encoded_bytes().ends_with(b"/");
        let path = whole_path(path);
        let mut state = self.state();
        let mut folders: Vec<&Path> = path.ancestors().skip(usize::from(!is_folder)).collect();
        folders.reverse();
        for folder in folders {
            match state.names.entry_at(folder) {
                Err(error) if error.kind() == ErrorKind::NotFound => {
                    state.names.add(folder.to_owned(), PathEntry::Folder)?
                }
                _ => state.names.folder(folder)?,
            }
        }
        if !is_folder {
            let number = state.files.len();
            state.names.add(path.clone(), PathEntry::File(number))?;
            state.files.push(Arc::new(bytes));
            state.put.insert(path, number);
        }
        Ok(())
    }

    /// Files that differ from those put here, new or replaced, by paths from the root, and removed ones.
    #[must_use]
    pub fn changes(&self) -> (BTreeMap<String, Vec<u8>>, Vec<String>) {
        let state = self.state();
        let named = |path: &Path| path.strip_prefix("/").unwrap_or(path).to_string_lossy().into_owned();
        let mut written = BTreeMap::new();
        for (path, node) in state.names.all() {
            if let PathEntry::File(number) = node
                && state.put.get(path) != Some(&number)
                && let Some(bytes) = state.files.get(number)
            {
                written.insert(named(path), bytes.as_ref().clone());
            }
        }
        let gone = state.put.keys().filter(|path| state.names.file(path).is_err());
        (written, gone.map(|path| named(path)).collect())
    }

    /// Writes at the end of a file.
    fn append(&self, number: usize, bytes: &[u8]) -> io::Result<()> {
        let mut state = self.state();
        let file = state.files.get_mut(number).ok_or(ErrorKind::NotFound)?;
        Arc::make_mut(file).extend_from_slice(bytes);
        Ok(())
    }
}

impl Disk for MemoryDisk {
    fn look(&self, path: &Path) -> io::Result<DiskObject> {
        let node = self.state().names.entry_at(&whole_path(path))?;
        let (kind, identity) = match node {
            PathEntry::Folder => (ObjectKind::Folder, None),
            PathEntry::File(number) => (ObjectKind::File, Some((0, number as u64))),
        };
        Ok(DiskObject { kind, identity, is_mine: true })
    }

    fn follow(&self, path: &Path) -> io::Result<DiskObject> {
        self.look(path)
    }

    fn canonical_path(&self, path: &Path) -> io::Result<PathBuf> {
        self.look(path).map(|_| whole_path(path))
    }

    fn names(&self, folder: &Path) -> io::Result<Vec<OsString>> {
        let (state, folder) = (self.state(), whole_path(folder));
        state.names.folder(&folder)?;
        let children = state.names.children(&folder);
        Ok(children.iter().filter_map(|path| path.file_name()).map(OsString::from).collect())
    }

    fn open(&self, path: &Path) -> io::Result<Box<dyn Read + Send>> {
        let state = self.state();
        let number = state.names.file(&whole_path(path))?;
        let bytes = state.files.get(number).cloned().unwrap_or_default();
        Ok(Box::new(MemoryReader { bytes, at: 0 }))
    }

    fn standard_input(&self) -> io::Result<Box<dyn Read + Send>> {
        let taken = || io::Error::new(io::ErrorKind::ResourceBusy, "standard input is read already");
        let bytes = Arc::new(self.state().input.take().ok_or_else(taken)?);
        Ok(Box::new(MemoryReader { bytes, at: 0 }))
    }

    fn create(&self, path: &Path) -> io::Result<Box<dyn Output>> {
        let mut state = self.state();
        let number = state.files.len();
        state.names.add(whole_path(path), PathEntry::File(number))?;
        state.files.push(Arc::default());
        Ok(Box::new(MemoryWriter { disk: self.clone(), number }))
    }

    fn append(&self, path: &Path) -> io::Result<Box<dyn Output>> {
        let found = self.state().names.file(&whole_path(path));
        match found {
            Ok(number) => Ok(Box::new(MemoryWriter { disk: self.clone(), number })),
            Err(error) if error.kind() == ErrorKind::NotFound => self.create(path),
            Err(error) => Err(error),
        }
    }

    fn stream(&self, _: &Path) -> io::Result<Box<dyn Output>> {
        Err(ErrorKind::Unsupported.into())
    }

    fn create_folder(&self, path: &Path) -> io::Result<()> {
        self.state().names.add(whole_path(path), PathEntry::Folder)
    }

    fn remove_file(&self, path: &Path) -> io::Result<()> {
        let (mut state, path) = (self.state(), whole_path(path));
        state.names.file(&path)?;
        state.names.remove(&path);
        Ok(())
    }

    fn remove_folder(&self, path: &Path) -> io::Result<()> {
        let (mut state, path) = (self.state(), whole_path(path));
        state.names.folder(&path)?;
        if path.parent().is_none() {
            return Err(ErrorKind::ResourceBusy.into());
        }
        if !state.names.children(&path).is_empty() {
            return Err(ErrorKind::DirectoryNotEmpty.into());
        }
        state.names.remove(&path);
        Ok(())
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        self.state().names.rename(&whole_path(from), &whole_path(to), true)
    }

    fn rename_new(&self, from: &Path, to: &Path) -> io::Result<()> {
        self.state().names.rename(&whole_path(from), &whole_path(to), false)
    }

    fn exchange(&self, one: &Path, other: &Path) -> io::Result<()> {
        self.state().names.exchange(&whole_path(one), &whole_path(other))
    }

    fn link(&self, from: &Path, to: &Path) -> io::Result<()> {
        let mut state = self.state();
        let number = state.names.file(&whole_path(from))?;
        state.names.add(whole_path(to), PathEntry::File(number))
    }

    fn copy_access(&self, from: &Path, to: &Path) -> io::Result<()> {
        // The caller owns all files.
        self.look(from).and_then(|_| self.look(to)).map(|_| ())
    }

    fn sync_folder(&self, path: &Path) -> io::Result<()> {
        self.state().names.folder(&whole_path(path))
    }

    fn lock(&self, path: &Path) -> io::Result<Option<Lock>> {
        let path = whole_path(path);
        let found = self.state().names.file(&path);
        match found {
            Err(error) if error.kind() == ErrorKind::NotFound => drop(self.create(&path)?),
            found => drop(found?),
        }
        let is_free = self.state().locks.insert(path.clone());
        Ok(is_free.then(|| Box::new(MemoryLock(self.clone(), path)) as Lock))
    }

    fn lock_folder(&self, path: &Path) -> io::Result<Lock> {
        // A disk has one user, whose runs are sequential.
        self.state().names.folder(&whole_path(path))?;
        Ok(Box::new(()))
    }
}
