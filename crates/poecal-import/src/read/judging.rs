//! Judges the data that were read: units, spread, and missing components.

use super::MeasurementReader;
use crate::table::FileTable;
use crate::table::cursor::Cursor;
use poecal_fit::input_doubts::{lengths, spread};
use poecal_numerics::error::Result;

impl MeasurementReader<'_> {
    /// Judges the scale of the readings and of the measurements.
    pub(super) fn judge(&mut self, table: &FileTable<'_>, cursor: &Cursor<'_>, first: usize) -> Result<()> {
        let header = &table.header;
        self.found.warnings.extend(cursor.joint_warnings(header)?);
        cursor.check_orientations(header)?;
        let slides_m = cursor.unlimited_slides_m();
        self.refuse_far_positions(table, cursor, slides_m, first)?;
        let data = &self.found.data;
        let new_rows = data.observations.get(first..).unwrap_or_default();
        cursor.refuse(header, lengths::of_ranges(self.robot, slides_m, new_rows))?;
        let x = cursor.layout.targets.first().and_then(|target| Some(target.position?[0]));
        let columns = cursor.columns();
        cursor.refuse(header, x.and_then(|x| spread::of_positions(self.robot, &columns, x, data, first)))
    }

    /// Refuses positions of the rows from `first` on that only another unit explains.
    pub(super) fn refuse_far_positions(
        &self,
        table: &FileTable<'_>,
        cursor: &Cursor<'_>,
        slides_m: f64,
        first: usize,
    ) -> Result<()> {
        let columns = cursor.columns();
        let position = cursor.layout.targets.first().and_then(|target| target.position);
        let of = |at: usize| columns.get(at).copied();
        let Some([Some(x), Some(y), Some(z)]) = position.map(|at| at.map(of)) else { return Ok(()) };
        let rows = self.found.data.observations.get(first..).unwrap_or_default();
        cursor.refuse(&table.header, lengths::of_positions(self.robot, [x, y, z], slides_m, rows))
    }
}
