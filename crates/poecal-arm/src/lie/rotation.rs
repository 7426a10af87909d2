//! Rotations as 3×3 matrices: exponential, logarithm, quaternions, URDF roll-pitch-yaw, shortest arc.

// The functions of numbers, where there is no standard library.
#[allow(unused_imports)]
use nalgebra::{ComplexField as _, RealField as _};

use super::{hat, series};
use nalgebra::{Matrix3, Vector3, Vector4};

/// `exp(ω̂) = I + sinc ω̂ + cosc ω̂²`: the rotation by the vector ω (radians), theory.md §1 (2a).
#[must_use]
pub fn exp(w: &Vector3<f64>) -> Matrix3<f64> {
    let angle_squared = w.norm_squared();
    let hat_w = hat(w);
    Matrix3::identity() + hat_w * series::sinc(angle_squared) + hat_w * hat_w * series::cosc(angle_squared)
}

/// Rotation vector `log(R)^∨` of a rotation matrix (theory.md §1 (2a)), `|log R| ≤ π`, accurate at 0 and up to π (through the quaternion).
#[must_use]
pub fn log(r: &Matrix3<f64>) -> Vector3<f64> {
    let q = to_quaternion_xyzw(r);
    let vector = Vector3::new(q.x, q.y, q.z);
    let sine = vector.norm();
    // to_quaternion_xyzw returns w ≥ 0, so the half angle lies in [0, π/2].
    if sine < 1e-8 {
        // 2 asin(s)/s = 2 + s²/3 + …, the omitted term is below 1e-32.
        vector * (2.0 + sine * sine / 3.0)
    } else {
        vector * (2.0 * sine.atan2(q.w) / sine)
    }
}

/// Unit quaternion `(x, y, z, w)` of a rotation matrix, `w ≥ 0`, from its largest component (shepperd1978).
#[must_use]
pub fn to_quaternion_xyzw(r: &Matrix3<f64>) -> Vector4<f64> {
    let trace = r.trace();
    let (xx, yy, zz) = (r[(0, 0)], r[(1, 1)], r[(2, 2)]);
    let (a, b, c) = (r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)]);
    let (d, e, f) = (r[(1, 0)] + r[(0, 1)], r[(0, 2)] + r[(2, 0)], r[(2, 1)] + r[(1, 2)]);
    let q = if trace >= xx && trace >= yy && trace >= zz {
        Vector4::new(a, b, c, 1.0 + trace)
    } else if xx >= yy && xx >= zz {
        Vector4::new(1.0 + xx - yy - zz, d, e, a)
    } else if yy >= zz {
        Vector4::new(d, 1.0 + yy - xx - zz, f, b)
    } else {
        Vector4::new(e, f, 1.0 + zz - xx - yy, c)
    };
    let q = q / q.norm();
    if q.w < 0.0 { -q } else { q }
}

/// Rotation matrix of a quaternion `(x, y, z, w)`, which is normalised first (horn1987).
#[must_use]
pub fn from_quaternion_xyzw(q: &Vector4<f64>) -> Matrix3<f64> {
    let q = q / q.norm();
    let (x, y, z, w) = (q.x, q.y, q.z, q.w);
    Matrix3::new(
        1.0 - 2.0 * (y * y + z * z),
        2.0 * (x * y - z * w),
        2.0 * (x * z + y * w),
        2.0 * (x * y + z * w),
        1.0 - 2.0 * (x * x + z * z),
        2.0 * (y * z - x * w),
        2.0 * (x * z - y * w),
        2.0 * (y * z + x * w),
        1.0 - 2.0 * (x * x + y * y),
    )
}

/// Rotation about a coordinate axis (0 = x, 1 = y, 2 = z) by an angle in radians: theory.md §1 (2a).
#[must_use]
pub fn about(axis: usize, angle_rad: f64) -> Matrix3<f64> {
    let (s, c) = angle_rad.sin_cos();
    match axis {
        0 => Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c),
        1 => Matrix3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c),
        _ => Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0),
    }
}

/// Rotation of URDF's fixed-axis angles, `R = Rz(yaw) Ry(pitch) Rx(roll)`, radians (docs/conventions.md).
#[must_use]
pub fn from_rpy(roll: f64, pitch: f64, yaw: f64) -> Matrix3<f64> {
    about(2, yaw) * about(1, pitch) * about(0, roll)
}

/// URDF angles `[roll, pitch, yaw]` of a rotation, the inverse of [`from_rpy`]. At and near `pitch = ±π/2`, where roll and yaw are not
/// unique, the three still compose to `R` to rounding: roll is computed after yaw has been undone.
#[must_use]
pub fn to_rpy(r: &Matrix3<f64>) -> [f64; 3] {
    let horizontal = r[(0, 0)].hypot(r[(1, 0)]);
    let yaw = if horizontal > 1e-12 { r[(1, 0)].atan2(r[(0, 0)]) } else { 0.0 };
    let (s, c) = yaw.sin_cos();
    let pitch = (-r[(2, 0)]).atan2(c * r[(0, 0)] + s * r[(1, 0)]);
    let roll = (s * r[(0, 2)] - c * r[(1, 2)]).atan2(c * r[(1, 1)] - s * r[(0, 1)]);
    [roll, pitch, yaw]
}

/// Rotation by the smallest angle that takes unit vector `from` to unit vector `to`. It is `I + â + â²/(1 + cos φ)` with `a = from × to`
/// and `sin φ = |a|`, which is theory.md §1 (2a) for `ω = φ a/|a|`. For opposite vectors it is half a turn about a perpendicular
/// direction.
#[must_use]
pub fn shortest_arc(from: &Vector3<f64>, to: &Vector3<f64>) -> Matrix3<f64> {
    let cross = from.cross(to);
    let dot = from.dot(to);
    if dot < -1.0 + 1e-12 {
        let side = perpendicular_to(from);
        return 2.0 * side * side.transpose() - Matrix3::identity();
    }
    let hat_cross = hat(&cross);
    Matrix3::identity() + hat_cross + hat_cross * hat_cross / (1.0 + dot)
}

/// A unit vector perpendicular to `a` (any length but zero): `a × e_k`, normalised, with the axis `e_k` of the smallest component of `a`.
#[must_use]
pub fn perpendicular_to(a: &Vector3<f64>) -> Vector3<f64> {
    let other = match a.iamin() {
        0 => Vector3::x(),
        1 => Vector3::y(),
        _ => Vector3::z(),
    };
    a.cross(&other).normalize()
}

/// Nearest rotation to a matrix that is a rotation except for rounding: `R (3I - RᵀR)/2`, one Newton-Schulz step of the polar
/// decomposition (bjorck1971).
#[must_use]
pub fn orthonormalized(r: &Matrix3<f64>) -> Matrix3<f64> {
    r * (Matrix3::identity() * 1.5 - r.transpose() * r * 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn logarithm_inverts_the_exponential_at_every_scale() {
        let direction = Vector3::new(0.6, -0.48, 0.64);
        for angle in [0.0, 1e-12, 1e-8, 1e-4, 0.099, 0.101, 1.0, 3.0, PI - 1e-4, PI - 1e-8] {
            let w = direction * angle;
            let error = (log(&exp(&w)) - w).norm();
            println!("angle {angle:e}: {error:.1e}");
            assert!(error < 1e-14);
        }
    }

    #[test]
    fn angles_compose_to_the_rotation_near_gimbal_lock() {
        for pitch in [FRAC_PI_2, -FRAC_PI_2, FRAC_PI_2 - 1e-9, FRAC_PI_2 - 1e-5, 0.3] {
            let r = from_rpy(0.7, pitch, -2.0) * exp(&Vector3::new(1e-9, -3e-9, 2e-9));
            let [a, b, c] = to_rpy(&r);
            let error = (from_rpy(a, b, c) - r).norm();
            println!("pitch {pitch}: {error:.1e}");
            assert!(error < 3e-12, "{error}");
        }
    }

    #[test]
    fn shortest_arc_of_opposite_vectors_is_half_a_turn() {
        let a = Vector3::new(0.6, 0.0, 0.8);
        let r = shortest_arc(&a, &-a);
        assert!((r * a + a).norm() < 1e-14 && (r.determinant() - 1.0).abs() < 1e-14);
    }

    #[test]
    fn a_quarter_turn_about_z_takes_x_to_y() {
        let half = (0.5 * FRAC_PI_2).sin_cos();
        for r in [
            exp(&Vector3::new(0.0, 0.0, FRAC_PI_2)),
            shortest_arc(&Vector3::x(), &Vector3::y()),
            // The quaternion is twice as long as a unit quaternion.
            from_quaternion_xyzw(&Vector4::new(0.0, 0.0, 2.0 * half.0, 2.0 * half.1)),
        ] {
            assert!((r * Vector3::x() - Vector3::y()).norm() < 1e-15);
            assert!((r * Vector3::z() - Vector3::z()).norm() < 1e-15);
        }
    }
}
