//! Arms of six revolute axes without any special geometry (raghavan1993).
//!
//! A point `p` and the direction `l` of the sixth axis are equal from both ends of the loop: `e₃e₄e₅ (p, l) = e₂⁻¹e₁⁻¹ R (p, l)`, with `eᵢ =
//! exp(ξᵢqᵢ)` and the requested motion `R`. Six equations, and eight that follow from them (p·p, p·l, p × l, (p·p) l - 2 (p·l) p), hold no
//! more than products of cosines and sines of one angle each. Six combinations of them are free of q₁ and q₂; their resultant in q₄ and q₅
//! is a trigonometric polynomial of degree 8 in q₃.

// Rows and columns are by their numbers, as in the equations.
#![allow(clippy::needless_range_loop)]

use core::f64::consts::TAU;

use nalgebra::Vector3;

use super::axis::{RevoluteAxis, reverse_turn};
use super::roots::{AngleList, RootTolerance, TrigonometricPolynomial};
use super::tables::{AngleTable, EQUATIONS, by_halves, functions, harmonics, third_of_turn};
use crate::lie::Pose;
use crate::small_systems::{determinant, null_vector};
use crate::trig::cosine_and_sine;

// The functions of numbers, where there is no standard library.
#[allow(unused_imports)]
use nalgebra::{ComplexField as _, RealField as _};

/// Imaginary part of a pair of roots up to which rounding may hide a real pair of the arm, rad.
const BEYOND: f64 = 0.075;
/// Unknown products of the cosines and sines of the first two angles.
const UNKNOWN: usize = 8;
/// Number of samples of a polynomial of degree 8.
const SAMPLES: usize = 17;
/// Zero of the fourth and fifth angle: half an angle has no tangent at π, a frequent angle of arms.
const TURNED: [f64; 2] = [0.734, -1.187];

/// An arm of six axes, with quantities that do not depend on the pose.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GeneralArm {
    axes: [RevoluteAxis; 6],
    first: usize,
    origin: Vector3<f64>,
    scale: f64,
    /// Numbers of each equation by 1, cos and sin of the third angle, then of the fourth and the fifth.
    left: [[AngleTable; 3]; EQUATIONS],
    /// Cosines and sines of the angles at which the polynomial is sampled.
    turns: [(f64, f64); SAMPLES],
}

impl GeneralArm {
    /// Axes at which the loop can be opened.
    pub(crate) const FIRST: [usize; 3] = [0, 5, 4];

    /// The loop opened at an axis: `first` (0, 4, or 5) of the arm's comes first, so that the last four are fixed to each other for all
    /// poses.
    pub(crate) fn new(axes: &[RevoluteAxis; 6], first: usize, reach_m: f64) -> Self {
        let mut axes = *axes;
        axes.rotate_left(first);
        let [.., a3, a4, a5, a6] = &axes;
        let origin = axes[2].point + axes[2].w * axes[2].w.dot(&(axes[1].point - axes[2].point));
        let scale = 1.0 / reach_m;
        let seen = |k3: usize, k4: usize, k5: usize| {
            let turn = |k: usize, by: f64| cosine_and_sine(TAU / 3.0 * k as f64 + by);
            let (t3, t4, t5) = (third_of_turn(k3), turn(k4, TURNED[0]), turn(k5, TURNED[1]));
            let p = a3.rotate_point(t3, &a4.rotate_point(t4, &a5.rotate_point(t5, &a6.point)));
            let l = a3.rotate(t3, &a4.rotate(t4, &a5.rotate(t5, &a6.w)));
            functions(&((p - origin) * scale), &l)
        };
        let mut left = [[[[0.0; 3]; 3]; 3]; EQUATIONS];
        let mut samples = [[[[0.0; EQUATIONS]; 3]; 3]; 3];
        for (k3, samples) in samples.iter_mut().enumerate() {
            for (k4, samples) in samples.iter_mut().enumerate() {
                for (k5, it) in samples.iter_mut().enumerate() {
                    *it = seen(k3, k4, k5);
                }
            }
        }
        for (equation, out) in left.iter_mut().enumerate() {
            let of = |k3: usize, k4: usize, k5: usize| samples[k3][k4][k5][equation];
            let mut by_five = [[[0.0; 3]; 3]; 3];
            for k3 in 0..3 {
                for k4 in 0..3 {
                    by_five[k3][k4] = harmonics([of(k3, k4, 0), of(k3, k4, 1), of(k3, k4, 2)]);
                }
            }
            let mut by_four = [[[0.0; 3]; 3]; 3];
            for k3 in 0..3 {
                for h5 in 0..3 {
                    let found = harmonics([by_five[k3][0][h5], by_five[k3][1][h5], by_five[k3][2][h5]]);
                    for (h4, it) in found.into_iter().enumerate() {
                        by_four[k3][h4][h5] = it;
                    }
                }
            }
            for h4 in 0..3 {
                for h5 in 0..3 {
                    let found = harmonics([by_four[0][h4][h5], by_four[1][h4][h5], by_four[2][h4][h5]]);
                    for (h3, it) in found.into_iter().enumerate() {
                        out[h3][h4][h5] = it;
                    }
                }
            }
            for table in out.iter_mut() {
                *table = by_halves(table);
            }
        }
        let mut turns = [(1.0, 0.0); SAMPLES];
        for (k, it) in turns.iter_mut().enumerate() {
            *it = cosine_and_sine(TAU * k as f64 / SAMPLES as f64);
        }
        GeneralArm { axes, first, origin, scale, left, turns }
    }

    /// Right side by 1, cos and sin of the first two angles: eight unknown products, and the constant part.
    fn right(&self, axes: &[RevoluteAxis; 6], motion: &Pose) -> ([[f64; UNKNOWN]; EQUATIONS], [f64; EQUATIONS]) {
        let [a1, a2, .., a6] = axes;
        let (p, l) = (motion.act(&a6.point), motion.rotation * a6.w);
        let mut samples = [[[0.0; EQUATIONS]; 3]; 3];
        for (k1, samples) in samples.iter_mut().enumerate() {
            let (c, s) = third_of_turn(k1);
            let (p, l) = (a1.rotate_point((c, -s), &p), a1.rotate((c, -s), &l));
            for (k2, it) in samples.iter_mut().enumerate() {
                let (c, s) = third_of_turn(k2);
                let (p, l) = (a2.rotate_point((c, -s), &p), a2.rotate((c, -s), &l));
                *it = functions(&((p - self.origin) * self.scale), &l);
            }
        }
        let mut unknown = [[0.0; UNKNOWN]; EQUATIONS];
        let mut constant = [0.0; EQUATIONS];
        for equation in 0..EQUATIONS {
            let mut by_two = [[0.0; 3]; 3];
            for (out, of) in by_two.iter_mut().zip(&samples) {
                *out = harmonics([of[0][equation], of[1][equation], of[2][equation]]);
            }
            for h2 in 0..3 {
                let found = harmonics([by_two[0][h2], by_two[1][h2], by_two[2][h2]]);
                for (h1, it) in found.into_iter().enumerate() {
                    match 3 * h1 + h2 {
                        0 => constant[equation] = it,
                        index => unknown[equation][index - 1] = it,
                    }
                }
            }
        }
        (unknown, constant)
    }

    /// Six combinations of the equations that are free of the first two angles, by 1, cos and sin of the third.
    fn combinations(&self, axes: &[RevoluteAxis; 6], motion: &Pose) -> [[AngleTable; 3]; 6] {
        let (mut unknown, constant) = self.right(axes, motion);
        // Reflections that make the unknown products triangular leave six rows without any.
        let mut keep = [[0.0; EQUATIONS]; 6];
        for (row, it) in keep.iter_mut().enumerate() {
            it[UNKNOWN + row] = 1.0;
        }
        let mut reflections = [[0.0; EQUATIONS]; UNKNOWN];
        for k in 0..UNKNOWN {
            let norm = (k..EQUATIONS).map(|i| unknown[i][k] * unknown[i][k]).sum::<f64>().sqrt();
            if norm == 0.0 {
                continue;
            }
            let mut v = [0.0; EQUATIONS];
            for i in k..EQUATIONS {
                v[i] = unknown[i][k];
            }
            v[k] += if v[k] < 0.0 { -norm } else { norm };
            let size = v.iter().map(|it| it * it).sum::<f64>();
            let factor = (2.0 / size).sqrt();
            v.iter_mut().for_each(|it| *it *= factor);
            for column in k..UNKNOWN {
                let product: f64 = (k..EQUATIONS).map(|i| v[i] * unknown[i][column]).sum();
                for i in k..EQUATIONS {
                    unknown[i][column] -= v[i] * product;
                }
            }
            reflections[k] = v;
        }
        for v in reflections.iter().rev() {
            for row in &mut keep {
                let product: f64 = row.iter().zip(v).map(|(a, b)| a * b).sum();
                row.iter_mut().zip(v).for_each(|(it, v)| *it -= v * product);
            }
        }
        let mut out = [[[[0.0; 3]; 3]; 3]; 6];
        for (out, row) in out.iter_mut().zip(&keep) {
            let mut free = 0.0;
            for (equation, &share) in row.iter().enumerate() {
                free += share * constant[equation];
                for (out, of) in out.iter_mut().flatten().flatten().zip(self.left[equation].iter().flatten().flatten())
                {
                    *out += share * of;
                }
            }
            // A constant is 1 of every angle.
            for (i, j) in [(0, 0), (0, 2), (2, 0), (2, 2)] {
                out[0][i][j] -= free;
            }
        }
        out
    }

    /// Joint values of all branches for a motion `exp(ξ₁q₁) … exp(ξ₆q₆)`.
    pub(crate) fn seeds(&self, motion: &Pose, push: &mut impl FnMut([f64; 6])) {
        let mut axes = self.axes;
        if self.first > 0 {
            // From the base, axes after the pose are moved by it.
            for axis in axes.iter_mut().take(6 - self.first) {
                *axis = RevoluteAxis { w: motion.rotation * axis.w, point: motion.act(&axis.point) };
            }
        }
        let equations = self.combinations(&axes, motion);
        let mut samples = [0.0; SAMPLES];
        for ((c, s), it) in self.turns.iter().zip(&mut samples) {
            let (mut matrix, factor) = reduce_equations(&equations, *c, *s);
            *it = factor * determinant(&mut matrix);
        }
        let largest = samples.iter().fold(0.0_f64, |most, it| most.max(it.abs()));
        if largest == 0.0 || !largest.is_finite() {
            return;
        }
        let mut coefficients = [(0.0, 0.0); 9];
        for (harmonic, it) in coefficients.iter_mut().enumerate() {
            let share = if harmonic == 0 { 1.0 } else { 2.0 } / SAMPLES as f64 / largest;
            for (k, sample) in samples.iter().enumerate() {
                let (c, s) = self.turns[k * harmonic % SAMPLES];
                it.0 += share * sample * c;
                it.1 += share * sample * s;
            }
        }
        let roots: AngleList<24> = TrigonometricPolynomial { coefficients }.roots(48, RootTolerance::rounding(BEYOND));
        for &q3 in roots.as_slice() {
            let (c, s) = cosine_and_sine(q3);
            // t and t² of the fourth times the powers of the fifth.
            let x = null_vector(&mut reduce_equations(&equations, c, s).0);
            let ratio = |pairs: &[(usize, usize)]| {
                let (up, down) = pairs
                    .iter()
                    .map(|&(up, down)| (x[up], x[down]))
                    .max_by(|a, b| (a.0.abs() + a.1.abs()).total_cmp(&(b.0.abs() + b.1.abs())))
                    .unwrap_or((0.0, 1.0));
                2.0 * up.atan2(down)
            };
            const FIVE: [(usize, usize); 4] = [(1, 0), (2, 1), (4, 3), (5, 4)];
            const FOUR: [(usize, usize); 3] = [(3, 0), (4, 1), (5, 2)];
            let (q4, q5) = (ratio(&FOUR) + TURNED[0], ratio(&FIVE) + TURNED[1]);
            let mut q = self.complete_angles(&axes, motion, [q3, q4, q5]);
            q.rotate_right(self.first);
            push(q);
        }
    }

    /// All six angles from the middle three: the first two bring the sixth axis to its pose, the last turns about it.
    fn complete_angles(&self, axes: &[RevoluteAxis; 6], motion: &Pose, [q3, q4, q5]: [f64; 3]) -> [f64; 6] {
        let [a1, a2, a3, a4, a5, a6] = axes;
        let (t3, t4, t5) = (cosine_and_sine(q3), cosine_and_sine(q4), cosine_and_sine(q5));
        let p = a3.rotate_point(t3, &a4.rotate_point(t4, &a5.rotate_point(t5, &a6.point)));
        let l = a3.rotate(t3, &a4.rotate(t4, &a5.rotate(t5, &a6.w)));
        let (goal_p, goal_l) = (motion.act(&a6.point) - a1.point, motion.rotation * a6.w);
        // Invariants of the first joint: heights along its axis, and the square of a length; linear in cos q₂ and sin q₂.
        let mut normal = [[0.0; 2]; 2];
        let mut right = [0.0; 2];
        let mut add = |a: f64, b: f64, d: f64| {
            normal[0][0] += a * a;
            normal[0][1] += a * b;
            normal[1][0] += a * b;
            normal[1][1] += b * b;
            right[0] += a * d;
            right[1] += b * d;
        };
        let parts = |v: &Vector3<f64>| {
            let along = a2.w * a2.w.dot(v);
            (along, v - along, a2.w.cross(v))
        };
        let (l0, l1, l2) = parts(&l);
        add(a1.w.dot(&l1), a1.w.dot(&l2), a1.w.dot(&goal_l) - a1.w.dot(&l0));
        let (p0, p1, p2) = parts(&(p - a2.point));
        let base = a2.point - a1.point + p0;
        let (scale, w) = (self.scale, &a1.w);
        add(scale * w.dot(&p1), scale * w.dot(&p2), scale * (w.dot(&goal_p) - w.dot(&base)));
        let squares = goal_p.norm_squared() - base.norm_squared() - p1.norm_squared();
        let square = scale * scale;
        add(square * 2.0 * base.dot(&p1), square * 2.0 * base.dot(&p2), square * squares);
        let gap = a2.point - a1.point;
        let product = goal_p.dot(&goal_l) - (p - a2.point).dot(&l) - gap.dot(&l0);
        add(scale * gap.dot(&l1), scale * gap.dot(&l2), scale * product);
        let det = normal[0][0] * normal[1][1] - normal[0][1] * normal[1][0];
        let c2 = (right[0] * normal[1][1] - right[1] * normal[0][1]) / det;
        let s2 = (right[1] * normal[0][0] - right[0] * normal[1][0]) / det;
        let q2 = if det > 0.0 { s2.atan2(c2) } else { 0.0 };
        let t2 = cosine_and_sine(q2);
        let (p, l) = (a2.rotate_point(t2, &p) - a1.point, a2.rotate(t2, &l));
        let flat = |v: &Vector3<f64>| v - a1.w * a1.w.dot(v);
        let (p, l, goal_p, goal_l) = (flat(&p) * scale, flat(&l), flat(&goal_p) * scale, flat(&goal_l));
        let across = a1.w.dot(&(p.cross(&goal_p) + l.cross(&goal_l)));
        let q1 = across.atan2(p.dot(&goal_p) + l.dot(&goal_l));
        let side = crate::lie::rotation::perpendicular_to(&a6.w);
        let mut turned = motion.rotation * side;
        for (axis, q) in [(a1, q1), (a2, q2), (a3, q3), (a4, q4), (a5, q5)] {
            turned = axis.rotate(reverse_turn(q), &turned);
        }
        [q1, q2, q3, q4, q5, a6.angle(&side, &turned)]
    }
}

/// The equations at a third angle as a matrix of 6 unknowns, and the factor by which its determinant is that of the resultant.
///
/// The resultant has the equations and the equations times the tangent t of half the fourth angle, as blocks of the powers of t: `[A B
/// C 0; 0 A B C] (1, t, t², t³) = 0`, each block by 1, tan and tan² of half the fifth angle. Its first and its last columns have
/// numbers in one half of the rows only: without them, `t` and `t²` times the powers of the fifth remain.
fn reduce_equations(equations: &[[AngleTable; 3]; 6], c: f64, s: f64) -> ([[f64; 6]; 6], f64) {
    let (mut first, mut last) = ([[0.0; 9]; 6], [[0.0; 9]; 6]);
    for (row, [one, cosine, sine]) in equations.iter().enumerate() {
        for four in 0..3 {
            for five in 0..3 {
                let number = one[four][five] + c * cosine[four][five] + s * sine[four][five];
                first[row][3 * four + five] = number;
                // C before A and B.
                last[row][3 * ((four + 1) % 3) + five] = number;
            }
        }
    }
    let mut factor = 1.0;
    eliminate(&mut first, &mut factor);
    eliminate(&mut last, &mut factor);
    let row = |of: &[f64; 9]| [of[3], of[4], of[5], of[6], of[7], of[8]];
    let [.., a, b, c] = &first;
    let [.., d, e, f] = &last;
    ([row(a), row(b), row(c), row(d), row(e), row(f)], factor)
}

/// Eliminates the first three columns from the last three rows, with row pivots, whose product goes into the factor.
#[inline]
fn eliminate(rows: &mut [[f64; 9]; 6], factor: &mut f64) {
    for k in 0..3 {
        let mut row = k;
        for i in k + 1..6 {
            if rows[i][k].abs() > rows[row][k].abs() {
                row = i;
            }
        }
        if row != k {
            rows.swap(k, row);
            *factor = -*factor;
        }
        let pivot = rows[k];
        *factor *= pivot[k];
        let inverse = if pivot[k] == 0.0 { 0.0 } else { 1.0 / pivot[k] };
        for below in rows.iter_mut().skip(k + 1) {
            let share = below[k] * inverse;
            for j in 3..9 {
                below[j] -= share * pivot[j];
            }
            for j in k + 1..3 {
                below[j] -= share * pivot[j];
            }
        }
    }
}
