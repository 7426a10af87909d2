//! `calibration.json`, and the report made of it.

use poecal_import::parse_joints;
use poecal_report::calibration_page;
use poecal_results::calibration_file::CalibrationFile;
use poecal_results::model::{Model, ModelSource};
use poecal_results::predictions::{PredictionFrame, predict};
use poecal_results::residuals::Residuals;

use super::models::convert_both_forms;
use crate::properties::{PATH, certain, check_result, one_line, parts, text};

/// A calibration: read, written, read again, and used as a robot.
pub fn calibration(data: &[u8]) -> bool {
    let Some(text) = text(data) else { return false };
    let Some(file) = check_result(CalibrationFile::parse(&text, PATH), &text) else { return false };
    assert_round_trip(&file);
    let robots = [file.robot(), file.nominal_robot()].map(|robot| check_result(robot, &text));
    check_result(file.base_from_device(), &text);
    let [Some(robot), _] = robots else { return false };
    let names = robot.reading_names();
    let table = format!(
        "{}\n{}\n",
        names.iter().map(|name| quote_name(name)).collect::<Vec<_>>().join(","),
        vec!["0.1"; names.len()].join(",")
    );
    let source = ModelSource::Calibration(Box::new(file));
    let model = Model { robot, source, path: PATH.into() };
    convert_both_forms(&model);
    let corrected = check_result(model.clone().corrected_model(), &text);
    for model in std::iter::once(model).chain(corrected) {
        let joints = check_result(parse_joints(&table, PATH, &model.robot, &Default::default()), &table);
        for (frame, doubts) in [(PredictionFrame::Base, true), (PredictionFrame::Device, false)] {
            if let Some(joints) = &joints {
                check_result(predict(&model, joints, frame, None, doubts), "");
            }
        }
    }
    true
}

fn quote_name(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}

/// Asserts that written text reads back the same.
pub(crate) fn assert_round_trip(file: &CalibrationFile) {
    let written = certain(file.to_text(), "to_text");
    let again = certain(CalibrationFile::parse(&written, PATH), &written);
    assert_eq!(&again, file);
    assert_eq!(certain(again.to_text(), "to_text"), written);
}

/// A calibration and its residuals: the page.
pub fn report(data: &[u8]) -> bool {
    let Some([json, csv]) = parts(data) else { return false };
    let Some(file) = check_result(CalibrationFile::parse(&json, PATH), &json) else { return false };
    let Some(residuals) = check_result(Residuals::parse(&csv, PATH), &csv) else { return false };
    page(&file, &residuals)
}

/// Asserts that the page is complete, and no text of a file becomes markup in it.
pub(crate) fn page(file: &CalibrationFile, residuals: &Residuals) -> bool {
    let page = match calibration_page(file, residuals) {
        Ok(page) => page,
        Err(error) => {
            one_line(&error.to_string());
            return false;
        }
    };
    let [head, body, _, data, ..] = page.as_slice() else { panic!("{} pieces", page.len()) };
    // A leverage that is not a number is reported as such.
    let unfit =
        residuals.rows().iter().filter_map(|row| row.judged).any(|it| !(it.leverage + it.studentized).is_finite());
    assert!(head.starts_with("<!DOCTYPE html>") && page.concat().ends_with("</html>\n"));
    for piece in [head, body] {
        let lower = piece.to_lowercase();
        for markup in ["<script", "<iframe", "<img", "<link", "javascript:"] {
            assert!(!lower.contains(markup), "{markup} in the page");
        }
        assert!(unfit || !piece.contains("NaN"), "NaN in the page");
    }
    assert!(!data.contains('<'));
    serde_json::from_str::<serde_json::Value>(data).expect("the page's data");
    true
}
