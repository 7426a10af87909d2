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
/// Largest number of columns of a form.
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
    /// The rotation's matrix, column by column.
    MatrixByColumns,
    /// Three angles.
    Angles(Angles),
}

/// A form with its name in a mapping, its words, and the contents of its columns in order.
type NamedOrientation = (OrientationForm, &'static str, &'static str, &'static [&'static str]);

/// Forms that are not three angles about axes, and the most frequent ones, first the most frequent.
const NAMED: [NamedOrientation; 6] = [
    (OrientationForm::QuaternionXyzw, "quaternion_xyzw", "quaternion x, y, z, w", &["qx", "qy", "qz", "qw"]),
    (OrientationForm::QuaternionWxyz, "quaternion_wxyz", "quaternion w, x, y, z", &["qw", "qx", "qy", "qz"]),
    (OrientationForm::ROTATION_VECTOR, "rotation_vector", "rotation vector", &["rx", "ry", "rz"]),
    (
        OrientationForm::ROLL_PITCH_YAW,
        "roll_pitch_yaw",
        "roll, pitch, yaw (extrinsic Euler angles about x, y, z)",
        &["roll", "pitch", "yaw"],
    ),
    (
        OrientationForm::MatrixByRows,
        "rotation_matrix",
        "rotation matrix by rows",
        &["r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"],
    ),
    (
        OrientationForm::MatrixByColumns,
        "rotation_matrix_by_columns",
        "rotation matrix by columns",
        &["r11", "r21", "r31", "r12", "r22", "r32", "r13", "r23", "r33"],
    ),
];

impl OrientationForm {
    /// Rotation vector: axis times angle.
    pub(crate) const ROTATION_VECTOR: Self = OrientationForm::Angles(Angles::RotationVector);
    /// URDF's roll, pitch, yaw.
    pub(crate) const ROLL_PITCH_YAW: Self = OrientationForm::Angles(Angles::ROLL_PITCH_YAW);
    /// Forms of columns with our names.
    pub(crate) const BY_NAME: [Self; 3] = [Self::QuaternionXyzw, Self::ROTATION_VECTOR, Self::ROLL_PITCH_YAW];

    /// Forms that have a name of their own, first the most frequent.
    pub(crate) fn with_names() -> impl Iterator<Item = Self> {
        NAMED.iter().map(|it| it.0)
    }

    fn named_form(self) -> Option<&'static NamedOrientation> {
        NAMED.iter().find(|it| it.0 == self)
    }

    /// Name in a mapping.
    pub(crate) fn mapping_text(self) -> String {
        match (self, self.named_form()) {
            (OrientationForm::Angles(angles), None) => angles.to_string(),
            (_, named) => named.map_or("", |it| it.1).to_owned(),
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

    /// Column names in our own files, in order; empty for matrices and Euler angles, which these files do not have.
    pub(crate) fn own_columns(self) -> &'static [&'static str] {
        let is_own = self == Self::QuaternionWxyz || Self::BY_NAME.contains(&self);
        if is_own { self.part_names() } else { &[] }
    }

    /// Contents of its columns, in order.
    pub(crate) fn part_names(self) -> &'static [&'static str] {
        self.named_form().map_or(&["first angle", "second angle", "third angle"], |it| it.3)
    }

    /// The rotation of the columns' values (radians, quaternion parts or a matrix), or the text that was found and the expected one.
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
        return Err(format!("found a quaternion of norm {norm:.4}, expected 1 to within {QUATERNION_TOLERANCE}"));
    }
    Ok(rotation::from_quaternion_xyzw(&q))
}

/// The rotation nearest to a matrix that is a rotation except for rounding.
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
    // Each step squares the deviation.
    Ok((0..4).fold(*found, |it, _| rotation::orthonormalized(&it)))
}

impl FromStr for OrientationForm {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let named = NAMED.iter().find(|it| it.1 == text).map(|it| it.0);
        let form = named.or_else(|| text.parse().ok().map(OrientationForm::Angles));
        form.ok_or_else(|| ErrorKind::Syntax.error(format!(
                "found the orientation form `{text}`, expected quaternion_xyzw, quaternion_wxyz, rotation_vector, \
                 rotation_matrix, rotation_matrix_by_columns, roll_pitch_yaw, or intrinsic_ or extrinsic_ and three axes such as intrinsic_xyz"
            )))
    }
}

impl fmt::Display for OrientationForm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (word, axes) = match (self.named_form(), self) {
            (None, OrientationForm::Angles(Angles::Intrinsic(axes))) => ("intrinsic", axes),
            (None, OrientationForm::Angles(Angles::Extrinsic(axes))) => ("extrinsic", axes),
            (named, _) => return f.write_str(named.map_or("", |it| it.2)),
        };
        let letters = axes.map(|axis| ["x", "y", "z"].get(axis).copied().unwrap_or_default());
        write!(f, "{word} Euler angles about {}", letters.join(", "))
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
        // Files state six decimals.
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
        let mirrored: Vec<f64> = by_rows.iter().enumerate().map(|(k, it)| if k < 3 { -it } else { *it }).collect();
        let error = OrientationForm::MatrixByRows.rotation(&mirrored).unwrap_err();
        assert!(error.contains("a reflection"), "{error}");
        let error = OrientationForm::MatrixByRows.rotation(&[0.5; 9]).unwrap_err();
        assert!(error.contains("rows are no rotation (off by 0.750)"), "{error}");
    }
}
