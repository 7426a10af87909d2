//! The report: its output place, and its reconstruction from its files.

use poecal_model::simulate::{SessionKind, Simulation};

use crate::folder::Folder;
use crate::session::{calibration, session, write_measurements};

#[test]
fn calibrate_writes_the_report_where_it_is_asked_to() {
    let folder = session(SessionKind::POINT);
    let out = folder.run_to_success("calibrate robot.urdf measurements.csv");
    assert!(out.ends_with("poecal-out: open report.html; 3 files beside it\n"), "{out}");
    let page = folder.read("poecal-out/report.html");
    let out = folder.run_to_success("calibrate robot.urdf measurements.csv --out other --report page.html");
    assert!(out.ends_with("report        page.html\n") && !folder.path("other/report.html").exists(), "{out}");
    assert!(folder.read("page.html") == page, "another place is another page");
    let out = folder.run_to_success("calibrate robot.urdf measurements.csv --force --report none");
    assert!(!out.contains("report"), "{out}");
    assert!(!folder.path("poecal-out/report.html").exists(), "an old report stands beside new results");
    let run = folder.run("calibrate robot.urdf measurements.csv --out new --report missing/page.html");
    assert!(run.code == 2 && run.err.contains("the folder above does not exist"), "{}", run.err);
    assert!(!folder.path("new").exists());
}

#[test]
fn the_report_made_again_is_the_same() {
    let folder = session(SessionKind::MIXED);
    write_measurements(
        &folder,
        "other.csv",
        SessionKind::POINT,
        "mirror",
        &Simulation { count: 60, ..Simulation::default() },
    );
    folder.run_to_success("calibrate robot.urdf measurements.csv --robust huber");
    folder.run_to_success("calibrate robot.urdf other.csv --out targets");
    for out in ["poecal-out", "targets"] {
        let page = folder.read(&format!("{out}/report.html"));
        folder.run_to_success(&format!("report {out}/calibration.json -o again.html"));
        assert!(folder.read("again.html") == page, "{out}");
        folder.write(&format!("{out}/report.html"), "<meta name=\"generator\" content=\"poecal 0.0.9\">old");
        folder.run_to_success(&format!("report {out}/calibration.json"));
        assert!(folder.read(&format!("{out}/report.html")) == page, "{out}");
    }
    let words = "report poecal-out/calibration.json --residuals targets/residuals.csv -o third.html";
    let run = folder.run(words);
    assert!(run.code == 2 && run.err.contains("targets/residuals.csv: found residuals of"), "{}", run.err);
}

#[test]
fn a_report_states_the_session() {
    let folder = session(SessionKind::POINT);
    folder.run_to_success("calibrate robot.urdf measurements.csv --record serial=4711 --record operator=Walburga");
    folder.run_to_success("report poecal-out/calibration.json --record operator=Quirin -o page.html");
    let page = folder.read("page.html");
    assert!(page.contains("4711") && page.contains(">Quirin<") && !page.contains(">Walburga<"));
    let run = folder.run("report poecal-out/calibration.json --record colour=red -o other.html");
    assert!(run.code == 2 && !folder.path("other.html").exists(), "{}", run.err);
}

#[test]
fn the_file_names_what_it_was_made_of_and_how() {
    let folder = session(SessionKind::POINT);
    folder.run_to_success("calibrate robot.urdf measurements.csv --threads 1 --out a --held-out=0.2 --report none");
    let inputs = calibration(&folder, "a").inputs;
    assert_eq!(inputs.command.as_deref(), Some("poecal calibrate robot.urdf measurements.csv --held-out=0.2"));
    let names: Vec<&str> = inputs.sha256.keys().map(String::as_str).collect();
    assert_eq!(names, ["measurements.csv", "robot.urdf"]);
    let hash = &inputs.sha256["robot.urdf"];
    assert!(hash.len() == 64 && hash.chars().all(|c| c.is_ascii_hexdigit()), "{hash}");
}

#[cfg(unix)]
#[test]
fn what_comes_through_a_pipe_has_its_own_checksum_or_none() {
    let folder = session(SessionKind::POINT);
    folder.run_to_success("calibrate robot.urdf measurements.csv --out files --report none");
    let files = calibration(&folder, "files").inputs.sha256;
    for (words, piped) in [
        ("calibrate robot.urdf /dev/stdin --out measurements --report none", "measurements.csv"),
        ("calibrate /dev/stdin measurements.csv --out model --report none", "robot.urdf"),
    ] {
        let run = folder.run_with_input(words, &folder.read(piped));
        assert_eq!(run.code, 0, "{}", run.err);
    }
    // Measurements are hashed as they are read; a model would have to be read again.
    assert_eq!(calibration(&folder, "measurements").inputs.sha256["/dev/stdin"], files["measurements.csv"]);
    let names: Vec<String> = calibration(&folder, "model").inputs.sha256.into_keys().collect();
    assert_eq!(names, ["measurements.csv"]);
}

#[test]
fn mistakes_are_told() {
    let folder: Folder = session(SessionKind::POINT);
    folder.run_to_success("calibrate robot.urdf measurements.csv");
    for (words, expected) in [
        ("report missing.json", "missing.json: found no such file"),
        (
            "report poecal-out/calibration.json --residuals measurements.csv",
            "measurements.csv:1:1: found the column `id`, expected `file`",
        ),
        ("report poecal-out/calibration.json -o missing/page.html", "the folder above does not exist"),
        ("report robot.urdf", "robot.urdf: found a URDF, expected a calibration"),
    ] {
        let run = folder.run(words);
        assert!(run.code == 2 && run.err.contains(expected), "{words}: {}", run.err);
    }
}
