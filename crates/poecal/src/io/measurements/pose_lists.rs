//! Lists of poses: of an arm's flange, and of what a camera saw, side by side in one file or in two.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::mapping::ColumnMap;
use super::number::Numbers;
use super::pose_columns::{PoseColumns, StatedUnits, Whose, found, list_words, name_column, text_column};
use super::pose_names::{Named, by_name};
use super::pose_readings::others;
use super::table::{Row, Table, refuse_more_rows};
use super::text::Blocks;
use super::units::NamedUnit;
use crate::error::{ErrorKind, Result};
use crate::hand_eye::PoseList;
use crate::lie::Pose;
use crate::unit::Unit;
use nalgebra::Vector3;

/// Units of columns that state none, as `mm`, `deg`, or both.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoseUnits {
    /// Of lengths.
    pub length: Option<NamedUnit>,
    /// Of angles.
    pub angle: Option<NamedUnit>,
}

impl std::str::FromStr for PoseUnits {
    type Err = crate::error::Error;

    fn from_str(text: &str) -> Result<Self> {
        let mut units = PoseUnits::default();
        for symbol in text.split(',').map(str::trim) {
            let unit = NamedUnit::parse_any(symbol)?;
            let place = if unit.of() == Unit::Radian { &mut units.angle } else { &mut units.length };
            if place.replace(unit).is_some() {
                return ErrorKind::Option.refuse(format!(
                    "found `{text}`, expected one unit of lengths and one of angles, like mm,deg"
                ));
            }
        }
        Ok(units)
    }
}

/// Poses of an arm, and of what a camera saw, row by row.
#[derive(Clone, Debug, Default)]
pub struct PosePairs {
    /// `base_from_flange`, unless they are inverted.
    pub flange: PoseList,
    /// `camera_from_target`, likewise.
    pub target: PoseList,
    /// What messages call each row.
    pub names: Vec<String>,
    /// How the columns were understood, a sentence each.
    pub understood: Vec<String>,
    /// Warnings, a sentence each.
    pub warnings: Vec<String>,
    /// SHA-256 of each file by its name.
    pub sha256: BTreeMap<String, String>,
}

/// Poses of an arm, with texts of its rows.
#[derive(Clone, Debug, Default)]
pub struct FlangePoses {
    /// `base_from_flange`.
    pub poses: PoseList,
    /// The point that the row touched, empty if no column says it.
    pub points: Vec<String>,
    /// The tip with which it did.
    pub tips: Vec<String>,
    /// What messages call each row.
    pub names: Vec<String>,
    /// How the columns were understood, a sentence each.
    pub understood: Vec<String>,
    /// SHA-256 of each file by its name.
    pub sha256: BTreeMap<String, String>,
}

/// One list of a file.
struct List {
    columns: PoseColumns,
    positions: Vec<Vector3<f64>>,
    /// Numbers of the orientations, radians or none.
    numbers: Vec<Vec<f64>>,
    poses: Vec<Pose>,
}

/// A file of poses.
struct PoseFile {
    path: PathBuf,
    lists: Vec<(Whose, List)>,
    lines: Vec<usize>,
    names: Option<Vec<String>>,
    points: Vec<String>,
    tips: Vec<String>,
    sha256: Option<String>,
}

/// Reads poses of an arm and of a target: side by side in one file, or in two, joined by a column of names that both have, else row by row.
///
/// # Errors
/// [`ErrorKind::File`] if a file cannot be read; [`ErrorKind::Syntax`], [`ErrorKind::Measurement`] and [`ErrorKind::Unit`] for what is no
/// list of poses, with its place.
pub fn read_pose_pairs(paths: &[PathBuf], units: PoseUnits) -> Result<PosePairs> {
    match paths {
        [one] => side_by_side(read(one, None, units)?),
        [first, second] => {
            let (first, second) = (read(first, Some(Whose::Arm), units)?, read(second, Some(Whose::Target), units)?);
            joined(first, second)
        }
        _ => ErrorKind::Option.refuse(format!(
            "found {} files, expected one with the poses of arm and target side by side, or two: the arm's, then the target's",
            paths.len()
        )),
    }
}

/// Reads poses of an arm, with the columns `point` and `tip` if there are any.
///
/// # Errors
/// As [`read_pose_pairs`].
pub fn read_flange_poses(path: &Path, units: PoseUnits) -> Result<FlangePoses> {
    let file = read(path, Some(Whose::Arm), units)?;
    let names = row_names(&file);
    let sha256 = file.sha256.iter().map(|it| (path.display().to_string(), it.clone())).collect();
    let Some((_, list)) = file.lists.into_iter().next() else { return no_list(path, Whose::Arm) };
    Ok(FlangePoses {
        understood: vec![list.columns.words.clone()],
        poses: list.list(),
        points: file.points,
        tips: file.tips,
        names,
        sha256,
    })
}

fn no_list<T>(path: &Path, whose: Whose) -> Result<T> {
    Err(ErrorKind::Measurement
        .error(format!(
            "found no poses of {}, expected columns such as flange_x, flange_y, flange_z, flange_qx … flange_qw for the arm and target_x … target_qw \
             for the target (`poecal init --hand-eye in-hand` writes a header)",
            list_words(whose)
        ))
        .in_file(path))
}

fn side_by_side(file: PoseFile) -> Result<PosePairs> {
    let names = row_names(&file);
    let sha256 = file.sha256.iter().map(|it| (file.path.display().to_string(), it.clone())).collect();
    let (mut flange, mut target) = (None, None);
    for (whose, list) in file.lists {
        match whose {
            Whose::Arm => flange = Some(list),
            Whose::Target => target = Some(list),
        }
    }
    match (flange, target) {
        (Some(flange), Some(target)) => Ok(PosePairs {
            understood: vec![flange.columns.words.clone(), target.columns.words.clone()],
            flange: flange.list(),
            target: target.list(),
            names,
            warnings: Vec::new(),
            sha256,
        }),
        (None, _) => no_list(&file.path, Whose::Arm),
        (_, None) => no_list(&file.path, Whose::Target),
    }
}

/// What messages call the rows: their line, and their name.
fn row_names(file: &PoseFile) -> Vec<String> {
    let name = |row: usize| file.names.as_ref().and_then(|names| names.get(row)).filter(|it| !it.is_empty());
    let rows = file.lines.iter().enumerate();
    rows.map(|(row, line)| match name(row) {
        Some(name) => format!("line {line} ({name})"),
        None => format!("line {line}"),
    })
    .collect()
}

fn joined(first: PoseFile, second: PoseFile) -> Result<PosePairs> {
    let mut warnings = Vec::new();
    let rows: Vec<(usize, usize)> = match (&first.names, &second.names) {
        (Some(one), Some(other)) => {
            let one = Named { path: &first.path, names: one, lines: &first.lines };
            by_name(&one, &Named { path: &second.path, names: other, lines: &second.lines }, &mut warnings)?
        }
        _ if first.lines.len() == second.lines.len() => {
            (0..first.lines.len()).map(|row| (row, row)).collect()
        }
        _ => {
            return Err(ErrorKind::Measurement
                .error(format!(
                    "found {} poses, and {} in {}, expected as many, or a column `image` of names in both files by which they are joined",
                    first.lines.len(),
                    second.lines.len(),
                    second.path.display()
                ))
                .in_file(&first.path));
        }
    };
    let all_names = row_names(&first);
    let files = [&first, &second];
    let sha256 =
        files.iter().filter_map(|it| Some((it.path.display().to_string(), it.sha256.clone()?))).collect();
    let (first_path, second_path) = (first.path.clone(), second.path.clone());
    let Some((one, flange)) = first.lists.into_iter().next() else { return no_list(&first_path, Whose::Arm) };
    let Some((other, target)) = second.lists.into_iter().next() else {
        return no_list(&second_path, Whose::Target);
    };
    let names = rows.iter().filter_map(|(row, _)| all_names.get(*row).cloned()).collect();
    let understood = vec![flange.columns.words.clone(), target.columns.words.clone()];
    let pick = |list: List, rows: &[usize]| list.list().of_rows(rows);
    let (left, right): (Vec<usize>, Vec<usize>) = rows.into_iter().unzip();
    let (mut flange, mut target) = (pick(flange, &left), pick(target, &right));
    if (one, other) == (Whose::Target, Whose::Arm) {
        std::mem::swap(&mut flange, &mut target);
    }
    Ok(PosePairs { flange, target, names, understood, warnings, sha256 })
}

impl List {
    /// The poses, with other readings of their numbers.
    fn list(self) -> PoseList {
        let others = others(&self.columns, &self.positions, &self.numbers);
        PoseList { poses: self.poses, others }
    }
}

/// Reads a file; `alone` is whose poses it has, if it has one list.
fn read(path: &Path, alone: Option<Whose>, units: PoseUnits) -> Result<PoseFile> {
    let map = ColumnMap::default();
    let mut table = Table::open(path, Blocks::open(path, "a file of poses (CSV)")?, &map)?;
    let stated = StatedUnits { length: units.length, angle: units.angle };
    let lists = found(&table.header, alone, stated)?;
    let name = name_column(&table.header);
    let [point, tip] = ["point", "tip"].map(|it| text_column(&table.header, it));
    let header_line = table.header.line;
    let mut file = PoseFile {
        path: path.to_owned(),
        lists: lists
            .into_iter()
            .map(|(whose, columns)| {
                (whose, List { columns, positions: Vec::new(), numbers: Vec::new(), poses: Vec::new() })
            })
            .collect(),
        lines: Vec::new(),
        names: name.map(|_| Vec::new()),
        points: Vec::new(),
        tips: Vec::new(),
        sha256: None,
    };
    if file.lists.is_empty() {
        return no_list(path, alone.unwrap_or(Whose::Arm));
    }
    let mut numbers = Numbers::new(None);
    while let Some(mut rows) = table.next_block()? {
        while let Some(row) = rows.next()? {
            for (_, list) in &mut file.lists {
                list.add(&row, &mut numbers)?;
            }
            file.lines.push(row.line);
            refuse_more_rows(file.lines.len(), &row)?;
            let text = |at: Option<usize>| {
                at.and_then(|at| row.cells.get(at)).map_or(String::new(), |cell| cell.text().into_owned())
            };
            if let Some(names) = &mut file.names {
                names.push(text(name));
            }
            file.points.push(text(point));
            file.tips.push(text(tip));
        }
    }
    if file.lines.is_empty() {
        return Err(ErrorKind::Measurement
            .error("found a header and no rows, expected a row for each pose")
            .at_line(path, header_line));
    }
    file.sha256 = table.sha256();
    Ok(file)
}

impl List {
    /// Adds the pose of a row.
    fn add(&mut self, row: &Row<'_>, numbers: &mut Numbers) -> Result<()> {
        let mut number = |column: &super::pose_columns::NumberColumn| -> Result<f64> {
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
            let message = format!(
                "found the angle {:.3} rad, expected at most a full turn: if the column is in degrees, write `[deg]` behind its name, or --units deg",
                parts.iter().copied().fold(0.0, |most: f64, it| if it.abs() > most.abs() {
                    it
                } else {
                    most
                })
            );
            return Err(row.error(first, message));
        }
        let rotation = self.columns.form.rotation(&parts).map_err(|message| row.error(first, message))?;
        if !(place.iter().all(|it| it.abs() <= super::LARGEST_NUMBER)) {
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
