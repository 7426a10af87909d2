//! Headers whose names are shifted by one column from their values: found by the robot, which then fits the values of neighbouring columns.

use std::path::Path;

use super::join_pairs::{JointRows, Pairing};
use super::join_plan::PlannedFile;
use crate::Join;
use crate::instruments::{MEASURED, OpenedFile};
use crate::read::MeasurementReader;
use crate::table::FileTable;
use crate::table::cells::{Separator, split};
use crate::table::configurations::is_folder;
use crate::table::header::Header;
use crate::table::header_cells::is_number;
use crate::table::inputs::InputSource;
use crate::table::layout::ColumnLayout;
use poecal_fit::start::{Agreement, RowPair, UnpairedRows};
use poecal_model::measurement::Dataset;
use poecal_numerics::error::{Error, ErrorKind};

/// Largest number of rows by which a header is judged.
const SOME: usize = 600;
/// Columns by which values may be shifted from their names.
const SHIFTS: [isize; 2] = [1, -1];

impl ColumnLayout {
    /// The layout with every number taken from `by` columns further to the right, if a measured number is there, not a count.
    pub(crate) fn shift_columns(mut self, by: isize, header: &Header<'_>, separator: Separator) -> Option<Self> {
        let row = header.first_row()?;
        let mut cells = Vec::new();
        split(&row, separator, &mut cells).ok()?;
        let is_measured = |at: usize| {
            let cell = cells.get(at)?.raw;
            (is_number(cell) && cell.contains(['.', ','])).then_some(())
        };
        for input in &mut self.inputs {
            if !input.sum.is_empty() {
                return None;
            }
            if let InputSource::Column(column) = input.source {
                let column = column.checked_add_signed(by).filter(|it| *it < header.cells.len())?;
                is_measured(column)?;
                input.source = InputSource::Column(column);
            }
        }
        Some(self)
    }
}

/// Largest number of rows of lists whose order is compared with shifted headers.
const MOST_ROWS: usize = 2000;

impl MeasurementReader<'_> {
    /// The layout of the shifted values, if the header is judged to be shifted.
    pub(crate) fn as_shifted(
        &self,
        layout: ColumnLayout,
        table: &FileTable<'_>,
    ) -> poecal_numerics::error::Result<ColumnLayout> {
        if self.shift == 0 {
            return Ok(layout);
        }
        layout
            .shift_columns(self.shift, &table.header, table.separator)
            .ok_or_else(|| ErrorKind::Measurement.error("found no columns beside").in_file(table.header.path))
    }

    /// Error of the nominal robot at rows with their own readings, metres, if it evidently fits them.
    pub(crate) fn fit_m(&self, data: &Dataset) -> Option<f64> {
        let rows: Vec<u32> = data.all_rows().into_iter().step_by(data.len().div_ceil(SOME).max(1)).collect();
        let data = &data.select_rows(&rows);
        let readings: Vec<f64> = (0..data.len()).flat_map(|row| data.readings(row).to_vec()).collect();
        let rows = UnpairedRows::new(self.robot, &readings, data);
        // Targets that are seen in one configuration have separate rows.
        let pairs: Vec<RowPair> =
            (rows.shots().iter().enumerate()).filter_map(|(shot, of)| Some((*of.first()? as usize, shot))).collect();
        match rows.agreement(&pairs) {
            Some(Agreement::Right { missed_m }) => Some(missed_m),
            _ => None,
        }
    }

    /// The error of a file with joint readings and measurements whose header is shifted; `None` if it is not. `first` is the first of its rows, if
    /// they were read.
    pub(crate) fn shifted_whole(&self, path: &Path, first: Option<usize>) -> Option<Error> {
        if is_folder(path) {
            return None;
        }
        let blocks = || match self.opening_context().open_file(path, MEASURED) {
            Ok(OpenedFile::Own(blocks)) => Some(*blocks),
            Ok(OpenedFile::Made(_)) | Err(_) => None,
        };
        let is_right = || {
            let rows = u32::try_from(first?).ok()?..u32::try_from(self.found.data.len()).ok()?;
            self.fit_m(&self.found.data.select_rows(&rows.collect::<Vec<u32>>()))
        };
        let fit = |shift: isize| {
            let map = self.map;
            let mut reader = MeasurementReader { map, shift, ..MeasurementReader::new(self.robot, self.options, map) };
            reader.rows_alone(path, blocks()?).ok()?;
            self.fit_m(&reader.found.data)
        };
        let possible = |shift: &isize| {
            let table = FileTable::open(path, blocks()?, self.map).ok()?;
            let layout = ColumnLayout::new(&table.header, self.robot, self.options, self.map).ok()?;
            layout.shift_columns(*shift, &table.header, table.separator).map(|_| table.header.line)
        };
        for shift in SHIFTS {
            if let Some(line) = possible(&shift)
                && is_right().is_none()
                && let Some(missed_m) = fit(shift)
            {
                return Some(shifted_header_error(path, line, shift, missed_m));
            }
        }
        None
    }

    /// The error of two files that do not fit, if the header of one is shifted.
    pub(crate) fn or_shifted(
        &self,
        error: Error,
        (of_joints, joints): (Option<&PlannedFile<'_>>, &JointRows),
        planned: &PlannedFile<'_>,
    ) -> Error {
        let is_placed = error.place().is_some_and(|it| it.line.is_some());
        // Rows of recordings are not joined by their order.
        let is_stream = matches!(self.options.join, Some(Join::Time | Join::Motion)) || joints.lines.len() > MOST_ROWS;
        if error.kind() != ErrorKind::Measurement || is_placed || is_stream {
            return error;
        }
        let fit = |joints: &JointRows, data: &Dataset| {
            if data.len() > MOST_ROWS {
                return None;
            }
            let pairing = Pairing::of_lists(joints, planned.path, data, self.robot);
            pairing.find_readings(None).ok()?.entry.missed_mm.map(|it| 1e-3 * it)
        };
        let fit = |joints: &JointRows, data: &Dataset| {
            fit(joints, data).or_else(|| fit(&joints.in_degrees(), data).filter(|_| joints.is_without_unit))
        };
        for shift in SHIFTS {
            let map = &planned.map;
            let mut reader = MeasurementReader { map, shift, ..MeasurementReader::new(self.robot, self.options, map) };
            let read = planned.blocks(self.opening_context(), MEASURED);
            if let Ok(()) = read.and_then(|blocks| reader.rows_alone(planned.path, blocks))
                && let Some(missed_m) = fit(joints, &reader.found.data)
            {
                return shifted_header_error(planned.path, reader.header_line, shift, missed_m);
            }
            let Some(of_joints) = of_joints else { continue };
            let mut reader = MeasurementReader { shift, ..MeasurementReader::new(self.robot, self.options, self.map) };
            let Ok(others) = reader.joint_rows(of_joints) else { continue };
            let line = reader.header_line;
            let mut reader = MeasurementReader { map, ..MeasurementReader::new(self.robot, self.options, map) };
            let read = planned.blocks(self.opening_context(), MEASURED);
            if let Ok(()) = read.and_then(|blocks| reader.rows_alone(planned.path, blocks))
                && let Some(missed_m) = fit(&others, &reader.found.data)
            {
                return shifted_header_error(of_joints.path, line, shift, missed_m);
            }
        }
        error
    }
}

/// The error of a shifted header.
fn shifted_header_error(path: &Path, line: usize, shift: isize, missed_m: f64) -> Error {
    let (side, count) = if shift > 0 { ("right", "few") } else { ("left", "many") };
    ErrorKind::Measurement
        .error(format!(
            "found the values of each name one column further to the {side}, where the nominal robot misses them by {:.3} mm (median), and not below \
             it, where it fits none, expected values below their names: the header has one name too {count} at its beginning",
            1e3 * missed_m
        ))
        .at_line(path, line)
}
