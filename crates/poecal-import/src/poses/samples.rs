//! Samples of other hand-eye programs as a table of poses: lists of MoveIt, easy_handeye2 and scripts (YAML, JSON), and folders with one pose in
//! each file. The latter have the forms of ViSP and Zivid.

use std::collections::BTreeMap;
use std::path::Path;

use super::pose_owner::{PoseOwner, whose_of};
use crate::instruments::{CellValue, MadeTable, TableColumn};
use crate::table::configurations::is_folder;
use crate::table::picture_names::number_at_end;
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_storage::folder;
use poecal_storage::hashes::sha256_of;
use poecal_storage::limits::ResourceLimit;
use poecal_storage::source::unreadable_error;
use poecal_storage::source_text::read_up_to;
use poecal_storage::yaml_tree::{NodeKind, YamlNode, documents};

const EXPECTED: &str = "samples of a hand-eye calibration: poses of the arm (effector_wrt_world, robot) and of the target (object_wrt_sensor, tracking), or a \
                        folder with a pose in each file";
/// Endings of files with trees; in folders, files with other endings have rows of numbers.
const TREES: [&str; 4] = ["yaml", "yml", "json", "samples"];
const TEXTS: [&str; 3] = ["txt", "csv", "dat"];
/// Keys of the two parts of a pose.
const PLACES: [&str; 2] = ["translation", "position"];
const TURNS: [&str; 2] = ["rotation", "orientation"];
/// Columns of a matrix, of a position with a quaternion, and of ViSP's vectors, each with the unit of lengths of the position.
const MATRIX: [&str; 12] =
    ["r11", "r12", "r13", "r14[m]", "r21", "r22", "r23", "r24[m]", "r31", "r32", "r33", "r34[m]"];
const QUATERNION: [&str; 7] = ["x[m]", "y[m]", "z[m]", "qx", "qy", "qz", "qw"];
const VECTOR: [&str; 6] = ["x[m]", "y[m]", "z[m]", "rvec_x[rad]", "rvec_y[rad]", "rvec_z[rad]"];

/// Beginnings of libfranka's keys of frames on the flange and the tool, and keys of commanded poses: none is an actual pose of the arm.
const NOT_OF_THE_ARM: [&str; 5] = ["F_T_", "NE_T_", "EE_T_", "O_T_EE_c", "O_T_EE_d"];

/// A pose in a file.
struct PoseSample {
    whose: Option<PoseOwner>,
    columns: &'static [&'static str],
    numbers: Vec<f64>,
    /// True if lengths are millimetres.
    in_mm: bool,
    line: usize,
    /// The number of its file, or of the entry of a list that has the poses of a sample.
    sample: Option<u64>,
}

/// Poses that were found so far.
#[derive(Default)]
struct Samples {
    found: Vec<PoseSample>,
    /// Entries of lists so far.
    entries: u64,
}

/// The table of a folder or a file of samples; `None` for a file in another form.
pub(crate) fn table(path: &Path) -> Result<Option<MadeTable>> {
    let ends = |path: &Path, all: &[&str]| {
        let ending = path.extension().and_then(|it| it.to_str()).unwrap_or_default();
        all.iter().any(|it| ending.eq_ignore_ascii_case(it))
    };
    let (mut samples, mut whole) = (Samples::default(), String::new());
    if is_folder(path) {
        let is_wanted = |name: &str| {
            number_at_end(name).is_some() && (ends(Path::new(name), &TREES) || ends(Path::new(name), &TEXTS))
        };
        let (mut names, _) =
            folder::files(path, is_wanted).map_err(|error| unreadable_error(path, &error, EXPECTED))?;
        names.sort_by_cached_key(|name| (number_at_end(name), name.clone()));
        for name in names {
            let own = path.join(&name);
            let text = read_up_to(&own, EXPECTED, ResourceLimit::Settings)?;
            let before = samples.found.len();
            if ends(&own, &TREES) {
                for document in documents(&text, &own, EXPECTED)? {
                    samples.walk(&document, whose_of(&name));
                }
            } else {
                let all = text.split(|it: char| it.is_whitespace() || matches!(it, ',' | ';' | '[' | ']'));
                let numbers = all.filter(|it| !it.is_empty()).map(|it| it.parse().ok()).collect::<Option<Vec<f64>>>();
                samples.found.extend(numbers.and_then(|it| PoseSample::matrix(it, whose_of(&name), 1)));
            }
            if samples.found.len() != before + 1 {
                let message = format!(
                    "found {} poses, expected one in each file of the folder: sixteen numbers row by row, or YAML",
                    samples.found.len() - before
                );
                return Err(ErrorKind::Measurement.error(message).in_file(&own));
            }
            samples.found.iter_mut().skip(before).for_each(|it| it.sample = number_at_end(&name));
            whole.push_str(&text);
        }
    } else if ends(path, &TREES) {
        whole = read_up_to(path, EXPECTED, ResourceLimit::Table)?;
        documents(&whole, path, EXPECTED)?.iter().for_each(|it| samples.walk(it, None));
    } else {
        return Ok(None);
    }
    let made = make_table(&samples.found, is_folder(path)).map_err(|message| refuse(path, message))?;
    Ok(Some(made.of_file("samples of a hand-eye calibration", Some(sha256_of(&whole)))))
}

fn refuse(path: &Path, message: String) -> Error {
    ErrorKind::Measurement.error(message).in_file(path)
}

/// The numbers of a list, or of lists in it.
fn numbers(node: &YamlNode) -> Option<Vec<f64>> {
    let inner: Option<Vec<Vec<f64>>> = node
        .list()?
        .iter()
        .map(|it| it.text().map_or_else(|| numbers(it), |text| Some(vec![text.parse().ok()?])))
        .collect();
    Some(inner?.concat())
}

impl Samples {
    /// Takes the poses below a node.
    fn walk(&mut self, node: &YamlNode, whose: Option<PoseOwner>) {
        if let Some(sample) = PoseSample::new(node, whose) {
            return self.found.push(sample);
        }
        match &node.kind {
            NodeKind::Map(entries) => {
                let is_pose = |key: &String| !NOT_OF_THE_ARM.iter().any(|it| key.starts_with(it));
                let poses = entries.iter().filter(|(key, _)| is_pose(key));
                poses.for_each(|(key, it)| self.walk(it, whose_of(key).or(whose)));
            }
            NodeKind::List(entries) => entries.iter().for_each(|it| self.entry(it, whose)),
            NodeKind::Text(_) => {}
        }
    }

    /// Takes an entry of a list; the two poses whose keys are in it belong together.
    fn entry(&mut self, node: &YamlNode, whose: Option<PoseOwner>) {
        let before = self.found.len();
        self.walk(node, whose);
        self.entries += 1;
        let own = self.found.get_mut(before..).filter(|own| own.len() <= 2).into_iter().flatten();
        own.filter(|it| it.whose != whose && it.sample.is_none()).for_each(|it| it.sample = Some(self.entries));
    }
}

impl PoseSample {
    /// The pose of a node, if it is one.
    fn new(node: &YamlNode, whose: Option<PoseOwner>) -> Option<Self> {
        let part = |keys: [&str; 2]| keys.into_iter().find_map(|key| node.get(key));
        let Some((place, turn)) = part(PLACES).zip(part(TURNS)) else {
            if let Some(matrix) = node.get("FloatMatrix").and_then(|it| it.get("Data")) {
                return Some(PoseSample { in_mm: true, ..PoseSample::matrix(numbers(matrix)?, whose, node.line)? });
            }
            // The node has OpenCV's or ViSP's matrix, or the numbers alone.
            let numbers = numbers(node.get("data").unwrap_or(node))?;
            let columns: &[&str] = if numbers.len() == VECTOR.len() && node.get("rows").is_some() {
                &VECTOR
            } else {
                return PoseSample::matrix(numbers, whose, node.line);
            };
            return Some(PoseSample { whose, columns, numbers, in_mm: false, line: node.line, sample: None });
        };
        let parts = |of: &YamlNode, keys: &[&str]| -> Option<Vec<f64>> {
            keys.iter().map(|key| of.get(key)?.text()?.parse().ok()).collect()
        };
        let numbers = [parts(place, &["x", "y", "z"])?, parts(turn, &["x", "y", "z", "w"])?].concat();
        Some(PoseSample { whose, columns: &QUATERNION, numbers, in_mm: false, line: node.line, sample: None })
    }

    /// The pose of sixteen numbers, row by row, or column by column if the position is at the end.
    fn matrix(numbers: Vec<f64>, whose: Option<PoseOwner>, line: usize) -> Option<Self> {
        let all: [f64; 16] = numbers.try_into().ok()?;
        let row = |at: usize| [all[at], all[at + 4], all[at + 8]];
        let numbers: Vec<f64> = match (&all[12..], row(3)) {
            ([0.0, 0.0, 0.0, _], _) => all[..12].to_vec(),
            (_, [0.0, 0.0, 0.0]) => (0..3).flat_map(|at| [all[at], all[at + 4], all[at + 8], all[at + 12]]).collect(),
            _ => return None,
        };
        (all[15] == 1.0).then_some(PoseSample { whose, columns: &MATRIX, numbers, in_mm: false, line, sample: None })
    }

    /// The names of its columns.
    fn columns(&self) -> impl Iterator<Item = TableColumn> {
        let before = match self.whose {
            None => "",
            Some(PoseOwner::Arm) => "flange_",
            Some(PoseOwner::Target) => "target_",
        };
        let unit = if self.in_mm { "[mm]" } else { "[m]" };
        self.columns.iter().map(move |it| TableColumn::from(format!("{before}{}", it.replace("[m]", unit))))
    }
}

/// The table of poses: those of arm and target side by side, by the numbers of their files or in their order.
fn make_table(samples: &[PoseSample], are_files: bool) -> std::result::Result<MadeTable, String> {
    let mut rows: BTreeMap<u64, Vec<&PoseSample>> = BTreeMap::new();
    let mut counts = [0_u64; 3];
    for sample in samples {
        let count = &mut counts[sample.whose.map_or(2, |it| usize::from(it == PoseOwner::Target))];
        rows.entry(sample.sample.unwrap_or(*count)).or_default().push(sample);
        *count += 1;
    }
    rows.values_mut().for_each(|row| row.sort_by_key(|it| it.whose));
    let Some(first) = rows.values().next() else {
        return Err(format!(
            "found no pose with a place and a quaternion, and none of sixteen numbers, expected {EXPECTED}"
        ));
    };
    let is_alike = |row: &[&PoseSample]| {
        row.len() == first.len()
            && row.iter().zip(row.iter().skip(1)).all(|(one, next)| one.whose < next.whose)
            && row
                .iter()
                .zip(first)
                .all(|(one, other)| (one.whose, one.columns, one.in_mm) == (other.whose, other.columns, other.in_mm))
    };
    if first.len() > 2 || rows.values().any(|row| !is_alike(row)) {
        let [arm, target, others] = counts;
        return Err(format!(
            "found {arm} poses of the arm, {target} of the target and {others} of which nothing says whose they are, expected as many of both in one \
             form, {EXPECTED}"
        ));
    }
    let names = are_files.then(|| TableColumn::from("image"));
    let mut made = MadeTable::new(1, names.into_iter().chain(first.iter().flat_map(|it| it.columns())));
    for (number, row) in &rows {
        let name = number.to_string();
        let numbers = row.iter().flat_map(|it| it.numbers.iter().copied().map(CellValue::Number));
        let line = row.first().map_or(1, |it| it.line);
        made.row(line, are_files.then_some(CellValue::Text(&name)).into_iter().chain(numbers));
    }
    made.say(format!("{} poses, {}", rows.len(), if first.len() == 2 { "of arm and target" } else { "each alone" }));
    Ok(made)
}
