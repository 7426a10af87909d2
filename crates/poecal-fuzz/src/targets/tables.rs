//! Tables: measurements and joint readings.

use poecal_import::{ColumnMap, JointsTable, MeasurementFile, ReadOptions, parse, parse_joints};
use poecal_model::robot::Robot;
use poecal_model::simulate::{elbow, scara};
use poecal_results::model::{Model, ModelSource};
use poecal_results::predictions::{PredictionFrame, predict};

use crate::properties::{PATH, certain, check_result, one_line, parts, text};

/// A robot with the joints of a table.
pub(crate) fn robot_of(table: &str) -> Robot {
    if table.contains("joint6") { elbow() } else { scara() }
}

/// A measurement table, with the mapping by which it is read, if one follows.
pub fn measurements(data: &[u8]) -> bool {
    let Some([table, map]) = parts(data) else { return false };
    let mapping = if map.is_empty() {
        None
    } else {
        let Some(mapping) = check_result(ColumnMap::parse(&map, PATH), &map) else { return false };
        Some(mapping)
    };
    let robot = robot_of(&table);
    let options = ReadOptions { mapping, ..ReadOptions::default() };
    let Some(file) = check_result(parse(&table, PATH, &robot, &options), &table) else { return false };
    assert_sound(&file, &table);
    // The set of a line does not affect its content.
    let all = ReadOptions { ignore_sets: true, ..options };
    let again = certain(parse(&table, PATH, &robot, &all), "without sets");
    assert_eq!(file.data.all_readings(), again.data.all_readings());
    true
}

/// Asserts that the data are consistent and belong to the text.
pub(crate) fn assert_sound(file: &MeasurementFile, text: &str) {
    certain(file.data.check(), "data");
    file.warnings.iter().for_each(|warning| one_line(warning));
    assert!(!file.data.is_empty() && file.understood.len() == 1);
    let lines = text.split(['\n', '\r']).count();
    for understood in &file.understood {
        let others: usize = understood.others.values().sum();
        assert_eq!(understood.points + understood.poses + others, file.data.len());
        // A row may have no measurement.
        assert!(understood.rows <= lines);
    }
    assert!(file.data.observations.iter().all(|row| (1..=lines).contains(&(row.source.line as usize))));
    assert!(file.data.all_readings().iter().all(|reading| reading.abs() <= 1e6));
}

/// A table of joint readings, and predictions from them.
pub fn joints(data: &[u8]) -> bool {
    let Some(text) = text(data) else { return false };
    let robot = robot_of(&text);
    let Some(table) = check_result(parse_joints(&text, PATH, &robot, &ReadOptions::default()), &text) else {
        return false;
    };
    joints_sound(&table, &robot);
    let model = Model { robot, source: ModelSource::Toml, path: PATH.into() };
    let predicted = certain(predict(&model, &table, PredictionFrame::Base, None, false), "predict");
    assert!(predicted.lines().count() > table.rows, "{predicted}");
    true
}

pub(crate) fn joints_sound(table: &JointsTable, robot: &Robot) {
    assert_eq!(table.readings.len(), table.rows * robot.reading_names().len());
    assert!(table.ids.is_empty() || table.ids.len() == table.rows);
    assert!(table.lines.len() == table.rows && table.lines.is_sorted_by(|a, b| a < b));
    table.warnings.iter().for_each(|warning| one_line(warning));
}
