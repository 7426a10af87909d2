//! Frames on axes, and motions of the tip.

use nalgebra::{Matrix3, Vector3};

use crate::lie::{Pose, Screw, rotation};

/// Largest number of joints of an arm, so that computations with it allocate nothing.
pub const MOST_JOINTS: usize = 16;

/// Pose of an arm of up to `N` joints: its tip, and the motion of that with each reading, `velocity = v + w × tip` and `angular = w`, in
/// the base.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ArmState<const N: usize> {
    pub(crate) v: [Vector3<f64>; N],
    pub(crate) w: [Vector3<f64>; N],
    pub(crate) tip: Pose,
}

impl<const N: usize> ArmState<N> {
    /// Motion of the tip with a reading: of its point, and its rotation.
    #[inline]
    pub(crate) fn column(&self, reading: usize) -> (Vector3<f64>, Vector3<f64>) {
        let w = self.w[reading];
        (self.v[reading] + w.cross(&self.tip.translation), w)
    }
}

/// A frame on a joint's axis, which is its z, with the origin nearest to a point.
pub(crate) fn frame_on_axis(screw: &Screw, near: &Vector3<f64>) -> Pose {
    let direction = screw.direction();
    let x = rotation::perpendicular_to(&direction).normalize();
    let origin = if screw.is_prismatic() { *near } else { screw.nearest_point(near) };
    Pose::new(Matrix3::from_columns(&[x, direction.cross(&x), direction]), origin)
}
