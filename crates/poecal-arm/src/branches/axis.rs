//! Axes as a direction and a point, and rotations about them.

use nalgebra::Vector3;

use crate::lie::Screw;
use crate::trig::cosine_and_sine;

// The functions of numbers, where there is no standard library.
#[allow(unused_imports)]
use nalgebra::{ComplexField as _, RealField as _};

/// The axis of a revolute joint at zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RevoluteAxis {
    pub(crate) w: Vector3<f64>,
    pub(crate) point: Vector3<f64>,
}

impl RevoluteAxis {
    pub(crate) fn from_screw(screw: &Screw) -> Self {
        RevoluteAxis { w: screw.w(), point: screw.nearest_point(&Vector3::zeros()) }
    }

    /// A direction after a rotation.
    #[inline]
    pub(crate) fn rotate(&self, (c, s): (f64, f64), v: &Vector3<f64>) -> Vector3<f64> {
        v * c + self.w.cross(v) * s + self.w * ((1.0 - c) * self.w.dot(v))
    }

    /// A point after a rotation.
    #[inline]
    pub(crate) fn rotate_point(&self, turn: (f64, f64), p: &Vector3<f64>) -> Vector3<f64> {
        self.point + self.rotate(turn, &(p - self.point))
    }

    /// Angle that turns `from` closest to `to`.
    #[inline]
    pub(crate) fn angle(&self, from: &Vector3<f64>, to: &Vector3<f64>) -> f64 {
        let across = self.w.dot(&from.cross(to));
        let along = from.dot(to) - self.w.dot(from) * self.w.dot(to);
        if across == 0.0 && along == 0.0 { 0.0 } else { across.atan2(along) }
    }

    /// Point between two axes that is nearest to both, and their distance there; `None` if they are parallel.
    pub(crate) fn midpoint(&self, other: &RevoluteAxis) -> Option<(Vector3<f64>, f64)> {
        let across = self.w.cross(&other.w);
        let squared = across.norm_squared();
        if squared < 1e-4 {
            return None;
        }
        let gap = other.point - self.point;
        let here = self.point + self.w * (gap.cross(&other.w).dot(&across) / squared);
        let there = other.point + other.w * (gap.cross(&self.w).dot(&across) / squared);
        Some(((here + there) * 0.5, (there - here).norm()))
    }

    /// Distance of a point.
    pub(crate) fn distance(&self, p: &Vector3<f64>) -> f64 {
        self.w.cross(&(p - self.point)).norm()
    }
}

/// `(cos, sin)` of minus the angle.
#[inline]
pub(crate) fn reverse_turn(angle: f64) -> (f64, f64) {
    let (c, s) = cosine_and_sine(angle);
    (c, -s)
}
