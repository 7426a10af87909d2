//! The ledger of a line of robots on a disk that becomes full, and on a machine that stops.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use poecal_results::fleet::{Ledger, LedgerRow, read_ledgers};
use poecal_storage::disk::run_on_disk;

use super::disk::{Chance, Faults, SimulatedDisk};

const ROBOTS: usize = 4;

fn row(robot: usize) -> LedgerRow {
    LedgerRow { serial: format!("SN{robot}"), date: format!("2026-01-0{}", robot + 1), ..LedgerRow::default() }
}

/// Appends the rows that the ledger does not have; returns their number, and the error that ended it.
fn work_off(disk: &SimulatedDisk) -> (usize, Option<String>) {
    run_on_disk(Arc::new(disk.clone()), || {
        let mut ledger = match Ledger::open(Path::new("fleet.jsonl")) {
            Ok(ledger) => ledger,
            Err(error) => return (0, Some(error.to_string())),
        };
        let mut done = 0;
        for robot in 0..ROBOTS {
            if ledger.has(&row(robot)) {
                continue;
            }
            if let Err(error) = ledger.append(row(robot)) {
                return (done, Some(error.to_string()));
            }
            done += 1;
        }
        (done, None)
    })
}

fn serials(disk: &SimulatedDisk) -> Vec<String> {
    let read = || read_ledgers(&[PathBuf::from("fleet.jsonl")]).unwrap();
    run_on_disk(Arc::new(disk.clone()), read).into_iter().map(|row| row.serial).collect()
}

/// With room for any number of bytes, and stopped before any operation: an appended row is there, half a row is none, and the next run adds those
/// that are missing.
#[test]
fn a_ledger_on_a_full_disk_is_completed_by_the_next_run() {
    let whole = SimulatedDisk::new();
    assert_eq!(work_off(&whole), (ROBOTS, None));
    let operations = whole.operations();
    let bytes: usize = whole.listing("fleet.jsonl").values().flatten().map(Vec::len).sum();
    let all: Vec<String> = (0..ROBOTS).map(|robot| format!("SN{robot}")).collect();
    assert_eq!(serials(&whole), all);
    let full = (0..bytes).step_by(7).map(|room| Faults { room: Some(room), ..Faults::default() });
    let stopped = (0..operations).map(|at| Faults { stop_before: Some(at), ..Faults::default() });
    let (mut torn, mut count) = (0, 0);
    for faults in full.chain(stopped) {
        let disk = SimulatedDisk::new();
        disk.set_faults(faults.clone());
        let (done, error) = work_off(&disk);
        let error = error.unwrap();
        assert!(error.contains("fleet.jsonl: the ledger cannot be"), "{faults:?}: {error}");
        disk.restart(false, &mut Chance(1));
        let text: Vec<u8> = disk.listing("fleet.jsonl").into_values().flatten().flatten().collect();
        torn += usize::from(text.last().is_some_and(|last| *last != b'\n'));
        let (more, error) = work_off(&disk);
        // A row whose bytes are all there, but not for certain, is not written twice.
        assert!(error.is_none() && (done + more == ROBOTS || done + more + 1 == ROBOTS), "{faults:?}: {error:?}");
        assert_eq!(serials(&disk), all, "{faults:?}");
        count += 1;
    }
    println!("{count} faults, {torn} of them left half a row");
    assert!(torn > 10);
}
