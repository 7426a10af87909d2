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
