//! Locks of files and folders to which only one run at a time writes: a ledger, a history, a folder of results.
//!
//! A lock is a file beside that path, which the system locks and which names its holder. The lock of a killed run is taken over. Without locks in
//! the file system, or if nothing can be written beside the path, there is none.

use std::cell::Cell;
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::disk::{self, Disk as _, Lock, LockOutcome};
use poecal_numerics::error::{ErrorKind, Result};

/// Time between attempts.
const PAUSE: Duration = Duration::from_millis(20);
/// End of the names of such files.
const ENDING: &str = ".poecal-lock";

thread_local! {
    static PATIENCE: Cell<Duration> = const { Cell::new(Duration::ZERO) };
}

/// Files of the locks of this process.
static LIVE: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn live() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    LIVE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A path to which no other run writes until this is dropped.
pub struct ReservedPlace {
    /// Dropped before the path is removed from the list.
    lock: Option<Lock>,
    path: PathBuf,
}

impl Drop for ReservedPlace {
    fn drop(&mut self) {
        drop(self.lock.take());
        live().remove(&self.path);
    }
}

/// Removes the files of all locks of this process: for a program that is about to end.
pub fn give_back_all() {
    for path in live().iter() {
        let _ = disk::SystemDisk.remove_file(path);
    }
}

/// Time to wait for locks of other runs, on this thread.
#[must_use]
pub fn patience() -> Duration {
    PATIENCE.get()
}

/// Runs `work` with this time to wait for locks of other runs, on this thread only.
pub fn run_with_patience<T>(patience: Duration, work: impl FnOnce() -> T) -> T {
    let before = PATIENCE.replace(patience);
    let done = work();
    PATIENCE.set(before);
    done
}

/// The lock file of a path, beside it.
#[must_use]
pub fn lock_of(place: &Path) -> PathBuf {
    let mut name = OsString::from(".");
    name.push(place.file_name().unwrap_or_default());
    name.push(ENDING);
    place.with_file_name(name)
}

/// Locks a path for this run, which `what` names with an article; `None` if there are no locks. Waits up to the patience for another run, and
/// reports whose lock it took over.
///
/// # Errors
/// [`ErrorKind::File`] if another run holds it, with the name of this run.
pub fn hold(
    place: &Path,
    what: &str,
    patience: Duration,
    say: &mut dyn FnMut(String),
) -> Result<Option<ReservedPlace>> {
    let (disk, path, holder) = (disk::current_disk(), lock_of(place), holder());
    if place.file_name().is_none() {
        return Ok(None);
    }
    let mut end = None;
    loop {
        let other = match disk.hold(&path, &holder) {
            Ok(LockOutcome::Mine { lock, before }) => {
                live().insert(path.clone());
                if let Some(before) = before {
                    say(format!("took over the lock of {what}: {before} was killed"));
                }
                return Ok(Some(ReservedPlace { lock: Some(lock), path }));
            }
            Ok(LockOutcome::Other(other)) => other,
            Err(error) if is_nowhere(&error) => return Ok(None),
            Err(error) => {
                let message = format!("the lock of {what} cannot be taken ({error})");
                return Err(ErrorKind::File.error(message).in_file(&path));
            }
        };
        // Some systems have no clock: it is read only if there is time to wait.
        if !patience.is_zero() {
            let end = *end.get_or_insert_with(|| Instant::now().checked_add(patience));
            if end.is_none_or(|end| Instant::now() < end) {
                std::thread::sleep(PAUSE);
                continue;
            }
        }
        let other = if other.is_empty() { "another run".to_owned() } else { other };
        let message =
            format!("found {what} in use by {other}, expected one run at a time: wait for it, as by --wait 60s");
        return Err(ErrorKind::File.error(message).in_file(place));
    }
}

/// True if a lock is impossible, which does not prevent the work.
fn is_nowhere(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::Unsupported
            | io::ErrorKind::PermissionDenied
            | io::ErrorKind::ReadOnlyFilesystem
            | io::ErrorKind::NotFound
            | io::ErrorKind::NotADirectory
            | io::ErrorKind::StorageFull
            | io::ErrorKind::QuotaExceeded
    )
}

/// Name of this run, for others.
fn holder() -> String {
    let process = if cfg!(target_family = "wasm") { 0 } else { std::process::id() };
    let host = std::env::var("HOSTNAME").or_else(|_| std::env::var("COMPUTERNAME")).unwrap_or_default();
    let host: String = host.chars().filter(|it| it.is_ascii_graphic()).take(64).collect();
    let at = if host.is_empty() { String::new() } else { format!(" on {host}") };
    format!("process {process}{at}")
}
