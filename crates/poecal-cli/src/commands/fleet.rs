//! `poecal fleet`: a folder of robots, processed by processes of one thread each.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, mpsc};
use std::thread;

use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::threads::threads_now;
use poecal_report as report;
use poecal_results::calibration_file::{CalibrationFile, Inputs};
use poecal_results::fleet::{
    InboxFile, InputRow, LEDGER, Ledger, LedgerRow, Station, find_doubled_files, find_exchanged_robot, list_files,
    read_ledgers,
};
use poecal_results::output::{ExistingFiles, ReservedFile};
use poecal_results::settings::{SettingValue, Settings};
use poecal_results::validation::current_time;
use poecal_storage::named_files::canonical_path;
use poecal_storage::{limits, write_locks};

use crate::args::{Fleet, FleetCommand, FleetPrior, FleetReport};
use crate::console::Console;
use crate::{DONE, WORSE};

pub(crate) fn fleet(arguments: &Fleet, console: &Console) -> Result<u8> {
    match &arguments.command {
        Some(FleetCommand::Report(options)) => return report_of(options, console),
        Some(FleetCommand::Prior(options)) => return prior_of(options, console),
        None => {}
    }
    let Some(path) = &arguments.station else {
        return ErrorKind::Option.refuse("found no station, expected its file (TOML)");
    };
    let station = Station::read(path)?;
    let place = match arguments.shard {
        Some((at, of)) => {
            let stem = station.ledger.file_stem().and_then(|it| it.to_str()).unwrap_or("fleet").to_owned();
            station.ledger.with_file_name(format!("{stem}.{at}-of-{of}.jsonl"))
        }
        None => station.ledger.clone(),
    };
    let _held = write_locks::hold(&place, "the ledger", write_locks::patience(), &mut console.warner())?;
    let mut ledger = Ledger::open(&place)?;
    let mut seen: BTreeMap<PathBuf, String> = BTreeMap::new();
    let mut told = BTreeSet::new();
    let mut again = arguments.rerun;
    loop {
        let (all, left) = list_files(&station)?;
        for other in left {
            let sentence = other.to_string();
            if told.insert(other) {
                console.warning(sentence);
            }
        }
        let mut own: Vec<InboxFile> =
            all.into_iter().filter(|it| arguments.shard.is_none_or(|shard| it.is_of_shard(shard))).collect();
        own.sort_by(|a, b| a.date.cmp(&b.date).then_with(|| a.cmp(b)));
        if arguments.watch.is_some() {
            // A file that is still being written differs at the next look.
            own.retain(|it| {
                let Some(sha256) = it.sha256() else { return false };
                seen.insert(it.path.clone(), sha256.clone()) == Some(sha256)
            });
        }
        let failed = work_off(&station, &own, &mut ledger, again, console)?;
        if arguments.watch.is_none() && failed.now + failed.passed == 0 && failed.before > 0 {
            let what = if failed.before == 1 { "robot failed" } else { "robots failed" };
            console.say(&format!(
                "nothing new; {} {what} before, with the same files: {} states the reason, and --rerun calibrates all again\n",
                failed.before,
                place.display()
            ))?;
        }
        again = false;
        let Some(time) = arguments.watch else {
            return Ok(if failed.now + failed.before > 0 { WORSE } else { DONE });
        };
        thread::sleep(time);
    }
}

/// Numbers of robots that passed and failed.
#[derive(Clone, Copy, Default)]
struct Counts {
    passed: usize,
    now: usize,
    before: usize,
}

/// Calibrates the robots that the ledger does not have.
fn work_off(
    station: &Station,
    all: &[InboxFile],
    ledger: &mut Ledger,
    again: bool,
    console: &Console,
) -> Result<Counts> {
    let shared = SharedInputs::read(station)?;
    let mut failed = 0;
    let (open, failed_before) = find_open(station, all, ledger, again, &shared);
    let before = find_changed(&open, ledger, again);
    let doubles = find_doubled_files(&open.iter().map(|it| &it.1).collect::<Vec<_>>(), ledger);
    let (skipped, total) = (all.len() - open.len(), open.len());
    let workers = threads_now().min(total.max(1));
    let next = AtomicUsize::new(0);
    let (send, receive) = mpsc::channel();
    let send = Mutex::new(send);
    let mut result = Ok(());
    let mut passed = 0;
    thread::scope(|scope| {
        for _ in 0..workers {
            let (next, open, shared) = (&next, &open, &shared);
            let before = (&before[..], &doubles[..]);
            let own = send.lock().map(|it| it.clone()).ok();
            scope.spawn(move || {
                let Some(own) = own else { return };
                calibrate_next((station, &shared.prior), open, before, (next, &own));
            });
        }
        drop(send);
        // The ledger has the order of the inbox, whichever process ends first.
        let mut waiting: BTreeMap<usize, LedgerRow> = BTreeMap::new();
        let mut place = 0;
        for (at, row) in receive {
            waiting.insert(at, row);
            while let Some(row) = waiting.remove(&place) {
                place += 1;
                let row = held_against_the_line(station, row, ledger);
                failed += usize::from(!row.is_passed());
                passed += usize::from(row.is_passed());
                if let Some(reason) = row.reason.as_ref().filter(|_| !row.is_passed()) {
                    console.warning(format!("{} {}: {reason}", row.serial, row.date));
                }
                let row = LedgerRow { time: current_time().unwrap_or_default(), ..row };
                if let Err(error) = ledger.append(row) {
                    result = Err(error);
                    next.store(usize::MAX / 2, Ordering::Relaxed);
                    return;
                }
            }
        }
    });
    result?;
    if total > 0 {
        console.say(&format!("{passed} of {total} robots passed; {skipped} were done before\n"))?;
    }
    Ok(Counts { passed, now: failed, before: failed_before })
}

/// Finds the robots that the ledger does not have, with their rows, and counts the earlier ones that failed.
fn find_open(
    station: &Station,
    all: &[InboxFile],
    ledger: &Ledger,
    again: bool,
    shared: &SharedInputs,
) -> (Vec<(InboxFile, LedgerRow)>, usize) {
    let mut failed = 0;
    let mut open: Vec<(InboxFile, LedgerRow)> = Vec::new();
    for found in all {
        open.push((found.clone(), initial_row(station, found, shared)));
    }
    // A file that was refused as another robot's is tried again if it no longer is.
    let doubles = find_doubled_files(&open.iter().map(|it| &it.1).collect::<Vec<_>>(), ledger);
    let mut doubles = doubles.iter();
    open.retain(|(_, row)| {
        let is_double = doubles.next().is_some_and(Option::is_some);
        let last = ledger.latest_match(row).filter(|_| ledger.has(row) && !again);
        let is_freed = last.is_some_and(|it| it.exit == REFUSED && it.of_another.is_some()) && !is_double;
        failed += usize::from(last.is_some_and(|it| !is_freed && !it.is_passed()));
        last.is_none() || is_freed
    });
    (open, failed)
}

/// Reason of refusal for each robot, if the ledger has another file of it.
fn find_changed(open: &[(InboxFile, LedgerRow)], ledger: &Ledger, again: bool) -> Vec<Option<String>> {
    open
        .iter()
        .map(|(_, row)| {
            let other = ledger.latest_match(row).filter(|it| !again && it.exit != REFUSED && it.inputs != row.inputs)?;
            (other.sha256(&row.file) != row.sha256(&row.file)).then(|| {
                format!(
                    "found `{}` of {} again with other bytes, expected one file a robot and date: name it by another date, or repeat by --rerun",
                    row.serial, row.date
                )
            })
        })
        .collect()
}

/// Calibrates robots in sequence, of those that no other thread took, until none remains.
fn calibrate_next(
    (station, prior): (&Station, &[OsString]),
    open: &[(InboxFile, LedgerRow)],
    (changed, doubles): (&[Option<String>], &[Option<String>]),
    (next, own): (&AtomicUsize, &mpsc::Sender<(usize, LedgerRow)>),
) {
    loop {
        let at = next.fetch_add(1, Ordering::Relaxed);
        let Some((found, row)) = open.get(at) else { return };
        let done = match (&changed[at], doubles[at].as_ref().filter(|_| found.fault().is_none())) {
            (Some(sentence), _) => refused_row(row.clone(), sentence.clone()),
            (None, Some(sentence)) => {
                LedgerRow { of_another: Some(sentence.clone()), ..refused_row(row.clone(), sentence.clone()) }
            }
            (None, None) => calibrate_robot(station, found, row.clone(), prior),
        };
        if own.send((at, done)).is_err() {
            return;
        }
    }
}

/// A row that was calibrated; it fails if it is of another robot of the line.
fn held_against_the_line(station: &Station, row: LedgerRow, ledger: &Ledger) -> LedgerRow {
    if row.exit >= REFUSED {
        return row;
    }
    match find_exchanged_robot(station, &row, ledger) {
        Some(sentence) => {
            LedgerRow { exit: row.exit.max(WORSE), reason: Some(sentence.clone()), of_another: Some(sentence), ..row }
        }
        None => row,
    }
}

/// Code of a refused calibration.
const REFUSED: u8 = 2;

/// Inputs that all robots share.
struct SharedInputs {
    /// SHA-256 of models and settings.
    sha256: BTreeMap<String, String>,
    /// Estimate of the line's next robot, as options.
    prior: Vec<OsString>,
}

impl SharedInputs {
    fn read(station: &Station) -> Result<Self> {
        let files = station.models.values().chain(&station.settings).chain(&station.prior);
        let sha256 = Inputs::checksums(files.map(PathBuf::as_path))?;
        let mut prior = Vec::new();
        if let Some(path) = &station.prior {
            let settings = Settings::read(path, &["tolerance", "corrections"])?;
            for entry in &settings.entries {
                let SettingValue::One(text) = &entry.value else {
                    let message = format!(
                        "found a list or a switch for `{}`, expected a text as `poecal fleet prior` writes it",
                        entry.key
                    );
                    return Err(settings.error(entry, message));
                };
                prior.push(format!("--{}={text}", entry.key).into());
            }
        }
        Ok(SharedInputs { sha256, prior })
    }
}

/// A row before its calibration.
fn initial_row(station: &Station, found: &InboxFile, shared: &SharedInputs) -> LedgerRow {
    let by_prior = station.prior.is_some() && !Station::is_in_full(&found.serial);
    let files = found.model(station).into_iter().chain(&station.settings);
    let files = files.chain(station.prior.iter().filter(|_| by_prior));
    let input = |path: &PathBuf| {
        let sha256 = shared.sha256.get(&path.display().to_string())?.clone();
        Some(InputRow { file: station.from_folder(path), sha256 })
    };
    let file = station.from_folder(&found.path);
    let own = found.sha256().map(|sha256| InputRow { file: file.clone(), sha256 });
    LedgerRow {
        serial: found.serial.clone(),
        date: found.date.clone(),
        of_type: found.of_type.clone(),
        results: station.from_folder(&found.results(station)),
        poecal_version: env!("CARGO_PKG_VERSION").to_owned(),
        inputs: own.into_iter().chain(files.filter_map(input)).collect(),
        file,
        by_prior,
        ..LedgerRow::default()
    }
}

fn refused_row(row: LedgerRow, sentence: String) -> LedgerRow {
    LedgerRow { exit: REFUSED, reason: Some(sentence), ..row }
}

/// Calibrates a robot by a process of its own.
fn calibrate_robot(station: &Station, found: &InboxFile, row: LedgerRow, prior: &[OsString]) -> LedgerRow {
    if let Some(fault) = found.fault() {
        return refused_row(row, fault);
    }
    let Some(model) = found.model(station) else {
        let message = format!("found a robot of type `{}`, expected one that `models` names", found.of_type);
        return refused_row(row, message);
    };
    let results = found.results(station);
    if let Some(parent) = results.parent()
        && let Err(error) = poecal_storage::disk::create_folders(parent)
    {
        return refused_row(row, format!("the folder of the results cannot be made ({error})"));
    }
    let mut words: Vec<OsString> = vec!["calibrate".into(), model.into(), found.path.clone().into()];
    words.extend(["--out".into(), results.clone().into_os_string()]);
    // A process of a killed fleet run may still be at work on this robot.
    words.extend(["--force", "--quiet", "--threads", "1", "--wait", "120s"].map(OsString::from));
    words.extend(limits::list_changed().into_iter().map(|it| format!("--limit={it}").into()));
    if let Some(settings) = &station.settings {
        words.extend(["--settings".into(), settings.clone().into_os_string()]);
    }
    if !station.accept.is_empty() {
        words.extend(["--accept".into(), OsString::from(station.accept.join(","))]);
    }
    if row.by_prior {
        words.extend(prior.iter().cloned());
    }
    let (code, said) = run_program(words);
    let sentence = || {
        // The path as in the ledger, independent of the current folder.
        let said = said.replace(&found.path.display().to_string(), &row.file);
        let line = said.lines().rev().find_map(|line| line.strip_prefix("error: "));
        line.map_or_else(|| format!("the calibration ended with code {code}"), str::to_owned)
    };
    if code > 1 {
        return LedgerRow { exit: code, reason: Some(sentence()), ..row };
    }
    match CalibrationFile::read(results.join("calibration.json")) {
        Ok(file) => LedgerRow { exit: code, ..row.with_findings(&file) },
        Err(error) => LedgerRow { exit: 3, reason: Some(error.to_string()), ..row },
    }
}

/// Runs the program with these words, and returns its code and its error messages. Within another program, such as Python, it runs in this process.
fn run_program(words: Vec<OsString>) -> (u8, String) {
    let own = std::env::current_exe().ok();
    let is_own = own.as_ref().and_then(|it| it.file_stem()?.to_str()).is_some_and(|stem| stem.starts_with("poecal"));
    if let (Some(own), true) = (own, is_own) {
        let done = Command::new(own).args(&words).stdin(Stdio::null()).stdout(Stdio::null()).output();
        return match done {
            Ok(done) => {
                let code = done.status.code().and_then(|code| u8::try_from(code).ok()).unwrap_or(3);
                (code, String::from_utf8_lossy(&done.stderr).into_owned())
            }
            Err(error) => (3, format!("error: the program cannot be started ({error})")),
        };
    }
    let typed = std::iter::once(OsString::from("poecal")).chain(words);
    let said = crate::run_captured(typed);
    (said.code, said.err)
}

/// Rows of the named ledgers, or of the station's.
fn rows(station: &Station, ledgers: &[PathBuf]) -> Result<Vec<LedgerRow>> {
    if ledgers.is_empty() { read_ledgers(std::slice::from_ref(&station.ledger)) } else { read_ledgers(ledgers) }
}

fn report_of(options: &FleetReport, console: &Console) -> Result<u8> {
    let station = Station::read(&options.station)?;
    let page = options.out.clone().unwrap_or_else(|| options.station.with_file_name("fleet.html"));
    let table = page.with_extension("csv");
    let existing = ExistingFiles::from_switch(options.force);
    let inputs = [options.station.as_path(), station.ledger.as_path()];
    let place = ReservedFile::reserve(&page, existing, &inputs, &mut console.warner())?;
    let beside = ReservedFile::reserve(&table, existing, &inputs, &mut console.warner())?;
    let mut rows = rows(&station, &options.ledger)?;
    // Links of the page are from its folder.
    let folder = page.parent().unwrap_or(Path::new(""));
    for row in &mut rows {
        let results = &station.folder.join(&row.results);
        let from_here = results.strip_prefix(folder).map(Path::to_owned);
        row.results = from_here.unwrap_or_else(|_| canonical_path(results)).display().to_string();
    }
    let line = report::FleetLine::from_rows(rows, station.reference.as_deref(), &station.limits)
        .map_err(|error| error.in_file(&station.path))?;
    place.write(report::fleet_page(&line))?;
    beside.write(vec![line.csv().into()])?;
    console.say(&line.text())?;
    Ok(DONE)
}

fn prior_of(options: &FleetPrior, console: &Console) -> Result<u8> {
    let station = Station::read(&options.station)?;
    let rows = rows(&station, &options.ledger)?;
    console.data(&report::fleet_prior(&rows, LEDGER)?)?;
    Ok(DONE)
}
