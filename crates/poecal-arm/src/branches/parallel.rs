//! Arms whose second, third and fourth axes are parallel.

use nalgebra::Vector3;

use super::axis::{RevoluteAxis, reverse_turn};
use super::roots::{RootTolerance, linear};
use crate::lie::{Pose, rotation};
use crate::trig::cosine_and_sine;

// The functions of numbers, where there is no standard library.
#[allow(unused_imports)]
use nalgebra::{ComplexField as _, RealField as _};

/// An arm of six axes, the second, third and fourth of which are (nearly) parallel, and the fifth of which meets the sixth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ParallelAxesArm {
    axes: [RevoluteAxis; 6],
    care: RootTolerance,
    /// Intersection of the fifth axis with the sixth.
    wrist: Vector3<f64>,
    /// Direction of the parallel axes.
    along: Vector3<f64>,
}

impl ParallelAxesArm {
    /// The nearest arm of this kind, and the distance from it: largest angle between the axes (rad), and distance of the last two (m).
    pub(crate) fn new(axes: &[RevoluteAxis; 6], reach_m: f64) -> Option<(Self, f64, f64)> {
        let first = axes[1].w;
        let signed = |axis: &RevoluteAxis| if axis.w.dot(&first) < 0.0 { -axis.w } else { axis.w };
        let along = (first + signed(&axes[2]) + signed(&axes[3])).normalize();
        let angle = axes[1..4].iter().map(|axis| axis.w.cross(&along).norm()).fold(0.0, f64::max);
        let (wrist, apart) = axes[4].midpoint(&axes[5])?;
        let mut axes = *axes;
        for axis in &mut axes[1..4] {
            // Intersection with the plane of the wrist, with the axis's own sense.
            let slope = axis.w.dot(&along);
            if slope.abs() < 0.5 {
                return None;
            }
            axis.point += axis.w * (along.dot(&(wrist - axis.point)) / slope);
            axis.w = along * slope.signum();
        }
        let bends = axes[0].w.cross(&along).norm() > 0.1 && axes[4].w.cross(&along).norm() > 0.1;
        bends.then_some((
            ParallelAxesArm { axes, wrist, along, care: RootTolerance::from_deviation(angle.max(apart / reach_m)) },
            angle,
            apart,
        ))
    }

    /// Joint values of the branches for a motion `exp(ξ₁q₁) … exp(ξ₆q₆)`.
    pub(crate) fn seeds(&self, motion: &Pose, push: &mut impl FnMut([f64; 6], bool)) {
        let [a1, a2, a3, a4, a5, a6] = &self.axes;
        let w = &self.along;
        // The first joint determines the height of the wrist along the parallel axes: w · exp(-ξ₁q₁) p = w · p₀.
        let p = motion.act(&self.wrist) - a1.point;
        let level = a1.w * a1.w.dot(&p);
        let (a, b) = (w.dot(&(p - level)), -w.dot(&a1.w.cross(&p)));
        let height = w.dot(&(self.wrist - a1.point)) - w.dot(&level);
        let w6 = motion.rotation * a6.w;
        let (across, along) = (a5.w.cross(w), a5.w * a5.w.dot(w));
        let side = rotation::perpendicular_to(w);
        for (q1, one) in linear(a, b, height, self.care).iter_flagged() {
            let turned = a1.rotate(cosine_and_sine(q1), w);
            // w6 · exp(-w5 q5) w = (R w6) · exp(w1 q1) w.
            let (a, b) = (a6.w.dot(&(w - along)), -a6.w.dot(&across));
            let goal = motion.rotation.transpose() * turned;
            for (q5, two) in
                linear(a, b, w6.dot(&turned) - a6.w.dot(&along), self.care.with_forced_pairs()).iter_flagged()
            {
                let bent = a5.rotate(reverse_turn(q5), w);
                let q6 = a6.angle(&goal, &bent);
                // Motion of the parallel axes: a rotation, and a position of the fourth.
                let undone = |v: &Vector3<f64>| {
                    let v = a5.rotate(reverse_turn(q5), v);
                    a1.rotate(reverse_turn(q1), &(motion.rotation * a6.rotate(reverse_turn(q6), &v)))
                };
                let turn = RevoluteAxis { w: *w, point: a2.point }.angle(&side, &undone(&side));
                let at = a6.rotate_point(reverse_turn(q6), &a5.rotate_point(reverse_turn(q5), &a4.point));
                let at = a1.rotate_point(reverse_turn(q1), &motion.act(&at)) - a2.point;
                let (upper, fore) = (a3.point - a2.point, a4.point - a3.point);
                let flat = |v: Vector3<f64>| v - w * w.dot(&v);
                let (at, upper, fore) = (flat(at), flat(upper), flat(fore));
                // |upper + exp(w q3) fore| = |at|.
                let (a, b) = (upper.dot(&fore), upper.dot(&w.cross(&fore)));
                let d = 0.5 * (at.norm_squared() - upper.norm_squared() - fore.norm_squared());
                for (q3, three) in linear(a, b, d, self.care).iter_flagged() {
                    let axis = RevoluteAxis { w: *w, point: a2.point };
                    let reached = upper + axis.rotate(cosine_and_sine(q3), &fore);
                    let q2 = axis.angle(&reached, &at);
                    let sign = |axis: &RevoluteAxis| axis.w.dot(w);
                    let q = [q1, sign(a2) * q2, sign(a3) * q3, sign(a4) * (turn - q2 - q3), q5, q6];
                    push(q, one || two || three);
                }
            }
        }
    }
}
