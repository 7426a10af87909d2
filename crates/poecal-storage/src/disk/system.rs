//! The machine's own disk.

use std::ffi::OsString;
use std::fs::{self, File, Metadata, OpenOptions, TryLockError};
use std::io::{self, Read, Seek as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
#[cfg(unix)]
use std::time::{Duration, Instant};

use super::{Disk, DiskObject, Lock, LockOutcome, ObjectKind, Output};

/// The machine's disk.
#[derive(Clone, Copy, Debug, Default)]
pub struct SystemDisk;

impl Output for File {
    fn sync(&mut self) -> io::Result<()> {
        self.sync_all()
    }
}

/// Standard output and error: there is nothing to sync.
struct StandardStream<W>(W);

impl<W: io::Write> io::Write for StandardStream<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

impl<W: io::Write + Send> Output for StandardStream<W> {
    fn sync(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

fn object_kind(metadata: &Metadata) -> DiskObject {
    let kind = match metadata.file_type() {
        kind if kind.is_file() => ObjectKind::File,
        kind if kind.is_dir() => ObjectKind::Folder,
        kind if kind.is_symlink() => ObjectKind::Link,
        _ => ObjectKind::Other,
    };
    #[cfg(unix)]
    let (identity, is_mine) = {
        use std::os::unix::fs::MetadataExt as _;
        (Some((metadata.dev(), metadata.ino())), metadata.uid() == rustix::process::geteuid().as_raw())
    };
    #[cfg(not(unix))]
    let (identity, is_mine) = (None, true);
    DiskObject { kind, identity, is_mine }
}

/// Time to wait for a folder's lock, and between attempts. Other runs hold it for less.
#[cfg(unix)]
const PATIENCE: Duration = Duration::from_secs(20);
#[cfg(unix)]
const PAUSE: Duration = Duration::from_millis(2);

/// True if the file system does not support the operation.
#[cfg(unix)]
fn is_unknown(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported)
}

/// True if the file system has no locks.
fn has_no_locks(error: &io::Error) -> bool {
    #[cfg(unix)]
    if error.raw_os_error() == Some(rustix::io::Errno::NOLCK.raw_os_error()) {
        return true;
    }
    error.kind() == io::ErrorKind::Unsupported
}

/// Extended attributes with their values, such as access lists and labels.
#[cfg(any(target_os = "linux", target_os = "android", target_vendor = "apple"))]
fn attributes(path: &Path) -> io::Result<Vec<(Vec<u8>, Vec<u8>)>> {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt as _;
    const LARGEST: usize = 1 << 16;
    let mut names = vec![0; LARGEST];
    let length = match rustix::fs::listxattr(path, &mut names[..]).map_err(io::Error::from) {
        Err(error) if is_unknown(&error) => 0,
        listed => listed?,
    };
    let names = names.get(..length).unwrap_or_default().split(|byte| *byte == 0).filter(|name| !name.is_empty());
    let valued = names.map(|name| {
        let mut value = vec![0; LARGEST];
        let length = rustix::fs::getxattr(path, OsStr::from_bytes(name), &mut value[..])?;
        value.truncate(length);
        Ok((name.to_vec(), value))
    });
    let mut valued = valued.collect::<io::Result<Vec<_>>>()?;
    valued.sort();
    Ok(valued)
}

/// Rename without replacement on systems without such a call: a hard link, or a folder rename, which replaces only an empty folder.
fn rename_new_in_steps(from: &Path, to: &Path) -> io::Result<()> {
    if fs::symlink_metadata(from)?.is_dir() {
        return fs::rename(from, to);
    }
    fs::hard_link(from, to)?;
    fs::remove_file(from)
}

/// Exchanges two files or folders, or moves one to a free path, in one step; [`io::ErrorKind::Unsupported`] if the system cannot.
#[cfg(any(target_os = "linux", target_os = "android", target_vendor = "apple"))]
fn rename_in_one_step(from: &Path, to: &Path, is_exchange: bool) -> io::Result<()> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    let flags = if is_exchange { RenameFlags::EXCHANGE } else { RenameFlags::NOREPLACE };
    renameat_with(CWD, from, CWD, to, flags).map_err(|error| {
        let error = io::Error::from(error);
        if is_unknown(&error) { io::ErrorKind::Unsupported.into() } else { error }
    })
}

#[cfg(not(any(target_os = "linux", target_os = "android", target_vendor = "apple")))]
fn rename_in_one_step(_: &Path, _: &Path, _: bool) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

/// A file that is locked, and removed before the lock is released.
struct LockedFile {
    file: File,
    path: PathBuf,
}

impl Drop for LockedFile {
    fn drop(&mut self) {
        // If an open file cannot be removed, it is emptied: an empty file means no killed run.
        let _ = self.file.set_len(0);
        if is_at(&self.file, &self.path) {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// True if an open file is the one at a path.
fn is_at(file: &File, path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt as _;
        let (own, there) = (file.metadata(), fs::symlink_metadata(path));
        own.and_then(|own| Ok((own, there?)))
            .is_ok_and(|(own, there)| (own.dev(), own.ino()) == (there.dev(), there.ino()))
    }
    #[cfg(not(unix))]
    {
        let _ = file;
        path.exists()
    }
}

/// Largest number of attempts to lock a file that others remove, and largest length of a holder's name, bytes.
const ATTEMPTS: usize = 100;
const LONGEST_HOLDER: u64 = 500;

impl Disk for SystemDisk {
    fn look(&self, path: &Path) -> io::Result<DiskObject> {
        fs::symlink_metadata(path).map(|metadata| object_kind(&metadata))
    }

    fn follow(&self, path: &Path) -> io::Result<DiskObject> {
        fs::metadata(path).map(|metadata| object_kind(&metadata))
    }

    fn canonical_path(&self, path: &Path) -> io::Result<PathBuf> {
        fs::canonicalize(path)
    }

    fn names(&self, folder: &Path) -> io::Result<Vec<OsString>> {
        let mut names: Vec<OsString> =
            fs::read_dir(folder)?.map(|entry| entry.map(|entry| entry.file_name())).collect::<Result<_, _>>()?;
        names.sort();
        Ok(names)
    }

    fn open(&self, path: &Path) -> io::Result<Box<dyn Read + Send>> {
        Ok(Box::new(File::open(path)?))
    }

    fn standard_input(&self) -> io::Result<Box<dyn Read + Send>> {
        static TAKEN: AtomicBool = AtomicBool::new(false);
        if TAKEN.swap(true, Ordering::Relaxed) {
            return Err(io::Error::new(io::ErrorKind::ResourceBusy, "standard input is read already"));
        }
        Ok(Box::new(io::stdin()))
    }

    fn create(&self, path: &Path) -> io::Result<Box<dyn Output>> {
        Ok(Box::new(File::create_new(path)?))
    }

    fn append(&self, path: &Path) -> io::Result<Box<dyn Output>> {
        Ok(Box::new(OpenOptions::new().append(true).create(true).open(path)?))
    }

    fn stream(&self, path: &Path) -> io::Result<Box<dyn Output>> {
        // Reopening the file of standard output would overwrite it from its beginning.
        if ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"].iter().any(|name| path == Path::new(name)) {
            return Ok(Box::new(StandardStream(io::stdout())));
        }
        if ["/dev/stderr", "/dev/fd/2", "/proc/self/fd/2"].iter().any(|name| path == Path::new(name)) {
            return Ok(Box::new(StandardStream(io::stderr())));
        }
        Ok(Box::new(StandardStream(OpenOptions::new().append(true).open(path)?)))
    }

    fn create_folder(&self, path: &Path) -> io::Result<()> {
        fs::create_dir(path)
    }

    fn remove_file(&self, path: &Path) -> io::Result<()> {
        fs::remove_file(path)
    }

    fn remove_folder(&self, path: &Path) -> io::Result<()> {
        fs::remove_dir(path)
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        fs::rename(from, to)
    }

    fn rename_new(&self, from: &Path, to: &Path) -> io::Result<()> {
        match rename_in_one_step(from, to, false) {
            Err(error) if error.kind() == io::ErrorKind::Unsupported => rename_new_in_steps(from, to),
            done => done,
        }
    }

    fn exchange(&self, one: &Path, other: &Path) -> io::Result<()> {
        rename_in_one_step(one, other, true)
    }

    fn link(&self, from: &Path, to: &Path) -> io::Result<()> {
        fs::hard_link(from, to)
    }

    #[cfg(unix)]
    fn copy_access(&self, from: &Path, to: &Path) -> io::Result<()> {
        use std::os::unix::fs::{MetadataExt as _, chown};
        #[cfg(any(target_os = "linux", target_os = "android", target_vendor = "apple"))]
        {
            // Access lists and labels would be lost.
            if attributes(from)? != attributes(to)? {
                return Err(io::ErrorKind::Unsupported.into());
            }
        }
        let (wanted, has) = (fs::metadata(from)?, fs::metadata(to)?);
        if (wanted.uid(), wanted.gid()) != (has.uid(), has.gid()) {
            chown(to, Some(wanted.uid()), Some(wanted.gid()))?;
        }
        if wanted.permissions() != has.permissions() {
            fs::set_permissions(to, wanted.permissions())?;
        }
        Ok(())
    }

    #[cfg(not(unix))]
    fn copy_access(&self, _: &Path, _: &Path) -> io::Result<()> {
        Err(io::ErrorKind::Unsupported.into())
    }

    #[cfg(unix)]
    fn sync_folder(&self, path: &Path) -> io::Result<()> {
        match File::open(path)?.sync_all() {
            // Some file systems cannot sync a folder.
            Err(error) if is_unknown(&error) => Ok(()),
            synced => synced,
        }
    }

    #[cfg(not(unix))]
    fn sync_folder(&self, _: &Path) -> io::Result<()> {
        Ok(())
    }

    fn lock(&self, path: &Path) -> io::Result<Option<Lock>> {
        let file = OpenOptions::new().create(true).append(true).open(path)?;
        match file.try_lock() {
            Ok(()) => Ok(Some(Box::new(file))),
            Err(TryLockError::WouldBlock) => Ok(None),
            Err(TryLockError::Error(error)) if has_no_locks(&error) => Err(io::ErrorKind::Unsupported.into()),
            Err(TryLockError::Error(error)) => Err(error),
        }
    }

    fn hold(&self, path: &Path, holder: &str) -> io::Result<LockOutcome> {
        for _ in 0..ATTEMPTS {
            let mut file = OpenOptions::new().create(true).truncate(false).read(true).write(true).open(path)?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    let mut other = String::new();
                    let _ = file.take(LONGEST_HOLDER).read_to_string(&mut other);
                    return Ok(LockOutcome::Other(other.trim().to_owned()));
                }
                Err(TryLockError::Error(error)) if has_no_locks(&error) => {
                    return Err(io::ErrorKind::Unsupported.into());
                }
                Err(TryLockError::Error(error)) => return Err(error),
            }
            // Its holder may have removed it in the meantime.
            if !is_at(&file, path) {
                continue;
            }
            let mut before = String::new();
            let _ = Read::by_ref(&mut file).take(LONGEST_HOLDER).read_to_string(&mut before);
            file.set_len(0)?;
            file.rewind()?;
            file.write_all(holder.as_bytes())?;
            let before = Some(before.trim().to_owned()).filter(|it| !it.is_empty());
            return Ok(LockOutcome::Mine { lock: Box::new(LockedFile { file, path: path.to_owned() }), before });
        }
        Ok(LockOutcome::Other(String::new()))
    }

    #[cfg(unix)]
    fn lock_folder(&self, path: &Path) -> io::Result<Lock> {
        let folder = File::open(path)?;
        let end = Instant::now() + PATIENCE;
        loop {
            match folder.try_lock() {
                Ok(()) => return Ok(Box::new(folder)),
                Err(TryLockError::Error(error)) if has_no_locks(&error) => return Ok(Box::new(folder)),
                Err(TryLockError::Error(error)) => return Err(error),
                Err(TryLockError::WouldBlock) if Instant::now() > end => {
                    let message = "another program holds a lock on the folder";
                    return Err(io::Error::new(io::ErrorKind::TimedOut, message));
                }
                Err(TryLockError::WouldBlock) => std::thread::sleep(PAUSE),
            }
        }
    }

    #[cfg(not(unix))]
    fn lock_folder(&self, _: &Path) -> io::Result<Lock> {
        Ok(Box::new(()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_names_its_holder_and_is_taken_over_of_a_run_that_was_killed() {
        let path = std::env::temp_dir().join(format!("poecal_lock_{}", std::process::id()));
        let hold = |holder: &str| SystemDisk.hold(&path, holder).unwrap();
        let LockOutcome::Mine { lock, before: None } = hold("first") else { panic!("held by another") };
        assert!(matches!(hold("second"), LockOutcome::Other(name) if name == "first"));
        drop(lock);
        assert!(!path.exists());
        // A killed run leaves its name behind.
        fs::write(&path, "killed").unwrap();
        let LockOutcome::Mine { lock, before } = hold("third") else { panic!("held by another") };
        assert_eq!(before.as_deref(), Some("killed"));
        assert_eq!(fs::read_to_string(&path).unwrap(), "third");
        drop(lock);
        assert!(!path.exists());
    }

    #[test]
    fn files_are_made_moved_and_removed() {
        let folder = std::env::temp_dir().join(format!("poecal_system_disk_{}", std::process::id()));
        let (one, two) = (folder.join("one"), folder.join("two"));
        SystemDisk.create_folder(&folder).unwrap();
        assert_eq!(SystemDisk.look(&folder).unwrap().kind, ObjectKind::Folder);
        let mut file = SystemDisk.create(&one).unwrap();
        file.write_all(b"text").unwrap();
        file.sync().unwrap();
        drop(file);
        SystemDisk.rename_new(&one, &two).unwrap();
        assert_eq!(SystemDisk.look(&one).unwrap_err().kind(), io::ErrorKind::NotFound);
        assert_eq!(SystemDisk.look(&two).unwrap().kind, ObjectKind::File);
        assert_eq!(SystemDisk.names(&folder).unwrap(), ["two"]);
        SystemDisk.remove_file(&two).unwrap();
        SystemDisk.remove_folder(&folder).unwrap();
        assert!(!folder.exists());
    }
}
