//! Every command end to end, on simulated measurements.

use poecal_calibrate::AcceptedModel;
use poecal_import as measurements;
use poecal_import::ReadOptions;
use poecal_model::simulate::{SessionKind, Simulation};
use poecal_results::calibration_file::CalibrationFile;

use crate::folder::Folder;
use crate::session::{ROBOT, calibration, numbers, session, write_measurements};

#[test]
fn calibrate_writes_its_folder_and_tells_three_models() {
    let folder = session(SessionKind::POSE);
    let out = folder.run_to_success("calibrate robot.urdf measurements.csv --verbose");
    for words in [
        "nominal   registered   calibrated",
        "training (42)",
        "held out (18)",
        "60 rows: 42 fitted, 18 held out",
        "determined    30 of 30 unknowns, from 42 of 60 rows",
    ] {
        assert!(out.contains(words), "`{words}` is not in\n{out}");
    }
    let files = ["measurements.csv", "poecal-out", "robot.urdf"].map(|name| folder.path(name));
    let results =
        ["calibrated.urdf", "calibration.json", "report.html", "residuals.csv"].map(|name| files[1].join(name));
    let mut expected: Vec<_> = files.into_iter().chain(results).collect();
    expected.sort();
    assert_eq!(folder.listing().into_keys().collect::<Vec<_>>(), expected);
    let held_out = calibration(&folder, "poecal-out").accuracy.held_out.unwrap();
    println!("held out, calibrated: {:?}", held_out.calibrated);
    // Simulated noise: 0.05 mm and 0.01 degrees for each component.
    assert!(held_out.calibrated.position_mm().rms < 0.2 && held_out.nominal.position_mm().rms > 5.0);
    assert!(held_out.calibrated.rotation_deg().unwrap().rms < 0.04);
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
    let folder = session(SessionKind::POSE);
    folder.run_to_success("calibrate robot.urdf measurements.csv");
    let calibrated = folder.read("poecal-out/calibrated.urdf");
    assert_ne!(calibrated, ROBOT);
    // Comments, blanks and everything else are the input's, byte for byte; the tool's mount got an `rpy` that it did not have.
    assert_eq!(without_placements(&calibrated), without_placements(ROBOT));
    assert!(without_placements(ROBOT).contains("<!-- The elbow manipulator of Lou"));
}

#[test]
fn training_figures_are_never_shown_without_the_word() {
    let folder = session(SessionKind::MIXED);
    write_measurements(
        &folder,
        "other.csv",
        SessionKind::MIXED,
        "",
        &Simulation { count: 25, noise_position_m: 6e-5, ..Simulation::default() },
    );
    for arguments in ["--validate other.csv", "--held-out 0", "--train-where stage=1", ""] {
        let out =
            folder.run_to_success(&format!("calibrate robot.urdf measurements.csv --force --verbose {arguments}"));
        // Each block of figures begins with a row that names its set; the first block of a table is the training one.
        let mut set = "";
        for line in out.lines() {
            if line.starts_with("position, mm") || line.starts_with("rotation, deg") || line.is_empty() {
                set = "";
            }
            for name in ["training (", "held out (", "fitted ("] {
                if line.trim_start().starts_with(name) {
                    set = name;
                }
            }
            let is_row = |row: &&str| line.trim_start().starts_with(*row);
            let is_figure = ["mean ", "RMS ", "95 % ", "max "].iter().any(is_row);
            assert!(!is_figure || !set.is_empty(), "figures without their set:\n{out}");
        }
    }
    let found = folder.run("validate poecal-out/calibration.json poecal-out/../measurements.csv other.csv");
    let warning = "measurements.csv: the calibration was made of this file, so it fits these rows better than new ones";
    assert!(found.err.contains(warning) && !found.err.contains("other.csv: the calibration"), "{}", found.err);
    let out = folder.run_to_success("validate poecal-out/calibration.json measurements.csv --refit device,tool");
    assert!(out.contains("device frame and tool: fitted to these measurements, so training"), "{out}");
}

#[test]
fn what_is_held_out_can_be_said() {
    let folder = session(SessionKind::POSE);
    let out = folder.run_to_success("calibrate robot.urdf measurements.csv --held-out 0 --out all --verbose");
    assert!(out.contains("held out        none: every measurement was fitted"), "{out}");
    assert!(out.contains("no row was held out: these errors are of fitted rows"), "{out}");
    let json: serde_json::Value = serde_json::from_str(&folder.read("all/calibration.json")).unwrap();
    assert_eq!(json["accuracy"]["held_out"], serde_json::Value::Null);
    assert_eq!(json["accuracy"]["training"]["count"], 60);

    folder.run_to_success("simulate robot.urdf --count 20 --out few");
    let of_few = "calibrate few/nominal.urdf few/measurements.csv --force --out few/out";
    let said = "all 20 configurations were fitted, since fewer than 12 would judge (--held-out 0.3 holds them out); cross-validation ";
    let out = folder.run_to_success(of_few);
    let words = out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains(said), "{out}");
    let file = calibration(&folder, "few/out");
    let left_out = file.cross_validation.as_ref().unwrap().random.rms.lead();
    let accuracy = &file.accuracy;
    assert_eq!((accuracy.few_configurations, accuracy.held_out.is_none()), (Some(20), true));
    // Other checks compare with the error of rows that were left out.
    assert_eq!(file.own_rms(AcceptedModel::Calibrated), left_out);
    assert!(left_out > accuracy.training.calibrated.position_mm().rms);
    folder.run_to_success(&format!("{of_few} --held-out 0.3"));
    assert_eq!(calibration(&folder, "few/out").accuracy.held_out.unwrap().count, 6);

    let out = folder.run_to_success("calibrate robot.urdf measurements.csv --train-where stage=1 --out stage");
    assert!(out.contains("from 40 of 60 rows") && out.contains("\nheld out      20 rows, at most "), "{out}");

    let simulation = Simulation { count: 60, seed: 1, ..Simulation::default() };
    write_measurements(
        &folder,
        "other.csv",
        SessionKind::POSE,
        "",
        &Simulation { count: 25, noise_position_m: 6e-5, ..simulation },
    );
    let out = folder.run_to_success("calibrate robot.urdf measurements.csv --validate other.csv --out other");
    assert!(out.contains("from 60 of 85 rows") && out.contains("\nheld out      25 rows, at most "), "{out}");

    for stated in ["--train-where stage=1", "--validate other.csv"] {
        let run = folder.run(&format!("calibrate robot.urdf measurements.csv --force {stated} --held-out 0"));
        assert_eq!(run.code, 0, "{}", run.err);
        // With --validate no more is held out than that file.
        let rows = if stated.starts_with("--validate") { "\nheld out      25 rows" } else { "no row was held out" };
        assert!(run.out.contains(rows), "{}", run.out);
        let run = folder.run(&format!("calibrate robot.urdf measurements.csv --force {stated} --seed 2"));
        let seed = "warning: --seed has no effect on which rows are held out: that is stated\n";
        assert!(run.code == 0 && run.err.contains(seed), "{}", run.err);
    }
}

#[test]
fn json_is_the_file_and_quiet_is_silent() {
    let folder = session(SessionKind::POINT);
    let out = folder.run_to_success("calibrate robot.urdf measurements.csv --json");
    assert_eq!(out, folder.read("poecal-out/calibration.json"));
    let run = folder.run("calibrate robot.urdf measurements.csv --quiet --out quiet");
    assert_eq!((run.code, run.out.as_str(), run.err.as_str()), (0, "", ""));
    let run = folder.run("calibrate robot.urdf measurements.csv --out poecal-out");
    assert_eq!(run.code, 2, "an existing folder was overwritten");
    // If none is named, the next is new.
    folder.run_to_success("calibrate robot.urdf measurements.csv");
    assert_eq!(out, folder.read("poecal-out-2/calibration.json"));
    folder.write("poecal-out/residuals.csv", "old");
    folder.write("poecal-out/mine.txt", "mine");
    folder.run_to_success("calibrate robot.urdf measurements.csv --force");
    assert_ne!(folder.read("poecal-out/residuals.csv"), "old");
    assert_eq!(folder.read("poecal-out/mine.txt"), "mine");
}

#[test]
fn threads_do_not_change_a_byte() {
    let folder = session(SessionKind::MIXED);
    let one = folder.run_to_success("calibrate robot.urdf measurements.csv --threads 1 --out one --json");
    let two = folder.run_to_success("calibrate robot.urdf measurements.csv --threads 2 --out two --json");
    assert_eq!(one, two);
    for name in ["calibration.json", "calibrated.urdf", "residuals.csv"] {
        assert_eq!(folder.read(&format!("one/{name}")), folder.read(&format!("two/{name}")), "{name}");
    }
}

#[test]
fn predictions_are_those_of_the_model() {
    let folder = session(SessionKind::POSE);
    folder.run_to_success("calibrate robot.urdf measurements.csv");
    let out = folder.run_to_success("predict poecal-out/calibration.json measurements.csv");
    assert_eq!(out.lines().next(), Some("id,x[m],y[m],z[m],qx,qy,qz,qw"));
    assert!(out.lines().nth(1).unwrap().starts_with("row0,"));
    let file = calibration(&folder, "poecal-out");
    let robot = file.robot().unwrap();
    let data = measurements::read(&[folder.path("measurements.csv")], &robot, &ReadOptions::default()).unwrap().data;
    for (row, predicted) in numbers(&out, 1).iter().enumerate() {
        let pose = robot.forward_kinematics(data.readings(row));
        let position: [f64; 3] = pose.translation.into();
        // Equal to the bit, since numbers are written so that they read back.
        assert_eq!(predicted[..3], position);
        assert_eq!(predicted[3..], pose.quaternion_xyzw());
        assert!(predicted[6] >= 0.0);
    }
    // In the device's frame, predictions equal the measurements, except for the noise.
    let out = folder
        .run_to_success("predict poecal-out/calibration.json measurements.csv --output-frame device --out seen.csv");
    assert_eq!(out, "");
    for (row, predicted) in numbers(&folder.read("seen.csv"), 1).iter().enumerate() {
        let measured = data.observations[row].measurement.pose();
        let distance = (0..3).map(|k| (predicted[k] - measured.translation[k]).powi(2)).sum::<f64>().sqrt();
        assert!(distance < 5e-4, "row {row}: {distance} m");
    }
    // The calibrated URDF is the same robot.
    let urdf = numbers(&folder.run_to_success("predict poecal-out/calibrated.urdf measurements.csv"), 1);
    let json = numbers(&folder.run_to_success("predict poecal-out/calibration.json measurements.csv"), 1);
    for (a, b) in urdf.iter().flatten().zip(json.iter().flatten()) {
        assert!((a - b).abs() < 1e-12);
    }
}

#[test]
fn the_device_is_the_base_where_that_was_given() {
    let folder = session(SessionKind::POSE);
    let at_base = Simulation { count: 60, device_anywhere: false, ..Simulation::default() };
    write_measurements(&folder, "base.csv", SessionKind::POSE, "", &at_base);
    folder.run_to_success("calibrate robot.urdf base.csv --device-frame base");
    assert_eq!(
        folder.run_to_success("predict poecal-out/calibration.json base.csv --output-frame device"),
        folder.run_to_success("predict poecal-out/calibration.json base.csv --output-frame base --target measured")
    );
}

#[test]
fn check_says_what_it_understood() {
    let folder = session(SessionKind::MIXED);
    folder.write("ids.csv", "id;set;joint1[deg];joint2;joint3;joint4;joint5;joint6;x[mm];y[mm];z[mm];note\nr1;fit;-90;0,5;0;0;0;0;700;0;500;a\nr2;held_out;90;0,25;0;0;0;0;700;10;500;b\n");
    let out = folder.run_to_success("check robot.urdf measurements.csv ids.csv");
    for words in [
        "robot         elbow: 6 revolute, from base_link to tool",
        "joint3: revolute about (0, -1, 0) through (150, 0, 570) mm, from",
        "rows          60: 30 poses and 30 points",
        "orientation   quaternion x, y, z, w; device_from_target",
        "separator: semicolon; decimal sign: comma",
        "joint1    joint1[deg]    deg, header   -90 to 90 deg",
        "joint2    joint2         rad, SI       14.324 to 28.648 deg",
        "y         y[mm]          mm, header    0 to 10 mm",
        "ignored       note",
        "sets          1 to fit, 1 held out, 60 not stated (fitted)",
        "warnings      measurements.csv: ignored the columns `stage`",
        "ids.csv: ignored the columns `note`",
    ] {
        assert!(out.contains(words), "`{words}` is not in\n{out}");
    }
    assert!(out.lines().all(|line| line.chars().count() <= 80), "{out}");
    let out = folder.run_to_success("check robot.urdf measurements.csv --train-where stage=1");
    assert!(out.contains("sets          40 to fit, 20 held out"), "{out}");

    let json: serde_json::Value =
        serde_json::from_str(&folder.run_to_success("check robot.urdf ids.csv --json")).unwrap();
    assert_eq!(json["model"]["joints"][1]["point_m"], serde_json::json!([0.15, 0.0, 0.0]));
    assert_eq!(json["files"][0]["separator"], "semicolon");
    assert_eq!(json["sets"], serde_json::json!({"fit": 1, "held_out": 1, "unstated": 0}));
    assert_eq!(json["warnings"].as_array().unwrap().len(), 1);
    let json: serde_json::Value = serde_json::from_str(&folder.run_to_success("check robot.urdf --json")).unwrap();
    assert_eq!((&json["sets"], &json["files"]), (&serde_json::Value::Null, &serde_json::json!([])));
}

#[test]
fn convert_gives_the_same_robot_in_another_form() {
    let folder = session(SessionKind::POSE);
    folder.run_to_success("calibrate robot.urdf measurements.csv");
    let run = folder.run("export robot.urdf --format toml");
    assert!(run.out.starts_with("poecal_robot = 1\n"));
    assert_eq!(
        run.err,
        "warning: link frames, fixed joints, meshes and inertias are not part of a TOML model and were left out\n"
    );
    assert_eq!(folder.run_to_success("export robot.urdf --out robot.toml"), "");
    assert_eq!(folder.read("robot.toml"), run.out);
    folder.run_to_success("export poecal-out/calibration.json --out again.urdf");
    folder.run_to_success("export again.urdf --tip-link tool --format toml --out again.toml");
    for (a, b) in
        [("robot.urdf", "robot.toml"), ("poecal-out/calibration.json", "again.urdf"), ("again.urdf", "again.toml")]
    {
        let of = |name: &str| numbers(&folder.run_to_success(&format!("predict {name} measurements.csv")), 1);
        for (a, b) in of(a).iter().flatten().zip(of(b).iter().flatten()) {
            assert!((a - b).abs() < 1e-12);
        }
    }
}

#[test]
fn the_schema_in_the_docs_is_the_programs() {
    let printed = Folder::new().run_to_success("schema");
    assert_eq!(printed, CalibrationFile::json_schema());
    let kept = include_str!("../../../../docs/calibration.schema.json");
    assert!(printed == kept, "write it anew: cargo run -p poecal-cli -- schema > docs/calibration.schema.json");
}

#[test]
#[cfg(target_os = "linux")]
fn a_result_that_does_not_arrive_is_an_error_unless_its_reader_has_gone() {
    let folder = session(SessionKind::POINT);
    folder.run_to_success("calibrate robot.urdf measurements.csv");
    for arguments in [
        "calibrate robot.urdf measurements.csv --force",
        "calibrate robot.urdf measurements.csv --force --json",
        "validate poecal-out/calibration.json measurements.csv",
        "check robot.urdf measurements.csv",
        "simulate robot.urdf --out made --force",
    ] {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let run = folder.run_into(arguments, full);
        // 2 states that nothing was written.
        assert_eq!(run.code, if arguments.contains("--force") { 1 } else { 2 }, "poecal {arguments}");
        assert!(run.err.contains("error: standard output cannot be written to ("), "{}", run.err);
        let run = folder.run_unread(arguments);
        assert!(run.code == 0 && !run.err.contains("error"), "poecal {arguments}\n{}", run.err);
    }
}
