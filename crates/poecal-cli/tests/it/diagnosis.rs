//! Mistakes in the input are reported in the words by which people search for them.

use std::fmt::Write as _;

use poecal_arm::lie::{Pose, rotation};
use poecal_fit::forensics::DiagnosisKind;
use poecal_import::{ReadOptions, read};
use poecal_model::simulate::SessionKind;
use poecal_results::model::Model;

use crate::session::{calibration, session};

#[test]
fn exchanged_columns_are_named_with_evidence() {
    let folder = session(SessionKind::POSE);
    let text = folder.read("measurements.csv");
    let header = text.lines().next().unwrap();
    let exchanged = header.replace("joint4", "other").replace("joint5", "joint4").replace("other", "joint5");
    folder.write("measurements.csv", text.replacen(header, &exchanged, 1));
    let checked = folder.run_to_success("check robot.urdf measurements.csv");
    assert!(
        checked.contains("diagnosis     exchanging the readings of joint4 and joint5 lowers"),
        "no diagnosis in\n{checked}"
    );
    let run = folder.run("calibrate robot.urdf measurements.csv");
    println!("{}", run.out);
    let words = run.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        words.starts_with("verdict do not use: exchanging the readings of joint4 and joint5 lowers the registered")
    );
    assert!(words.contains("(RMS): check the order of the joint columns") && run.code == 1);
    let file = calibration(&folder, "poecal-out");
    assert_eq!(file.diagnosis.len(), 1);
    assert_eq!(file.diagnosis[0].kind, DiagnosisKind::JointsSwapped);
    assert!(file.diagnosis[0].rows.is_empty());
}

/// The session with its quaternions replaced by three columns.
fn with_turns(text: &str, names: &str, turns: impl Fn(&Pose) -> [f64; 3]) -> String {
    let mut out = String::new();
    for (row, line) in text.lines().enumerate() {
        let cells: Vec<&str> = line.split(',').collect();
        let (kept, quaternion) = cells.split_at(cells.len() - 4);
        let last = if row == 0 {
            names.to_owned()
        } else {
            let parts: Vec<f64> = quaternion.iter().map(|part| part.parse().unwrap()).collect();
            let pose = Pose::from_position_quaternion([0.0; 3], parts.try_into().unwrap());
            turns(&pose).map(|angle| format!("{angle:?}")).join(",")
        };
        writeln!(out, "{},{last}", kept.join(",")).unwrap();
    }
    out
}

#[test]
fn angles_of_a_controller_that_are_called_roll_pitch_yaw_are_named_with_the_mapping_that_reads_them() {
    let folder = session(SessionKind::POSE);
    // KUKA's A turns about z, B about y, C about x: yaw, pitch, roll.
    let abc = |pose: &Pose| {
        let [roll, pitch, yaw] = rotation::to_rpy(&pose.rotation);
        [yaw, pitch, roll].map(f64::to_degrees)
    };
    let text = folder.read("measurements.csv");
    folder.write("kuka.csv", with_turns(&text, "roll[deg],pitch[deg],yaw[deg]", abc));
    let checked = folder.run_to_success("check robot.urdf kuka.csv --json");
    let found: serde_json::Value = serde_json::from_str(&checked).unwrap();
    let statement = found["diagnosis"][0]["statement"].as_str().unwrap();
    println!("{statement}");
    assert!(statement.starts_with(
        "taking the orientation as intrinsic zyx angles (KUKA's A, B, C) instead of roll, pitch, yaw (extrinsic xyz) lowers the "
    ));
    assert!(statement.contains(
        "a mapping (--columns) with `form = \"intrinsic_zyx\"` and `columns = [\"roll\", \"pitch\", \"yaw\"]` under `[orientation]`"
    ));
    folder.write("map.toml", "[orientation]\nform = \"intrinsic_zyx\"\ncolumns = [\"roll\", \"pitch\", \"yaw\"]\n");
    assert!(!folder.run_to_success("check robot.urdf kuka.csv --columns map.toml").contains("diagnosis"));
}

#[test]
fn rotation_vectors_in_degrees_are_no_radians() {
    let folder = session(SessionKind::POSE);
    let vector = |pose: &Pose| -> [f64; 3] { rotation::log(&pose.rotation).map(f64::to_degrees).into() };
    let text = folder.read("measurements.csv");
    folder.write("ur.csv", with_turns(&text, "rx,ry,rz", vector));
    let run = folder.run("check robot.urdf ur.csv");
    assert_eq!(run.code, 2);
    assert!(
        run.err.starts_with("error: ur.csv:2:") && run.err.contains("as `rx[deg]`, `ry[deg]`, `rz[deg]`"),
        "{}",
        run.err
    );
    folder.write("ur.csv", with_turns(&text, "rx[deg],ry[deg],rz[deg]", vector));
    assert!(!folder.run_to_success("check robot.urdf ur.csv").contains("diagnosis"));
}

#[test]
fn rows_that_stand_twice_are_named_by_their_lines() {
    let folder = session(SessionKind::POINT);
    let text = folder.read("measurements.csv");
    let copied = text.lines().nth(3).unwrap();
    folder.write("measurements.csv", format!("{text}{copied}\n"));
    let run = folder.run("calibrate robot.urdf measurements.csv");
    println!("{}", run.out);
    let expected = "look at 1 row repeats another to the last digit, readings and measurement \
                    (measurements.csv:62 as measurements.csv:4): remove the copies, since they count twice";
    assert!(run.out.split_whitespace().collect::<Vec<_>>().join(" ").contains(expected));
    assert_eq!(calibration(&folder, "poecal-out").diagnosis[0].rows, [60]);
}

#[test]
fn targets_without_names_are_told_to_be_named() {
    let folder = session(SessionKind::POSE);
    let model = Model::read(folder.path("robot.urdf"), &Default::default()).unwrap();
    let data = read(&[folder.path("measurements.csv")], &model.robot, &ReadOptions::default()).unwrap().data;
    // Along axes of the tool.
    let places = [(0, 0.0), (1, 0.06), (0, 0.08)];
    let mut text = format!("{},x,y,z\n", data.reading_names().join(","));
    for (row, observation) in data.observations.iter().enumerate() {
        let readings: Vec<String> = data.readings(row).iter().map(|reading| format!("{reading:?}")).collect();
        let pose = observation.measurement.pose();
        for (axis, metres) in places {
            let [x, y, z]: [f64; 3] = (pose.translation + pose.rotation.column(axis) * metres).into();
            writeln!(text, "{},{x:?},{y:?},{z:?}", readings.join(",")).unwrap();
        }
    }
    folder.write("measurements.csv", text);
    let statement = "each of 60 configurations has rows at 3 places that are always 60.0 to 100 mm apart (such as \
                     measurements.csv:2 and measurements.csv:3), as 3 targets are: add a column `target` that names \
                     which one each row saw";
    let checked: serde_json::Value =
        serde_json::from_str(&folder.run_to_success("check robot.urdf measurements.csv --json")).unwrap();
    assert_eq!(checked["diagnosis"].as_array().unwrap().len(), 1, "{checked}");
    assert_eq!(checked["diagnosis"][0]["kind"], "targets_unnamed");
    assert_eq!(checked["diagnosis"][0]["statement"], statement);
    let run = folder.run("calibrate robot.urdf measurements.csv");
    let words = run.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("add a column `target` that names which one each row saw"), "{}", run.out);
    assert!(words.starts_with("verdict do not use: ") && run.code == 1, "{}", run.out);
    assert!(!words.contains("check which is right"), "{}", run.out);
}

#[test]
fn readings_in_per_cent_of_the_range_are_named_with_the_mapping_that_reads_them() {
    let folder = session(SessionKind::POSE);
    let text = folder.read("measurements.csv");
    let mut rows = text.lines();
    let mut made = rows.next().unwrap().to_owned();
    // Half the ranges of the joints' limits, degrees.
    let half = [180.0, 140.0, 160.0, 180.0, 130.0, 360.0];
    for row in rows {
        let mut cells: Vec<String> = row.split(',').map(str::to_owned).collect();
        for (cell, half) in cells[3..9].iter_mut().zip(half) {
            *cell = format!("{:.6}", cell.parse::<f64>().unwrap().to_degrees() / half * 100.0);
        }
        made.push('\n');
        made.push_str(&cells.join(","));
    }
    folder.write("percent.csv", &made);
    let run = folder.run("calibrate robot.urdf percent.csv --out results");
    println!("{}", run.err);
    assert_eq!(run.code, 2);
    // As the sentence advises.
    let mut called = made;
    for joint in 1..=6 {
        called = called.replacen(&format!("joint{joint}"), &format!("joint{joint}[deg]"), 1);
    }
    folder.write("called.csv", called);
    let run = folder.run("check robot.urdf called.csv --json");
    let found: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    let statement = found["diagnosis"][0]["statement"].as_str().unwrap();
    println!("{statement}");
    assert!(statement.contains("per cent of the joints' ranges, -100 to 100"), "{statement}");
    // The lines that it names, in a mapping.
    let lines =
        statement.split('`').filter(|it| it.starts_with("joint") || it.starts_with('[')).collect::<Vec<_>>().join("\n");
    folder.write("map.toml", lines);
    let told = folder.run_to_success("calibrate robot.urdf called.csv --columns map.toml --out results");
    assert!(told.starts_with("verdict       good"), "{told}");
}

/// For a file that moves a joint beyond the tip link, the message names the link to state instead; there is no message if the column is of no joint.
#[test]
fn readings_of_a_joint_beyond_the_tip_link_are_named() {
    let folder = session(SessionKind::POINT);
    let run = folder.run("calibrate robot.urdf measurements.csv --tip-link link5");
    let words = "measurements.csv: has readings of `joint6`, beyond the tip link: if what was measured moves with it, state the link that carries it, \
                 like `--tip-link tool`";
    assert!(run.err.contains(words), "{}", run.err);
    let run = folder.run("calibrate robot.urdf measurements.csv");
    assert!(!run.err.contains("beyond the tip link"), "{}", run.err);
}
