//! Hypothetical mistakes, each with the change that undoes it and advice.

use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

use super::DiagnosisKind;
use super::change::{RowChange, ShiftedRows};
use poecal_model::measurement::{Dataset, Quantity};
use poecal_model::robot::{Joint, ReadingKind, Robot, level};

/// Largest number of files of which the units are compared.
const MOST_FILES: usize = 6;

/// A hypothetical mistake.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MistakeHypothesis {
    pub(crate) kind: DiagnosisKind,
    /// Changes that undo it, one after the other.
    pub(crate) changes: Vec<RowChange>,
    /// The change, as the subject of a sentence.
    pub(crate) action: String,
    /// Advice.
    pub(crate) advice: String,
}

impl MistakeHypothesis {
    pub(crate) fn new(kind: DiagnosisKind, change: RowChange, action: String, advice: String) -> Self {
        MistakeHypothesis { kind, changes: vec![change], action, advice }
    }

    /// Factor on all measured lengths.
    pub(crate) fn size_factor(&self) -> f64 {
        let factor = |change: &RowChange| if let RowChange::Resize(factor, _, true) = change { *factor } else { 1.0 };
        self.changes.iter().map(factor).product()
    }

    /// The data with the mistake undone.
    pub(crate) fn apply(&self, data: &Dataset) -> Dataset {
        let mut changes = self.changes.iter();
        let Some(first) = changes.next() else { return data.clone() };
        changes.fold(first.apply(data), |data, change| change.apply(&data))
    }
}

/// Names and kinds of the joints' readings; a mimic joint counts with its leader.
pub(crate) struct ReadingColumns {
    pub(crate) names: Vec<String>,
    pub(crate) kinds: Vec<ReadingKind>,
    /// For a third axis that counts from the horizontal: the second and third reading, and the factor of the second.
    level: Option<(usize, usize, f64)>,
}

impl ReadingColumns {
    pub(crate) fn new(robot: &Robot) -> Self {
        // Factors come last.
        let of_joints = |name: &String| robot.reading_kind(name) != ReadingKind::Factor;
        let names: Vec<String> = robot.reading_names().into_iter().filter(of_joints).collect();
        let kinds = names.iter().map(|name| robot.reading_kind(name)).collect();
        let at = |name: &String| names.iter().position(|it| it == name);
        let level = level(robot).and_then(|(second, third, factor)| Some((at(&second)?, at(&third)?, -factor)));
        ReadingColumns { kinds, level, names }
    }

    /// The joint of a reading that no other joint has, with its index.
    pub(crate) fn only_joint<'r>(&self, robot: &'r Robot, column: usize) -> Option<(usize, &'r Joint)> {
        let name = self.names.get(column)?;
        let mut users = robot.joints.iter().enumerate().filter(|(_, joint)| joint.reading.name == *name);
        users.next().filter(|_| users.next().is_none())
    }

    fn columns_of_kind(&self, kind: ReadingKind) -> Vec<usize> {
        (0..self.kinds.len()).filter(|&column| self.kinds[column] == kind).collect()
    }
}

/// Units of readings: degrees for radians and millimetres for metres, of all joints or of single ones.
pub(crate) fn joint_units(columns: &ReadingColumns) -> Vec<MistakeHypothesis> {
    let mut all = Vec::new();
    for (kind, factor, large, small) in
        [(ReadingKind::Angle, 180.0 / PI, "degrees", "radians"), (ReadingKind::Length, 1e3, "millimetres", "metres")]
    {
        let members = columns.columns_of_kind(kind);
        let mut sets: Vec<Vec<usize>> = members.iter().map(|&column| vec![column]).collect();
        if members.len() > 1 {
            sets.insert(0, members);
        }
        for set in sets {
            let names: Vec<&str> = set.iter().map(|&column| columns.names[column].as_str()).collect();
            let names = names.join(", ");
            for (factor, meant, read) in [(1.0 / factor, large, small), (factor, small, large)] {
                all.push(MistakeHypothesis::new(
                    DiagnosisKind::JointUnit,
                    RowChange::Scale(set.clone(), factor),
                    format!("taking the readings of {names} as {meant} instead of {read}"),
                    format!("state the unit of {names} in the header"),
                ));
            }
        }
    }
    all
}

/// One joint with the wrong sign.
pub(crate) fn joint_signs(columns: &ReadingColumns) -> Vec<MistakeHypothesis> {
    let one = |(column, name): (usize, &String)| {
        MistakeHypothesis::new(
            DiagnosisKind::JointSign,
            RowChange::Scale(vec![column], -1.0),
            format!("counting {name} the other way"),
            format!("check the sign of {name} in the readings and the direction of its axis in the model"),
        )
    };
    columns.names.iter().enumerate().map(one).collect()
}

/// Two joint columns exchanged.
pub(crate) fn joint_exchanges(columns: &ReadingColumns) -> Vec<MistakeHypothesis> {
    let mut all = Vec::new();
    for (b, second) in columns.names.iter().enumerate() {
        for (a, first) in columns.names.iter().enumerate().take(b) {
            // Exchanging a prismatic and a revolute joint would change units too.
            if columns.kinds[a] == columns.kinds[b] {
                all.push(MistakeHypothesis::new(
                    DiagnosisKind::JointsSwapped,
                    RowChange::Exchange(a, b),
                    format!("exchanging the readings of {first} and {second}"),
                    "check the order of the joint columns".to_owned(),
                ));
            }
        }
    }
    all
}

/// A revolute joint's readings as sum or difference with those of the revolute joint before it. Some controllers state the third axis
/// relative to the horizontal.
pub(crate) fn joint_couplings(columns: &ReadingColumns) -> Vec<MistakeHypothesis> {
    let turning = columns.columns_of_kind(ReadingKind::Angle);
    let mut all = Vec::new();
    for (&before, &column) in turning.iter().zip(turning.iter().skip(1)) {
        for (own, factor) in [(1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            all.push(coupling(columns, column, before, own, factor));
        }
    }
    all
}

/// A key of TOML, in quotes if it is not plain letters and digits.
pub(crate) fn toml_key(name: &str) -> String {
    let is_plain = name.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_' || letter == '-');
    if is_plain { name.to_owned() } else { format!("{name:?}") }
}

fn coupling(columns: &ReadingColumns, column: usize, other: usize, own: f64, factor: f64) -> MistakeHypothesis {
    let (name, before) = (columns.names[column].as_str(), columns.names[other].as_str());
    if columns.level == Some((other, column, factor)) && own == 1.0 {
        return MistakeHypothesis::new(
            DiagnosisKind::JointsCoupled,
            RowChange::Combine { column, own, other, factor },
            format!("counting {name} from the level instead of from the arm"),
            format!(
                "check whether the controller states {name} so, as those of FANUC do: then write `third_axis = \"level\"` into a mapping file \
                 (--columns)"
            ),
        );
    }
    let signed = |value: f64| if value < 0.0 { "-" } else { "" };
    let joined = if factor < 0.0 { "less" } else { "plus" };
    MistakeHypothesis::new(
        DiagnosisKind::JointsCoupled,
        RowChange::Combine { column, own, other, factor },
        format!("taking {name} as {}its readings {joined} those of {before}", if own < 0.0 { "minus " } else { "" }),
        format!(
            "check whether the controller states {name} together with {before}, as relative to the horizontal; in a mapping \
             file: `[joints]` and below it `{0} = {{ columns = {{ {0} = {1}1, {2} = {3}1 }} }}`",
            toml_key(name),
            signed(own),
            toml_key(before),
            signed(factor)
        ),
    )
}

/// Measurements paired with readings of rows before or after.
pub(crate) fn row_shifts(targets: usize) -> Vec<MistakeHypothesis> {
    let one = |stream: ShiftedRows, by: i32| {
        let rows = if by.abs() == 1 { "1 row".to_owned() } else { format!("{} rows", by.abs()) };
        let side = if by > 0 { "later" } else { "earlier" };
        let same = match stream {
            ShiftedRows::Target if targets > 1 => " of the same target",
            ShiftedRows::Target | ShiftedRows::File => "",
        };
        MistakeHypothesis::new(
            DiagnosisKind::RowShift,
            RowChange::Shift(by, stream),
            format!("pairing the readings of each row with the measurement {rows} {side}{same}"),
            "check how readings and measurements were brought together".to_owned(),
        )
    };
    let shifts = [1, -1, 2, -2, 3, -3];
    let mut all: Vec<MistakeHypothesis> = shifts.into_iter().map(|by| one(ShiftedRows::Target, by)).collect();
    if targets > 1 {
        all.extend(shifts.into_iter().map(|by| one(ShiftedRows::File, by)));
    }
    all
}

/// Factors that correct lengths read in another unit, and the mistake in words.
const OTHER_LENGTHS: [(f64, &str); 10] = [
    (1e-3, "millimetres had been read as metres"),
    (1e3, "metres had been read as millimetres"),
    (25.4, "inches had been read as millimetres"),
    (0.0254, "inches had been read as metres"),
    (1.0 / 25.4, "millimetres had been read as inches"),
    (1.0 / 0.0254, "metres had been read as inches"),
    (10.0, "centimetres had been read as millimetres"),
    (0.1, "millimetres had been read as centimetres"),
    (100.0, "metres had been read as centimetres"),
    (0.01, "centimetres had been read as metres"),
];

/// Lengths of a quantity in another unit.
pub(crate) fn length_units(of: Quantity, is_all: bool) -> Vec<MistakeHypothesis> {
    let is_position = of == Quantity::Position;
    let kind = if is_position { DiagnosisKind::PositionUnit } else { DiagnosisKind::LengthUnit };
    let one = |(factor, words): (f64, &str)| {
        MistakeHypothesis::new(
            kind,
            RowChange::Resize(factor, of, is_all),
            format!("multiplying the {}s by {}", of.name(), factor_words(factor)),
            format!("check their unit, since it looks as if {words} (or the model's lengths are in another one)"),
        )
    };
    OTHER_LENGTHS.into_iter().map(one).collect()
}

/// A factor as text of at most four digits.
fn factor_words(factor: f64) -> String {
    format!("{factor:.3e}").parse::<f64>().unwrap_or(factor).to_string()
}

/// Positions of one of several files in another unit than those of the others.
pub(crate) fn file_units(data: &Dataset) -> Vec<MistakeHypothesis> {
    let mut files: Vec<u32> = data.observations.iter().map(|row| row.source.file).collect();
    files.sort_unstable();
    files.dedup();
    if !(2..=MOST_FILES).contains(&files.len()) {
        return Vec::new();
    }
    let name = |file: u32| data.files.get(file as usize).map(|it| it.display().to_string());
    let of = |file: u32| {
        let name = name(file)?;
        let one = move |whole: MistakeHypothesis| {
            let factor = whole.size_factor();
            MistakeHypothesis {
                changes: vec![RowChange::ResizeFile(factor, file)],
                action: format!("multiplying the positions of {name} alone by {}", factor_words(factor)),
                ..whole
            }
        };
        Some(length_units(Quantity::Position, true).into_iter().map(one))
    };
    files.into_iter().filter_map(of).flatten().collect()
}

/// One coordinate of positions in another unit than the other two.
pub(crate) fn axis_units() -> Vec<MistakeHypothesis> {
    let one = |(axis, (factor, words)): (usize, (f64, &str))| {
        let name = ["x", "y", "z"][axis];
        MistakeHypothesis::new(
            DiagnosisKind::PositionUnit,
            RowChange::ResizeAxis(axis, factor),
            format!("multiplying {name} alone by {}", factor_words(factor)),
            format!(
                "state the unit of `{name}` in the header, since it looks as if {words} there, and not in the other two columns"
            ),
        )
    };
    (0..3).flat_map(|axis| OTHER_LENGTHS.map(|unit| (axis, unit))).map(one).collect()
}

/// Distances that do not count from their anchor, or radii of other spheres.
pub(crate) fn zeros() -> MistakeHypothesis {
    MistakeHypothesis::new(
        DiagnosisKind::DistanceZero,
        RowChange::FreeZero,
        "taking the zero of the distances as unknown".to_owned(),
        "check what they count from, and whether the radius of a ball or the length of a hook is missing or counted twice \
         (`--free zero` finds it)"
            .to_owned(),
    )
}

/// Tilts in another unit. Mirrored tilts are those of the opposite direction, measured by a tool that is turned.
pub(crate) fn tilt_units() -> Vec<MistakeHypothesis> {
    let unit = |factor: f64, meant: &str, read: &str| {
        MistakeHypothesis::new(
            DiagnosisKind::TiltUnit,
            RowChange::ScaleTilts(factor),
            format!("taking the tilts as {meant} instead of {read}"),
            "state the unit of tilt_x and tilt_y in the header".to_owned(),
        )
    };
    vec![unit(180.0 / PI, "radians", "degrees"), unit(PI / 180.0, "degrees", "radians")]
}

/// Quaternions in another order, and inverted poses.
pub(crate) fn pose_forms() -> Vec<MistakeHypothesis> {
    let order = |places, was, read| {
        MistakeHypothesis::new(
            DiagnosisKind::QuaternionOrder,
            RowChange::Quaternion(places),
            format!("taking the quaternions in the order {was} instead of {read}"),
            "check the order of the quaternion columns".to_owned(),
        )
    };
    let inverse = |change, what: &str, expected| {
        MistakeHypothesis::new(DiagnosisKind::InvertedPose, change, format!("inverting the {what}"), expected)
    };
    let poses = "check which way they go, since device_from_target is expected \
                 (poses of the device in the target: `pose = \"target_from_device\"` in a mapping)";
    let turns = "check which way they go, since orientations of the target in the device are expected \
                 (a transposed matrix or a conjugate quaternion is the other way)";
    vec![
        order([1, 2, 3, 0], "w, x, y, z", "x, y, z, w"),
        order([3, 0, 1, 2], "x, y, z, w", "w, x, y, z"),
        inverse(RowChange::Invert, "poses", poses.to_owned()),
        inverse(RowChange::Transpose, "orientations", turns.to_owned()),
    ]
}

/// Coordinates of a left-handed frame. With an unknown device frame, mirrored points are the same for every axis.
pub(crate) fn mirrors(device_free: bool, turned: bool) -> Vec<MistakeHypothesis> {
    let negated = |axis: usize| {
        let mut signs = Vector3::new(1.0, 1.0, 1.0);
        signs[axis] = -1.0;
        (Matrix3::from_diagonal(&signs), format!("negating {}", ["x", "y", "z"][axis]))
    };
    let exchanged = |a: usize, b: usize| {
        let mut mirror = Matrix3::identity();
        mirror.swap_columns(a, b);
        (mirror, format!("exchanging {} and {}", ["x", "y", "z"][a], ["x", "y", "z"][b]))
    };
    let axes = [negated(0), negated(1), negated(2), exchanged(0, 1), exchanged(0, 2), exchanged(1, 2)];
    let mut all = Vec::new();
    for (index, (mirror, words)) in axes.into_iter().enumerate() {
        if index == 0 || !device_free {
            let what = if turned { "positions and orientations" } else { "positions" };
            all.push(mirror_hypothesis(mirror, true, format!("mirroring the {what} ({words})")));
        }
        if turned {
            all.push(mirror_hypothesis(mirror, false, format!("mirroring the positions ({words})")));
        }
    }
    all
}

fn mirror_hypothesis(mirror: Matrix3<f64>, turns: bool, action: String) -> MistakeHypothesis {
    MistakeHypothesis::new(
        DiagnosisKind::LeftHanded,
        RowChange::Mirror(mirror, turns),
        action,
        "check whether an axis of the measuring device has the wrong sign or two are exchanged, since a right-handed \
         frame is expected"
            .to_owned(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_resized_by_the_ratio_of_the_units_that_the_words_name() {
        let metres = |word: &str| match word {
            "metres" => 1.0,
            "centimetres" => 0.01,
            "millimetres" => 0.001,
            "inches" => 0.0254,
            other => panic!("found the unit {other}"),
        };
        let all = length_units(Quantity::Position, true);
        for hypothesis in &all {
            let words: Vec<&str> =
                hypothesis.advice.split(|it: char| !it.is_alphabetic()).filter(|it| !it.is_empty()).collect();
            let at = words.windows(4).position(|it| it == ["had", "been", "read", "as"]).unwrap();
            let ratio = metres(words[at - 1]) / metres(words[at + 4]);
            println!("{} read as {}: {ratio}", words[at - 1], words[at + 4]);
            assert!((hypothesis.size_factor() / ratio - 1.0).abs() < 1e-12, "{}", hypothesis.advice);
        }
        assert_eq!(all.len(), 10);
    }
}
