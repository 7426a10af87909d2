//! How much of each joint's range the fitted measurements take in.

use crate::estimate::Packed;
use crate::robot::{JointKind, Limits, Robot};

/// What of a joint's range was sampled, radians or metres.
///
/// ```
/// use poecal::{calibration::Coverage, robot::JointKind};
/// let half = Coverage { joint: "a".into(), kind: JointKind::Revolute, sampled: [0.0, 1.5], limits: Some([-1.5, 1.5]) };
/// assert_eq!(half.share(), Some(0.5));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Coverage {
    /// The joint's name.
    pub joint: String,
    /// Its kind.
    pub kind: JointKind,
    /// Least and largest value in the rows that were fitted.
    pub sampled: [f64; 2],
    /// Its limits, if the model has any that are no placeholders.
    pub limits: Option<[f64; 2]>,
}

impl Coverage {
    /// The sampled span over that of the limits; of a revolute joint over a whole turn, where the limits allow more or are missing. `None`
    /// for a sliding joint without limits.
    #[must_use]
    pub fn share(&self) -> Option<f64> {
        let span = self.sampled[1] - self.sampled[0];
        let turn = std::f64::consts::TAU;
        let all = match (self.kind, self.limits) {
            (JointKind::Revolute, limits) => limits.map_or(turn, |[lower, upper]| (upper - lower).min(turn)),
            (JointKind::Prismatic, Some([lower, upper])) => upper - lower,
            (JointKind::Prismatic, None) => return None,
        };
        (all > 0.0).then(|| (span / all).min(1.0))
    }

    /// Whether a value lies in the sampled range; of a revolute joint also after whole turns, which change no geometry.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        // Readings come rounded; what differs by less is the same configuration.
        const ROUNDING: f64 = 1e-6;
        let [least, most] = [self.sampled[0] - ROUNDING, self.sampled[1] + ROUNDING];
        match self.kind {
            JointKind::Prismatic => (least..=most).contains(&value),
            JointKind::Revolute => {
                let turn = std::f64::consts::TAU;
                value - turn * ((value - least) / turn).floor() <= most
            }
        }
    }
}

/// The coverage of every joint by some rows.
#[must_use]
pub fn coverage(robot: &Robot, packed: &Packed, rows: &[u32]) -> Vec<Coverage> {
    robot
        .joints
        .iter()
        .enumerate()
        .map(|(index, joint)| {
            let values = rows.iter().map(|&row| packed.joint_values(row as usize)[index]);
            let (least, most) =
                values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), value| (a.min(value), b.max(value)));
            let real = |limits: &Limits| {
                joint.kind == JointKind::Revolute || limits.upper - limits.lower < Limits::PLACEHOLDER_M
            };
            Coverage {
                joint: joint.name.clone(),
                kind: joint.kind,
                sampled: [least, most],
                limits: joint.limits.filter(real).map(|limits| [limits.lower, limits.upper]),
            }
        })
        .collect()
}
