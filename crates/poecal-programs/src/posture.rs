//! Posture of an arm of six axes, by the makers' terms for its configurations.

use nalgebra::Vector3;
use poecal_arm::Arm;

use super::shape::{axes, wrist_centre};

/// Angle (rad) within which a joint may be on either side of a border.
pub(crate) const MARGIN: f64 = 0.01;
/// Share of the reach below which a point is on neither side of an axis.
const ASIDE: f64 = 0.005;
/// Share of the reach within which the axes of a wrist intersect.
const MEET: f64 = 1e-3;

/// An axis: a point on it, and its direction.
type AxisLine = (Vector3<f64>, Vector3<f64>);

/// An arm in the makers' zero configuration at readings 0: lower arm upright, forearm horizontal and to the front, wrist straight. Front, elbow and
/// wrist are only defined for such an arm.
///
/// The positions of axes determine its sides, not the signs of readings. The wrist centre W is before or behind the first axis by `(W - o₁)·f`,
/// with the front f rotated by the first joint. It is before or behind the line of the lower arm from o₂ to o₃ by `((o₃ - o₂) × (W - o₂))·z₂`. The
/// fifth joint counts by the sign of its angle.
#[derive(Clone, Debug)]
pub(crate) struct Posture<'a> {
    arm: &'a Arm,
    /// Front at zero, horizontal, of length 1.
    front: Vector3<f64>,
    /// Sign of the lower arm's side on which the wrist is at zero.
    side: f64,
    /// Direction of the lower arm at zero.
    up: Vector3<f64>,
    /// True if negative angles of the fifth joint bend the hand down with the other joints at zero.
    is_down_negative: bool,
}

/// Posture of an arm; `None` for a criterion too near to its border.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct BendSigns {
    /// The wrist centre is before the first axis.
    pub(crate) is_front: Option<bool>,
    /// The wrist centre is before the lower arm, on the same side as at zero.
    pub(crate) is_before_arm: Option<bool>,
    /// The lower arm points up.
    pub(crate) is_arm_up: Option<bool>,
    /// The angle of the fifth joint is positive.
    pub(crate) is_wrist_positive: Option<bool>,
}

impl<'a> Posture<'a> {
    /// The posture of an arm; `None` if its structure or zero differs.
    pub(crate) fn new(arm: &'a Arm) -> Option<Self> {
        let (axes, wrist) = wrist_axes(arm, &[0.0; 6])?;
        let reach = arm.reach_m();
        let meets = |(point, direction): &AxisLine| {
            let off = wrist - point;
            (off - direction * direction.dot(&off)).norm() < MEET * reach
        };
        let level = |it: Vector3<f64>| it - axes[0].1 * axes[0].1.dot(&it);
        let across = |it: Vector3<f64>| it - axes[1].1 * axes[1].1.dot(&it);
        let lower = across(axes[2].0 - axes[1].0);
        let front = level(wrist - axes[0].0);
        let up = lower.try_normalize(MEET * reach)?;
        let is_built = axes[3..].iter().all(meets)
            && axes[1].1.cross(&axes[2].1).norm() < MARGIN
            && axes[0].1.dot(&axes[1].1).abs() < MARGIN
            && axes[3].1.dot(&axes[4].1).abs() < MARGIN
            && axes[3].1.cross(&axes[5].1).norm() < MARGIN
            && axes[4].1.cross(&axes[1].1).norm() < MARGIN;
        let is_zeroed = up.dot(&axes[0].1).abs() > 0.95
            && axes[3].1.dot(&axes[0].1).abs() < 0.2
            && across(front).norm() > 0.1 * reach;
        if !is_built || !is_zeroed {
            return None;
        }
        let front = across(front).normalize();
        // Rotation by the fifth joint moves the hand, which points to the front, by z₅ × f.
        let down = -axes[4].1.cross(&front).dot(&up);
        let side = lower.cross(&(wrist - axes[1].0)).dot(&axes[1].1).signum();
        Some(Posture { arm, front, side, up, is_down_negative: down < 0.0 })
    }

    /// True if negative angles of the fifth joint bend the hand down with the other joints at zero.
    pub(crate) fn is_down_negative(&self) -> bool {
        self.is_down_negative
    }

    /// The posture at readings (rad).
    pub(crate) fn bends_at(&self, q: &[f64; 6]) -> BendSigns {
        let Some((axes, wrist)) = wrist_axes(self.arm, q) else { return BendSigns::default() };
        let reach = self.arm.reach_m();
        let first = axes[0].1;
        // The front rotates with the second axis, which is perpendicular to it at zero.
        let front = self.level_direction(&axes, self.front);
        let ahead = front.dot(&(wrist - axes[0].0));
        let across = |it: Vector3<f64>| it - axes[1].1 * axes[1].1.dot(&it);
        let (lower, whole) = (across(axes[2].0 - axes[1].0), across(wrist - axes[1].0));
        let side = self.side * lower.cross(&whole).dot(&axes[1].1) / lower.norm();
        let upright = lower.normalize().dot(&(first * self.up.dot(&first).signum()));
        let told = |value: f64, least: f64| (value.abs() > least).then_some(value > 0.0);
        BendSigns {
            is_front: told(ahead, ASIDE * reach),
            is_before_arm: told(side, ASIDE * reach),
            is_arm_up: told(upright, 0.05),
            is_wrist_positive: told(q[4].sin(), MARGIN),
        }
    }

    /// Present direction of a horizontal direction at zero that is fixed to the link between the first two joints.
    fn level_direction(&self, axes: &[AxisLine; 6], direction: Vector3<f64>) -> Vector3<f64> {
        let Some(second) = self.arm.screws().get(1).map(poecal_arm::lie::Screw::direction) else {
            return direction;
        };
        let first = axes[0].1;
        let other = first.cross(&second);
        let now = first.cross(&axes[1].1);
        axes[1].1 * direction.dot(&second) + now * direction.dot(&other)
    }
}

/// The axes of six joints at readings, directions of length 1, and the wrist centre.
fn wrist_axes(arm: &Arm, q: &[f64; 6]) -> Option<([AxisLine; 6], Vector3<f64>)> {
    if arm.joints() != 6 {
        return None;
    }
    let mut axes: [AxisLine; 6] = axes(arm, q).try_into().ok()?;
    for (_, direction) in &mut axes {
        *direction = direction.try_normalize(1e-3)?;
    }
    let wrist = wrist_centre(&axes)?;
    Some((axes, wrist))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use nalgebra::Vector3;
    use poecal_arm::Arm;

    use super::Posture;
    use poecal_arm::lie::{Pose, Screw};

    /// An arm by directions of its axes and points on them.
    fn arm(axes: [([f64; 3], [f64; 3]); 6], tip: [f64; 3]) -> Arm {
        let screws = axes.map(|(axis, point)| Screw::revolute(&Vector3::from(axis), &Vector3::from(point)));
        Arm::new(&screws, &Pose::from_translation(Vector3::from(tip))).unwrap()
    }

    /// The sides change when the arm passes the border, and nowhere else.
    #[test]
    fn sides_are_those_of_the_drawing() {
        let arm = arm(
            [
                ([0.0, 0.0, 1.0], [0.0, 0.0, 0.0]),
                ([0.0, 1.0, 0.0], [0.15, 0.0, 0.0]),
                ([0.0, -1.0, 0.0], [0.15, 0.0, 0.57]),
                ([-1.0, 0.0, 0.0], [0.15, 0.0, 0.72]),
                ([0.0, 1.0, 0.0], [0.784, 0.0, 0.72]),
                ([-1.0, 0.0, 0.0], [0.784, 0.0, 0.72]),
            ],
            [0.834, 0.0, 0.72],
        );
        let posture = Posture::new(&arm).unwrap();
        let at = |degrees: [f64; 6]| posture.bends_at(&degrees.map(f64::to_radians));
        let level = at([0.0, 0.0, 0.0, 0.0, 30.0, 0.0]);
        assert_eq!(level.is_front, Some(true));
        assert_eq!(level.is_before_arm, Some(true));
        assert_eq!(level.is_arm_up, Some(true));
        assert_eq!(level.is_wrist_positive, Some(true));
        // Its third axis rotates the forearm up: over the top of the lower arm to the other side.
        let over = at([70.0, 0.0, 120.0, 0.0, -30.0, 0.0]);
        assert_eq!(
            (over.is_front, over.is_before_arm, over.is_wrist_positive),
            (Some(false), Some(false), Some(false))
        );
        // With the arm leaning back, the elbow is bent as before.
        let back = at([-50.0, -80.0, 40.0, 10.0, 30.0, 0.0]);
        assert_eq!((back.is_front, back.is_before_arm, back.is_arm_up), (Some(false), Some(true), Some(true)));
        assert_eq!(at([0.0; 6]).is_wrist_positive, None);
        // Its fifth axis is to the left, so that positive angles bend the hand down.
        assert!(!posture.is_down_negative());
    }

    /// An arm whose second to fourth axes are parallel has no wrist in which three axes meet.
    #[test]
    fn arms_of_another_kind_have_no_sides() {
        let arm = arm(
            [
                ([0.0, 0.0, 1.0], [0.0, 0.0, 0.0]),
                ([0.0, 1.0, 0.0], [0.0, 0.0, 0.16]),
                ([0.0, 1.0, 0.0], [0.0, 0.0, 0.58]),
                ([0.0, 1.0, 0.0], [0.39, 0.0, 0.58]),
                ([0.0, 0.0, -1.0], [0.39, 0.13, 0.58]),
                ([0.0, 1.0, 0.0], [0.39, 0.13, 0.48]),
            ],
            [0.39, 0.23, 0.48],
        );
        assert!(Posture::new(&arm).is_none());
    }
}
