//! Functions of two or three angles by their cosines and sines: from samples, and as polynomials of the tangents of half the angles.

use core::f64::consts::TAU;

use nalgebra::Vector3;

use crate::trig::cosine_and_sine;

/// Number of equations.
pub(super) const EQUATIONS: usize = 14;

/// Numbers of a function of two angles by 1, cos and sin of each.
pub(super) type AngleTable = [[f64; 3]; 3];

/// Functions of the point and the direction that are equal from both ends.
#[inline]
pub(super) fn functions(p: &Vector3<f64>, l: &Vector3<f64>) -> [f64; EQUATIONS] {
    let (square, product) = (p.norm_squared(), p.dot(l));
    let moment = p.cross(l);
    let mirrored = l * square - p * (2.0 * product);
    [p.x, p.y, p.z, l.x, l.y, l.z, square, product, moment.x, moment.y, moment.z, mirrored.x, mirrored.y, mirrored.z]
}

/// Mean and first harmonics of three samples over a turn.
#[inline]
pub(super) fn harmonics(samples: [f64; 3]) -> [f64; 3] {
    const HALF_ROOT: f64 = 0.866_025_403_784_438_6;
    let [a, b, c] = samples;
    [(a + b + c) / 3.0, (2.0 * a - b - c) / 3.0, (b - c) * 2.0 * HALF_ROOT / 3.0]
}

/// Cosine and sine of `k` thirds of a turn.
#[inline]
pub(super) fn third_of_turn(k: usize) -> (f64, f64) {
    cosine_and_sine(TAU / 3.0 * k as f64)
}

/// 1, cos and sin of an angle as polynomials of the tangent of its half, times 1 + tan².
const HALVES: [[f64; 3]; 3] = [[1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [0.0, 2.0, 0.0]];

/// A table by the tangents of half the angles.
#[inline]
pub(super) fn by_halves(table: &AngleTable) -> AngleTable {
    let mut out = [[0.0; 3]; 3];
    for (row, one) in table.iter().zip(HALVES) {
        for (number, other) in row.iter().zip(HALVES) {
            for (out, one) in out.iter_mut().zip(one) {
                for (out, other) in out.iter_mut().zip(other) {
                    *out += number * one * other;
                }
            }
        }
    }
    out
}
