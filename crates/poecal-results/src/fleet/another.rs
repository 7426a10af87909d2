//! Measurements that are of another robot of the line than their serial number says: a file under two of them, and robots that were exchanged.

use std::collections::BTreeMap;

use super::{Ledger, LedgerRow, Station};
use crate::calibration_file::CalibrationFile;
use crate::compare::compare;

/// How many times better a visit must fit another robot than its own, to be that robot's.
const BETTER: f64 = 4.0;
/// Code of a refused calibration.
const REFUSED: u8 = 2;

/// Of each of some rows, in their order, the sentence of a file that is of another serial number too, byte for byte: by a row of a ledger that was not
/// refused or another robot's, or by an earlier one of these.
#[must_use]
pub fn doubled<'a>(open: &[&'a LedgerRow], ledger: &'a Ledger) -> Vec<Option<String>> {
    let mut known: BTreeMap<&str, &LedgerRow> = BTreeMap::new();
    for row in ledger.rows().iter().filter(|row| row.exit != REFUSED && row.of_another.is_none()) {
        row.sha256(&row.file).map(|sha256| known.entry(sha256).or_insert(row));
    }
    let of = |row: &&'a LedgerRow| {
        let other = *known.entry(row.sha256(&row.file)?).or_insert(row);
        (other.serial != row.serial).then(|| {
            format!(
                "found the same bytes as `{}` of {}, expected measurements of {}: one robot was measured, and its file was copied; find out which of both it \
                 was, and put the file of the other one there",
                other.file, other.serial, row.serial
            )
        })
    };
    open.iter().map(of).collect()
}

/// That the calibration of a row is of another robot of the ledger: its tip is where that robot's is, and not where its own was at its last visit.
/// `None` where it is its own, and where nothing earlier is known of one of them.
#[must_use]
pub fn exchanged(station: &Station, row: &LedgerRow, ledger: &Ledger) -> Option<String> {
    let read = |it: &LedgerRow| {
        let path = station.folder.join(&it.results).join("calibration.json");
        CalibrationFile::read(path).ok()
    };
    // The last result of each robot of this type, that is still there.
    let is_known = |it: &&LedgerRow| {
        it.exit < REFUSED && it.of_type == row.of_type && it.results != row.results && it.of_another.is_none()
    };
    let mut last: BTreeMap<&str, &LedgerRow> = BTreeMap::new();
    last.extend(ledger.rows().iter().filter(is_known).map(|it| (it.serial.as_str(), it)));
    let own = last.remove(row.serial.as_str())?;
    let file = read(row)?;
    let change = compare(&read(own)?, &file, None).ok()?;
    if change.is_moved() != Some(true) {
        return None;
    }
    let moved_m = |it: &&LedgerRow| Some(compare(&read(it)?, &file, None).ok()?.tip.rms_m);
    let others = last.into_values().filter_map(|it| Some((moved_m(&it)?, it)));
    let (other_m, other) = others.min_by(|a, b| a.0.total_cmp(&b.0))?;
    (BETTER * other_m < change.tip.rms_m).then(|| {
        format!(
            "found a robot whose tip is {:.3} mm (RMS) from where {} had it on {}, and {:.3} mm from where {} had it on {}, expected its own: the robots or \
             their files were exchanged; check the serial number, and rename the file",
            1e3 * change.tip.rms_m,
            row.serial,
            own.date,
            1e3 * other_m,
            other.serial,
            other.date
        )
    })
}
