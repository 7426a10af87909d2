//! `--accept` and `--record`: decisions with their exit codes, texts of certificates, and refused words.

use poecal_calibrate::{AcceptedModel, AcceptedRows, Decision};
use poecal_model::simulate::SessionKind;

use crate::folder::Folder;
use crate::session::{calibration, session};

/// The decision of a calibration with these words, with the exit code.
fn decide_acceptance(folder: &Folder, words: &str) -> (Decision, i32) {
    let run = folder.run(&format!("calibrate robot.urdf measurements.csv --force {words}"));
    let found = calibration(folder, "poecal-out").acceptance.unwrap_or_else(|| panic!("{}", run.err));
    let line = format!("acceptance    {}: ", found.decision.words());
    assert!(run.out.contains(&line), "{}", run.out);
    (found.decision, run.code)
}

#[test]
fn limits_are_kept_exceeded_or_neither() {
    let folder = session(SessionKind::POSE);
    folder.run_to_success("calibrate robot.urdf measurements.csv --accept 10mm");
    let file = calibration(&folder, "poecal-out");
    let own = file.accuracy.held_out.unwrap();
    let found = file.acceptance.unwrap();
    let limit = &found.limits[0];
    assert_eq!((found.by, found.limits.len()), (AcceptedRows::HeldOut, 1));
    let judged = if found.model == AcceptedModel::Corrected { own.corrected.unwrap() } else { own.calibrated };
    // The table's figure, except for rounding of sums.
    assert!((limit.found / judged.position_mm().rms - 1.0).abs() < 1e-9);
    println!("{limit:?}");
    let to = limit.to.unwrap();
    assert!(limit.from < limit.found && limit.found < to && limit.rows == own.count);
    assert_eq!(decide_acceptance(&folder, &format!("--accept {}mm", to * 1.001)), (Decision::Pass, 0));
    assert_eq!(decide_acceptance(&folder, &format!("--accept {}mm", limit.found)), (Decision::NotShown, 1));
    assert_eq!(decide_acceptance(&folder, &format!("--accept {}mm", limit.from * 0.999)), (Decision::Fail, 1));
    // The worst of several decides; without 59 configurations nothing bounds the 95 % quantile from above.
    assert_eq!(decide_acceptance(&folder, "--accept 10mm,5deg,max:20mm"), (Decision::Pass, 0));
    assert_eq!(
        decide_acceptance(&folder, "--accept 10mm --accept 1e-5deg --accept-model calibrated"),
        (Decision::Fail, 1)
    );
    assert_eq!(decide_acceptance(&folder, "--accept p95:100mm"), (Decision::NotShown, 1));
    // Without rows held out, cross-validation decides.
    assert_eq!(decide_acceptance(&folder, "--accept 10mm --held-out 0"), (Decision::Pass, 0));
    let by = calibration(&folder, "poecal-out").acceptance.unwrap().by;
    assert_eq!(by, AcceptedRows::CrossValidation);
}

/// Without a noise that is stated or repeated, the largest observed error is the robot's: it bounds the maximum from below.
#[test]
fn a_maximum_is_no_less_than_was_seen_but_for_noise_that_is_shown() {
    let folder = session(SessionKind::POSE);
    let largest = |words: &str| {
        let (_, _) = decide_acceptance(&folder, &format!("--accept max:20mm {words}"));
        calibration(&folder, "poecal-out").acceptance.unwrap().limits[0].clone()
    };
    let unknown = largest("");
    println!("{unknown:?}");
    let of_noise = unknown.to.unwrap() - unknown.found;
    assert!(of_noise > 0.0 && unknown.from >= 0.9 * unknown.found && unknown.from <= unknown.found);
    // A stated noise is subtracted, and no more than the amount that was added.
    let stated = largest("--sigma-position 0.01mm --sigma-rotation 0.01mrad");
    println!("{stated:?}");
    let taken_off = stated.found - stated.from;
    // In the largest row of three numbers: at least the bound for one of them, 2.795 times the noise, and at most 2 times that.
    assert!((0.02795..0.0559).contains(&taken_off), "{taken_off}");
    assert!((stated.to.unwrap() - stated.found - 0.02795).abs() < 2e-5);
}

#[test]
fn other_measurements_decide_and_those_of_the_calibration_do_not() {
    let folder = session(SessionKind::POSE);
    folder.run_to_success("calibrate robot.urdf measurements.csv");
    let rows = folder.read("measurements.csv");
    let lines: Vec<&str> = rows.lines().collect();
    folder.write("some.csv", lines[..lines.len() - 3].join("\n") + "\n");
    let run = folder.run("validate poecal-out/calibration.json some.csv --accept 10mm");
    assert_eq!(run.code, 0, "{}{}", run.out, run.err);
    assert!(run.out.contains("acceptance    PASS: "), "{}", run.out);
    let run = folder.run("validate poecal-out/calibration.json some.csv --accept 1nm --refit device --json");
    assert!(run.code == 1 && run.out.contains("\"decision\": \"fail\""), "{}", run.out);
    let run = folder.run("validate poecal-out/calibration.json measurements.csv --accept 10mm");
    assert_eq!(run.code, 2);
    assert!(run.err.contains("which the calibration was made of"), "{}", run.err);
}

#[test]
fn a_record_is_kept_and_shown_and_typed_keys_precede_those_of_the_settings() {
    let folder = session(SessionKind::POSE);
    let settings = "poecal_settings = 1\nmodel = \"robot.urdf\"\nmeasurements = [\"measurements.csv\"]\nforce = true\naccept = [\"10mm\"]\n\
                    [record]\nserial = \"<b>4711</b>\"\ndate = 2026-03-02\noperator = \"A = B\"\nnote = \"\"\n";
    folder.write("poecal.toml", settings);
    folder.run_to_success("calibrate --record operator=C --record temperature=21.5C");
    let record = calibration(&folder, "poecal-out").record;
    let found: Vec<(&str, &str)> = record.entries().iter().map(|&(key, _, text)| (key, text)).collect();
    let expected = [("serial", "<b>4711</b>"), ("operator", "C"), ("date", "2026-03-02"), ("temperature", "21.5 °C")];
    assert_eq!(found, expected);
    let page = folder.read("poecal-out/report.html");
    assert!(page.contains("&lt;b&gt;4711&lt;/b&gt;") && !page.contains("<b>4711"), "escaped");
    assert!(page.contains("PASS: the limit is kept"));
    // The recorded command makes the same bytes without the settings.
    let before = folder.read("poecal-out/calibration.json");
    folder.run_to_success("calibrate --record operator=C --record temperature=21.5C");
    assert_eq!(folder.read("poecal-out/calibration.json"), before);
    let run = folder.run("report poecal-out/calibration.json --force");
    assert_eq!((run.code, folder.read("poecal-out/report.html") == page), (0, true), "{}", run.err);
}

#[test]
fn wrong_limits_and_records_are_refused_by_one_sentence() {
    let folder = session(SessionKind::POINT);
    let long = format!("--record serial={}", "x".repeat(201));
    let cases = [
        ("--accept 0.2", "--accept: found `0.2` as a limit, expected a unit behind the number"),
        ("--accept 0mm", "expected a number above 0 with its unit"),
        ("--accept=-1mm", "expected a number above 0 with its unit"),
        ("--accept nanmm", "expected a number above 0 with its unit"),
        ("--accept infmm", "expected a number above 0 with its unit"),
        ("--accept mean:1mm", "expected rms, p95 or max before the colon"),
        ("--accept 1parsec", "found the unit `parsec`"),
        ("--accept max:", "expected a number above 0 with its unit"),
        ("--accept 1mm,,2deg", "expected a number above 0 with its unit"),
        ("--accept 1mm,rms:2mm", "found two limits of one kind, rms:1mm and rms:2mm"),
        ("--accept 1deg", "measured no angle, only position"),
        ("--accept p95:1mm --held-out 0", "found limits to accept and no rows held out"),
        ("--accept 1mrad,rms:2mrad", "rms:0.0572958deg and rms:0.114592deg"),
        ("--accept-model calibrated", "found `calibrated` as the model that shall keep limits, but no limit"),
        ("--accept 1mm --accept-model nominal", "nominal"),
        ("--record serial", "--record: found `serial`, expected KEY=TEXT"),
        ("--record sreial=1", "found the key `sreial`, expected one of the record: the nearest is `serial`"),
        ("--record date=2026-02-30", "found `2026-02-30` as the date, expected a day like 2026-03-02"),
        ("--record date=today", "expected a day like 2026-03-02"),
        ("--record temperature=21.5", "expected degrees Celsius, like 21.5C"),
        ("--record temperature=70F", "expected degrees Celsius"),
        ("--record serial=1 --record serial=2", "found `serial` twice in the record"),
        ("--record note=a\u{7}b", "found the character U+0007 in `note`"),
        (&long, "found 201 letters in `serial`, expected at most 200"),
    ];
    for (words, sentence) in cases {
        let run = folder.run(&format!("calibrate robot.urdf measurements.csv {words}"));
        assert_eq!(run.code, 2, "{words}: {}", run.out);
        assert!(run.err.contains(sentence), "{words}: {}", run.err);
        assert!(run.err.matches('\n').count() <= 4, "{words}: {}", run.err);
        assert!(!folder.path("poecal-out").exists(), "{words}");
    }
    let settings = "poecal_settings = 1\nmodel = \"robot.urdf\"\nmeasurements = [\"measurements.csv\"]\n";
    for (more, sentence) in [
        ("[record]\nserial = \"a\"\ndate = \"soon\"\n", "poecal.toml:6:8: record: found `soon` as the date"),
        ("[record]\nserial = true\n", "poecal.toml:5:10: found boolean for `serial` of `record`"),
        ("[record]\nowner = \"a\"\n", "poecal.toml:5:9: record: found the key `owner`"),
        ("accept = \"1\"\n", "poecal.toml:4:10: accept: found `1` as a limit"),
    ] {
        folder.write("poecal.toml", format!("{settings}{more}"));
        let run = folder.run("calibrate");
        assert_eq!(run.code, 2, "{more}");
        assert!(run.err.contains(sentence), "{more}: {}", run.err);
    }
}
