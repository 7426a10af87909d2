//! `poecal calibrate` of sessions in which something moved: reported, repaired, and judged by the rows after it.

use poecal_model::simulate::{SessionKind, Simulation};
use serde_json::Value;

use crate::folder::Folder;
use crate::session::{session, write_measurements};

/// A file with the `y` of its data lines from one on moved, millimetres.
fn move_lines(folder: &Folder, from: &str, to: &str, first: usize, by_mm: f64) {
    let text = folder.read(from);
    let mut lines = text.lines();
    let head = lines.next().unwrap();
    let at = head.split(',').position(|name| name == "y").unwrap();
    let by = 1e-3 * by_mm;
    let rows = lines.enumerate().map(|(k, line)| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        if k >= first {
            cells[at] = (cells[at].parse::<f64>().unwrap() + by).to_string();
        }
        cells.join(",")
    });
    folder.write(to, std::iter::once(head.to_owned()).chain(rows).collect::<Vec<_>>().join("\n"));
}

#[test]
fn a_move_during_the_session_is_repaired_and_said() {
    let folder = session(SessionKind::POINT);
    let more = Simulation { count: 160, ..Simulation::default() };
    write_measurements(&folder, "all.csv", SessionKind::POINT, "", &more);
    let all = folder.read("all.csv");
    let part = |first: usize, count: usize| {
        let is_of = |(line, _): &(usize, &str)| *line == 0 || (first..first + count).contains(line);
        all.lines().enumerate().filter(is_of).map(|(_, line)| line).collect::<Vec<_>>().join("\n")
    };
    folder.write("fit.csv", part(1, 80));
    folder.write("judge.csv", part(81, 60));
    move_lines(&folder, "fit.csv", "knocked.csv", 40, 2.0);
    move_lines(&folder, "judge.csv", "after.csv", 0, 2.0);

    let out = folder.run_to_success("calibrate robot.urdf knocked.csv --out knocked --verbose");
    println!("{out}");
    let said = out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains("repaired from knocked.csv:42 on the measuring device is 2."), "{said}");
    assert!(said.contains("taken as set up anew there, `device.2`; cross-validation 0."), "{said}");
    let file: Value = serde_json::from_str(&folder.read("knocked/calibration.json")).unwrap();
    let repairs = &file["repairs"];
    assert_eq!((&repairs[0]["kind"], &repairs[0]["from_row"]), (&"device".into(), &41.into()), "{repairs}");
    assert!(repairs.as_array().unwrap().len() == 1 && file["suspicions"].is_null());
    assert!(folder.read("knocked/residuals.csv").lines().last().unwrap().ends_with(",device.2"));
    let page = folder.read("knocked/report.html");
    assert!(page.contains("device moved: errors before and after"), "no picture");

    // Other rows are judged by the state that fits.
    let judged = |name: &str| -> Value {
        let text = folder.run_to_success(&format!("validate knocked/calibration.json {name} --json --history none"));
        serde_json::from_str(&text).unwrap()
    };
    for (name, stage) in [("judge.csv", 1), ("after.csv", 2)] {
        let found = judged(name);
        println!("{name}: {}", found["verdict"]);
        assert_eq!((&found["stage"], &found["verdict"]["level"]), (&stage.into(), &"good".into()), "{name}");
        assert!(found["verdict"]["position_mm"]["rms"].as_f64().unwrap() < 0.2);
    }
    // A prediction for the device equals its present measurement.
    let seen = |name: &str| -> Vec<f64> {
        let text = folder.run_to_success(&format!("predict {name} judge.csv --output-frame device --quiet"));
        text.lines().nth(1).unwrap().split(',').skip(1).take(3).map(|cell| cell.parse().unwrap()).collect()
    };
    folder.run_to_success("calibrate robot.urdf fit.csv --out clean");
    let (now, before) = (seen("knocked/calibration.json"), seen("clean/calibration.json"));
    assert!((now[1] - before[1] - 2e-3).abs() < 3e-4, "{now:?} {before:?}");

    // Without repairs the result is not to be used.
    let run = folder.run("calibrate robot.urdf knocked.csv --repair off --out off");
    let said = run.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(run.code == 1 && said.starts_with("verdict do not use: from knocked.csv:42 on"), "{said}");
    let file: Value = serde_json::from_str(&folder.read("off/calibration.json")).unwrap();
    assert!(file["repairs"].is_null() && file["suspicions"][0]["kind"] == "device");
    // A clean session has neither.
    let file = folder.read("clean/calibration.json");
    assert!(!file.contains("\"repairs\"") && !file.contains("\"suspicions\""));
}
