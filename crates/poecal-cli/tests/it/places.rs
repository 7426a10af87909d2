//! Output places of the program: files of others are never harmed, whatever exists there and whoever writes at the same time.

use std::fs;
use std::os::unix::fs::{FileTypeExt as _, symlink};
use std::process::{Child, Command, Stdio};

use poecal_model::simulate::SessionKind;

use crate::folder::Folder;
use crate::session::session;

/// A folder with a model, measurements, joints and the results of a calibration.
fn folder_with_calibration() -> Folder {
    let folder = session(SessionKind::POINT);
    folder.run_to_success("calibrate robot.urdf measurements.csv --out out");
    folder
}

/// Refused: nothing has changed, and the sentence holds these words.
fn assert_refused(folder: &Folder, arguments: &str, words: &str) {
    let before = folder.listing();
    let run = folder.run(arguments);
    assert_eq!(run.code, 2, "poecal {arguments}\n{}{}", run.out, run.err);
    assert!(run.err.contains(words), "poecal {arguments}\n{}", run.err);
    assert_eq!(run.err.lines().filter(|line| line.starts_with("error:")).count(), 1, "{}", run.err);
    assert!(folder.listing() == before, "poecal {arguments} changed something");
}

#[test]
fn a_file_that_exists_is_replaced_only_with_force() {
    let folder = folder_with_calibration();
    folder.write("mine.txt", "mine");
    for command in [
        "export robot.urdf --format toml --out mine.txt",
        "predict out/calibration.json measurements.csv --out mine.txt",
        "offsets robot.urdf out/calibration.json --out mine.txt",
        "report out/calibration.json --out mine.txt",
        "calibrate robot.urdf measurements.csv --out new --report mine.txt",
    ] {
        assert_refused(
            &folder,
            command,
            "mine.txt: found this file, expected none: choose another, or write over this one with --force",
        );
        folder.run_to_success(&format!("{command} --force"));
        assert_ne!(folder.read("mine.txt"), "mine", "{command}");
        folder.write("mine.txt", "mine");
    }
    // A report is renewed without, here and elsewhere; another page is not.
    folder.run_to_success("report out/calibration.json");
    folder.run_to_success("report out/calibration.json --out page.html");
    folder.run_to_success("report out/calibration.json --out page.html");
    folder.write("out/report.html", "<!DOCTYPE html><title>mine</title>");
    assert_refused(&folder, "report out/calibration.json", "out/report.html: found this file");
}

#[test]
fn an_input_is_never_replaced() {
    let folder = folder_with_calibration();
    fs::hard_link(folder.path("measurements.csv"), folder.path("second_name.html")).unwrap();
    symlink("robot.urdf", folder.path("link.urdf")).unwrap();
    let words = "found a file that this run reads (";
    for command in [
        "export robot.urdf --format toml --out robot.urdf --force",
        "export robot.urdf --format toml --out link.urdf --force",
        "predict out/calibration.json measurements.csv --out measurements.csv --force",
        "offsets robot.urdf out/calibration.json --out out/../out/calibration.json --force",
        "report out/calibration.json --out out/residuals.csv --force",
        "calibrate robot.urdf measurements.csv --out out --force --report measurements.csv",
        "calibrate robot.urdf measurements.csv --out out --force --report second_name.html",
        // The earlier results would be removed, and with them the model.
        "calibrate out/calibrated.urdf measurements.csv --out out --force",
        "calibrate out/calibration.json measurements.csv --out out --force --report none",
    ] {
        assert_refused(&folder, command, words);
    }
    folder.run_to_success("simulate robot.urdf --out sim");
    assert_refused(&folder, "simulate sim/actual.urdf --out sim --force", words);
}

#[test]
fn what_is_no_regular_file_is_written_to_and_stays() {
    let folder = folder_with_calibration();
    folder.run_to_success("calibrate robot.urdf measurements.csv --out new --report /dev/null");
    assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
    let text = folder.run_to_success("export robot.urdf --format toml");
    assert_eq!(folder.run_to_success("export robot.urdf --format toml --out /dev/stdout"), text);
    assert_eq!(folder.run_to_success("export robot.urdf --format toml --out -"), text);
    // Standard output that goes into a file is not written from its beginning.
    let into = fs::File::create(folder.path("kept.txt")).unwrap();
    (&into).write_all_text("before\n");
    folder.run_into("export robot.urdf --format toml --out /dev/stdout", into);
    assert_eq!(folder.read("kept.txt"), format!("before\n{text}"));
    // A pipe.
    let pipe = folder.path("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || fs::read_to_string(pipe).unwrap()
    });
    folder.run_to_success("export robot.urdf --format toml --out pipe");
    assert_eq!(reader.join().unwrap(), text);
    assert!(fs::metadata(&pipe).unwrap().file_type().is_fifo());
    fs::remove_file(&pipe).unwrap();
    // A device that is full: nothing is written elsewhere either.
    assert_refused(
        &folder,
        "calibrate robot.urdf measurements.csv --out other --report /dev/full",
        "/dev/full: the file cannot be written",
    );
    assert_refused(
        &folder,
        "calibrate robot.urdf measurements.csv --out /dev/null --force",
        "/dev/null: found a file, expected a folder",
    );
}

/// Text into an open file.
trait WriteText {
    fn write_all_text(self, text: &str);
}

impl WriteText for &fs::File {
    fn write_all_text(mut self, text: &str) {
        std::io::Write::write_all(&mut self, text.as_bytes()).unwrap();
    }
}

#[test]
fn links_are_followed_or_refused() {
    let folder = folder_with_calibration();
    folder.write("real.toml", "old");
    symlink("real.toml", folder.path("link.toml")).unwrap();
    assert_refused(&folder, "export robot.urdf --out link.toml", "link.toml: found this file");
    folder.run_to_success("export robot.urdf --out link.toml --force");
    assert!(fs::symlink_metadata(folder.path("link.toml")).unwrap().is_symlink());
    assert!(folder.read("real.toml").contains("poecal_robot"));
    fs::remove_file(folder.path("link.toml")).unwrap();
    symlink("nowhere", folder.path("broken.toml")).unwrap();
    let run = folder.run("export robot.urdf --out broken.toml --force");
    assert!(run.code == 2 && run.err.contains("broken.toml: found a link that leads nowhere"), "{}", run.err);
    let run = folder.run("calibrate robot.urdf measurements.csv --out broken.toml --force");
    assert!(run.code == 2 && run.err.contains("broken.toml: found a link that leads nowhere"), "{}", run.err);
    fs::remove_file(folder.path("broken.toml")).unwrap();
    // A folder by a link; and a link among the results.
    symlink("out", folder.path("results")).unwrap();
    folder.run_to_success("calibrate robot.urdf measurements.csv --out results --force");
    assert!(fs::symlink_metadata(folder.path("results")).unwrap().is_symlink());
    fs::remove_file(folder.path("results")).unwrap();
    fs::remove_file(folder.path("out/report.html")).unwrap();
    symlink("../robot.urdf", folder.path("out/report.html")).unwrap();
    assert_refused(&folder, "calibrate robot.urdf measurements.csv --out out --force", "out/report.html: found a link");
}

#[test]
fn others_files_stay_and_the_mode_of_the_folder_too() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = folder_with_calibration();
    let mode = |folder: &Folder| fs::metadata(folder.path("out")).unwrap().permissions().mode();
    fs::set_permissions(folder.path("out"), fs::Permissions::from_mode(0o2750)).unwrap();
    let before = mode(&folder);
    let calibrate = "calibrate robot.urdf measurements.csv --out out --force --held-out 0.2";
    folder.run_to_success(calibrate);
    assert_eq!(mode(&folder), before);
    folder.write("out/notes.txt", "mine");
    fs::create_dir(folder.path("out/photos")).unwrap();
    folder.write("out/photos/1.jpg", "mine");
    folder.run_to_success(calibrate);
    assert_eq!((folder.read("out/notes.txt"), folder.read("out/photos/1.jpg")), ("mine".into(), "mine".into()));
    // An empty folder, as a container's mount is, needs no --force; one with a file of others does.
    fs::create_dir(folder.path("empty")).unwrap();
    folder.run_to_success("calibrate robot.urdf measurements.csv --out empty");
    fs::create_dir(folder.path("theirs")).unwrap();
    folder.write("theirs/notes.txt", "mine");
    assert_refused(&folder, "calibrate robot.urdf measurements.csv --out theirs", "theirs: the output folder exists");
}

#[test]
fn what_an_interrupted_run_left_is_settled_and_said() {
    let folder = folder_with_calibration();
    let results = folder.read("out/calibration.json");
    // Killed while writing.
    fs::create_dir_all(folder.path("out/.poecal-unfinished-77-0/new")).unwrap();
    folder.write("out/.poecal-unfinished-77-0/new/calibration.json", "{");
    folder.write("out/.poecal-unfinished-77-0/lock", "");
    fs::create_dir_all(folder.path(".out.poecal-unfinished-78-3/new")).unwrap();
    folder.write(".out.poecal-unfinished-78-3/new/residuals.csv", "half");
    // Not a folder of poecal, in spite of its name.
    fs::create_dir_all(folder.path("out/.poecal-unfinished-of-mine")).unwrap();
    let run = folder.run("calibrate robot.urdf measurements.csv --out out");
    assert_eq!(run.code, 2, "{}", run.err);
    assert_eq!(run.err.matches("removed what an interrupted run left").count(), 2);
    let run = folder.run("calibrate robot.urdf measurements.csv --out out --force");
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(
        !folder.path(".out.poecal-unfinished-78-3").exists() && !folder.path("out/.poecal-unfinished-77-0").exists()
    );
    assert!(folder.path("out/.poecal-unfinished-of-mine").exists());
    // Killed while files were put in place: the next run completes it, even one that is refused.
    let unfinished = "out/.poecal-unfinished-79-0";
    fs::create_dir_all(folder.path(unfinished).join("new")).unwrap();
    folder.write(&format!("{unfinished}/new/residuals.csv"), "new");
    fs::create_dir_all(folder.path(unfinished).join("old")).unwrap();
    for name in ["residuals.csv", "report.html"] {
        fs::hard_link(folder.path("out").join(name), folder.path(unfinished).join("old").join(name)).unwrap();
    }
    folder.write(
        &format!("{unfinished}/journal"),
        "poecal-journal-1\nput calibration.json\nput residuals.csv\nremove report.html\nend\n",
    );
    let run = folder.run("calibrate robot.urdf measurements.csv --out out");
    assert_eq!(run.code, 2);
    assert_eq!(folder.read("out/residuals.csv"), "new");
    assert_eq!(folder.read("out/calibration.json"), results);
    assert!(!folder.path("out/report.html").exists() && !folder.path(unfinished).exists());
    // A journal that leads elsewhere is no journal.
    fs::create_dir_all(folder.path(unfinished).join("new")).unwrap();
    folder.write(&format!("{unfinished}/journal"), "poecal-journal-1\nremove ../robot.urdf\nend\n");
    let run = folder.run("calibrate robot.urdf measurements.csv --out out --force");
    assert!(run.code == 0 && run.err.contains("it cannot be settled"), "{}", run.err);
    assert!(folder.path("robot.urdf").exists());
}

#[test]
fn what_somebody_planted_leads_nowhere() {
    let folder = folder_with_calibration();
    fs::create_dir(folder.path("victim")).unwrap();
    folder.write("victim/calibration.json", "theirs");
    folder.write("victim/thesis.tex", "theirs");
    folder.write("out/thesis.tex", "mine");
    // Links in place of the remains of a run, inside and beside, for a folder and for a file.
    for unfinished in ["out/.poecal-unfinished-1-0", ".out.poecal-unfinished-1-0", ".new.toml.poecal-unfinished-1-0"] {
        fs::create_dir_all(folder.path(unfinished)).unwrap();
        symlink(folder.path("victim"), folder.path(unfinished).join("new")).unwrap();
        symlink(folder.path("victim/made"), folder.path(unfinished).join("lock")).unwrap();
    }
    symlink(folder.path("victim"), folder.path("out/.poecal-unfinished-2-0")).unwrap();
    // A journal of files that no run writes.
    fs::create_dir_all(folder.path("out/.poecal-unfinished-3-0/new")).unwrap();
    folder.write("out/.poecal-unfinished-3-0/journal", "poecal-journal-1\nremove thesis.tex\nend\n");
    folder.run("calibrate robot.urdf measurements.csv --out out");
    folder.run_to_success("calibrate robot.urdf measurements.csv --out out --force");
    folder.run_to_success("export robot.urdf --out new.toml");
    let names: Vec<_> = fs::read_dir(folder.path("victim")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(names.len(), 2, "{names:?}");
    assert_eq!(
        (folder.read("victim/calibration.json"), folder.read("out/thesis.tex")),
        ("theirs".into(), "mine".into())
    );
}

#[test]
fn what_was_changed_since_an_interrupted_run_stays() {
    let folder = folder_with_calibration();
    let unfinished = "out/.poecal-unfinished-79-0";
    for half in ["new", "old"] {
        fs::create_dir_all(folder.path(unfinished).join(half)).unwrap();
    }
    for name in ["calibration.json", "residuals.csv"] {
        fs::hard_link(folder.path("out").join(name), folder.path(unfinished).join("old").join(name)).unwrap();
        folder.write(&format!("{unfinished}/new/{name}"), "new");
    }
    let text =
        "poecal-journal-1\nput calibration.json\nput residuals.csv\nadd calibrated.toml\nremove report.html\nend\n";
    folder.write(&format!("{unfinished}/journal"), text);
    folder.write(&format!("{unfinished}/new/calibrated.toml"), "new");
    // A backup was put back, a model made by hand, and a report written anew.
    fs::remove_file(folder.path("out/calibration.json")).unwrap();
    folder.write("out/calibration.json", "a backup");
    folder.write("out/calibrated.toml", "by hand");
    folder.run("calibrate robot.urdf measurements.csv --out out");
    assert_eq!(folder.read("out/calibration.json"), "a backup");
    assert_eq!(folder.read("out/calibrated.toml"), "by hand");
    assert_eq!(folder.read("out/residuals.csv"), "new");
    assert!(folder.path("out/report.html").exists() && !folder.path(unfinished).exists());
}

#[test]
fn a_report_named_inside_the_results_is_one_of_them() {
    let folder = folder_with_calibration();
    let calibrate = "calibrate robot.urdf measurements.csv --out out --force --report";
    folder.run_to_success(&format!("{calibrate} out/report.html"));
    assert!(folder.read("out/report.html").contains("<!DOCTYPE html>"));
    folder.run_to_success(&format!("{calibrate} ./out/../out/page.html"));
    assert!(folder.path("out/page.html").exists() && !folder.path("out/report.html").exists());
    assert_refused(&folder, &format!("{calibrate} out/calibration.json"), "found the place of another result");
    assert_refused(&folder, &format!("{calibrate} out"), "found the folder of the results");
    assert_refused(
        &folder,
        "calibrate robot.urdf measurements.csv --out x --report x",
        "found the folder of the results",
    );
    folder.run_to_success("calibrate robot.urdf measurements.csv --out y --report y/report.html");
    assert!(folder.path("y/report.html").exists());
}

#[test]
fn results_are_there_when_nobody_can_be_told() {
    let folder = session(SessionKind::POINT);
    let full = || fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    for more in ["", " --json"] {
        let run = folder.run_into(&format!("calibrate robot.urdf measurements.csv --out out --force{more}"), full());
        assert_eq!(run.code, 1, "{}", run.err);
        assert!(run.err.contains("; what was to be written is in out"), "{}", run.err);
        assert!(folder.path("out/calibration.json").exists());
    }
}

/// Two runs at once; their exit codes, sorted, and their messages.
fn at_once(folder: &Folder, commands: [&str; 2]) -> (Vec<i32>, String) {
    let start = |arguments: &str| -> Child {
        let mut command = Command::new(env!("CARGO_BIN_EXE_poecal"));
        command.args(arguments.split_whitespace()).current_dir(folder.path("."));
        command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
    };
    let outputs = commands.map(start).map(|child| child.wait_with_output().unwrap());
    let mut codes: Vec<i32> = outputs.iter().map(|output| output.status.code().unwrap()).collect();
    codes.sort_unstable();
    (codes, outputs.iter().map(|output| String::from_utf8_lossy(&output.stderr)).collect())
}

#[test]
fn of_two_writers_one_wins_and_results_are_never_mixed() {
    let folder = session(SessionKind::POINT);
    let (one, other) =
        ("calibrate robot.urdf measurements.csv --seed 1", "calibrate robot.urdf measurements.csv --seed 2");
    let mut whole = Vec::new();
    for (command, out) in [(one, "a"), (other, "b")] {
        folder.run_to_success(&format!("{command} --out {out}"));
        whole.push(["calibration.json", "residuals.csv"].map(|name| folder.read(&format!("{out}/{name}"))));
    }
    let read = |out: &str| ["calibration.json", "residuals.csv"].map(|name| folder.read(&format!("{out}/{name}")));
    for round in 0..20 {
        let out = format!("new{round}");
        let (codes, said) = at_once(&folder, [&format!("{one} --out {out}"), &format!("{other} --out {out}")]);
        assert_eq!(codes, [0, 2], "{said}");
        assert!(said.contains("the output folder exists") || said.contains("found the folder in use by"), "{said}");
        assert!(whole.contains(&read(&out)), "mixed");
        fs::remove_dir_all(folder.path(&out)).unwrap();
    }
    for mine in [false, true] {
        let (one, other) = (format!("{one} --out both --force"), format!("{other} --out both --force"));
        for _ in 0..20 {
            let (codes, said) = at_once(&folder, [&one, &other]);
            assert_eq!(codes.first(), Some(&0), "{said}");
            assert!(whole.contains(&read("both")), "mixed");
        }
        if !mine {
            folder.write("both/notes.txt", "mine");
        }
    }
    assert_eq!(folder.read("both/notes.txt"), "mine");
    let left: Vec<_> =
        folder.listing().into_keys().filter(|path| path.to_string_lossy().contains("unfinished")).collect();
    assert!(left.is_empty(), "{left:?}");
}

/// True if this process ignores a signal, as under `nohup` or behind a shell's `&`: so does then the program.
fn is_ignored(number: u32) -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| (mask >> (number - 1)) & 1 == 1)
}

#[test]
fn a_signal_cleans_up() {
    let folder = session(SessionKind::POINT);
    for (signal, number) in [("INT", 2), ("TERM", 15), ("HUP", 1)] {
        if is_ignored(number) {
            println!("SIG{signal} is ignored here, and not sent");
            continue;
        }
        let mut command = Command::new(env!("CARGO_BIN_EXE_poecal"));
        command.args("reproduce lou2009 --trials 100000 --out paper".split_whitespace()).current_dir(folder.path("."));
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let has_begun = || {
            let names = fs::read_dir(folder.path(".")).unwrap().map(|entry| entry.unwrap().file_name());
            names.into_iter().any(|name| name.to_string_lossy().starts_with(".paper.poecal-unfinished-"))
        };
        while !has_begun() {
            assert!(child.try_wait().unwrap().is_none(), "it ended too soon");
            std::thread::yield_now();
        }
        let sent = Command::new("kill").args(["-s", signal, &child.id().to_string()]).status().unwrap();
        assert!(sent.success());
        let output = child.wait_with_output().unwrap();
        assert!(output.status.code().is_none() && output.stderr.is_empty(), "{output:?}");
        assert!(!has_begun(), "{signal} left something");
        assert!(!folder.path("paper").exists());
    }
}

#[test]
fn settings_lead_nowhere_else_and_let_only_results_go() {
    let folder = session(SessionKind::POINT);
    fs::create_dir(folder.path("cell")).unwrap();
    fs::create_dir(folder.path("outside")).unwrap();
    symlink("../outside", folder.path("cell/link")).unwrap();
    let settings = |lines: &str| {
        let text =
            format!("poecal_settings = 1\nmodel = '../robot.urdf'\nmeasurements = ['../measurements.csv']\n{lines}\n");
        folder.write("cell/poecal.toml", text);
    };
    let absolute = folder.path("outside/x");
    for (line, key) in [
        ("out = '../outside/x'".to_owned(), "out"),
        (format!("out = '{}'", absolute.display()), "out"),
        ("out = 'link/x'".to_owned(), "out"),
        ("out = 'link'\nforce = true".to_owned(), "out"),
        ("report = '../page.html'".to_owned(), "report"),
    ] {
        settings(&line);
        assert_refused(
            &folder,
            "calibrate --settings cell/poecal.toml",
            &format!("cell/poecal.toml:4:{}: found the place `", key.len() + 4),
        );
    }
    settings("out = '../outside/x'");
    folder.run_to_success("calibrate --settings cell/poecal.toml --out typed");
    // Settings are an input, read by default or not.
    folder.write("poecal.toml", "poecal_settings = 1\nmodel = 'robot.urdf'\nmeasurements = ['measurements.csv']\n");
    assert_refused(
        &folder,
        "calibrate --out by_default --report poecal.toml --force",
        "found a file that this run reads",
    );
    // Only a typed option lets a folder of others be replaced.
    fs::create_dir(folder.path("cell/results")).unwrap();
    folder.write("cell/results/report.html", "mine");
    settings("out = 'results'\nforce = true");
    assert_refused(
        &folder,
        "calibrate --settings cell/poecal.toml",
        "cell/results: found a folder without results of poecal",
    );
    folder.run_to_success("calibrate --settings cell/poecal.toml --force");
    folder.run_to_success("calibrate --settings cell/poecal.toml");
    // The recorded command does not contain it.
    assert!(!folder.read("cell/results/calibration.json").contains("--force"));
    folder.write("cell/page.html", "mine");
    settings("out = 'results'\nforce = true\nreport = 'page.html'");
    assert_refused(&folder, "calibrate --settings cell/poecal.toml", "cell/page.html: found this file");
}
