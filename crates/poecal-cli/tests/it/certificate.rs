//! `poecal report --certificate`.

use poecal_model::simulate::SessionKind;

use crate::session::session;

/// The statements of the record are printed beside those of the calibration, with the checksum of its file.
#[test]
fn a_certificate_states_the_session_and_its_result() {
    let folder = session(SessionKind::POINT);
    folder.run_to_success(
        "calibrate robot.urdf measurements.csv --accept 10mm --record serial=4711 --record operator=Mia",
    );
    folder.write("logo.svg", "<svg xmlns=\"http://www.w3.org/2000/svg\"/>");
    let out = folder.run_to_success(
        "report poecal-out/calibration.json --certificate --logo logo.svg --record valid_until=2027-11-28 --record serial=4712",
    );
    assert_eq!(out, "written       poecal-out/certificate.html\n");
    let page = folder.read("poecal-out/certificate.html");
    for words in ["4712", "Mia", "2027-11-28", "data:image/svg+xml,%3C", "k = 2", "calibration.json <code>", "PASS"] {
        assert!(page.contains(words), "{words}");
    }
    assert!(!page.contains("4711") && !page.contains("<script"));
    // Again: its own file is replaced, others' are not.
    folder.run_to_success("report poecal-out/calibration.json --certificate");
    folder.write("theirs.html", "theirs");
    for (words, sentence) in [
        ("report poecal-out/calibration.json --certificate --out theirs.html", "theirs.html"),
        ("report robot.urdf --certificate", "found a URDF, expected a calibration as written by `poecal calibrate`"),
        (
            "report poecal-out/calibration.json --certificate --record valid_until=tomorrow",
            "found `tomorrow` as the day until which it is valid",
        ),
        (
            "report poecal-out/calibration.json --certificate --logo robot.urdf",
            "found no picture, expected PNG, JPEG or SVG",
        ),
    ] {
        let run = folder.run(words);
        assert!(run.code == 2 && run.err.contains(sentence), "{words}: {}", run.err);
    }
    assert_eq!(folder.read("theirs.html"), "theirs");
}
