//! `poecal track` as users run it.

use crate::folder::Folder;

/// A simulated robot with its calibration.
fn cell() -> Folder {
    let folder = Folder::new();
    folder.write("robot.urdf", crate::session::ROBOT);
    folder.run_to_success("simulate robot.urdf --kind point --count 60 --seed 3 --out cell");
    folder.run_to_success("calibrate cell/nominal.urdf cell/measurements.csv --corrections off --report none");
    folder
}

#[test]
fn the_same_rows_are_unchanged_and_a_line_of_the_history() {
    let folder = cell();
    let run = folder.run("track poecal-out/calibration.json cell/measurements.csv --repeatability 0.05mm");
    assert_eq!(run.code, 0, "{}{}", run.out, run.err);
    assert!(run.out.contains("60 of 60 rows that repeat"), "{}", run.out);
    let history = folder.read("poecal-out/history.jsonl");
    assert!(history.contains("poecal-track-1") && history.lines().count() == 1, "{history}");
    // Both commands read a history that has lines of both.
    folder.run_to_success("validate poecal-out/calibration.json cell/measurements.csv");
    folder.run_to_success("track poecal-out/calibration.json cell/measurements.csv --repeatability 0.05mm");
    assert_eq!(folder.read("poecal-out/history.jsonl").lines().count(), 2);
}

/// The page of a visit states both sessions, the findings and the advice; a signed one is not overwritten.
#[test]
fn a_visit_is_a_page_to_sign() {
    let folder = cell();
    folder.run_to_success("calibrate cell/nominal.urdf cell/measurements.csv --out then --corrections off --record serial=4711 --record operator=Ann --record date=2026-05-28");
    let rows = folder.read("cell/measurements.csv");
    let shifted = rows.lines().map(|line| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        if let Some(third) = cells.get_mut(2)
            && let Ok(value) = third.parse::<f64>()
        {
            *third = (value - 0.05).to_string();
        }
        cells.join(",")
    });
    folder.write("visit.csv", shifted.collect::<Vec<_>>().join("\n") + "\n");
    let words =
        "track then/calibration.json visit.csv --repeatability 0.05mm --report visit.html --record operator=<Mia>";
    let run = folder.run(words);
    assert!(run.code == 1 && run.out.ends_with("report        visit.html\n"), "{}{}", run.out, run.err);
    let page = folder.read("visit.html");
    for words in [
        "4711",
        "Ann",
        "&lt;Mia&gt;",
        "2026-05-28",
        "changed: joint3: zero by +0.050",
        "<code>poecal track --recalibrate joint3 --out FILE</code>",
        "do not use",
        "Checked by: name, date, signature",
    ] {
        assert!(page.contains(words), "{words}");
    }
    assert!(!page.contains("<script"));
    assert!(folder.read("then/history.jsonl").contains("\"record\":{\"operator\":\"<Mia>\"}"));
    let run = folder.run(words);
    assert!(run.code == 2 && run.err.contains("visit.html") && run.err.contains("--force"), "{}", run.err);
    assert_eq!(folder.read("visit.html"), page);
    let run = folder.run(&format!("{words} --force"));
    assert_eq!((run.code, folder.read("visit.html") == page), (1, true), "{}", run.err);
    let run = folder.run("track then/calibration.json --plan 8 --report plan.html");
    assert!(run.code == 2 && !folder.path("plan.html").exists(), "{}", run.err);
    let run = folder.run("track then/calibration.json visit.csv --report visit.csv --force");
    assert!(run.code == 2 && run.err.contains("an input is never replaced"), "{}", run.err);
}

#[test]
fn witnesses_are_planned_and_written() {
    let folder = cell();
    let run = folder.run("track poecal-out/calibration.json --plan 8 --repeatability 0.05mm --out witness.csv");
    assert_eq!(run.code, 0, "{}{}", run.out, run.err);
    assert!(run.out.contains("not visible"), "{}", run.out);
    // A comment, the names, and eight rows.
    assert_eq!(folder.read("witness.csv").lines().count(), 10);
}

/// The plan of a visit is the same by both spellings; of new configurations there is one too.
#[test]
fn visits_are_planned_by_plan_for_drift() {
    let folder = cell();
    folder.run_to_success("track poecal-out/calibration.json --plan 8 --repeatability 0.05mm --out one.csv");
    let run = folder.run("plan poecal-out/calibration.json --purpose drift --repeatability 0.05mm --out two.csv");
    assert_eq!((run.code, folder.read("one.csv")), (0, folder.read("two.csv")), "{}", run.err);
    folder.run_to_success("plan robot.urdf --count 20 --out new.csv");
    let words = "plan poecal-out/calibration.json --purpose drift --device known --count 6 --candidates new.csv --out three.csv";
    let run = folder.run(words);
    assert!(run.code == 0 && run.out.contains("6, new"), "{}{}", run.out, run.err);
    assert!(run.out.contains("joint1") && !run.out.contains("joint1: the device"), "{}", run.out);
    assert_eq!(folder.read("three.csv").lines().count(), 8);
    for (words, expected) in [
        ("poecal-out/calibration.json --purpose drift --count 61", "60 measured configurations"),
        ("poecal-out/calibration.json --purpose drift --count 2", "choose more"),
        ("poecal-out/calibration.json --purpose drift --device 1,2,3mm", "known or refit"),
        ("robot.urdf --device known", "expected a place"),
        ("robot.urdf --purpose drift", "calibration.json"),
        ("poecal-out/calibration.json --purpose drift --floor-height 20mm", "expected none of them"),
    ] {
        let run = folder.run(&format!("plan {words}"));
        assert!(run.code == 2 && run.err.contains(expected), "{words}: {}", run.err);
    }
}

/// Rows that repeat nothing are judged by the model, and a note states that; another note states changed bytes of the model.
#[test]
fn rows_that_repeat_nothing_are_judged_by_the_model() {
    let folder = cell();
    folder.run_to_success("simulate robot.urdf --kind point --count 30 --seed 4 --out other");
    let run = folder.run("track poecal-out/calibration.json other/measurements.csv --history none");
    assert!(run.err.contains("none of the rows repeats"), "{}{}", run.out, run.err);
    let model = folder.read("cell/nominal.urdf") + "<!-- another -->\n";
    folder.write("cell/nominal.urdf", model);
    let run =
        folder.run("track poecal-out/calibration.json cell/measurements.csv --repeatability 0.05mm --history none");
    assert!(run.code == 0 && run.err.contains("has other bytes than when it was calibrated"), "{}{}", run.out, run.err);
}

#[test]
fn what_cannot_be_judged_is_refused() {
    let folder = cell();
    let few: Vec<String> = folder.read("cell/measurements.csv").lines().take(3).map(str::to_owned).collect();
    folder.write("few.csv", few.join("\n") + "\n");
    let run = folder.run("track poecal-out/calibration.json few.csv");
    assert_eq!(run.code, 2, "{}", run.out);
    assert!(run.err.contains("more configurations"), "{}", run.err);
    let run =
        folder.run("track poecal-out/calibration.json cell/measurements.csv --recalibrate nothing --out new.json");
    assert!(run.code == 2 && run.err.contains("found joint `nothing`"), "{}", run.err);
    let run = folder.run("track poecal-out/calibration.json cell/measurements.csv --out new.json");
    assert!(run.code == 2 && run.err.contains("--plan or --recalibrate"), "{}", run.err);
}

/// Another robot with the same joints is not called unchanged, in the same configurations or in others, and no joint is blamed.
#[test]
fn another_robot_is_not_called_unchanged() {
    let folder = cell();
    folder.run_to_success("simulate robot.urdf --kind point --count 60 --seed 4 --out other");
    // The same readings with the other robot's measurements.
    folder.run_to_success("predict other/actual.urdf cell/measurements.csv --out places.csv");
    let (rows, places) = (folder.read("cell/measurements.csv"), folder.read("places.csv"));
    let mut joined = String::new();
    for (row, place) in rows.lines().filter(|line| !line.starts_with('#')).zip(places.lines()) {
        let readings: Vec<&str> = row.split(',').take(6).collect();
        let place: Vec<&str> = place.split(',').take(3).collect();
        joined += &format!("{},{}\n", readings.join(","), place.join(","));
    }
    folder.write("places.csv", joined);
    for file in ["other/measurements.csv", "places.csv"] {
        let run = folder.run(&format!("track poecal-out/calibration.json {file} --history none"));
        println!("{file}: {}{}", run.out, run.err);
        assert_eq!(run.code, 1, "{}{}", run.out, run.err);
        assert!(run.out.contains("no single cause explains it"), "{}", run.out);
        assert!(run.err.contains("if the calibration is of this robot and this tool"), "{}", run.err);
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Rows of the cell by its actual robot, with the target elsewhere on the flange and the device elsewhere, metres.
fn visit(folder: &Folder, tool_m: [f64; 3], device_m: [f64; 3]) -> String {
    folder.run_to_success("predict cell/actual.urdf cell/measurements.csv --out poses.csv --force");
    let (rows, poses) = (folder.read("cell/measurements.csv"), folder.read("poses.csv"));
    let mut rows = rows.lines().filter(|line| !line.starts_with('#'));
    let mut joined = rows.next().unwrap().split(',').take(6).collect::<Vec<_>>().join(",") + ",x[m],y[m],z[m]\n";
    for (row, pose) in rows.zip(poses.lines().skip(1)) {
        let readings: Vec<&str> = row.split(',').take(6).collect();
        let pose: Vec<f64> = pose.split(',').map(|cell| cell.parse().unwrap()).collect();
        let (q, w) = ([pose[3], pose[4], pose[5]], pose[6]);
        let twice = cross(q, cross(q, tool_m).map(|it| 2.0 * it));
        let once = cross(q, tool_m);
        let place: Vec<f64> =
            (0..3).map(|k| pose[k] + tool_m[k] + 2.0 * w * once[k] + twice[k] + device_m[k]).collect();
        joined += &format!("{},{},{},{}\n", readings.join(","), place[0], place[1], place[2]);
    }
    joined
}

/// Another tool is named as the tool, and none if it was mounted anew; a moved device is named if it is stated to be known.
#[test]
fn another_tool_and_another_place_of_the_device_are_named() {
    let folder = Folder::new();
    folder.write("robot.urdf", crate::session::ROBOT);
    folder.run_to_success("simulate robot.urdf --kind point --count 60 --seed 3 --device-frame base --out cell");
    folder.run_to_success(
        "calibrate cell/nominal.urdf cell/measurements.csv --device-frame base --corrections off --report none",
    );
    let none = [0.0; 3];
    folder.write("old.csv", visit(&folder, none, none));
    folder.write("tool.csv", visit(&folder, [0.03, -0.02, 0.05], none));
    folder.write("device.csv", visit(&folder, none, [0.02, 0.0, -0.01]));
    for (words, code, expected) in [
        ("tool.csv", 1, "tool"),
        ("tool.csv --tool refit", 0, "unchanged within"),
        ("device.csv", 1, "device"),
        ("device.csv --device refit", 0, "unchanged within"),
    ] {
        let run = folder.run(&format!(
            "track poecal-out/calibration.json {words} --reference old.csv --repeatability 0.05mm --history none"
        ));
        let state = run.out.lines().find(|line| line.starts_with("state")).unwrap_or_default();
        println!("{words}: {state}");
        assert_eq!(run.code, code, "{words}: {}{}", run.out, run.err);
        assert!(state.contains(expected), "{words}: {}", run.out);
    }
}
