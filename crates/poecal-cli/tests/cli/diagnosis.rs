//! Mistakes in the input are told as people look for them.

use poecal::forensics::DiagnosisKind;
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
