//! Recognition of messages, and errors of other files of YAML.

use std::path::Path;

use poecal_numerics::error::{Error, ErrorKind, Result};

use super::parsed_message::EXPECTED;
use crate::table::configurations::advice;

/// Beginnings of messages.
const BEGINNINGS: [&str; 6] = ["---", "header:", "joint_states:", "- header:", "- joint_states:", "observations:"];
/// Key of joints in a file of YAML or JSON.
const JOINTS: &str = "joint_states";

/// True if the beginning of a file is that of messages; other YAML, which is no table either, is refused.
pub(crate) fn are_messages(path: &Path, head: &str) -> Result<bool> {
    let begin = head.trim_start();
    let is_json = begin.starts_with(['{', '[']);
    let ending = path.extension().and_then(|it| it.to_str()).map(str::to_ascii_lowercase);
    let has_keys = ending.is_some_and(|it| ["yaml", "yml"].contains(&it.as_str())) || begins_with_keys(head);
    let is_yaml = has_keys || BEGINNINGS.iter().any(|it| begin.starts_with(it));
    if (is_json || is_yaml) && head.contains(JOINTS) {
        return Ok(true);
    }
    if has_keys {
        let has = |key: &str| head.lines().any(|line| line.trim_start().trim_start_matches("- ").starts_with(key));
        let message = if has("target_finder:") || has("image:") && has("pose:") {
            "found pictures with poses (cal_data.yaml of industrial_calibration), expected the joint readings of each picture, which this file does not have: \
             write a CSV with `image` and the joint readings, and detect the corners by `poecal detect`; pass this file to --camera, --markers or \
             detect --board"
                .to_owned()
        } else {
            format!("found YAML without `{JOINTS}`, expected a table (CSV), or {EXPECTED}{}", advice(path))
        };
        return Err(Error::new(ErrorKind::Measurement, message).in_file(path));
    }
    Ok(false)
}

/// Number of lines by which YAML is recognised.
const LOOKED_AT: usize = 200;

/// True if the first lines, except comments, are keys of YAML, entries of its lists, or indented lines. Cells of a table are not: it may have
/// titles above it.
fn begins_with_keys(head: &str) -> bool {
    let is_content = |it: &&str| !it.trim().is_empty() && !it.starts_with(['#', '%']) && *it != "---";
    let is_word = |it: char| it.is_alphanumeric() || matches!(it, '_' | '-' | '.' | '/' | '"' | '\'');
    let is_key = |line: &str| {
        let key = line.split_once(':').filter(|it| it.1.is_empty() || it.1.starts_with(' ')).map(|it| it.0);
        key.is_some_and(|key| !key.is_empty() && key.chars().all(is_word))
    };
    let is_entry = |line: &str| line == "-" || line.starts_with("- ") || line.starts_with(['[', ']', '{', '}']);
    let is_inside = |line: &str| {
        let inner = line.trim_start();
        is_entry(inner) || inner.len() < line.len() && (is_key(inner) || inner.ends_with([']', '}']))
    };
    let mut lines = head.lines().filter(is_content).take(LOOKED_AT).peekable();
    lines.peek().is_some_and(|it| is_key(it.trim_start_matches("- "))) && lines.all(|it| is_key(it) || is_inside(it))
}
