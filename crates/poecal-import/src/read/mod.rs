//! Reads measurement files.

mod joined_intervals;
pub(crate) mod joining;
pub(crate) mod joints;
mod judging;
pub(crate) mod labels;
pub(crate) mod socket_distance;
mod zeros;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use self::socket_distance::Sockets;
use super::messages::are_messages;
use super::table::FileTable;
use super::{FitWhere, FrameGrouping, MeasurementFile, ReadOptions};
use crate::instruments::OpeningContext;
use crate::join::input_roles::{has_readings_of_pictures, lone_file_error, missing_camera_error};
use crate::join::join_plan::{JoinPlan, ReadingsByLine};
use crate::pictures::corner_columns::{are_corners, are_readings_of_pictures};
use crate::pictures::picture_files::ConfigurationsByImage;
use crate::table::beam_breaks;
use crate::table::configurations::in_its_file;
use crate::table::cursor::Cursor;
use crate::table::layout::ColumnLayout;
use crate::table::mapping::ColumnMap;
use crate::table::naming::RowNames;
use crate::table::text::{FileRemarks, LineBlocks};
use poecal_fit::input_doubts::boards::refuse_wrong_boards;
use poecal_fit::start::{settle_faces, settle_pictures};
use poecal_model::camera::{Board, Camera};
use poecal_model::measurement::Dataset;
use poecal_model::robot::Robot;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::text::{NamedLines, escape_invisible};
use poecal_storage::document;

/// Reads measurement files, joined in their order.
///
/// # Errors
/// A file cannot be read ([`ErrorKind::File`]), is no table ([`ErrorKind::Syntax`]), has a wrong or missing unit ([`ErrorKind::Unit`]), or has
/// wrong columns or cells ([`ErrorKind::Measurement`]); a [`ReadOptions::train_where`] fits no file ([`ErrorKind::Option`]).
pub fn read(paths: &[impl AsRef<Path>], robot: &Robot, options: &ReadOptions) -> Result<MeasurementFile> {
    let paths: Vec<&Path> = paths.iter().map(AsRef::as_ref).collect();
    document::reading(|| read_all(&paths, robot, options))
}

/// Compiled once, and not for each kind of path.
fn read_all(paths: &[&Path], robot: &Robot, options: &ReadOptions) -> Result<MeasurementFile> {
    if paths.is_empty() {
        return ErrorKind::Option.refuse("found no measurement file, expected at least one");
    }
    let no_map = ColumnMap::default();
    if let Some(mut plan) = JoinPlan::from_paths(paths, robot, options, options.mapping.as_ref().unwrap_or(&no_map))? {
        plan.settle_sets(robot, options, &no_map)?;
        let mut reader = MeasurementReader::new(robot, options, &no_map);
        reader.read_joined(&plan)?;
        return reader.finish();
    }
    let mut reader = MeasurementReader::new(robot, options, &no_map);
    // Readings by picture precede the corners of the pictures, in whatever order the files are named.
    let mut order = paths.to_vec();
    if !options.cameras.is_empty() {
        order.sort_by_cached_key(|path| !has_readings_of_pictures(path, robot, reader.map));
    }
    for path in order {
        let opening = reader.opening_context();
        let blocks = reader.blocks_of_set(path)?;
        let first = reader.found.data.len();
        let read = reader.file(path, blocks);
        let is_own = reader.found.understood.last().is_none_or(|it| it.form.is_none());
        let is_doubtful = is_own && read.as_ref().err().is_none_or(|it| it.kind() == ErrorKind::Measurement);
        if is_doubtful && let Some(error) = reader.shifted_whole(path, read.is_ok().then_some(first)) {
            return Err(error);
        }
        read.map_err(|error| in_its_file(error, path))
            .map_err(|error| lone_file_error(error, path, &opening, reader.map))
            .map_err(|error| {
                missing_camera_error(error, path, paths, (robot, reader.map, options.cameras.is_empty()))
            })?;
    }
    reader.finish()
}

/// Reads the text of a measurement file as [`read()`] reads the file; `path` is its name in messages.
///
/// # Errors
/// Those of [`read()`].
pub fn parse(text: &str, path: impl AsRef<Path>, robot: &Robot, options: &ReadOptions) -> Result<MeasurementFile> {
    let path = path.as_ref();
    document::reading_text(path, text, || read_all(&[path], robot, options))
}

pub(crate) struct MeasurementReader<'a> {
    pub(crate) robot: &'a Robot,
    pub(crate) options: &'a ReadOptions,
    pub(crate) map: &'a ColumnMap,
    pub(crate) targets: RowNames,
    pub(crate) stations: RowNames,
    /// Kind of each named position, with its first occurrence.
    pub(crate) places: BTreeMap<String, (&'static str, PathBuf, usize)>,
    /// Pairs of rows: the first one's configuration until the second is read, and its line.
    pub(crate) begun: BTreeMap<String, (Option<u32>, usize)>,
    /// Readings of joints by picture.
    pub(crate) taken: ConfigurationsByImage,
    /// Name of these readings in messages.
    pub(crate) taken_as: &'static str,
    /// The joint readings of each line, if another file has them.
    pub(crate) readings: Option<ReadingsByLine>,
    /// The time of each row so far, seconds, if it is asked for.
    pub(crate) times: Option<Vec<f64>>,
    pub(crate) cameras: Vec<Camera>,
    /// The boards; a board with several poses occurs under each of its names.
    pub(crate) boards: Vec<Board>,
    /// The sockets of each `place`.
    pub(crate) sockets: Sockets,
    /// True for each of the values that mark a training row, if it was seen.
    pub(crate) fit_values_seen: Vec<bool>,
    /// Number of columns by which values are assumed to be to the right of their names, and the line of names that was read last.
    pub(crate) shift: isize,
    pub(crate) header_line: usize,
    pub(crate) found: MeasurementFile,
}

impl<'a> MeasurementReader<'a> {
    pub(crate) fn new(robot: &'a Robot, options: &'a ReadOptions, no_map: &'a ColumnMap) -> Self {
        MeasurementReader {
            robot,
            options,
            map: options.mapping.as_ref().unwrap_or(no_map),
            targets: RowNames::default(),
            stations: RowNames::default(),
            places: BTreeMap::new(),
            begun: BTreeMap::new(),
            taken: ConfigurationsByImage::new(),
            taken_as: "joint readings",
            readings: None,
            times: None,
            cameras: options.cameras.clone(),
            boards: options.boards.clone(),
            sockets: Sockets::new(),
            fit_values_seen: Vec::new(),
            shift: 0,
            header_line: 0,
            found: MeasurementFile {
                data: Dataset::new(robot.reading_names()).with_factors(robot.factors.len()),
                warnings: options.said.clone(),
                ..MeasurementFile::default()
            },
        }
    }

    /// Settings with which files are opened.
    pub(crate) fn opening_context(&self) -> OpeningContext<'a> {
        OpeningContext { robot: self.robot, options: self.options }
    }

    /// Takes the notes and warnings from the opening of a file.
    pub(crate) fn take_said(&mut self, said: FileRemarks) {
        self.found.notes.extend(said.notes);
        self.found.warnings.extend(said.warnings);
    }

    /// Adds findings in a file to the warnings.
    pub(crate) fn warn(&mut self, path: &Path, words: impl IntoIterator<Item = String>) {
        let own = words.into_iter().map(|words| format!("{}: {words}", path.display()));
        self.found.warnings.extend(own);
    }

    pub(crate) fn file<'p>(&mut self, path: &'p Path, mut blocks: LineBlocks<'p>) -> Result<()> {
        blocks.begin()?;
        if are_messages(path, blocks.text())? {
            return self.messages(path, blocks);
        }
        let mut table = FileTable::open(path, blocks, self.map)?;
        self.take_said(table.take_remarks());
        let joints = self.found.data.reading_names();
        if are_corners(&table.header, joints, self.map)? {
            return self.corners(path, table);
        }
        if !self.cameras.is_empty() && are_readings_of_pictures(&table.header, joints, self.map) {
            return self.readings_of_pictures(path, table);
        }
        let mut layout = ColumnLayout::new(&table.header, self.robot, self.options, self.map)?;
        if let Some(by_line) = &self.readings {
            layout.controller.clone_from(&by_line.controller);
        }
        if let Some(column) = layout.instrument.filter(|_| self.options.frames == FrameGrouping::PerFile) {
            let message = "found a column of instruments and --device-frames per-file, expected one of the two: leave the option \
                           out, or the column";
            return Err(table.header.error(ErrorKind::Measurement, column, message));
        }
        let mut cursor = Cursor::new(layout, self.robot, self.map.decimal);
        let first = self.found.data.len();
        self.found.data.files.push(path.to_path_buf());
        if cursor.layout.id.is_some() {
            self.found.data.ids.resize(first, String::new());
        }
        let (rows, lost) = self.rows(&mut table, &mut cursor)?;
        self.take_means(first);
        self.take_motion(path, first)?;
        self.refuse_single_rows(path)?;
        self.found.sha256.extend(table.sha256().map(|sha256| (path.display().to_string(), sha256)));
        if self.found.data.len() == first {
            let message = "found no position in any row, expected at least one that is neither empty nor zero";
            return Err(ErrorKind::Measurement.error(message).at_line(path, table.header.line));
        }
        let skipped = beam_breaks::lost_words(&lost);
        self.warn(path, skipped.map(|it| format!("skipped {it}; --strict refuses them")));
        let new_rows = self.found.data.observations.get(first..).unwrap_or_default();
        self.found.warnings.extend(beam_breaks::incomplete_warning(path, new_rows));
        self.judge(&table, &cursor, first)?;
        self.understand(&table, &cursor, (first, rows, lost))
    }

    /// Takes the rows of a file without judging them.
    pub(crate) fn rows_alone<'p>(&mut self, path: &'p Path, blocks: LineBlocks<'p>) -> Result<()> {
        let mut table = FileTable::open(path, blocks, self.map)?;
        self.header_line = table.header.line;
        let layout = ColumnLayout::new(&table.header, self.robot, self.options, self.map)?;
        let layout = self.as_shifted(layout, &table)?;
        let mut cursor = Cursor::new(layout, self.robot, self.map.decimal);
        self.found.data.files.push(path.to_path_buf());
        self.rows(&mut table, &mut cursor)?;
        self.found.data.ids.resize(self.found.data.len(), String::new());
        // A wrong unit would be taken for a wrong order.
        self.refuse_far_positions(&table, &cursor, 0.0, 0)
    }

    /// Takes all rows of a file, and counts them including beam breaks.
    fn rows(&mut self, table: &mut FileTable<'_>, cursor: &mut Cursor<'_>) -> Result<(usize, NamedLines)> {
        let mut lost = NamedLines::default();
        let rows = table.some_rows("at least one measurement", |row| {
            cursor.read(row)?;
            if let Some(by_line) = &self.readings {
                // A line without readings has no partner.
                let Some(readings) = by_line.lines.get(&row.line) else { return Ok(()) };
                cursor.put_readings(readings);
            }
            cursor.take_readings(row)?;
            if self.begins_pair(row, cursor)? || beam_breaks::take_out(&mut lost, row, cursor, self.options.strict)? {
                return Ok(());
            }
            cursor.observe(row);
            self.row(row, cursor)?;
            if let Some(times) = &mut self.times {
                times.resize(self.found.data.len(), cursor.time_s(row));
            }
            Ok(())
        })?;
        Ok((rows, lost))
    }

    fn finish(self) -> Result<MeasurementFile> {
        self.refuse_unused()?;
        let rule = self.options.train_where.as_ref().or(self.map.set.as_ref());
        if let Some(FitWhere { column, values }) = rule
            && !self.options.ignore_sets
            && let Some((value, _)) = values.iter().zip(&self.fit_values_seen).find(|(_, seen)| !**seen)
        {
            let message = format!("found no row with `{value}` in column `{column}`, expected at least one to fit");
            let error = ErrorKind::Option.error(message);
            return Err(match self.found.data.files.as_slice() {
                [only] => error.in_file(only),
                _ => error,
            });
        }
        if let Some(taken) = self.taken.values().next().filter(|_| self.found.data.is_empty()) {
            let message = format!(
                "found the joint readings of {} pictures and no corners, expected a second file with these: image, target, u[px], v[px], as \
                 `poecal detect` writes it",
                self.taken.len()
            );
            return Err(ErrorKind::Measurement.error(message).in_file(&taken.place.0));
        }
        let mut found = self.found;
        if let Some(distances) = &self.options.socket_distances {
            found.data.lengths = distances.lengths(&self.sockets)?;
        }
        for noise in &self.options.instrument_noise {
            noise.state(&mut found.data)?;
        }
        settle_faces(&mut found.data, self.robot);
        found.data.settle_pixels();
        refuse_wrong_boards(&found.data)?;
        if let Some(motors) = self.map.motors.as_ref().filter(|_| self.options.controller.is_none()) {
            zeros::settle_zeros(&mut found, self.robot, motors)?;
        }
        let settled = settle_pictures(&mut found.data, self.robot);
        found.notes.extend(settled.notes);
        found.warnings.extend(settled.warnings);
        let said = found.notes.iter_mut().chain(&mut found.warnings);
        said.for_each(|words| *words = escape_invisible(words).into_owned());
        Ok(found)
    }
}
