//! Contents of measurements: rows, their source, and their pickled state.

use std::collections::BTreeMap;
use std::sync::Arc;

use poecal_import::{InputEntry, JoinEntry, MeasurementFile};
use poecal_model::measurement::Dataset;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

use crate::arguments::{Argument, unexpected_error};
use crate::errors::{argument, raise};
use crate::pickle;
use crate::robot::Robot;
use crate::rows;

/// Measurements of a robot: in each row a configuration and the measurement of a target. Immutable.
///
/// Make them by `Measurements.from_csv`, `from_arrays` or `from_dataframe`. Lengths are in metres, angles in radians. Measurements
/// compare by value, and can be copied and pickled.
#[pyclass(frozen, module = "poecal", name = "Measurements")]
#[derive(Clone)]
pub(crate) struct Measurements {
    pub(crate) file: Arc<MeasurementFile>,
    pub(crate) source: Arc<MeasurementSource>,
}

/// Source of measurements.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct MeasurementSource {
    /// File names, or their substitutes.
    pub(crate) names: Vec<String>,
    /// SHA-256 of each file that was read.
    pub(crate) sha256: BTreeMap<String, String>,
    /// Kind of each file and its used rows.
    #[serde(default)]
    pub(crate) files: Vec<InputEntry>,
    /// Joins of the files.
    #[serde(default)]
    pub(crate) joins: Vec<JoinEntry>,
    /// True if `train_where` selected the rows to fit.
    pub(crate) train_where: bool,
}

/// Pickled measurements.
#[derive(Serialize, Deserialize)]
pub(super) struct MeasurementState {
    pub(super) data: Dataset,
    pub(super) notes: Vec<String>,
    pub(super) warnings: Vec<String>,
    pub(super) source: MeasurementSource,
}

impl Measurements {
    pub(super) fn new(file: MeasurementFile, source: MeasurementSource) -> Self {
        Measurements { file: Arc::new(file), source: Arc::new(source) }
    }

    /// Source of rows without a file.
    pub(crate) fn in_memory(data: Dataset, name: &str) -> Self {
        let source = MeasurementSource { names: vec![name.to_owned()], ..MeasurementSource::default() };
        Measurements::new(MeasurementFile { data, ..MeasurementFile::default() }, source)
    }

    pub(crate) fn data(&self) -> &Dataset {
        &self.file.data
    }

    /// Refuses a robot whose readings differ from those of the rows.
    pub(crate) fn check_robot(&self, robot: &Robot) -> PyResult<()> {
        let expected = robot.model.robot.reading_names();
        if self.data().reading_names() == expected {
            return Ok(());
        }
        Err(argument(
            "measurements",
            format!(
                "found readings of {}, expected those of robot `{}`: {}",
                self.data().reading_names().join(", "),
                robot.model.robot.name,
                expected.join(", ")
            ),
        ))
    }

    pub(crate) fn of_state(state: &[u8]) -> PyResult<Self> {
        let MeasurementState { data, notes, warnings, source } = pickle::value(state)?;
        data.check().map_err(raise)?;
        let file = MeasurementFile { data, notes, warnings, ..MeasurementFile::default() };
        Ok(Measurements::new(file, source))
    }

    /// Some of the rows.
    pub(super) fn part(&self, rows: &[usize]) -> PyResult<Self> {
        let file = MeasurementFile {
            data: rows::part(self.data(), rows)?,
            notes: self.file.notes.clone(),
            warnings: self.file.warnings.clone(),
            ..MeasurementFile::default()
        };
        Ok(Measurements { file: Arc::new(file), source: Arc::clone(&self.source) })
    }

    /// The rows of all parts.
    pub(super) fn join_parts(parts: &[&Self]) -> PyResult<Self> {
        let data: Vec<&Dataset> = parts.iter().map(|part| part.data()).collect();
        let (mut source, mut notes, mut warnings) = (MeasurementSource::default(), Vec::new(), Vec::new());
        let add = |known: &mut Vec<String>, more: &[String]| {
            more.iter().for_each(|it| {
                if !known.contains(it) {
                    known.push(it.clone())
                }
            });
        };
        for part in parts {
            add(&mut source.names, &part.source.names);
            add(&mut notes, &part.file.notes);
            add(&mut warnings, &part.file.warnings);
            source.sha256.extend(part.source.sha256.clone());
            // Parts of one reading have the same files.
            for file in &part.source.files {
                if !source.files.contains(file) {
                    source.files.push(file.clone());
                }
            }
            for join in &part.source.joins {
                if !source.joins.contains(join) {
                    source.joins.push(join.clone());
                }
            }
            source.train_where |= part.source.train_where;
        }
        let file = MeasurementFile { data: rows::join_datasets(&data)?, notes, warnings, ..MeasurementFile::default() };
        Ok(Measurements::new(file, source))
    }

    pub(super) fn words(&self) -> String {
        let data = self.data();
        let poses = data.observations.iter().filter(|row| row.measurement.sees_orientation()).count();
        let points = data.len() - poses;
        let targets: Vec<&str> = data.targets.iter().flatten().map(String::as_str).collect();
        let of = if targets.is_empty() { "the tip".to_owned() } else { targets.join(", ") };
        let counted = |count: usize, one: &str| format!("{count} {one}{}", if count == 1 { "" } else { "s" });
        let kinds = [(poses, "pose"), (points, "point")].into_iter().filter(|(count, _)| *count > 0);
        let kinds: Vec<String> = kinds.map(|(count, one)| counted(count, one)).collect();
        match kinds.as_slice() {
            [] => counted(0, "row"),
            kinds => format!("{}: {} of {of}", counted(data.len(), "row"), kinds.join(" and ")),
        }
    }
}

impl<'a, 'py> Argument<'a, 'py> for &'a Measurements {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        let expected = "poecal.Measurements, as of Measurements.from_csv, from_arrays or from_dataframe";
        value.cast::<Measurements>().map(Bound::get).map_err(|_| unexpected_error(name, value, expected))
    }
}

impl<'a, 'py> Argument<'a, 'py> for Measurements {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        <&Measurements>::from_argument(value, name).cloned()
    }
}
