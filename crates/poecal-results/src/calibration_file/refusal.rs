//! Errors for texts that are no calibration.

use std::path::Path;

use serde::Deserialize;
use serde::de::IgnoredAny;

use poecal_numerics::error::{Error, ErrorKind};
use poecal_storage::looks_like;

/// Version of the files that are written; those of other versions are refused.
pub const SCHEMA: &str = "poecal-calibration-3";

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
        ErrorKind::Syntax.error(message).at_position(path, line, column)
    };
    if let Some(model) = looks_like::model(text) {
        let message = format!(
            "found {model}, expected a calibration as written by `poecal calibrate`: calibrate it, and name the calibration.json"
        );
        return ErrorKind::Syntax.error(message).in_file(path);
    }
    if let Err(error) = serde_json::from_str::<IgnoredAny>(text) {
        return syntax(&error);
    }
    let schema = schema_of(text.as_bytes());
    ErrorKind::Syntax
        .error(match (schema.as_deref(), error) {
            (Some(SCHEMA), Some(error)) => return syntax(&error),
            (Some(other), _) => {
                let again = sources(text)
                    .rerun_command()
                    .map_or_else(|| "calibrate again".to_owned(), |it| format!("calibrate again: `{it}`"));
                format!("found schema `{other}`, expected `{SCHEMA}`, that of this version: {again}")
            }
            (None, _) => {
                format!("found JSON without the key `schema`, expected a calibration of schema `{SCHEMA}`")
            }
        })
        .in_file(path)
}

/// The inputs of a calibration, as all versions have them.
#[derive(Default, Deserialize)]
#[serde(default)]
struct Sources {
    command: Option<String>,
    model: Option<String>,
    measurements: Vec<String>,
}

impl Sources {
    /// The command that repeats the calibration from the inputs that the file lists.
    fn rerun_command(self) -> Option<String> {
        let Sources { command, model, measurements } = self;
        command.or_else(|| {
            let words = std::iter::once(model?).chain(measurements);
            Some(format!("poecal calibrate {}", words.collect::<Vec<_>>().join(" ")))
        })
    }
}

/// The key `schema` of a JSON text; nothing else of the text is stored.
pub(crate) fn schema_of(text: &[u8]) -> Option<String> {
    #[derive(Deserialize)]
    struct SchemaHead {
        schema: Option<String>,
    }
    serde_json::from_slice::<SchemaHead>(text).ok()?.schema
}

/// The inputs that a calibration of any version lists.
fn sources(text: &str) -> Sources {
    #[derive(Default, Deserialize)]
    struct SourcesHead {
        #[serde(default)]
        inputs: Sources,
    }
    serde_json::from_str::<SourcesHead>(text).unwrap_or_default().inputs
}
