//! File operations behind one small trait, so that whole commands can run on a simulated disk.
//!
//! [`SystemDisk`] is the machine's. [`run_on_disk`] replaces it for the work of one thread; `tests/it/simulated_disk` has one with short writes, no space,
//! and loss of unsynced data.
//!
//! [`Disk`] has some twenty operations of one step each. [`current_disk`] is the disk of the thread: the machine's, unless [`run_on_disk`] names another; in
//! WebAssembly a disk in memory (`crates/poecal-wasm`). It is not an argument of the public functions because only WebAssembly and tests need
//! another disk.

mod preset_files;
mod system;

use std::any::Any;
use std::cell::RefCell;
use std::ffi::OsString;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub use preset_files::PresetFiles;
pub use system::SystemDisk;

/// Kind of a path's object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ObjectKind {
    /// A regular file.
    File,
    /// A folder.
    Folder,
    /// A symbolic link.
    Link,
    /// A device, a pipe or a socket.
    Other,
}

/// Object at a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DiskObject {
    /// Kind of the object.
    pub kind: ObjectKind,
    /// Device and file number, the same for every path to the file; `None` if the system has none.
    pub identity: Option<(u64, u64)>,
    /// True if it belongs to the user of this process, or if files have no owners.
    pub is_mine: bool,
}

/// Holds a lock until it is dropped.
pub type Lock = Box<dyn Any + Send>;

/// Result of a request for a lock.
pub enum LockOutcome {
    /// It is held until dropped. `before` names a run that held it and was killed.
    Mine {
        /// The lock.
        lock: Lock,
        /// Name of the earlier holder.
        before: Option<String>,
    },
    /// Another run holds it: its name, or empty if the system does not let others read it.
    Other(String),
}

/// A file being written.
pub trait Output: Write + Send {
    /// Waits until the written bytes are on the disk.
    ///
    /// # Errors
    /// Errors of the system.
    fn sync(&mut self) -> io::Result<()>;
}

/// Atomic operations on files.
///
/// # Errors
/// Each returns the system's error.
#[expect(clippy::missing_errors_doc, reason = "said once, above")]
pub trait Disk: Send + Sync {
    /// The object at a path; a link itself.
    fn look(&self, path: &Path) -> io::Result<DiskObject>;
    /// The object to which a path leads.
    fn follow(&self, path: &Path) -> io::Result<DiskObject>;
    /// Path without links.
    fn canonical_path(&self, path: &Path) -> io::Result<PathBuf>;
    /// Names in a folder, sorted.
    fn names(&self, folder: &Path) -> io::Result<Vec<OsString>>;
    /// Opens a file for reading.
    fn open(&self, path: &Path) -> io::Result<Box<dyn Read + Send>>;
    /// Standard input, once: then [`io::ErrorKind::ResourceBusy`].
    fn standard_input(&self) -> io::Result<Box<dyn Read + Send>>;
    /// Creates a new file.
    fn create(&self, path: &Path) -> io::Result<Box<dyn Output>>;
    /// Opens a file for writing at its end, creating it if necessary.
    fn append(&self, path: &Path) -> io::Result<Box<dyn Output>>;
    /// Opens a device or pipe for writing.
    fn stream(&self, path: &Path) -> io::Result<Box<dyn Output>>;
    /// Creates a new folder.
    fn create_folder(&self, path: &Path) -> io::Result<()>;
    /// Removes a file or a link.
    fn remove_file(&self, path: &Path) -> io::Result<()>;
    /// Removes an empty folder.
    fn remove_folder(&self, path: &Path) -> io::Result<()>;
    /// Moves a file, replacing another one.
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()>;
    /// Moves a file or folder without replacing another one.
    fn rename_new(&self, from: &Path, to: &Path) -> io::Result<()>;
    /// Exchanges two folders atomically; [`io::ErrorKind::Unsupported`] if the system cannot.
    fn exchange(&self, one: &Path, other: &Path) -> io::Result<()>;
    /// Adds a second name of a file (hard link).
    fn link(&self, from: &Path, to: &Path) -> io::Result<()>;
    /// Copies owner and permissions of a folder to another one; [`io::ErrorKind::Unsupported`] if that is impossible.
    fn copy_access(&self, from: &Path, to: &Path) -> io::Result<()>;
    /// Waits until a folder's names are on the disk.
    fn sync_folder(&self, path: &Path) -> io::Result<()>;
    /// Locks a file, creating it if necessary; `None` if another process holds it. [`io::ErrorKind::Unsupported`] without locks.
    fn lock(&self, path: &Path) -> io::Result<Option<Lock>>;
    /// Locks an existing file for this run alone, which `holder` names in a line. The file is removed when the lock is dropped.
    /// [`io::ErrorKind::Unsupported`] without locks. A disk of one process needs none.
    fn hold(&self, path: &Path, holder: &str) -> io::Result<LockOutcome> {
        let _ = (path, holder);
        Ok(LockOutcome::Mine { lock: Box::new(()), before: None })
    }
    /// Locks a folder, waiting some seconds for another holder; returns without a lock if the disk has none.
    fn lock_folder(&self, path: &Path) -> io::Result<Lock>;
}

thread_local! {
    static HERE: RefCell<Arc<dyn Disk>> = RefCell::new(Arc::new(SystemDisk));
}

/// Disk of this thread.
#[must_use]
pub fn current_disk() -> Arc<dyn Disk> {
    HERE.with_borrow(Arc::clone)
}

/// True if a path leads to a regular file.
#[must_use]
pub fn is_file(path: &Path) -> bool {
    current_disk().follow(path).is_ok_and(|object| object.kind == ObjectKind::File)
}

/// Creates a folder with all missing folders above it.
///
/// # Errors
/// Errors of the system.
pub fn create_folders(path: &Path) -> io::Result<()> {
    let disk = current_disk();
    if path.as_os_str().is_empty() || disk.follow(path).is_ok_and(|found| found.kind == ObjectKind::Folder) {
        return Ok(());
    }
    if let Some(parent) = path.parent() {
        create_folders(parent)?;
    }
    match disk.create_folder(path) {
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Ok(()),
        done => done,
    }
}

/// Runs `work` on another disk, on this thread only.
pub fn run_on_disk<T>(disk: Arc<dyn Disk>, work: impl FnOnce() -> T) -> T {
    /// Restores the previous disk, also after a panic.
    struct DiskGuard(Option<Arc<dyn Disk>>);
    impl Drop for DiskGuard {
        fn drop(&mut self) {
            if let Some(disk) = self.0.take() {
                HERE.replace(disk);
            }
        }
    }
    let _back = DiskGuard(Some(HERE.replace(disk)));
    work()
}
