//! Forward kinematics of a chain of joints whose values are their readings.

use alloc::vec::Vec;

use nalgebra::{Matrix3, Vector3};

// The functions of numbers, where there is no standard library.
#[allow(unused_imports)]
use nalgebra::{ComplexField as _, RealField as _};

use crate::arm_state::frame_on_axis;
use crate::lie::{Pose, Screw, rotation};

/// Sine of the angle between two axes below which any direction across both serves.
const PARALLEL: f64 = 1e-9;

/// A chain of joints. The frame of a joint has its axis along z, and its x across its axis and the next one: then the next frame is turned by
/// one angle about x and one about its own z, to which the joint's value is added. Origins are the points of an axis nearest to the origin
/// before. So lengths stay those of the arm also if axes are almost parallel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LinkChain {
    /// First frame in the base before its joint moves.
    pub(crate) start: Pose,
    pub(crate) links: Vec<ChainLink>,
    /// Tip in the frame of the last joint.
    pub(crate) tip: Pose,
    /// Length of the path from the first axis over all axes to the tip, metres.
    pub(crate) length_m: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ChainLink {
    /// Origin in the frame before.
    pub(crate) origin: Vector3<f64>,
    /// Cosine and sine of the angle about x from the axis before.
    pub(crate) tilt: (f64, f64),
    /// Angle about its own axis at zero.
    pub(crate) turned: f64,
    pub(crate) slides: bool,
}

impl LinkChain {
    /// The chain of screws (base frame, at zero) and the tip there.
    pub(crate) fn new(screws: &[Screw], home: &Pose) -> Self {
        let axes: Vec<Pose> = {
            let mut before = Vector3::zeros();
            let mut place = |screw: &Screw| {
                let frame = frame_on_axis(screw, &before);
                before = frame.translation;
                frame
            };
            screws.iter().map(&mut place).collect()
        };
        let axis = |k: usize| axes[k].rotation.column(2).into_owned();
        // Direction across an axis and the next one, or the previous direction.
        let across = |k: usize, old: Vector3<f64>| {
            let z = axis(k);
            let cross = if k + 1 < axes.len() { z.cross(&axis(k + 1)) } else { Vector3::zeros() };
            let x = if cross.norm() < PARALLEL { old } else { cross.normalize() };
            let x = x - z * z.dot(&x);
            let size = x.norm();
            if size < 0.5 { rotation::perpendicular_to(&z) } else { x / size }
        };
        let mut links = Vec::with_capacity(screws.len());
        let mut length_m = 0.0;
        let (mut start, mut frame) = (Pose::identity(), Pose::identity());
        for (k, screw) in screws.iter().enumerate() {
            let (z, old) = (axis(k), frame);
            let x = across(k, old.rotation.column(0).into_owned());
            let rotation = Matrix3::from_columns(&[x, z.cross(&x), z]);
            frame = Pose::new(rotation, axes[k].translation);
            let slides = screw.is_prismatic();
            if k == 0 {
                start = frame;
                links.push(ChainLink { origin: Vector3::zeros(), tilt: (1.0, 0.0), turned: 0.0, slides });
                continue;
            }
            length_m += (frame.translation - old.translation).norm();
            let before = |v: Vector3<f64>| old.rotation.tr_mul(&v);
            let (along, side) = (before(z), before(x));
            // About x of the frame before, z = (0, -s, c); then x of this one = (cos, sin) in its plane.
            let (c, s) = (along.z, -along.y);
            let size = c.hypot(s);
            let tilt = (c / size, s / size);
            let turned = (side.y * tilt.0 + side.z * tilt.1).atan2(side.x);
            links.push(ChainLink { origin: before(frame.translation - old.translation), tilt, turned, slides });
        }
        length_m += (home.translation - frame.translation).norm();
        LinkChain { start, links, tip: frame.inverse() * *home, length_m }
    }

    /// Number of joints.
    pub(crate) fn len(&self) -> usize {
        self.links.len()
    }
}
