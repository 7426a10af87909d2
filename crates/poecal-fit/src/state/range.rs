//! Readings of an instrument that measures distances: zero and scale.

use nalgebra::Vector3;

use poecal_arm::lie::Pose;
use poecal_model::measurement::Sensitivity;

/// Zero and scale of an instrument's distances: it reads `(1 + s) |p| + o` for a target at p (theory.md §4 (15d)). For a sphere that is
/// touched, the zero is minus its radius.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RangeModel {
    /// Reading at the instrument itself, metres.
    pub zero_m: f64,
    /// Growth of the reading with the distance, less 1.
    pub scale: f64,
}

/// One of the two, as an unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RangeTerm {
    /// Zero, metres.
    Zero,
    /// Scale.
    Scale,
}

impl RangeTerm {
    /// Both terms.
    pub const ALL: [RangeTerm; 2] = [RangeTerm::Zero, RangeTerm::Scale];

    /// Name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            RangeTerm::Zero => "zero",
            RangeTerm::Scale => "scale",
        }
    }
}

impl RangeModel {
    /// True if a reading is the distance itself.
    pub(crate) fn is_plain(&self) -> bool {
        *self == RangeModel::default()
    }

    /// Reading of the instrument for a target at this pose: below zero inside a sphere that is touched.
    #[must_use]
    pub(crate) fn reading(&self, target: &Pose) -> f64 {
        target.translation.norm() * (1.0 + self.scale) + self.zero_m
    }

    /// Pose of the target at the distance that is read, in its direction.
    #[must_use]
    pub fn locate_target(&self, target: &Pose) -> Pose {
        let place = target.translation;
        let direction = place.try_normalize(0.0).unwrap_or_default();
        Pose { translation: place * (1.0 + self.scale) + direction * self.zero_m, ..*target }
    }

    /// Transforms a sensitivity at the read position to one at the target.
    pub(crate) fn pull_back(&self, target: &Pose, sensitivity: &mut [Sensitivity]) {
        let place = target.translation;
        let Some(direction) = place.try_normalize(0.0) else { return };
        let across = self.zero_m / place.norm();
        for [x, y, z, ..] in sensitivity {
            let own = Vector3::new(*x, *y, *z);
            let moved = own * (1.0 + self.scale + across) - direction * (across * own.dot(&direction));
            (*x, *y, *z) = (moved.x, moved.y, moved.z);
        }
    }

    /// Motion of the read position by a unit of a term.
    pub(crate) fn motion(target: &Pose, term: RangeTerm) -> Vector3<f64> {
        match term {
            RangeTerm::Zero => target.translation.try_normalize(0.0).unwrap_or_default(),
            RangeTerm::Scale => target.translation,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zero_moves_what_is_seen_along_the_line_of_sight() {
        let target = Pose::from_translation(Vector3::new(0.0, 2.0, 0.0));
        assert_eq!(RangeModel { zero_m: 0.1, scale: 0.0 }.locate_target(&target).translation.y, 2.1);
    }
}
