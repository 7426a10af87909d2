//! Errors for texts that are no calibration.

use std::path::Path;

use poecal_numerics::error::{Error, ErrorKind};
use poecal_storage::looks_like;

/// Version of the files that are written. Readers take those of version 1 too, and refuse others.
pub const SCHEMA: &str = "poecal-calibration-2";

/// Version without quantities beside position and rotation, but otherwise the same.
pub(crate) const EARLIER: &str = "poecal-calibration-1";

/// Message for a text that is no calibration of this version; `error` is the parser's.
pub(crate) fn refusal(text: &str, error: Option<serde_json::Error>, path: &Path) -> Error {
    let syntax = |error: &serde_json::Error| {
        let reason = error.to_string();
        let reason = reason.split(" at line ").next().unwrap_or_default();
        let found = if error.is_data() { "something that does not fit the schema" } else { "broken JSON" };
        let message = format!(
            "found {found} ({reason}), expected a calibration as written by `poecal calibrate`: name a calibration.json"
        );
        let line = error.line().max(1);
        // The parser counts bytes up to the unexpected one.
        let before = text.split('\n').nth(line - 1).unwrap_or_default().char_indices();
        let column = before.take_while(|(at, _)| *at < error.column()).count().max(1);
        ErrorKind::Syntax.error(message).at(path, line, column)
    };
    if let Some(model) = looks_like::model(text) {
        let message = format!(
            "found {model}, expected a calibration as written by `poecal calibrate`: calibrate it, and name the calibration.json"
        );
        return ErrorKind::Syntax.error(message).in_file(path);
    }
    let value: serde_json::Value = match serde_json::from_str(text) {
        Ok(value) => value,
        Err(error) => return syntax(&error),
    };
    ErrorKind::Syntax
        .error(match (value.get("schema").and_then(serde_json::Value::as_str), error) {
            (Some(SCHEMA | EARLIER), Some(error)) => return syntax(&error),
            (Some(other), _) => {
                format!("found schema `{other}`, expected `{SCHEMA}`: calibrate again with this version")
            }
            (None, _) => {
                format!("found JSON without the key `schema`, expected a calibration of schema `{SCHEMA}`")
            }
        })
        .in_file(path)
}
