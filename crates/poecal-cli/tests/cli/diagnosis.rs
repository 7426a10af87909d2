//! Mistakes in the input are told as people look for them.

use std::fmt::Write as _;

use poecal::forensics::DiagnosisKind;
use poecal::io::measurements::{ReadOptions, read};
use poecal::io::model::Model;
use poecal::simulate::Kind;

use crate::session::{calibration, session};

#[test]
fn exchanged_columns_are_named_with_evidence() {
    let folder = session(Kind::Pose);
    let text = folder.read("measurements.csv");
    let header = text.lines().next().unwrap();
    let exchanged = header.replace("joint4", "other").replace("joint5", "joint4").replace("other", "joint5");
    folder.write("measurements.csv", text.replacen(header, &exchanged, 1));
    let checked = folder.done("check robot.urdf measurements.csv");
    assert!(
        checked.contains("diagnosis     exchanging the readings of joint4 and joint5 lowers"),
        "no diagnosis in\n{checked}"
    );
    let run = folder.run("calibrate robot.urdf measurements.csv");
    println!("{}", run.err);
    assert!(run.err.contains("warning: exchanging the readings of joint4 and joint5 lowers the registered"));
    assert!(run.err.contains("(RMS): check the order of the joint columns"));
    let file = calibration(&folder, "poecal-out");
    assert_eq!(file.diagnosis.len(), 1);
    assert_eq!(file.diagnosis[0].kind, DiagnosisKind::JointsSwapped);
    assert!(file.diagnosis[0].rows.is_empty());
}

#[test]
fn rows_that_stand_twice_are_named_by_their_lines() {
    let folder = session(Kind::Point);
    let text = folder.read("measurements.csv");
    let copied = text.lines().nth(3).unwrap();
    folder.write("measurements.csv", format!("{text}{copied}\n"));
    let run = folder.run("calibrate robot.urdf measurements.csv");
    println!("{}", run.err);
    let expected = "warning: 1 row repeats another to the last digit, readings and measurement \
                    (measurements.csv:62 as measurements.csv:4): leave out what was copied, since it counts twice";
    assert!(run.err.contains(expected));
    assert_eq!(calibration(&folder, "poecal-out").diagnosis[0].rows, [60]);
}

#[test]
fn targets_without_names_are_told_to_be_named() {
    let folder = session(Kind::Pose);
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
        serde_json::from_str(&folder.done("check robot.urdf measurements.csv --json")).unwrap();
    assert_eq!(checked["diagnosis"].as_array().unwrap().len(), 1, "{checked}");
    assert_eq!(checked["diagnosis"][0]["kind"], "targets_unnamed");
    assert_eq!(checked["diagnosis"][0]["statement"], statement);
    let run = folder.run("calibrate robot.urdf measurements.csv");
    assert!(run.err.contains("add a column `target` that names which one each row saw"), "{}", run.err);
    let words = run.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("verdict do not use: "), "{}", run.out);
    assert!(!run.err.contains("look which is right"), "{}", run.err);
}
