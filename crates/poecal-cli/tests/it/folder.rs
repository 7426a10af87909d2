//! A folder for a test's files, and the program run in it.

use std::collections::BTreeMap;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

pub(crate) use crate::files::Folder;

/// Result of a run of the program.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) code: i32,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Run {
    pub(crate) fn new(output: Output) -> Self {
        Run {
            code: output.status.code().unwrap(),
            out: String::from_utf8(output.stdout).unwrap(),
            err: String::from_utf8(output.stderr).unwrap(),
        }
    }
}

impl Folder {
    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Runs the program here; arguments are separated by blanks.
    pub(crate) fn run(&self, arguments: &str) -> Run {
        Run::new(self.command(arguments).output().unwrap())
    }

    /// As [`Folder::run`], with a text that comes through a pipe.
    pub(crate) fn run_with_input(&self, arguments: &str, input: &str) -> Run {
        let mut command = self.command(arguments);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        child.stdin.take().unwrap().write_all(input.as_bytes()).unwrap();
        Run::new(child.wait_with_output().unwrap())
    }

    /// As [`Folder::run`], with a variable.
    pub(crate) fn run_with_variable(&self, arguments: &str, name: &str, value: &str) -> Run {
        Run::new(self.command(arguments).env(name, value).output().unwrap())
    }

    /// As [`Folder::run`], for arguments with blanks in them.
    pub(crate) fn run_words(&self, arguments: &[String]) -> Run {
        let mut command = self.command("");
        Run::new(command.args(arguments).output().unwrap())
    }

    /// As [`Folder::run`], with standard output going into a file or device.
    pub(crate) fn run_into(&self, arguments: &str, out: fs::File) -> Run {
        Run::new(self.command(arguments).stdout(out).output().unwrap())
    }

    /// As [`Folder::run`], for a reader of standard output that has gone away.
    pub(crate) fn run_unread(&self, arguments: &str) -> Run {
        let mut command = self.command(arguments);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        Run::new(child.wait_with_output().unwrap())
    }

    fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_poecal"));
        command.args(arguments.split_whitespace()).current_dir(self.root_path());
        command
    }

    /// As [`Folder::run`], for a run that must succeed; returns its standard output.
    pub(crate) fn run_to_success(&self, arguments: &str) -> String {
        let run = self.run(arguments);
        assert_eq!(run.code, 0, "poecal {arguments}\n{}{}", run.out, run.err);
        run.out
    }

    /// Every file with its content, and every folder (without).
    pub(crate) fn listing(&self) -> BTreeMap<PathBuf, Option<Vec<u8>>> {
        fn add(folder: &Path, into: &mut BTreeMap<PathBuf, Option<Vec<u8>>>) {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    add(&path, into);
                    into.insert(path, None);
                } else {
                    let content = fs::read(&path).unwrap();
                    into.insert(path, Some(content));
                }
            }
        }
        let mut listing = BTreeMap::new();
        add(self.root_path(), &mut listing);
        listing
    }
}
