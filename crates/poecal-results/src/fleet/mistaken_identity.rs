//! Measurements of another robot of the line than their serial number states: a file under two serial numbers, and exchanged robots.

use std::collections::BTreeMap;

use super::{Ledger, LedgerRow, Station};
use crate::calibration_file::CalibrationFile;
use crate::compare::compare;

/// Ratio of the errors against its own robot and another robot from which on a visit is of the other.
const BETTER: f64 = 4.0;
/// Code of a refused calibration.
const REFUSED: u8 = 2;

/// For each of some rows, in their order, a sentence if its file also belongs to another serial number, byte for byte. The other is a row of a ledger
/// that was not refused or of another robot, or an earlier one of these rows.
#[must_use]
pub fn find_doubled_files<'a>(open: &[&'a LedgerRow], ledger: &'a Ledger) -> Vec<Option<String>> {
    let mut known: BTreeMap<&str, &LedgerRow> = BTreeMap::new();
    for row in ledger.rows().iter().filter(|row| row.exit != REFUSED && row.of_another.is_none()) {
        row.sha256(&row.file).map(|sha256| known.entry(sha256).or_insert(row));
    }
    let of = |row: &&'a LedgerRow| {
        let other = *known.entry(row.sha256(&row.file)?).or_insert(row);
        (other.serial != row.serial).then(|| {
            format!(
                "found the same bytes as `{}` of {}, expected measurements of {}: the file of one robot was copied; find out which robot was measured, \
                 and replace the file of the other",
                other.file, other.serial, row.serial
            )
        })
    };
    open.iter().map(of).collect()
}

/// Sentence if the calibration of a row is of another robot of the ledger. Its tip is then at that robot's position, and not at its own of the last
/// visit. `None` if it is its own, or if there is no earlier result of one of them.
#[must_use]
pub fn find_exchanged_robot(station: &Station, row: &LedgerRow, ledger: &Ledger) -> Option<String> {
    let read = |it: &LedgerRow| {
        let path = station.folder.join(&it.results).join("calibration.json");
        CalibrationFile::read(path).ok()
    };
    // The last result of each robot of this type that still exists.
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
