//! All of a calibration, in memory.

use poecal_calibrate::{Calibration, CalibrationOptions, calibrate};
use poecal_fit::forensics::{DiagnosisOptions, diagnose};
use poecal_formats::urdf::ChainSelection;
use poecal_import::{ColumnMap, MeasurementFile, ReadOptions, parse, parse_joints};
use poecal_report as report;
use poecal_results::calibration_file::{CalibrationFile, Inputs};
use poecal_results::model::{Model, ModelSource};
use poecal_results::predictions::{PredictionFrame, predict};
use poecal_results::residuals::Residuals;

use super::calibration::{assert_round_trip, page};
use super::models::{assert_patched, convert_both_forms};
use super::tables::{assert_sound, joints_sound};
use crate::properties::{PATH, VAST_M, certain, check_result, one_line, parts, size_m};

/// Limits of a calibrated input, so that it takes little time.
const MOST_JOINTS: usize = 8;
const MOST_ROWS: usize = 60;
const MOST_TARGETS: usize = 4;

/// A model, measurements and a mapping: read, checked, calibrated, written and predicted.
pub fn pipeline(data: &[u8]) -> bool {
    let Some([model, table, map]) = parts(data) else { return false };
    let selection = ChainSelection::default();
    let Some(model) = check_result(Model::parse(&model, PATH, &selection), &model) else { return false };
    let mapping = if map.is_empty() {
        None
    } else {
        let Some(mapping) = check_result(ColumnMap::parse(&map, PATH), &map) else { return false };
        Some(mapping)
    };
    let options = ReadOptions { mapping, ..ReadOptions::default() };
    let Some(file) = check_result(parse(&table, PATH, &model.robot, &options), &table) else { return false };
    assert_sound(&file, &table);
    let sizes = (model.robot.joints.len(), file.data.len(), file.data.targets.len());
    if sizes.0 > MOST_JOINTS || sizes.1 > MOST_ROWS || sizes.2 > MOST_TARGETS {
        return true;
    }
    check_diagnosis(&model, &file);
    let calibrated = calibrate(&model.robot, &file.data, &CalibrationOptions { restarts: 2, ..Default::default() });
    let calibration = match calibrated {
        Ok(calibration) => calibration,
        Err(error) => {
            one_line(&error.to_string());
            return false;
        }
    };
    let results = results(&model, &file, &calibration);
    if let Some(joints) = check_result(parse_joints(&table, PATH, &model.robot, &options), &table) {
        joints_sound(&joints, &model.robot);
        for (frame, doubts) in [(PredictionFrame::Base, true), (PredictionFrame::Device, false)] {
            check_result(predict(&results, &joints, frame, None, doubts), "");
        }
    }
    true
}

fn check_diagnosis(model: &Model, file: &MeasurementFile) {
    let found = diagnose(&model.robot, &file.data, &file.data.all_rows(), &DiagnosisOptions::default());
    found.iter().for_each(|diagnosis| one_line(&diagnosis.statement));
    let check = report::Check::new(model, Some(file), &found);
    assert!(!check.text().is_empty());
    certain(report::json(&check), "check as JSON");
}

/// Results of a calibration, and the model that it becomes.
fn results(model: &Model, read: &MeasurementFile, calibration: &Calibration) -> Model {
    for sentence in &calibration.warnings {
        one_line(sentence);
    }
    let file = CalibrationFile::new(calibration, &read.data, Inputs::default());
    for detail in [report::Detail::Short, report::Detail::Full] {
        assert!(!report::summary(&file, detail).is_empty());
    }
    assert_round_trip(&file);
    let residuals = Residuals::from_calibration(&read.data, calibration);
    let text = residuals.text();
    assert_eq!(certain(Residuals::parse(&text, PATH), &text).text(), text);
    assert!(page(&file, &residuals), "a calibration without a page");
    let robot = calibration.robot_with_targets();
    if let ModelSource::Urdf(document) = &model.source
        && size_m(&robot) < VAST_M
    {
        assert_patched(document, &robot);
    }
    let model = Model { robot, source: ModelSource::Calibration(Box::new(file)), path: PATH.into() };
    convert_both_forms(&model);
    model
}
