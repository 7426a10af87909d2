//! Whole commands on a disk that writes short, becomes full, fails and stops at any moment, and forgets unsynced data. In any case, a place holds its
//! earlier content, or all that is new, or the next run completes it. It never loses a file of others.
//!
//! `POECAL_TRIALS` sets the number of trials, as everywhere.

mod disk;
mod ledger;
mod operations;

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use disk::{Chance, Faults, SimulatedDisk};
use poecal_cli::{CapturedOutput, run_captured};
use poecal_storage::disk::run_on_disk;
use poecal_testing::trials::trials;

/// An arm of two joints: thousands of calibrations run, and a test of the disk needs no larger one.
const ROBOT: &str = r#"<robot name="two">
<link name="base"/><link name="upper"/><link name="fore"/><link name="tip"/>
<joint name="joint1" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 0.3"/><axis xyz="0 0 1"/><limit lower="-2" upper="2"/></joint>
<joint name="joint2" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="0.3 0 0.1"/><axis xyz="0 1 0"/><limit lower="-2" upper="2"/></joint>
<joint name="end" type="fixed"><parent link="fore"/><child link="tip"/><origin xyz="0.3 0 0.05"/></joint>
</robot>
"#;
/// Rows that are measured, enough for a good verdict.
const ROWS: usize = 14;
/// Marks of files that a run has not put in place.
const UNFINISHED: &str = "poecal-unfinished";

type Listing = BTreeMap<PathBuf, Option<Vec<u8>>>;

/// A command, and the places that it writes to.
struct Case {
    name: &'static str,
    command: &'static str,
    /// Each is old as a whole or new as a whole.
    places: &'static [&'static str],
    start: SimulatedDisk,
    /// Contents of the places before and after.
    old: Vec<Listing>,
    new: Vec<Listing>,
    operations: usize,
}

impl Case {
    /// Bytes of the files that the command writes.
    fn bytes(&self) -> usize {
        let files = self.new.iter().flat_map(|listing| listing.values().flatten());
        files.map(Vec::len).sum()
    }
}

fn run(disk: &SimulatedDisk, command: &str) -> CapturedOutput {
    let words = std::iter::once("poecal").chain(command.split_whitespace()).map(OsString::from);
    run_on_disk(Arc::new(disk.clone()), || run_captured(words))
}

/// A place without the files that a run has not put in place.
fn place(disk: &SimulatedDisk, path: &str) -> Listing {
    let mut listing = disk.listing(path);
    listing.retain(|path, _| !path.to_string_lossy().contains(UNFINISHED));
    listing
}

fn case(name: &'static str, start: &SimulatedDisk, command: &'static str, places: &'static [&'static str]) -> Case {
    let start = start.copy();
    let old = places.iter().map(|path| place(&start, path)).collect();
    let disk = start.copy();
    let said = run(&disk, command);
    assert_eq!(said.code, 0, "{name}: {}", said.err);
    let new = places.iter().map(|path| place(&disk, path)).collect();
    let operations = disk.operations();
    let left: Vec<PathBuf> =
        disk.listing("/").into_keys().filter(|path| path.to_string_lossy().contains(UNFINISHED)).collect();
    assert!(left.is_empty(), "{name}: {left:?}");
    println!("{name}: {operations} operations");
    Case { name, command, places, start, old, new, operations }
}

fn cases() -> Vec<Case> {
    let empty = SimulatedDisk::new();
    empty.put("robot.urdf", ROBOT.as_bytes());
    for (seed, day) in ["monday", "tuesday"].into_iter().enumerate() {
        let command = format!("simulate robot.urdf --count {ROWS} --seed {seed} --out {day}");
        let made = empty.copy();
        assert_eq!(run(&made, &command).code, 0);
        let written = made.listing(day).into_iter().find(|(path, _)| path.ends_with("measurements.csv"));
        empty.put(&format!("{day}.csv"), &written.and_then(|(_, rows)| rows).unwrap());
    }
    let first = empty.copy();
    assert_eq!(run(&first, "calibrate robot.urdf monday.csv --out out --report page.html").code, 0);
    assert_eq!(run(&first, "export out/calibration.json --format toml --out robot.toml").code, 0);
    let others = first.copy();
    others.put("out/notes.txt", b"mine");
    others.put("out/calibrated.toml", b"of an earlier run");
    others.put("out/photos/1.jpg", b"mine too");
    let simulated = empty.copy();
    assert_eq!(run(&simulated, "simulate robot.urdf --count 5 --out sim").code, 0);
    let reported = empty.copy();
    assert_eq!(run(&reported, "calibrate robot.urdf monday.csv --out out --report none").code, 0);
    vec![
        case("new folder", &empty, "calibrate robot.urdf tuesday.csv --out out --report none", &["out"]),
        case("exchange", &first, "calibrate robot.urdf tuesday.csv --out out --force --report none", &["out"]),
        case("others' files", &others, "calibrate robot.urdf tuesday.csv --out out --force --report none", &["out"]),
        case(
            "report elsewhere",
            &others,
            "calibrate robot.urdf tuesday.csv --out out --force --report page.html",
            &["out", "page.html"],
        ),
        case("simulation", &simulated, "simulate robot.urdf --count 7 --held-out-count 3 --out sim --force", &["sim"]),
        case("report", &reported, "report out/calibration.json", &["out"]),
        case("file", &first, "export robot.urdf --format toml --out robot.toml --force", &["robot.toml"]),
        case("new file", &first, "export robot.urdf --format toml --out new.toml", &["new.toml"]),
        case("project", &empty, "init robot.urdf --count 5 --out cell", &["cell"]),
    ]
}

/// Faults of a trial.
fn faults(case: &Case, chance: &mut Chance) -> Faults {
    let mut faults = Faults {
        short_writes: chance.one_in(3),
        no_exchange: chance.one_in(3),
        no_links: chance.one_in(4),
        mounted: chance.one_in(5) && !case.start.listing("out").is_empty(),
        ..Faults::default()
    };
    // Other paths, and short writes, take more operations than the default one.
    let operations = case.operations + 20;
    match chance.draw_below(4) {
        0 => faults.stop_before = Some(chance.draw_below(operations)),
        1 => faults.fail = (0..=chance.draw_below(3)).map(|_| chance.draw_below(operations)).collect(),
        2 => {
            let first = chance.draw_below(operations);
            faults.fail = (first..=first + chance.draw_below(4)).collect();
            faults.stop_before = Some(first + chance.draw_below(operations));
        }
        // Sometimes more than is needed.
        _ => faults.room = Some(chance.draw_below(case.bytes() * 6 / 5)),
    }
    faults.chance = Some(chance.clone());
    faults
}

/// State of the places: each old, or each new, or a mixture.
fn state(case: &Case, disk: &SimulatedDisk) -> &'static str {
    let is = |wanted: &[Listing]| {
        case.places.iter().zip(wanted).map(|(path, wanted)| place(disk, path) == *wanted).collect::<Vec<_>>()
    };
    let (old, new) = (is(&case.old), is(&case.new));
    if old.iter().all(|old| *old) {
        "old"
    } else if new.iter().all(|new| *new) {
        "new"
    } else if old.iter().zip(&new).all(|(old, new)| *old || *new) {
        // A machine can stop between two places, each whole, and two failures leave one of them to the next run.
        "each whole"
    } else {
        "mixed"
    }
}

/// One trial; returns its outcome.
fn trial(case: &Case, faults: &Faults, chance: &mut Chance) -> &'static str {
    let disk = case.start.copy();
    disk.set_faults(faults.clone());
    let said = run(&disk, case.command);
    let stopped = disk.has_stopped();
    let failures = disk.failures();
    let seen = format!("{}: {faults:?}\n{said:?}\n", case.name);
    if !stopped {
        match (said.code, state(case, &disk)) {
            (0, "new") | (2, "old") => {}
            // With more than one fault: files that could not be put back are reported, and settled by the next run.
            (2, _) if failures > 1 => {
                let is_said = ["settles it", "could not be taken back"].iter().any(|words| said.err.contains(words));
                assert!(is_said, "{seen}");
            }
            (code, state) => panic!("{seen}code {code}, but the places are {state}"),
        }
    }
    disk.restart(stopped && chance.one_in(2), chance);
    // Without --force the command is refused if something exists, which settles remains nevertheless.
    let again = case.command.replace(" --force", "");
    let _ = run(&disk, &again);
    let settled = state(case, &disk);
    let is_settled = ["old", "new"].contains(&settled) || ((stopped || failures > 1) && settled == "each whole");
    assert!(is_settled, "{seen}{settled}");
    let forced =
        if case.command.contains("--force") || case.name == "report" { case.command.to_owned() } else { again };
    let last = run(&disk, &forced);
    // A place that was empty has been filled by the run before.
    assert!(last.code == 0 || !case.command.contains("--force"), "{seen}{last:?}");
    assert_eq!(state(case, &disk), "new", "{seen}{last:?}");
    let left: Vec<PathBuf> =
        disk.listing("/").into_keys().filter(|path| path.to_string_lossy().contains(UNFINISHED)).collect();
    assert!(left.is_empty(), "{seen}{left:?}");
    match (stopped, said.code) {
        (true, _) => "stopped",
        (false, 0) => "done",
        (false, _) => "refused",
    }
}

/// Trials of a week: `./test` runs a sixth.
const WEEKLY: usize = 4000;

/// Work for each number up to `count`, on two threads. Not by rayon, which would begin one trial while another waits, on that one's disk.
fn on_two_threads<T: Send>(count: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let some = || {
        let numbers = std::iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed));
        numbers.take_while(|number| *number < count).map(&work).collect::<Vec<T>>()
    };
    std::thread::scope(|scope| {
        let threads = [scope.spawn(some), scope.spawn(some)];
        threads.into_iter().flat_map(|thread| thread.join().unwrap()).collect()
    })
}

#[test]
fn whatever_fails_a_place_is_old_or_new_or_completed_by_the_next_run() {
    let cases = cases();
    let trials = trials(WEEKLY).count;
    let ends = on_two_threads(trials, |seed| {
        let mut chance = Chance(seed as u64);
        let case = &cases[chance.draw_below(cases.len())];
        let faults = faults(case, &mut chance);
        trial(case, &faults, &mut chance)
    });
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for end in ends {
        *counts.entry(end).or_default() += 1;
    }
    println!("{trials} trials: {counts:?}");
    for kind in ["stopped", "done", "refused"] {
        let count = counts.get(kind).copied().unwrap_or(0);
        assert!(count > 0 && count > trials / 50, "{kind}: {count}");
    }
}

#[test]
fn a_stop_before_every_single_operation() {
    // Before every one weekly, before one in so many where fewer trials are required.
    let apart = 1000_usize.div_ceil(trials(1000).count);
    let cases = cases();
    let stops = on_two_threads(2 * cases.len(), |number| {
        let (case, no_exchange) = (&cases[number / 2], number % 2 == 1);
        let stops = (0..case.operations + 40).step_by(apart).take_while(|stop| {
            let faults = Faults { stop_before: Some(*stop), no_exchange, ..Faults::default() };
            let mut chance = Chance((2 * stop + usize::from(no_exchange)) as u64);
            trial(case, &faults, &mut chance) == "stopped"
        });
        stops.count()
    });
    let stops: usize = stops.into_iter().sum();
    println!("{stops} stops");
    assert!(stops > 500 / apart);
}

/// Each input is opened once, for any number of questions about it: its kind, its partner in a join, a shifted header.
#[test]
fn each_input_is_opened_once() {
    let inputs: [(&str, &[u8]); 9] = [
        ("robot.urdf", include_bytes!("../../../../../examples/elbow/robot.urdf")),
        ("points.csv", include_bytes!("../../../../../examples/elbow/points.csv")),
        ("joints.csv", include_bytes!("../../../../../examples/howto/joints.csv")),
        ("take.csv", include_bytes!("../../../../../examples/howto/take.csv")),
        ("joints.xlsx", include_bytes!("../../../../../examples/howto/joints.xlsx")),
        ("points.txt", include_bytes!("../../../../../examples/howto/points.txt")),
        ("pictures.csv", include_bytes!("../../../../../examples/howto/pictures.csv")),
        ("corners.csv", include_bytes!("../../../../../examples/howto/corners.csv")),
        ("lens.csv", include_bytes!("../../../../../examples/howto/lens.csv")),
    ];
    let start = SimulatedDisk::new();
    inputs.iter().for_each(|(name, bytes)| start.put(name, bytes));
    for command in [
        "check robot.urdf points.csv",
        "check robot.urdf joints.csv take.csv",
        "check robot.urdf pictures.csv corners.csv --camera lens.csv --markers chessboard:6x5:40mm",
        "calibrate robot.urdf points.csv --out out --report none",
        "calibrate robot.urdf joints.csv take.csv --out out --report none",
        "import robot.urdf joints.xlsx points.txt --out session.csv",
    ] {
        let disk = start.copy();
        let said = run(&disk, command);
        assert_eq!(said.code, 0, "{command}: {}", said.err);
        let opened = &disk.state().opened;
        for (name, _) in &inputs {
            let count = opened.get(&disk::whole_path(name.as_ref())).copied().unwrap_or_default();
            assert_eq!(count, usize::from(command.contains(name)), "{command}: {name}");
        }
    }
}
