//! Files of joint readings and files of measurements, joined row with row (docs/file-formats.md, *Two files*).

use std::collections::BTreeMap;
use std::path::Path;

use super::LostBeams;
use super::inputs::InputReader;
use super::join_pairs::{JointRows, Pairing};
use super::join_plan::{Part, Plan, Planned};
use super::joints::rows_of;
use super::layout::ColumnLayout;
use super::mapping::ColumnMap;
use super::number::Numbers;
use super::read::Reader;
use super::table::Table;
use super::text::Blocks;
use super::understanding::{self, FileUnderstanding};
use crate::error::Result;
use crate::measurement::Dataset;
use crate::start::Unpaired;

impl<'a> Reader<'a> {
    /// Reads files of which some have the joint readings of others: each those of the files behind it, up to the next file of readings; the first
    /// ones also those of files before them.
    pub(super) fn joined(&mut self, plan: &'a Plan<'_>) -> Result<()> {
        let first = plan.files.iter().find(|it| it.part == Part::Joints).map(|it| it.path);
        let mut joints = first.map(|path| self.joint_rows(path)).transpose()?;
        for Planned { path, part, map } in &plan.files {
            match (part, &joints) {
                (Part::Joints, Some(known)) if known.path == *path => {}
                (Part::Joints, _) => joints = Some(self.joint_rows(path)?),
                (Part::Measured { .. }, Some(known)) => self.measured(path, known, map)?,
                (Part::Measured { .. }, None) | (Part::Whole, _) => {
                    self.file(path, Blocks::open(path, "a measurement file (CSV)")?)?;
                }
            }
        }
        Ok(())
    }

    /// Reads a file of joint readings alone.
    fn joint_rows(&mut self, path: &Path) -> Result<JointRows> {
        let mut table = Table::open(path, Blocks::open(path, "a file of joint readings (CSV)")?, self.map)?;
        let layout = ColumnLayout::joints(&table.header, self.robot, self.options, self.map)?;
        let numbers = Numbers::new(self.map.decimal);
        let mut inputs = InputReader::new(&layout.inputs, layout.inputs.len(), numbers);
        let table_rows = rows_of(&mut table, &layout, &mut inputs, self.robot)?;
        self.found.warnings.extend(table_rows.warnings);
        self.warn_of_ignored(path, &layout);
        self.take_controller(path, &layout)?;
        self.found.sha256.extend(table.sha256().map(|sha256| (path.display().to_string(), sha256)));
        self.found.understood.push(FileUnderstanding {
            path: path.to_path_buf(),
            rows: table_rows.rows,
            points: 0,
            poses: 0,
            others: BTreeMap::from([("joint readings", table_rows.rows)]),
            lost: LostBeams::default(),
            separator: table.separator,
            separator_line: table.separator_line,
            units_line: table.header.units_line,
            decimal_sign: inputs.numbers.sign(),
            columns: understanding::columns(&table.header, &layout, &inputs.ranges),
            orientation: None,
            pose: understanding::pose_word(layout.pose),
            ignored: layout.ignored.iter().map(|(name, _)| name.clone()).collect(),
        });
        Ok(JointRows {
            path: path.to_path_buf(),
            readings: table_rows.readings,
            ids: table_rows.ids.iter().map(|id| id.trim().to_owned()).collect(),
            lines: table_rows.lines,
            controller: layout.controller,
        })
    }

    /// Reads a file of measurements alone, with the readings of another.
    fn measured(&mut self, path: &Path, joints: &JointRows, unread: &'a ColumnMap) -> Result<()> {
        let data = self.without_readings(path, unread)?;
        let rows = Unpaired::new(self.robot, &joints.readings, &data);
        let found =
            Pairing { joints, path, data: &data, rows, robot: self.robot }.found(self.options.join)?;
        self.found.notes.extend(found.notes);
        self.found.warnings.extend(found.warnings);
        // The same again, with the readings of each line.
        let usual = std::mem::replace(&mut self.map, unread);
        self.readings = Some(found.readings);
        let read = Blocks::open(path, "a measurement file (CSV)").and_then(|blocks| self.file(path, blocks));
        (self.map, self.readings) = (usual, None);
        read
    }

    /// What was measured, with readings that mean nothing.
    fn without_readings(&self, path: &Path, map: &'a ColumnMap) -> Result<Dataset> {
        let mut reader = Reader { map, ..Reader::new(self.robot, self.options, map) };
        reader.rows_alone(path)?;
        Ok(reader.found.data)
    }
}
