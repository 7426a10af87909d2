//! Outcome of a target by the motions to it.

use std::borrow::Cow;
use std::f64::consts::TAU;

use super::reasons as reason;
use poecal_arm::lie::Pose;
use poecal_programs::stated_configuration::StatedConfiguration;

/// Reason why a target is unchanged.
pub(crate) type UnchangedReason = Cow<'static, str>;

/// Finding for a target, or the reason why it is unchanged.
pub(crate) type TargetResult<T> = std::result::Result<T, UnchangedReason>;

/// Frames and configuration of a target during its correction.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlacedTarget {
    pub(crate) tool: Pose,
    pub(crate) frame: Pose,
    pub(crate) q: Vec<f64>,
    pub(crate) stated: StatedConfiguration,
}

/// Outcome of a target.
#[derive(Clone, Debug)]
pub(crate) enum TargetOutcome {
    Open,
    Placed(Box<PlacedTarget>),
    Listed(UnchangedReason, usize),
}

/// Outcome of a target with another motion, on this line.
pub(crate) fn join_outcomes(fate: TargetOutcome, placed: TargetResult<PlacedTarget>, line: usize) -> TargetOutcome {
    match (fate, placed) {
        (TargetOutcome::Open, Ok(placed)) => TargetOutcome::Placed(Box::new(placed)),
        (TargetOutcome::Open | TargetOutcome::Placed(_), Err(reason)) => TargetOutcome::Listed(reason, line),
        (TargetOutcome::Listed(reason, line), _) => TargetOutcome::Listed(reason, line),
        (TargetOutcome::Placed(one), Ok(other)) => match differs(&one, &other) {
            Some(reason) => TargetOutcome::Listed(reason.into(), line),
            None => TargetOutcome::Placed(one),
        },
    }
}

/// Difference between two motions to one target.
fn differs(one: &PlacedTarget, other: &PlacedTarget) -> Option<&'static str> {
    let is_same = |a: &Pose, b: &Pose| {
        let (metres, radians) = a.distance_and_angle(b);
        metres < 1e-12 && radians < 1e-12
    };
    if !is_same(&one.tool, &other.tool) || !is_same(&one.frame, &other.frame) {
        return Some(reason::TWO_PLACES);
    }
    let is_turned = |a: &f64, b: &f64| {
        let turns = ((a - b) / TAU).round();
        (a - b - turns * TAU).abs() > 1e-6
    };
    one.q.iter().zip(&other.q).any(|(a, b)| is_turned(a, b)).then_some(reason::TWO_WAYS)
}
