//! Configurations in which all targets deviate by similar distances.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use poecal_calibrate::Calibration;
use poecal_model::measurement::{Dataset, Quantity};

/// Largest ratio of two targets' residuals that count as similar.
const ALIKE: f64 = 3.0;
/// Fewest targets that distinguish an error of the arm from one of a target.
const TARGETS: usize = 2;
/// Most configurations in a file.
const LISTED: usize = 100;

/// A configuration in which every measured position is suspected, of two targets or more, with residuals of similar length. There the arm or its
/// readings are wrong, not a target.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SuspectedConfigurationEntry {
    /// File of its first row.
    pub file: String,
    /// Line of its first row, from 1.
    pub row: u32,
    /// Number of its rows.
    pub rows: usize,
    /// Number of their targets.
    pub targets: usize,
    /// Smallest residual of position, millimetres.
    pub least_mm: f64,
    /// Largest residual of position, millimetres.
    pub largest_mm: f64,
}

/// Readings as a key of comparison: rows of one configuration have equal keys.
fn key(data: &Dataset, row: u32) -> Vec<u64> {
    data.readings(row as usize).iter().map(|it| it.to_bits()).collect()
}

impl SuspectedConfigurationEntry {
    /// Entries of a calibration, the worst first, at most 100; the others are suspected row by row.
    pub(crate) fn all_from_calibration(calibration: &Calibration, data: &Dataset) -> Vec<Self> {
        let suspects: Vec<u32> = calibration.robustness.suspects().collect();
        if data.targets.len() < TARGETS || suspects.len() < TARGETS {
            return Vec::new();
        }
        let mut configurations: BTreeMap<Vec<u64>, (Vec<u32>, usize)> = BTreeMap::new();
        for &row in &suspects {
            configurations.entry(key(data, row)).or_default().0.push(row);
        }
        for row in 0..u32::try_from(data.len()).unwrap_or(u32::MAX) {
            if let Some((_, all)) = configurations.get_mut(&key(data, row)) {
                *all += 1;
            }
        }
        let packed = calibration.packed_values(data);
        let session = calibration.session(data, &packed);
        let entry = |(rows, all): &(Vec<u32>, usize)| {
            let observations = || rows.iter().filter_map(|&row| data.observations.get(row as usize));
            let mut targets: Vec<usize> = observations().map(|it| it.target).collect();
            targets.sort_unstable();
            targets.dedup();
            if rows.len() != *all || targets.len() < TARGETS {
                return None;
            }
            let errors = session.errors(rows, &calibration.models.calibrated);
            let lengths: Option<Vec<f64>> = errors.iter().map(|it| it.length(Quantity::Position)).collect();
            let lengths = lengths?;
            let least = lengths.iter().copied().fold(f64::INFINITY, f64::min);
            let largest = lengths.iter().copied().fold(0.0, f64::max);
            let source = observations().next()?.source;
            let file = data.files.get(source.file as usize);
            (largest <= ALIKE * least).then(|| SuspectedConfigurationEntry {
                file: file.map_or_else(String::new, |path| path.display().to_string()),
                row: source.line,
                rows: rows.len(),
                targets: targets.len(),
                least_mm: 1e3 * least,
                largest_mm: 1e3 * largest,
            })
        };
        let mut found: Vec<Self> = configurations.values().filter_map(entry).collect();
        found.sort_by(|one, other| other.largest_mm.total_cmp(&one.largest_mm).then(one.row.cmp(&other.row)));
        found.truncate(LISTED);
        found
    }
}
