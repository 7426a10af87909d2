//! `poecal offsets`, and `poecal export --offset`, which it undoes.

use poecal_model::simulate::SessionKind;

use crate::folder::Folder;
use crate::session::{ROBOT, session};

/// Turns, slides, turns: a joint of each kind.
pub(crate) const COLUMN: &str = r#"
poecal_robot = 1
name = "column"
length_unit = "mm"
angle_unit = "deg"
joint = [
  { name = "turn", direction = [0, 0, 1], point = [0, 0, 0], limits = [-180, 180] },
  { name = "slide", type = "prismatic", direction = [0, 0, 1], limits = [0, 500] },
  { name = "nod", direction = [0, 1, 0], point = [100, 0, 300], limits = [-90, 90] },
]
home = { position = [600, 20, 300] }
"#;

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("column.toml", COLUMN);
    folder.write("robot.urdf", ROBOT);
    folder
}

fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn offsets_that_were_put_in_are_found() {
    let folder = folder();
    for form in ["urdf", "toml"] {
        let put_in = "--offset turn=0.5deg --offset slide=-1.2mm --offset nod=-170deg";
        folder.run_to_success(&format!("export column.toml {put_in} --out actual.{form} --quiet"));
        let out = folder.run_to_success(&format!("offsets column.toml actual.{form}"));
        for words in [
            "nominal       column.toml\n",
            "base          kept: both models state it\n",
            "  turn                     0.5000 deg          0.0000 deg     0.0000 mm\n",
            "  slide                   -1.2000 mm           0.0000 deg\n",
            "  nod                   -170.0000 deg          0.0000 deg     0.0000 mm\n",
            "  tip at zero                                  0.0000 deg     0.0000 mm\n",
            "predictions   on 10000 random configurations within the limits, offsets change",
        ] {
            assert!(out.contains(words), "`{words}` is not in\n{out}");
        }
        assert!(!out.contains('*') && out.lines().all(|line| line.chars().count() <= 80), "{out}");
    }
}

#[test]
fn json_holds_the_same_and_goes_into_a_file() {
    let folder = folder();
    folder.run_to_success("export column.toml --offset turn=0.5deg --offset slide=1.2mm --out actual.toml");
    assert_eq!(folder.run_to_success("offsets column.toml actual.toml --free tip --json --out offsets.json"), "");
    let found = json(&folder.read("offsets.json"));
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    assert!((number(&found["joints"][0]["offset_deg"]) - 0.5).abs() < 1e-12);
    assert!((number(&found["joints"][1]["offset_mm"]) - 1.2).abs() < 1e-12);
    assert!(found["joints"][1]["offset_deg"].is_null() && found["joints"][1]["shift_mm"].is_null());
    assert_eq!(found["joints"][2]["determined"], false);
    assert_eq!(found["undetermined"], serde_json::json!(["nod"]));
    assert!(found["home"].is_null());
    assert_eq!((&found["base"]["frame"], &found["tip"]["frame"]), (&"kept".into(), &"free".into()));
    assert_eq!(found["tip"]["reason"], "as asked");
    let predictions = &found["predictions"];
    assert!(number(&predictions["without_offsets"]["position_rms_mm"]) > 1.0);
    assert!(number(&predictions["with_offsets"]["position_max_mm"]) < 1e-9);
    // The table is written to a file as well, also with --quiet; standard output then has none.
    folder.run_to_success("offsets column.toml actual.toml --quiet --out table.txt");
    assert!(folder.read("table.txt").contains("tip at zero"));
    assert_eq!(folder.run_to_success("offsets column.toml actual.toml --quiet"), "");
}

#[test]
fn a_calibration_has_a_base_and_a_tip_of_its_own() {
    let folder = session(SessionKind::POSE);
    folder.run_to_success("calibrate robot.urdf measurements.csv --out anywhere --quiet");
    let ends = |arguments: &str| {
        let out = folder.run_to_success(&format!("offsets robot.urdf {arguments} --json"));
        let found = json(&out);
        ["base", "tip"].map(|end| format!("{}: {}", found[end]["frame"], found[end]["reason"]).replace('"', ""))
    };
    assert_eq!(
        ends("anywhere/calibration.json"),
        [
            "free: the calibration did not know the device's place, so its base frame is a matter of choice",
            "free: a tool is taught on the robot as it is"
        ]
    );
    assert_eq!(ends("anywhere/calibration.json --fix base,tip"), ["kept: as asked", "kept: as asked"]);
    // The chain is the URDF's; a calibration has one only.
    ends("anywhere/calibration.json --base-link base_link --tip-link tool");
    let out = folder.run_to_success("offsets robot.urdf anywhere/calibration.json");
    assert!(out.contains("undetermined  * joint1, joint6: this comparison does not determine these\n"), "{out}");
}

#[test]
fn mistakes_get_a_sentence() {
    let folder = folder();
    let cases = [
        (
            "offsets robot.urdf column.toml",
            "column.toml: found an actual robot of 3 joints, expected the 6 of the nominal one: compare two models of one robot",
        ),
        (
            "offsets column.toml robot.urdf --tip-link tool",
            "column.toml: found --base-link or --tip-link, expected neither: this model has one chain only",
        ),
        (
            "offsets column.toml missing.toml",
            "missing.toml: found no such file, expected a robot model (URDF, MJCF, SDF, TOML or calibration.json): check the path",
        ),
        (
            "export column.toml --format urdf --offset trun=1deg",
            "--offset: found no moving joint `trun`, expected one of turn, slide, nod; did you mean `turn`?",
        ),
        (
            "export column.toml --format urdf --offset turn=1mm",
            "--offset: joint `turn`: found the unit `mm`, expected an angle (rad, mrad, deg, arcmin, arcsec, ticks)",
        ),
        (
            "export column.toml --format urdf --offset slide=1deg",
            "--offset: joint `slide`: found the unit `deg`, expected a length (m, cm, mm, um, nm, in)",
        ),
        (
            "export column.toml --format urdf --offset slide=1",
            "--offset: joint `slide`: found `1` without a unit, expected a number with a unit, like 0.05mm",
        ),
        (
            "export column.toml --format urdf --offset turn=infdeg",
            "--offset: joint `turn`: found `infdeg`, expected a number with a unit, like 0.01deg",
        ),
        (
            "export column.toml --format urdf --offset turn",
            "--offset: found `turn`, expected a joint and its offset, like joint2=0.5deg or slide=1.2mm",
        ),
        (
            "export column.toml --format urdf --offset turn=1deg --offset turn=2deg",
            "--offset: found joint `turn` twice, expected one offset a joint",
        ),
    ];
    for (arguments, sentence) in cases {
        let run = folder.run(arguments);
        assert_eq!((run.code, run.out.as_str(), run.err), (2, "", format!("error: {sentence}\n")), "{arguments}");
    }
    // Absurd lengths are refused too, for any reason.
    for form in ["urdf", "toml"] {
        for offset in ["1e300m", "1e9m"] {
            let run = folder.run(&format!("export column.toml --format {form} --offset slide={offset}"));
            assert_eq!((run.code, run.out.as_str(), run.err.lines().count()), (2, "", 1), "{}", run.err);
        }
    }
    assert_eq!(folder.run("offsets column.toml column.toml --fix flange").code, 2);
}

#[test]
fn an_offset_of_a_leader_says_that_its_followers_stay() {
    let folder = Folder::new();
    let mimic =
        COLUMN.replace("limits = [-90, 90] }", "limits = [-90, 90], mimic = { joint = \"turn\", multiplier = 2 } }");
    folder.write("column.toml", &mimic);
    let run = folder.run("export column.toml --offset turn=0.5deg --out actual.toml");
    assert_eq!(run.code, 0, "{run:?}");
    assert!(run.err.contains("joint `turn` alone is moved, not `nod`"), "{}", run.err);
    // The follower has an offset of its own, and no warning is due.
    let run = folder.run("export column.toml --offset nod=1deg --out other.toml");
    assert!(run.code == 0 && !run.err.contains("alone is moved"), "{run:?}");
    let run = folder.run("offsets column.toml actual.toml");
    assert_eq!(run.code, 0, "{run:?}");
    assert!(run.err.contains("joint `turn` is read for `nod` too"), "{}", run.err);
    assert!(run.out.contains("  turn                     0.5000 deg"), "{}", run.out);
}
