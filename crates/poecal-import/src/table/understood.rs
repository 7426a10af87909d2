//! Interpretation of a file, collected while it is read.

use std::collections::BTreeMap;
use std::path::Path;

use super::columns::turns;
use super::cursor::Cursor;
use super::layout::ColumnLayout;
use super::understanding::FileUnderstanding;
use crate::read::MeasurementReader;
use crate::table::FileTable;
use poecal_model::robot::Controller;
use poecal_numerics::error::{ErrorKind, Result, shorten_name};
use poecal_numerics::text::NamedLines;

/// Name of rows with some components of a position.
const COMPONENTS: &str = "single components";

/// Largest number of ignored columns in a warning.
const IGNORED_NAMED: usize = 30;

impl MeasurementReader<'_> {
    /// Records the interpretation of a file.
    pub(crate) fn understand(
        &mut self,
        table: &FileTable<'_>,
        inputs: &Cursor<'_>,
        (first, rows, lost): (usize, usize, NamedLines),
    ) -> Result<()> {
        let (path, layout) = (table.header.path, &inputs.layout);
        let (mut points, mut poses, mut others) = (0, 0, BTreeMap::new());
        for row in self.found.data.observations.get(first..).unwrap_or_default() {
            let seen = &row.measurement;
            if seen.is_place() {
                *(if seen.sees_orientation() { &mut poses } else { &mut points }) += 1;
            } else {
                let is_part = seen.is_part_of_position();
                let name = if is_part { COMPONENTS } else { seen.function().leading_quantity().name() };
                *others.entry(name).or_default() += 1;
            }
        }
        if !self.found.data.ids.is_empty() {
            self.found.data.ids.resize(self.found.data.len(), String::new());
        }
        self.warn_of_ignored(path, layout);
        self.warn(path, layout.joint_words());
        self.take_controller(path, layout)?;
        self.warn(path, turns::warning(&table.header, layout, self.map));
        self.found.notes.extend(turns::note(layout).map(|note| format!("{}: {note}", path.display())));
        let mut own = FileUnderstanding { points, poses, others, lost, ..FileUnderstanding::new(table, inputs, rows) };
        // Joints whose readings are in another file are no columns of this one.
        own.columns.drain(..if self.readings.is_some() { self.found.data.reading_names().len() } else { 0 });
        self.found.understood.push(own);
        Ok(())
    }

    /// Takes the conversion of columns into readings, which must be the same in all files.
    pub(crate) fn take_controller(&mut self, path: &Path, layout: &ColumnLayout) -> Result<()> {
        let words = |it: &Option<Controller>| it.as_ref().map(|it| (it.third_axis, it.words()));
        let is_first = self.found.understood.is_empty();
        if !is_first && words(&self.found.data.controller) != words(&layout.controller) {
            let shown = |it: &Option<Controller>| it.as_ref().map_or("one by one".to_owned(), Controller::words);
            return Err(ErrorKind::Measurement
                .error(format!(
                    "found joint readings of columns {} after a file with {}, expected the same in all files",
                    shown(&layout.controller),
                    shown(&self.found.data.controller)
                ))
                .in_file(path));
        }
        self.found.data.controller.clone_from(&layout.controller);
        Ok(())
    }

    pub(crate) fn warn_of_ignored(&mut self, path: &Path, layout: &ColumnLayout) {
        if layout.ignored.is_empty() {
            return;
        }
        let columns = layout.ignored.iter().take(IGNORED_NAMED).map(|(name, meant)| match meant {
            Some(meant) => format!("`{}` (did you mean `{meant}`?)", shorten_name(name)),
            None => format!("`{}`", shorten_name(name)),
        });
        let columns: Vec<String> = columns.collect();
        let more = match layout.ignored.len() - columns.len() {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        let columns = columns.join(", ");
        self.warn(path, [format!("ignored the columns {columns}{more}")]);
        self.warn_of_joints_beyond(path, layout);
    }

    /// Warns that a file has readings of joints beyond the tip link.
    fn warn_of_joints_beyond(&mut self, path: &Path, layout: &ColumnLayout) {
        let of_column = |name: &str| {
            let plain = name.split('[').next().unwrap_or(name).trim();
            self.options.beyond_tip.iter().find(|(joint, _)| joint == plain)
        };
        let mut found = layout.ignored.iter().filter_map(|(name, _)| of_column(name));
        let Some((joint, end)) = found.next() else { return };
        let more = if found.next().is_some() { " and others" } else { "" };
        self.found.warnings.push(format!(
            "{}: has readings of `{joint}`{more}, beyond the tip link: if what was measured moves with it, state the link that carries it, like `--tip-link {end}`",
            path.display()
        ));
    }
}
