//! Files of joint readings and files of measurements, joined row with row (docs/file-formats.md, *Two files*).

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::corner_columns::{are_corners, are_readings_of_pictures};
use super::inputs::InputReader;
use super::layout::ColumnLayout;
use super::mapping::{ColumnMap, ColumnSpec};
use super::messages::are_messages;
use super::number::Numbers;
use super::picture_names::same_numbers;
use super::read::Reader;
use super::scale::JointWatch;
use super::table::{Table, refuse_more_rows};
use super::text::Blocks;
use super::understanding::{self, FileUnderstanding};
use super::{Frames, Join, LostBeams, ReadOptions};
use crate::error::{Error, ErrorKind, Result, first_few};
use crate::forensics::{DiagnosisOptions, diagnose};
use crate::io::disk::is_file;
use crate::measurement::Dataset;
use crate::robot::{Controller, ReadingKind, Robot};
use crate::start::{Agreement, Aligned, Order, Pair, Unpaired};

/// What a file has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    /// Joint readings and nothing that was measured.
    Joints,
    /// What was measured, without joint readings; whether it names its targets.
    Measured { is_named: bool },
    /// All that belongs together, or something else.
    Whole,
}

/// Joint readings of a file.
#[derive(Clone, Debug)]
pub(super) struct JointRows {
    path: PathBuf,
    readings: Vec<f64>,
    ids: Vec<String>,
    lines: Vec<usize>,
    controller: Option<Controller>,
}

/// The readings of each line of a file of measurements, from another file.
#[derive(Clone, Debug, Default)]
pub(super) struct ReadingsByLine {
    pub(super) lines: BTreeMap<usize, Vec<f64>>,
    /// How they are made of columns.
    pub(super) controller: Option<Controller>,
}

/// Files of which some have the joint readings of others.
pub(super) struct Plan<'p> {
    files: Vec<Planned<'p>>,
}

struct Planned<'p> {
    path: &'p Path,
    part: Part,
    /// How one without readings is read.
    map: ColumnMap,
}

impl<'p> Plan<'p> {
    /// The plan of files, if there are some to join.
    pub(super) fn of(
        paths: &[&'p Path],
        robot: &Robot,
        options: &ReadOptions,
        map: &ColumnMap,
    ) -> Option<Self> {
        let parts: Vec<Part> = paths.iter().map(|path| part(path, robot, options, map)).collect();
        let measured = parts.iter().filter(|it| matches!(it, Part::Measured { .. })).count();
        let joints = parts.iter().filter(|it| **it == Part::Joints).count();
        if joints == 0 || measured == 0 {
            return None;
        }
        let several = joints == 1 && measured > 1;
        let planned = |(path, part): (&&'p Path, Part)| {
            let mut map = without_joints(map, robot);
            // Several files that were measured at the same configurations are of several targets, or of several instruments.
            if several && part == (Part::Measured { is_named: false }) && options.frames == Frames::Common {
                map.target_name = path.file_stem().map(|it| it.to_string_lossy().into_owned());
            }
            Planned { path, part, map }
        };
        Some(Plan { files: paths.iter().zip(parts).map(planned).collect() })
    }
}

/// What a file has; one that cannot be read is named when it is.
fn part(path: &Path, robot: &Robot, options: &ReadOptions, map: &ColumnMap) -> Part {
    // A pipe is read once.
    if !is_file(path) {
        return Part::Whole;
    }
    let kind = || -> Result<Part> {
        let mut blocks = Blocks::open(path, "a measurement file (CSV)")?;
        blocks.begin()?;
        if are_messages(path, blocks.text())? {
            return Ok(Part::Whole);
        }
        let table = Table::open(path, blocks, map)?;
        let names = robot.reading_names();
        if are_corners(&table.header, &names, map)?
            || !options.cameras.is_empty() && are_readings_of_pictures(&table.header, &names, map)
        {
            return Ok(Part::Whole);
        }
        let joints = ColumnLayout::joints(&table.header, robot, options, map).is_ok();
        let measured = ColumnLayout::new(&table.header, robot, options, &without_joints(map, robot));
        Ok(match (joints, measured) {
            (true, Err(_)) => Part::Joints,
            (false, Ok(layout)) => {
                let is_named =
                    layout.target_column.is_some() || layout.targets.len() > 1 || map.target_name.is_some();
                Part::Measured { is_named }
            }
            (true, Ok(_)) | (false, Err(_)) => Part::Whole,
        })
    };
    kind().unwrap_or(Part::Whole)
}

/// A mapping of a file that has no readings: those of joints are numbers that mean nothing.
fn without_joints(map: &ColumnMap, robot: &Robot) -> ColumnMap {
    let names = robot.reading_names();
    let joints = names.into_iter().filter(|name| robot.reading_kind(name) != ReadingKind::Factor);
    let zero = || ColumnSpec { value: Some(0.0), ..ColumnSpec::default() };
    let mut own = map.clone();
    (own.joints, own.third_axis) = (joints.map(|name| (name, zero())).collect(), None);
    own
}

impl<'a> Reader<'a> {
    /// Reads files of which some have the joint readings of others: each those of the files behind it, up to the next file of readings; the first
    /// ones also those of files before them.
    pub(super) fn joined(&mut self, plan: &'a Plan<'_>) -> Result<()> {
        let first = plan.files.iter().find(|it| it.part == Part::Joints).map(|it| it.path);
        let mut joints = first.map(|path| self.joint_rows(path)).transpose()?;
        for Planned { path, part, map } in &plan.files {
            match (part, &joints) {
                (Part::Joints, Some(known)) if known.path == *path => {}
                (Part::Joints, _) => joints = Some(self.joint_rows(path)?),
                (Part::Measured { .. }, Some(known)) => self.measured(path, &known.clone(), map)?,
                (Part::Measured { .. }, None) | (Part::Whole, _) => {
                    self.file(path, Blocks::open(path, "a measurement file (CSV)")?)?;
                }
            }
        }
        Ok(())
    }

    /// Reads a file of joint readings alone.
    fn joint_rows(&mut self, path: &Path) -> Result<JointRows> {
        let mut table = Table::open(path, Blocks::open(path, "a file of joint readings (CSV)")?, self.map)?;
        let layout = ColumnLayout::joints(&table.header, self.robot, self.options, self.map)?;
        let numbers = Numbers::new(self.map.decimal);
        let mut inputs = InputReader::new(&layout.inputs, layout.inputs.len(), numbers);
        let mut watch = JointWatch::new(self.robot);
        let mut found = JointRows {
            path: path.to_path_buf(),
            readings: Vec::new(),
            ids: Vec::new(),
            lines: Vec::new(),
            controller: layout.controller.clone(),
        };
        while let Some(mut rows) = table.next_block()? {
            while let Some(row) = rows.next()? {
                inputs.read(&row)?;
                watch.unwind(&row, &mut inputs);
                inputs.include_in_ranges();
                watch.observe(&row, &inputs);
                inputs.take_readings(&row)?;
                found.readings.extend_from_slice(inputs.readings());
                found.lines.push(row.line);
                refuse_more_rows(found.lines.len(), &row)?;
                if let Some(cell) = layout.id.and_then(|id| row.cells.get(id)) {
                    found.ids.push(cell.text().trim().to_owned());
                }
            }
        }
        if found.lines.is_empty() {
            let message = "found a header and no rows, expected at least one row of joint readings";
            return Err(ErrorKind::Measurement.error(message).at_line(path, table.header.line));
        }
        self.found.warnings.extend(watch.finish(path, &layout, &inputs.ranges)?);
        let own = |words: String| format!("{}: {words}", path.display());
        self.found.warnings.extend(layout.joint_words().into_iter().map(own));
        self.warn_of_ignored(path, &layout);
        self.take_controller(path, &layout)?;
        self.found.sha256.extend(table.sha256().map(|sha256| (path.display().to_string(), sha256)));
        self.found.understood.push(FileUnderstanding {
            path: path.to_path_buf(),
            rows: found.lines.len(),
            points: 0,
            poses: 0,
            others: BTreeMap::from([("joint readings", found.lines.len())]),
            lost: LostBeams::default(),
            separator: table.separator,
            separator_line: table.separator_line,
            units_line: table.header.units_line,
            decimal_sign: inputs.numbers.sign(),
            columns: understanding::columns(&table.header, &layout, &inputs.ranges),
            orientation: None,
            pose: understanding::pose_word(layout.pose),
            ignored: layout.ignored.iter().map(|(name, _)| name.clone()).collect(),
        });
        Ok(found)
    }

    /// Reads a file of measurements alone, with the readings of another.
    fn measured(&mut self, path: &Path, joints: &JointRows, unread: &'a ColumnMap) -> Result<()> {
        let data = self.without_readings(path, unread)?;
        let rows = Unpaired::new(self.robot, &joints.readings, &data);
        let found =
            Pairing { joints, path, data: &data, rows, robot: self.robot }.found(self.options.join)?;
        self.found.notes.extend(found.notes);
        self.found.warnings.extend(found.warnings);
        // The same again, with the readings of each line.
        let usual = std::mem::replace(&mut self.map, unread);
        self.readings = Some(found.readings);
        let read = Blocks::open(path, "a measurement file (CSV)").and_then(|blocks| self.file(path, blocks));
        (self.map, self.readings) = (usual, None);
        read
    }

    /// What was measured, with readings that mean nothing.
    fn without_readings(&self, path: &Path, map: &'a ColumnMap) -> Result<Dataset> {
        let mut reader = Reader { map, ..Reader::new(self.robot, self.options, map) };
        reader.rows_alone(path)?;
        Ok(reader.found.data)
    }
}

/// A file of joint readings and one of measurements.
struct Pairing<'a> {
    joints: &'a JointRows,
    path: &'a Path,
    data: &'a Dataset,
    rows: Unpaired<'a>,
    robot: &'a Robot,
}

/// Readings by line, and what is said of them.
struct Joined {
    readings: ReadingsByLine,
    notes: Vec<String>,
    warnings: Vec<String>,
}

impl Pairing<'_> {
    fn found(&self, join: Option<Join>) -> Result<Joined> {
        let by_names = if join == Some(Join::Rows) { None } else { self.by_names() };
        let (joints, shots) = (self.rows.joint_rows(), self.rows.shots().len());
        match (join, by_names) {
            (Some(Join::Name), None) => self.refuse(
                "found no name that is in both, expected a column `id` in each, with the same names, or names that end in the same number"
                    .to_owned(),
            ),
            (_, Some(pairs)) => match self.judged(&pairs, "name", join.is_some()) {
                // Numbers may count the points only.
                Err(_) if join.is_none() => self.by_rows(None),
                judged => judged,
            },
            (Some(Join::Rows), None) if joints != shots => self.by_alignment(),
            (_, None) => self.by_rows(join),
        }
    }

    fn by_rows(&self, join: Option<Join>) -> Result<Joined> {
        let (joints, shots) = (self.rows.joint_rows(), self.rows.shots().len());
        if joints != shots {
            return self.by_alignment();
        }
        let pairs: Vec<Pair> = (0..joints).map(|row| (row, row)).collect();
        self.judged(&pairs, "row by row", join.is_some())
    }

    /// The error of files that cannot be joined.
    fn refuse<T>(&self, message: String) -> Result<T> {
        let words = format!("{message} ({} has the joint readings)", self.joints.path.display());
        Err(Error::new(ErrorKind::Measurement, words).in_file(self.path))
    }

    /// Pairs of the same names, or of names that end in the same number.
    fn by_names(&self) -> Option<Vec<Pair>> {
        let name_of = |shot: &Vec<u32>| self.data.ids.get(*shot.first()? as usize);
        let seen: Vec<Option<&String>> = self.rows.shots().iter().map(name_of).collect();
        let own: BTreeSet<&String> = seen.iter().flatten().copied().filter(|it| !it.is_empty()).collect();
        let others: BTreeSet<&String> = self.joints.ids.iter().filter(|it| !it.is_empty()).collect();
        // A name that comes twice names no row.
        if others.len() != self.joints.ids.iter().filter(|it| !it.is_empty()).count() {
            return None;
        }
        let alike: BTreeMap<&String, &String> = same_numbers(&own, &others).into_iter().collect();
        let row_of = |name: &String| {
            let other = others.get(name).or_else(|| alike.get(name))?;
            self.joints.ids.iter().position(|it| it == *other)
        };
        let pairs: Vec<Pair> = (seen.iter().enumerate())
            .filter_map(|(shot, name)| Some((row_of(name.as_ref()?)?, shot)))
            .collect();
        (2 * pairs.len() >= seen.len() && !pairs.is_empty()).then_some(pairs)
    }

    /// Pairs of one order, if the nominal robot agrees with them and with no other order; `is_stated` where the user said that they are right.
    fn judged(&self, pairs: &[Pair], how: &str, is_stated: bool) -> Result<Joined> {
        let (joints, path) = (self.joints.path.display(), self.path.display());
        let by_name = if how == "name" { "by name" } else { how };
        let found = self.rows.agreement(pairs);
        let mm = |metres: f64| format!("{:.3} mm", 1e3 * metres);
        let mut warnings = Vec::new();
        match found {
            Some(Agreement::Other { missed_m, order, other_m }) => {
                return self.refuse(format!(
                    "found measurements that the nominal robot misses by {} (median) if they are joined {by_name}, and by {} {}, expected no other \
                     order to fit better: {}",
                    mm(missed_m),
                    mm(other_m),
                    words(order),
                    advice(order)
                ));
            }
            Some(Agreement::Alike { missed_m, order, other_m }) => {
                let message = format!(
                    "the nominal robot misses the measurements by {} (median) if they are joined {by_name}, and by {} {}, which is no evident difference",
                    mm(missed_m),
                    mm(other_m),
                    words(order)
                );
                if !is_stated {
                    return self.refuse(format!(
                        "found files that can be joined in two ways: {message}; state the order by --join {}, or give both files a column `id`",
                        if how == "name" { "name" } else { "rows" }
                    ));
                }
                warnings.push(format!("{joints}, {path}: {message}"));
            }
            Some(Agreement::None { missed_m }) => {
                let reason = self.diagnosis(pairs).unwrap_or_else(|| {
                    "look at the units, the signs and the order of joints and measurements".to_owned()
                });
                let message = format!(
                    "the nominal robot misses the measurements by {} (median) if they are joined {by_name}, no less than by chance: {reason}",
                    mm(missed_m)
                );
                if !is_stated {
                    return self.refuse(format!("found measurements that do not fit the joint readings: {message}"));
                }
                warnings.push(format!("{joints}, {path}: {message}"));
            }
            None => warnings.push(format!(
                "{joints}, {path}: nothing shows whether the rows belong together: too few, or of a kind that one frame does not place"
            )),
            Some(Agreement::Right { .. }) => {}
        }
        self.refuse_exchanged(pairs)?;
        let missed = match found {
            Some(Agreement::Right { missed_m }) => {
                format!(
                    "; the nominal robot misses them by {} (median), and by more than twice that in any other order",
                    mm(missed_m)
                )
            }
            _ => String::new(),
        };
        let note =
            format!("{joints} and {path} were joined {by_name}: {} configurations{missed}", pairs.len());
        warnings.extend(self.left_out(pairs));
        Ok(Joined { readings: self.readings(pairs), notes: vec![note], warnings })
    }

    /// Refuses rows that fit each other's readings.
    fn refuse_exchanged(&self, pairs: &[Pair]) -> Result<()> {
        let exchanged = self.rows.exchanged(pairs);
        let Some((one, other)) = exchanged.first() else { return Ok(()) };
        let (Some(one), Some(other)) = (pairs.get(*one), pairs.get(*other)) else { return Ok(()) };
        let all: BTreeSet<usize> = exchanged.iter().filter_map(|it| Some(pairs.get(it.0)?.1)).collect();
        self.refuse(format!(
            "found the measurements of {} in another order than their joint readings, as {} that fits the readings of {}, expected the same order: \
             exchange them",
            self.shot_lines(&all.into_iter().collect::<Vec<_>>()),
            self.shot_lines(&[one.1]),
            self.joint_lines(&[other.0])
        ))
    }

    /// What a diagnosis of mistakes says of pairs.
    fn diagnosis(&self, pairs: &[Pair]) -> Option<String> {
        let data = self.rows.session_of(pairs);
        let found = diagnose(self.robot, &data, &data.all_rows(), &DiagnosisOptions::default());
        found.first().map(|it| it.statement.clone())
    }

    /// What has no partner.
    fn left_out(&self, pairs: &[Pair]) -> Vec<String> {
        let joints: BTreeSet<usize> = pairs.iter().map(|it| it.0).collect();
        let shots: BTreeSet<usize> = pairs.iter().map(|it| it.1).collect();
        let alone = (0..self.rows.joint_rows()).filter(|it| !joints.contains(it)).collect::<Vec<_>>();
        let unread = (0..self.rows.shots().len()).filter(|it| !shots.contains(it)).collect::<Vec<_>>();
        let mut said = Vec::new();
        if !alone.is_empty() {
            said.push(format!(
                "{}: nothing was measured at {}",
                self.joints.path.display(),
                self.joint_lines(&alone)
            ));
        }
        if !unread.is_empty() {
            said.push(format!(
                "{}: left out {}, which have no joint readings",
                self.path.display(),
                self.shot_lines(&unread)
            ));
        }
        said
    }

    /// Lists of unequal length, by the errors of the nominal robot.
    fn by_alignment(&self) -> Result<Joined> {
        let (joints, shots) = (self.rows.joint_rows(), self.rows.shots().len());
        let counts = format!("found {shots} measured configurations and {joints} rows of joint readings");
        let Some(found) = self.rows.aligned() else {
            return self.refuse(format!(
                "{counts}, expected as many, or names in both (a column `id`): nothing shows which belong together"
            ));
        };
        let Aligned { pairs, unmeasured, repeated, unread, unclear, missed_m } = &found;
        if 2 * pairs.len() < shots.min(joints) {
            return self.refuse(format!(
                "{counts}, expected as many, or names in both (a column `id`): only {} of them fit the nominal robot in this order",
                pairs.len()
            ));
        }
        if let Some(Agreement::None { .. } | Agreement::Other { .. } | Agreement::Alike { .. }) =
            self.rows.agreement(pairs)
        {
            return self.refuse(format!(
                "{counts}, expected as many, or names in both (a column `id`): no order fits evidently better than others"
            ));
        }
        let mut warnings = Vec::new();
        let (own, path) = (self.joints.path.display(), self.path.display());
        if !unmeasured.is_empty() {
            warnings.push(format!("{own}: nothing was measured at {}", self.joint_lines(unmeasured)));
        }
        if !repeated.is_empty() {
            warnings.push(format!("{own}: more than once was measured at {}", self.joint_lines(repeated)));
        }
        if !unread.is_empty() {
            warnings
                .push(format!("{path}: left out {}, which fit no joint readings", self.shot_lines(unread)));
        }
        if !unclear.is_empty() {
            warnings.push(format!(
                "{path}: left out {}, which fit two neighbouring rows of joint readings",
                self.shot_lines(unclear)
            ));
        }
        let note = format!(
            "{own} and {path} were joined in their order, since they have {joints} and {shots} rows: {} configurations; the nominal robot misses them by \
             {:.3} mm (median)",
            pairs.len(),
            1e3 * missed_m
        );
        Ok(Joined { readings: self.readings(pairs), notes: vec![note], warnings })
    }

    fn readings(&self, pairs: &[Pair]) -> ReadingsByLine {
        let mut found =
            ReadingsByLine { controller: self.joints.controller.clone(), ..ReadingsByLine::default() };
        for (joint, shot) in pairs {
            for &row in self.rows.shots().get(*shot).into_iter().flatten() {
                if let Some(observation) = self.data.observations.get(row as usize) {
                    found.lines.insert(observation.source.line as usize, self.rows.readings(*joint).to_vec());
                }
            }
        }
        found
    }

    fn joint_lines(&self, rows: &[usize]) -> String {
        let lines: Vec<String> =
            rows.iter().filter_map(|row| self.joints.lines.get(*row)).map(ToString::to_string).collect();
        numbered(&lines)
    }

    fn shot_lines(&self, shots: &[usize]) -> String {
        let line = |shot: &usize| {
            let row = *self.rows.shots().get(*shot)?.first()?;
            Some(self.data.observations.get(row as usize)?.source.line.to_string())
        };
        numbered(&shots.iter().filter_map(line).collect::<Vec<_>>())
    }
}

/// Lines in words.
fn numbered(lines: &[String]) -> String {
    format!("{} {}", if lines.len() == 1 { "line" } else { "lines" }, first_few(lines))
}

/// An order in words.
fn words(order: Order) -> String {
    let rows = |by: usize| if by == 1 { "one row".to_owned() } else { format!("{by} rows") };
    match order {
        Order::MeasuredLater(by) => format!("with the measurements {} later", rows(by)),
        Order::JointsLater(by) => format!("with the joint readings {} later", rows(by)),
        Order::Reversed => "in reverse order".to_owned(),
    }
}

/// What to do where an order fits better.
fn advice(order: Order) -> String {
    let rows = |by: usize| if by == 1 { "the first row".to_owned() } else { format!("the first {by} rows") };
    match order {
        Order::MeasuredLater(by) => format!("remove {} of the joint readings", rows(by)),
        Order::JointsLater(by) => format!("remove {} of the measurements", rows(by)),
        Order::Reversed => "turn one of the files round".to_owned(),
    }
}
