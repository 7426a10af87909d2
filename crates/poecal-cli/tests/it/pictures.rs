//! Corners in pixels on the command line, by the files of the guide.

use std::path::Path;

use crate::folder::Folder;

/// A command on the files of the guide; its words begin with the model.
fn words(command: &str, files: &str, more: &str) -> String {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let (model, howto) = (examples.join("elbow/robot.urdf"), examples.join("howto"));
    let files: Vec<String> = files.split_whitespace().map(|name| howto.join(name).display().to_string()).collect();
    let camera = howto.join("lens.csv");
    let before = if command == "plan" { "--rows " } else { "" };
    let files: Vec<String> = files.iter().map(|file| format!("{before}{file}")).collect();
    format!("{command} {} {} --camera {} {more}", model.display(), files.join(" "), camera.display())
}

const BOARD: &str = "--markers chessboard:6x5:40mm";

#[test]
fn a_list_of_pictures_says_what_pictures_determine() {
    let folder = Folder::new();
    let files = "pictures.csv corners.csv";
    let out = folder.run_to_success(&words("plan", files, &format!("{BOARD} --json")));
    let found: serde_json::Value = serde_json::from_str(&out).unwrap();
    let rank = &found["identifiability"]["rank"];
    let mean_mm = found["expected_error"]["position_mean_mm"].as_f64().unwrap();
    println!("rank {rank}, {mean_mm:.3} mm expected of {}", found["pictures"]);
    assert_eq!((rank, &found["kind"]), (&serde_json::json!(30), &serde_json::json!("picture")));
    // 50 pictures that are known to 1 mm and 1 mrad.
    assert!((0.5..2.0).contains(&mean_mm), "{mean_mm}");
    let points = folder.run(&words("plan", "../elbow/points.csv", BOARD));
    assert!(points.code == 2 && points.err.contains("expected corners with u[px] and v[px]"), "{}", points.err);
}

#[test]
fn joints_of_pictures_without_corners_are_named() {
    let folder = Folder::new();
    for command in ["calibrate", "check", "plan"] {
        let said = folder.run(&words(command, "pictures.csv", BOARD));
        println!("{command}: {}", said.err);
        assert_eq!(said.code, 2, "{}", said.err);
        assert!(said.err.contains("50 pictures and no corners, expected a second file"), "{}", said.err);
    }
    assert!(!folder.path("poecal-out").exists());
}
