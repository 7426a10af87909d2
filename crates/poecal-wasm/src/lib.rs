//! The program `poecal` as a WebAssembly module: words and files in, an exit code, words and files out.
//!
//! [`run`] is the whole interface: it puts files on a [`MemoryDisk`], runs the program on it, and collects the written files. `exports` passes it to
//! JavaScript through plain memory; the module imports nothing. `web/npm/poecal.js` is the other side, with the same encoding.
//!
//! For `web/npm` and the page in `web/app`; its interface is not stable beyond the program's. `exports.rs` is its only `unsafe` code. This crate has
//! no computation, sentences or settings of its own.

mod disk;
#[cfg(target_arch = "wasm32")]
mod exports;
mod message;
mod names;

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::Path;
use std::sync::Arc;

use poecal_cli::{CapturedOutput, run_captured};
use poecal_storage::disk::run_on_disk;

pub use disk::MemoryDisk;
pub use message::{decode, encode};

/// A requested run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunRequest {
    /// The words after the program's name.
    pub words: Vec<String>,
    /// Input of `-`; an empty text if none is supplied.
    pub input: Vec<u8>,
    /// Files by their paths, which begin in the current folder. A path that ends in `/` is a folder.
    pub files: Vec<(String, Vec<u8>)>,
}

/// Result of a run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Answer {
    /// Exit code, standard output and standard error.
    pub said: CapturedOutput,
    /// Files written by the run, new or in place of others, by paths as in [`RunRequest::files`].
    pub written: BTreeMap<String, Vec<u8>>,
    /// Files that existed before and were removed.
    pub removed: Vec<String>,
}

/// Runs the program on a disk of its own.
#[must_use]
pub fn run(request: RunRequest) -> Answer {
    let disk = MemoryDisk::new(request.input);
    for (path, bytes) in request.files {
        if let Err(error) = disk.put(Path::new(&path), bytes) {
            let err =
                format!("error: {path}: the file cannot be put on the disk ({error}), expected a path of its own\n");
            return Answer { said: CapturedOutput { code: 2, err, ..CapturedOutput::default() }, ..Answer::default() };
        }
    }
    let words = std::iter::once("poecal".to_owned()).chain(request.words).map(OsString::from);
    let said = run_on_disk(Arc::new(disk.clone()), || run_captured(words));
    let (written, removed) = disk.changes();
    Answer { said, written, removed }
}
