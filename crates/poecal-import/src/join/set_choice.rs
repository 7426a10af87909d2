//! Choice between two sets of coordinates in a row, by the nominal robot. Its errors are small at the measured set and nil at a set that it
//! computed.
//! computed.

use std::path::Path;

use super::join_pairs::{JointRows, Pairing};
use super::join_plan::{FileRole, JoinPlan, PlannedFile};
use crate::ReadOptions;
use crate::instruments::{CoordinateName, MEASURED, MadeTable, OpenedFile};
use crate::read::MeasurementReader;
use crate::table::mapping::ColumnMap;
use crate::table::text::LineBlocks;
use poecal_model::robot::Robot;
use poecal_numerics::error::{ErrorKind, Result};

/// Largest error of the nominal robot at coordinates that it computed, metres: the last digits of a report.
const COMPUTED_M: f64 = 5e-5;
/// Ratio by which the error at the other set must then be larger.
const MORE: f64 = 5.0;

impl JoinPlan<'_> {
    /// Chooses the measured set of each file with two sets.
    pub(crate) fn settle_sets(&mut self, robot: &Robot, options: &ReadOptions, map: &ColumnMap) -> Result<()> {
        let mut of_joints = self.files.iter().position(|it| it.part == FileRole::Joints);
        for at in 0..self.files.len() {
            let Some(planned) = self.files.get(at) else { continue };
            if planned.part == FileRole::Joints {
                of_joints = Some(at);
            }
            let Some(sets) = planned.sets() else { continue };
            let mut reader = MeasurementReader::new(robot, options, map);
            let table = match (planned.part, of_joints.and_then(|at| self.files.get(at))) {
                (FileRole::Measured { .. }, Some(joints)) => {
                    let joints = reader.joint_rows(joints)?;
                    reader.measured_set(planned, sets, &joints)?
                }
                _ => reader.measured_set_of_whole(planned.path, sets)?,
            };
            if let Some(planned) = self.files.get_mut(at) {
                planned.with_table(table);
            }
        }
        Ok(())
    }
}

impl MeasurementReader<'_> {
    /// A file's blocks; if it has two sets of coordinates, those of the set that was measured.
    pub(crate) fn blocks_of_set<'p>(&self, path: &'p Path) -> Result<LineBlocks<'p>> {
        let mut opened = self.opening_context().open_file(path, MEASURED)?;
        if let OpenedFile::Made(table) = &opened
            && let Some(sets) = table.sets()
        {
            opened = OpenedFile::Made(Box::new(self.measured_set_of_whole(path, sets)?));
        }
        Ok(opened.blocks(path, MEASURED))
    }

    /// The set that was measured, in a file whose joint readings are in another.
    fn measured_set(&self, planned: &PlannedFile<'_>, sets: [MadeTable; 2], joints: &JointRows) -> Result<MadeTable> {
        let path = planned.path;
        let missed = |table: &MadeTable, joints: &JointRows| -> Result<Option<f64>> {
            let map = &planned.map;
            let mut reader = MeasurementReader { map, ..MeasurementReader::new(self.robot, self.options, map) };
            reader.rows_alone(path, table.blocks(path, MEASURED))?;
            let data = &reader.found.data;
            let pairing = Pairing::of_lists(joints, path, data, self.robot);
            Ok(pairing.find_readings(self.options.join).ok().and_then(|it| it.entry.missed_mm).map(|it| 1e-3 * it))
        };
        let mut errors = [missed(&sets[0], joints)?, missed(&sets[1], joints)?];
        if joints.is_without_unit && errors == [None, None] {
            let joints = joints.in_degrees();
            errors = [missed(&sets[0], &joints)?, missed(&sets[1], &joints)?];
        }
        choose_set(path, sets, errors)
    }

    /// The measured set of a file that has its joint readings.
    fn measured_set_of_whole(&self, path: &Path, sets: [MadeTable; 2]) -> Result<MadeTable> {
        let missed = |table: &MadeTable| -> Result<Option<f64>> {
            let mut reader =
                MeasurementReader { map: self.map, ..MeasurementReader::new(self.robot, self.options, self.map) };
            reader.rows_alone(path, table.blocks(path, MEASURED))?;
            Ok(self.fit_m(&reader.found.data))
        };
        let errors = [missed(&sets[0])?, missed(&sets[1])?];
        choose_set(path, sets, errors)
    }
}

/// The set that was measured, by the errors of the nominal robot, metres; `None` if it does not fit a set.
fn choose_set(path: &Path, sets: [MadeTable; 2], errors: [Option<f64>; 2]) -> Result<MadeTable> {
    let is_named = sets[1].called == Some(CoordinateName::Measured);
    let names = if is_named { ["nominal", "measured"] } else { ["first", "second"] };
    let words = |at: usize| match errors[at] {
        Some(missed) => format!("the {} by {:.3} mm (median)", names[at], 1e3 * missed),
        None => format!("the {} by no less than by chance", names[at]),
    };
    let is_computed = |at: usize| match (errors[at], errors[1 - at]) {
        (Some(own), Some(other)) => own < COMPUTED_M && MORE * own < other,
        _ => false,
    };
    let at = match errors {
        [_, Some(_)] if is_named => Some(1),
        [Some(_), Some(_)] if is_computed(0) => Some(1),
        [Some(_), Some(_)] if is_computed(1) => Some(0),
        [Some(_), None] if !is_named => Some(0),
        [None, Some(_)] => Some(1),
        _ => None,
    };
    let Some(at) = at else {
        return Err(ErrorKind::Measurement
            .error(format!(
                "found two sets of coordinates in a row, of which the nominal robot misses {} and {}, expected one that was measured: name its columns \
                 in a mapping (--columns)",
                words(0),
                words(1)
            ))
            .in_file(path));
    };
    let [first, second] = sets;
    let (mut table, why) = (if at == 0 { first } else { second }, format!("{}, {}", words(0), words(1)));
    table.said.insert(0, format!("took the {} of two sets of coordinates; the nominal robot misses {why}", names[at]));
    Ok(table)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_computed_is_not_what_was_measured() {
        let sets = || [MadeTable::default(), MadeTable::default()];
        let taken = |errors| choose_set(Path::new("report.csv"), sets(), errors).map(|it| it.said.join("; "));
        let (fits, computed) = (Some(2e-3), Some(1e-6));
        assert!(taken([fits, computed]).unwrap().contains("took the first"));
        assert!(taken([computed, fits]).unwrap().contains("took the second"));
        assert!(taken([None, fits]).unwrap().contains("took the second"));
        assert!(taken([fits, None]).unwrap().contains("took the first"));
        for errors in [[None, None], [fits, Some(2.1e-3)]] {
            let error = taken(errors).unwrap_err().to_string();
            assert!(error.contains("found two sets of coordinates in a row"), "{error}");
        }
    }
}
