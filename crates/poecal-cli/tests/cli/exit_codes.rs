//! What the program ends with: 0 usable, 1 results that should not be used, 2 refused, 3 no result.

use poecal::simulate::Kind;

use crate::folder::Folder;
use crate::session::{calibration, session};

/// The session with two columns exchanged: the verdict is `do not use`.
fn exchanged() -> Folder {
    let folder = session(Kind::Pose);
    let text = folder.read("measurements.csv");
    let header = text.lines().next().unwrap();
    let exchanged = header.replace("joint4", "other").replace("joint5", "joint4").replace("other", "joint5");
    folder.write("exchanged.csv", text.replacen(header, &exchanged, 1));
    folder
}

#[test]
fn a_usable_calibration_ends_with_0() {
    let folder = exchanged();
    assert_eq!(folder.run("calibrate robot.urdf measurements.csv").code, 0);
    assert_eq!(folder.run("calibrate robot.urdf measurements.csv --force --json --require good").code, 0);
}

#[test]
fn a_calibration_that_should_not_be_used_is_written_and_ends_with_1() {
    let folder = exchanged();
    for more in ["", " --json", " --quiet", " --report none"] {
        let run = folder.run(&format!("calibrate robot.urdf exchanged.csv --force{more}"));
        assert_eq!(run.code, 1, "{more}: {}{}", run.out, run.err);
        let verdict = calibration(&folder, "poecal-out").verdict.unwrap();
        assert_eq!(verdict.level, poecal::calibration::Level::DoNotUse);
    }
    let run = folder.run("calibrate robot.urdf exchanged.csv --force");
    assert!(
        run.out.starts_with("verdict       do not use: exchanging the readings of joint4 and"),
        "{}",
        run.out
    );
}

#[test]
fn a_fit_that_did_not_converge_is_written_and_ends_with_1() {
    let folder = session(Kind::Point);
    // Full steps of free screws from far away.
    let text = folder.read("measurements.csv");
    let scrambled: Vec<String> = text
        .lines()
        .enumerate()
        .map(|(k, line)| {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            for (column, cell) in
                cells.iter_mut().enumerate().filter(|(column, _)| k > 0 && (9..12).contains(column))
            {
                *cell = format!("{}", ((k * 7919 + column * 104_729) % 1000) as f64 / 1000.0);
            }
            cells.join(",")
        })
        .collect();
    folder.write("scrambled.csv", scrambled.join("\n") + "\n");
    let run = folder.run("calibrate robot.urdf scrambled.csv --method gauss-newton --robust off");
    println!("{}{}", run.out, run.err);
    assert_eq!(run.code, 1);
    let file = calibration(&folder, "poecal-out");
    assert!(!file.solver.converged);
    assert!(file.verdict.unwrap().reasons.iter().any(|reason| reason == "the fit did not converge"));
}

#[test]
fn what_is_refused_ends_with_2_and_writes_nothing() {
    let folder = session(Kind::Point);
    let before = folder.listing();
    for words in [
        "calibrate robot.urdf missing.csv",
        "calibrate robot.urdf measurements.csv --held-out 2",
        "calibrate robot.urdf measurements.csv --held-out 0.9",
        "calibrate",
    ] {
        assert_eq!(folder.run(words).code, 2, "{words}");
    }
    assert_eq!(folder.listing(), before);
}
