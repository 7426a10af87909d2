//! Lists of poses: of an arm's flange, and of what a camera saw, side by side in one file or in two.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::mapping::ColumnMap;
use super::number::Numbers;
use super::orientation::OrientationForm;
use super::pose_columns::{PoseColumns, StatedUnits, Whose, found, list_words, name_column, text_column};
use super::table::{Row, Table, refuse_more_rows};
use super::text::Blocks;
use super::units::NamedUnit;
use crate::error::{ErrorKind, Result};
use crate::hand_eye::{PoseList, Reading};
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
        (Some(one), Some(other)) => by_name(&first, one, &second, other, &mut warnings)?,
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

/// Rows of the same name, or whose names end in the same number.
fn by_name(
    first: &PoseFile,
    one: &[String],
    second: &PoseFile,
    other: &[String],
    warnings: &mut Vec<String>,
) -> Result<Vec<(usize, usize)>> {
    let number = |name: &String| -> String {
        let stem = name.rsplit(['/', '\\']).next().unwrap_or(name);
        let stem = stem.split('.').next().unwrap_or(stem);
        let digits: String = stem
            .chars()
            .rev()
            .take_while(char::is_ascii_digit)
            .collect::<Vec<_>>()
            .into_iter()
            .rev()
            .collect();
        let plain = digits.trim_start_matches('0');
        if digits.is_empty() {
            name.clone()
        } else if plain.is_empty() {
            "0".to_owned()
        } else {
            plain.to_owned()
        }
    };
    let exact = one.iter().any(|name| other.contains(name));
    let key = |name: &String| if exact { name.clone() } else { number(name) };
    let mut places: BTreeMap<String, usize> = BTreeMap::new();
    for (row, name) in other.iter().enumerate() {
        if places.insert(key(name), row).is_some() {
            return Err(ErrorKind::Measurement
                .error(format!("found the name `{name}` a second time, expected each pose once: rename it"))
                .at_line(&second.path, second.lines.get(row).copied().unwrap_or(1)));
        }
    }
    let rows: Vec<(usize, usize)> =
        one.iter().enumerate().filter_map(|(row, name)| Some((row, *places.get(&key(name))?))).collect();
    if rows.is_empty() {
        return Err(ErrorKind::Measurement
            .error(format!("found no name that is in {} too, expected the same names in both files: join them by one column", second.path.display()))
            .in_file(&first.path));
    }
    let alone = one.len() + other.len() - 2 * rows.len();
    if alone > 0 {
        warnings.push(format!(
            "{alone} poses are in one of the two files only, and left out; {} are in both",
            rows.len()
        ));
    }
    Ok(rows)
}

/// A table of poses to fill: of arm and target side by side, or of the arm's touches of a point.
#[must_use]
pub fn pose_table(has_target: bool) -> String {
    let flange = "flange_x[mm],flange_y[mm],flange_z[mm],flange_A[deg],flange_B[deg],flange_C[deg]";
    let forms = "# A, B, C are KUKA's; instead: W, P, R (FANUC), rx, ry, rz in [rad] (Universal Robots), q1 to q4 (ABB), qx, qy, qz, qw (ROS), r11 to r33\n";
    if has_target {
        let target =
            "target_rvec_x,target_rvec_y,target_rvec_z,target_tvec_x[mm],target_tvec_y[mm],target_tvec_z[mm]";
        format!(
            "# A row for each pose: the flange in the base as the controller shows it, and the target as the camera sees it; 15 to 30 poses, turned by 20 deg \
             and more about two axes\n{forms}image,{flange},{target}\n"
        )
    } else {
        format!(
            "# A row for each touch of a fixed point by the tip: the flange in the base, with the controller's tool set to zero; 6 to 10 touches, tilted by \
             20 deg and more to all sides\n# point: name of the point, if there are several; tip: two tips along the tool show its direction\n{forms}{flange},point,tip\n"
        )
    }
}

impl List {
    /// The poses, with other readings of their numbers.
    fn list(self) -> PoseList {
        let others = self.others();
        PoseList { poses: self.poses, others }
    }

    /// How else the orientations could be read.
    fn others(&self) -> Vec<Reading> {
        let degree = std::f64::consts::PI / 180.0;
        let zyx = OrientationForm::Intrinsic([2, 1, 0]);
        let (xyz, zyz, fixed) = (
            OrientationForm::Intrinsic([0, 1, 2]),
            OrientationForm::Intrinsic([2, 1, 2]),
            OrientationForm::ROLL_PITCH_YAW,
        );
        let who = list_words(self.columns.whose_words());
        let mut ways: Vec<(OrientationForm, f64, String)> = Vec::new();
        if self.columns.form.quantity() == Unit::Radian {
            let symbol = self.columns.orientation.first().map_or("rad", |it| it.unit.symbol());
            let (other, factor) =
                if symbol == "deg" { ("radians", 1.0 / degree) } else { ("degrees", degree) };
            let short = if symbol == "deg" { "rad" } else { "deg" };
            ways.push((
                self.columns.form,
                factor,
                format!("angles of {who} in {other}: write `[{short}]` behind the names of these columns"),
            ));
            for (form, words) in [
                (zyx, "angles about z, y, x as turned (KUKA)"),
                (fixed, "roll, pitch, yaw about fixed axes (FANUC, URDF)"),
                (xyz, "angles about x, y, z as turned (Stäubli)"),
                (zyz, "angles about z, y, z as turned (Kawasaki)"),
                (OrientationForm::RotationVector, "rotation vectors (Universal Robots, OpenCV)"),
            ] {
                if form != self.columns.form {
                    ways.push((form, 1.0, format!("orientations of {who} as {words}: name the columns as that form has them (docs/howto/hand-eye.md)")));
                }
            }
        }
        match self.columns.form {
            OrientationForm::QuaternionXyzw => ways.push((
                OrientationForm::QuaternionWxyz,
                1.0,
                format!("quaternions of {who} with the real part first: exchange the names of the columns"),
            )),
            OrientationForm::QuaternionWxyz => ways.push((
                OrientationForm::QuaternionXyzw,
                1.0,
                format!("quaternions of {who} with the real part last: name the columns qx, qy, qz, qw"),
            )),
            OrientationForm::MatrixByRows => ways.push((
                OrientationForm::MatrixByColumns,
                1.0,
                format!("matrices of {who} written column by column: exchange rows and columns"),
            )),
            _ => {}
        }
        let read = |form: OrientationForm, factor: f64| -> Option<Vec<Pose>> {
            let rows = self.numbers.iter().zip(&self.positions);
            rows.map(|(numbers, place)| {
                let numbers: Vec<f64> = numbers.iter().map(|it| it * factor).collect();
                Some(Pose::new(form.rotation(&numbers).ok()?, *place))
            })
            .collect()
        };
        ways.into_iter()
            .filter_map(|(form, factor, advice)| Some(Reading { advice, poses: read(form, factor)? }))
            .collect()
    }
}

impl PoseColumns {
    fn whose_words(&self) -> Whose {
        if self.words.starts_with(list_words(Whose::Target)) { Whose::Target } else { Whose::Arm }
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
