//! Files of joint readings and files of measurements, joined row with row (docs/file-formats.md, *Two files*).

use std::collections::BTreeMap;
use std::path::Path;

use super::joined_intervals::{UnmeasuredReadings, no_stands, refuse_backwards, take_stands};
use super::joints::rows_of;
use crate::Join;
use crate::instruments::MEASURED;
use crate::join::join_motion::in_motion;
use crate::join::join_pairs::{JoinedReadings, JointRows, Pairing};
use crate::join::join_plan::{FileRole, JoinPlan, PlannedFile};
use crate::join::missing_intervals::MissingIntervals;
use crate::read::MeasurementReader;
use crate::table::FileTable;
use crate::table::cursor::Cursor;
use crate::table::layout::ColumnLayout;
use crate::table::mapping::ColumnMap;
use crate::table::understanding::FileUnderstanding;
use poecal_fit::start::{
    FEWEST_PAIRS, JointStream, ResampledStream, TimeInterval, UnpairedRows, motion_of_points, motion_of_target,
    stands_of_measured, stands_of_readings,
};
use poecal_model::measurement::Dataset;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::named_unit::UnitSource;
use poecal_numerics::unit::Unit;

impl<'a> MeasurementReader<'a> {
    /// Reads files of which some hold the joint readings of others. A file of readings belongs to the files behind it, up to the next file of
    /// readings. The first one also belongs to files before it.
    pub(crate) fn read_joined(&mut self, plan: &'a JoinPlan<'_>) -> Result<()> {
        let first = plan.files.iter().find(|it| it.part == FileRole::Joints);
        let mut joints = first.map(|it| self.joint_rows(it)).transpose()?;
        let mut of_joints = first;
        let mut unmeasured = UnmeasuredReadings::default();
        for it in &plan.files {
            match (it.part, &joints) {
                (FileRole::Joints, Some(known)) if known.path == it.path => {}
                (FileRole::Joints, _) => {
                    let known = joints.replace(self.joint_rows(it)?);
                    self.warn_of_unmeasured(std::mem::take(&mut unmeasured), known.as_ref());
                    of_joints = Some(it);
                }
                (FileRole::Measured { .. }, Some(known)) => {
                    let read = self.read_measured(it, known, &mut unmeasured);
                    read.map_err(|error| self.or_shifted(error, (of_joints, known), it))?;
                }
                (FileRole::Measured { .. }, None) | (FileRole::Whole, _) => {
                    self.file(it.path, it.blocks(self.opening_context(), MEASURED)?)?;
                }
            }
        }
        self.warn_of_unmeasured(unmeasured, joints.as_ref());
        Ok(())
    }

    /// Warns of joint readings without a measurement in any file.
    fn warn_of_unmeasured(&mut self, found: UnmeasuredReadings, joints: Option<&JointRows>) {
        let (Some(rows), Some(joints)) = (found.rows.filter(|it| !it.is_empty()), joints) else { return };
        let rows: Vec<usize> = rows.into_iter().collect();
        let warning = format!("{}: nothing was measured at {}", joints.path.display(), joints.lines_of(&rows));
        self.found.warnings.insert(found.at.min(self.found.warnings.len()), warning);
    }

    /// Reads a file with joint readings only. Angles without a unit that are no radians are degrees: the nominal robot then agrees with the pairs,
    /// or they are refused.
    pub(crate) fn joint_rows(&mut self, planned: &PlannedFile<'_>) -> Result<JointRows> {
        let found = self.joint_rows_by(planned, self.map);
        let Err(error) = &found else { return found };
        if error.kind() != ErrorKind::Unit || self.map.units.angle.is_some() {
            return found;
        }
        let mut in_degrees = self.map.clone();
        if in_degrees.state_units("deg").is_err() {
            return found;
        }
        let Ok(rows) = self.joint_rows_by(planned, &in_degrees) else { return found };
        self.found.is_in_degrees = true;
        self.found.warnings.push(took_degrees(planned.path, "as radians they are too large"));
        Ok(rows)
    }

    fn joint_rows_by(&mut self, planned: &PlannedFile<'_>, map: &ColumnMap) -> Result<JointRows> {
        let path = planned.path;
        let blocks = planned.blocks(self.opening_context(), "a file of joint readings (CSV)")?;
        let mut table = FileTable::open(path, blocks, map)?;
        let said = table.take_remarks();
        self.header_line = table.header.line;
        let layout = ColumnLayout::joints(&table.header, self.robot, self.options, map)?;
        let layout = self.as_shifted(layout, &table)?;
        let mut cursor = Cursor::new(layout, self.robot, map.decimal);
        let table_rows = rows_of(&mut table, &mut cursor)?;
        let layout = &cursor.layout;
        self.take_said(said);
        self.found.warnings.extend(table_rows.warnings);
        self.warn_of_ignored(path, layout);
        self.take_controller(path, layout)?;
        self.found.sha256.extend(table.sha256().map(|sha256| (path.display().to_string(), sha256)));
        let mut understood = FileUnderstanding::new(&table, &cursor, table_rows.rows);
        understood.others = BTreeMap::from([("joint readings", table_rows.rows)]);
        self.found.understood.push(understood);
        let turning = layout.inputs.iter().filter(|it| it.unit.si_unit() == Unit::Radian);
        let rows = JointRows {
            path: path.to_path_buf(),
            readings: table_rows.readings,
            ids: table_rows.ids.iter().map(|id| id.trim().to_owned()).collect(),
            lines: table_rows.lines,
            is_sheet: table.is_sheet(),
            is_without_unit: turning.clone().count() > 0 && turning.clone().all(|it| it.unit_from == UnitSource::Si),
            turns: layout.inputs.iter().map(|it| it.unit.si_unit() == Unit::Radian).collect(),
            times: table_rows.times,
            spans: None,
            sampled: None,
            stream: None,
            no_stands: MissingIntervals::Listed,
            controller: layout.controller.clone(),
        };
        self.stands(rows)
    }

    /// The static intervals of rows of joint readings that are a stream; else the rows.
    fn stands(&mut self, mut rows: JointRows) -> Result<JointRows> {
        // A stream has no names of rows.
        let is_listed =
            !rows.ids.is_empty() || matches!(self.options.join, Some(Join::Rows | Join::Name | Join::Motion));
        let found =
            if is_listed { Err(None) } else { stands_of_readings(&rows.times, &rows.readings, rows.turns.len()) };
        let found = match found {
            Ok(found) => found,
            Err(why) => {
                let why = MissingIntervals::from_times(why, &rows.times, |row| rows.lines.get(row).copied());
                refuse_backwards(&rows.path, &why)?;
                if self.options.join == Some(Join::Motion) {
                    rows.sampled = ResampledStream::new(&rows.times, &rows.readings, rows.turns.len());
                }
                return Ok(JointRows { no_stands: why, ..rows });
            }
        };
        if found.len() < FEWEST_PAIRS {
            return Err(no_stands(&rows.path, "joint readings", found.len()));
        }
        let lines = found.iter().filter_map(|(it, _)| rows.lines.get(it.rows.start)).copied();
        self.found.notes.push(format!(
            "{}: took the {} stands of the robot in its stream of joint readings",
            rows.path.display(),
            found.len()
        ));
        Ok(JointRows {
            lines: lines.collect(),
            spans: Some(found.iter().map(|(it, _)| it.span_s).collect()),
            stream: JointStream::new(&rows.times, &rows.readings, rows.turns.len()),
            sampled: ResampledStream::new(&rows.times, &rows.readings, rows.turns.len()),
            readings: found.into_iter().flat_map(|(_, means)| means).collect(),
            ids: Vec::new(),
            ..rows
        })
    }

    /// Reads a file with measurements only, with the readings of another.
    fn read_measured(
        &mut self,
        planned: &'a PlannedFile<'_>,
        joints: &JointRows,
        unmeasured: &mut UnmeasuredReadings,
    ) -> Result<()> {
        let path = planned.path;
        let (data, times) = self.without_readings(planned)?;
        if self.options.join == Some(Join::Motion) {
            let found = self.join_in_motion(joints, (path, &data, &times))?;
            return self.read_again(planned, found, unmeasured);
        }
        let is_by_rows = matches!(self.options.join, Some(Join::Rows | Join::Name));
        let found = if is_by_rows || !joints.ids.is_empty() && !data.ids.iter().all(String::is_empty) {
            Err(None)
        } else {
            stands_of_measured(&data, &times)
        };
        let (stands, why) = match found {
            Ok(stands) => (Some(stands), None),
            Err(why) => {
                let line = |row: usize| data.observations.get(row).map(|it| it.source.line as usize);
                (None, Some(MissingIntervals::from_times(why, &times, line)))
            }
        };
        if let Some(why) = &why {
            refuse_backwards(path, why)?;
        }
        let few = |count: usize| count < FEWEST_PAIRS;
        if let Some(stands) = stands.as_ref().filter(|it| few(it.spans.len())) {
            return Err(no_stands(path, "measurements", stands.spans.len()));
        }
        let stream = stands.as_ref().map(|_| (&data, times.as_slice()));
        let motion = stands.as_ref().and_then(|it| motion_of_target(&data, &times, &it.spans));
        let data = stands.as_ref().map_or(&data, |it| &it.data);
        let points: Option<Vec<TimeInterval>> =
            (times.len() == data.len() && times.iter().all(|it| it.is_finite())).then(|| points(data, &times));
        let spans = stands.as_ref().map(|it| &it.spans).or(points.as_ref()).map(Vec::as_slice);
        let paired = |joints: &JointRows| {
            let (lag, no_stands) = (self.options.lag, why.as_ref());
            let lists = Pairing::of_lists(joints, path, data, self.robot);
            Pairing { spans, lag, no_stands, stream, ..lists }.find_readings(self.options.join)
        };
        let mut found = match paired(joints) {
            Err(error) if joints.is_without_unit => {
                let mut found = paired(&joints.in_degrees()).map_err(|_| error)?;
                found.warnings.push(took_degrees(&joints.path, "as radians they fit no measurements"));
                self.found.is_in_degrees = true;
                found
            }
            found => found?,
        };
        if let Some(stands) = stands {
            take_stands(&mut found, stands, path);
        }
        let by_time = found.entry.join == Join::Time;
        found.entry.measured_motion =
            motion.or_else(|| points.as_deref().filter(|_| by_time).and_then(motion_of_points));
        self.read_again(planned, found, unmeasured)
    }

    /// Joins measurements in motion; joint readings that state no unit may be degrees.
    fn join_in_motion(&mut self, joints: &JointRows, seen: (&Path, &Dataset, &[f64])) -> Result<JoinedReadings> {
        let joined = |joints: &JointRows| in_motion(joints, seen, self.robot, self.options.lag);
        match joined(joints) {
            Err(error) if joints.is_without_unit => {
                let mut found = joined(&joints.in_degrees()).map_err(|_| error)?;
                found.warnings.push(took_degrees(&joints.path, "as radians they fit no measurements"));
                self.found.is_in_degrees = true;
                Ok(found)
            }
            found => found,
        }
    }

    /// Reads a file of measurements again, with the readings of each line.
    fn read_again(
        &mut self,
        planned: &'a PlannedFile<'_>,
        found: JoinedReadings,
        unmeasured: &mut UnmeasuredReadings,
    ) -> Result<()> {
        let (path, unread) = (planned.path, &planned.map);
        self.found.join = Some(found.entry.join);
        self.found.joins.push(found.entry);
        self.found.notes.extend(found.notes);
        unmeasured.include(found.unmeasured, self.found.warnings.len());
        self.found.warnings.extend(found.warnings);
        let usual = std::mem::replace(&mut self.map, unread);
        self.readings = Some(found.readings);
        let blocks = planned.blocks(self.opening_context(), MEASURED);
        let read = blocks.and_then(|blocks| self.file(path, blocks));
        (self.map, self.readings) = (usual, None);
        read
    }

    /// The measurements, with meaningless readings, and the time of each row, seconds; NaN if it has none.
    fn without_readings(&self, planned: &'a PlannedFile<'_>) -> Result<(Dataset, Vec<f64>)> {
        let map = &planned.map;
        let mut reader =
            MeasurementReader { map, times: Some(Vec::new()), ..MeasurementReader::new(self.robot, self.options, map) };
        reader.rows_alone(planned.path, planned.blocks(self.opening_context(), MEASURED)?)?;
        Ok((reader.found.data, reader.times.unwrap_or_default()))
    }
}

/// The time of each measured configuration, if the rows are points.
fn points(data: &Dataset, times: &[f64]) -> Vec<TimeInterval> {
    let shots = UnpairedRows::shots_of(data);
    shots.iter().filter_map(|it| times.get(*it.first()? as usize)).map(|it| (*it, *it)).collect()
}

/// The warning of readings without a unit that are degrees.
fn took_degrees(path: &Path, reason: &str) -> String {
    format!(
        "{}: took the joint readings, which state no unit, as degrees: {reason}; --units deg states it",
        path.display()
    )
}
