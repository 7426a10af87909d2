//! What the columns of a list of poses are called: controllers', robots', cameras' and ROS's names.

use crate::table::conventions::{CONVENTIONS, OPENCV};
use crate::table::header::{Header, unit_in_name};
use crate::table::orientation::OrientationForm;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;

/// Whose poses a column belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Whose {
    /// The arm's.
    Arm,
    /// What the camera saw.
    Target,
}

const ARM: [&str; 11] =
    ["flange", "robot", "tcp", "base", "ee", "tool0", "tool", "gripper", "arm", "hand", "end_effector"];
const TARGET: [&str; 10] =
    ["target", "board", "marker", "camera", "cam", "tag", "pattern", "object", "chessboard", "c"];
/// Columns that name a row.
const NAMES: [&str; 9] = ["image", "picture", "file", "filename", "name", "id", "index", "image_id", "frame"];

/// Letters of makers, by the first of which the columns are the arm's.
const MAKERS: [&str; 4] = ["a", "w", "o", "u"];

/// A column of numbers with its unit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NumberColumn {
    pub(crate) at: usize,
    pub(crate) unit: NamedUnit,
}

/// The columns of one list.
#[derive(Clone, Debug)]
pub(crate) struct PoseColumns {
    pub(crate) position: [NumberColumn; 3],
    pub(crate) orientation: Vec<NumberColumn>,
    pub(crate) form: OrientationForm,
    /// Whether stated units are of its angles: OpenCV's are radians.
    pub(crate) takes_angle_unit: bool,
    /// How it was understood.
    pub(crate) words: String,
    pub(crate) whose: Whose,
}

/// A column that belongs to a pose: whose it is if its name says so, and its name without that.
struct Named {
    at: usize,
    whose: Option<Whose>,
    key: String,
}

/// The name of the part of a pose that a column's name means.
fn key_of(name: &str) -> Option<String> {
    let name = name.replace(['.', '[', ' ', '-'], "_").replace(']', "");
    let squeezed: String = name.chars().filter(|c| *c != '_').collect();
    let axis = |rest: &str| match rest {
        "x" | "0" => Some('x'),
        "y" | "1" => Some('y'),
        "z" | "2" => Some('z'),
        "w" | "3" => Some('w'),
        _ => None,
    };
    for (start, key) in [
        ("position", ""),
        ("pos", ""),
        ("tvec", ""),
        ("translation", ""),
        ("trans", ""),
        ("rvec", "rv"),
        ("rotvec", "rv"),
        ("intrinsic", "i"),
        ("orientation", "q"),
        ("quaternion", "q"),
        ("quat", "q"),
        ("rotation", "q"),
    ] {
        if let Some(axis) = squeezed.strip_prefix(start).and_then(axis) {
            return Some(format!("{key}{axis}"));
        }
    }
    let digits: String = squeezed.chars().filter(char::is_ascii_digit).collect();
    if digits.len() == 2
        && matches!(squeezed.trim_end_matches(|c: char| c.is_ascii_digit()), "r" | "m" | "t" | "h")
    {
        return Some(format!("m{digits}"));
    }
    let known = [
        "x", "y", "z", "qx", "qy", "qz", "qw", "q0", "q1", "q2", "q3", "q4", "rx", "ry", "rz", "a", "b", "c",
        "w", "p", "r", "o", "t", "e", "u", "v", "roll", "pitch", "yaw",
    ];
    let plain = match squeezed.as_str() {
        "tx" | "px" => "x",
        "ty" | "py" => "y",
        "tz" | "pz" => "z",
        other => other,
    };
    known.contains(&plain).then(|| plain.to_owned())
}

/// The name of a column without the unit at its end, as `x_mm`, and that unit.
fn without_unit(name: &str) -> (String, Option<NamedUnit>) {
    let Some((stem, last)) = name.rsplit_once(['_', ' ']) else { return (name.to_owned(), None) };
    let unit = if last == "m" || last.len() > 1 { unit_in_name(&format!("v_{last}"), "v") } else { None };
    match unit {
        Some(unit) => (stem.to_owned(), Some(unit)),
        None => (name.to_owned(), None),
    }
}

/// Whose a name says it is, with the rest of it.
fn prefixed(name: &str) -> (Option<Whose>, String) {
    let lower = name.to_lowercase().replace(['.', ' ', '-', '/'], "_");
    for (whose, prefixes) in [(Whose::Arm, &ARM[..]), (Whose::Target, &TARGET[..])] {
        for prefix in prefixes {
            let rest = lower
                .strip_prefix(&format!("{prefix}_pose_"))
                .or_else(|| lower.strip_prefix(&format!("{prefix}_")));
            if let Some(rest) = rest.filter(|rest| key_of(rest).is_some()) {
                return (Some(whose), rest.to_owned());
            }
        }
    }
    // As in `cx, cy, cz` of a camera beside `X, Y, Z`.
    if let Some(rest @ ("x" | "y" | "z")) = lower.strip_prefix('c') {
        return (Some(Whose::Target), rest.to_owned());
    }
    let whose = (lower.starts_with("rvec") || lower.starts_with("tvec")).then_some(Whose::Target);
    (whose, lower)
}

/// The column that names the rows.
pub(crate) fn name_column(header: &Header<'_>) -> Option<usize> {
    NAMES.iter().find_map(|name| header.cells.iter().position(|cell| cell.name.to_lowercase() == *name))
}

/// A column of texts of this name.
pub(crate) fn text_column(header: &Header<'_>, name: &str) -> Option<usize> {
    header.cells.iter().position(|cell| cell.name.eq_ignore_ascii_case(name))
}

/// Units of columns that state none, as `mm`, `deg`, or both.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoseUnits {
    /// Of lengths.
    pub length: Option<NamedUnit>,
    /// Of angles.
    pub angle: Option<NamedUnit>,
}

impl std::str::FromStr for PoseUnits {
    type Err = poecal_numerics::error::Error;

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

/// Columns of a header by whose poses they are, but for those of joints; `alone` says whose all are that do not say it, in a file of one list.
pub(crate) fn found(
    header: &Header<'_>,
    joints: &[String],
    alone: Option<Whose>,
    stated: PoseUnits,
) -> Result<Vec<(Whose, PoseColumns)>> {
    let name = name_column(header);
    let texts = ["point", "tip"].map(|it| text_column(header, it));
    let mut named: Vec<Named> = Vec::new();
    for (at, cell) in header.cells.iter().enumerate() {
        if Some(at) == name || texts.contains(&Some(at)) || joints.contains(&cell.name) {
            continue;
        }
        let (stem, _) = without_unit(&cell.name);
        let (whose, rest) = prefixed(&stem);
        if let Some(key) = key_of(&rest) {
            named.push(Named { at, whose, key });
        }
    }
    let one_list = alone.is_some()
        && !(named.iter().any(|it| it.whose == Some(Whose::Arm))
            && named.iter().any(|it| it.whose == Some(Whose::Target)));
    if let Some(whose) = alone.filter(|_| one_list) {
        named.iter_mut().for_each(|it| it.whose = Some(whose));
    }
    settle(&mut named);
    let mut lists = Vec::new();
    for whose in [Whose::Arm, Whose::Target] {
        let own: Vec<&Named> = named.iter().filter(|it| it.whose == Some(whose)).collect();
        if own.is_empty() {
            continue;
        }
        lists.push((whose, columns(header, whose, &own, stated)?));
    }
    Ok(lists)
}

/// Columns whose names do not say whose they are: makers' letters are the arm's; others go where that part is missing, the arm first.
fn settle(named: &mut [Named]) {
    let has = |named: &[Named], whose: Whose, keys: &[&str]| {
        named.iter().any(|it| it.whose == Some(whose) && keys.contains(&it.key.as_str()))
    };
    let all = |named: &[Named], keys: &[&str]| {
        keys.iter().all(|key| named.iter().any(|it| it.whose.is_none() && it.key == *key))
    };
    for keys in CONVENTIONS.iter().map(|it| it.columns).chain([&["x", "y", "z"][..]]) {
        if !all(named, keys) {
            continue;
        }
        let is_place = keys[0] == "x";
        let orientations: Vec<&str> = CONVENTIONS.iter().flat_map(|it| it.columns.iter().copied()).collect();
        let others: &[&str] = if is_place { &["x", "y", "z", "m03"] } else { &orientations };
        let is_maker = MAKERS.contains(&keys[0]);
        let whose = if is_maker || !has(named, Whose::Arm, others) { Whose::Arm } else { Whose::Target };
        for it in named.iter_mut().filter(|it| it.whose.is_none() && keys.contains(&it.key.as_str())) {
            it.whose = Some(whose);
        }
    }
    // A quaternion that came first, beside the arm's own angles and the place of the camera.
    let quaternion = |it: &Named| it.key.starts_with('q');
    let letters = named.iter().any(|it| {
        it.whose == Some(Whose::Arm) && (MAKERS.contains(&it.key.as_str()) || it.key == "b" || it.key == "p")
    });
    if letters && !has(named, Whose::Target, &["qx", "rvx", "rx", "roll", "m00"]) {
        for it in named.iter_mut().filter(|it| it.whose == Some(Whose::Arm) && quaternion(it)) {
            it.whose = Some(Whose::Target);
        }
    }
    named.iter_mut().filter(|it| it.whose.is_none()).for_each(|it| it.whose = Some(Whose::Arm));
}

/// What a list is called in messages.
pub(crate) fn list_words(whose: Whose) -> &'static str {
    match whose {
        Whose::Arm => "the arm",
        Whose::Target => "the target",
    }
}

/// The columns of one list by their parts.
fn columns(header: &Header<'_>, whose: Whose, named: &[&Named], stated: PoseUnits) -> Result<PoseColumns> {
    let is_from_0 = named.iter().any(|it| it.key == "m00");
    let key = |it: &Named| match it.key.strip_prefix('m').and_then(|digits| digits.parse::<u32>().ok()) {
        // Counted from 1.
        Some(number) if !is_from_0 && number >= 11 => format!("m{:02}", number - 11),
        _ => it.key.clone(),
    };
    let find = |wanted: &str| named.iter().find(|it| key(it) == wanted).map(|it| it.at);
    let all = |wanted: &[&str]| wanted.iter().map(|it| find(it)).collect::<Option<Vec<usize>>>();
    let who = list_words(whose);
    let names = || {
        named
            .iter()
            .filter_map(|it| header.cells.get(it.at))
            .map(|it| it.name.clone())
            .collect::<Vec<_>>()
            .join(", ")
    };
    let position = all(&["x", "y", "z"]).or_else(|| all(&["m03", "m13", "m23"]));
    let Some(&[x, y, z]) = position.as_deref() else {
        return Err(ErrorKind::Measurement
            .error(format!("found no position of {who} among the columns {}, expected x, y, z or tvec_x, tvec_y, tvec_z: name them so", names()))
            .at_line(header.path, header.line));
    };
    let found = CONVENTIONS.iter().find_map(|form| Some((form, all(form.columns)?)));
    let Some((form, orientation)) = found else {
        return Err(ErrorKind::Measurement
            .error(format!(
                "found no orientation of {who} among the columns {}, expected qx, qy, qz, qw, or A, B, C (KUKA), W, P, R (FANUC), O, A, T (Kawasaki), \
                 A, E, R (Comau), U, V, W (Epson), intrinsic_x, intrinsic_y, intrinsic_z (Stäubli), rx, ry, rz (rotation vector), q1 to q4 (ABB), roll, \
                 pitch, yaw, rvec_x, rvec_y, rvec_z (OpenCV) or r11 to r33: name them so",
                names()
            ))
            .at_line(header.path, header.line));
    };
    let usual = form.usual.unwrap_or(("m", "rad"));
    let number = |at: usize, quantity: Unit, stated: Option<NamedUnit>, usual: &str| {
        number_column(header, (at, quantity), (stated, usual), who)
    };
    let quantity = form.form.quantity();
    let takes_angle_unit = quantity == Unit::Radian && form.columns != OPENCV;
    let angle = stated.angle.filter(|_| takes_angle_unit);
    let usual_angle = if quantity == Unit::Radian { usual.1 } else { "1" };
    let position = [
        number(x, Unit::Metre, stated.length, usual.0)?,
        number(y, Unit::Metre, stated.length, usual.0)?,
        number(z, Unit::Metre, stated.length, usual.0)?,
    ];
    let orientation: Vec<NumberColumn> =
        orientation.into_iter().map(|at| number(at, quantity, angle, usual_angle)).collect::<Result<_>>()?;
    let symbol = orientation.first().map(|it| it.unit.symbol()).filter(|it| *it != "1");
    let words = format!(
        "{who}: {} ({}{})",
        form.words,
        position[0].unit.symbol(),
        symbol.map_or(String::new(), |it| format!(", {it}"))
    );
    Ok(PoseColumns { position, orientation, form: form.form, takes_angle_unit, words, whose })
}

/// A column of numbers with its unit: as the header has it, as its name ends, as it is stated, or the usual one.
fn number_column(
    header: &Header<'_>,
    (at, quantity): (usize, Unit),
    (stated, usual): (Option<NamedUnit>, &str),
    who: &str,
) -> Result<NumberColumn> {
    let purpose = format!("for {who}");
    let in_name =
        header.cells.get(at).and_then(|cell| without_unit(&cell.name).1).filter(|unit| unit.of() == quantity);
    let unit = match header.unit(at, quantity, &purpose)? {
        Some((unit, _)) => unit,
        None => match in_name.or(stated) {
            Some(unit) => unit,
            None => NamedUnit::parse(usual, quantity)?,
        },
    };
    Ok(NumberColumn { at, unit })
}
