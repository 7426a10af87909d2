//! `poecal simulate --camera`: pictures with detectable boards that calibrate an arm, and refused options.

use std::fs;
use std::path::Path;

use crate::folder::Folder;

const MODEL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/elbow/robot.urdf");

#[test]
fn simulated_pictures_calibrate_the_robot_wherever_the_camera_is() {
    for (place, spec) in [
        ("in-hand", "charuco:7x5:36mm:26mm:DICT_4X4_50"),
        ("beside", "circles:4x7:26mm:asymmetric"),
        ("in-hand", "aprilgrid:4x3:40mm:0.3"),
    ] {
        let folder = Folder::new();
        fs::copy(Path::new(MODEL), folder.path("robot.urdf")).unwrap();
        let simulate =
            format!("simulate robot.urdf --camera {place} --board {spec} --errors 0.2deg,0.5mm --count 20 --out s");
        folder.run_to_success(&simulate);
        if place == "beside" {
            let first = folder.listing();
            folder.run_to_success(&format!("{simulate} --force"));
            assert!(folder.listing() == first, "another session of the same seed");
        }
        folder.run_to_success(&format!("detect s --board {spec} --out corners.csv"));
        let words = "calibrate s/nominal.urdf s/joints.csv corners.csv --camera s/cameras.csv --out results --verbose";
        let said = folder.run_to_success(&format!("{words} --markers {spec}"));
        let line = said.lines().find(|line| line.starts_with("held out")).unwrap();
        println!("{place}, {spec}: {line}");
        // The stationary object, or the one on the tip, is the board: its pose is the truth of the session.
        let number = |file: &str, keys: &[&str]| -> Vec<f64> {
            let all: serde_json::Value = serde_json::from_str(&folder.read(file)).unwrap();
            let found = keys.iter().fold(&all, |it, key| &it[*key]);
            found["quaternion_xyzw"].as_array().unwrap().iter().map(|it| it.as_f64().unwrap()).collect()
        };
        if place == "in-hand" {
            let truth = number("s/truth.json", &["base_from_other"]);
            let found = number("results/calibration.json", &["measurement_frame", "base_from_device"]);
            let same: f64 = truth.iter().zip(&found).map(|(a, b)| a * b).sum();
            // Within a degree: errors of the axes of 0.2° turn the base.
            println!("turned by {:.3} deg from the truth", 2.0 * same.abs().min(1.0).acos().to_degrees());
            assert!(same.abs() > 0.5_f64.to_radians().cos(), "{truth:?} {found:?}");
        }
        // Corners to some 0.03 px, and an arm with errors of 0.05 mm and 0.01° in each configuration: 0.1 mm at 0.4 m, of 1,000 px.
        let px: f64 = line.split_whitespace().nth(4).unwrap().parse().unwrap();
        assert!(px < 0.6, "{line}");
    }
}

#[test]
fn what_pictures_cannot_be_of_is_said_in_one_line_and_nothing_is_written() {
    let folder = Folder::new();
    fs::copy(Path::new(MODEL), folder.path("robot.urdf")).unwrap();
    let before = folder.listing();
    for (words, expected) in [
        ("--camera in-hand --kind point", "cannot be used with"),
        ("--camera in-hand --count 1000", "expected at most 999 pictures"),
        ("--camera in-hand --board tags:36h11:40mm", "expected a board"),
        ("--camera in-hand --board charuco:7x5", "found the board"),
        ("--camera above", "in-hand"),
        ("--board chessboard:10x7:27mm", "--camera"),
    ] {
        let run = folder.run(&format!("simulate robot.urdf --out s {words}"));
        println!("{words}: {}", run.err.lines().next().unwrap_or_default());
        assert!(run.code == 2 && run.err.contains(expected), "{words}: {} {}", run.code, run.err);
        assert!(folder.listing() == before, "{words} wrote something");
    }
}
