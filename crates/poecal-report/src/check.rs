//! Interpretation of a model and of measurement files.

use std::borrow::Cow;
use std::fmt::Write as _;

use serde::Serialize;

use super::sight::SightCheck;
use super::table::{format_short, format_triple, kinds_words, line, lines, robot_words};
use poecal_fit::forensics::Diagnosis;
use poecal_import::{
    ColumnUnderstanding, DecimalSign, FileUnderstanding, JoinEntry, MeasurementFile, Separator, lost_words,
};
use poecal_model::measurement::Set;
use poecal_model::robot::{Joint, JointKind, Mount, Robot};
use poecal_numerics::error::first_few;
use poecal_numerics::named_unit::{NamedUnit, UnitSource};
use poecal_numerics::text::escape_invisible;
use poecal_numerics::unit::Unit;
use poecal_results::calibration_file::{BodyEntry, MassEntry, PoseEntry};
use poecal_results::model::{Model, ModelSource};

/// Widest name of a quantity, and of a column, that the table of columns keeps on one line.
const WIDEST: usize = 22;

/// Interpretation of a model and measurements, for a person to look over or a machine to read.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    model: ModelCheck,
    files: Vec<FileUnderstanding>,
    /// Joins of files of joint readings with files of measurements.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    joins: Vec<JoinEntry>,
    sets: Option<SetCounts>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    notes: Vec<String>,
    warnings: Vec<String>,
    /// Visible pairs of instruments and targets, for a robot with branches or with instruments and targets on named bodies.
    #[serde(skip_serializing_if = "Option::is_none")]
    sight: Option<SightCheck>,
    /// Mistakes that the measurements show.
    diagnosis: Vec<Diagnosis>,
    #[serde(skip)]
    robot_words: String,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct ModelCheck {
    path: String,
    form: &'static str,
    name: String,
    base: String,
    tip: String,
    joints: Vec<JointCheck>,
    base_from_tip_at_zero: PoseEntry,
    targets: Vec<TargetCheck>,
    /// Targets with bodies of their own, and instruments on the robot.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    mounted: Vec<MountCheck>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    instruments: Vec<MountCheck>,
    /// Masses of the links that joints move.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    masses: Vec<MassEntry>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct JointCheck {
    name: String,
    kind: &'static str,
    direction: [f64; 3],
    /// A point of the axis, metres; `None` for a slide.
    point_m: Option<[f64; 3]>,
    limits: Option<[f64; 2]>,
    reading: String,
    multiplier: f64,
    offset: f64,
    /// The body that carries it, if that is not the link of the joint before.
    #[serde(skip_serializing_if = "Option::is_none")]
    on: Option<BodyEntry>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct TargetCheck {
    name: String,
    tip_from_target: PoseEntry,
}

/// Numbers of rows by their stated set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct SetCounts {
    /// Measurements to be fitted.
    pub fit: usize,
    /// Measurements to be held out.
    pub held_out: usize,
    /// Measurements without a stated set.
    pub unstated: usize,
}

impl Check {
    /// Interpretation of a model, and of measurements with their diagnosis if there are some.
    #[must_use]
    pub fn new(model: &Model, measurements: Option<&MeasurementFile>, diagnosis: &[Diagnosis]) -> Self {
        let robot = &model.robot;
        Check {
            model: ModelCheck {
                path: model.path.display().to_string(),
                form: match &model.source {
                    ModelSource::Urdf(document) => document.form(),
                    ModelSource::Toml => "TOML",
                    ModelSource::Calibration(_) => "calibration",
                },
                name: robot.name.clone(),
                base: robot.base_name.clone(),
                tip: robot.tip_name.clone(),
                joints: robot.joints.iter().map(|joint| JointCheck::from_joint(robot, joint)).collect(),
                base_from_tip_at_zero: (&robot.home).into(),
                targets: robot
                    .targets
                    .iter()
                    .map(|(name, pose)| TargetCheck { name: name.clone(), tip_from_target: pose.into() })
                    .collect(),
                mounted: MountCheck::all_from_mounts(robot, &robot.mounted),
                instruments: MountCheck::all_from_mounts(robot, &robot.instruments),
                masses: MassEntry::all_from_robot(robot),
            },
            files: measurements.map_or_else(Vec::new, |file| file.understood.clone()),
            joins: measurements.map_or_else(Vec::new, |file| file.joins.clone()),
            sets: measurements.map(SetCounts::from_measurements),
            sight: SightCheck::from_robot(robot, measurements.map(|file| &file.data)),
            notes: measurements.map_or_else(Vec::new, |file| file.notes.clone()),
            warnings: {
                let doubts = model.doubts().into_iter().chain(robot.placeholder_limits());
                let of_model = doubts.map(|it| format!("{}: {it}", model.path.display()));
                of_model.chain(measurements.map_or_else(Vec::new, |file| file.warnings.clone())).collect()
            },
            diagnosis: diagnosis.to_vec(),
            robot_words: robot_words(robot),
        }
    }

    /// Summary of the input, and the first mistake that it shows, in a sentence.
    #[must_use]
    pub fn answer(&self) -> String {
        let Some(SetCounts { fit, held_out, unstated }) = self.sets else { return self.robot_words.clone() };
        let read = match fit + held_out + unstated {
            1 => "1 row".to_owned(),
            rows => format!("{rows} rows"),
        };
        match self.diagnosis.as_slice() {
            [] => format!("{read}, no mistake found"),
            [one] => format!("{read}, 1 mistake: {}", one.statement),
            [first, more @ ..] => format!("{read}, {} mistakes: {}; …", 1 + more.len(), first.statement),
        }
    }

    /// As text of lines up to 80 characters (except for longer names).
    #[must_use]
    pub fn text(&self) -> String {
        let mut out = String::new();
        let model = &self.model;
        line(&mut out, "model", &format!("{} ({})", model.path, model.form));
        line(&mut out, "robot", &self.robot_words);
        lines(&mut out, "joints", model.joints.iter().map(JointCheck::words));
        line(&mut out, "tip at zero", &pose_words(&model.base_from_tip_at_zero));
        let words = |it: &TargetCheck| format!("{}: {} in the tip frame", it.name, pose_words(&it.tip_from_target));
        let targets = model.targets.iter().map(words);
        lines(&mut out, "targets", targets.chain(model.mounted.iter().map(MountCheck::words)));
        lines(&mut out, "instruments", model.instruments.iter().map(MountCheck::words));
        if !model.masses.is_empty() {
            let all: f64 = model.masses.iter().map(|mass| mass.mass_kg).sum();
            line(&mut out, "masses", &format!("{} of the moving links, {all:.1} kg in all", model.masses.len()));
        }
        if let Some(sight) = &self.sight {
            lines(&mut out, "ways", sight.words());
            lines(&mut out, "unseen", sight.unseen_words());
        }
        for file in &self.files {
            out.push('\n');
            file_text(&mut out, file);
        }
        if let Some(sets) = self.sets {
            out.push('\n');
            line(&mut out, "sets", &sets.words());
        }
        lines(&mut out, "notes", &self.notes);
        lines(&mut out, "warnings", &self.warnings);
        lines(&mut out, "diagnosis", self.diagnosis.iter().map(|found| &found.statement));
        out
    }
}

/// An instrument or a target on a body.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct MountCheck {
    name: String,
    on: BodyEntry,
    base_from_frame_at_zero: PoseEntry,
}

impl MountCheck {
    fn all_from_mounts(robot: &Robot, mounts: &[Mount]) -> Vec<Self> {
        let of = |mount: &Mount| MountCheck {
            name: mount.name.clone(),
            on: BodyEntry::from_body(robot, mount.body),
            base_from_frame_at_zero: (&robot.base_from(mount)).into(),
        };
        mounts.iter().map(of).collect()
    }

    fn words(&self) -> String {
        format!(
            "{}: on {}, at zero {} in the base",
            self.name,
            body_words(&self.on),
            pose_words(&self.base_from_frame_at_zero)
        )
    }
}

/// A body in words.
fn body_words(body: &BodyEntry) -> String {
    match body {
        BodyEntry::Base => "the base".to_owned(),
        BodyEntry::LinkOf(joint) => format!("the link of {joint}"),
    }
}

impl JointCheck {
    fn from_joint(robot: &Robot, joint: &Joint) -> Self {
        let point = match joint.kind {
            JointKind::Revolute => Some(joint.screw.nearest_point(&joint.frame.translation).into()),
            JointKind::Prismatic => None,
        };
        JointCheck {
            name: joint.name.clone(),
            kind: joint.kind.word(),
            direction: joint.screw.direction().into(),
            point_m: point,
            limits: joint.limits.map(|limits| [limits.lower, limits.upper]),
            reading: joint.reading.name.clone(),
            multiplier: joint.reading.multiplier,
            offset: joint.reading.offset,
            on: joint.stands_on.map(|body| BodyEntry::from_body(robot, body)),
        }
    }

    fn words(&self) -> String {
        let direction = format_triple(self.direction, 1.0, 6);
        let (place, factor, unit) = match self.point_m {
            Some(point) => {
                (format!("about {direction} through {} mm", format_triple(point, 1e3, 3)), 1f64.to_degrees(), "deg")
            }
            None => (format!("along {direction}"), 1e3, "mm"),
        };
        let limits = match self.limits {
            Some([lower, upper]) => {
                format!("from {} to {} {unit}", format_short(lower * factor, 3), format_short(upper * factor, 3))
            }
            None => "no limits".to_owned(),
        };
        let mut words = format!("{}: {} {place}, {limits}", self.name, self.kind);
        if self.reading != self.name || self.multiplier != 1.0 || self.offset != 0.0 {
            let offset = format_short(self.offset * factor, 6);
            let _ = write!(words, "; value = {} * reading of {} + {offset} {unit}", self.multiplier, self.reading);
        }
        if let Some(on) = &self.on {
            let _ = write!(words, "; on {}", body_words(on));
        }
        words
    }
}

fn pose_words(pose: &PoseEntry) -> String {
    let position = format_triple(pose.position_m, 1e3, 3);
    if let [0.0, 0.0, 0.0, _] = pose.quaternion_xyzw {
        return format!("{position} mm");
    }
    let parts = pose.quaternion_xyzw.map(|part| format_short(part, 6)).join(", ");
    format!("{position} mm, quaternion x, y, z, w ({parts})")
}

impl SetCounts {
    fn from_measurements(file: &MeasurementFile) -> Self {
        let count = |set| file.data.observations.iter().filter(|row| row.set == set).count();
        SetCounts { fit: count(Some(Set::Fit)), held_out: count(Some(Set::HeldOut)), unstated: count(None) }
    }

    fn words(self) -> String {
        let SetCounts { fit, held_out, unstated } = self;
        if fit + held_out == 0 {
            return "not stated: `poecal calibrate` chooses what it holds out (--held-out, --seed)".to_owned();
        }
        let rest = if unstated > 0 { format!(", {unstated} not stated (fitted)") } else { String::new() };
        format!("{fit} to fit, {held_out} held out{rest}")
    }
}

fn file_text(out: &mut String, file: &FileUnderstanding) {
    let separator = match file.separator {
        Separator::Comma => "comma",
        Separator::Semicolon => "semicolon",
        Separator::Tab => "tab",
        Separator::Whitespace => "blanks",
    };
    let decimal = match file.decimal_sign {
        DecimalSign::Point => "point",
        DecimalSign::Comma => "comma",
    };
    line(out, "file", &file.path.display().to_string());
    let others = file.others.iter().map(|(name, count)| format!("{count} of {name}"));
    let poses = (file.poses + file.points > 0).then(|| kinds_words(file.poses, file.points));
    let kinds: Vec<String> = poses.into_iter().chain(others).collect();
    line(out, "rows", &format!("{}: {}", file.rows, kinds.join(" and ")));
    if let Some(lost) = lost_words(&file.lost) {
        line(out, "skipped", &lost);
    }
    let stated = file.separator_line.map_or_else(String::new, |line| format!(" (line {line})"));
    let units = file.units_line.map_or_else(String::new, |line| format!("; units: line {line}"));
    match file.form {
        // Separators of the converted table carry no information.
        Some(form) => line(out, "form", &format!("{form}{units}")),
        None => line(out, "form", &format!("separator: {separator}{stated}; decimal sign: {decimal}{units}")),
    }
    if let Some(orientation) = &file.orientation {
        line(out, "orientation", &format!("{orientation}; {}", file.pose));
    }
    let widest = |lengths: &mut dyn Iterator<Item = usize>| lengths.max().unwrap_or(0).min(WIDEST);
    let ours = widest(&mut file.columns.iter().map(|column| width(&escape_invisible(&column.name)))).max(8);
    let theirs = widest(&mut file.columns.iter().map(|column| width(&column_words(column)))).max(13);
    let units = widest(&mut file.columns.iter().map(|column| width(&unit_words(column)))).max(12);
    let mut row = |name: &str, column: &str, unit: &str, range: &str| {
        // A long name moves the rest of its row to a line of its own.
        let broken = if width(name) > ours || width(column) > theirs {
            format!("\n  {:ours$}  {:theirs$}", "", "")
        } else {
            String::new()
        };
        let text = format!("  {name:<ours$}  {column:<theirs$}{broken}  {unit:<units$}  {range}");
        out.push_str(text.trim_end());
        out.push('\n');
    };
    row("column", "read from", "unit", "values");
    for column in &file.columns {
        row(&escape_invisible(&column.name), &column_words(column), &unit_words(column), &range_words(column));
    }
    if !file.ignored.is_empty() {
        line(out, "ignored", &first_few(&file.ignored));
    }
}

fn width(text: &str) -> usize {
    text.chars().count()
}

fn column_words(column: &ColumnUnderstanding) -> Cow<'_, str> {
    escape_invisible(column.column.as_deref().unwrap_or("(constant)"))
}

fn unit_words(column: &ColumnUnderstanding) -> String {
    let Some(unit) = column.unit else { return String::new() };
    match column.unit_from {
        Some(UnitSource::Header) => format!("{unit}, header"),
        Some(UnitSource::UnitsLine) => format!("{unit}, units line"),
        Some(UnitSource::Mapping) => format!("{unit}, mapping"),
        Some(UnitSource::Maker) => format!("{unit}, its maker's"),
        Some(UnitSource::Si) => format!("{unit}, SI"),
        None => unit.to_owned(),
    }
}

/// Smallest and largest value, in millimetres or degrees.
fn range_words(column: &ColumnUnderstanding) -> String {
    let (Some(min), Some(max)) = (column.min, column.max) else { return String::new() };
    let quantity = column.unit.and_then(|unit| NamedUnit::parse_any(unit).ok()).map(NamedUnit::si_unit);
    let (factor, unit) = match quantity {
        Some(Unit::Metre) => (1e3, " mm"),
        Some(Unit::Radian) => (1f64.to_degrees(), " deg"),
        Some(Unit::One | Unit::Second) | None => (1.0, ""),
    };
    let (min, max) = (format_short(min * factor, 3), format_short(max * factor, 3));
    if min == max { format!("{min}{unit}") } else { format!("{min} to {max}{unit}") }
}
