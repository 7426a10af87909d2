//! `poecal plan --rows`: determination of the unknowns by planned measurements.

use crate::folder::Folder;
use crate::offsets::COLUMN;

/// Readings of many configurations: the turn's, the slide's if it moves, and the nod's.
fn joints(slides: bool) -> String {
    let rows = (0..40).map(|k| {
        let slide = if slides { (k * 37 % 41) as f64 * 9.0 } else { 120.0 };
        format!("{},{slide},{}\n", k * 53 % 360 - 180, k * 29 % 170 - 85)
    });
    format!("turn[deg],slide[mm],nod[deg]\n{}", rows.collect::<String>())
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("column.toml", COLUMN);
    folder.write("still.csv", joints(false));
    folder.write("all.csv", joints(true));
    folder
}

#[test]
fn what_would_stay_undetermined_is_said_before_anything_is_measured() {
    let folder = folder();
    let out = folder.run_to_success("plan column.toml --rows still.csv --kind point --sigma-position 0.1mm");
    for words in [
        "to measure    40 points: still.csv\n",
        "noise         0.1000 mm each component\n",
        "determined    11 of 13 unknowns",
        "undetermined: slide never moved: its screw is undetermined (2\n              unknowns)\n",
        "orientation of the tool: no orientation was measured\n",
        "; 993 others",
        " 120.0 to 120.0 mm           0.0 to 500.0 mm     0 %\n",
    ] {
        assert!(out.contains(words), "`{words}` is not in\n{out}");
    }
    assert!(out.lines().all(|line| line.chars().count() <= 80), "{out}");
    // With the slide moving, also in another file, nothing is undetermined.
    for files in ["all.csv", "still.csv --rows all.csv"] {
        let out = folder.run_to_success(&format!("plan column.toml --rows {files} --kind point"));
        assert!(out.contains("determined    13 of 13 unknowns") && !out.contains("undetermined"), "{out}");
    }
}

#[test]
fn json_holds_the_same() {
    let folder = folder();
    let of = |arguments: &str| -> serde_json::Value {
        serde_json::from_str(&folder.run_to_success(&format!("plan column.toml --rows {arguments} --json"))).unwrap()
    };
    let found = of("still.csv --kind pose");
    assert_eq!(
        (&found["kind"], &found["frame"], &found["configurations"]),
        (&"pose".into(), &"unknown".into(), &40.into())
    );
    let open = &found["identifiability"]["unidentifiable"][0];
    assert_eq!((&open["cause"], &open["directions"]), (&"stood_still".into(), &2.into()));
    assert_eq!(open["joints"], serde_json::json!(["slide"]));
    assert!(found["identifiability"]["observability"]["o1"].is_null());
    assert_eq!(found["coverage"][1]["sampled_min"], 0.12);
    let structural = |found: &serde_json::Value| -> Vec<String> {
        let list = found["identifiability"]["structural"].as_array().unwrap();
        list.iter().map(|it| it["cause"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(structural(&found), ["own_axis", "base_frame", "joint_offsets"]);
    assert_eq!(
        structural(&of("all.csv --device-frame base --kind point")),
        ["own_axis", "joint_offsets", "no_orientation"]
    );
    let found = of("all.csv --kind pose --sigma-position 0.05mm --sigma-rotation 0.01deg");
    let expected = |key: &str| found["expected_error"][key].as_f64().unwrap();
    // Less than the noise of one measurement, with some 40 of them.
    assert!(expected("position_mean_mm") < 0.05 && expected("position_worst_mm") > expected("position_mean_mm"));
    assert_eq!(found["expected_error"]["told"], 1000);
    assert!(found["identifiability"]["observability"]["o3"].as_f64().unwrap() > 1e3);
}

#[test]
fn mistakes_get_a_sentence() {
    let folder = folder();
    folder.write("empty.csv", "turn[deg],slide[mm],nod[deg]\n");
    folder.write("huge.csv", "turn,slide,nod\n0.1,1e300,0.1\n0.2,-1e300,0.2\n");
    for (arguments, sentence) in [
        ("plan column.toml --rows missing.csv --kind pose", "missing.csv: found no such file"),
        (
            "plan column.toml --rows all.csv --rows all.csv --kind pose",
            "all.csv: found this measurement file named twice",
        ),
        ("plan column.toml --rows empty.csv --kind pose", "empty.csv:1: found a header and no rows"),
        (
            "plan column.toml --rows all.csv --kind pose --sigma-position 0mm",
            "--sigma-position: found `0mm`, expected a standard deviation above 0",
        ),
    ] {
        let run = folder.run(arguments);
        assert_eq!((run.code, run.out.as_str()), (2, ""), "{arguments}");
        assert!(run.err.starts_with(&format!("error: {sentence}")), "{}", run.err);
    }
    let run = folder.run("plan column.toml --rows huge.csv --kind pose");
    assert_eq!((run.code, run.out.as_str()), (2, ""), "{}", run.err);
}
