//! What a signal may not cut short, and what it leaves to clean up.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError, RwLock, RwLockReadGuard};

use super::staging;
use crate::io::disk::SystemDisk;

/// Staging folders of this process.
static LIVE: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
/// Held while results are put in place.
static EXCHANGE: RwLock<()> = RwLock::new(());
/// Another thread may be writing into a folder while it is removed.
const ATTEMPTS: usize = 100;

fn live() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    LIVE.lock().unwrap_or_else(PoisonError::into_inner)
}

pub(super) fn begun(staging: &Path) {
    live().insert(staging.to_owned());
}

pub(super) fn ended(staging: &Path) {
    live().remove(staging);
}

/// Lets no [`clean_up`] begin while it is held.
pub(super) fn undisturbed() -> RwLockReadGuard<'static, ()> {
    EXCHANGE.read().unwrap_or_else(PoisonError::into_inner)
}

/// Removes what runs of this process have written and not yet put in place. Results that are being put in place are waited for, and
/// none are afterwards: for a program that was asked to end, and ends then.
pub fn clean_up() {
    std::mem::forget(EXCHANGE.write().unwrap_or_else(PoisonError::into_inner));
    let folders: Vec<PathBuf> = live().iter().cloned().collect();
    for folder in folders {
        for _ in 0..ATTEMPTS {
            if staging::remove(&SystemDisk, &folder).is_ok() {
                break;
            }
        }
    }
}
