//! The shipped example agrees with its README, and simulated sessions have their stated errors.

use std::fs;

use crate::folder::Folder;
use crate::project::{output_of, root, run};

/// The command in the first line of a text file by which it was made.
fn command(text: &str) -> &str {
    text.lines().next().unwrap().strip_prefix("# simulated by: poecal ").unwrap()
}

#[test]
fn the_shipped_points_come_from_the_command_in_their_first_line() {
    let folder = Folder::new();
    let shipped = fs::read_to_string(root().join("examples/elbow/points.csv")).unwrap();
    output_of(command(&shipped), &folder.path("again"));
    assert_eq!(fs::read_to_string(folder.path("again/measurements.csv")).unwrap(), shipped);
    let readme = fs::read_to_string(root().join("examples/elbow/README.md")).unwrap();
    assert!(readme.contains(command(&shipped)), "the README names another command");
}

#[test]
fn both_models_of_the_example_are_the_same_robot() {
    let read = |name: &str| {
        let path = root().join("examples/elbow").join(name);
        poecal_results::model::Model::read(path, &Default::default()).unwrap().robot
    };
    let difference = poecal_formats::proof::Difference::from_robots(&read("robot.urdf"), &read("robot.toml"), 1000);
    // Rounding of the two texts' numbers along six joints.
    assert!(difference.is_within(1e-14, 1e-14), "{difference:?}");
}

#[test]
fn a_simulated_session_without_noise_is_calibrated_exactly() {
    for (model, kind) in [("robot.urdf", "mixed"), ("robot.toml", "point")] {
        let folder = Folder::new();
        let session = folder.path("session");
        let words = format!("simulate examples/elbow/{model} --kind {kind} --noise 0mm --held-out-count 20");
        output_of(&words, &session);
        let at = |name: &str| session.join(name).display().to_string();
        let words = format!(
            "calibrate {} {} --validate {} --json",
            at("nominal.urdf"),
            at("measurements.csv"),
            at("held_out.csv")
        );
        let calibration: serde_json::Value = serde_json::from_str(&output_of(&words, &folder.path("out"))).unwrap();
        let held_out = &calibration["accuracy"]["held_out"];
        assert_eq!(held_out["count"], 20);
        assert!(held_out["calibrated"]["position_mm"]["max"].as_f64().unwrap() < 1e-6, "{held_out}");
        assert!(held_out["registered"]["position_mm"]["rms"].as_f64().unwrap() > 1.0, "{held_out}");
    }
}

#[test]
fn the_truth_names_the_robot_that_was_measured() {
    let folder = Folder::new();
    let session = folder.path("session");
    output_of("simulate examples/elbow/robot.toml --device-frame base --noise 0.01deg,0.05mm", &session);
    let text = fs::read_to_string(session.join("truth.json")).unwrap();
    let truth: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(truth["measurement_frame"]["base_from_device"]["position_m"], serde_json::json!([0.0, 0.0, 0.0]));
    let model = poecal_results::model::Model::read(session.join("actual.urdf"), &Default::default()).unwrap();
    let screw = model.robot.joints[3].screw.v();
    for axis in 0..3 {
        let told = truth["joints"][3]["screw"]["v_m"][axis].as_f64().unwrap();
        assert!((told - screw[axis]).abs() < 1e-12);
    }
}

#[test]
fn mistakes_are_told_in_a_sentence_and_nothing_is_written() {
    let folder = Folder::new();
    let cases = [
        ("--errors 1deg,2deg", "found `1deg,2deg`, expected one length and one angle, like 2mm,1deg"),
        ("--noise 0.05", "found `0.05` without a unit, expected a number with a unit, like 2mm or 1deg"),
        ("--noise -1mm", "found `-1mm`, expected a number not below 0, with a unit, like 2mm or 1deg"),
        ("--count 0", "0 is not in 1..=10000000"),
        ("--base-link nobody", "nobody"),
    ];
    for (words, sentence) in cases {
        let run = run(&format!("simulate examples/elbow/robot.urdf {words}"), &folder.path("session"));
        assert_eq!(run.code, 2, "{words}: {}", run.err);
        assert!(run.err.contains(sentence), "{words}: {}", run.err);
        assert!(!folder.path("session").exists());
    }
    output_of("simulate examples/elbow/robot.urdf", &folder.path("session"));
    let again = run("simulate examples/elbow/robot.urdf", &folder.path("session"));
    assert!(again.err.contains("the output folder exists"));
}
