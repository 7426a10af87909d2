//! Numbers by quantity: the table of quantities, files of another schema, rows without a position.

use std::collections::BTreeSet;

use nalgebra::Vector3;
use poecal_arm::lie::Pose;
use poecal_model::measurement::{Measurement, Quantity};
use poecal_report::{Detail, calibration_page, summary};
use poecal_results::calibration_file::{CalibrationFile, SCHEMA};
use poecal_results::residuals::{Residuals, columns};
use serde_json::Value;

/// A turning and a sliding joint, poses and points, suspected and repeated rows.
const FILE: &str = include_str!("../../../poecal-testing/data/calibration.json");
/// The rows of it.
const ROWS: &str = include_str!("../../../poecal-testing/data/calibration_rows.csv");

/// The file without its statements about positions, as if orientations alone had been measured; expected errors of predictions stay.
fn without_positions(value: &Value) -> Value {
    let position = ["position_mm", "sigma_position_mm"];
    match value {
        Value::Object(map) => {
            let is_own = |key: &str| {
                let rotation = map.get(&key.replace("position", "rotation").replace("mm", "deg"));
                rotation.is_some_and(|value| !value.is_null())
            };
            let kept = map.iter().filter(|(key, _)| !position.contains(&key.as_str()) || !is_own(key));
            Value::Object(kept.map(|(key, value)| (key.clone(), without_positions(value))).collect())
        }
        Value::Array(values) => Value::Array(values.iter().map(without_positions).collect()),
        other @ (Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_)) => other.clone(),
    }
}

#[test]
fn a_file_is_read_as_it_is_written_and_one_of_another_schema_names_its_command() {
    let file = CalibrationFile::parse(FILE, "calibration.json").unwrap();
    assert_eq!(CalibrationFile::parse(&file.to_text().unwrap(), "calibration.json").unwrap(), file);
    assert_eq!(file.uncertainty(&[None]).unwrap().1, [0]);
    let inputs = r#"{"model": "arm.urdf", "measurements": ["joints.csv", "seen.csv"]"#;
    for (inputs, command) in [
        (format!("{inputs}}}"), "poecal calibrate arm.urdf joints.csv seen.csv"),
        (
            format!("{inputs}, \"command\": \"poecal calibrate --settings poecal.toml\"}}"),
            "poecal calibrate --settings poecal.toml",
        ),
    ] {
        let text = format!(r#"{{"schema": "poecal-calibration-2", "inputs": {inputs}}}"#);
        let error = CalibrationFile::parse(&text, "calibration.json").unwrap_err().to_string();
        let expected = format!(
            "found schema `poecal-calibration-2`, expected `{SCHEMA}`, that of this version: calibrate again: `{command}`"
        );
        assert!(error.contains(&expected), "{error}");
    }
}

#[test]
fn names_of_quantities_and_their_columns_follow_from_one_table() {
    let mut names = BTreeSet::new();
    for quantity in Quantity::ALL {
        assert_eq!(quantity.key(), format!("{}_{}", quantity.name(), quantity.unit().symbol()));
        assert_eq!(columns(quantity, true).count(), 4 + quantity.components());
        names.extend(columns(quantity, true));
    }
    assert_eq!(names.len(), Quantity::ALL.into_iter().map(|it| columns(it, true).count()).sum::<usize>());
    for seen in [Measurement::point(Vector3::zeros()), Measurement::of_pose(&Pose::identity())] {
        for quantity in Quantity::ALL.into_iter().filter(|quantity| seen.has(*quantity)) {
            let own = seen.channels().iter().filter(|channel| channel.quantity == quantity);
            assert_eq!(own.map(|channel| channel.name).collect::<Vec<_>>(), quantity.component_names());
        }
    }
}

#[test]
fn rows_without_a_position_are_read_and_reported_by_what_they_have() {
    let mut rows: Vec<Vec<String>> = ROWS.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect();
    let column = |name: &str| rows[0].iter().position(|it| it == name).unwrap();
    let (first, rotation) = (column("position_nominal[mm]"), column("rotation_nominal[deg]"));
    let points = rows.iter().filter(|row| row[rotation].is_empty()).count();
    assert!(points > 10);
    // Rows of points stay, so that there are rows of either kind.
    for row in rows.iter_mut().skip(1).filter(|row| !row[rotation].is_empty()) {
        row[first..first + 6].iter_mut().for_each(String::clear);
    }
    let text = |rows: &[Vec<String>]| rows.iter().map(|row| row.join(",") + "\n").collect::<String>();
    let mixed = text(&rows);
    let residuals = Residuals::parse(&mixed, "residuals.csv").unwrap();
    assert_eq!(residuals.text(), mixed);
    let leading: Vec<_> = residuals.rows().iter().map(|row| row.errors.leading_value().unwrap().0).collect();
    assert_eq!(leading.iter().filter(|it| **it == Quantity::Position).count(), points);

    // A row without a quantity is no row.
    let mut nothing = rows.clone();
    nothing[1][first..first + 12].iter_mut().for_each(String::clear);
    let error = Residuals::parse(&text(&nothing), "residuals.csv").unwrap_err().to_string();
    assert!(error.starts_with("residuals.csv:2:") && error.contains("found ``, expected a number"), "{error}");

    // Orientations alone, fitted or held out as before.
    for row in rows.iter_mut().skip(1).filter(|row| row[rotation].is_empty()) {
        row[first..first + 6].iter_mut().for_each(String::clear);
        row[rotation..rotation + 6].iter_mut().for_each(|cell| "0".clone_into(cell));
    }
    let residuals = Residuals::parse(&text(&rows), "residuals.csv").unwrap();
    assert_eq!(residuals.measured_quantities(), [Quantity::Rotation]);
    let mut value = without_positions(&serde_json::from_str(FILE).unwrap());
    for (set, held_out) in [("training", false), ("held_out", true)] {
        let own = residuals.rows().iter().filter(|row| row.held_out == held_out);
        let errors: Vec<f64> = own.map(|row| row.errors.rotation_deg().unwrap().calibrated_error()).collect();
        let rms = (errors.iter().map(|it| it * it).sum::<f64>() / errors.len() as f64).sqrt();
        value["accuracy"][set]["calibrated"]["rotation_deg"]["rms"] = rms.into();
    }
    let file = CalibrationFile::parse(&value.to_string(), "calibration.json").unwrap();
    assert_eq!(CalibrationFile::parse(&file.to_text().unwrap(), "calibration.json").unwrap(), file);
    let page = calibration_page(&file, &residuals).unwrap().concat();
    for words in
        ["Rotation error on rows held out, degrees", "rotation error, °", r#""lead":{"name":"rotation","unit":"°"}"#]
    {
        assert!(page.contains(words), "{words}");
    }
    let text = summary(&file, Detail::Full);
    println!("{text}");
    assert!(text.contains("rotation in deg") && !text.contains("position in mm"));
}
