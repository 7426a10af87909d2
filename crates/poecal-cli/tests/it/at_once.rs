//! Two runs that write to one place, folders with other files, and files that change.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use crate::folder::{Folder, Run};
use crate::session::ROBOT;

/// A station with some robots.
fn line(count: usize) -> Folder {
    let folder = Folder::new();
    folder.write("robot.urdf", ROBOT);
    folder.write(
        "station.toml",
        "poecal_station = 1\ninbox = \"inbox/{serial}.csv\"\nresults = \"results/{serial}\"\nmodel = \"robot.urdf\"\n",
    );
    fs::create_dir(folder.path("inbox")).unwrap();
    for robot in 0..count {
        folder.run_to_success(&format!("simulate robot.urdf --kind point --count 30 --seed {robot} --out made{robot}"));
        folder.write(&format!("inbox/SN{robot}.csv"), folder.read(&format!("made{robot}/measurements.csv")));
    }
    folder
}

fn start_run(folder: &Folder, words: &str) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_poecal"));
    command.args(words.split_whitespace()).current_dir(folder.root_path());
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

fn end_run(child: Child) -> Run {
    Run::new(child.wait_with_output().unwrap())
}

/// A lock as another run holds it, until it is dropped.
fn hold_lock(path: &Path, holder: &str) -> fs::File {
    fs::write(path, holder).unwrap();
    let file = fs::OpenOptions::new().read(true).write(true).open(path).unwrap();
    file.lock().unwrap();
    file
}

#[test]
fn the_second_run_names_the_first_or_waits_for_it() {
    let folder = line(1);
    folder.run("calibrate robot.urdf made0/measurements.csv --out out");
    for (lock, words, what) in [
        (".fleet.jsonl.poecal-lock", "fleet station.toml", "the ledger"),
        (".out.poecal-lock", "calibrate robot.urdf made0/measurements.csv --out out --force", "the folder"),
        (".new.poecal-lock", "calibrate robot.urdf made0/measurements.csv --out new", "the folder"),
    ] {
        let path = folder.path(lock);
        let lock = hold_lock(&path, "process 7 on line3");
        let before = folder.listing();
        let run = folder.run(words);
        let part = format!("found {what} in use by process 7 on line3, expected one run at a time");
        assert!(run.code == 2 && run.err.contains(&part), "{words}: {}{}", run.out, run.err);
        assert_eq!(folder.listing(), before);
        let waiting = start_run(&folder, &format!("{words} --wait 60s"));
        std::thread::sleep(Duration::from_millis(300));
        fs::write(&path, "").unwrap();
        drop(lock);
        let run = end_run(waiting);
        assert_eq!(run.code, 0, "{words}: {}{}", run.out, run.err);
        assert!(!path.exists());
    }
}

#[test]
fn the_lock_of_a_killed_run_is_taken_over_with_a_line() {
    let folder = line(1);
    folder.write(".fleet.jsonl.poecal-lock", "process 7 on line3");
    let run = folder.run("fleet station.toml");
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(run.err.contains("took over the lock of the ledger: process 7 on line3 was killed"), "{}", run.err);
    assert!(!folder.path(".fleet.jsonl.poecal-lock").exists());
}

/// With two runs at once each robot is calibrated once, and each check is in the history.
#[test]
fn nothing_is_lost_and_nothing_twice() {
    let folder = line(2);
    let both =
        [start_run(&folder, "fleet station.toml --wait 60s"), start_run(&folder, "fleet station.toml --wait 60s")];
    let both = both.map(end_run);
    assert_eq!(both.each_ref().map(|run| run.code), [0, 0], "{both:?}");
    assert_eq!(folder.read("fleet.jsonl").lines().count(), 2);
    let visits = [1, 2].map(|at| format!("made{at}"));
    for (at, visit) in visits.iter().enumerate() {
        if !folder.path(visit).exists() {
            folder.run_to_success(&format!(
                "simulate robot.urdf --kind point --count 12 --seed {} --out {visit}",
                at + 7
            ));
        }
    }
    let words =
        |visit: &str| format!("validate results/SN0/calibration.json {visit}/measurements.csv --refit device,tool");
    let running: Vec<Child> = [0, 0, 1, 1].iter().map(|at| start_run(&folder, &words(&visits[*at]))).collect();
    for child in running {
        let run = end_run(child);
        assert!(run.code <= 1, "{}{}", run.out, run.err);
    }
    let history = folder.read("results/SN0/history.jsonl");
    assert_eq!(history.lines().count(), 2, "{history}");
}

#[test]
fn nothing_new_and_old_failures_are_said() {
    let folder = line(1);
    folder.write("inbox/SN9.csv", "nothing\n");
    assert_eq!(folder.run("fleet station.toml").code, 1);
    let run = folder.run("fleet station.toml");
    assert_eq!(run.code, 1);
    assert!(run.out.contains("nothing new; 1 robot failed before, with the same files"), "{}", run.out);
}

#[test]
fn a_calibration_of_somebody_else_stays() {
    let folder = line(1);
    for place in ["results/SN0", "out"] {
        fs::create_dir_all(folder.path(place)).unwrap();
        folder.write(&format!("{place}/calibration.json"), "{\"camera\": 1}\n");
    }
    let run = folder.run("calibrate robot.urdf made0/measurements.csv --out out --force");
    assert!(run.code == 2 && run.err.contains("found a file that poecal did not write"), "{}", run.err);
    assert_eq!(folder.run("fleet station.toml").code, 1);
    for place in ["results/SN0", "out"] {
        assert_eq!(folder.read(&format!("{place}/calibration.json")), "{\"camera\": 1}\n");
    }
    assert!(folder.read("fleet.jsonl").contains("found a file that poecal did not write"));
}

/// An object that is no regular file of the inbox is named with the reason. Earlier a pipe was waited for, and a line of a linked file was in the
/// ledger.
#[cfg(unix)]
#[test]
fn an_inbox_has_regular_files() {
    use std::os::unix::ffi::OsStrExt as _;
    use std::os::unix::fs::symlink;
    let folder = line(1);
    folder.write("secret.txt", "password: 12345\n");
    symlink(folder.path("secret.txt"), folder.path("inbox/linked.csv")).unwrap();
    symlink("SN0.csv", folder.path("inbox/same.csv")).unwrap();
    let pipe = Command::new("mkfifo").arg(folder.path("inbox/pipe.csv")).status().unwrap();
    assert!(pipe.success());
    fs::write(folder.path("inbox").join(std::ffi::OsStr::from_bytes(b"\xff.csv")), "x").unwrap();
    let run = folder.run("fleet station.toml");
    // A link within the inbox is taken, and its file is that of another serial number.
    assert_eq!(run.code, 1, "{}{}", run.out, run.err);
    for part in [
        "same : found the same bytes as `inbox/SN0.csv` of SN0",
        "pipe.csv: left out, since it is a pipe, a socket or a device",
        "linked.csv: left out, since it is a link that leads out of the folder",
        "\u{fffd}.csv: left out, since it is a name that is no UTF-8",
    ] {
        assert!(run.err.contains(part), "{part}: {}", run.err);
    }
    let ledger = folder.read("fleet.jsonl");
    assert!(ledger.lines().count() == 2 && !ledger.contains("12345"), "{ledger}");
    let few = folder.run("fleet station.toml --limit files=3");
    assert!(few.code == 2 && few.err.contains("expected at most 3 files (limit `files`)"), "{}", few.err);
    // Pictures and readings of pictures too.
    fs::create_dir(folder.path("pictures")).unwrap();
    let pipe = Command::new("mkfifo").arg(folder.path("pictures/a.png")).status().unwrap();
    assert!(pipe.success());
    let run = folder.run("detect pictures --board chessboard:10x7:27mm");
    assert!(run.code == 2 && run.err.contains("a.png: left out, since it is a pipe"), "{}", run.err);
}

/// A program that writes its log again leaves it missing, empty or cut for a moment.
#[test]
fn a_log_that_is_written_again_is_waited_for() {
    let folder = line(1);
    let text = folder.read("made0/measurements.csv");
    let mut command = Command::new(env!("CARGO_BIN_EXE_poecal"));
    command.args(["watch", "robot.urdf", "log.csv", "--json"]).current_dir(folder.root_path());
    let [out, err] = ["out.jsonl", "err.txt"].map(|name| fs::File::create(folder.path(name)).unwrap());
    let mut child = command.stdout(out).stderr(err).spawn().unwrap();
    let step = || std::thread::sleep(Duration::from_millis(250));
    step();
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    let part = |count: usize| lines[..count].concat();
    // A line that is cut, and a row that is not whole, for a moment.
    let cut = part(10)[..part(10).len() - 4].to_owned();
    for content in [String::new(), part(2), part(8), part(3), String::new(), cut, part(12) + "1,2\n", part(12)] {
        folder.write("log.csv", content);
        step();
    }
    fs::remove_file(folder.path("log.csv")).unwrap();
    step();
    folder.write("log.csv", part(20));
    step();
    folder.write("log.csv", part(lines.len()));
    let rows = lines.iter().filter(|line| !line.starts_with('#')).count() - 1;
    // Each row is a fit: a busy machine takes its time.
    for _ in 0..480 {
        if folder.read("out.jsonl").lines().count() >= rows || child.try_wait().unwrap().is_some() {
            break;
        }
        step();
    }
    assert!(child.try_wait().unwrap().is_none(), "ended by itself: {}", folder.read("err.txt"));
    child.kill().unwrap();
    child.wait().unwrap();
    let (out, err) = (folder.read("out.jsonl"), folder.read("err.txt"));
    assert_eq!(out.lines().count(), rows, "{out}{err}");
    assert!(err.contains("log.csv: waits for its first lines"), "{err}");
    assert!(!err.contains("read again from the first"), "{err}");
    // A lasting fault ends it.
    folder.write("log.csv", part(12) + "1,2\n");
    let run = folder.run("watch robot.urdf log.csv");
    assert!(run.code == 2 && run.err.contains("found 2 cell"), "{}", run.err);
    assert_eq!(folder.run("watch robot.urdf none.csv --batch").code, 2);
}

#[test]
fn a_torn_line_of_a_history_is_set_aside() {
    let folder = line(1);
    folder.run("calibrate robot.urdf made0/measurements.csv --out out");
    let words = "validate out/calibration.json made0/measurements.csv --refit device,tool --history h.jsonl";
    assert!(folder.run(words).code <= 1);
    let whole = folder.read("h.jsonl");
    for (text, count) in
        [(whole[..whole.len() / 2].to_owned(), 1), (format!("{whole}{}", &whole[..40]), 1), ("{".to_owned(), 1)]
    {
        folder.write("h.jsonl", text);
        let run = folder.run(words);
        assert!(run.code <= 1, "{}", run.err);
        let checks = folder.read("h.jsonl");
        let own = checks.lines().filter(|line| line.ends_with('}')).count();
        assert_eq!(own, count, "{checks}");
    }
    // A file of another program is no history.
    for text in ["{\"a\": 1}", "hello", "{\"a\": 1}\n{"] {
        folder.write("h.jsonl", text);
        assert_eq!(folder.run(words).code, 2, "{text}");
        assert_eq!(folder.read("h.jsonl"), text);
    }
}

/// Help that cannot be printed is no help.
#[cfg(target_os = "linux")]
#[test]
fn help_to_a_full_disk_is_an_error() {
    let folder = Folder::new();
    for words in ["--help", "calibrate --help", "--version"] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let run = folder.run_into(words, full);
        assert!(run.code == 2 && run.err.contains("standard output cannot be written to"), "{words}: {}", run.err);
        assert_eq!(folder.run(words).code, 0);
    }
}
