//! Sections that a signal must not interrupt, and staging folders to be removed after one.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError, RwLock, RwLockReadGuard};

/// Staging folders of this process.
static LIVE: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
/// Lock that is held while results are put in place.
static EXCHANGE: RwLock<()> = RwLock::new(());

fn live() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    LIVE.lock().unwrap_or_else(PoisonError::into_inner)
}

pub(crate) fn note_begin(staging: &Path) {
    live().insert(staging.to_owned());
}

pub(crate) fn note_end(staging: &Path) {
    live().remove(staging);
}

/// Guard that prevents the start of a [`clean_up`](super::clean_up).
pub(crate) fn hold_clean_up() -> RwLockReadGuard<'static, ()> {
    EXCHANGE.read().unwrap_or_else(PoisonError::into_inner)
}

/// Waits for the end of uninterruptible sections, and blocks new ones. Returns the staging folders.
pub(crate) fn at_last() -> Vec<PathBuf> {
    std::mem::forget(EXCHANGE.write().unwrap_or_else(PoisonError::into_inner));
    live().iter().cloned().collect()
}
