//! Forms of orientations in files.

use std::fmt;
use std::str::FromStr;

use nalgebra::{Matrix3, Vector4};

use poecal_arm::lie::angles::Angles;
use poecal_arm::lie::rotation;
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_numerics::unit::Unit;

/// Largest deviation of a quaternion's norm from 1.
const QUATERNION_TOLERANCE: f64 = 1e-2;

/// Largest deviation of a matrix's rows from lengths of 1 and right angles.
const MATRIX_TOLERANCE: f64 = 1e-2;
/// Most columns of a form.
pub(crate) const MOST_PARTS: usize = 9;

/// Rotation from three angles, four quaternion parts, or the nine numbers of a matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OrientationForm {
    /// Quaternion parts in the order x, y, z, w.
    QuaternionXyzw,
    /// Quaternion parts in the order w, x, y, z.
    QuaternionWxyz,
    /// The rotation's matrix, row by row.
    MatrixByRows,
    /// The same, column by column.
    MatrixByColumns,
    /// Three angles.
    Angles(Angles),
}

/// Three angles.
const fn angles(of: Angles) -> OrientationForm {
    OrientationForm::Angles(of)
}

impl OrientationForm {
    /// Axis times angle.
    pub(crate) const ROTATION_VECTOR: Self = angles(Angles::RotationVector);
    /// URDF's roll, pitch, yaw.
    pub(crate) const ROLL_PITCH_YAW: Self = angles(Angles::ROLL_PITCH_YAW);
    /// Forms that columns have by our names.
    pub(crate) const BY_NAME: [Self; 3] = [Self::QuaternionXyzw, Self::ROTATION_VECTOR, Self::ROLL_PITCH_YAW];
    /// Forms that are not three angles about axes, and the most frequent ones, first the most frequent.
    pub(crate) const NAMED: [Self; 6] = [
        Self::QuaternionXyzw,
        Self::QuaternionWxyz,
        Self::ROTATION_VECTOR,
        Self::ROLL_PITCH_YAW,
        Self::MatrixByRows,
        Self::MatrixByColumns,
    ];

    /// As a mapping has it.
    pub(crate) fn mapped(self) -> String {
        match self {
            OrientationForm::QuaternionXyzw => "quaternion_xyzw".to_owned(),
            OrientationForm::QuaternionWxyz => "quaternion_wxyz".to_owned(),
            OrientationForm::MatrixByRows => "rotation_matrix".to_owned(),
            OrientationForm::MatrixByColumns => "rotation_matrix_by_columns".to_owned(),
            OrientationForm::Angles(angles) => angles.to_string(),
        }
    }

    /// Number of columns.
    pub(crate) fn len(self) -> usize {
        self.part_names().len()
    }

    /// Unit of its columns.
    pub(crate) fn quantity(self) -> Unit {
        if self.len() == 3 { Unit::Radian } else { Unit::One }
    }

    /// Column names in our own files, in order; empty for Euler angles, which these do not have.
    pub(crate) fn own_columns(self) -> &'static [&'static str] {
        let is_own = self == Self::QuaternionWxyz || Self::BY_NAME.contains(&self);
        if is_own { self.part_names() } else { &[] }
    }

    /// Contents of its columns, in order.
    pub(crate) fn part_names(self) -> &'static [&'static str] {
        match self {
            OrientationForm::QuaternionXyzw => &["qx", "qy", "qz", "qw"],
            OrientationForm::QuaternionWxyz => &["qw", "qx", "qy", "qz"],
            OrientationForm::MatrixByRows => &["r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"],
            OrientationForm::MatrixByColumns => {
                &["r11", "r21", "r31", "r12", "r22", "r32", "r13", "r23", "r33"]
            }
            Self::ROTATION_VECTOR => &["rx", "ry", "rz"],
            Self::ROLL_PITCH_YAW => &["roll", "pitch", "yaw"],
            OrientationForm::Angles(_) => &["first angle", "second angle", "third angle"],
        }
    }

    /// The rotation of the columns' values (radians, quaternion parts or a matrix), or what was found and expected.
    pub(crate) fn rotation(self, values: &[f64]) -> std::result::Result<Matrix3<f64>, String> {
        let all: [f64; MOST_PARTS] = std::array::from_fn(|part| values.get(part).copied().unwrap_or(0.0));
        let [a, b, c, d, ..] = all;
        match self {
            OrientationForm::QuaternionXyzw => quaternion(Vector4::new(a, b, c, d)),
            OrientationForm::QuaternionWxyz => quaternion(Vector4::new(b, c, d, a)),
            OrientationForm::MatrixByRows => matrix(&Matrix3::from_row_slice(&all)),
            OrientationForm::MatrixByColumns => matrix(&Matrix3::from_column_slice(&all)),
            OrientationForm::Angles(angles) => Ok(angles.rotation([a, b, c])),
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

/// The rotation nearest to a matrix that is one but for rounding.
fn matrix(found: &Matrix3<f64>) -> std::result::Result<Matrix3<f64>, String> {
    let off = (found.transpose() * found - Matrix3::identity()).amax();
    if off > MATRIX_TOLERANCE || off.is_nan() {
        return Err(format!(
            "found nine numbers whose rows are no rotation (off by {off:.3}), expected one to within {MATRIX_TOLERANCE}: check the columns and their \
             order"
        ));
    }
    if found.determinant() < 0.0 {
        return Err("found the matrix of a reflection, expected that of a rotation: an axis is mirrored, or two columns are exchanged".to_owned());
    }
    // Each step squares what is off.
    Ok((0..4).fold(*found, |it, _| rotation::orthonormalized(&it)))
}

impl FromStr for OrientationForm {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let angles = text.parse().ok().map(OrientationForm::Angles);
        let form = angles.or_else(|| OrientationForm::NAMED.into_iter().find(|it| it.mapped() == text));
        form.ok_or_else(|| ErrorKind::Syntax.error(format!(
                "found the orientation form `{text}`, expected quaternion_xyzw, quaternion_wxyz, rotation_vector, \
                 rotation_matrix, rotation_matrix_by_columns, roll_pitch_yaw, or intrinsic_ or extrinsic_ and three axes such as intrinsic_xyz"
            )))
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
            OrientationForm::MatrixByRows => f.write_str("rotation matrix by rows"),
            OrientationForm::MatrixByColumns => f.write_str("rotation matrix by columns"),
            &Self::ROLL_PITCH_YAW => f.write_str("roll, pitch, yaw (extrinsic Euler angles about x, y, z)"),
            OrientationForm::Angles(Angles::RotationVector) => f.write_str("rotation vector"),
            OrientationForm::Angles(Angles::Intrinsic(axes)) => euler(f, "intrinsic", axes),
            OrientationForm::Angles(Angles::Extrinsic(axes)) => euler(f, "extrinsic", axes),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quaternions_are_normalised_only_when_they_are_nearly_unit() {
        let turned = OrientationForm::QuaternionWxyz.rotation(&[1.001, 0.0, 0.0, 0.0]).unwrap();
        assert!((turned - Matrix3::identity()).norm() < 1e-15);
        assert_eq!(
            OrientationForm::QuaternionXyzw.rotation(&[0.0, 0.0, 0.0, 0.9]).unwrap_err(),
            "found a quaternion of norm 0.9000, expected 1 to within 0.01"
        );
        assert!(OrientationForm::QuaternionXyzw.rotation(&[0.0; 4]).is_err());
    }

    #[test]
    fn matrices_are_those_of_rotations() {
        let turned = rotation::from_rpy(0.3, -0.5, 1.1);
        // As files have it, with six decimals.
        let rounded = turned.map(|it| (it * 1e6).round() * 1e-6);
        let by_columns: Vec<f64> = rounded.iter().copied().collect();
        let by_rows: Vec<f64> = rounded.transpose().iter().copied().collect();
        for (form, values) in [("rotation_matrix", &by_rows), ("rotation_matrix_by_columns", &by_columns)] {
            let form: OrientationForm = form.parse().unwrap();
            assert_eq!((form.len(), form.quantity()), (9, Unit::One));
            let found = form.rotation(values).unwrap();
            assert!((found - turned).amax() < 1e-6);
            assert!((found.transpose() * found - Matrix3::identity()).amax() < 1e-15);
        }
        let mirrored: Vec<f64> =
            by_rows.iter().enumerate().map(|(k, it)| if k < 3 { -it } else { *it }).collect();
        let error = OrientationForm::MatrixByRows.rotation(&mirrored).unwrap_err();
        assert!(error.contains("a reflection"), "{error}");
        let error = OrientationForm::MatrixByRows.rotation(&[0.5; 9]).unwrap_err();
        assert!(error.contains("rows are no rotation (off by 0.750)"), "{error}");
    }
}
