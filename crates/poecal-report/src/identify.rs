//! Determination of the unknowns by chosen configurations.

use std::fmt::Write as _;

use serde::Serialize;

use super::plan::{PlanErrors, robot_error_words};
use super::summary::{determined_words, unknowns_words};
use super::table::{kinds_words, line, noise_words, number, robot_words};
use poecal_fit::analysis::{Cause, ExpectedUncertainty, JointCoverage, MeasuredPictures, PlannedSession};
use poecal_model::measurement::{MeasuredQuantities, Quantity};
use poecal_model::robot::JointKind;
use poecal_numerics::text::escape_invisible;
use poecal_plan::plan::ListExpectation;
use poecal_results::calibration_file::IdentifiabilityEntry;
use poecal_results::model::Model;

/// Directions of a kind that the terminal names.
const MOST_DIRECTIONS: usize = 6;

/// Determination of the unknowns by configurations, for a person to look over or a machine to read.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Identify {
    model: String,
    files: Vec<String>,
    kind: &'static str,
    frame: &'static str,
    configurations: usize,
    noise: MeasuredQuantities<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pictures: Option<IdentifiedPicturesEntry>,
    identifiability: IdentifiabilityEntry,
    expected_error: PredictedErrorsEntry,
    /// Errors of a fit including the robot's own scatter; null for kinds whose configurations cannot be chosen freely.
    expected: Option<PlanErrors>,
    robot_error_is_a_guess: bool,
    coverage: Vec<JointCoverage>,
    #[serde(skip)]
    robot_words: String,
    #[serde(skip)]
    kinds: Vec<JointKind>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct PredictedErrorsEntry {
    configurations: usize,
    told: usize,
    /// Mean expected error of positions; null without a prediction.
    position_mean_mm: Option<f64>,
    position_worst_mm: Option<f64>,
}

/// The pictures, and the noise of their corners.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct IdentifiedPicturesEntry {
    count: usize,
    corners: usize,
    sigma_px: f64,
    common_shift_mm: f64,
    common_turn_deg: f64,
}

impl IdentifiedPicturesEntry {
    fn from_pictures(found: &MeasuredPictures) -> Self {
        let MeasuredPictures { count, corners, sigma_px, shared: [shift_m, turn_rad] } = *found;
        let (common_shift_mm, common_turn_deg) = (1e3 * shift_m, turn_rad.to_degrees());
        IdentifiedPicturesEntry { count, corners, sigma_px, common_shift_mm, common_turn_deg }
    }
}

impl Identify {
    /// Result of `identify` for a model in the configurations of some files, named as the user named them, with the expected errors.
    #[must_use]
    pub fn new(
        model: &Model,
        files: &[String],
        session: &PlannedSession,
        (found, expected): (&ExpectedUncertainty, Option<ListExpectation>),
    ) -> Self {
        let sigma = |quantity: Quantity| quantity.unit().in_shown_unit(session.noise[quantity]);
        let is_stated = |quantity: Quantity| found.pictures.is_none() && session.kind.has(quantity);
        let sigma = MeasuredQuantities::from_fn(|quantity| is_stated(quantity).then(|| sigma(quantity)));
        Identify {
            model: model.path.display().to_string(),
            files: files.to_vec(),
            kind: if found.pictures.is_some() { "picture" } else { session.kind.word() },
            frame: if session.device_free { "unknown" } else { "base" },
            configurations: found.count,
            noise: sigma,
            pictures: found.pictures.as_ref().map(IdentifiedPicturesEntry::from_pictures),
            identifiability: IdentifiabilityEntry::from_identifiability(&found.identifiability),
            expected_error: PredictedErrorsEntry {
                configurations: found.expected.configurations,
                told: found.expected.determined,
                position_mean_mm: found.expected.mean_m.map(|mean| mean * 1e3),
                position_worst_mm: found.expected.worst_m.map(|worst| worst * 1e3),
            },
            expected: expected.map(|it| PlanErrors::new(&it.errors)),
            robot_error_is_a_guess: expected.is_some_and(|it| it.robot_error_is_a_guess),
            coverage: found.coverage.clone(),
            robot_words: robot_words(&model.robot),
            kinds: model.robot.joints.iter().map(|joint| joint.kind).collect(),
        }
    }

    /// Number of determined unknowns, and the expected errors, in a sentence.
    #[must_use]
    pub fn answer(&self) -> String {
        let found = &self.identifiability;
        let weak: usize = found.weak.iter().map(|it| it.directions).sum();
        let weak = if weak > 0 { format!(" ({weak} weakly)") } else { String::new() };
        let expected = self.expected.as_ref().map_or_else(String::new, |it| {
            let (calibrated, corrected) = (number(it.calibrated_mm), number(it.corrected_mm));
            format!(": {calibrated} mm calibrated and {corrected} mm corrected are expected (RMS)")
        });
        format!("{} of {} unknowns determined{weak}{expected}", found.rank, found.parameters)
    }

    /// As text of lines up to 80 characters (except for longer names).
    #[must_use]
    pub fn text(&self) -> String {
        let mut out = String::new();
        line(&mut out, "robot", &self.robot_words);
        let (poses, points) = match self.kind {
            "pose" => (self.configurations, 0),
            "point" => (0, self.configurations),
            _ => (self.configurations.div_ceil(2), self.configurations / 2),
        };
        let what = match self.kind {
            "pose" | "point" | "mixed" => kinds_words(poses, points),
            kind => format!("{} configurations, {kind}", self.configurations),
        };
        let files = self.files.join(", ");
        match &self.pictures {
            Some(found) => {
                line(&mut out, "measured", &format!("{} pictures, {} corners: {files}", found.count, found.corners));
                let (shift, turn) = (number(found.common_shift_mm), number(found.common_turn_deg));
                let noise = format!(
                    "{} px of each coordinate of a corner, and {shift} mm and {turn} deg that the corners of a picture share, as is usual before a calibration",
                    number(found.sigma_px)
                );
                line(&mut out, "noise", &noise);
            }
            None => {
                line(&mut out, "to measure", &format!("{what}: {files}"));
                line(&mut out, "noise", &noise_words(&self.noise));
            }
        }
        identifiability_lines(&mut out, &self.identifiability);
        line(&mut out, "observability", &self.observability_words());
        line(&mut out, "expected", &self.expected_words());
        if let Some(expected) = &self.expected {
            let [calibrated, corrected] = expected.words();
            line(&mut out, "", &format!("calibrated {calibrated}"));
            line(&mut out, "", &format!("corrected {corrected}"));
            let robot = robot_error_words(expected, self.robot_error_is_a_guess);
            line(&mut out, "robot error", &robot);
        }
        coverage_table(&mut out, self.coverage.iter().zip(self.kinds.iter().copied()));
        out
    }

    fn observability_words(&self) -> String {
        let found = self.identifiability.observability;
        let indices = [found.o1, found.o2, found.o3, found.o4, found.o5];
        let words: Vec<String> = indices
            .iter()
            .enumerate()
            .filter_map(|(k, index)| index.map(|index| format!("O{} {index:.3e}", k + 1)))
            .collect();
        if words.is_empty() {
            "O1 to O5 are zero: an unknown is not determined at all".to_owned()
        } else {
            format!("{} (larger is better)", words.join(", "))
        }
    }

    fn expected_words(&self) -> String {
        let expected = self.expected_error;
        let (Some(mean), Some(worst)) = (expected.position_mean_mm, expected.position_worst_mm) else {
            return "no prediction is determined: all depend on undetermined unknowns".to_owned();
        };
        let rest = expected.configurations - expected.told;
        let open = match rest {
            0 => String::new(),
            1 => "; 1 other depends on undetermined unknowns".to_owned(),
            _ => format!("; {rest} others depend on undetermined unknowns"),
        };
        format!(
            "tip predicted to {} mm (worst {} mm), noise only, in {} random configurations within the limits{open}",
            number(mean),
            number(worst),
            expected.told
        )
    }
}

/// Unknowns that measurements determine, do not determine, determine weakly, and cannot determine.
fn identifiability_lines(out: &mut String, found: &IdentifiabilityEntry) {
    let condition = found.condition.map_or_else(String::new, |it| format!(", condition {it:.3e}"));
    line(out, "determined", &format!("{}{condition}", determined_words(found)));
    if found.rank == 0 && found.parameters > 0 {
        let words = "undetermined: everything, since the residual is as large as the effect of the unknowns";
        line(out, "", words);
    } else {
        for (label, directions) in [("undetermined", &found.unidentifiable), ("weakly determined", &found.weak)] {
            for direction in directions.iter().take(MOST_DIRECTIONS) {
                let count = match direction.directions {
                    1 => String::new(),
                    count => format!(" ({})", unknowns_words(count)),
                };
                line(out, "", &format!("{label}: {}{count}", direction.description));
            }
            if directions.len() > MOST_DIRECTIONS {
                let rest = directions.len() - MOST_DIRECTIONS;
                line(out, "", &format!("{label}: {rest} more, in calibration.json"));
            }
        }
    }
    for direction in found.structural.iter().filter(|it| it.cause == Cause::NoOrientation) {
        line(out, "", &direction.description);
    }
}

/// Sampled part of each joint's range.
pub(crate) fn coverage_table<'a>(out: &mut String, joints: impl Iterator<Item = (&'a JointCoverage, JointKind)>) {
    // Writing to a String cannot fail.
    let _ = writeln!(out, "\n{:<21}{:>23}{:>26}{:>8}", "joint", "sampled", "limits", "share");
    let mut is_of_a_turn = false;
    for (joint, kind) in joints {
        is_of_a_turn |= joint.is_of_a_turn(kind);
        let _ = writeln!(out, "{}", coverage_row(joint, kind));
    }
    if is_of_a_turn {
        let _ = writeln!(out, "  share: of one turn where the limits span more");
    }
}

fn coverage_row(joint: &JointCoverage, kind: JointKind) -> String {
    let (scale, unit) = match kind {
        JointKind::Revolute => (1f64.to_degrees(), "deg"),
        JointKind::Prismatic => (1e3, "mm"),
    };
    // Adding zero makes negative zero positive.
    let shown = |value: f64| format!("{:.1}", (value * scale * 10.0).round() / 10.0 + 0.0);
    let sampled = format!("{} to {} {unit}", shown(joint.sampled_min), shown(joint.sampled_max));
    let limits = match (joint.limit_min, joint.limit_max) {
        (Some(least), Some(most)) => format!("{} to {} {unit}", shown(least), shown(most)),
        _ => "none".to_owned(),
    };
    let share = joint.share(kind).map_or_else(|| "-".to_owned(), |share| format!("{:.0} %", 100.0 * share));
    format!("  {:<19}{sampled:>23}{limits:>26}{share:>8}", escape_invisible(&joint.joint))
}
