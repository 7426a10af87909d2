//! Locks of what one run at a time writes to: a ledger, a history, a folder of results.
//!
//! A lock is a file beside the place, which the system locks and which names its holder. That of a killed run is taken over. Where the file system has no
//! locks, or nothing can be written beside the place, there is none.

use std::cell::Cell;
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::disk::{self, Disk as _, Held, Lock};
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

/// A place that no other run writes to until this is dropped.
pub struct HeldPlace {
    /// Taken before the path is forgotten.
    lock: Option<Lock>,
    path: PathBuf,
}

impl Drop for HeldPlace {
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

/// How long locks of other runs are waited for on this thread.
#[must_use]
pub fn patience() -> Duration {
    PATIENCE.get()
}

/// Does some work in which locks of other runs are waited for so long, as far as this thread does it.
pub fn waiting<T>(patience: Duration, work: impl FnOnce() -> T) -> T {
    let before = PATIENCE.replace(patience);
    let done = work();
    PATIENCE.set(before);
    done
}

/// The file of a place's lock, beside it.
#[must_use]
pub fn lock_of(place: &Path) -> PathBuf {
    let mut name = OsString::from(".");
    name.push(place.file_name().unwrap_or_default());
    name.push(ENDING);
    place.with_file_name(name)
}

/// Locks a place for this run, which `what` names with an article; `None` where there are no locks. Waits so long for another run, and says whose lock
/// it took over.
///
/// # Errors
/// [`ErrorKind::File`] if another run holds it, with the name of that.
pub fn hold(
    place: &Path,
    what: &str,
    patience: Duration,
    say: &mut dyn FnMut(String),
) -> Result<Option<HeldPlace>> {
    let (disk, path, holder) = (disk::here(), lock_of(place), holder());
    if place.file_name().is_none() {
        return Ok(None);
    }
    let mut end = None;
    loop {
        let other = match disk.hold(&path, &holder) {
            Ok(Held::Mine { lock, before }) => {
                live().insert(path.clone());
                if let Some(before) = before {
                    say(format!("took over the lock of {what}: {before} was killed"));
                }
                return Ok(Some(HeldPlace { lock: Some(lock), path }));
            }
            Ok(Held::Other(other)) => other,
            Err(error) if is_nowhere(&error) => return Ok(None),
            Err(error) => {
                let message = format!("the lock of {what} cannot be taken ({error})");
                return Err(ErrorKind::File.error(message).in_file(&path));
            }
        };
        // Not everywhere is a clock: it is asked where there is somebody to wait for.
        if !patience.is_zero() {
            let end = *end.get_or_insert_with(|| Instant::now().checked_add(patience));
            if end.is_none_or(|end| Instant::now() < end) {
                std::thread::sleep(PAUSE);
                continue;
            }
        }
        let other = if other.is_empty() { "another run".to_owned() } else { other };
        let message = format!(
            "found {what} in use by {other}, expected one run at a time: wait for it, as by --wait 60s"
        );
        return Err(ErrorKind::File.error(message).in_file(place));
    }
}

/// Whether a lock cannot be, which is no reason not to work.
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

/// This run, for others.
fn holder() -> String {
    let process = if cfg!(target_family = "wasm") { 0 } else { std::process::id() };
    let host = std::env::var("HOSTNAME").or_else(|_| std::env::var("COMPUTERNAME")).unwrap_or_default();
    let host: String = host.chars().filter(|it| it.is_ascii_graphic()).take(64).collect();
    let at = if host.is_empty() { String::new() } else { format!(" on {host}") };
    format!("process {process}{at}")
}
