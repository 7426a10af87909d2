//! Plan of the files that are read together: files with joint readings only, and files with measurements only.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::missing_forms::{BODIES, unused_option_error};
use crate::instruments::{MEASURED, MadeTable, OpenedFile, OpeningContext, RECORDINGS, Recording};
use crate::messages::are_messages;
use crate::pictures::corner_columns::{are_corners, are_readings_of_pictures};
use crate::table::FileTable;
use crate::table::column_spec::ColumnSpec;
use crate::table::configurations::is_folder;
use crate::table::layout::ColumnLayout;
use crate::table::mapping::ColumnMap;
use crate::table::text::LineBlocks;
use crate::{FrameGrouping, ReadOptions};
use poecal_model::measurement::{Clock, Measurement};
use poecal_model::robot::{Controller, ReadingKind, Robot};
use poecal_numerics::error::{Error, ErrorKind, Result, shorten_name};

/// Content of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FileRole {
    /// Joint readings, no measurements.
    Joints,
    /// Measurements without joint readings; `is_named` if it names its targets.
    Measured { is_named: bool },
    /// Joint readings and measurements, or something else.
    Whole,
}

/// The readings of each line of a file of measurements, from another file.
#[derive(Clone, Debug, Default)]
pub(crate) struct ReadingsByLine {
    pub(crate) lines: BTreeMap<usize, Vec<f64>>,
    /// Mean measurements of a line's static interval, if the lines are those of a stream.
    pub(crate) means: BTreeMap<usize, Vec<Measurement>>,
    /// Rates of the readings, and times, for lines that were measured in motion.
    pub(crate) moving: Option<MotionByLine>,
    /// Conversion of columns into the readings.
    pub(crate) controller: Option<Controller>,
}

/// Lines that were measured in motion: rates of their readings (rad/s, m/s), and their times from the middle of all, seconds.
#[derive(Clone, Debug)]
pub(crate) struct MotionByLine {
    pub(crate) rows: BTreeMap<usize, (Vec<f64>, f64)>,
    /// The clock of the instrument.
    pub(crate) clock: Clock,
}

/// Files of which some hold the joint readings of others.
pub(crate) struct JoinPlan<'p> {
    pub(crate) files: Vec<PlannedFile<'p>>,
}

/// A file and its content.
pub(crate) struct PlannedFile<'p> {
    pub(crate) path: &'p Path,
    pub(crate) part: FileRole,
    /// Mapping by which a file without readings is read.
    pub(crate) map: ColumnMap,
    /// The table of a file in another form.
    table: Option<MadeTable>,
}

impl<'p> PlannedFile<'p> {
    /// The tables of two sets of coordinates, of a file that has them.
    pub(crate) fn sets(&self) -> Option<[MadeTable; 2]> {
        self.table.as_ref()?.sets()
    }

    /// Replaces its table.
    pub(crate) fn with_table(&mut self, table: MadeTable) {
        self.table = Some(table);
    }

    /// Its blocks.
    pub(crate) fn blocks(&self, opening: OpeningContext<'_>, expected: &'p str) -> Result<LineBlocks<'p>> {
        match &self.table {
            Some(table) => Ok(table.blocks(self.path, expected)),
            None => opening.blocks(self.path, expected),
        }
    }
}

impl<'p> JoinPlan<'p> {
    /// The plan of files, if there are some to join.
    pub(crate) fn from_paths(
        paths: &[&'p Path],
        robot: &Robot,
        options: &ReadOptions,
        map: &ColumnMap,
    ) -> Result<Option<Self>> {
        let opening = OpeningContext { robot, options };
        let recordings: Vec<Option<Recording>> =
            paths.iter().map(|path| opening.recording(path)).collect::<Result<_>>()?;
        let first = paths.iter().zip(&recordings).find_map(|(path, it)| Some((*path, it.as_ref()?)));
        if paths.len() < 2 && first.is_none() {
            return Ok(None);
        }
        let (files, neither) = sort_parts(paths.iter().copied().zip(&recordings), opening, map)?;
        let measured = files.iter().filter(|it| matches!(it.1, FileRole::Measured { .. })).count();
        let joints = files.iter().filter(|it| it.1 == FileRole::Joints).count();
        if let Some((path, recording)) = first {
            refuse_other_topics(path, &recordings, options)?;
            let has_bodies = recordings.iter().flatten().any(|it| it.names_bodies)
                || files.iter().any(|it| it.2.as_ref().is_some_and(|it| RECORDINGS.contains(&it.title)));
            if options.body.is_some() && !has_bodies {
                return Err(unused_option_error("--body", BODIES));
            }
            if joints == 0 || measured == 0 {
                return Err(recording.error(path, joints == 0));
            }
        }
        // If another file has joint readings or measurements, the first file without either is reported.
        if let Some(UnusableFile { as_joints, as_measured }) = neither.into_iter().next()
            && joints + measured > 0
        {
            return Err(if joints == 0 { as_joints } else { as_measured });
        }
        if joints == 0 || measured == 0 {
            return Ok(None);
        }
        let several = joints == 1 && measured > 1;
        // Files with different frames are from several stations of the instrument.
        let frames: BTreeSet<&str> = (files.iter())
            .filter(|it| several && matches!(it.1, FileRole::Measured { .. }))
            .filter_map(|it| it.2.as_ref()?.frame.as_deref())
            .collect();
        let is_by_frames = frames.len() > 1 && options.frames == FrameGrouping::Common;
        let planned = |(path, part, table): FileWithTable<'p>| {
            let mut map = without_joints(map, robot);
            // Several files that were measured at the same configurations are of several targets, or of several instruments.
            let is_unnamed = part == (FileRole::Measured { is_named: false });
            if several && is_unnamed && !is_by_frames && options.frames == FrameGrouping::Common {
                map.target_name = path.file_stem().map(|it| it.to_string_lossy().into_owned());
            }
            let table = if is_by_frames { table.map(MadeTable::by_frame) } else { table };
            PlannedFile { path, part, map, table }
        };
        Ok(Some(JoinPlan { files: files.into_iter().map(planned).collect() }))
    }
}

/// Refuses a requested topic that no file has.
fn refuse_other_topics(path: &Path, recordings: &[Option<Recording>], options: &ReadOptions) -> Result<()> {
    for (at, name) in options.topics.iter().enumerate() {
        let found = recordings.iter().flatten().filter_map(|it| it.has_topic.get(at).copied().flatten()).max();
        if found == Some(true) {
            continue;
        }
        let contents: Vec<&str> = recordings.iter().flatten().map(|it| it.contents.as_str()).collect();
        let contents = contents.join(", ");
        let name = shorten_name(name);
        let message = match found {
            None => format!("found no topic `{name}`, expected one of {contents}"),
            Some(_) => format!(
                "found the topic `{name}`, which has neither joint readings nor measurements, expected another one of {contents}"
            ),
        };
        return Err(ErrorKind::Option.error(message).in_file(path));
    }
    Ok(())
}

/// Content of a file, with its table if it is in another form.
pub(crate) struct FileFinding {
    pub(crate) part: FileRole,
    table: Option<MadeTable>,
    /// Reason why it has neither joint readings nor measurements.
    why: Option<UnusableFile>,
}

/// Reasons why a file has no joint readings, and no measurements.
struct UnusableFile {
    as_joints: Error,
    as_measured: Error,
}

impl FileFinding {
    fn whole_file() -> Self {
        FileFinding { part: FileRole::Whole, table: None, why: None }
    }

    /// The reasons for a file that cannot be read.
    fn from_read_error(error: &Error) -> Self {
        FileFinding {
            why: Some(UnusableFile { as_joints: error.clone(), as_measured: error.clone() }),
            ..Self::whole_file()
        }
    }
}

/// Determines the content of a file. A file that is no table is refused later: when it is read, or beside a file with joint readings or
/// measurements only.
///
/// # Errors
/// Those of a file in another form that cannot be one of these.
pub(crate) fn part(path: &Path, opening: OpeningContext<'_>, map: &ColumnMap) -> Result<FileFinding> {
    if is_folder(path) {
        let error = opening.open_file(path, MEASURED).err();
        return Ok(error.map_or_else(FileFinding::whole_file, |it| FileFinding::from_read_error(&it)));
    }
    let (blocks, table) = match opening.open_file(path, MEASURED)? {
        OpenedFile::Own(blocks) => (*blocks, None),
        OpenedFile::Made(table) => (table.blocks(path, MEASURED), Some(*table)),
    };
    let found = part_of(path, blocks, opening, map);
    Ok(FileFinding { table, ..found.unwrap_or_else(|error| FileFinding::from_read_error(&error)) })
}

fn part_of<'p>(
    path: &'p Path,
    mut blocks: LineBlocks<'p>,
    opening: OpeningContext<'_>,
    map: &ColumnMap,
) -> Result<FileFinding> {
    let OpeningContext { robot, options } = opening;
    blocks.begin()?;
    if are_messages(path, blocks.text())? {
        return Ok(FileFinding::whole_file());
    }
    let table = FileTable::open(path, blocks, map)?;
    let names = robot.reading_names();
    if are_corners(&table.header, &names, map)?
        || !options.cameras.is_empty() && are_readings_of_pictures(&table.header, &names, map)
    {
        return Ok(FileFinding::whole_file());
    }
    let joints = ColumnLayout::joints(&table.header, robot, options, map);
    let measured = ColumnLayout::new(&table.header, robot, options, &without_joints(map, robot));
    let (part, why) = match (joints, measured) {
        (Ok(_), Err(_)) => (FileRole::Joints, None),
        (Err(_), Ok(layout)) => {
            let is_named = layout.target_column.is_some() || layout.targets.len() > 1 || map.target_name.is_some();
            (FileRole::Measured { is_named }, None)
        }
        (Err(as_joints), Err(as_measured)) => (FileRole::Whole, Some(UnusableFile { as_joints, as_measured })),
        // Columns by number are those of the file without joint readings.
        (Ok(_), Ok(_)) if !map.names_joints() && map.measured_numbers().is_some() => (FileRole::Joints, None),
        (Ok(_), Ok(_)) => (FileRole::Whole, None),
    };
    Ok(FileFinding { part, table: None, why })
}

/// A mapping for a file without readings: those of joints are numbers without meaning.
fn without_joints(map: &ColumnMap, robot: &Robot) -> ColumnMap {
    let names = robot.reading_names();
    let joints = names.into_iter().filter(|name| robot.reading_kind(name) != ReadingKind::Factor);
    let zero = || ColumnSpec { value: Some(0.0), ..ColumnSpec::default() };
    let mut own = map.clone();
    (own.joints, own.third_axis) = (joints.map(|name| (name, zero())).collect(), None);
    own
}

/// A file with its content, and its table if it is in another form.
type FileWithTable<'p> = (&'p Path, FileRole, Option<MadeTable>);

/// Sorts files by content, with the reasons why some have neither joint readings nor measurements.
fn sort_parts<'p, 'r>(
    paths: impl Iterator<Item = (&'p Path, &'r Option<Recording>)>,
    opening: OpeningContext<'_>,
    map: &ColumnMap,
) -> Result<(Vec<FileWithTable<'p>>, Vec<UnusableFile>)> {
    let mut files: Vec<FileWithTable<'p>> = Vec::new();
    let mut neither = Vec::new();
    for (path, recording) in paths {
        let Some(recording) = recording else {
            let FileFinding { part, table, why } = part(path, opening, map)?;
            neither.extend(why);
            files.push((path, part, table));
            continue;
        };
        for (is_joints, table) in recording.tables() {
            let is_named = map.target_name.is_some();
            let part = if is_joints { FileRole::Joints } else { FileRole::Measured { is_named } };
            files.push((path, part, Some(table)));
        }
    }
    Ok((files, neither))
}
