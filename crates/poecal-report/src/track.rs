//! Detection of a robot's drift, for a person to look over or a machine to read.

use serde::Serialize;

use super::table::line;
use super::track_entries::{
    ExplanationEntry, InvisibleEntry, SightEntry, UsageLevel, in_page_unit, sight_table, to_do,
};
use poecal_model::robot::JointKind;
use poecal_numerics::text::escape_invisible;
use poecal_results::calibration_file::{CalibrationFile, RepairedPart};
use poecal_results::record::Record;
use poecal_results::track::{JudgingBasis, RecalibratedJoint, RobotCondition, VisitResult, Witnesses};
use poecal_results::validation::{TRACK, ValidationInputs};

/// A visit with its references.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrackReport {
    /// Name and version of this schema.
    pub schema: &'static str,
    /// Version that judged.
    pub poecal_version: &'static str,
    /// The robot's name.
    pub robot: String,
    /// The judged calibration and the measurements that judge it.
    pub inputs: ValidationInputs,
    /// Statements about the visit, not about the calibration's session.
    #[serde(skip_serializing_if = "Record::is_empty")]
    pub record: Record,
    state: RobotCondition,
    judged_by: JudgingBasis,
    /// Stated position of the measuring device and mounting of the tool: words of `--device` and `--tool`.
    device: &'static str,
    tool: &'static str,
    pub(crate) rows: usize,
    repeated: usize,
    explanation: Option<ExplanationEntry>,
    alternatives: Vec<ExplanationEntry>,
    /// Joints without a visible shift of their zeros.
    pub(crate) invisible: Vec<InvisibleEntry>,
    pub(crate) joints: Vec<SightEntry>,
    /// Root mean square change of measured positions beside the free unknowns, millimetres.
    pub(crate) change_mm: f64,
    /// Root mean square change that the explanation leaves.
    left_mm: f64,
    /// Standard deviation of a coordinate of such a change, millimetres, and its degrees of freedom; null for a known one.
    pub(crate) noise_mm: f64,
    freedom: Option<f64>,
    /// Root mean square error of the delivered model in this visit, millimetres.
    pub(crate) error_mm: f64,
    pub(crate) notes: Vec<String>,
}

/// Detectable shifts of repeats of chosen configurations.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WitnessPlan {
    robot: String,
    configurations: usize,
    /// True if they are new, and no earlier visit has them.
    are_new: bool,
    /// Standard deviation of a visit and coordinate for which this holds, millimetres.
    noise_mm: f64,
    joints: Vec<SightEntry>,
    /// Joints without a visible shift of their zeros.
    invisible: Vec<InvisibleEntry>,
}

impl WitnessPlan {
    /// Plan of chosen configurations.
    #[must_use]
    pub fn new(found: &Witnesses, robot: &str, are_new: bool) -> Self {
        WitnessPlan {
            robot: robot.to_owned(),
            configurations: found.configurations.len(),
            are_new,
            noise_mm: 1e3 * found.sigma_m,
            joints: found.joints.iter().map(|it| SightEntry::from_sight(it, &[])).collect(),
            invisible: found.joints.iter().filter_map(InvisibleEntry::from_sight).collect(),
        }
    }

    /// Number of chosen configurations, and the smallest shifts that their repeats detect, in a sentence.
    #[must_use]
    pub fn answer(&self) -> String {
        let seen = self.joints.iter().filter_map(|it| {
            let smallest = it.smallest?;
            Some(format!("{} {smallest:.3} {}", escape_invisible(&it.joint), it.unit))
        });
        let seen: Vec<String> = seen.collect();
        let seen = if seen.is_empty() { "none".to_owned() } else { seen.join(", ") };
        let unseen: Vec<String> = self.invisible.iter().map(|it| escape_invisible(&it.joint).into_owned()).collect();
        let unseen = if unseen.is_empty() { String::new() } else { format!("; not visible: {}", unseen.join(", ")) };
        format!("{} configurations; smallest visible shifts (95 %): {seen}{unseen}", self.configurations)
    }

    /// The table.
    #[must_use]
    pub fn text(&self) -> String {
        let mut out = String::new();
        line(&mut out, "robot", &self.robot);
        let new = if self.are_new { ", new: measure them now, and name that visit by --reference later" } else { "" };
        line(&mut out, "witnesses", &format!("{}{new}", self.configurations));
        line(&mut out, "noise", &format!("{:.3} mm a visit and coordinate", self.noise_mm));
        out.push_str(&sight_table(&self.joints, &self.invisible));
        out
    }
}

/// Recalibrated parts, in words.
#[must_use]
pub fn describe_recalibrated(found: &RecalibratedJoint, before: &CalibrationFile) -> String {
    let mut out = String::new();
    let (size, sigma) = found.repair.size();
    let joint = before.joints.iter().find(|it| it.name == found.repair.joint);
    let slides = joint.is_some_and(|it| it.kind == JointKind::Prismatic);
    let unit = if slides { "mm" } else { "deg" };
    let what = match found.repair.part {
        RepairedPart::Zero => {
            format!("zero by {:+.4} ± {:.4} {unit}", in_page_unit(size, slides), in_page_unit(sigma, slides))
        }
        RepairedPart::Axis => {
            format!("axis turned by {:.4} ± {:.4} deg", size.to_degrees(), sigma.to_degrees())
        }
    };
    line(&mut out, "robot", &before.robot.name);
    line(&mut out, "anew", &format!("{}: {what}; all else as before", escape_invisible(&found.repair.joint)));
    out
}

impl TrackReport {
    /// Entries of a visit's result.
    #[must_use]
    pub fn new(found: &VisitResult, robot: &str, inputs: ValidationInputs) -> Self {
        TrackReport {
            schema: TRACK,
            poecal_version: env!("CARGO_PKG_VERSION"),
            robot: robot.to_owned(),
            inputs,
            record: Record::default(),
            state: found.state,
            judged_by: found.judged_by,
            device: if found.options.device_is_known { "known" } else { "refit" },
            tool: if found.options.tool_is_anew { "refit" } else { "same" },
            rows: found.rows,
            repeated: found.repeated,
            explanation: found.explanation.as_ref().map(ExplanationEntry::from_explanation),
            alternatives: found.alternatives.iter().map(ExplanationEntry::from_explanation).collect(),
            invisible: found.joints.iter().filter_map(InvisibleEntry::from_sight).collect(),
            joints: found.joints.iter().map(|it| SightEntry::from_sight(it, &found.ranges)).collect(),
            change_mm: 1e3 * found.change_m,
            left_mm: 1e3 * found.left_m,
            noise_mm: 1e3 * found.noise_m,
            freedom: Some(found.freedom).filter(|it| *it < 1e5),
            error_mm: 1e3 * found.error_m,
            notes: found.notes.clone(),
        }
    }

    /// The same result with the statements about the visit.
    #[must_use]
    pub fn with_record(self, record: Record) -> Self {
        TrackReport { record, ..self }
    }

    /// The change, in a sentence.
    #[must_use]
    pub fn answer(&self) -> String {
        let Some(found) = &self.explanation else {
            return match self.state {
                RobotCondition::Unchanged => format!("unchanged within {:.3} mm", self.change_mm),
                RobotCondition::Changed => {
                    "changed, and no single cause explains it: another robot or tool, or calibrate anew".to_owned()
                }
            };
        };
        let others: Vec<String> = self.alternatives.iter().map(ExplanationEntry::subject_name).collect();
        let others = match others.as_slice() {
            [] => String::new(),
            [one] => format!("; {one} explains it nearly as well"),
            some => format!("; {} explain it nearly as well", some.join(", ")),
        };
        format!("{}{others}", found.words)
    }

    /// The state with the change.
    pub(crate) fn state_words(&self) -> String {
        match (&self.explanation, self.state) {
            (Some(_), RobotCondition::Changed) => format!("changed: {}", self.answer()),
            (..) => self.answer(),
        }
    }

    /// Reference of the judgement.
    pub(crate) fn judged_words(&self) -> String {
        match self.judged_by {
            JudgingBasis::Repeats => {
                format!("{} of {} rows that repeat earlier ones, measured against measured", self.repeated, self.rows)
            }
            JudgingBasis::Model => format!("the model, at {} rows", self.rows),
        }
    }

    /// Part of the change that the explanation leaves.
    pub(crate) fn left_words(&self) -> Option<String> {
        let left = || format!(", {:.3} mm of which the explanation leaves", self.left_mm);
        self.explanation.as_ref().map(|_| left())
    }

    /// The level of the calibration after the visit, by its level before.
    pub(crate) fn level_words(&self, before: &str) -> String {
        match (self.state, self.explanation.as_ref().map(|it| to_do(it).0)) {
            (RobotCondition::Unchanged, _) | (RobotCondition::Changed, Some(UsageLevel::Whole)) => before.to_owned(),
            (RobotCondition::Changed, Some(UsageLevel::Axes)) => format!("axes: {before}; tool: do not use"),
            (RobotCondition::Changed, Some(UsageLevel::None) | None) => "do not use".to_owned(),
        }
    }

    /// Advice after the visit.
    pub(crate) fn to_do(&self) -> String {
        let Some(found) = &self.explanation else {
            return match self.state {
                RobotCondition::Unchanged => "Nothing: the calibration stays in use.".to_owned(),
                RobotCondition::Changed => "Do not use the calibration: calibrate again.".to_owned(),
            };
        };
        let (_, words) = to_do(found);
        let apart = if self.alternatives.is_empty() {
            ""
        } else {
            " First distinguish the explanations: repeat more configurations of the calibration."
        };
        format!("{words}.{apart}")
    }

    pub(crate) fn device_words(&self) -> &'static str {
        if self.device == "known" { "where it was" } else { "set up anew: its place is fitted" }
    }

    pub(crate) fn tool_words(&self) -> &'static str {
        if self.tool == "refit" { "mounted anew: its targets are fitted" } else { "on the flange as it was" }
    }

    /// The table.
    #[must_use]
    pub fn text(&self) -> String {
        let mut out = String::new();
        line(&mut out, "robot", &self.robot);
        line(&mut out, "state", &self.state_words());
        line(&mut out, "judged by", &self.judged_words());
        let left = self.left_words().unwrap_or_default();
        line(
            &mut out,
            "change",
            &format!("{:.3} mm (RMS){left}; noise {:.3} mm a coordinate", self.change_mm, self.noise_mm),
        );
        line(&mut out, "error now", &format!("{:.3} mm (RMS)", self.error_mm));
        out.push_str(&sight_table(&self.joints, &self.invisible));
        out
    }
}
