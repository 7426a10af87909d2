//! `fleet.jsonl`: one line for each robot, appended and synced.

use std::collections::BTreeMap;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

use super::LedgerRow;
use crate::calibration_file::schema_of;
use crate::output::{ExistingFiles, ReservedFile};
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_storage::disk::{self, ObjectKind};
use poecal_storage::limits::ResourceLimit;

/// Usual name of the file.
pub const LEDGER: &str = "fleet.jsonl";
/// Name and version of its lines.
const SCHEMA: &str = "poecal-fleet-1";
const FAMILY: &str = "poecal-fleet-";

/// The calibrations done, line by line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ledger {
    path: PathBuf,
    /// The lines, in their order.
    rows: Vec<LedgerRow>,
    /// Indices of each robot's and date's lines.
    places: BTreeMap<LedgerKey, Vec<usize>>,
}

/// Serial number, date and type.
type LedgerKey = (String, String, String);

fn key(row: &LedgerRow) -> LedgerKey {
    (row.serial.clone(), row.date.clone(), row.of_type.clone())
}

impl Ledger {
    /// Reads a ledger; an empty one if there is no file. An incomplete last line of a killed run is cut off.
    ///
    /// # Errors
    /// [`ErrorKind::File`] if it cannot be read, or an incomplete line not cut off; [`ErrorKind::Syntax`] if a line is not of this version.
    pub fn open(path: &Path) -> Result<Self> {
        let mut ledger = Ledger { path: path.to_owned(), ..Ledger::default() };
        let Some(text) = bytes(path)? else { return Ok(ledger) };
        let whole = text.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
        rows(&text[..whole], path)?.into_iter().for_each(|row| ledger.add(row));
        if whole < text.len() {
            let kept = String::from_utf8_lossy(&text[..whole]).into_owned();
            ReservedFile::reserve(path, ExistingFiles::from_switch(true), &[], &mut |_| ())?
                .write(vec![kept.into()])?;
        }
        Ok(ledger)
    }

    /// The lines, in their order.
    #[must_use]
    pub fn rows(&self) -> &[LedgerRow] {
        &self.rows
    }

    fn add(&mut self, row: LedgerRow) {
        self.places.entry(key(&row)).or_default().push(self.rows.len());
        self.rows.push(row);
    }

    /// Lines of the same robot and date, the last first.
    fn rows_like(&self, row: &LedgerRow) -> impl Iterator<Item = &LedgerRow> {
        let places = self.places.get(&key(row)).map_or(&[][..], Vec::as_slice);
        places.iter().rev().map(|at| &self.rows[*at])
    }

    /// True if it has a row of the same inputs.
    #[must_use]
    pub fn has(&self, row: &LedgerRow) -> bool {
        self.rows_like(row).any(|it| it.inputs == row.inputs)
    }

    /// The last row of the same robot and date.
    #[must_use]
    pub fn latest_match(&self, row: &LedgerRow) -> Option<&LedgerRow> {
        self.rows_like(row).next()
    }

    /// Appends a row, in one piece, and waits until it is on the disk.
    ///
    /// # Errors
    /// [`ErrorKind::File`] if it cannot be written; [`ErrorKind::Export`] if a number is not finite.
    pub fn append(&mut self, row: LedgerRow) -> Result<()> {
        let row = LedgerRow { schema: SCHEMA.to_owned(), ..row };
        let text = serde_json::to_string(&row)
            .map_err(|error| ErrorKind::Export.error(format!("the row of the ledger cannot be written: {error}")))?;
        let written = disk::current_disk().append(&self.path).and_then(|mut out| {
            out.write_all(format!("{text}\n").as_bytes())?;
            out.sync()
        });
        written.map_err(|error| ledger_error(&self.path, format!("the ledger cannot be written ({error})")))?;
        self.add(row);
        Ok(())
    }
}

/// The rows of some ledgers in sequence; for a robot and date that was repeated, the last.
///
/// # Errors
/// As [`Ledger::open`], and [`ErrorKind::File`] if there is no such file.
pub fn read_ledgers(paths: &[PathBuf]) -> Result<Vec<LedgerRow>> {
    let mut all: Vec<LedgerRow> = Vec::new();
    for path in paths {
        let Some(text) = bytes(path)? else {
            return Err(ledger_error(path, "found no file, expected a ledger as `poecal fleet` writes it".to_owned()));
        };
        let whole = text.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
        all.extend(rows(&text[..whole], path)?);
    }
    let last: BTreeMap<LedgerKey, usize> = all.iter().enumerate().map(|(at, row)| (key(row), at)).collect();
    let mut kept: Vec<usize> = last.into_values().collect();
    kept.sort_unstable();
    let mut found: Vec<LedgerRow> = kept.into_iter().map(|at| all[at].clone()).collect();
    // In the order of measurement, if that is known; a clock that jumped changes nothing.
    found.sort_by(|a, b| a.date.cmp(&b.date));
    Ok(found)
}

fn bytes(path: &Path) -> Result<Option<Vec<u8>>> {
    let disk = disk::current_disk();
    let failed = |error: io::Error| ledger_error(path, format!("the ledger cannot be read ({error})"));
    match disk.follow(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(failed(error)),
        Ok(there) if there.kind != ObjectKind::File => {
            return Err(ledger_error(path, "found no file, expected a ledger or nothing".to_owned()));
        }
        Ok(_) => {}
    }
    let mut text = Vec::new();
    let most = ResourceLimit::Ledger.value();
    disk.open(path).and_then(|file| file.take(most + 1).read_to_end(&mut text)).map_err(failed)?;
    if text.len() as u64 > most {
        return Err(ledger_error(path, ResourceLimit::Ledger.exceeded_error("a ledger")));
    }
    Ok(Some(text))
}

fn rows(text: &[u8], path: &Path) -> Result<Vec<LedgerRow>> {
    let lines = text.split(|byte| *byte == b'\n').enumerate().filter(|(_, line)| !line.is_empty());
    let row = |(at, line): (usize, &[u8])| {
        let refuse = |message: String| Err(ErrorKind::Syntax.error(message).at_line(path, at + 1));
        let schema = schema_of(line);
        match schema.as_deref() {
            Some(SCHEMA) => serde_json::from_slice(line)
                .or_else(|error| refuse(format!("found a row that is none ({error}), expected one of {SCHEMA}"))),
            Some(other) if other.starts_with(FAMILY) => {
                refuse(format!("found a row of {other}, expected {SCHEMA}: a newer poecal wrote it"))
            }
            _ => refuse(format!("found a line that is no row of a ledger, expected {SCHEMA}: name another file")),
        }
    };
    lines.map(row).collect()
}

fn ledger_error(path: &Path, message: String) -> Error {
    ErrorKind::File.error(message).in_file(path)
}
