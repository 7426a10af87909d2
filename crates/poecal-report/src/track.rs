//! Whether a robot has drifted, for a person to look over or a machine to read.

use serde::Serialize;

use super::table::line;
use super::track_entries::{ExplanationEntry, InvisibleEntry, SightEntry, shown, sight_table};
use poecal_model::robot::JointKind;
use poecal_numerics::text::visible;
use poecal_results::calibration_file::{CalibrationFile, RepairedPart};
use poecal_results::track::{JudgedBy, Repaired, State, Tracked, Witnesses};
use poecal_results::validation::{TRACK, ValidationInputs};

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
