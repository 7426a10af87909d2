//! Whether a robot has drifted, for a person to look over or a machine to read.

use std::fmt::Write as _;

use serde::Serialize;

use super::table::line;
use crate::io::calibration_file::{CalibrationFile, RepairedPart};
use crate::io::validation::{TRACK, ValidationInputs};
use crate::robot::JointKind;
use crate::text::visible;
use crate::track::{Explanation, JointSight, JudgedBy, Kind, Repaired, State, Tracked, Unseen, Witnesses};

/// A visit with what was judged by what.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Track {
    /// Name and version of this schema.
    pub schema: &'static str,
    /// Version that judged.
    pub poecal_version: &'static str,
    /// The robot's name.
    pub robot: String,
    /// What was judged, and by what.
    pub inputs: ValidationInputs,
    state: State,
    judged_by: JudgedBy,
    rows: usize,
    repeated: usize,
    explanation: Option<ExplanationEntry>,
    alternatives: Vec<ExplanationEntry>,
    /// Joints of whose zeros no shift is visible.
    invisible: Vec<InvisibleEntry>,
    joints: Vec<SightEntry>,
    /// Root mean square change of measured places beside what is free, millimetres.
    change_mm: f64,
    /// The same of what the explanation leaves.
    left_mm: f64,
    /// Standard deviation of a coordinate of such a change, millimetres, and its degrees of freedom; null of a known one.
    noise_mm: f64,
    freedom: Option<f64>,
    /// Root mean square error of the delivered model in this visit, millimetres.
    error_mm: f64,
    notes: Vec<String>,
}

/// What explains the changes.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct ExplanationEntry {
    kind: &'static str,
    /// The joint of it; of two zeros both, null where it is of none.
    joint: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    other_joint: Option<String>,
    /// The target or device, if it has a name.
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    size_deg: Option<f64>,
    sigma_deg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    other_size_deg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    other_sigma_deg: Option<f64>,
    size_mm: Option<f64>,
    sigma_mm: Option<f64>,
    /// Growth of all lengths, parts in a million.
    #[serde(skip_serializing_if = "Option::is_none")]
    size_ppm: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sigma_ppm: Option<f64>,
    words: String,
}

/// A joint of which no shift of the zero is visible.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct InvisibleEntry {
    joint: String,
    because: &'static str,
    words: String,
}

/// What would be visible of a joint: in degrees, of a slide in millimetres.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct SightEntry {
    joint: String,
    unit: &'static str,
    /// Smallest shift of its zero that is visible with 95 %; null where none is.
    smallest: Option<f64>,
    sigma: Option<f64>,
}

/// Word of a kind.
fn kind(of: Kind) -> &'static str {
    match of {
        Kind::Device => "device",
        Kind::Tool => "tool",
        Kind::Target => "target",
        Kind::Lengths => "lengths",
        Kind::Zero => "zero",
        Kind::Axis => "axis",
        Kind::Give => "give",
        Kind::TwoZeros => "two_zeros",
    }
}

/// Words of why no shift of a joint is visible.
fn because(unseen: Unseen) -> (&'static str, &'static str) {
    match unseen {
        Unseen::Device => (
            "device",
            "the device was set up anew, so that its new place hides the shift: state --device known if it is on fixed nests",
        ),
        Unseen::Tool => ("tool", "the tool was mounted anew, so that its new place hides the shift"),
        Unseen::DeviceAndTool => {
            ("device and tool", "device and tool are new, so that their places hide the shift")
        }
        Unseen::NoMotion => (
            "motion",
            "a shift moves no target of these rows by enough: measure a target farther from its axis, and turn the joints before it",
        ),
    }
}

fn shown(value: f64, slides: bool) -> f64 {
    if slides { 1e3 * value } else { value.to_degrees() }
}

/// What repeats of chosen configurations would show.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WitnessPlan {
    robot: String,
    configurations: usize,
    /// Whether they are new, and no earlier visit has them.
    are_new: bool,
    /// Standard deviation of a visit and coordinate for which this is, millimetres.
    noise_mm: f64,
    joints: Vec<SightEntry>,
    /// Joints of whose zeros no shift is visible.
    invisible: Vec<InvisibleEntry>,
}

impl WitnessPlan {
    /// Of chosen configurations.
    #[must_use]
    pub fn new(found: &Witnesses, robot: &str, are_new: bool) -> Self {
        WitnessPlan {
            robot: robot.to_owned(),
            configurations: found.configurations.len(),
            are_new,
            noise_mm: 1e3 * found.sigma_m,
            joints: found.joints.iter().map(SightEntry::of).collect(),
            invisible: found.joints.iter().filter_map(InvisibleEntry::of).collect(),
        }
    }

    /// How many configurations are chosen, and the smallest shifts that their repeats show, in a sentence.
    #[must_use]
    pub fn answer(&self) -> String {
        let seen = self.joints.iter().filter_map(|it| {
            let smallest = it.smallest?;
            Some(format!("{} {smallest:.3} {}", visible(&it.joint), it.unit))
        });
        let seen: Vec<String> = seen.collect();
        let seen = if seen.is_empty() { "none".to_owned() } else { seen.join(", ") };
        let unseen: Vec<String> = self.invisible.iter().map(|it| visible(&it.joint).into_owned()).collect();
        let unseen =
            if unseen.is_empty() { String::new() } else { format!("; not visible: {}", unseen.join(", ")) };
        format!("{} configurations; smallest visible shifts (95 %): {seen}{unseen}", self.configurations)
    }

    /// The table.
    #[must_use]
    pub fn text(&self) -> String {
        let mut out = String::new();
        line(&mut out, "robot", &self.robot);
        let new = if self.are_new {
            ", new: measure them now, and name that visit by --reference later"
        } else {
            ""
        };
        line(&mut out, "witnesses", &format!("{}{new}", self.configurations));
        line(&mut out, "noise", &format!("{:.3} mm a visit and coordinate", self.noise_mm));
        out.push_str(&sight_table(&self.joints, &self.invisible));
        out
    }
}

/// What was calibrated anew, in words.
#[must_use]
pub fn recalibrated(found: &Repaired, before: &CalibrationFile) -> String {
    let mut out = String::new();
    let (size, sigma) = found.repair.size();
    let joint = before.joints.iter().find(|it| it.name == found.repair.joint);
    let slides = joint.is_some_and(|it| it.kind == JointKind::Prismatic);
    let unit = if slides { "mm" } else { "deg" };
    let what = match found.repair.part {
        RepairedPart::Zero => {
            format!("zero by {:+.4} ± {:.4} {unit}", shown(size, slides), shown(sigma, slides))
        }
        RepairedPart::Axis => {
            format!("axis turned by {:.4} ± {:.4} deg", size.to_degrees(), sigma.to_degrees())
        }
    };
    line(&mut out, "robot", &before.robot.name);
    line(&mut out, "anew", &format!("{}: {what}; all else as before", visible(&found.repair.joint)));
    out
}

fn sight_table(joints: &[SightEntry], invisible: &[InvisibleEntry]) -> String {
    let mut out = String::new();
    let _ = writeln!(out, "\n  {:16} {:>30}", "joint", "smallest visible shift (95 %)");
    for joint in joints {
        let smallest =
            joint.smallest.map_or_else(|| "not visible".to_owned(), |it| format!("{it:.3} {}", joint.unit));
        let _ = writeln!(out, "  {:16} {smallest:>30}", visible(&joint.joint));
    }
    for it in invisible {
        let _ = writeln!(out, "  {}: {}", visible(&it.joint), it.words);
    }
    out
}

impl SightEntry {
    fn of(it: &JointSight) -> Self {
        SightEntry {
            joint: it.joint.clone(),
            unit: if it.slides { "mm" } else { "deg" },
            smallest: Some(shown(it.smallest, it.slides)).filter(|_| it.unseen.is_none()),
            sigma: Some(shown(it.sigma, it.slides)).filter(|it| it.is_finite()),
        }
    }
}

impl InvisibleEntry {
    fn of(it: &JointSight) -> Option<Self> {
        let (word, words) = because(it.unseen?);
        Some(InvisibleEntry { joint: it.joint.clone(), because: word, words: words.to_owned() })
    }
}

impl ExplanationEntry {
    fn of(found: &Explanation) -> Self {
        let is_of_joint = matches!(found.kind, Kind::Zero | Kind::Axis | Kind::Give | Kind::TwoZeros);
        let name = |at: usize| found.names.get(at).filter(|it| !it.is_empty()).cloned();
        let is_pair = found.kind == Kind::TwoZeros;
        let (angle, length) = (found.size(true), found.size(false));
        let share = found.kind == Kind::Lengths;
        let own = |at: usize| found.sizes.get(at).filter(|it| it.turns).map(|it| (it.value, it.sigma));
        let angle = if is_pair { own(0) } else { angle };
        let other = if is_pair { own(1) } else { None };
        let millimetres = length.filter(|_| !share);
        ExplanationEntry {
            kind: kind(found.kind),
            joint: name(0).filter(|_| is_of_joint),
            other_joint: name(1).filter(|_| is_pair),
            name: name(0).filter(|_| matches!(found.kind, Kind::Target | Kind::Device)),
            size_deg: angle.map(|it| it.0.to_degrees()),
            sigma_deg: angle.map(|it| it.1.to_degrees()),
            other_size_deg: other.map(|it| it.0.to_degrees()),
            other_sigma_deg: other.map(|it| it.1.to_degrees()),
            size_mm: millimetres.map(|it| 1e3 * it.0),
            sigma_mm: millimetres.map(|it| 1e3 * it.1),
            size_ppm: length.filter(|_| share).map(|it| 1e6 * it.0),
            sigma_ppm: length.filter(|_| share).map(|it| 1e6 * it.1),
            words: words(found),
        }
    }

    /// What it is of, in a word.
    fn named(&self) -> String {
        match (&self.joint, &self.other_joint, &self.name) {
            (Some(joint), Some(other), _) => format!("{joint} and {other}"),
            (Some(joint), None, _) if self.kind == "zero" => joint.clone(),
            (Some(joint), None, _) => format!("{} of {joint}", self.kind),
            (None, _, Some(name)) => format!("{} {name}", self.kind),
            _ => self.kind.to_owned(),
        }
    }
}

/// An explanation with its size.
fn words(found: &Explanation) -> String {
    let first = found.names.first().map(String::as_str).unwrap_or_default();
    let name = |what: &str| if first.is_empty() { what.to_owned() } else { format!("{what} {first}") };
    let angle =
        |(value, sigma): (f64, f64)| format!("{:+.3} ± {:.3} deg", value.to_degrees(), sigma.to_degrees());
    let length = |(value, sigma): (f64, f64)| format!("{:+.3} ± {:.3} mm", 1e3 * value, 1e3 * sigma);
    let far = || {
        let size = |turns: bool, unit: &str| {
            let shown = |value: f64| if turns { value.to_degrees() } else { 1e3 * value };
            found
                .size(turns)
                .map(|(value, sigma)| format!("{:.3} ± {:.3} {unit}", shown(value), shown(sigma)))
        };
        [size(false, "mm"), size(true, "deg")].into_iter().flatten().collect::<Vec<_>>().join(" and ")
    };
    let each = |at: usize| {
        found.sizes.get(at).map_or_else(String::new, |it| {
            if it.turns { angle((it.value, it.sigma)) } else { length((it.value, it.sigma)) }
        })
    };
    let second = found.names.get(1).map(String::as_str).unwrap_or_default();
    match found.kind {
        Kind::Device => format!("{}: moved by {}", name("device"), far()),
        Kind::Tool => format!("tool: moved on the flange by {}", far()),
        Kind::Target => format!("{}: moved on the tool by {}", name("target"), far()),
        Kind::Lengths => {
            let (value, sigma) = found.size(false).unwrap_or_default();
            format!("all lengths: {:+.0} ± {:.0} parts in a million, as by warmth", 1e6 * value, 1e6 * sigma)
        }
        Kind::Zero => format!("{first}: zero by {}", each(0)),
        Kind::Axis => format!("{first}: axis moved by {}", far()),
        Kind::Give => format!("{first}: gives otherwise by {} at full weight", far()),
        Kind::TwoZeros => format!("{first}: zero by {}, and {second}: zero by {}", each(0), each(1)),
    }
}

impl Track {
    /// Of what a visit showed.
    #[must_use]
    pub fn new(found: &Tracked, robot: &str, inputs: ValidationInputs) -> Self {
        Track {
            schema: TRACK,
            poecal_version: env!("CARGO_PKG_VERSION"),
            robot: robot.to_owned(),
            inputs,
            state: found.state,
            judged_by: found.judged_by,
            rows: found.rows,
            repeated: found.repeated,
            explanation: found.explanation.as_ref().map(ExplanationEntry::of),
            alternatives: found.alternatives.iter().map(ExplanationEntry::of).collect(),
            invisible: found.joints.iter().filter_map(InvisibleEntry::of).collect(),
            joints: found.joints.iter().map(SightEntry::of).collect(),
            change_mm: 1e3 * found.change_m,
            left_mm: 1e3 * found.left_m,
            noise_mm: 1e3 * found.noise_m,
            freedom: Some(found.freedom).filter(|it| *it < 1e5),
            error_mm: 1e3 * found.error_m,
            notes: found.notes.clone(),
        }
    }

    /// What changed, in a sentence.
    #[must_use]
    pub fn answer(&self) -> String {
        let Some(found) = &self.explanation else {
            return match self.state {
                State::Unchanged => format!("unchanged within {:.3} mm", self.change_mm),
                State::Changed => {
                    "changed, and no single cause explains it: another robot or tool, or calibrate anew"
                        .to_owned()
                }
            };
        };
        let others: Vec<String> = self.alternatives.iter().map(ExplanationEntry::named).collect();
        let others = match others.as_slice() {
            [] => String::new(),
            [one] => format!("; {one} explains it nearly as well"),
            some => format!("; {} explain it nearly as well", some.join(", ")),
        };
        format!("{}{others}", found.words)
    }

    /// The state with what changed.
    fn state_words(&self) -> String {
        match (&self.explanation, self.state) {
            (Some(_), State::Changed) => format!("changed: {}", self.answer()),
            (..) => self.answer(),
        }
    }

    /// The table.
    #[must_use]
    pub fn text(&self) -> String {
        let mut out = String::new();
        let by = match self.judged_by {
            JudgedBy::Repeats => format!(
                "{} of {} rows that repeat earlier ones, measured against measured",
                self.repeated, self.rows
            ),
            JudgedBy::Model => format!("the model, at {} rows", self.rows),
        };
        line(&mut out, "robot", &self.robot);
        line(&mut out, "state", &self.state_words());
        line(&mut out, "judged by", &by);
        let left = if self.explanation.is_some() {
            format!(", {:.3} mm of which the explanation leaves", self.left_mm)
        } else {
            String::new()
        };
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
