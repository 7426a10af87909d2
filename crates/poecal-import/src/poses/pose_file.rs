//! One file with lists of poses: of an arm's flange, of what a camera saw, or both side by side; an arm's also by the readings of its joints.

use std::path::{Path, PathBuf};

use nalgebra::Vector3;

use super::pose_columns::{
    NumberColumn, PoseColumns, PoseUnits, Whose, found, list_words, name_column, text_column,
};
use super::pose_names::Named;
use super::pose_readings::others;
use crate::read::joints::read_joints;
use crate::table::mapping::ColumnMap;
use crate::table::number::Numbers;
use crate::table::text::Blocks;
use crate::table::{Row, Table, refuse_more_rows};
use crate::{LARGEST_NUMBER, ReadOptions};
use poecal_arm::lie::Pose;
use poecal_fit::hand_eye::PoseList;
use poecal_model::robot::Robot;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::unit::Unit;

/// One list of a file, while it is read.
struct Columns {
    whose: Whose,
    columns: PoseColumns,
    positions: Vec<Vector3<f64>>,
    /// Numbers of the orientations, radians or none.
    numbers: Vec<Vec<f64>>,
    poses: Vec<Pose>,
}

/// One list of a file.
pub(crate) struct List {
    pub(crate) whose: Whose,
    pub(crate) poses: PoseList,
    /// How its columns were understood.
    pub(crate) words: String,
}

/// A file of poses.
pub(crate) struct PoseFile {
    pub(crate) path: PathBuf,
    pub(crate) lists: Vec<List>,
    pub(crate) lines: Vec<usize>,
    pub(crate) names: Option<Vec<String>>,
    pub(crate) points: Vec<String>,
    pub(crate) tips: Vec<String>,
    /// Readings of the joints, one row after the other, where the arm's poses are by these.
    pub(crate) joints: Vec<f64>,
    pub(crate) warnings: Vec<String>,
    pub(crate) sha256: Option<String>,
}

/// The error of a file without a list of poses.
pub(crate) fn no_list<T>(path: &Path, whose: Whose) -> Result<T> {
    Err(ErrorKind::Measurement
        .error(format!(
            "found no poses of {}, expected columns such as flange_x, flange_y, flange_z, flange_qx … flange_qw for the arm and target_x … target_qw \
             for the target (`poecal init --hand-eye in-hand` writes a header)",
            list_words(whose)
        ))
        .in_file(path))
}

impl PoseFile {
    /// What messages call the rows: their line, and their name.
    pub(crate) fn row_names(&self) -> Vec<String> {
        let name =
            |row: usize| self.names.as_ref().and_then(|names| names.get(row)).filter(|it| !it.is_empty());
        let rows = self.lines.iter().enumerate();
        rows.map(|(row, line)| match name(row) {
            Some(name) => format!("line {line} ({name})"),
            None => format!("line {line}"),
        })
        .collect()
    }

    /// The names of the rows, if a column has them.
    pub(crate) fn named(&self) -> Option<Named<'_>> {
        let names = self.names.as_deref()?;
        Some(Named { path: &self.path, names, lines: &self.lines })
    }

    /// The list of one of both.
    pub(crate) fn take(&mut self, whose: Whose) -> Result<List> {
        match self.lists.iter().position(|list| list.whose == whose) {
            Some(at) => Ok(self.lists.swap_remove(at)),
            None => no_list(&self.path, whose),
        }
    }
}

/// Reads a file; `alone` is whose poses it has, if it has one list. With a robot, the arm's poses are those of its tip by the file's joint readings.
pub(crate) fn read_poses(
    path: &Path,
    alone: Option<Whose>,
    stated: PoseUnits,
    robot: Option<&Robot>,
) -> Result<PoseFile> {
    let map = ColumnMap::default();
    let mut table = Table::open(path, Blocks::open(path, "a file of poses (CSV)")?, &map)?;
    let joints = robot.map(Robot::reading_names).unwrap_or_default();
    let by_joints = robot.filter(|_| alone != Some(Whose::Target));
    let alone = if by_joints.is_some() { Some(Whose::Target) } else { alone };
    let lists = found(&table.header, &joints, alone, stated)?;
    let mut lists: Vec<Columns> =
        lists.into_iter().map(|(whose, columns)| Columns::new(whose, columns)).collect();
    let name = name_column(&table.header);
    let [point, tip] = ["point", "tip"].map(|it| text_column(&table.header, it));
    let header_line = table.header.line;
    if lists.is_empty() && by_joints.is_none() {
        return no_list(path, alone.unwrap_or(Whose::Arm));
    }
    let (mut lines, mut points, mut tips) = (Vec::new(), Vec::new(), Vec::new());
    let mut names = name.map(|_| Vec::new());
    let mut numbers = Numbers::new(None);
    while let Some(mut rows) = table.next_block()? {
        while let Some(row) = rows.next()? {
            for list in &mut lists {
                list.add(&row, &mut numbers)?;
            }
            lines.push(row.line);
            refuse_more_rows(lines.len(), &row)?;
            let text = |at: Option<usize>| {
                at.and_then(|at| row.cells.get(at)).map_or(String::new(), |cell| cell.text().into_owned())
            };
            if let Some(names) = &mut names {
                names.push(text(name));
            }
            points.push(text(point));
            tips.push(text(tip));
        }
    }
    if lines.is_empty() {
        return no_rows(path, header_line);
    }
    let mut file = PoseFile {
        path: path.to_owned(),
        lists: lists.into_iter().map(Columns::list).collect(),
        lines,
        names,
        points,
        tips,
        joints: Vec::new(),
        warnings: Vec::new(),
        sha256: table.sha256(),
    };
    if let Some(robot) = by_joints {
        file.add_joints(robot)?;
    }
    Ok(file)
}

/// Refuses a file that has a header alone.
fn no_rows<T>(path: &Path, line: usize) -> Result<T> {
    Err(ErrorKind::Measurement
        .error("found a header and no rows, expected a row for each pose")
        .at_line(path, line))
}

impl PoseFile {
    /// Adds the list of the arm's poses by the readings of its joints.
    fn add_joints(&mut self, robot: &Robot) -> Result<()> {
        let read = read_joints(&self.path, robot, &ReadOptions::default())?;
        let poses: Vec<Pose> = robot.forward_kinematics_of(&read.readings).collect();
        let words =
            format!("the arm: joint readings, by which `{}` is where the model has it", robot.tip_name);
        self.lists.push(List { whose: Whose::Arm, poses: poses.into(), words });
        self.joints = read.readings;
        self.warnings.extend(read.warnings);
        Ok(())
    }
}

impl Columns {
    fn new(whose: Whose, columns: PoseColumns) -> Self {
        Columns { whose, columns, positions: Vec::new(), numbers: Vec::new(), poses: Vec::new() }
    }

    /// The poses, with other readings of their numbers.
    fn list(self) -> List {
        let others = others(&self.columns, &self.positions, &self.numbers);
        let poses = PoseList { others, ..self.poses.into() };
        List { whose: self.whose, poses, words: self.columns.words }
    }

    /// Adds the pose of a row.
    fn add(&mut self, row: &Row<'_>, numbers: &mut Numbers) -> Result<()> {
        let mut number = |column: &NumberColumn| -> Result<f64> {
            let text = row.cells.get(column.at).map(|cell| cell.text()).unwrap_or_default();
            let value = numbers
                .parse(&text, row.line)
                .map_err(|expected| row.error(column.at, format!("found `{text}`, expected {expected}")))?;
            Ok(column.unit.to_si(value))
        };
        let [x, y, z] = &self.columns.position;
        let place = Vector3::new(number(x)?, number(y)?, number(z)?);
        let parts: Vec<f64> = self.columns.orientation.iter().map(number).collect::<Result<_>>()?;
        let first = self.columns.orientation.first().map_or(0, |it| it.at);
        if self.columns.form.quantity() == Unit::Radian
            && parts.iter().any(|it| it.abs() > 2.01 * std::f64::consts::PI)
        {
            let option = if self.columns.takes_angle_unit { ", or --units deg" } else { "" };
            let message = format!(
                "found the angle {:.3} rad, expected at most a full turn: if the column is in degrees, write `[deg]` behind its name{option}",
                parts.iter().copied().fold(0.0, |most: f64, it| if it.abs() > most.abs() {
                    it
                } else {
                    most
                })
            );
            return Err(row.error(first, message));
        }
        let rotation = self.columns.form.rotation(&parts).map_err(|message| row.error(first, message))?;
        if !(place.iter().all(|it| it.abs() <= LARGEST_NUMBER)) {
            return Err(row.error(
                x.at,
                format!("found a position {:.0} m away, expected one within a million metres", place.norm()),
            ));
        }
        self.positions.push(place);
        self.poses.push(Pose::new(rotation, place));
        self.numbers.push(parts);
        Ok(())
    }
}
