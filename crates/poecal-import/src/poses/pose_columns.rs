//! Names of the columns of a list of poses, in controllers, robots, cameras and ROS.

use super::matrix_columns::matrices;
pub(crate) use super::pose_owner::PoseOwner;
use crate::table::conventions::{CONVENTIONS, OPENCV, OrientationConvention};
use crate::table::header::Header;
use crate::table::orientation::OrientationForm;
use crate::table::roles::{ColumnRole, plain_letters, without_unit};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;

/// A column of numbers with its unit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NumberColumn {
    pub(crate) at: usize,
    pub(crate) unit: NamedUnit,
}

/// The columns of one list.
#[derive(Clone, Debug)]
pub(crate) struct PoseColumns {
    pub(crate) position: Vec<NumberColumn>,
    pub(crate) orientation: Vec<NumberColumn>,
    pub(crate) form: OrientationForm,
    /// True if stated units apply to its angles: OpenCV's are radians.
    pub(crate) takes_angle_unit: bool,
    /// Interpretation of the columns, in words.
    pub(crate) words: String,
    pub(crate) whose: PoseOwner,
}

/// A column of a pose: its list, if the name states it, and the part of the pose, by its name in conventions.
struct PosePartColumn {
    at: usize,
    whose: Option<PoseOwner>,
    key: String,
}

const PLACE: [&str; 3] = ["x", "y", "z"];
/// Remedy for positions of a target without orientation.
const PLACES_ALONE: &str = "; places alone, as of a ball or a depth camera, locate the camera by the joint readings beside them: \
                            `poecal calibrate MODEL FILE --fix joints`, for a camera in the hand with --instrument NAME=LINK and --target NAME=LINK";
/// The position in the last column of a matrix.
const IN_MATRIX: [&str; 3] = ["r14", "r24", "r34"];

/// True if a part belongs to the position, false if to the orientation.
fn is_of_place(key: &str) -> bool {
    PLACE.contains(&key) || IN_MATRIX.contains(&key)
}

/// The part of a pose by the letters and digits of a name.
fn key_of(name: &str) -> Option<String> {
    let axis = |word: &str| match word {
        "x" | "0" => Some('x'),
        "y" | "1" => Some('y'),
        "z" | "2" => Some('z'),
        "w" | "3" => Some('w'),
        _ => None,
    };
    if let Some((part, axis)) = ColumnRole::part(name).and_then(|(part, rest)| Some((part, axis(rest)?))) {
        return Some(format!("{part}{axis}"));
    }
    let digits = name.trim_start_matches(['r', 'm', 't', 'h']);
    if name.len() == 3 && digits.len() == 2 && digits.bytes().all(|it| it.is_ascii_digit()) {
        return Some(format!("r{digits}"));
    }
    let of_place = ColumnRole::Place.words().filter_map(|it| name.strip_prefix(it)).find(|it| PLACE.contains(it));
    let known = of_place.unwrap_or(name);
    let is_known = PLACE.contains(&known) || CONVENTIONS.iter().any(|it| it.has(known));
    is_known.then(|| known.to_owned())
}

/// The list that a name states, and the part of the pose.
fn part_of(name: &str) -> Option<(Option<PoseOwner>, String)> {
    let (name, _) = without_unit(name);
    let words: Vec<String> = name.split(|it: char| !it.is_alphanumeric()).map(plain_letters).collect();
    for count in 1..words.len() {
        let (before, rest) = words.split_at(count);
        let rest = rest.strip_prefix(&["pose".to_owned()]).unwrap_or(rest);
        let (before, key) = (before.concat(), key_of(&rest.concat()));
        let whose = match key {
            Some(_) if ColumnRole::OfArm.has(&before) => Some(PoseOwner::Arm),
            Some(_) if ColumnRole::OfTarget.has(&before) => Some(PoseOwner::Target),
            _ => continue,
        };
        return Some((whose, key?));
    }
    let all = words.concat();
    // For example `cx, cy, cz` of a camera beside `X, Y, Z`.
    if let Some(axis) = all.strip_prefix('c').filter(|it| PLACE.contains(it)) {
        return Some((Some(PoseOwner::Target), axis.to_owned()));
    }
    let is_target = all.starts_with("rvec") || all.starts_with("tvec");
    Some((is_target.then_some(PoseOwner::Target), key_of(&all)?))
}

/// The column that names the rows.
pub(crate) fn name_column(header: &Header<'_>) -> Option<usize> {
    let mut names = [ColumnRole::Picture, ColumnRole::Row, ColumnRole::Frame].into_iter().flat_map(ColumnRole::words);
    names.find_map(|name| header.cells.iter().position(|cell| plain_letters(&cell.name) == name))
}

/// A column of texts of this name.
pub(crate) fn text_column(header: &Header<'_>, name: &str) -> Option<usize> {
    header.cells.iter().position(|cell| cell.name.eq_ignore_ascii_case(name))
}

/// Units of columns that state none, as `mm`, `deg`, or both.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoseUnits {
    /// Unit of lengths.
    pub length: Option<NamedUnit>,
    /// Unit of angles.
    pub angle: Option<NamedUnit>,
}

impl std::str::FromStr for PoseUnits {
    type Err = poecal_numerics::error::Error;

    fn from_str(text: &str) -> Result<Self> {
        let mut units = PoseUnits::default();
        for symbol in text.split(',').map(str::trim) {
            let unit = NamedUnit::parse_any(symbol)?;
            let place = if unit.si_unit() == Unit::Radian { &mut units.angle } else { &mut units.length };
            if place.replace(unit).is_some() {
                return ErrorKind::Option
                    .refuse(format!("found `{text}`, expected one unit of lengths and one of angles, like mm,deg"));
            }
        }
        Ok(units)
    }
}

/// Columns of a header by their list of poses, except those of joints. `alone` is the list of columns that do not state it, in a file of one list.
pub(crate) fn find_pose_columns(
    header: &Header<'_>,
    joints: &[String],
    alone: Option<PoseOwner>,
    stated: PoseUnits,
) -> Result<Vec<PoseColumns>> {
    let texts = [name_column(header), text_column(header, "point"), text_column(header, "tip")];
    let matrices = matrices(header);
    let is_free = |at: usize| !texts.contains(&Some(at)) && !matrices.iter().any(|it| it.0 == at);
    let cells = header.cells.iter().enumerate();
    let cells = cells.filter(|(at, cell)| is_free(*at) && !joints.contains(&cell.name));
    let mut parts: Vec<PosePartColumn> = cells
        .filter_map(|(at, cell)| part_of(&cell.name).map(|(whose, key)| PosePartColumn { at, whose, key }))
        .collect();
    parts.extend(matrices.iter().map(|(at, whose, key)| PosePartColumn { at: *at, whose: *whose, key: key.clone() }));
    let has = |whose| parts.iter().any(|it| it.whose == Some(whose));
    let is_one = !(has(PoseOwner::Arm) && has(PoseOwner::Target));
    if let Some(whose) = alone.filter(|_| is_one) {
        parts.iter_mut().for_each(|it| it.whose = Some(whose));
    }
    // The elements of a matrix may be numbered from 0.
    let from_0: Vec<Option<PoseOwner>> = parts.iter().filter(|it| it.key == "r00").map(|it| it.whose).collect();
    for part in parts.iter_mut().filter(|it| from_0.contains(&it.whose)) {
        if let Some(Ok(number)) = part.key.strip_prefix('r').map(str::parse::<u32>) {
            part.key = format!("r{}", number + 11);
        }
    }
    settle(&mut parts);
    let mut lists = Vec::new();
    for whose in [PoseOwner::Arm, PoseOwner::Target] {
        let own: Vec<&PosePartColumn> = parts.iter().filter(|it| it.whose == Some(whose)).collect();
        if !own.is_empty() {
            lists.push(columns(header, whose, &own, stated)?);
        }
    }
    Ok(lists)
}

/// Assigns columns whose names state no list. Makers' letters belong to the arm; others to the list without this part, the arm first.
fn settle(parts: &mut [PosePartColumn]) {
    let is = |it: &PosePartColumn, whose: Option<PoseOwner>, name: &str| {
        it.whose == whose && it.key.eq_ignore_ascii_case(name)
    };
    let conventions = CONVENTIONS.iter().map(|it| (it.columns, it.is_makers));
    for (columns, is_makers) in conventions.chain([(&PLACE[..], false)]) {
        if !columns.iter().all(|name| parts.iter().any(|it| is(it, None, name))) {
            continue;
        }
        let is_alike =
            |it: &PosePartColumn| it.whose == Some(PoseOwner::Arm) && is_of_place(&it.key) == (columns == PLACE);
        let is_arms = is_makers || !parts.iter().any(is_alike);
        for part in parts.iter_mut().filter(|it| columns.iter().any(|name| is(it, None, name))) {
            part.whose = Some(if is_arms { PoseOwner::Arm } else { PoseOwner::Target });
        }
    }
    // A quaternion may have been assigned first, beside the arm's own angles and the position of the camera.
    let has_all = |whose: PoseOwner, it: &OrientationConvention| {
        it.columns.iter().all(|name| parts.iter().any(|part| is(part, Some(whose), name)))
    };
    let is_targets = CONVENTIONS.iter().any(|it| it.is_makers && has_all(PoseOwner::Arm, it))
        && !CONVENTIONS.iter().any(|it| has_all(PoseOwner::Target, it));
    for part in parts {
        let is_arms = part.whose != Some(PoseOwner::Target);
        let is_quaternion = part.whose == Some(PoseOwner::Arm) && part.key.starts_with('q');
        if is_arms {
            part.whose = Some(if is_targets && is_quaternion { PoseOwner::Target } else { PoseOwner::Arm });
        }
    }
}

/// Name of a list in messages.
pub(crate) fn list_words(whose: PoseOwner) -> &'static str {
    match whose {
        PoseOwner::Arm => "the arm",
        PoseOwner::Target => "the target",
    }
}

/// The columns of one list by their parts.
fn columns(header: &Header<'_>, whose: PoseOwner, parts: &[&PosePartColumn], stated: PoseUnits) -> Result<PoseColumns> {
    let find = |name: &&str| parts.iter().find(|it| it.key.eq_ignore_ascii_case(name)).map(|it| it.at);
    let all = |names: &[&str]| names.iter().map(find).collect::<Option<Vec<usize>>>();
    let who = list_words(whose);
    let refuse = |missing: &str, expected: &str, more: &str| {
        let names = parts.iter().filter_map(|it| header.cells.get(it.at)).map(|it| it.name.as_str());
        let names = names.collect::<Vec<_>>().join(", ");
        let message =
            format!("found no {missing} of {who} among the columns {names}, expected {expected}: name them so{more}");
        Err(ErrorKind::Measurement.error(message).at_line(header.path, header.line))
    };
    let Some(place) = all(&PLACE).or_else(|| all(&IN_MATRIX)) else {
        return refuse("position", "x, y, z or tvec_x, tvec_y, tvec_z", "");
    };
    let found = CONVENTIONS.iter().find_map(|it| Some((it, all(it.columns)?)));
    let Some((convention, orientation)) = found else {
        return refuse(
            "orientation",
            "qx, qy, qz, qw, or A, B, C (KUKA), W, P, R (FANUC), O, A, T (Kawasaki), A, E, R (Comau), U, V, W (Epson), intrinsic_x, intrinsic_y, \
             intrinsic_z (Stäubli), rx, ry, rz (rotation vector), q1 to q4 (ABB), roll, pitch, yaw, rvec_x, rvec_y, rvec_z (OpenCV) or r11 to r33",
            if whose == PoseOwner::Target { PLACES_ALONE } else { "" },
        );
    };
    let (length, angle) = convention.usual.unwrap_or(("m", "rad"));
    let (form, quantity) = (convention.form, convention.form.quantity());
    let takes_angle_unit = quantity == Unit::Radian && convention.columns != OPENCV;
    let stated_angle = stated.angle.filter(|_| takes_angle_unit);
    let angle = if quantity == Unit::Radian { angle } else { "1" };
    // The unit of the header has priority, then the end of the column's name, the stated unit, and the usual one.
    let number = |at: usize, quantity: Unit, stated: Option<NamedUnit>, usual: &str| -> Result<NumberColumn> {
        let in_header = header.unit(at, quantity, &format!("for {who}"))?.map(|(unit, _)| unit);
        let in_name = header.cells.get(at).and_then(|cell| without_unit(&cell.name).1);
        let known = in_header.or(in_name.filter(|unit| unit.si_unit() == quantity)).or(stated);
        Ok(NumberColumn { at, unit: known.map_or_else(|| NamedUnit::parse(usual, quantity), Ok)? })
    };
    let of = |columns: Vec<usize>, quantity, stated, usual| {
        columns.into_iter().map(|at| number(at, quantity, stated, usual)).collect::<Result<Vec<_>>>()
    };
    let position = of(place, Unit::Metre, stated.length, length)?;
    let orientation = of(orientation, quantity, stated_angle, angle)?;
    let symbols = [position.first(), orientation.first()].into_iter().flatten().map(|it| it.unit.symbol());
    let symbols: Vec<&str> = symbols.filter(|it| *it != "1").collect();
    let words = format!("{who}: {} ({})", convention.words, symbols.join(", "));
    Ok(PoseColumns { position, orientation, form, takes_angle_unit, words, whose })
}
