//! Files as instruments, controllers and recorders write them.

use poecal_import::{Join, MeasurementFile, ReadOptions, imported_table, parse, read};
use poecal_model::simulate::elbow;

use crate::one_file::with_files;
use crate::properties::one_line;
use crate::{BETWEEN, LONGEST};

/// The names under which files are read.
pub(crate) const NAMES: [&str; 2] = ["input.1", "input.2"];

/// A file in any form, or two of which one has the joint readings of the other, including bytes of workbooks and bags: read as they are, joined row
/// by row. The data are the same each time, and as a table of the project's form.
pub fn read_recorded(data: &[u8]) -> bool {
    if data.len() > LONGEST {
        return false;
    }
    let between = format!("\n{BETWEEN}\n");
    let at = data.windows(between.len()).position(|it| it == between.as_bytes());
    let files: Vec<(&str, &[u8])> = match at {
        Some(at) => vec![(NAMES[0], &data[..at]), (NAMES[1], &data[at + between.len()..])],
        None => vec![(NAMES[0], data)],
    };
    read_files(&files)
}

/// Files that are read together.
pub(crate) fn read_files(files: &[(&str, &[u8])]) -> bool {
    let robot = elbow();
    let mut options = ReadOptions { join: (files.len() > 1).then_some(Join::Rows), ..ReadOptions::default() };
    let stated = options.state_units("mm,deg");
    assert!(stated.is_ok());
    let paths: Vec<&str> = files.iter().map(|it| it.0).collect();
    let whole = || with_files(files, || read(&paths, &robot, &options));
    let file = match whole() {
        Ok(file) => file,
        Err(error) => {
            one_line(&error.to_string());
            assert!(!error.message().trim().is_empty(), "an error without words");
            let Some(place) = error.place() else { return false };
            let own = files.iter().find(|it| place.path == std::path::Path::new(it.0));
            assert!(own.is_some(), "{error}: no file of these");
            assert!(place.line.is_none_or(|line| line > 0), "{error}");
            return false;
        }
    };
    assert_sound(&file);
    let again = whole();
    let is_same = |again: &MeasurementFile| {
        again.data == file.data
            && again.notes == file.notes
            && again.warnings == file.warnings
            && again.joins == file.joins
    };
    assert!(again.is_ok_and(|again| is_same(&again)), "another result of the same files");
    let Ok(table) = imported_table(&file, &robot) else { return true };
    let Ok(back) = parse(&table, "session.csv", &robot, &ReadOptions::default()) else { return true };
    let (own, other) = (file.data.all_readings(), back.data.all_readings());
    // Degrees from radians are rounded.
    let is_same = |(a, b): (&f64, &f64)| (a - b).abs() <= 4.0 * f64::EPSILON * a.abs();
    assert!(own.len() == other.len() && own.iter().zip(other).all(is_same), "{table}");
    true
}

/// Asserts that the data are consistent.
fn assert_sound(file: &MeasurementFile) {
    let checked = file.data.check();
    assert!(checked.is_ok(), "{checked:?}");
    assert!(!file.data.is_empty());
    file.notes.iter().chain(&file.warnings).for_each(|words| one_line(words));
    assert!(file.data.all_readings().iter().all(|reading| reading.is_finite()));
    for join in &file.joins {
        assert!(
            join.pairs.iter().all(|[one, other]| {
                (1..=join.joint_rows).contains(one) && (1..=join.measured_rows).contains(other)
            })
        );
        assert!(join.paired >= join.pairs.len());
    }
}
