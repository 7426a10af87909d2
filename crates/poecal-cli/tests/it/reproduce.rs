//! `poecal reproduce`, and the formulations of `poecal calibrate`.

use poecal_model::simulate::SessionKind;

use crate::folder::Folder;
use crate::session::session;

fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn reproduction_writes_its_report() {
    let folder = Folder::new();
    let out = folder.run_to_success("reproduce lou2009 --out report --trials 3 --starts 2");
    assert!(out.lines().all(|line| line.starts_with("written") || line.chars().count() <= 80), "{out}");
    assert!(out.contains("The matrix of (9) has rank 42 of 48 columns"), "{out}");
    let results = json(&folder.read("report/results.json"));
    let runs = results["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 32);
    for key in [
        "formulation",
        "measurement",
        "offsets_in_truth",
        "noise",
        "iterations",
        "converged",
        "parameters",
        "rank",
        "held_out_rms_m",
        "screw_error_max",
        "offset_error_max_deg",
    ] {
        assert!(runs.iter().all(|run| run.get(key).is_some()), "{key}");
    }
    for claim in results["claims"].as_array().unwrap() {
        assert!(claim["holds"].is_boolean() && claim["said_by_paper"].is_boolean());
        assert!(["claim", "paper", "criterion"].iter().all(|key| claim[key].is_string()));
        let measured = claim["measured"].as_str().unwrap();
        assert!(folder.read("report/report.md").contains(measured.split('|').next().unwrap()));
    }
    assert!(folder.read("report/report.html").contains("</html>"));
    // The command that the report names makes the same files.
    let command = results["command"].as_str().unwrap();
    let arguments = command.strip_prefix("poecal ").unwrap().replace("--out DIR", "--out again --quiet");
    folder.run_to_success(&arguments);
    for name in ["results.json", "report.md", "report.html"] {
        assert_eq!(folder.read(&format!("report/{name}")), folder.read(&format!("again/{name}")));
    }
    // The same command again is refused, and with --force writes the same bytes.
    let before = folder.listing();
    let again = "reproduce lou2009 --out report --trials 3 --starts 2";
    assert_eq!(folder.run(again).code, 2);
    folder.run_to_success(&format!("{again} --force --threads 1 --quiet"));
    assert!(before == folder.listing());
}

#[test]
fn reproduction_refuses_what_it_cannot_do() {
    let folder = Folder::new();
    for (arguments, words) in [
        ("reproduce lou2010 --out report", "invalid value 'lou2010' for '<EXPERIMENT>'"),
        ("reproduce lou2009 --out report --trials 0", "0 is not in 1..=1000000"),
        ("reproduce lou2009 --out report --starts -1", "unexpected argument '-1' found"),
        ("reproduce lou2009", "required arguments were not provided:\n  --out <DIR>"),
    ] {
        let run = folder.run(arguments);
        assert!(run.code == 2 && run.err.contains(words), "{arguments}: {run:?}");
    }
    assert!(folder.listing().is_empty());
}

#[test]
fn every_formulation_can_be_chosen() {
    let folder = session(SessionKind::POINT);
    let mut predictions = Vec::new();
    folder
        .write("joints.csv", "joint1,joint2,joint3,joint4,joint5,joint6\n0.3,-0.4,0.9,1,0.2,-3\n1.3,0.4,-0.7,0,1,2\n");
    for (formulation, method, unknowns) in [
        ("adjoint", "levenberg-marquardt", 27),
        ("screw", "gauss-newton", 39),
        ("screw-offsets", "gauss-newton", 45),
        ("adjoint-offsets", "levenberg-marquardt", 33),
    ] {
        let options = format!("--formulation {formulation} --out {formulation}");
        folder.run_to_success(&format!(
            "calibrate robot.urdf measurements.csv --held-out 0 --tolerance none --corrections off {options}"
        ));
        let file = json(&folder.read(&format!("{formulation}/calibration.json")));
        assert_eq!(file["solver"]["formulation"], formulation);
        assert_eq!(file["solver"]["method"], method);
        assert_eq!(file["solver"]["joint_offsets"].is_array(), formulation.ends_with("offsets"));
        println!("{formulation}: {} iterations", file["solver"]["iterations"]);
        assert!(file["identifiability"]["parameters"] == unknowns);
        predictions.push(folder.run_to_success(&format!("predict {formulation}/calibration.json joints.csv")));
    }
    // Offsets are moved into the screws of the written models: the same robot, in both formulations.
    let numbers = |text: &str| -> Vec<f64> {
        text.lines().skip(1).flat_map(|line| line.split(',').map(|it| it.parse::<f64>().unwrap())).collect()
    };
    let (plain, offsets) = (numbers(&predictions[0]), numbers(&predictions[3]));
    let worst = plain.iter().zip(&offsets).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!("adjoint against adjoint-offsets: {worst:.1e}");
    assert!(worst < 1e-6);
}

#[test]
fn residual_and_method_can_be_chosen() {
    let folder = session(SessionKind::POSE);
    let out = folder
        .run_to_success("calibrate robot.urdf measurements.csv --residual spatial --method gauss-newton --verbose");
    assert!(out.contains("formulation   adjoint, spatial residual of poses, gauss-newton"), "{out}");
    let run = folder.run("calibrate robot.urdf measurements.csv --formulation screws --out other");
    assert!(run.code == 2 && run.err.contains("screw"), "{run:?}");
}

#[test]
fn a_residual_of_poses_says_that_points_have_none() {
    let folder = session(SessionKind::POINT);
    let run = folder.run("calibrate robot.urdf measurements.csv --residual spatial --verbose");
    assert_eq!(run.code, 0, "{run:?}");
    let words = "--residual spatial has no effect: it is about measured frames, and there are none";
    assert!(run.err.contains(words), "{}", run.err);
    assert!(!run.out.contains("residual of poses"), "{}", run.out);
    let out = folder
        .run_to_success("calibrate robot.urdf measurements.csv --formulation adjoint-offsets --out offsets --verbose");
    assert!(out.contains("formulation   adjoint-offsets, levenberg-marquardt; joint offsets"), "{out}");
}
