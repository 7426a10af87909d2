//! Numbers by quantity: the table of quantities, files of an earlier schema, rows without a position.

use std::collections::BTreeSet;

use nalgebra::Vector3;
use poecal_arm::lie::Pose;
use poecal_model::measurement::{Measurement, Quantity};
use poecal_report::{Detail, calibration_page, summary};
use poecal_results::calibration_file::{CalibrationFile, SCHEMA};
use poecal_results::residuals::{Residuals, columns};
use serde_json::Value;

/// Written by the last version of schema 1: a turning and a sliding joint, poses and points, suspected and repeated rows.
const EARLIER: &str = include_str!("../../../poecal-testing/data/calibration_schema_1.json");
/// The rows of it.
const ROWS: &str = include_str!("../../../poecal-testing/data/calibration_schema_1.csv");

fn earlier() -> CalibrationFile {
    CalibrationFile::parse(EARLIER, "calibration.json").unwrap()
}

/// The file without what it says of positions, as if orientations alone had been measured; expected errors of predictions stay.
fn without_positions(value: &Value) -> Value {
    let position = ["position_mm", "sigma_position_mm", "position_rms_mm", "residual_mm"];
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
fn a_file_of_the_earlier_schema_is_read_as_one_of_this() {
    let text = EARLIER.replace("poecal-calibration-1", SCHEMA);
    assert_ne!(text, EARLIER);
    assert_eq!(earlier(), CalibrationFile::parse(&text, "calibration.json").unwrap());
    // All keys of poses and points are as they were, but for those of a whole axis, which have its name now.
    let mut renamed = text;
    for key in ["tilt_deg", "shift_mm"] {
        renamed = renamed.replace(&format!("\"{key}\""), &format!("\"axis_{key}\""));
        renamed = renamed.replace(&format!("\"sigma_{key}\""), &format!("\"sigma_axis_{key}\""));
    }
    assert_eq!(earlier().to_text().unwrap(), renamed);
    assert_eq!(earlier().uncertainty(&[None]).unwrap().1, [0]);
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
    let mut rows: Vec<Vec<String>> =
        ROWS.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect();
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
    let leading: Vec<_> = residuals.rows().iter().map(|row| row.errors.leading().unwrap().0).collect();
    assert_eq!(leading.iter().filter(|it| **it == Quantity::Position).count(), points);

    // A row of nothing is none.
    let mut nothing = rows.clone();
    nothing[1][first..first + 12].iter_mut().for_each(String::clear);
    let error = Residuals::parse(&text(&nothing), "residuals.csv").unwrap_err().to_string();
    assert!(
        error.starts_with("residuals.csv:2:") && error.contains("found ``, expected a number"),
        "{error}"
    );

    // Orientations alone, fitted or held out as before.
    for row in rows.iter_mut().skip(1).filter(|row| row[rotation].is_empty()) {
        row[first..first + 6].iter_mut().for_each(String::clear);
        row[rotation..rotation + 6].iter_mut().for_each(|cell| "0".clone_into(cell));
    }
    let residuals = Residuals::parse(&text(&rows), "residuals.csv").unwrap();
    assert_eq!(residuals.measured(), [Quantity::Rotation]);
    let mut value = without_positions(&serde_json::from_str(EARLIER).unwrap());
    for (set, held_out) in [("training", false), ("held_out", true)] {
        let own = residuals.rows().iter().filter(|row| row.held_out == held_out);
        let errors: Vec<f64> = own.map(|row| row.errors.rotation_deg().unwrap().calibrated()).collect();
        let rms = (errors.iter().map(|it| it * it).sum::<f64>() / errors.len() as f64).sqrt();
        value["accuracy"][set]["calibrated"]["rotation_deg"]["rms"] = rms.into();
    }
    let file = CalibrationFile::parse(&value.to_string(), "calibration.json").unwrap();
    assert_eq!(CalibrationFile::parse(&file.to_text().unwrap(), "calibration.json").unwrap(), file);
    let page = calibration_page(&file, &residuals).unwrap().concat();
    for words in [
        "Rotation error on rows held out, degrees",
        "rotation error, °",
        r#""lead":{"name":"rotation","unit":"°"}"#,
    ] {
        assert!(page.contains(words), "{words}");
    }
    let text = summary(&file, Detail::Full);
    println!("{text}");
    assert!(text.contains("rotation in deg") && !text.contains("position in mm"));
}
