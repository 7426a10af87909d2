//! `poecal track` as users run it.

use crate::folder::Folder;

/// A simulated robot with its calibration.
fn cell() -> Folder {
    let folder = Folder::new();
    folder.write("robot.urdf", crate::session::ROBOT);
    folder.done("simulate robot.urdf --kind point --count 60 --seed 3 --out cell");
    folder.done("calibrate cell/nominal.urdf cell/measurements.csv --corrections off --report none");
    folder
}

#[test]
fn the_same_rows_are_unchanged_and_a_line_of_the_history() {
    let folder = cell();
    let run = folder.run("track poecal-out/calibration.json cell/measurements.csv --repeatability 0.05mm");
    assert_eq!(run.code, 0, "{}{}", run.out, run.err);
    assert!(run.out.contains("unchanged (60 of 60 rows repeat"), "{}", run.out);
    let history = folder.read("poecal-out/history.jsonl");
    assert!(history.contains("poecal-track-1") && history.lines().count() == 1, "{history}");
    // Both commands read a history that has lines of both.
    folder.done("validate poecal-out/calibration.json cell/measurements.csv");
    folder.done("track poecal-out/calibration.json cell/measurements.csv --repeatability 0.05mm");
    assert_eq!(folder.read("poecal-out/history.jsonl").lines().count(), 2);
}

#[test]
fn witnesses_are_planned_and_written() {
    let folder = cell();
    let run =
        folder.run("track poecal-out/calibration.json --plan 8 --repeatability 0.05mm --out witness.csv");
    assert_eq!(run.code, 0, "{}{}", run.out, run.err);
    assert!(run.out.contains("not seen"), "{}", run.out);
    // A comment, the names, and eight rows.
    assert_eq!(folder.read("witness.csv").lines().count(), 10);
}

/// The plan of a visit is the same by both spellings; and of new configurations there is one too.
#[test]
fn visits_are_planned_by_plan_for_drift() {
    let folder = cell();
    folder.done("track poecal-out/calibration.json --plan 8 --repeatability 0.05mm --out one.csv");
    let run = folder.run("plan poecal-out/calibration.json --for drift --repeatability 0.05mm --out two.csv");
    assert_eq!((run.code, folder.read("one.csv")), (0, folder.read("two.csv")), "{}", run.err);
    folder.done("plan robot.urdf --count 20 --out new.csv");
    let words = "plan poecal-out/calibration.json --for drift --device known --count 6 --candidates new.csv --out three.csv";
    let run = folder.run(words);
    assert!(run.code == 0 && run.out.contains("6, new"), "{}{}", run.out, run.err);
    assert!(run.out.contains("joint1") && !run.out.contains("joint1: the device"), "{}", run.out);
    assert_eq!(folder.read("three.csv").lines().count(), 8);
    for (words, expected) in [
        ("poecal-out/calibration.json --for drift --count 61", "60 measured configurations"),
        ("poecal-out/calibration.json --for drift --count 2", "choose more"),
        ("poecal-out/calibration.json --for drift --device 1,2,3mm", "known or anew"),
        ("robot.urdf --device known", "expected a place"),
        ("robot.urdf --for drift", "calibration.json"),
        ("poecal-out/calibration.json --for drift --floor 20mm", "cannot be used with"),
    ] {
        let run = folder.run(&format!("plan {words}"));
        assert!(run.code == 2 && run.err.contains(expected), "{words}: {}", run.err);
    }
}

/// Rows of which none repeats are judged by the model, and that is said; so is a model that has other bytes now.
#[test]
fn rows_that_repeat_nothing_are_judged_by_the_model() {
    let folder = cell();
    folder.done("simulate robot.urdf --kind point --count 30 --seed 4 --out other");
    let run = folder.run("track poecal-out/calibration.json other/measurements.csv --history none");
    assert!(run.err.contains("none of the rows repeats"), "{}{}", run.out, run.err);
    let model = folder.read("cell/nominal.urdf") + "<!-- another -->\n";
    folder.write("cell/nominal.urdf", model);
    let run = folder
        .run("track poecal-out/calibration.json cell/measurements.csv --repeatability 0.05mm --history none");
    assert!(
        run.code == 0 && run.err.contains("has other bytes than when it was calibrated"),
        "{}{}",
        run.out,
        run.err
    );
}

#[test]
fn what_cannot_be_judged_is_refused() {
    let folder = cell();
    let few: Vec<String> = folder.read("cell/measurements.csv").lines().take(3).map(str::to_owned).collect();
    folder.write("few.csv", few.join("\n") + "\n");
    let run = folder.run("track poecal-out/calibration.json few.csv");
    assert_eq!(run.code, 2, "{}", run.out);
    assert!(run.err.contains("more configurations"), "{}", run.err);
    let run = folder
        .run("track poecal-out/calibration.json cell/measurements.csv --recalibrate nothing --out new.json");
    assert!(run.code == 2 && run.err.contains("found joint `nothing`"), "{}", run.err);
    let run = folder.run("track poecal-out/calibration.json cell/measurements.csv --out new.json");
    assert!(run.code == 2 && run.err.contains("--plan or --recalibrate"), "{}", run.err);
}
