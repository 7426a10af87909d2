//! Beam breaks: rows without information on the target's position.

use poecal_model::simulate::SessionKind;

use crate::session::session;

#[test]
fn lost_beams_are_told_or_refused() {
    let folder = session(SessionKind::POINT);
    let text = folder.read("measurements.csv");
    let lines: Vec<&str> = text.lines().collect();
    let without = |line: &str, position: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        format!("{},{position},,,,", cells[..9].join(","))
    };
    let mut lost = lines.clone();
    let (empty, zero) = (without(lines[4], ",,"), without(lines[7], "0,0,0.000"));
    (lost[4], lost[7]) = (&empty, &zero);
    folder.write("lost.csv", format!("sep=,\n{}\n", lost.join("\n")));
    let out = folder.run_to_success("check robot.urdf lost.csv");
    let words = "2 measurements with an empty or zero position, as of a lost beam (lines 6, 9)";
    let told = out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(told.contains(&format!("skipped {words} form separator: comma (line 1)")), "{out}");
    let json: serde_json::Value =
        serde_json::from_str(&folder.run_to_success("check robot.urdf lost.csv --json")).unwrap();
    assert_eq!(json["files"][0]["lost"], serde_json::json!({ "count": 2, "first_lines": [6, 9] }));
    assert_eq!((&json["files"][0]["rows"], &json["files"][0]["points"]), (&60.into(), &58.into()));
    let refused = "error: lost.csv:6:";
    for command in ["check robot.urdf lost.csv", "calibrate robot.urdf lost.csv"] {
        let run = folder.run(&format!("{command} --strict"));
        assert_eq!(run.code, 2);
        assert!(run.err.starts_with(refused) && run.err.contains("found an empty position"), "{}", run.err);
    }
    let run = folder.run("calibrate robot.urdf lost.csv");
    assert!(run.err.contains(&format!("warning: lost.csv: skipped {words}; --strict refuses them")), "{}", run.err);
    let run = folder.run("validate poecal-out/calibration.json lost.csv --strict");
    assert!(run.code == 2 && run.err.starts_with(refused), "{}", run.err);
}
