//! Outliers in `calibration.json`.

use std::collections::BTreeSet;
use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::CalibrationFile;
use super::in_file_units;
use poecal_calibrate::{Calibration, Loss, RowError, SetAccuracy, row_influence};
use poecal_model::measurement::{Dataset, MeasuredQuantities};

/// Most suspected rows in a file; `robust` has their number.
const LISTED: usize = 1000;

/// Treatment of outliers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RobustEntry {
    /// Loss of a robust fit; null: least squares.
    pub loss: Option<Loss>,
    /// Numbers of suspected rows.
    pub suspected: OutliersBySet<usize>,
    /// `accuracy` without suspected rows; null for a set that has none.
    pub without_suspected: OutliersBySet<Option<SetAccuracy>>,
}

/// A value for the training rows and one for the held-out rows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct OutliersBySet<T> {
    /// Value of the training rows.
    pub training: T,
    /// Value of the held-out rows.
    pub held_out: T,
}

/// A suspected outlier.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OutlierEntry {
    /// Its file, as named by the user.
    pub file: String,
    /// Its line in that file, from 1.
    pub row: u32,
    /// Its set.
    pub set: OutlierSet,
    /// Residual of each measured quantity against the calibrated model's prediction, millimetres or degrees: distance of positions, angle of
    /// orientations, and so on.
    pub residual: MeasuredQuantities<f64>,
    /// Studentised residual: length over its own standard deviation.
    pub studentized: f64,
    /// Weight in the fit, 0 to 1; for a held-out row the weight that it would have had.
    pub weight: f64,
}

/// Set of a suspected row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum OutlierSet {
    /// Training row.
    Fit,
    /// Held-out row.
    HeldOut,
}

impl RobustEntry {
    /// Outliers of a finished calibration.
    pub(crate) fn from_calibration(calibration: &Calibration) -> Self {
        let robustness = &calibration.robustness;
        let suspected = |rows: &[u32]| rows.len() - robustness.rest(rows).len();
        RobustEntry {
            loss: robustness.loss,
            suspected: OutliersBySet {
                training: suspected(&calibration.fit_rows),
                held_out: suspected(&calibration.held_out_rows),
            },
            without_suspected: OutliersBySet { training: robustness.training_rest, held_out: robustness.held_out_rest },
        }
    }
}

impl CalibrationFile {
    /// The rows that are not suspected, of data from which the calibration was made. Files are identified by their names without folders.
    pub(crate) fn kept_rows(&self, data: &Dataset) -> Vec<u32> {
        let place = |file: &Path, line: u32| Some((file.file_name()?.to_owned(), line));
        let suspected: BTreeSet<_> = self.outliers.iter().filter_map(|it| place(Path::new(&it.file), it.row)).collect();
        let is_kept = |row: &u32| {
            let source = data.observations[*row as usize].source;
            let file = data.files.get(source.file as usize);
            file.and_then(|file| place(file, source.line)).is_none_or(|it| !suspected.contains(&it))
        };
        data.all_rows().into_iter().filter(is_kept).collect()
    }
}

impl OutlierEntry {
    /// Suspected rows of a finished calibration, the worst first, at most 1,000.
    #[must_use]
    pub fn all_from_calibration(calibration: &Calibration, data: &Dataset) -> Vec<Self> {
        let robustness = &calibration.robustness;
        let rows: Vec<u32> = robustness.suspects().collect();
        if rows.is_empty() {
            return Vec::new();
        }
        let influences = row_influence(calibration, data, &rows);
        let mut rows: Vec<(u32, f64)> =
            rows.into_iter().zip(influences.iter().map(|influence| influence.studentized)).collect();
        rows.sort_by(|(a, first), (b, second)| second.total_cmp(first).then(a.cmp(b)));
        rows.truncate(LISTED);
        let numbers: Vec<u32> = rows.iter().map(|(row, _)| *row).collect();
        let packed = calibration.packed_values(data);
        let errors = calibration.session(data, &packed).errors(&numbers, &calibration.models.calibrated);
        let entry = |((row, studentized), error): (&(u32, f64), &RowError)| {
            let source = data.observations[*row as usize].source;
            let file = data.files.get(source.file as usize);
            let held_out = calibration.held_out_rows.binary_search(row).is_ok();
            OutlierEntry {
                file: file.map_or_else(String::new, |path| path.display().to_string()),
                row: source.line,
                set: if held_out { OutlierSet::HeldOut } else { OutlierSet::Fit },
                residual: in_file_units(|quantity| error.length(quantity)),
                studentized: *studentized,
                weight: robustness.rows.get(*row as usize).map_or(1.0, |judged| judged.weight),
            }
        };
        rows.iter().zip(&errors).map(entry).collect()
    }
}
