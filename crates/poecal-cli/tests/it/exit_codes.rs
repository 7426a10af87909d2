//! Exit codes: 0 usable, 1 results that should not be used, 2 refused, 3 no result.

use poecal_model::simulate::SessionKind;

use crate::folder::Folder;
use crate::session::{calibration, session};

/// The session with two columns exchanged: the verdict is `do not use`.
fn folder_with_exchange() -> Folder {
    let folder = session(SessionKind::POSE);
    let text = folder.read("measurements.csv");
    let header = text.lines().next().unwrap();
    let exchanged = header.replace("joint4", "other").replace("joint5", "joint4").replace("other", "joint5");
    folder.write("exchanged.csv", text.replacen(header, &exchanged, 1));
    folder
}

#[test]
fn a_usable_calibration_ends_with_0() {
    let folder = folder_with_exchange();
    assert_eq!(folder.run("calibrate robot.urdf measurements.csv").code, 0);
    assert_eq!(folder.run("calibrate robot.urdf measurements.csv --force --json --require good").code, 0);
}

#[test]
fn a_calibration_that_should_not_be_used_is_written_and_ends_with_1() {
    let folder = folder_with_exchange();
    for more in ["", " --json", " --quiet", " --report none"] {
        let run = folder.run(&format!("calibrate robot.urdf exchanged.csv --force{more}"));
        assert_eq!(run.code, 1, "{more}: {}{}", run.out, run.err);
        let verdict = calibration(&folder, "poecal-out").verdict.unwrap();
        assert_eq!(verdict.level, poecal_calibrate::Level::DoNotUse);
    }
    let run = folder.run("calibrate robot.urdf exchanged.csv --force");
    assert!(run.out.starts_with("verdict       do not use: exchanging the readings of joint4 and"), "{}", run.out);
}

#[test]
fn a_fit_that_did_not_converge_is_written_and_ends_with_1() {
    let folder = session(SessionKind::POINT);
    folder.run_to_success("simulate robot.urdf --kind point --count 14 --errors 60deg,500mm --seed 4 --out far");
    // Full steps of free screws and offsets, with hardly more numbers than unknowns, from far away.
    let run = folder.run(
        "calibrate far/nominal.urdf far/measurements.csv --formulation screw-offsets --method gauss-newton --robust off --held-out 0",
    );
    assert_eq!(run.code, 1, "{}{}", run.out, run.err);
    let file = calibration(&folder, "poecal-out");
    assert!(!file.solver.converged);
    assert!(file.verdict.unwrap().reasons.iter().any(|reason| reason == "the fit did not converge"));
}

#[test]
fn without_any_result_it_ends_with_3_and_nothing_is_written() {
    let folder = session(SessionKind::POINT);
    let before = folder.listing();
    let run = folder.run("calibrate robot.urdf measurements.csv --sigma-position 1e-200mm");
    assert_eq!(run.code, 3, "{}{}", run.out, run.err);
    assert!(run.err.contains("error: found residuals that are not finite numbers"), "{}", run.err);
    assert_eq!(folder.listing(), before);
}

#[test]
fn what_is_refused_ends_with_2_and_writes_nothing() {
    let folder = session(SessionKind::POINT);
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

#[test]
fn a_level_of_vector_instructions_that_is_not_here_is_refused() {
    let folder = session(SessionKind::POINT);
    let before = folder.listing();
    for level in ["avx1024", "AVX2"] {
        let run = folder.run_with_variable("calibrate robot.urdf measurements.csv", "POECAL_SIMD", level);
        assert_eq!(run.code, 2, "{level}: {}{}", run.out, run.err);
        let start = format!("error: POECAL_SIMD: found `{level}`, expected one of the levels of this machine (");
        assert!(run.err.starts_with(&start) && run.err.contains("plain"), "{}", run.err);
    }
    assert_eq!(folder.listing(), before);
    for level in ["plain", ""] {
        let command = "calibrate robot.urdf measurements.csv --force";
        let run = folder.run_with_variable(command, "POECAL_SIMD", level);
        assert_eq!(run.code, 0, "{}", run.err);
    }
}
