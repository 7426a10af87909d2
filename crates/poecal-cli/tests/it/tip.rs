//! The tip is the model's, and the measured object is a target of its own; with `--move-tip` the measured object becomes the tip.

use poecal_model::simulate::{SessionKind, Simulation};

use crate::folder::Folder;
use crate::session::{ROBOT, calibration, numbers, session, write_measurements};

/// Links beyond the last joint, with numbers that no computation repeats by chance.
const GRIPPER: &str = "  <link name=\"flange\"/>\n  <joint name=\"flange_mount\" type=\"fixed\">\n    <parent link=\"tool\"/>\n    \
    <child link=\"flange\"/>\n    <origin xyz=\"0.0123 -0.0456 0.0789\" rpy=\"0.11 -0.22 0.33\"/>\n  </joint>\n  \
    <link name=\"gripper\"/>\n  <joint name=\"gripper_mount\" type=\"fixed\">\n    <parent link=\"flange\"/>\n    \
    <child link=\"gripper\"/>\n    <origin xyz=\"0.01 0.02 0.03\" rpy=\"-0.5 0 1.5708\"/>\n  </joint>\n</robot>";

/// A session of the elbow, with a gripper in the model behind the reflector's position.
fn with_gripper(kind: SessionKind) -> Folder {
    let folder = session(kind);
    folder.write("robot.urdf", ROBOT.replace("</robot>", GRIPPER));
    folder
}

/// Lines of `calibrated.urdf` that are not in the model, with the joint to which they belong.
fn changed_lines(folder: &Folder) -> Vec<(String, String)> {
    let (before, after) = (folder.read("robot.urdf"), folder.read("results/calibrated.urdf"));
    let mut joint = String::new();
    let mut found = Vec::new();
    for (old, new) in before.lines().zip(after.lines()) {
        if let Some(rest) = old.trim().strip_prefix("<joint name=\"") {
            joint = rest.split('"').next().unwrap().to_owned();
        }
        if old != new {
            found.push((joint.clone(), new.trim().to_owned()));
        }
    }
    assert_eq!(before.lines().count(), after.lines().count());
    found
}

#[test]
fn links_beyond_the_last_joint_keep_the_numbers_of_the_model() {
    for kind in [SessionKind::POINT, SessionKind::POSE] {
        let folder = with_gripper(kind);
        let told = folder.run_to_success("calibrate robot.urdf measurements.csv --out results --verbose");
        let found = changed_lines(&folder);
        println!(
            "{kind:?}: {} lines changed; {}",
            found.len(),
            told.lines().find(|it| it.starts_with("target")).unwrap()
        );
        assert!(found.len() >= 6 && found.iter().all(|(joint, _)| !joint.contains("mount")), "{found:#?}");
        let file = calibration(&folder, "results");
        assert!(!file.move_tip && told.contains("target        measured: at ("), "{told}");
        // The model differs from the truth by 2 mm and 1° for each axis and tip: the reflector is at the flange that simulated it, 50 mm before joint
        // 6.
        let robot = file.robot().unwrap();
        let [(name, target)] = &robot.targets[..] else { panic!("{:?}", robot.targets) };
        let on_last = robot.last_joint_from_tip() * *target;
        let off = (on_last.translation.norm() - 0.05).abs();
        println!("{name} is {:.2} mm from where the simulated robot has it, along the axis", 1e3 * off);
        assert!(name == "measured" && off < 0.006);
        // Written for people and read again, in other forms too.
        let page = folder.read("results/report.html");
        assert!(page.contains("Targets in the frame of gripper"));
        folder.run_to_success("export results/calibration.json --format toml --out calibrated.toml");
        assert!(folder.read("calibrated.toml").contains("measured"));
    }
}

#[test]
fn the_device_sees_the_target_and_the_base_frame_has_the_tip() {
    let folder = with_gripper(SessionKind::POINT);
    folder.run_to_success("calibrate robot.urdf measurements.csv --out results");
    folder.run_to_success("calibrate robot.urdf measurements.csv --out moved --move-tip");
    let measured = |text: &str, skip: usize| -> Vec<[f64; 3]> {
        numbers(text, skip).iter().map(|row| [row[0], row[1], row[2]]).collect()
    };
    let rms = |found: &[[f64; 3]], wanted: &[[f64; 3]]| {
        let squares = found.iter().zip(wanted).map(|(a, b)| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>());
        1e3 * (squares.sum::<f64>() / wanted.len() as f64).sqrt()
    };
    let csv = folder.read("measurements.csv");
    let seen: Vec<[f64; 3]> = csv
        .lines()
        .skip(1)
        .map(|line| {
            let cells: Vec<f64> = line.split(',').skip(9).take(3).map(|cell| cell.parse().unwrap()).collect();
            [cells[0], cells[1], cells[2]]
        })
        .collect();
    let predict = |options: &str| measured(&folder.run_to_success(&format!("predict {options} measurements.csv")), 1);
    let (by_target, by_tip) = (
        predict("results/calibration.json --output-frame device"),
        predict("moved/calibration.json --output-frame device"),
    );
    println!(
        "device frame: {:.4} mm from the rows, with the tip moved {:.4} mm",
        rms(&by_target, &seen),
        rms(&by_tip, &seen)
    );
    assert!(rms(&by_target, &seen) < 0.2 && (rms(&by_target, &seen) - rms(&by_tip, &seen)).abs() < 1e-3);
    let named = predict("results/calibration.json --output-frame device --target measured");
    assert!(named == by_target);
    // The tip is the gripper, 114 mm from the reflector and more.
    let tip = predict("results/calibration.json --output-frame base");
    let target = predict("results/calibration.json --output-frame base --target measured");
    println!("the tip is {:.1} mm from the target", rms(&tip, &target));
    assert!(rms(&tip, &target) > 60.0);
    assert!(rms(&target, &predict("moved/calibration.json --output-frame base")) < 0.05);
    // A file without names is judged by either.
    for name in ["results", "moved"] {
        let judged = folder.run_to_success(&format!("validate {name}/calibration.json measurements.csv --json"));
        let found: serde_json::Value = serde_json::from_str(&judged).unwrap();
        let rms = found["calibrated"]["position_mm"]["rms"].as_f64().unwrap();
        let inside = found["promised"]["parts"]["position"]["inside"].clone();
        println!("{name}: {rms:.4} mm, {inside}");
        assert!(rms < 0.2, "{judged}");
    }
}

#[test]
fn a_model_that_ends_in_its_reflector_may_have_it_as_its_tip() {
    let folder = session(SessionKind::POINT);
    let told = folder.run_to_success("calibrate robot.urdf measurements.csv --out results --move-tip --verbose");
    assert!(told.contains("tip           the point that was measured, by --move-tip"), "{told}");
    let file = calibration(&folder, "results");
    assert!(file.move_tip && file.targets.is_empty());
    assert!(changed_lines(&folder).iter().any(|(joint, _)| joint == "tool_mount"));
    // After a further calibration, the tip is unchanged.
    // There is nothing left to correct, which the table states.
    let told = folder.run_to_success("calibrate results/calibration.json measurements.csv --out again");
    assert!(told.contains("\nconfirmed     the axes of your model"), "{told}");
    let again = calibration(&folder, "again").robot().unwrap();
    let place = again.targets[0].1.translation.norm();
    println!("{:.4} mm from the tip that was moved", 1e3 * place);
    assert!(place < 2e-3 && again.targets[0].0 == "measured");
}

#[test]
fn which_target_is_meant_is_said_where_it_is_open() {
    let folder = session(SessionKind::POINT);
    for (name, seed) in [("left", 1), ("right", 2)] {
        write_measurements(
            &folder,
            &format!("{name}.csv"),
            SessionKind::POINT,
            name,
            &Simulation { seed, ..Simulation::default() },
        );
    }
    let before = folder.listing();
    let run = folder.run("calibrate robot.urdf left.csv --move-tip --out results");
    assert!(
        run.code == 2
            && run.err.contains("found --move-tip beside rows of the target `left`")
            && folder.listing() == before,
        "{}",
        run.err
    );
    let run = folder.run("calibrate robot.urdf left.csv right.csv --out results");
    assert!(run.code < 2, "{}", run.err);
    let run = folder.run("predict results/calibration.json left.csv --output-frame device");
    println!("{}", run.err.trim_end());
    assert!(run.code == 2 && run.err.contains("write --target left"), "{}", run.err);
    folder.run_to_success("predict results/calibration.json left.csv --output-frame device --target left");
    let run = folder.run("validate results/calibration.json measurements.csv");
    assert!(run.code == 2 && run.err.contains("without a target's name, expected one of left, right"), "{}", run.err);
}
