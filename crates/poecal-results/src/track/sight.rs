//! Detectable shift of each joint's zero, and the reason if none is detectable.

use nalgebra::DMatrix;

use super::explain::{ExplanationKind, HypothesisTests, HypothesisVerdict, MotionHypothesis, ProjectedChanges, Size};
use super::hypotheses::find_free_columns;
use super::model::VisitModel;
use super::options::{MOST_M, MOST_RAD, TrackOptions};
use super::pairs::VisitChanges;
use super::visit::{ColumnSubject, Visit};
use poecal_model::robot::JointKind;

/// Normal quantile of 95 %.
const NORMAL: f64 = 1.644_853_627;

/// Reason why the zero of a joint is not seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Undetectable {
    /// The device was set up anew: its frame absorbs the shift.
    Device,
    /// The tool was mounted anew: its targets absorb the shift.
    Tool,
    /// Both together absorb it.
    DeviceAndTool,
    /// The joint moves no target, or none by enough.
    NoMotion,
}

/// Detectability of a shift of a joint's zero.
#[derive(Clone, Debug, PartialEq)]
pub struct JointSight {
    /// Its name.
    pub joint: String,
    /// True if it slides, so that its zero is a length.
    pub slides: bool,
    /// Standard deviation of its shift, radians or metres; infinite if it is not seen.
    pub sigma: f64,
    /// Smallest shift that is detected with a probability of 95 %, radians or metres.
    pub smallest: f64,
    /// Reason why it is not seen at all.
    pub unseen: Option<Undetectable>,
    /// Estimated shift of its zero beside the explanation. `None` if it is not seen beside that, nothing explains the changes, or nothing was
    /// measured.
    pub shift: Option<Size>,
}

/// Ratio of the smallest shift that is detected with 95 % to its standard deviation. `quantile` is the critical value (a square) with `freedom`
/// degrees of freedom. The noncentral t has its normal approximation (abramowitz1964, 26.7.10, without its term 1/(4ν)).
pub(crate) fn smallest_detectable(quantile: f64, freedom: f64) -> f64 {
    let t = quantile.sqrt();
    t + NORMAL * (1.0 + 0.5 * quantile / freedom.max(1.0)).sqrt()
}

/// Detectability of all joints.
pub(crate) fn joints(
    changes: &VisitChanges,
    visit: &Visit,
    model: &VisitModel,
    (hypotheses, tests): (&[MotionHypothesis], &HypothesisTests),
    (variance, freedom): (f64, f64),
    options: &TrackOptions,
) -> Vec<JointSight> {
    let beside = |options: &TrackOptions, device_is_known: bool| {
        let visit = Visit { device_is_known, ..visit.clone() };
        ProjectedChanges::new(&changes.residual, &find_free_columns(&changes.jacobian, &visit, options))
    };
    let known_tool = TrackOptions { tool_is_anew: false, ..*options };
    let all = [
        beside(options, visit.device_is_known),
        beside(options, true),
        beside(&known_tool, visit.device_is_known),
        beside(&known_tool, true),
    ];
    let zeros = hypotheses.iter().enumerate().filter(|(_, it)| it.kind == ExplanationKind::Zero);
    let sight = |(at, it): (usize, &MotionHypothesis)| {
        let Some(&ColumnSubject::Zero(index)) = it.of.first() else { return None };
        let joint = &model.robot.joints[index];
        let slides = joint.kind == JointKind::Prismatic;
        let most = if slides { MOST_M } else { MOST_RAD };
        let factor = smallest_detectable(tests.quantile(at, 1, freedom), freedom);
        let sigma = |evidence: &ProjectedChanges| variance.sqrt() * evidence.sigma(&it.columns);
        let [own, device, tool, both] = [0, 1, 2, 3].map(|k| sigma(&all[k]));
        // A free device or tool is the reason only if a shift would be clearly visible with it known.
        let is_seen = |sigma: f64| factor * sigma <= if sigma < own { 0.25 * most } else { most };
        let unseen = match () {
            () if is_seen(own) => None,
            () if !visit.device_is_known && is_seen(device) => Some(Undetectable::Device),
            () if options.tool_is_anew && is_seen(tool) => Some(Undetectable::Tool),
            () if (options.tool_is_anew || !visit.device_is_known) && is_seen(both) => {
                Some(Undetectable::DeviceAndTool)
            }
            () => Some(Undetectable::NoMotion),
        };
        Some(JointSight { joint: joint.name.clone(), slides, sigma: own, smallest: factor * own, unseen, shift: None })
    };
    zeros.filter_map(sight).collect()
}

/// The shift of each joint's zero, in the order of [`joints`], beside the explanation of the changes; for a joint that the explanation names, the
/// explanation's.
pub(crate) fn shifts(
    evidence: &ProjectedChanges,
    hypotheses: &[MotionHypothesis],
    verdict: &HypothesisVerdict,
) -> Vec<Option<Size>> {
    let best = verdict.best.as_ref().and_then(|it| hypotheses.get(it.at));
    let shift = |zero: &MotionHypothesis| {
        // Each zero of an explanation is one of its columns.
        let named = best.and_then(|it| it.of.iter().position(|of| zero.of.contains(of)));
        let beside = best.map_or_else(|| DMatrix::zeros(zero.columns.nrows(), 0), |it| it.columns.clone());
        let at = named.unwrap_or(beside.ncols());
        let columns = if named.is_some() { beside } else { join_columns(&beside, &zero.columns) };
        let &(value, sigma) = evidence.steps(&columns)?.get(at)?;
        Some(Size { value, sigma: verdict.variance.sqrt() * sigma, turns: zero.turns.first() == Some(&true) })
    };
    hypotheses.iter().filter(|it| it.kind == ExplanationKind::Zero).map(shift).collect()
}

/// Columns of two matrices side by side.
fn join_columns(one: &DMatrix<f64>, other: &DMatrix<f64>) -> DMatrix<f64> {
    let mut all = one.clone().resize_horizontally(one.ncols() + other.ncols(), 0.0);
    all.columns_mut(one.ncols(), other.ncols()).copy_from(other);
    all
}

/// The joints with their estimated shifts; `None` for a joint that is not seen.
pub(crate) fn with_shifts(mut joints: Vec<JointSight>, shifts: Vec<Option<Size>>) -> Vec<JointSight> {
    for (joint, shift) in joints.iter_mut().zip(shifts) {
        joint.shift = shift.filter(|_| joint.unseen.is_none());
    }
    joints
}
