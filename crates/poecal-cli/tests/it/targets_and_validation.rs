//! `poecal validate`, and targets by name.

use poecal_import as measurements;
use poecal_import::ReadOptions;
use poecal_model::simulate::{SessionKind, Simulation};

use crate::session::{calibration, numbers, session, write_measurements};

#[test]
fn named_targets_are_predicted_by_name() {
    let folder = session(SessionKind::POINT);
    let simulation = Simulation { count: 60, ..Simulation::default() };
    write_measurements(&folder, "smr.csv", SessionKind::POINT, "smr1", &simulation);
    folder.run_to_success("calibrate robot.urdf smr.csv");
    let file = calibration(&folder, "poecal-out");
    let robot = file.robot().unwrap();
    let data = measurements::read(&[folder.path("smr.csv")], &robot, &ReadOptions::default()).unwrap().data;
    let out = folder.run_to_success("predict poecal-out/calibration.json smr.csv --target smr1 --output-frame device");
    for (row, predicted) in numbers(&out, 1).iter().enumerate() {
        let measured = data.observations[row].measurement.pose();
        let distance = (0..3).map(|k| (predicted[k] - measured.translation[k]).powi(2)).sum::<f64>().sqrt();
        assert!(distance < 5e-4, "row {row}: {distance} m");
    }
    // A point has the tip's orientation.
    let tip = numbers(&folder.run_to_success("predict poecal-out/calibration.json smr.csv --output-frame device"), 1);
    assert_eq!(numbers(&out, 1)[0][3..], tip[0][3..]);
    let run = folder.run("predict poecal-out/calibration.json smr.csv --target smr2");
    assert_eq!(run.code, 2);
    assert_eq!(
        run.err,
        "error: poecal-out/calibration.json: found no target `smr2`, expected one of smr1; did you mean `smr1`?\n"
    );

    let refusals = [
        (
            "measurements.csv",
            "found measurements without a target's name, expected one of smr1 as in the calibration: add a column `target`, or refit the targets with --refit tool",
        ),
        (
            "other.csv",
            "found measurements of target `smr2`, expected one of smr1 as in the calibration (nearest: `smr1`): rename it, or refit the targets with --refit tool",
        ),
        (
            "poses.csv",
            "found orientations of target `smr1`, expected positions alone, since it is a point in the calibration: leave the orientation columns out, or refit the targets with --refit tool",
        ),
    ];
    write_measurements(&folder, "other.csv", SessionKind::POINT, "smr2", &simulation);
    write_measurements(&folder, "poses.csv", SessionKind::POSE, "smr1", &simulation);
    for (name, sentence) in refusals {
        let run = folder.run(&format!("validate poecal-out/calibration.json {name}"));
        assert_eq!((run.code, run.err), (2, format!("error: {sentence}\n")));
        folder.run_to_success(&format!("validate poecal-out/calibration.json {name} --refit tool"));
    }
}

#[test]
fn validation_judges_other_sessions() {
    let folder = session(SessionKind::POSE);
    folder.run_to_success("calibrate robot.urdf measurements.csv");
    let own_rms = calibration(&folder, "poecal-out").accuracy.held_out.unwrap().calibrated.position_mm().rms;
    let json = |arguments: &str| -> serde_json::Value {
        serde_json::from_str(
            &folder.run_to_success(&format!("validate poecal-out/calibration.json {arguments} --json")),
        )
        .unwrap()
    };
    let rms = |value: &serde_json::Value| value["position_mm"]["rms"].as_f64().unwrap();

    // The same robot and device, in configurations that the calibration did not use: those after its 60 rows.
    let more = Simulation { count: 160, ..Simulation::default() };
    write_measurements(&folder, "all.csv", SessionKind::POSE, "", &more);
    let all = folder.read("all.csv");
    let is_new = |(line, _): &(usize, &str)| *line == 0 || *line > 60;
    let new: Vec<&str> = all.lines().enumerate().filter(is_new).map(|(_, line)| line).collect();
    folder.write("more.csv", new.join("\n"));
    let found = json("more.csv");
    assert_eq!(
        (&found["count"], &found["refitted"], &found["nominal"]),
        (&100.into(), &serde_json::json!([]), &serde_json::Value::Null)
    );
    println!("own {own_rms} mm, more.csv {} mm", rms(&found["calibrated"]));
    assert!(rms(&found["calibrated"]) < 1.5 * own_rms);
    assert!(found["calibrated"]["rotation_deg"]["rms"].as_f64().unwrap() < 0.04);

    // The same robot with the device elsewhere: positions in the base's own frame.
    write_measurements(&folder, "moved.csv", SessionKind::POSE, "", &Simulation { device_anywhere: false, ..more });
    let run = folder.run("validate poecal-out/calibration.json moved.csv");
    assert_eq!(run.code, 1);
    println!("{}", run.err.trim_end());
    assert!(
        run.err.contains("from where the calibration has it: with its frame refitted the position error is 0."),
        "{}",
        run.err
    );
    assert!(run.err.contains("judge the robot by --refit device, or let --refit auto do so"), "{}", run.err);
    // By itself it does the same, and reports that.
    let found = json("moved.csv --refit auto");
    assert_eq!(found["calibrated"], json("moved.csv --refit device")["calibrated"]);
    let moved = &found["moved_device"];
    assert!(moved["refitted"] == true && moved["after_rms"].as_f64() < moved["before_rms"].as_f64());
    assert!(
        folder
            .run_to_success("validate poecal-out/calibration.json moved.csv --refit auto")
            .contains("the device stands ")
    );
    // With an unmoved device, nothing is refitted.
    let found = json("more.csv --refit auto");
    assert!(found["moved_device"].is_null() && found["refitted"] == serde_json::json!([]), "{found}");
    let found = json("moved.csv --refit device");
    println!("moved.csv, frame refitted: {} mm", rms(&found["calibrated"]));
    assert!(rms(&found["calibrated"]) < 1.5 * own_rms);
    assert_eq!(found["nominal"], serde_json::Value::Null);

    let found = json("moved.csv --refit device,tool");
    assert_eq!(found["refitted"], serde_json::json!(["device_frame", "tool"]));
    assert!(rms(&found["calibrated"]) < 1.5 * own_rms && rms(&found["nominal"]) > 20.0 * own_rms);
    let out = folder.run_to_success("validate poecal-out/calibration.json moved.csv --refit device,tool");
    assert!(out.contains("nominal   calibrated") && out.lines().all(|line| line.len() <= 80), "{out}");
    assert_eq!(folder.run_to_success("validate poecal-out/calibration.json more.csv --quiet"), "");

    folder.write("one.csv", folder.read("more.csv").lines().take(2).collect::<Vec<_>>().join("\n"));
    let run = folder.run("validate poecal-out/calibration.json one.csv --refit device");
    assert_eq!(run.code, 2);
    assert_eq!(
        run.err,
        "error: found 1 measurement with 6 measured numbers, expected more than the 6 unknowns to be refitted (6 of the device frame, 0 of the targets): measure more configurations, or refit less\n"
    );
}

#[test]
fn the_nominal_model_is_judged_where_all_it_cannot_know_is_found_anew() {
    let folder = session(SessionKind::POSE);
    let at_base = Simulation { count: 60, device_anywhere: false, ..Simulation::default() };
    write_measurements(&folder, "base.csv", SessionKind::POSE, "", &at_base);
    folder.run_to_success("calibrate robot.urdf base.csv --device-frame base --out base");
    folder.run_to_success("calibrate robot.urdf base.csv --out anywhere");
    for (name, refit, is_judged) in [
        ("base", "", false),
        ("base", "--refit device", false),
        ("base", "--refit tool", true),
        ("anywhere", "--refit tool", false),
        ("anywhere", "--refit device,tool", true),
    ] {
        let out = folder.run_to_success(&format!("validate {name}/calibration.json base.csv {refit}"));
        assert_eq!(out.contains(" nominal   calibrated"), is_judged, "{name} {refit}\n{out}");
    }
}
