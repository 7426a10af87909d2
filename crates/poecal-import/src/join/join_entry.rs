//! Record of files and of their join.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::table::understanding::FileUnderstanding;
use crate::{Join, MeasurementFile};
use poecal_fit::start::MotionEntry;

/// Largest number of pairs in a list, and of rows without partner.
pub(crate) const MOST_PAIRS: usize = 2000;
pub(crate) const MOST_ALONE: usize = 1000;

/// A file that was read.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct InputEntry {
    /// Its name, as in `measurements`.
    pub file: String,
    /// Form of the file; absent for a table in our form.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub form: Option<String>,
    /// Interpretation of a file in another form, in a few words: sheet, frame, body, topic, unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub understood: Option<String>,
    /// Number of rows of the file, including beam breaks.
    pub rows: usize,
    /// Number of items that were taken, by quantity: `joint readings`, `points`, `poses` and other measurements.
    pub taken: BTreeMap<String, usize>,
    /// Units of its columns.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub units: Vec<String>,
    /// Number of beam breaks: measurements without a position, which were left out.
    #[serde(default, skip_serializing_if = "is_none")]
    pub lost: usize,
}

/// Join of a file of measurements with one of joint readings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct JoinEntry {
    /// The file of joint readings.
    pub joints: String,
    /// The file of measurements.
    pub measurements: String,
    /// Method by which rows were matched.
    pub join: Join,
    /// Number of rows of joint readings, or of static intervals of their stream.
    pub joint_rows: usize,
    /// Number of measured configurations, or of static intervals of the stream of measurements.
    pub measured_rows: usize,
    /// Number of pairs.
    pub paired: usize,
    /// Median error of the nominal robot at the pairs, millimetres; absent if there are too few pairs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub missed_mm: Option<f64>,
    /// Time of the measurements less that of the joint readings, seconds; absent without clocks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lag_s: Option<f64>,
    /// Pairs: number of the row of joint readings, and of the measured configuration, each from 1; at most 2,000.
    pub pairs: Vec<[usize; 2]>,
    /// Joint readings without a measurement; at most 1,000, as in the next two lists.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unmeasured: Vec<RowEntry>,
    /// Joint readings with more than one measurement.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub repeated: Vec<RowEntry>,
    /// Measured configurations that were left out, because they have no joint readings.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unread: Vec<RowEntry>,
    /// The robot's motion, for a stream of joint readings.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot_motion: Option<MotionEntry>,
    /// The target's motion, for a stream of measurements, or for single points with times.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured_motion: Option<MotionEntry>,
}

/// A row of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct RowEntry {
    /// Its number among the rows or static intervals, from 1.
    pub number: usize,
    /// Its line, row of a sheet or message; that of its first row for a static interval.
    pub line: usize,
}

fn is_none(count: &usize) -> bool {
    *count == 0
}

impl InputEntry {
    fn from_understanding(it: &FileUnderstanding) -> Self {
        let counts = [("points", it.points), ("poses", it.poses)];
        let others = it.others.iter().map(|(name, count)| (*name, *count));
        let mut units: Vec<String> = Vec::new();
        for unit in it.columns.iter().filter_map(|column| column.unit) {
            if !units.iter().any(|known| known == unit) {
                units.push(unit.to_owned());
            }
        }
        InputEntry {
            file: it.path.display().to_string(),
            form: it.form.map(str::to_owned),
            understood: it.understood.clone(),
            rows: it.rows,
            taken: counts
                .into_iter()
                .chain(others)
                .filter(|it| it.1 > 0)
                .map(|(name, count)| (name.to_owned(), count))
                .collect(),
            units,
            lost: it.lost.count,
        }
    }
}

impl MeasurementFile {
    /// Entries of the files in `calibration.json`; a file with joint readings and measurements has two.
    #[must_use]
    pub fn inputs(&self) -> Vec<InputEntry> {
        self.understood.iter().map(InputEntry::from_understanding).collect()
    }
}
