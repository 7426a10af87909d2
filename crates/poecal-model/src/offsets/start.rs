//! Offsets in closed form, joint by joint: exact if the robots differ by offsets alone, otherwise a start for the least squares.

use nalgebra::Vector3;

use super::EndConstraint;
use super::fit::{OffsetState, RobotPair};
use poecal_arm::lie::{Pose, Screw, hat};

/// Sine of an angle, or share of the arm's length, below which a motion does not determine an offset.
const LEAST_MOTION: f64 = 1e-3;

impl RobotPair<'_> {
    /// State in which each offset turns the next screw that it moves as near as possible to the actual one; a free base first takes
    /// the first screw there.
    pub(crate) fn sequential(&self, base: EndConstraint) -> OffsetState {
        let base = match base {
            EndConstraint::Kept => Pose::identity(),
            EndConstraint::Free => self.base_by_first_screws(),
        };
        let mut motion = base;
        let mut offsets = Vec::with_capacity(self.nominal.joints.len());
        for (index, joint) in self.nominal.joints.iter().enumerate() {
            let about = joint.screw.transform(&motion);
            let by_screws = self.by_next_screw(&about, index, &motion);
            let offset = by_screws.or_else(|| self.by_home(&about, &motion)).unwrap_or(0.0);
            offsets.push(offset);
            motion = about.exp(offset) * motion;
        }
        OffsetState { offsets, base }
    }

    /// Motion that takes the first screw to the actual one, with the rotation about it and the shift along it that fit the next screws.
    fn base_by_first_screws(&self) -> Pose {
        let (Some(from), Some(to)) = (self.nominal.joints.first(), self.actual.joints.first()) else {
            return Pose::identity();
        };
        let to_first = from.screw.smallest_motion_to(&to.screw, &from.frame.translation);
        let direction = to.screw.direction();
        let turn = Screw::revolute(&direction, &to.screw.nearest_point(&to.frame.translation));
        let turned = turn.exp(self.by_next_screw(&turn, 0, &to_first).unwrap_or(0.0)) * to_first;
        let slide = Screw::prismatic(&direction);
        slide.exp(self.by_next_screw(&slide, 0, &turned).unwrap_or(0.0)) * turned
    }

    /// Value of `about` by the first screw after joint `index` that it moves; later screws are moved by `motion`.
    fn by_next_screw(&self, about: &Screw, index: usize, motion: &Pose) -> Option<f64> {
        let pairs = self.nominal.joints.iter().zip(&self.actual.joints).skip(index + 1);
        let mut values = pairs.map(|(nominal, actual)| {
            let moving = nominal.screw.transform(motion);
            let origin = actual.screw.nearest_point(&actual.frame.translation);
            nearest_value(about, &moving, &actual.screw, &origin, LEAST_MOTION * self.length_m)
        });
        values.find_map(|value| value)
    }

    /// Value of `about` that brings the home pose, moved by `motion`, nearest; `None` if the tip is free.
    fn by_home(&self, about: &Screw, motion: &Pose) -> Option<f64> {
        if self.options.tip == EndConstraint::Free {
            return None;
        }
        let (home, goal) = (*motion * self.nominal.home, self.actual.home);
        let direction = about.direction();
        if about.is_prismatic() {
            return Some(direction.dot(&(goal.translation - home.translation)));
        }
        // tr(exp(φŵ) A) = cos φ (tr A - w·Aw) + sin φ tr(ŵA) + const is largest for the nearest rotations.
        let between = home.rotation * goal.rotation.transpose();
        let sine = (hat(&direction) * between).trace();
        Some(sine.atan2(between.trace() - direction.dot(&(between * direction))))
    }
}

/// Value by which `about` brings `moving` nearest to `to`, an axis relative to `origin`; `None` if it does not move it. Directions
/// decide, and positions if directions do not move: motions of at least `least_motion_m` (metres).
fn nearest_value(about: &Screw, moving: &Screw, to: &Screw, origin: &Vector3<f64>, least_motion_m: f64) -> Option<f64> {
    let axis = about.direction();
    let across = |vector: Vector3<f64>, normal: &Vector3<f64>| vector - normal * normal.dot(&vector);
    let angle = |from: Vector3<f64>, to: Vector3<f64>| axis.dot(&from.cross(&to)).atan2(from.dot(&to));
    if about.is_prismatic() {
        let slide = across(axis, &moving.direction());
        if moving.is_prismatic() || slide.norm() < LEAST_MOTION {
            return None;
        }
        let left = moving.nearest_point(origin) - origin;
        return Some(-left.dot(&slide) / slide.norm_squared());
    }
    let lever = across(moving.direction(), &axis);
    if lever.norm() > LEAST_MOTION {
        return Some(angle(lever, across(to.direction(), &axis)));
    }
    if moving.is_prismatic() {
        return None;
    }
    let center = about.nearest_point(origin);
    let lever = across(moving.nearest_point(&center) - center, &axis);
    (lever.norm() > least_motion_m).then(|| angle(lever, across(to.nearest_point(&center) - center, &axis)))
}
