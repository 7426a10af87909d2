//! Outcome of a target by the motions to it.

use std::borrow::Cow;
use std::f64::consts::TAU;

use super::reasons as reason;
use poecal_arm::lie::Pose;
use poecal_programs::stated::Stated;

/// Reason why a target is unchanged.
pub(crate) type Reason = Cow<'static, str>;

/// Finding for a target, or the reason why it is unchanged.
pub(crate) type Found<T> = std::result::Result<T, Reason>;

/// Frames and configuration of a target during its correction.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Placed {
    pub(crate) tool: Pose,
    pub(crate) frame: Pose,
    pub(crate) q: Vec<f64>,
    pub(crate) stated: Stated,
}

/// Outcome of a target.
#[derive(Clone, Debug)]
pub(crate) enum Fate {
    Open,
    Placed(Box<Placed>),
    Listed(Reason, usize),
}

/// Outcome of a target with another motion, on this line.
pub(crate) fn joined(fate: Fate, placed: Found<Placed>, line: usize) -> Fate {
    match (fate, placed) {
        (Fate::Open, Ok(placed)) => Fate::Placed(Box::new(placed)),
        (Fate::Open | Fate::Placed(_), Err(reason)) => Fate::Listed(reason, line),
        (Fate::Listed(reason, line), _) => Fate::Listed(reason, line),
        (Fate::Placed(one), Ok(other)) => match differs(&one, &other) {
            Some(reason) => Fate::Listed(reason.into(), line),
            None => Fate::Placed(one),
        },
    }
}

/// Difference between two motions to one target.
fn differs(one: &Placed, other: &Placed) -> Option<&'static str> {
    let is_same = |a: &Pose, b: &Pose| {
        let (metres, radians) = a.apart(b);
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
