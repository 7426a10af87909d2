//! The program run in the project's folder.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::folder::Run;

/// The project's folder.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// Runs the program with these words, and results in `out`.
pub(crate) fn run(words: &str, out: &Path) -> Run {
    let mut command = Command::new(env!("CARGO_BIN_EXE_poecal"));
    Run::new(command.current_dir(root()).args(words.split_whitespace()).arg("--out").arg(out).output().unwrap())
}

/// Output of a run that must succeed.
pub(crate) fn output_of(words: &str, out: &Path) -> String {
    let run = run(words, out);
    assert_eq!(run.code, 0, "{}", run.err);
    run.out
}
