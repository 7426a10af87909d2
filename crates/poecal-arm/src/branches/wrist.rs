//! Arms whose last three axes meet in a point.

use nalgebra::{Matrix3, Vector3};

use super::axis::{RevoluteAxis, reverse_turn};
use super::roots::{AngleList, RootTolerance, TrigonometricPolynomial, linear};
use crate::lie::{Pose, rotation};
use crate::trig::cosine_and_sine;

// The functions of numbers, where there is no standard library.
#[allow(unused_imports)]
use nalgebra::{ComplexField as _, RealField as _};

/// Distance of the first two axes (lengths over reach), or sine of the angle between them, below which they are treated as meeting or parallel.
const MET: f64 = 0.03;

/// An arm of six axes, the last three of which meet (nearly) in a point: the first three determine its position (pieper1968), the others
/// the orientation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SphericalWristArm {
    axes: [RevoluteAxis; 6],
    care: RootTolerance,
    centre: Vector3<f64>,
}

/// The point nearest to three axes (least squares of distances), and the largest distance; `None` if they are almost parallel.
fn meeting_point(axes: &[RevoluteAxis]) -> Option<(Vector3<f64>, f64)> {
    let (mut a, mut b) = (Matrix3::zeros(), Vector3::zeros());
    for axis in axes {
        let across = Matrix3::identity() - axis.w * axis.w.transpose();
        a += across;
        b += across * axis.point;
    }
    let mut rows = [[0.0; 3]; 3];
    for (i, row) in rows.iter_mut().enumerate() {
        for (j, it) in row.iter_mut().enumerate() {
            *it = a[(i, j)];
        }
    }
    let mut x = [b.x, b.y, b.z];
    crate::small_systems::solve(&mut rows, &mut x, 1e-6)?;
    let centre = Vector3::new(x[0], x[1], x[2]);
    Some((centre, axes.iter().map(|axis| axis.distance(&centre)).fold(0.0, f64::max)))
}

impl SphericalWristArm {
    /// The wrist of six axes, and the distance (m) of the last three from meeting.
    pub(crate) fn new(axes: &[RevoluteAxis; 6], reach_m: f64) -> Option<(Self, f64)> {
        let (centre, apart) = meeting_point(&axes[3..])?;
        let mut axes = *axes;
        if let Some((middle, _)) = axes[0].midpoint(&axes[1]) {
            // The point is nearest to the second axis, so that the two are apart by a perpendicular.
            axes[0].point += axes[0].w * axes[0].w.dot(&(middle - axes[0].point));
        }
        // Wrists whose axes are almost parallel turn in two directions only.
        let bends = |one: usize, other: usize| axes[one].w.cross(&axes[other].w).norm() > 0.1;
        (bends(3, 4) && bends(4, 5)).then_some((
            SphericalWristArm { axes, centre, care: RootTolerance::from_deviation(apart / reach_m) },
            apart,
        ))
    }

    /// Joint values of the branches for a motion `exp(ξ₁q₁) … exp(ξ₆q₆)`.
    pub(crate) fn seeds(&self, motion: &Pose, push: &mut impl FnMut([f64; 6], bool)) {
        let [a1, a2, a3, a4, a5, a6] = &self.axes;
        let place = motion.act(&self.centre);
        self.solve_regional(&place, &mut |[q1, q2, q3], one| {
            let (t1, t2, t3) = (reverse_turn(q1), reverse_turn(q2), reverse_turn(q3));
            let undone = |v: &Vector3<f64>| a3.rotate(t3, &a2.rotate(t2, &a1.rotate(t1, v)));
            let w6 = motion.rotation * a6.w;
            let goal = undone(&w6);
            // w4 · exp(w5 q5) w6 = w4 · goal.
            let (across, along) = (a5.w.cross(&a6.w), a5.w * a5.w.dot(&a6.w));
            let (a, b) = (a4.w.dot(&(a6.w - along)), a4.w.dot(&across));
            let side = rotation::perpendicular_to(&a6.w);
            let side_goal = undone(&(motion.rotation * side));
            for (q5, two) in
                linear(a, b, a4.w.dot(&goal) - a4.w.dot(&along), self.care.with_forced_pairs()).iter_flagged()
            {
                let bent = a5.rotate(cosine_and_sine(q5), &a6.w);
                let q4 = a4.angle(&bent, &goal);
                let back_side = a5.rotate(reverse_turn(q5), &a4.rotate(reverse_turn(q4), &side_goal));
                push([q1, q2, q3, q4, q5, a6.angle(&side, &back_side)], one || two);
            }
        });
    }

    /// Angles of the first three joints that bring the centre to a position. The first joint does not change the height along its
    /// axis and the distance from a point of it; both are linear in cos q₂ and sin q₂.
    fn solve_regional(&self, place: &Vector3<f64>, push: &mut impl FnMut([f64; 3], bool)) {
        let [a1, a2, a3, ..] = &self.axes;
        let q = a2.point - a1.point;
        let goal = place - a1.point;
        // Centre from the second axis: v = v0 + v1 cos q3 + v2 sin q3.
        let arm = self.centre - a3.point;
        let v1 = arm - a3.w * a3.w.dot(&arm);
        let v2 = a3.w.cross(&arm);
        let v0 = a3.point - a2.point + a3.w * a3.w.dot(&arm);
        let x = rotation::perpendicular_to(&a2.w);
        let y = a2.w.cross(&x);
        let flat = |v: &Vector3<f64>| (v.dot(&x), v.dot(&y));
        let (ax, ay) = flat(&a1.w);
        let (bx, by) = flat(&q);
        // Numbers (1, cos q3, sin q3).
        let affine = |f: &dyn Fn(&Vector3<f64>) -> f64| [f(&v0), f(&v1), f(&v2)];
        let h = affine(&|v| a2.w.dot(v));
        let squared = [v0.norm_squared() + v1.norm_squared(), 2.0 * v0.dot(&v1), 2.0 * v0.dot(&v2)];
        let along = a1.w.dot(&a2.w);
        let shift = q.dot(&a2.w);
        let mut alpha = h.map(|it| -along * it);
        alpha[0] += a1.w.dot(&goal) - a1.w.dot(&q);
        let mut beta = [0.0; 3];
        for (k, it) in beta.iter_mut().enumerate() {
            *it = -0.5 * squared[k] - shift * h[k];
        }
        beta[0] += 0.5 * (goal.norm_squared() - q.norm_squared());
        let det = ax * by - ay * bx;
        let (aa, ab, bb) = (ax * ax + ay * ay, ax * bx + ay * by, bx * bx + by * by);
        let at = |it: &[f64; 3], (c, s): (f64, f64)| it[0] + it[1] * c + it[2] * s;
        let centre = |(c, s): (f64, f64)| v0 + v1 * c + v2 * s;
        let finish = |q2: f64, q3: f64, is_touching: bool, push: &mut dyn FnMut([f64; 3], bool)| {
            let u = a2.rotate_point(cosine_and_sine(q2), &(a2.point + centre(cosine_and_sine(q3))));
            push([a1.angle(&(u - a1.point), &goal), q2, q3], is_touching);
        };
        // If the first axes (nearly) meet or are parallel, one equation has (nearly) no q₂: it determines q₃, the other q₂.
        let size = goal.norm() + q.norm() + v0.norm() + v1.norm();
        let met = if bb < MET * MET * size * size * aa {
            Some(((bx, by, beta), (ax, ay, alpha)))
        } else if aa * size * size < MET * MET * bb {
            Some(((ax, ay, alpha), (bx, by, beta)))
        } else {
            None
        };
        if let Some((weak, strong)) = met {
            let turned = |(x, y): (f64, f64), (c, s): (f64, f64)| (c * x - s * y, s * x + c * y);
            for (which, other) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let (mut q2, mut q3, mut shift) = (0.0, 0.0, 0.0);
                let (mut is_found, mut is_touching) = (true, false);
                for _ in 0..3 {
                    let third = linear(weak.2[1], weak.2[2], shift - weak.2[0], self.care);
                    is_found &= third.count == 2;
                    (q3, is_touching) = (third.values[which], third.is_touching());
                    let turn = cosine_and_sine(q3);
                    let z = flat(&centre(turn));
                    let (x, y) = (strong.0 * z.0 + strong.1 * z.1, strong.1 * z.0 - strong.0 * z.1);
                    let second = linear(x, y, at(&strong.2, turn), self.care);
                    is_found &= second.count == 2;
                    q2 = second.values[other];
                    is_touching |= second.is_touching();
                    let z = turned(z, cosine_and_sine(q2));
                    shift = weak.0 * z.0 + weak.1 * z.1;
                }
                if is_found {
                    finish(q2, q3, is_touching, push);
                }
            }
            return;
        }
        let mut sum = [(0.0, 0.0); 3];
        let mut add = |factor: f64, one: &[f64; 3], other: &[f64; 3]| {
            // Products of 1, cos and sin as harmonics.
            sum[0].0 += factor * (one[0] * other[0] + 0.5 * (one[1] * other[1] + one[2] * other[2]));
            sum[1].0 += factor * (one[0] * other[1] + one[1] * other[0]);
            sum[1].1 += factor * (one[0] * other[2] + one[2] * other[0]);
            sum[2].0 += factor * 0.5 * (one[1] * other[1] - one[2] * other[2]);
            sum[2].1 += factor * 0.5 * (one[1] * other[2] + one[2] * other[1]);
        };
        add(aa, &beta, &beta);
        add(-2.0 * ab, &alpha, &beta);
        add(bb, &alpha, &alpha);
        add(-det * det, &squared, &[1.0, 0.0, 0.0]);
        add(det * det, &h, &h);
        let roots: AngleList<8> = TrigonometricPolynomial { coefficients: sum }.roots(24, self.care);
        for (q3, is_touching) in roots.iter_flagged() {
            let turn = cosine_and_sine(q3);
            let (zx, zy) = flat(&centre(turn));
            let (alpha, beta) = (at(&alpha, turn), at(&beta, turn));
            // Turned by q₂, (zx, zy) has the products α and β with A and B.
            let (x, y) = ((by * alpha - ay * beta) / det, (ax * beta - bx * alpha) / det);
            finish((zx * y - zy * x).atan2(zx * x + zy * y), q3, is_touching, push);
        }
    }
}
