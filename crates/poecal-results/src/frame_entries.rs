//! Common parts of the JSON of a camera's pose and of a tool's tip.

use std::collections::BTreeMap;

use serde::Serialize;

use poecal_fit::hand_eye::{Finding, HandEyeLevel};

/// Inputs of a result.
#[derive(Serialize)]
pub(crate) struct InputsEntry<'a> {
    #[serde(skip_serializing_if = "str::is_empty")]
    pub(crate) command: &'a str,
    pub(crate) sha256: &'a BTreeMap<String, String>,
    pub(crate) understood: &'a [String],
}

#[derive(Serialize)]
pub(crate) struct VerdictEntry<'a> {
    level: &'static str,
    reasons: &'a [String],
}

impl<'a> VerdictEntry<'a> {
    pub(crate) fn new(level: HandEyeLevel, reasons: &'a [String]) -> Self {
        VerdictEntry { level: level.word(), reasons }
    }
}

#[derive(Serialize)]
pub(crate) struct FindingEntry<'a> {
    kind: &'static str,
    statement: &'a str,
    rows: Vec<&'a str>,
}

impl<'a> FindingEntry<'a> {
    /// All findings, with the names of their rows.
    pub(crate) fn all(findings: &'a [Finding], names: &'a [String]) -> Vec<Self> {
        let of = |it: &'a Finding| FindingEntry {
            kind: it.kind.word(),
            statement: &it.statement,
            rows: it.rows.iter().map(|row| name_of(names, *row)).collect(),
        };
        findings.iter().map(of).collect()
    }
}

/// Name of a row.
pub(crate) fn name_of(names: &[String], row: usize) -> &str {
    names.get(row).map_or("", String::as_str)
}
