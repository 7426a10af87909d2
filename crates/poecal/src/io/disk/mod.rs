//! Operations on files: one small trait behind which all of them stand, so that whole commands can run on a disk that fails.
//!
//! [`SystemDisk`] is the machine's. Another takes its place for the work of one thread by [`on`]; `tests/it/simulated_disk` has one
//! that writes short, runs full and loses what was not synced.

mod system;

use std::any::Any;
use std::cell::RefCell;
use std::ffi::OsString;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub use system::SystemDisk;

/// What a path leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FoundKind {
    /// A regular file.
    File,
    /// A folder.
    Folder,
    /// A symbolic link.
    Link,
    /// A device, a pipe or a socket.
    Other,
}

/// What is found at a path.
///
/// ```
/// use poecal::io::disk::{Disk as _, FoundKind, SystemDisk};
/// let found = SystemDisk.look(std::env::temp_dir().as_path())?;
/// assert_ne!(found.kind, FoundKind::File);
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Found {
    /// What it is.
    pub kind: FoundKind,
    /// Device and number of the file, the same for every path that leads to it; none where the system has no such numbers.
    pub identity: Option<(u64, u64)>,
    /// Whether it belongs to the user who runs the program; where files have no owners, it does.
    pub is_mine: bool,
}

/// Holds a lock until it is dropped.
pub type Lock = Box<dyn Any + Send>;

/// A file that is being written.
pub trait Output: Write + Send {
    /// Waits until what was written is on the disk.
    ///
    /// # Errors
    /// Those of the system.
    fn sync(&mut self) -> io::Result<()>;
}

/// Operations on files. Each is one step: it happens or it does not.
///
/// ```
/// use poecal::io::disk::{Disk as _, SystemDisk};
/// let folder = std::env::temp_dir().join(format!("poecal_disk_{}", std::process::id()));
/// SystemDisk.create_folder(&folder)?;
/// let mut file = SystemDisk.create(&folder.join("a"))?;
/// file.write_all(b"text")?;
/// file.sync()?;
/// SystemDisk.rename_new(&folder.join("a"), &folder.join("b"))?;
/// assert_eq!(SystemDisk.names(&folder)?, ["b"]);
/// SystemDisk.remove_file(&folder.join("b"))?;
/// SystemDisk.remove_folder(&folder)?;
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// # Errors
/// Each gives the system's error.
#[expect(clippy::missing_errors_doc, reason = "said once, above")]
pub trait Disk: Send + Sync {
    /// What is at a path, a link itself included.
    fn look(&self, path: &Path) -> io::Result<Found>;
    /// What a path leads to, links followed.
    fn follow(&self, path: &Path) -> io::Result<Found>;
    /// The one path, without links, of what a path leads to.
    fn actual(&self, path: &Path) -> io::Result<PathBuf>;
    /// Names in a folder, sorted.
    fn names(&self, folder: &Path) -> io::Result<Vec<OsString>>;
    /// Opens what is there for reading.
    fn open(&self, path: &Path) -> io::Result<Box<dyn Read + Send>>;
    /// Standard input, once: [`io::ErrorKind::ResourceBusy`] afterwards.
    fn standard_input(&self) -> io::Result<Box<dyn Read + Send>>;
    /// Creates a file where nothing is.
    fn create(&self, path: &Path) -> io::Result<Box<dyn Output>>;
    /// Opens what is no regular file (a device, a pipe) for writing.
    fn stream(&self, path: &Path) -> io::Result<Box<dyn Output>>;
    /// Creates a folder where nothing is.
    fn create_folder(&self, path: &Path) -> io::Result<()>;
    /// Removes a file or a link.
    fn remove_file(&self, path: &Path) -> io::Result<()>;
    /// Removes an empty folder.
    fn remove_folder(&self, path: &Path) -> io::Result<()>;
    /// Moves a file, over one that is there.
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()>;
    /// Moves a file or folder to where nothing is.
    fn rename_new(&self, from: &Path, to: &Path) -> io::Result<()>;
    /// Exchanges two folders in one step; [`io::ErrorKind::Unsupported`] where the system cannot.
    fn exchange(&self, one: &Path, other: &Path) -> io::Result<()>;
    /// Gives a file a second name.
    fn link(&self, from: &Path, to: &Path) -> io::Result<()>;
    /// Gives a folder the owner and permissions of another one; [`io::ErrorKind::Unsupported`] if they cannot be the same.
    fn copy_access(&self, from: &Path, to: &Path) -> io::Result<()>;
    /// Waits until a folder's names are on the disk.
    fn sync_folder(&self, path: &Path) -> io::Result<()>;
    /// Locks a file, created if need be; none if somebody else holds it. [`io::ErrorKind::Unsupported`] where there are no locks.
    fn lock(&self, path: &Path) -> io::Result<Option<Lock>>;
    /// Locks a folder, and waits some seconds for whoever holds it; where there are no locks, without one.
    fn lock_folder(&self, path: &Path) -> io::Result<Lock>;
}

thread_local! {
    static HERE: RefCell<Arc<dyn Disk>> = RefCell::new(Arc::new(SystemDisk));
}

/// The disk of this thread's work.
#[must_use]
pub fn here() -> Arc<dyn Disk> {
    HERE.with_borrow(Arc::clone)
}

/// Does some work, as far as this thread does it, on another disk than the machine's.
///
/// ```
/// use std::sync::Arc;
/// use poecal::io::disk::{SystemDisk, on};
/// assert_eq!(on(Arc::new(SystemDisk), || 1 + 1), 2);
/// ```
pub fn on<T>(disk: Arc<dyn Disk>, work: impl FnOnce() -> T) -> T {
    /// Puts the disk before back, also when the work panics.
    struct Back(Option<Arc<dyn Disk>>);
    impl Drop for Back {
        fn drop(&mut self) {
            if let Some(disk) = self.0.take() {
                HERE.replace(disk);
            }
        }
    }
    let _back = Back(Some(HERE.replace(disk)));
    work()
}
