//! One file with lists of poses: of an arm's flange, of a camera's target, or both side by side; the arm's also by joint readings.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use nalgebra::Vector3;

use super::pose_columns::{
    NumberColumn, PoseColumns, PoseOwner, PoseUnits, find_pose_columns, list_words, name_column, text_column,
};
use super::pose_readings::other_readings;
use super::samples;
use crate::read::joints::read_joints;
use crate::table::mapping::ColumnMap;
use crate::table::number::NumberReader;
use crate::table::text::LineBlocks;
use crate::table::{FileRow, FileTable};
use crate::{LARGEST_NUMBER, ReadOptions};
use poecal_arm::lie::Pose;
use poecal_fit::hand_eye::PoseList;
use poecal_model::robot::Robot;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::unit::Unit;

/// Largest angle, radians.
const LARGEST_ANGLE: f64 = 2.01 * std::f64::consts::PI;

/// One list of a file, while it is read.
struct PoseListRows {
    columns: PoseColumns,
    /// Numbers of the orientations, radians or dimensionless.
    numbers: Vec<Vec<f64>>,
    poses: Vec<Pose>,
}

/// One list of a file.
pub(crate) struct PoseFileList {
    pub(crate) whose: PoseOwner,
    pub(crate) poses: PoseList,
    /// Interpretation of its columns.
    pub(crate) words: String,
}

/// A file of poses.
#[derive(Default)]
pub(crate) struct PoseFile {
    pub(crate) path: PathBuf,
    pub(crate) lists: Vec<PoseFileList>,
    pub(crate) lines: Vec<usize>,
    pub(crate) names: Option<Vec<String>>,
    pub(crate) points: Vec<String>,
    pub(crate) tips: Vec<String>,
    /// Readings of the joints, one row after the other, if the arm's poses are computed from them.
    pub(crate) joints: Vec<f64>,
    pub(crate) warnings: Vec<String>,
    pub(crate) sha256: Option<String>,
}

/// The error of a file without a list of poses.
pub(crate) fn no_list<T>(path: &Path, whose: PoseOwner) -> Result<T> {
    Err(ErrorKind::Measurement
        .error(format!(
            "found no poses of {}, expected columns such as flange_x, flange_y, flange_z, flange_qx … flange_qw for the arm and target_x … target_qw \
             for the target (`poecal init --hand-eye in-hand` writes a header)",
            list_words(whose)
        ))
        .in_file(path))
}

impl PoseFile {
    /// Names of the rows in messages: line, and name.
    pub(crate) fn row_names(&self) -> Vec<String> {
        let name = |row: usize| self.names.as_ref()?.get(row).filter(|it| !it.is_empty());
        let words = |(row, line): (usize, &usize)| match name(row) {
            Some(name) => format!("line {line} ({name})"),
            None => format!("line {line}"),
        };
        self.lines.iter().enumerate().map(words).collect()
    }

    /// The row of each name, if a column has names.
    ///
    /// # Errors
    /// [`ErrorKind::Measurement`] if a name occurs twice, with its line.
    pub(crate) fn rows_by_name(&self) -> Result<Option<BTreeMap<&String, usize>>> {
        let Some(names) = &self.names else { return Ok(None) };
        let mut rows = BTreeMap::new();
        for (row, name) in names.iter().enumerate() {
            if rows.insert(name, row).is_some() {
                let message = format!("found the name `{name}` a second time, expected each pose once: rename it");
                let line = self.lines.get(row).copied().unwrap_or(1);
                return Err(ErrorKind::Measurement.error(message).at_line(&self.path, line));
            }
        }
        Ok(Some(rows))
    }

    /// Takes one of the two lists.
    pub(crate) fn take(&mut self, whose: PoseOwner) -> Result<PoseFileList> {
        match self.lists.iter().position(|list| list.whose == whose) {
            Some(at) => Ok(self.lists.swap_remove(at)),
            None => no_list(&self.path, whose),
        }
    }
}

/// Reads a file; `alone` is its list of poses if it has one list only. With a robot, the arm's poses are those of its tip by the file's joint
/// readings.
pub(crate) fn read_poses(
    path: &Path,
    alone: Option<PoseOwner>,
    stated: PoseUnits,
    robot: Option<&Robot>,
) -> Result<PoseFile> {
    let map = ColumnMap::default();
    let expected = "a file of poses (CSV)";
    let blocks = match samples::table(path)? {
        Some(made) => made.blocks(path, expected),
        None => LineBlocks::open(path, expected)?,
    };
    let mut table = FileTable::open(path, blocks, &map)?;
    let joints = robot.map(Robot::reading_names).unwrap_or_default();
    let by_joints = robot.filter(|_| alone != Some(PoseOwner::Target));
    let alone = if by_joints.is_some() { Some(PoseOwner::Target) } else { alone };
    let lists = find_pose_columns(&table.header, &joints, alone, stated)?;
    if lists.is_empty() && by_joints.is_none() {
        return no_list(path, alone.unwrap_or(PoseOwner::Arm));
    }
    let rows = |columns| PoseListRows { columns, numbers: Vec::new(), poses: Vec::new() };
    let mut lists: Vec<PoseListRows> = lists.into_iter().map(rows).collect();
    let name = name_column(&table.header);
    let [point, tip] = ["point", "tip"].map(|it| text_column(&table.header, it));
    let mut file = PoseFile { path: path.to_owned(), names: name.map(|_| Vec::new()), ..PoseFile::default() };
    let mut numbers = NumberReader::new(None);
    table.some_rows("a row for each pose", |row| {
        for list in &mut lists {
            list.add(row, &mut numbers)?;
        }
        file.lines.push(row.line);
        file.names.iter_mut().for_each(|names| names.push(row.word(name)));
        file.points.push(row.word(point));
        file.tips.push(row.word(tip));
        Ok(())
    })?;
    file.lists = lists.into_iter().map(PoseListRows::list).collect();
    file.sha256 = table.sha256();
    if let Some(robot) = by_joints {
        let read = read_joints(path, robot, &ReadOptions::default())?;
        let poses: Vec<Pose> = robot.forward_kinematics_of(&read.readings).collect();
        let words = format!("the arm: joint readings, by which `{}` is where the model has it", robot.tip_name);
        file.lists.push(PoseFileList { whose: PoseOwner::Arm, poses: poses.into(), words });
        (file.joints, file.warnings) = (read.readings, read.warnings);
    }
    Ok(file)
}

impl PoseListRows {
    /// The poses, with other interpretations of their numbers.
    fn list(self) -> PoseFileList {
        let others = other_readings(&self.columns, &self.poses, &self.numbers);
        let poses = PoseList { others, ..self.poses.into() };
        PoseFileList { whose: self.columns.whose, poses, words: self.columns.words }
    }

    /// Adds the pose of a row.
    fn add(&mut self, row: &FileRow<'_>, numbers: &mut NumberReader) -> Result<()> {
        let PoseColumns { position, orientation, form, .. } = &self.columns;
        let mut number = |it: &NumberColumn| Ok(it.unit.to_si(row.number(it.at, numbers, format_args!(""))?));
        let mut place = Vector3::zeros();
        for (value, column) in place.iter_mut().zip(position) {
            *value = number(column)?;
        }
        let parts: Vec<f64> = orientation.iter().map(number).collect::<Result<_>>()?;
        let first = |columns: &[NumberColumn]| columns.first().map_or(0, |it| it.at);
        let largest = parts.iter().copied().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
        if form.quantity() == Unit::Radian && largest.abs() > LARGEST_ANGLE {
            let option = if self.columns.takes_angle_unit { ", or --units deg" } else { "" };
            let message = format!(
                "found the angle {largest:.3} rad, expected at most a full turn: if the column is in degrees, write `[deg]` behind its name{option}"
            );
            return Err(row.error(first(orientation), message));
        }
        let rotation = form.rotation(&parts).map_err(|message| row.error(first(orientation), message))?;
        if !place.iter().all(|it| it.abs() <= LARGEST_NUMBER) {
            let far = place.norm();
            let message = format!("found a position {far:.0} m away, expected one within a million metres");
            return Err(row.error(first(position), message));
        }
        self.poses.push(Pose::new(rotation, place));
        self.numbers.push(parts);
        Ok(())
    }
}
