//! Which files are messages, and what is said of other files of YAML.

use std::path::Path;

use poecal_numerics::error::{Error, ErrorKind, Result};

use super::parsed::EXPECTED;
use crate::table::configurations::advice;

/// How messages begin.
const BEGINNINGS: [&str; 6] =
    ["---", "header:", "joint_states:", "- header:", "- joint_states:", "observations:"];
/// What says that a file of YAML or JSON has joints.
const JOINTS: &str = "joint_states";

/// Whether the beginning of a file is that of messages; other YAML, which is no table either, is refused.
pub(crate) fn are_messages(path: &Path, head: &str) -> Result<bool> {
    let ending = path.extension().and_then(|it| it.to_str()).map(str::to_ascii_lowercase);
    let is = |endings: &[&str]| ending.as_deref().is_some_and(|it| endings.contains(&it));
    let begin = head.trim_start();
    let is_json = begin.starts_with(['{', '[']);
    let is_yaml = is(&["yaml", "yml"]) || BEGINNINGS.iter().any(|it| begin.starts_with(it));
    if (is_json || is_yaml) && head.contains(JOINTS) {
        return Ok(true);
    }
    if is(&["yaml", "yml"]) {
        let has =
            |key: &str| head.lines().any(|line| line.trim_start().trim_start_matches("- ").starts_with(key));
        let message = if has("target_finder:") || has("image:") && has("pose:") {
            "found pictures with poses (cal_data.yaml of industrial_calibration), expected the joint readings of each picture, which it does not have: \
             write a CSV with `image` and the joints, and the corners by `poecal detect`; the file itself is for --camera, --markers and \
             detect --board"
                .to_owned()
        } else {
            format!("found YAML without `{JOINTS}`, expected a table (CSV), or {EXPECTED}{}", advice(path))
        };
        return Err(Error::new(ErrorKind::Measurement, message).in_file(path));
    }
    Ok(false)
}
