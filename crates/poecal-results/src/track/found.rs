//! What a visit shows.

use super::explain::{Hypothesis, Kind, Size, Tried, Verdict};
use super::model::Model;
use super::options::{JudgedBy, MOST_RAD, State, TrackOptions};
use super::sight::JointSight;
use super::visit::Of;
use poecal_fit::analysis::JointCoverage;
use poecal_model::measurement::Dataset;
use poecal_model::robot::JointKind;

/// What explains the changes.
#[derive(Clone, Debug, PartialEq)]
pub struct Explanation {
    /// Its kind.
    pub kind: Kind,
    /// Names of the joints, targets or devices.
    pub names: Vec<String>,
    /// Whether the first joint slides, so that its zero is a length.
    pub slides: bool,
    /// Its unknowns.
    pub sizes: Vec<Size>,
    /// Squares that it explains, in variances of a number.
    pub gain: f64,
}

/// What a visit shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Tracked {
    /// What was known of the visit.
    pub options: TrackOptions,
    /// Whether the robot is as it was.
    pub state: State,
    /// By what the rows were judged.
    pub judged_by: JudgedBy,
    /// Rows of the visit, and those among them that repeat earlier ones.
    pub rows: usize,
    /// Of these, how many repeat configurations of the earlier visit.
    pub repeated: usize,
    /// The simplest explanation that suffices; `None` of an unchanged robot, and where none does.
    pub explanation: Option<Explanation>,
    /// Others that explain the changes nearly as well.
    pub alternatives: Vec<Explanation>,
    /// What of each joint's zero would be found, and what cannot be seen.
    pub joints: Vec<JointSight>,
    /// Which part of each joint's range the rows sample.
    pub ranges: Vec<JointCoverage>,
    /// Root mean square change of measured places with what is free fitted, metres: noise of both visits is in it.
    pub change_m: f64,
    /// The same of what the explanation leaves.
    pub left_m: f64,
    /// Standard deviation of each coordinate, metres: the stated repeatability, or what was found.
    pub noise_m: f64,
    /// Degrees of freedom of that.
    pub freedom: f64,
    /// Root mean square error of the delivered model in this visit, metres: with the frame of the device fitted, unless that is known.
    pub error_m: f64,
    /// What else is to be said, a sentence each.
    pub notes: Vec<String>,
}

impl Explanation {
    /// Length of its angles or of its lengths, radians or metres, with its standard deviation along it; `None` where it has none.
    #[must_use]
    pub fn size(&self, turns: bool) -> Option<(f64, f64)> {
        let own: Vec<&Size> = self.sizes.iter().filter(|it| it.turns == turns).collect();
        if let [only] = own.as_slice() {
            return Some((only.value, only.sigma));
        }
        let length = own.iter().map(|it| it.value * it.value).sum::<f64>().sqrt();
        let along = own.iter().map(|it| (it.value * it.sigma).powi(2)).sum::<f64>().sqrt()
            / length.max(f64::MIN_POSITIVE);
        (!own.is_empty()).then_some((length, along))
    }

    /// Whether it is too far for what is linear.
    #[must_use]
    pub fn is_far(&self) -> bool {
        matches!(self.kind, Kind::Zero | Kind::TwoZeros | Kind::Zeros | Kind::Axis)
            && self.sizes.iter().any(|it| it.turns && it.value.abs() > MOST_RAD)
    }
}

/// An explanation with names and sizes.
pub(crate) fn explanation(
    tried: &Tried,
    hypothesis: &Hypothesis,
    verdict: &Verdict,
    model: &Model,
    data: &Dataset,
) -> Explanation {
    let joint = |joint: usize| model.robot.joints[joint].name.clone();
    let named = |names: &[Option<String>], at: usize| names.get(at).cloned().flatten().unwrap_or_default();
    let names = hypothesis.of.iter().map(|of| match *of {
        Of::Device(station) => named(&data.stations, station),
        Of::Target(target) => named(&data.targets, target),
        Of::Lengths => String::new(),
        Of::Zero(at) | Of::Axis(at) | Of::Give(at) => joint(at),
    });
    let slides = hypothesis.of.first().is_some_and(|of| match *of {
        Of::Zero(at) => model.robot.joints[at].kind == JointKind::Prismatic,
        Of::Device(_) | Of::Target(_) | Of::Lengths | Of::Axis(_) | Of::Give(_) => false,
    });
    let scale = verdict.variance.sqrt();
    let sizes = tried.step.iter().zip(&hypothesis.turns);
    let sizes = sizes.map(|(&(value, sigma), &turns)| Size { value, sigma: scale * sigma, turns });
    Explanation {
        kind: hypothesis.kind,
        names: names.collect(),
        slides,
        sizes: sizes.collect(),
        gain: tried.gain / verdict.variance,
    }
}
