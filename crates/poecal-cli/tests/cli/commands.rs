//! Every command end to end, on simulated measurements.

use std::fmt::Write as _;

use crate::folder::Folder;
use poecal::io::calibration_file::CalibrationFile;
use poecal::io::measurements::{self, ReadOptions};
use poecal::io::model::Model;
use poecal::measurement::Measurement;
use poecal::simulate::{Kind, Simulation};

const ROBOT: &str = include_str!("../../../../examples/elbow/robot.urdf");

/// A folder with `robot.urdf` and `measurements.csv`: 60 rows with `id` and `stage` (1 in the first 40, then 2).
fn session(kind: Kind) -> Folder {
    let folder = Folder::new();
    folder.write("robot.urdf", ROBOT);
    write_measurements(
        &folder,
        "measurements.csv",
        kind,
        "",
        &Simulation { count: 60, ..Simulation::default() },
    );
    folder
}

/// Writes a simulated session; every row names `target`, if it is not empty. Sessions of one seed are of one robot and begin alike.
fn write_measurements(folder: &Folder, name: &str, kind: Kind, target: &str, simulation: &Simulation) {
    let model = Model::read(folder.path("robot.urdf"), &Default::default()).unwrap();
    let data = simulation.run(&model.robot, kind).unwrap().data;
    let mut text = format!("id,stage,target,{},x,y,z,qx,qy,qz,qw\n", data.reading_names().join(","));
    for (row, observation) in data.observations.iter().enumerate() {
        let stage = if row < 40 { 1 } else { 2 };
        write!(text, "row{row},{stage},{target}").unwrap();
        for reading in data.readings(row) {
            write!(text, ",{reading:?}").unwrap();
        }
        let pose = observation.measurement.pose();
        let [x, y, z]: [f64; 3] = pose.translation.into();
        write!(text, ",{x:?},{y:?},{z:?}").unwrap();
        match observation.measurement {
            Measurement::Pose(_) => {
                for part in pose.quaternion_xyzw() {
                    write!(text, ",{part:?}").unwrap();
                }
            }
            Measurement::Point(_) => text.push_str(",,,,"),
        }
        text.push('\n');
    }
    folder.write(name, text);
}

fn calibration(folder: &Folder, name: &str) -> CalibrationFile {
    CalibrationFile::read(folder.path(name).join("calibration.json")).unwrap()
}

/// Numbers of a predicted table, without the header and the first `skip` columns.
fn numbers(table: &str, skip: usize) -> Vec<Vec<f64>> {
    let row = |line: &str| line.split(',').skip(skip).map(|cell| cell.parse().unwrap()).collect();
    table.lines().skip(1).map(row).collect()
}

#[test]
fn calibrate_writes_its_folder_and_tells_three_models() {
    let folder = session(Kind::Pose);
    let out = folder.done("calibrate robot.urdf measurements.csv");
    for words in [
        "nominal    registered    calibrated",
        "training (42)",
        "held out (18)",
        "60 poses: 42 fitted, 18 held out",
    ] {
        assert!(out.contains(words), "`{words}` is not in\n{out}");
    }
    let files = ["measurements.csv", "poecal-out", "robot.urdf"].map(|name| folder.path(name));
    let results = ["calibrated.urdf", "calibration.json", "residuals.csv"].map(|name| files[1].join(name));
    let mut expected: Vec<_> = files.into_iter().chain(results).collect();
    expected.sort();
    assert_eq!(folder.listing().into_keys().collect::<Vec<_>>(), expected);
    let held_out = calibration(&folder, "poecal-out").accuracy.held_out.unwrap();
    println!("held out, calibrated: {:?}", held_out.calibrated);
    // Simulated noise: 0.05 mm and 0.01 degrees a component.
    assert!(held_out.calibrated.position_mm.rms < 0.2 && held_out.nominal.position_mm.rms > 5.0);
    assert!(held_out.calibrated.rotation_deg.unwrap().rms < 0.04);
}

/// A URDF without its attributes `xyz` and `rpy`.
fn without_placements(urdf: &str) -> String {
    let mut rest = urdf;
    let mut kept = String::new();
    while let Some(at) = [" xyz=\"", " rpy=\""].iter().filter_map(|name| rest.find(name)).min() {
        let (before, attribute) = rest.split_at(at);
        kept.push_str(before);
        rest = attribute.splitn(3, '"').nth(2).unwrap();
    }
    kept + rest
}

#[test]
fn calibrated_urdf_changes_attribute_values_only() {
    let folder = session(Kind::Pose);
    folder.done("calibrate robot.urdf measurements.csv");
    let calibrated = folder.read("poecal-out/calibrated.urdf");
    assert_ne!(calibrated, ROBOT);
    // Comments, blanks and everything else are the input's, byte for byte; the tool's mount got an `rpy` that it did not have.
    assert_eq!(without_placements(&calibrated), without_placements(ROBOT));
    assert!(without_placements(ROBOT).contains("<!-- The elbow manipulator of Lou"));
}

#[test]
fn training_figures_are_never_shown_without_the_word() {
    let folder = session(Kind::Mixed);
    for arguments in ["", "--held-out 0", "--fit-where stage=1", "--validate measurements.csv"] {
        let out = folder.done(&format!("calibrate robot.urdf measurements.csv --force {arguments}"));
        // Each block of figures begins with a row that names its set; the first block of a table is the training one.
        let mut set = "";
        for line in out.lines() {
            if line.starts_with("position, mm") || line.starts_with("rotation, deg") {
                set = "";
            }
            for name in ["training (", "held out ("] {
                if line.trim_start().starts_with(name) {
                    set = name;
                }
            }
            let is_figure = ["mean ", "RMS ", "95 % ", "max "].iter().any(|row| line.contains(row));
            assert!(!is_figure || !set.is_empty(), "figures without their set:\n{out}");
        }
    }
    let out = folder.done("validate poecal-out/calibration.json measurements.csv");
    assert!(out.contains("measurements.csv (has training rows)"), "{out}");
    let out = folder.done("validate poecal-out/calibration.json measurements.csv --refit-frame --refit-tool");
    assert!(out.contains("device frame and tool: fitted to these measurements, so training"), "{out}");
}

#[test]
fn what_is_held_out_can_be_said() {
    let folder = session(Kind::Pose);
    let out = folder.done("calibrate robot.urdf measurements.csv --held-out 0 --out all");
    assert!(out.contains("held out        none: every measurement was fitted"), "{out}");
    let json: serde_json::Value = serde_json::from_str(&folder.read("all/calibration.json")).unwrap();
    assert_eq!(json["accuracy"]["held_out"], serde_json::Value::Null);
    assert_eq!(json["accuracy"]["training"]["count"], 60);

    let out = folder.done("calibrate robot.urdf measurements.csv --fit-where stage=1 --out stage");
    assert!(out.contains("training (40)") && out.contains("held out (20)"), "{out}");

    let simulation = Simulation { count: 60, seed: 1, ..Simulation::default() };
    write_measurements(&folder, "other.csv", Kind::Pose, "", &Simulation { count: 25, ..simulation });
    let out = folder.done("calibrate robot.urdf measurements.csv --validate other.csv --out other");
    assert!(out.contains("training (60)") && out.contains("held out (25)"), "{out}");
}

#[test]
fn json_is_the_file_and_quiet_is_silent() {
    let folder = session(Kind::Point);
    let out = folder.done("calibrate robot.urdf measurements.csv --json");
    assert_eq!(out, folder.read("poecal-out/calibration.json"));
    let run = folder.run("calibrate robot.urdf measurements.csv --quiet --out quiet");
    assert_eq!((run.code, run.out.as_str(), run.err.as_str()), (0, "", ""));
    let run = folder.run("calibrate robot.urdf measurements.csv");
    assert_eq!(run.code, 2, "an existing folder was overwritten");
    folder.write("poecal-out/residuals.csv", "old");
    folder.write("poecal-out/mine.txt", "mine");
    folder.done("calibrate robot.urdf measurements.csv --force");
    assert_ne!(folder.read("poecal-out/residuals.csv"), "old");
    assert_eq!(folder.read("poecal-out/mine.txt"), "mine");
}

#[test]
fn threads_do_not_change_a_byte() {
    let folder = session(Kind::Mixed);
    let one = folder.done("calibrate robot.urdf measurements.csv --threads 1 --out one --json");
    let two = folder.done("calibrate robot.urdf measurements.csv --threads 2 --out two --json");
    assert_eq!(one, two);
    for name in ["calibration.json", "calibrated.urdf", "residuals.csv"] {
        assert_eq!(folder.read(&format!("one/{name}")), folder.read(&format!("two/{name}")), "{name}");
    }
}

#[test]
fn predictions_are_those_of_the_model() {
    let folder = session(Kind::Pose);
    folder.done("calibrate robot.urdf measurements.csv");
    let out = folder.done("predict poecal-out/calibration.json measurements.csv");
    assert_eq!(out.lines().next(), Some("id,x[m],y[m],z[m],qx,qy,qz,qw"));
    assert!(out.lines().nth(1).unwrap().starts_with("row0,"));
    let file = calibration(&folder, "poecal-out");
    let robot = file.robot().unwrap();
    let data =
        measurements::read(&[folder.path("measurements.csv")], &robot, &ReadOptions::default()).unwrap().data;
    for (row, predicted) in numbers(&out, 1).iter().enumerate() {
        let pose = robot.forward_kinematics(data.readings(row));
        let position: [f64; 3] = pose.translation.into();
        // Equal to the bit, since numbers are written so that they read back.
        assert_eq!(predicted[..3], position);
        assert_eq!(predicted[3..], pose.quaternion_xyzw());
        assert!(predicted[6] >= 0.0);
    }
    // In the device's frame, predictions are what was measured, but for the noise.
    let out =
        folder.done("predict poecal-out/calibration.json measurements.csv --frame device --out seen.csv");
    assert_eq!(out, "");
    for (row, predicted) in numbers(&folder.read("seen.csv"), 1).iter().enumerate() {
        let measured = data.observations[row].measurement.pose();
        let distance = (0..3).map(|k| (predicted[k] - measured.translation[k]).powi(2)).sum::<f64>().sqrt();
        assert!(distance < 5e-4, "row {row}: {distance} m");
    }
    // The calibrated URDF is the same robot.
    let urdf = numbers(&folder.done("predict poecal-out/calibrated.urdf measurements.csv"), 1);
    let json = numbers(&folder.done("predict poecal-out/calibration.json measurements.csv"), 1);
    for (a, b) in urdf.iter().flatten().zip(json.iter().flatten()) {
        assert!((a - b).abs() < 1e-12);
    }
}

#[test]
fn the_device_is_the_base_where_that_was_given() {
    let folder = session(Kind::Pose);
    let at_base = Simulation { count: 60, device_anywhere: false, ..Simulation::default() };
    write_measurements(&folder, "base.csv", Kind::Pose, "", &at_base);
    folder.done("calibrate robot.urdf base.csv --frame base");
    assert_eq!(
        folder.done("predict poecal-out/calibration.json base.csv --frame device"),
        folder.done("predict poecal-out/calibration.json base.csv --frame base")
    );
}

#[test]
fn named_targets_are_predicted_by_name() {
    let folder = session(Kind::Point);
    let simulation = Simulation { count: 60, ..Simulation::default() };
    write_measurements(&folder, "smr.csv", Kind::Point, "smr1", &simulation);
    folder.done("calibrate robot.urdf smr.csv");
    let file = calibration(&folder, "poecal-out");
    let robot = file.robot().unwrap();
    let data = measurements::read(&[folder.path("smr.csv")], &robot, &ReadOptions::default()).unwrap().data;
    let out = folder.done("predict poecal-out/calibration.json smr.csv --target smr1 --frame device");
    for (row, predicted) in numbers(&out, 1).iter().enumerate() {
        let measured = data.observations[row].measurement.pose();
        let distance = (0..3).map(|k| (predicted[k] - measured.translation[k]).powi(2)).sum::<f64>().sqrt();
        assert!(distance < 5e-4, "row {row}: {distance} m");
    }
    // A point has the tip's orientation.
    let tip = numbers(&folder.done("predict poecal-out/calibration.json smr.csv --frame device"), 1);
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
            "found measurements without a target's name, expected one of smr1 as in the calibration: add a column `target`, or find the targets anew with --refit-tool",
        ),
        (
            "other.csv",
            "found measurements of target `smr2`, expected one of smr1 as in the calibration (nearest: `smr1`): rename it, or find the targets anew with --refit-tool",
        ),
        (
            "poses.csv",
            "found orientations of target `smr1`, expected positions alone, since the calibration knows it as a point: leave the orientation columns out, or find the targets anew with --refit-tool",
        ),
    ];
    write_measurements(&folder, "other.csv", Kind::Point, "smr2", &simulation);
    write_measurements(&folder, "poses.csv", Kind::Pose, "smr1", &simulation);
    for (name, sentence) in refusals {
        let run = folder.run(&format!("validate poecal-out/calibration.json {name}"));
        assert_eq!((run.code, run.err), (2, format!("error: {sentence}\n")));
        folder.done(&format!("validate poecal-out/calibration.json {name} --refit-tool"));
    }
}

#[test]
fn validation_judges_other_sessions() {
    let folder = session(Kind::Pose);
    folder.done("calibrate robot.urdf measurements.csv");
    let own_rms = calibration(&folder, "poecal-out").accuracy.held_out.unwrap().calibrated.position_mm.rms;
    let json = |arguments: &str| -> serde_json::Value {
        serde_json::from_str(
            &folder.done(&format!("validate poecal-out/calibration.json {arguments} --json")),
        )
        .unwrap()
    };
    let rms = |value: &serde_json::Value| value["position_mm"]["rms"].as_f64().unwrap();

    // The same robot and device, in configurations that the calibration did not see: what follows on its 60 rows.
    let more = Simulation { count: 160, ..Simulation::default() };
    write_measurements(&folder, "all.csv", Kind::Pose, "", &more);
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
    write_measurements(&folder, "moved.csv", Kind::Pose, "", &Simulation { device_anywhere: false, ..more });
    let run = folder.run("validate poecal-out/calibration.json moved.csv");
    assert_eq!(run.code, 0);
    assert!(run.err.contains("find its frame anew with --refit-frame"), "{}", run.err);
    let found = json("moved.csv --refit-frame");
    println!("moved.csv, frame refitted: {} mm", rms(&found["calibrated"]));
    assert!(rms(&found["calibrated"]) < 1.5 * own_rms);
    assert_eq!(found["nominal"], serde_json::Value::Null);

    let found = json("moved.csv --refit-frame --refit-tool");
    assert_eq!(found["refitted"], serde_json::json!(["device_frame", "tool"]));
    assert!(rms(&found["calibrated"]) < 1.5 * own_rms && rms(&found["nominal"]) > 20.0 * own_rms);
    let out = folder.done("validate poecal-out/calibration.json moved.csv --refit-frame --refit-tool");
    assert!(out.contains("nominal    calibrated") && out.lines().all(|line| line.len() <= 80), "{out}");
    assert_eq!(folder.done("validate poecal-out/calibration.json more.csv --quiet"), "");

    folder.write("one.csv", folder.read("more.csv").lines().take(2).collect::<Vec<_>>().join("\n"));
    let run = folder.run("validate poecal-out/calibration.json one.csv --refit-frame");
    assert_eq!(run.code, 2);
    assert_eq!(
        run.err,
        "error: found 1 measurements with 6 measured numbers, expected more than the 6 unknowns to be found anew (6 of the device frame, 0 of the targets): measure more configurations, or refit less\n"
    );
}

#[test]
fn check_says_what_it_understood() {
    let folder = session(Kind::Mixed);
    folder.write("ids.csv", "id;set;joint1[deg];joint2;joint3;joint4;joint5;joint6;x[mm];y[mm];z[mm];note\nr1;fit;-90;0,5;0;0;0;0;700;0;500;a\nr2;held_out;90;0,25;0;0;0;0;700;10;500;b\n");
    let out = folder.done("check robot.urdf measurements.csv ids.csv");
    for words in [
        "robot         elbow: 6 revolute, from base_link to tool",
        "joint3: revolute about (0, -1, 0) through (150, 0, 570) mm, from",
        "rows          60: 30 poses and 30 points",
        "orientation   quaternion x, y, z, w; device_from_target",
        "separator: semicolon; decimal sign: comma",
        "joint1    joint1[deg]    deg, header   -90 to 90 deg",
        "joint2    joint2         rad, SI       14.324 to 28.648 deg",
        "y         y[mm]          mm, header    0 to 10 mm",
        "left alone    note",
        "sets          1 to fit, 1 held out, 60 not stated (fitted)",
        "warnings      measurements.csv: left alone the columns `stage`",
        "ids.csv: left alone the columns `note`",
    ] {
        assert!(out.contains(words), "`{words}` is not in\n{out}");
    }
    assert!(out.lines().all(|line| line.chars().count() <= 80), "{out}");
    let out = folder.done("check robot.urdf measurements.csv --fit-where stage=1");
    assert!(out.contains("sets          40 to fit, 20 held out"), "{out}");

    let json: serde_json::Value =
        serde_json::from_str(&folder.done("check robot.urdf ids.csv --json")).unwrap();
    assert_eq!(json["model"]["joints"][1]["point_m"], serde_json::json!([0.15, 0.0, 0.0]));
    assert_eq!(json["files"][0]["separator"], "semicolon");
    assert_eq!(json["sets"], serde_json::json!({"fit": 1, "held_out": 1, "unstated": 0}));
    assert_eq!(json["warnings"].as_array().unwrap().len(), 1);
    let json: serde_json::Value = serde_json::from_str(&folder.done("check robot.urdf --json")).unwrap();
    assert_eq!((&json["sets"], &json["files"]), (&serde_json::Value::Null, &serde_json::json!([])));
}

#[test]
fn convert_gives_the_same_robot_in_another_form() {
    let folder = session(Kind::Pose);
    folder.done("calibrate robot.urdf measurements.csv");
    let run = folder.run("convert robot.urdf --to toml");
    assert!(run.out.starts_with("poecal_robot = 1\n"));
    assert_eq!(
        run.err,
        "warning: link frames, fixed joints, meshes and inertias are not part of a TOML model and were left out\n"
    );
    assert_eq!(folder.done("convert robot.urdf --out robot.toml"), "");
    assert_eq!(folder.read("robot.toml"), run.out);
    folder.done("convert poecal-out/calibration.json --out again.urdf");
    folder.done("convert again.urdf --tip-link tool --to toml --out again.toml");
    for (a, b) in [
        ("robot.urdf", "robot.toml"),
        ("poecal-out/calibration.json", "again.urdf"),
        ("again.urdf", "again.toml"),
    ] {
        let of = |name: &str| numbers(&folder.done(&format!("predict {name} measurements.csv")), 1);
        for (a, b) in of(a).iter().flatten().zip(of(b).iter().flatten()) {
            assert!((a - b).abs() < 1e-12);
        }
    }
}

#[test]
fn the_schema_in_the_docs_is_the_programs() {
    let printed = Folder::new().done("schema");
    assert_eq!(printed, CalibrationFile::json_schema());
    let kept = include_str!("../../../../docs/calibration.schema.json");
    assert!(
        printed == kept,
        "write it anew: cargo run -p poecal-cli -- schema > docs/calibration.schema.json"
    );
}
