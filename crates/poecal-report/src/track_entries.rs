//! Results of a visit for each joint and each cause, in numbers and words.

use std::fmt::Write as _;

use serde::Serialize;

use poecal_fit::analysis::JointCoverage;
use poecal_numerics::text::escape_invisible;
use poecal_results::track::{ChangeExplanation, ExplanationKind, JointSight, Size, Undetectable};

/// An explanation of the changes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct ExplanationEntry {
    #[serde(skip)]
    pub(crate) of: ExplanationKind,
    pub(crate) kind: &'static str,
    /// Its joint; for two zeros both, null if it concerns no joint.
    pub(crate) joint: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) other_joint: Option<String>,
    /// The target or device, if it has a name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) name: Option<String>,
    pub(crate) size_deg: Option<f64>,
    pub(crate) sigma_deg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) other_size_deg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) other_sigma_deg: Option<f64>,
    pub(crate) size_mm: Option<f64>,
    pub(crate) sigma_mm: Option<f64>,
    /// Growth of all lengths, parts per million.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) size_ppm: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) sigma_ppm: Option<f64>,
    /// Zeros of three joints or more, each with its shift.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) zeros: Vec<ZeroEntry>,
    pub(crate) words: String,
}

/// The zero of one of several joints: its shift in degrees, for a slide in millimetres.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct ZeroEntry {
    pub(crate) joint: String,
    pub(crate) unit: &'static str,
    pub(crate) size: f64,
    pub(crate) sigma: f64,
}

impl ZeroEntry {
    fn all(found: &ChangeExplanation) -> Vec<Self> {
        let of = |(joint, size): (&String, &Size)| ZeroEntry {
            joint: joint.clone(),
            unit: if size.turns { "deg" } else { "mm" },
            size: in_page_unit(size.value, !size.turns),
            sigma: in_page_unit(size.sigma, !size.turns),
        };
        found.names.iter().zip(&found.sizes).map(of).collect()
    }
}

/// A joint without a visible shift of its zero.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct InvisibleEntry {
    pub(crate) joint: String,
    pub(crate) because: &'static str,
    pub(crate) words: String,
}

/// Detectability of a joint's shift: in degrees, for a slide in millimetres.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct SightEntry {
    pub(crate) joint: String,
    pub(crate) unit: &'static str,
    /// Smallest shift of its zero that is visible with 95 %; null if none is.
    pub(crate) smallest: Option<f64>,
    pub(crate) sigma: Option<f64>,
    /// Part of its range that the visit samples.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) sampled: Option<[f64; 2]>,
    /// Estimated shift of its zero beside the explanation, and its standard deviation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) shift: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) sigma_shift: Option<f64>,
}

/// Word of a kind.
fn kind(of: ExplanationKind) -> &'static str {
    match of {
        ExplanationKind::Device => "device",
        ExplanationKind::Tool => "tool",
        ExplanationKind::Target => "target",
        ExplanationKind::Lengths => "lengths",
        ExplanationKind::Zero => "zero",
        ExplanationKind::Axis => "axis",
        ExplanationKind::Give => "give",
        ExplanationKind::TwoZeros => "two_zeros",
        ExplanationKind::Zeros => "zeros",
    }
}

/// Words for the reason why no shift of a joint is visible.
fn describe_reason(unseen: Undetectable) -> (&'static str, &'static str) {
    match unseen {
        Undetectable::Device => (
            "device",
            "the device was set up anew, so that its new place hides the shift: state --device known if it is on fixed nests",
        ),
        Undetectable::Tool => ("tool", "the tool was mounted anew, so that its new place hides the shift"),
        Undetectable::DeviceAndTool => {
            ("device and tool", "device and tool are new, so that their places hide the shift")
        }
        Undetectable::NoMotion => (
            "motion",
            "a shift moves no target of these rows by enough: measure a target farther from its axis, and turn the joints before it",
        ),
    }
}

/// A value in degrees; for a slide in millimetres.
pub(crate) fn in_page_unit(value: f64, slides: bool) -> f64 {
    if slides { 1e3 * value } else { value.to_degrees() }
}

/// The part of a range that rows sample, in the units of a page.
pub(crate) fn sampled_range(found: &JointCoverage, slides: bool) -> [f64; 2] {
    [found.sampled_min, found.sampled_max].map(|it| in_page_unit(it, slides))
}

impl SightEntry {
    pub(crate) fn from_sight(it: &JointSight, ranges: &[JointCoverage]) -> Self {
        let range = ranges.iter().find(|range| range.joint == it.joint);
        SightEntry {
            joint: it.joint.clone(),
            unit: if it.slides { "mm" } else { "deg" },
            smallest: Some(in_page_unit(it.smallest, it.slides)).filter(|_| it.unseen.is_none()),
            sigma: Some(in_page_unit(it.sigma, it.slides)).filter(|it| it.is_finite()),
            sampled: range.map(|range| sampled_range(range, it.slides)),
            shift: it.shift.map(|shift| in_page_unit(shift.value, it.slides)),
            sigma_shift: it.shift.map(|shift| in_page_unit(shift.sigma, it.slides)),
        }
    }
}

impl InvisibleEntry {
    pub(crate) fn from_sight(it: &JointSight) -> Option<Self> {
        let (word, words) = describe_reason(it.unseen?);
        Some(InvisibleEntry { joint: it.joint.clone(), because: word, words: words.to_owned() })
    }
}

impl ExplanationEntry {
    pub(crate) fn from_explanation(found: &ChangeExplanation) -> Self {
        let is_of_joint = matches!(
            found.kind,
            ExplanationKind::Zero | ExplanationKind::Axis | ExplanationKind::Give | ExplanationKind::TwoZeros
        );
        let name = |at: usize| found.names.get(at).filter(|it| !it.is_empty()).cloned();
        let is_pair = found.kind == ExplanationKind::TwoZeros;
        let are_several = found.kind == ExplanationKind::Zeros;
        let (angle, length) = (found.size(true), found.size(false));
        let share = found.kind == ExplanationKind::Lengths;
        let own = |at: usize| found.sizes.get(at).filter(|it| it.turns).map(|it| (it.value, it.sigma));
        let angle = if is_pair { own(0) } else { angle.filter(|_| !are_several) };
        let other = if is_pair { own(1) } else { None };
        let millimetres = length.filter(|_| !share && !are_several);
        ExplanationEntry {
            of: found.kind,
            kind: kind(found.kind),
            joint: name(0).filter(|_| is_of_joint),
            other_joint: name(1).filter(|_| is_pair),
            name: name(0).filter(|_| matches!(found.kind, ExplanationKind::Target | ExplanationKind::Device)),
            size_deg: angle.map(|it| it.0.to_degrees()),
            sigma_deg: angle.map(|it| it.1.to_degrees()),
            other_size_deg: other.map(|it| it.0.to_degrees()),
            other_sigma_deg: other.map(|it| it.1.to_degrees()),
            size_mm: millimetres.map(|it| 1e3 * it.0),
            sigma_mm: millimetres.map(|it| 1e3 * it.1),
            size_ppm: length.filter(|_| share).map(|it| 1e6 * it.0),
            sigma_ppm: length.filter(|_| share).map(|it| 1e6 * it.1),
            zeros: if are_several { ZeroEntry::all(found) } else { Vec::new() },
            words: words(found),
        }
    }

    /// Its subject, in a word.
    pub(crate) fn subject_name(&self) -> String {
        match (&self.joint, &self.other_joint, &self.name) {
            (Some(joint), Some(other), _) => format!("{joint} and {other}"),
            (Some(joint), None, _) if self.kind == "zero" => joint.clone(),
            (Some(joint), None, _) => format!("{} of {joint}", self.kind),
            (None, _, Some(name)) => format!("{} {name}", self.kind),
            _ => self.kind.to_owned(),
        }
    }
}

/// Further use of programs and the calibration, and advice, by the explanation of the changes.
pub(crate) fn to_do(found: &ExplanationEntry) -> (UsageLevel, String) {
    let joint = found.joint.as_deref().map(escape_invisible).unwrap_or_default();
    let named = found.subject_name();
    match found.of {
        ExplanationKind::Device => (
            UsageLevel::Whole,
            "Nothing on the robot: the measuring device is not where it was. Find out whether it or the robot's base was moved".to_owned(),
        ),
        ExplanationKind::Tool => (
            UsageLevel::Axes,
            "Look at the tool and its mounting. Measure its tip again (`poecal tcp`), or state `--tool refit` if it was taken off".to_owned(),
        ),
        ExplanationKind::Target => {
            (UsageLevel::Axes, format!("Fasten the {named}, or do without it: measure the visit again with the other targets"))
        }
        ExplanationKind::Lengths => (
            UsageLevel::None,
            "Measure again at the temperature of the calibration, after the same warming up; if it stays, calibrate again".to_owned(),
        ),
        ExplanationKind::Zero => (
            UsageLevel::None,
            format!(
                "Look at motor, encoder, belt and brake of {joint}, and set its mastering again. If nothing is found, calibrate its zero: `poecal track --recalibrate {joint} --out FILE`"
            ),
        ),
        ExplanationKind::Axis => (
            UsageLevel::None,
            format!(
                "Look for damage at {joint}. Calibrate its axis (`poecal track --recalibrate {joint}.axis --out FILE`), or the whole robot again"
            ),
        ),
        ExplanationKind::Give => {
            (UsageLevel::None, format!("Look at bearing, gear and balancer of {joint}, and at the payload; then calibrate again"))
        }
        ExplanationKind::TwoZeros => {
            (UsageLevel::None, format!("Look at the mastering of {named}; then calibrate again"))
        }
        ExplanationKind::Zeros => {
            let joints: Vec<_> = found.zeros.iter().map(|it| escape_invisible(&it.joint)).collect();
            (UsageLevel::None, format!("Look at the mastering of {}; then calibrate again", joints.join(", ")))
        }
    }
}

/// Extent to which a calibration is used after a visit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum UsageLevel {
    /// As before.
    Whole,
    /// The axes as before, but not the tool.
    Axes,
    /// Not at all.
    None,
}

/// An explanation with its size.
fn words(found: &ChangeExplanation) -> String {
    let first = found.names.first().map(String::as_str).unwrap_or_default();
    let name = |what: &str| if first.is_empty() { what.to_owned() } else { format!("{what} {first}") };
    let angle = |(value, sigma): (f64, f64)| format!("{:+.3} ± {:.3} deg", value.to_degrees(), sigma.to_degrees());
    let length = |(value, sigma): (f64, f64)| format!("{:+.3} ± {:.3} mm", 1e3 * value, 1e3 * sigma);
    let far = || {
        let size = |turns: bool, unit: &str| {
            let shown = |value: f64| if turns { value.to_degrees() } else { 1e3 * value };
            found.size(turns).map(|(value, sigma)| format!("{:.3} ± {:.3} {unit}", shown(value), shown(sigma)))
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
        ExplanationKind::Device => format!("{}: moved by {}", name("device"), far()),
        ExplanationKind::Tool => format!("tool: moved on the flange by {}", far()),
        ExplanationKind::Target => format!("{}: moved on the tool by {}", name("target"), far()),
        ExplanationKind::Lengths => {
            let (value, sigma) = found.size(false).unwrap_or_default();
            format!("all lengths: {:+.0} ± {:.0} parts in a million, as by warmth", 1e6 * value, 1e6 * sigma)
        }
        ExplanationKind::Zero => format!("{first}: zero by {}", each(0)),
        ExplanationKind::Axis => format!("{first}: axis moved by {}", far()),
        ExplanationKind::Give => format!("{first}: deflects otherwise by {} at full weight", far()),
        ExplanationKind::TwoZeros => {
            format!("{first}: zero by {}, and {second}: zero by {}", each(0), each(1))
        }
        ExplanationKind::Zeros => {
            let all = found.names.iter().enumerate().map(|(at, name)| format!("{name}: zero by {}", each(at)));
            all.collect::<Vec<_>>().join(", ")
        }
    }
}

/// A line for each joint: the smallest shift that is visible, or the reason if none is.
pub(crate) fn sight_table(joints: &[SightEntry], invisible: &[InvisibleEntry]) -> String {
    let mut out = String::new();
    let _ = writeln!(out, "\n  {:16} {:>30}", "joint", "smallest visible shift (95 %)");
    for joint in joints {
        let smallest = joint.smallest.map_or_else(|| "not visible".to_owned(), |it| format!("{it:.3} {}", joint.unit));
        let _ = writeln!(out, "  {:16} {smallest:>30}", escape_invisible(&joint.joint));
    }
    for it in invisible {
        let _ = writeln!(out, "  {}: {}", escape_invisible(&it.joint), it.words);
    }
    out
}
