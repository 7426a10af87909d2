//! Reading of `calibration.json`: refused texts and the positions of their faults.

use poecal_results::calibration_file::CalibrationFile;

#[test]
fn limits_that_are_none_are_refused() {
    let seed = include_str!("../../../../fuzz/seeds/calibration/scara");
    let mut file = CalibrationFile::parse(seed, "c.json").unwrap();
    file.joints[0].limits = Some([1.0, -1.0]);
    let error = file.robot().unwrap_err().to_string();
    assert_eq!(error, "found limits from 1 to -1 of joint `joint1`, expected the lower one first");
}

#[test]
fn columns_count_characters() {
    let error = CalibrationFile::parse("{\n\"µµ\": \"µ\" x}", "c.json").unwrap_err();
    let place = error.place().unwrap();
    assert_eq!((place.line, place.column), (Some(2), Some(11)), "{error}");
}
