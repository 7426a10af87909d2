//! `history.jsonl`: one line for each check, beside the calibration.

use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{SCHEMA, TRACK, Validation, ValidationVerdict};
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_storage::disk::{self, ObjectKind};
use poecal_storage::limits::ResourceLimit;
use poecal_storage::write_locks;

/// Name of the file beside a calibration.
pub const HISTORY: &str = "history.jsonl";
/// Longest wait for another run that appends: appending a line takes much less.
const PATIENCE: Duration = Duration::from_secs(20);

/// A check of the history.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct HistoryEntry {
    /// Time of the check, UTC, `2026-03-02T10:20:30Z`.
    pub time: String,
    /// Number of measurements.
    pub count: usize,
    /// Verdict of the measurements.
    pub verdict: ValidationVerdict,
}

/// The checks of a calibration, in the order of their time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    /// Its file.
    path: PathBuf,
    /// True if the file ends without a line break: a run was killed while it wrote.
    is_torn: bool,
    lines: Vec<Value>,
}

/// The current time, UTC, in the form of the history: `SOURCE_DATE_EPOCH` if that is set; `None` without a clock.
#[must_use]
pub fn current_time() -> Option<String> {
    #[cfg(target_family = "wasm")]
    return None;
    #[cfg(not(target_family = "wasm"))]
    {
        use std::time::{Duration, SystemTime};
        let stated = std::env::var("SOURCE_DATE_EPOCH").ok().and_then(|text| text.parse().ok());
        let stated = stated.and_then(|seconds| SystemTime::UNIX_EPOCH.checked_add(Duration::from_secs(seconds)));
        Some(humantime::format_rfc3339_seconds(stated.unwrap_or_else(SystemTime::now)).to_string())
    }
}

impl History {
    /// Reads the history at a path; an empty one if there is no file. Lines of another form are skipped, such as one that a killed run left
    /// incomplete, even if it is the only one.
    ///
    /// # Errors
    /// [`ErrorKind::File`] if the path is no file, the file cannot be read, or no line of it is a check.
    pub fn read(path: &Path) -> Result<Self> {
        let disk = disk::current_disk();
        let failed = |error: io::Error| history_error(path, format!("the history cannot be read ({error})"));
        let there = match disk.follow(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return Ok(History { path: path.to_owned(), ..History::default() });
            }
            there => there.map_err(failed)?,
        };
        if there.kind != ObjectKind::File {
            return Err(history_error(path, "found no file, expected the history of checks or nothing".to_owned()));
        }
        let mut text = Vec::new();
        disk.open(path)
            .and_then(|file| file.take(ResourceLimit::History.value() + 1).read_to_end(&mut text))
            .map_err(failed)?;
        if text.len() as u64 > ResourceLimit::History.value() {
            return Err(history_error(path, ResourceLimit::History.exceeded_error("a history")));
        }
        let is_torn = text.last().is_some_and(|last| *last != b'\n');
        let lines = text.split(|byte| *byte == b'\n').filter_map(|line| serde_json::from_slice(line).ok());
        let is_check =
            |line: &Value| line.get("schema").and_then(Value::as_str).is_some_and(|it| [SCHEMA, TRACK].contains(&it));
        let lines: Vec<Value> = lines.filter(is_check).collect();
        // A run that was killed while it wrote the first line leaves the beginning of a line.
        let begins_one = text.first() == Some(&b'{') && serde_json::from_slice::<IgnoredAny>(&text).is_err();
        if lines.is_empty() && !text.is_empty() && !(is_torn && begins_one && !text.contains(&b'\n')) {
            let message = "found a file without a check, expected the history of checks or nothing".to_owned();
            return Err(history_error(path, message));
        }
        Ok(History { path: path.to_owned(), is_torn, lines })
    }

    /// The checks of the same calibration before this one, by the SHA-256 of its file.
    #[must_use]
    pub fn checks_before(&self, validation: &Validation, sha256: &str) -> Vec<HistoryEntry> {
        let own = line_of(validation, "").map(|(_, line)| without_run(line)).ok();
        let is_of = |line: &&Value| {
            let inputs = line.get("inputs");
            let name = inputs.and_then(|it| it.get("calibration")).and_then(Value::as_str);
            let all = inputs.and_then(|it| it.get("sha256"));
            all.zip(name).and_then(|(all, name)| all.get(name)).and_then(Value::as_str) == Some(sha256)
        };
        let others = self.lines.iter().filter(is_of).filter(|line| Some(without_run((*line).clone())) != own);
        others.filter_map(|line| serde_json::from_value(line.clone()).ok()).collect()
    }

    /// Appends a check, by `poecal validate` or by `poecal track`, with its time, unless it is already there.
    ///
    /// # Errors
    /// [`ErrorKind::File`] if the file cannot be written, [`ErrorKind::Export`] if the check cannot be written as JSON.
    pub fn append(&mut self, check: &impl Serialize, time: &str) -> Result<()> {
        let patience = write_locks::patience().max(PATIENCE);
        let _held = write_locks::hold(&self.path, "the history", patience, &mut |_| ())?;
        // Another run may have appended since it was read.
        *self = History::read(&self.path)?;
        let (text, line) = line_of(check, time)?;
        let own = without_run(line.clone());
        if self.lines.iter().any(|other| without_run(other.clone()) == own) {
            return Ok(());
        }
        let text = if self.is_torn { format!("\n{text}\n") } else { format!("{text}\n") };
        let written = disk::current_disk().append(&self.path).and_then(|mut out| {
            // In one piece, so that two runs at the same time write two lines.
            out.write_all(text.as_bytes())?;
            out.sync()
        });
        written.map_err(|error| history_error(&self.path, format!("the history cannot be written ({error})")))?;
        self.is_torn = false;
        self.lines.push(line);
        Ok(())
    }
}

/// A line.
#[derive(Serialize)]
struct TimedLine<'a, T: Serialize> {
    time: &'a str,
    #[serde(flatten)]
    check: &'a T,
}

/// The line of a check, as text and as a value that has been read.
fn line_of(check: &impl Serialize, time: &str) -> Result<(String, Value)> {
    let cannot = |error| ErrorKind::Export.error(format!("the check cannot be written: {error}"));
    let text = serde_json::to_string(&TimedLine { time, check }).map_err(cannot)?;
    let line = serde_json::from_str(&text).map_err(cannot)?;
    Ok((text, line))
}

/// A line without the keys that differ between two runs of the same check.
fn without_run(mut line: Value) -> Value {
    if let Some(object) = line.as_object_mut() {
        object.remove("time");
        let inputs = object.get_mut("inputs").and_then(Value::as_object_mut);
        inputs.into_iter().for_each(|it| drop(it.remove("command")));
    }
    line
}

fn history_error(path: &Path, message: String) -> Error {
    ErrorKind::File.error(message).in_file(path)
}
