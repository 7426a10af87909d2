//! The configuration of a `robtarget`: `[cf1,cf4,cf6,cfx]`.

use std::f64::consts::FRAC_PI_2;

use poecal_arm::Arm;

use super::super::posture::{MARGIN, Posture};

/// Quarter turns of joints 1, 4 and 6, and the branch.
///
/// A joint with quarter turn c is at `[c, c + 1)·90°`. The branch is a sum of 4 if the wrist centre is behind the first axis, 2 if it is behind the
/// lower arm, and 1 for a negative angle of the fifth joint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RapidConfiguration {
    /// Quarter turns cf1, cf4, cf6.
    pub(crate) quarters: [i32; 3],
    /// Branch cfx.
    pub(crate) branch: i32,
}

/// Joints of the quarter turns, from 0.
const JOINTS: [usize; 3] = [0, 3, 5];
/// Angle (rad) beyond a border that is attributed to rounding of written numbers.
const ROUNDING: f64 = 1e-6;

impl RapidConfiguration {
    /// True if the quarter turns of a configuration of the nominal arm (rad) fit, borders included.
    pub(crate) fn fits(&self, q: &[f64]) -> bool {
        q.len() == 6 && self.quarters.iter().zip(JOINTS).all(|(&quarter, joint)| is_in(quarter, q.get(joint), MARGIN))
    }

    /// True if the branch fits, as far as it is determined, for arms with defined sides. The sides of the lower arm are defined if the lower arm
    /// points up and the wrist is before the first axis.
    pub(crate) fn branch_fits(&self, nominal: &Arm, q: &[f64]) -> bool {
        let Ok(q) = <&[f64; 6]>::try_from(q) else { return false };
        let Some(posture) = Posture::new(nominal).filter(|_| (0..8).contains(&self.branch)) else {
            return true;
        };
        let bent = posture.bends_at(q);
        let agrees = |found: Option<bool>, bit: i32| found.is_none_or(|it| it == (self.branch & bit == 0));
        agrees(bent.is_front, 4)
            && agrees(bent.is_wrist_positive, 1)
            && (bent.is_arm_up != Some(true) || bent.is_front != Some(true) || agrees(bent.is_before_arm, 2))
    }

    /// The four numbers at a configuration of the nominal arm (rad): stated quarter turns are kept if they still hold.
    pub(crate) fn words(&self, q: &[f64]) -> Vec<f64> {
        let quarter = |(&stated, joint): (&i32, usize)| {
            let value = q.get(joint);
            let own = (value.copied().unwrap_or(0.0) / FRAC_PI_2).floor();
            if is_in(stated, value, ROUNDING) { f64::from(stated) } else { own }
        };
        self.quarters.iter().zip(JOINTS).map(quarter).chain([f64::from(self.branch)]).collect()
    }
}

/// True if a joint (rad) is in a quarter turn, or at most `beyond` outside of it.
fn is_in(quarter: i32, value: Option<&f64>, beyond: f64) -> bool {
    let start = f64::from(quarter) * FRAC_PI_2;
    value.is_some_and(|it| (start - beyond..=start + FRAC_PI_2 + beyond).contains(it))
}
