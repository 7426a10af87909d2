//! Forms of orientations in files.

use std::fmt;
use std::str::FromStr;

use nalgebra::{Matrix3, Vector3, Vector4};

use super::units::Dimension;
use crate::error::{Error, ErrorKind, Result};
use crate::lie::rotation;

/// Largest deviation of a quaternion's norm from 1.
const QUATERNION_TOLERANCE: f64 = 1e-2;

/// Rotation from three angles or four quaternion parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum OrientationForm {
    /// Quaternion parts in the order x, y, z, w.
    QuaternionXyzw,
    /// Quaternion parts in the order w, x, y, z.
    QuaternionWxyz,
    /// Axis times angle.
    RotationVector,
    /// Angles about moving axes (0 = x): `R = R_a R_b R_c`.
    Intrinsic([usize; 3]),
    /// Angles about fixed axes: `R = R_c R_b R_a`.
    Extrinsic([usize; 3]),
}

impl OrientationForm {
    /// URDF's roll, pitch, yaw.
    pub(super) const ROLL_PITCH_YAW: Self = OrientationForm::Extrinsic([0, 1, 2]);

    /// Number of columns.
    pub(super) fn len(self) -> usize {
        self.part_names().len()
    }

    /// Dimension of its columns.
    pub(super) fn quantity(self) -> Dimension {
        if self.len() == 4 { Dimension::Number } else { Dimension::Angle }
    }

    /// Column names in our own files, in order; empty for Euler angles, which these do not have.
    pub(super) fn own_columns(self) -> &'static [&'static str] {
        match self {
            OrientationForm::Extrinsic([0, 1, 2])
            | OrientationForm::QuaternionXyzw
            | OrientationForm::QuaternionWxyz
            | OrientationForm::RotationVector => self.part_names(),
            OrientationForm::Intrinsic(_) | OrientationForm::Extrinsic(_) => &[],
        }
    }

    /// Contents of its columns, in order.
    pub(super) fn part_names(self) -> &'static [&'static str] {
        match self {
            OrientationForm::QuaternionXyzw => &["qx", "qy", "qz", "qw"],
            OrientationForm::QuaternionWxyz => &["qw", "qx", "qy", "qz"],
            OrientationForm::RotationVector => &["rx", "ry", "rz"],
            OrientationForm::Extrinsic([0, 1, 2]) => &["roll", "pitch", "yaw"],
            OrientationForm::Intrinsic(_) | OrientationForm::Extrinsic(_) => {
                &["first angle", "second angle", "third angle"]
            }
        }
    }

    /// The rotation of the columns' values (radians or quaternion parts), or what was found and expected.
    pub(super) fn rotation(self, values: [f64; 4]) -> std::result::Result<Matrix3<f64>, String> {
        let [a, b, c, d] = values;
        match self {
            OrientationForm::QuaternionXyzw => quaternion(Vector4::new(a, b, c, d)),
            OrientationForm::QuaternionWxyz => quaternion(Vector4::new(b, c, d, a)),
            OrientationForm::RotationVector => Ok(rotation::exp(&Vector3::new(a, b, c))),
            OrientationForm::Intrinsic([i, j, k]) => {
                Ok(rotation::about(i, a) * rotation::about(j, b) * rotation::about(k, c))
            }
            OrientationForm::Extrinsic([i, j, k]) => {
                Ok(rotation::about(k, c) * rotation::about(j, b) * rotation::about(i, a))
            }
        }
    }
}

fn quaternion(q: Vector4<f64>) -> std::result::Result<Matrix3<f64>, String> {
    let norm = q.norm();
    if (norm - 1.0).abs() > QUATERNION_TOLERANCE {
        return Err(format!(
            "found a quaternion of norm {norm:.4}, expected 1 to within {QUATERNION_TOLERANCE}"
        ));
    }
    Ok(rotation::from_quaternion_xyzw(&q))
}

impl FromStr for OrientationForm {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let euler = |axes: &str| -> Option<[usize; 3]> {
            let indices: Vec<usize> = axes.chars().map(|c| "xyz".find(c)).collect::<Option<_>>()?;
            let axes: [usize; 3] = indices.try_into().ok()?;
            (axes[0] != axes[1] && axes[1] != axes[2]).then_some(axes)
        };
        let form = match text {
            "quaternion_xyzw" => Some(OrientationForm::QuaternionXyzw),
            "quaternion_wxyz" => Some(OrientationForm::QuaternionWxyz),
            "rotation_vector" => Some(OrientationForm::RotationVector),
            "roll_pitch_yaw" => Some(OrientationForm::ROLL_PITCH_YAW),
            _ => match text.split_once('_') {
                Some(("intrinsic", axes)) => euler(axes).map(OrientationForm::Intrinsic),
                Some(("extrinsic", axes)) => euler(axes).map(OrientationForm::Extrinsic),
                _ => None,
            },
        };
        form.ok_or_else(|| {
            let message = format!(
                "found the orientation form `{text}`, expected quaternion_xyzw, quaternion_wxyz, rotation_vector, \
                 roll_pitch_yaw, or intrinsic_ or extrinsic_ and three axes such as intrinsic_xyz"
            );
            Error::new(ErrorKind::Syntax, message)
        })
    }
}

impl fmt::Display for OrientationForm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let euler = |f: &mut fmt::Formatter<'_>, word: &str, axes: &[usize; 3]| {
            let letters = axes.map(|axis| ["x", "y", "z"].get(axis).copied().unwrap_or_default());
            write!(f, "{word} Euler angles about {}", letters.join(", "))
        };
        match self {
            OrientationForm::QuaternionXyzw => f.write_str("quaternion x, y, z, w"),
            OrientationForm::QuaternionWxyz => f.write_str("quaternion w, x, y, z"),
            OrientationForm::RotationVector => f.write_str("rotation vector"),
            OrientationForm::Extrinsic([0, 1, 2]) => {
                f.write_str("roll, pitch, yaw (extrinsic Euler angles about x, y, z)")
            }
            OrientationForm::Intrinsic(axes) => euler(f, "intrinsic", axes),
            OrientationForm::Extrinsic(axes) => euler(f, "extrinsic", axes),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extrinsic_angles_are_intrinsic_ones_backwards() {
        let forward: OrientationForm = "intrinsic_zyx".parse().unwrap();
        let backward: OrientationForm = "roll_pitch_yaw".parse().unwrap();
        let one = forward.rotation([0.3, -0.5, 1.1, 0.0]).unwrap();
        let other = backward.rotation([1.1, -0.5, 0.3, 0.0]).unwrap();
        assert!((one - other).norm() < 1e-15);
        assert!((other - rotation::from_rpy(1.1, -0.5, 0.3)).norm() < 1e-15);
    }

    #[test]
    fn quaternions_are_normalised_only_when_they_are_nearly_unit() {
        let turned = OrientationForm::QuaternionWxyz.rotation([1.001, 0.0, 0.0, 0.0]).unwrap();
        assert!((turned - Matrix3::identity()).norm() < 1e-15);
        assert_eq!(
            OrientationForm::QuaternionXyzw.rotation([0.0, 0.0, 0.0, 0.9]).unwrap_err(),
            "found a quaternion of norm 0.9000, expected 1 to within 0.01"
        );
        assert!(OrientationForm::QuaternionXyzw.rotation([0.0; 4]).is_err());
    }

    #[test]
    fn only_sensible_axes_are_taken() {
        for bad in ["intrinsic_xx", "intrinsic_xxy", "extrinsic_xyzx", "intrinsic_abc", "euler", "extrinsic_"]
        {
            assert!(bad.parse::<OrientationForm>().is_err(), "{bad}");
        }
        assert_eq!(
            "intrinsic_zyz".parse::<OrientationForm>().unwrap(),
            OrientationForm::Intrinsic([2, 1, 2])
        );
    }
}
