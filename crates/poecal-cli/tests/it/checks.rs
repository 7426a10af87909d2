//! Results of `poecal validate`: the record and report of a repeat measurement, and the history of checks.

use poecal_model::simulate::{SessionKind, Simulation};
use serde_json::Value;

use crate::folder::Folder;
use crate::session::{session, write_measurements};

/// A calibration in `poecal-out`, and other sessions of the same robot.
fn folder_with_checks() -> Folder {
    let folder = session(SessionKind::POINT);
    folder.run_to_success("calibrate robot.urdf measurements.csv");
    // The same robot and device, in configurations that follow those of the calibration.
    write_measurements(&folder, "all.csv", SessionKind::POINT, "", &Simulation { count: 160, ..Simulation::default() });
    let all = folder.read("all.csv");
    for (name, first) in [("spring.csv", 61), ("autumn.csv", 101)] {
        let is_of = |(line, _): &(usize, &str)| *line == 0 || (first..first + 40).contains(line);
        let rows: Vec<&str> = all.lines().enumerate().filter(is_of).map(|(_, line)| line).collect();
        folder.write(name, rows.join("\n"));
    }
    folder
}

fn history(folder: &Folder, name: &str) -> Vec<Value> {
    folder.read(name).lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn a_repeat_measurement_has_its_own_record_and_report() {
    let folder = folder_with_checks();
    let command = "validate poecal-out/calibration.json spring.csv --refit device --out spring --record operator=Mia --record serial=4711";
    let out = folder.run_to_success(command);
    println!("{out}");
    assert!(out.starts_with("verdict       the calibration "), "{out}");
    assert!(out.contains("written       spring\n") && out.contains("validation.json, errors.csv, report.html"));
    let found: Value = serde_json::from_str(&folder.read("spring/validation.json")).unwrap();
    assert_eq!((&found["schema"], &found["count"]), (&"poecal-validation-1".into(), &40.into()));
    assert_eq!((&found["record"]["operator"], &found["record"]["serial"]), (&"Mia".into(), &"4711".into()));
    assert_eq!(found["inputs"]["sha256"].as_object().unwrap().len(), 2);
    // Each row is beside its bound: their share is the stated one.
    let rows = folder.read("spring/errors.csv");
    let head: Vec<&str> = rows.lines().next().unwrap().split(',').collect();
    let column = |name: &str| head.iter().position(|it| *it == name).unwrap();
    let (error, bound) = (column("position_error[mm]"), column("position_bound95[mm]"));
    let number = |line: &str, at: usize| line.split(',').nth(at).unwrap().parse::<f64>().unwrap();
    let all: Vec<(f64, f64)> = rows.lines().skip(1).map(|line| (number(line, error), number(line, bound))).collect();
    // Its components, with their signs, are those of the error.
    let components = ["x[mm]", "y[mm]", "z[mm]"].map(column);
    let is_signed = |line: &str| components.iter().any(|&at| number(line, at) < 0.0);
    assert!(rows.lines().skip(1).any(is_signed));
    for (line, (error, _)) in rows.lines().skip(1).zip(&all) {
        let length = components.iter().map(|&at| number(line, at).powi(2)).sum::<f64>().sqrt();
        assert!((length - error).abs() < 1e-12, "{line}");
    }
    let inside = all.iter().filter(|(error, bound)| error <= bound).count() as f64 / all.len() as f64;
    let rms = (all.iter().map(|(error, _)| error * error).sum::<f64>() / all.len() as f64).sqrt();
    let own = &found["verdict"]["position_mm"];
    println!("{} rows, {inside} inside, {rms} mm; {own}", all.len());
    assert_eq!((all.len(), inside), (40, own["inside_bound95"].as_f64().unwrap()));
    assert!((rms - own["rms"].as_f64().unwrap()).abs() < 1e-9);
    let page = folder.read("spring/report.html");
    for words in ["Check of the calibration of", "Mia", "4711", "spring.csv", "Signatures"] {
        assert!(page.contains(words), "{words}");
    }
    assert!(!page.contains("<script"));
    // The same command again refuses; with --force it writes the same bytes.
    let run = folder.run(command);
    assert_eq!(run.code, 2, "{}", run.err);
    folder.run_to_success(&format!("{command} --force"));
    assert!(folder.read("spring/report.html") == page, "another page");
    // The results of the calibration are never replaced by those of a check, nor the other way round.
    let own = folder.read("poecal-out/report.html");
    let run = folder.run("validate poecal-out/calibration.json spring.csv --refit device --out poecal-out --force");
    assert_eq!(
        run.err,
        "error: poecal-out: found the results of a calibration, expected another folder: choose one with --out\n"
    );
    assert!(run.code == 2 && folder.read("poecal-out/report.html") == own);
    let run = folder.run("calibrate robot.urdf measurements.csv --out spring --force");
    let refused = "error: spring: found the results of a check, expected another folder: choose one with --out\n";
    assert!(run.err.ends_with(refused), "{}", run.err);
    assert!(run.code == 2 && folder.read("spring/report.html") == page);
}

#[test]
fn the_history_gets_a_line_a_check() {
    let folder = folder_with_checks();
    let check = "validate poecal-out/calibration.json";
    folder.run_to_success(&format!("{check} spring.csv --refit device --quiet"));
    folder.run_to_success(&format!("{check} spring.csv --refit device --quiet --json"));
    assert_eq!(history(&folder, "poecal-out/history.jsonl").len(), 1, "the same check is there once");
    // A killed run left an incomplete line.
    let cut = folder.read("poecal-out/history.jsonl") + "{\"time\": \"2026-";
    folder.write("poecal-out/history.jsonl", cut);
    folder.run_to_success(&format!("{check} autumn.csv --refit device --quiet --report autumn.html"));
    let lines: Vec<Value> =
        folder.read("poecal-out/history.jsonl").lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    println!("{}", lines[1]);
    assert_eq!(lines.len(), 2);
    assert_eq!(lines[1]["inputs"]["measurements"], serde_json::json!(["autumn.csv"]));
    assert!(lines[0]["time"].as_str().unwrap() <= lines[1]["time"].as_str().unwrap());
    // The report of the second has the first.
    let page = folder.read("autumn.html");
    assert!(page.contains("Checks of this calibration") && page.contains(lines[0]["time"].as_str().unwrap()));
    // A calibration again into the same folder keeps the history, which does not belong to the new calibration.
    folder.run_to_success("calibrate robot.urdf measurements.csv spring.csv --device-frames per-file --force --quiet");
    assert_eq!(folder.read("poecal-out/history.jsonl").lines().count(), 3);
    folder.run_to_success(&format!("{check} autumn.csv --refit device --quiet --report again.html"));
    assert!(!folder.read("again.html").contains("Checks of this calibration"));
    // Elsewhere, or nowhere.
    let before = folder.read("poecal-out/history.jsonl");
    folder.run_to_success(&format!("{check} spring.csv --refit device --quiet --history cell.jsonl"));
    folder.run_to_success(&format!("{check} spring.csv --refit device --quiet --refit tool --history none"));
    assert_eq!((history(&folder, "cell.jsonl").len(), folder.read("poecal-out/history.jsonl")), (1, before));
    // A file that is no history is not written to.
    let rows = folder.read("spring.csv");
    let run = folder.run(&format!("{check} spring.csv --refit device --history spring.csv"));
    assert_eq!(run.err, "error: spring.csv: found a file without a check, expected the history of checks or nothing\n");
    assert_eq!((run.code, folder.read("spring.csv")), (2, rows));
    // If the default history cannot be kept, the check is done nevertheless, and a note states that.
    std::fs::remove_file(folder.path("poecal-out/history.jsonl")).unwrap();
    std::fs::create_dir(folder.path("poecal-out/history.jsonl")).unwrap();
    let run = folder.run(&format!("{check} spring.csv --refit device"));
    println!("{}", run.err);
    assert!(run.code == 0 && run.err.contains("the check is not in the history"), "{}", run.err);
}
