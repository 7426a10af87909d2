//! Robots with branches: instruments and targets on named links of a URDF, from the measurement file to the exported model.

use serde_json::Value;

use crate::folder::Folder;
use crate::session::calibration;

const TORSO: &str = include_str!("../../../poecal-testing/data/torso.urdf");
const TREE: &str =
    "--instrument eyes=head_camera --instrument chest=torso --target left=left_hand --target right=right_hand";

/// A simulated session of two cameras that see two hands.
fn seen_by_two() -> Folder {
    let folder = Folder::new();
    folder.write("torso.urdf", TORSO);
    folder.run_to_success(&format!(
        "simulate torso.urdf {TREE} --count 300 --held-out-count 40 --errors 0.5deg,2mm --out sim"
    ));
    folder
}

#[test]
fn two_cameras_calibrate_a_torso_with_two_arms() {
    let folder = seen_by_two();
    let header = folder.read("sim/measurements.csv");
    assert!(header.lines().nth(1).unwrap().ends_with(",qw,instrument,target"));
    folder.run_to_success(&format!("calibrate torso.urdf sim/measurements.csv {TREE} --out out"));
    let file = calibration(&folder, "out");
    let held_out = file.accuracy.held_out.as_ref().unwrap().calibrated.position_mm().rms;
    println!("held out: {held_out:.4} mm");
    assert!(held_out < 1.3 * 0.05 * 3f64.sqrt(), "{held_out}");
    let table = folder
        .run_to_success(&format!("calibrate torso.urdf sim/measurements.csv {TREE} --out out --force --report none"));
    let said = table.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains("no measurement sees joints torso1 and torso2 move"), "{table}");

    // The calibrated URDF is read with its present links, and predicts as calibration.json does.
    let robot = file.robot().unwrap();
    assert_eq!(robot.instruments.len() + robot.mounted.len(), 4);
    let rows = folder.read("sim/held_out.csv").lines().skip(1).count();
    for target in ["left", "right"] {
        let by_file =
            folder.run_to_success(&format!("predict out/calibration.json sim/held_out.csv --target {target}"));
        let by_urdf = folder
            .run_to_success(&format!("predict out/calibrated.urdf sim/held_out.csv --target {target}={target}_hand"));
        // A URDF may need fewer joints for one hand; the readings are there nevertheless.
        assert_eq!(by_file.lines().count(), rows);
        for (a, b) in by_file.lines().zip(by_urdf.lines()).skip(1) {
            let numbers = |line: &str| -> Vec<f64> { line.split(',').map(|it| it.parse().unwrap()).collect() };
            let apart = numbers(a).iter().zip(numbers(b)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart < 1e-9, "{target}: {apart:e}");
        }
    }
    folder.run_to_success("validate out/calibration.json sim/held_out.csv");
    // A calibrated robot can be calibrated again, from each of the forms.
    folder.run_to_success("export out/calibration.json --out torso.toml");
    for (model, out) in [("out/calibration.json", "again"), ("torso.toml", "from-toml")] {
        // There is nothing left to correct, which the table states.
        let told = folder.run_to_success(&format!("calibrate {model} sim/measurements.csv --out {out}"));
        assert!(told.contains("\nconfirmed     the axes of your model"), "{told}");
    }
    for out in ["again", "from-toml"] {
        let rms = calibration(&folder, out).accuracy.held_out.unwrap().calibrated.position_mm().rms;
        assert!((rms - held_out).abs() < 1e-3 * held_out, "{out}: {rms} {held_out}");
    }
    let device = folder.run("predict out/calibration.json sim/held_out.csv --output-frame device --target left");
    assert_eq!(device.code, 2);
    assert!(device.err.contains("found the instrument `eyes` on the robot"), "{}", device.err);
}

#[test]
fn settings_and_mappings_name_links_too() {
    let folder = seen_by_two();
    let options = format!("calibrate torso.urdf sim/measurements.csv {TREE} --out typed --report none");
    folder.run_to_success(&options);
    folder.write(
        "map.toml",
        "[mount.instruments]\neyes = 'head_camera'\nchest = 'torso'\n[mount.targets]\nleft = 'left_hand'\nright = 'right_hand'\n",
    );
    folder.run_to_success("calibrate torso.urdf sim/measurements.csv --columns map.toml --out mapped --report none");
    folder.write(
        "poecal.toml",
        "poecal_settings = 1\nmodel = 'torso.urdf'\nmeasurements = ['sim/measurements.csv']\n\
         instrument = ['eyes=head_camera', 'chest=torso']\ntarget = ['left=left_hand', 'right=right_hand']\nout = 'set'\nreport = 'none'\n",
    );
    folder.run_to_success("calibrate");
    let urdf = folder.read("typed/calibrated.urdf");
    assert_eq!(folder.read("set/calibrated.urdf"), urdf);
    let rms = |out: &str| calibration(&folder, out).accuracy.held_out.unwrap().calibrated.position_mm().rms;
    assert!((rms("mapped") - rms("typed")).abs() < 1e-9, "{} {}", rms("mapped"), rms("typed"));
    folder.run_to_success(&format!("init torso.urdf {TREE} --out project"));
    let settings = folder.read("project/poecal.toml");
    assert!(settings.contains("instrument = [\"eyes=head_camera\", \"chest=torso\"]"), "{settings}");
    let columns = folder.read("project/measurements.csv");
    assert!(columns.lines().last().unwrap().ends_with(",x[mm],y[mm],z[mm],instrument,target"), "{columns}");
    assert!(folder.read("project/README.md").contains("--target 'right=right_hand'"));
    folder.run_to_success(&format!("plan torso.urdf --rows project/joints.csv --kind pose {TREE}"));
}

#[test]
fn check_shows_which_joints_each_pair_sees() {
    let folder = Folder::new();
    folder.write("torso.urdf", TORSO);
    let text = folder.run_to_success(&format!("check torso.urdf {TREE}"));
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(text.contains("eyes to left: head_yaw, left1, left2, left3, left4, left5, left6"), "{text}");
    assert!(text.contains("unseen torso1, torso2: no way passes them"), "{text}");
    let json: Value = serde_json::from_str(&folder.run_to_success(&format!("check torso.urdf {TREE} --json"))).unwrap();
    assert_eq!(json["sight"]["ways"].as_array().unwrap().len(), 4);
    assert_eq!(json["sight"]["unseen"], serde_json::json!(["torso1", "torso2"]));
    assert_eq!(json["model"]["joints"][8]["on"]["link_of"], "torso2");
    // A chain has none of this.
    let chain: Value =
        serde_json::from_str(&folder.run_to_success("check torso.urdf --tip-link left_hand --json")).unwrap();
    assert!(chain.get("sight").is_none() && chain["model"].get("mounted").is_none());
}

#[test]
fn wrong_links_get_one_sentence() {
    let folder = Folder::new();
    folder.write("torso.urdf", TORSO);
    folder.write("map.toml", "[mount.targets]\nleft = 'right_hand'\n");
    for (arguments, expected) in [
        (
            "check torso.urdf --target left",
            "error: --target: found `left`, expected a name and its link, like camera=camera_link\n",
        ),
        (
            "check torso.urdf --target left=left_hand --target left=right_hand",
            "error: found target `left` on link `left_hand` and on link `right_hand`, expected one link\n",
        ),
        (
            "check torso.urdf --target left=left_hand --columns map.toml",
            "error: map.toml: found target `left` on link `left_hand` and on link `right_hand`, expected one link\n",
        ),
    ] {
        let run = folder.run(arguments);
        assert_eq!((run.code, run.err.as_str()), (2, expected), "{arguments}");
    }
    let run = folder.run("check torso.urdf --instrument eyes=head_camra --target left=left_hand");
    assert_eq!(run.code, 2);
    assert!(
        run.err.starts_with(
            "error: torso.urdf: instrument `eyes` names link `head_camra`, expected a link of this file, "
        ),
        "{}",
        run.err
    );
    assert!(run.err.contains("`head_camera`"), "{}", run.err);
}

#[test]
fn a_camera_in_the_hand_sees_a_board_beside_the_robot() {
    let folder = Folder::new();
    folder.write("torso.urdf", TORSO);
    let named = "--instrument camera=right_hand --target board=base_link";
    folder.run_to_success(&format!("simulate torso.urdf {named} --count 120 --out sim"));
    folder.run_to_success(&format!("calibrate torso.urdf sim/measurements.csv {named} --out out"));
    let file = calibration(&folder, "out");
    let held_out = file.accuracy.held_out.as_ref().unwrap().calibrated.position_mm().rms;
    println!("held out: {held_out:.4} mm");
    assert!(held_out < 1.3 * 0.05 * 3f64.sqrt(), "{held_out}");
    // The camera is at the tip, whose fixed joint holds both.
    let robot = file.robot().unwrap();
    assert_eq!(robot.tip_name, "right_hand");
    assert!((robot.base_from(&robot.instruments[0]).translation - robot.home.translation).norm() < 1e-12);
    assert!(!folder.read("out/calibrated.urdf").contains("right_hand_calibrated"));
}
