//! Result of a visit.

use super::explain::{ExplanationKind, HypothesisVerdict, MotionHypothesis, Size, TriedHypothesis};
use super::model::VisitModel;
use super::options::{JudgingBasis, MOST_RAD, RobotCondition, TrackOptions};
use super::sight::JointSight;
use super::visit::ColumnSubject;
use poecal_fit::analysis::JointCoverage;
use poecal_model::measurement::Dataset;
use poecal_model::robot::JointKind;

/// An explanation of the changes.
#[derive(Clone, Debug, PartialEq)]
pub struct ChangeExplanation {
    /// Its kind.
    pub kind: ExplanationKind,
    /// Names of the joints, targets or devices.
    pub names: Vec<String>,
    /// True if the first joint slides, so that its zero is a length.
    pub slides: bool,
    /// Its unknowns.
    pub sizes: Vec<Size>,
    /// Squares that it explains, in variances of a number.
    pub gain: f64,
}

/// Result of a visit.
#[derive(Clone, Debug, PartialEq)]
pub struct VisitResult {
    /// Knowledge of the visit.
    pub options: TrackOptions,
    /// State of the robot: unchanged or changed.
    pub state: RobotCondition,
    /// Reference by which the rows were judged.
    pub judged_by: JudgingBasis,
    /// Number of rows of the visit.
    pub rows: usize,
    /// Number of these that repeat configurations of the earlier visit.
    pub repeated: usize,
    /// The simplest sufficient explanation; `None` for an unchanged robot, and if no explanation suffices.
    pub explanation: Option<ChangeExplanation>,
    /// Others that explain the changes nearly as well.
    pub alternatives: Vec<ChangeExplanation>,
    /// Detectable shift of each joint's zero, and the reason for those that cannot be seen.
    pub joints: Vec<JointSight>,
    /// Part of each joint's range that the rows sample.
    pub ranges: Vec<JointCoverage>,
    /// Root mean square change of measured positions with the free unknowns fitted, metres: noise of both visits is in it.
    pub change_m: f64,
    /// Root mean square change that the explanation leaves, metres.
    pub left_m: f64,
    /// Standard deviation of each coordinate, metres: the stated repeatability, or an estimate.
    pub noise_m: f64,
    /// Degrees of freedom of that.
    pub freedom: f64,
    /// Root mean square error of the delivered model in this visit, metres: with the frame of the device fitted, unless that is known.
    pub error_m: f64,
    /// Further notes, a sentence each.
    pub notes: Vec<String>,
}

impl ChangeExplanation {
    /// Length of the vector of its angles or of its lengths, radians or metres, with the standard deviation along it; `None` if it has none.
    #[must_use]
    pub fn size(&self, turns: bool) -> Option<(f64, f64)> {
        let own: Vec<&Size> = self.sizes.iter().filter(|it| it.turns == turns).collect();
        if let [only] = own.as_slice() {
            return Some((only.value, only.sigma));
        }
        let length = own.iter().map(|it| it.value * it.value).sum::<f64>().sqrt();
        let along =
            own.iter().map(|it| (it.value * it.sigma).powi(2)).sum::<f64>().sqrt() / length.max(f64::MIN_POSITIVE);
        (!own.is_empty()).then_some((length, along))
    }

    /// True if it exceeds the linear range.
    #[must_use]
    pub fn is_far(&self) -> bool {
        matches!(
            self.kind,
            ExplanationKind::Zero | ExplanationKind::TwoZeros | ExplanationKind::Zeros | ExplanationKind::Axis
        ) && self.sizes.iter().any(|it| it.turns && it.value.abs() > MOST_RAD)
    }
}

/// An explanation with names and sizes.
pub(crate) fn explanation(
    tried: &TriedHypothesis,
    hypothesis: &MotionHypothesis,
    verdict: &HypothesisVerdict,
    model: &VisitModel,
    data: &Dataset,
) -> ChangeExplanation {
    let joint = |joint: usize| model.robot.joints[joint].name.clone();
    let named = |names: &[Option<String>], at: usize| names.get(at).cloned().flatten().unwrap_or_default();
    let names = hypothesis.of.iter().map(|of| match *of {
        ColumnSubject::Device(station) => named(&data.stations, station),
        ColumnSubject::Target(target) => named(&data.targets, target),
        ColumnSubject::Lengths => String::new(),
        ColumnSubject::Zero(at) | ColumnSubject::Axis(at) | ColumnSubject::Give(at) => joint(at),
    });
    let slides = hypothesis.of.first().is_some_and(|of| match *of {
        ColumnSubject::Zero(at) => model.robot.joints[at].kind == JointKind::Prismatic,
        ColumnSubject::Device(_)
        | ColumnSubject::Target(_)
        | ColumnSubject::Lengths
        | ColumnSubject::Axis(_)
        | ColumnSubject::Give(_) => false,
    });
    let scale = verdict.variance.sqrt();
    let sizes = tried.step.iter().zip(&hypothesis.turns);
    let sizes = sizes.map(|(&(value, sigma), &turns)| Size { value, sigma: scale * sigma, turns });
    ChangeExplanation {
        kind: hypothesis.kind,
        names: names.collect(),
        slides,
        sizes: sizes.collect(),
        gain: tried.gain / verdict.variance,
    }
}
