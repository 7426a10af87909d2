//! What the JSON of a camera's place and of a tool's tip have in common.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::hand_eye::{Finding, Level};

/// What a result was computed from.
#[derive(Serialize)]
pub(super) struct InputsEntry<'a> {
    #[serde(skip_serializing_if = "str::is_empty")]
    pub(super) command: &'a str,
    pub(super) sha256: &'a BTreeMap<String, String>,
    pub(super) understood: &'a [String],
}

#[derive(Serialize)]
pub(super) struct VerdictEntry<'a> {
    level: &'static str,
    reasons: &'a [String],
}

impl<'a> VerdictEntry<'a> {
    pub(super) fn new(level: Level, reasons: &'a [String]) -> Self {
        VerdictEntry { level: level.word(), reasons }
    }
}

#[derive(Serialize)]
pub(super) struct FindingEntry<'a> {
    kind: &'static str,
    statement: &'a str,
    rows: Vec<&'a str>,
}

impl<'a> FindingEntry<'a> {
    /// All findings, with the names of their rows.
    pub(super) fn all(findings: &'a [Finding], names: &'a [String]) -> Vec<Self> {
        let of = |it: &'a Finding| FindingEntry {
            kind: it.kind.word(),
            statement: &it.statement,
            rows: it.rows.iter().map(|row| name_of(names, *row)).collect(),
        };
        findings.iter().map(of).collect()
    }
}

/// What a row is called.
pub(super) fn name_of(names: &[String], row: usize) -> &str {
    names.get(row).map_or("", String::as_str)
}
