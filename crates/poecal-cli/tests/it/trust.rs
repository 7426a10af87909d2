//! The verdict, and the uncertainty of predictions.

use poecal_model::simulate::SessionKind;

use crate::folder::Folder;
use crate::session::session;

fn json(folder: &Folder, name: &str) -> serde_json::Value {
    serde_json::from_str(&folder.read(name)).unwrap()
}

/// Measurements in which joint2 hardly moves.
fn folder_with_narrow_range() -> Folder {
    let folder = session(SessionKind::POSE);
    let text = folder.read("measurements.csv");
    let mut kept = vec![text.lines().next().unwrap().to_owned()];
    let column = kept[0].split(',').position(|name| name == "joint2").unwrap();
    let small = |line: &&str| line.split(',').nth(column).unwrap().parse::<f64>().unwrap().abs() < 1.0;
    kept.extend(text.lines().skip(1).filter(small).map(str::to_owned));
    folder.write("narrow.csv", kept.join("\n") + "\n");
    folder
}

/// A required gain is shown: a file that does not state a gain ends with 1, without a warning.
#[test]
fn a_gain_that_is_asked_for_is_shown() {
    let folder = session(SessionKind::POSE);
    folder.run_to_success("calibrate robot.urdf measurements.csv --out all --require-gain");
    // One row far from singularities.
    folder.write("joints.csv", "joint1,joint2,joint3,joint4,joint5,joint6\n0.3,-0.5,0.8,0.4,0.7,0.2\n");
    let joints = "compensate all/calibration.json joints.csv --dry-run --require-gain";
    let run = folder.run(joints);
    assert_eq!(run.code, 0, "{run:?}");
    let mut file = json(&folder, "all/calibration.json");
    for (gain, is_said) in [(Some("unclear"), true), (None, false)] {
        let verdict = file["verdict"].as_object_mut().unwrap();
        verdict.remove("gain");
        verdict.extend(gain.map(|gain| ("gain".to_owned(), gain.into())));
        folder.write("all/calibration.json", file.to_string());
        let run = folder.run(joints);
        assert_eq!(run.code, 1, "{run:?}");
        assert_eq!(run.err.contains("do not correct programs with this calibration"), is_said, "{run:?}");
    }
}

#[test]
fn verdict_says_how_far_a_calibration_may_be_used() {
    let folder = folder_with_narrow_range();
    let good = folder.run("calibrate robot.urdf measurements.csv --out all --require good");
    assert_eq!(good.code, 0, "{good:?}");
    assert_eq!(json(&folder, "all/calibration.json")["verdict"]["level"], "good");

    let run = folder.run("calibrate robot.urdf narrow.csv --out some --require good");
    assert_eq!(run.code, 1, "{run:?}");
    let words = run.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.starts_with("verdict use inside the sampled range before "), "{words}");
    assert!(words.contains("valid inside the sampled range: joint2 was moved through"), "{words}");
    let file = json(&folder, "some/calibration.json");
    assert_eq!(file["verdict"]["level"], "inside_sampled_range");
    assert!(file["coverage"][1]["sampled_max"].as_f64().unwrap() < 1.0);
    let enough = folder.run("calibrate robot.urdf narrow.csv --out some --force --require inside_sampled_range");
    assert_eq!(enough.code, 0, "{enough:?}");
    for file in [json(&folder, "all/calibration.json"), file] {
        assert!(file["cross_validation"]["random"]["rms"]["position_mm"].as_f64().unwrap() > 0.0);
        assert_eq!(file["cross_validation"]["blocked"].as_array().unwrap().len(), 12);
        for correction in file["corrections"].as_array().unwrap() {
            assert!(
                correction["sigma"]["shift_mm"].as_f64().unwrap() < correction["axis"]["shift_mm"].as_f64().unwrap()
            );
            assert!(correction["left_nominal_rms_mm"].as_f64().unwrap() > 0.1);
        }
    }
}

#[test]
fn predictions_state_their_error() {
    let folder = folder_with_narrow_range();
    folder.run_to_success("calibrate robot.urdf narrow.csv --out some");
    folder.write(
        "joints.csv",
        "id,joint1,joint2,joint3,joint4,joint5,joint6\na,0.3,-0.4,-0.9,1,0.2,-3\nb,1.3,2.9,-0.7,0,1,2\n",
    );
    let plain = folder.run_to_success("predict some/calibration.json joints.csv --target measured");
    let run = folder.run("predict some/calibration.json joints.csv --with-uncertainty");
    assert!(run.code == 0 && run.err.contains("predicted the measured target `measured`; --target tip"), "{run:?}");
    let text = run.out;
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(
        rows[0][8..],
        ["sigma_position[m]", "sigma_rotation[rad]", "bound95_position[m]", "inside_sampled_range"]
    );
    for (line, row) in plain.lines().zip(&rows) {
        assert_eq!(line, row[..8].join(","));
    }
    let number = |row: usize, column: usize| rows[row][column].parse::<f64>().unwrap();
    assert_eq!((rows[1][11], rows[2][11]), ("true", "false"));
    assert!(number(1, 8) > 1e-6 && number(1, 8) < number(1, 10) && number(1, 10) < 1e-3);
    assert!(number(2, 8) > number(1, 8), "{text}");
    let run = folder.run("predict robot.urdf joints.csv --with-uncertainty");
    assert!(run.code == 2 && run.err.contains("expected a calibration.json for --with-uncertainty"), "{run:?}");
}

#[test]
fn validation_says_whether_the_promise_was_kept() {
    let folder = folder_with_narrow_range();
    folder.run_to_success("calibrate robot.urdf measurements.csv --train-where stage=1 --out all");
    let run = folder.run("validate all/calibration.json measurements.csv --json");
    assert_eq!(run.code, 0, "{run:?}");
    let found: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    let promised = &found["promised"];
    let share = promised["position_mm"]["inside_bound95"].as_f64().unwrap();
    let expected = promised["position_mm"]["expected_rms"].as_f64().unwrap();
    assert!(promised["rotation_deg"]["inside_bound95"].as_f64().unwrap() > 0.85);
    let rms = found["calibrated"]["position_mm"]["rms"].as_f64().unwrap();
    println!("{:.1} % inside, expected {expected:.4} mm, found {rms:.4} mm", 100.0 * share);
    assert!(share > 0.85 && (0.7..1.4).contains(&(rms / expected)));
    assert!(promised["inside_sampled_range"].as_f64().unwrap() > 0.8);
    let text = folder.run_to_success("validate all/calibration.json measurements.csv");
    assert!(text.contains("inside their 95 % bounds"), "{text}");

    // A tool that was bent exceeds the bounds.
    let mut bent = json(&folder, "all/calibration.json");
    let home = bent["robot"]["base_from_tip_at_zero"]["position_m"][2].as_f64().unwrap();
    bent["robot"]["base_from_tip_at_zero"]["position_m"][2] = (home + 5e-4).into();
    folder.write("bent.json", bent.to_string());
    let run = folder.run("validate bent.json measurements.csv");
    assert!(run.err.contains("exceed their 95 % bound"), "{run:?}");
    // With the tool refitted, the screws are as expected.
    let anew = folder.run_to_success("validate bent.json measurements.csv --refit tool --json");
    let found: serde_json::Value = serde_json::from_str(&anew).unwrap();
    assert!(found["promised"]["position_mm"]["inside_bound95"].as_f64().unwrap() > 0.85, "{anew}");
}
