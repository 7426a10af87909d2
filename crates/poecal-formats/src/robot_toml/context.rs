//! Numbers of the file in SI, checked, with their positions for messages.

use std::ops::Range;
use std::path::Path;

use nalgebra::{Matrix3, Vector3, Vector4};
use toml::Spanned;

use super::file::{AngleUnit, LengthUnit, PoseTable};
use poecal_arm::lie::{Pose, rotation};
use poecal_model::robot::{JointKind, check_name};
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_storage::numbers::LARGEST_NUMBER;

/// Rounding of tables with four digits, in unit vectors, quaternions and rotation matrices.
pub(crate) const TABLE_ROUNDING: f64 = 2e-3;

/// Text, for positions, and units.
pub(crate) struct Context<'a> {
    pub(crate) text: &'a str,
    pub(crate) path: &'a Path,
    pub(crate) length: LengthUnit,
    pub(crate) angle: AngleUnit,
}

/// Byte range of a value, if it exists.
pub(crate) fn span<T>(value: &Option<Spanned<T>>) -> Option<Range<usize>> {
    value.as_ref().map(Spanned::span)
}

impl Context<'_> {
    pub(crate) fn error(&self, span: Range<usize>, message: String) -> Error {
        ErrorKind::Model.error(message).at_offset(self.path, self.text, span.start)
    }

    /// Refuses the first of the keys that exists.
    pub(crate) fn refuse<const N: usize>(
        &self,
        keys: [(&str, Option<Range<usize>>); N],
        message: impl Fn(&str) -> String,
    ) -> Result<()> {
        match keys.into_iter().find_map(|(key, span)| Some((key, span?))) {
            Some((key, span)) => Err(self.error(span, message(key))),
            None => Ok(()),
        }
    }

    /// The numbers, if all are finite and of plausible size.
    pub(crate) fn check_numbers<const N: usize>(
        &self,
        numbers: [f64; N],
        span: Range<usize>,
        of: &str,
    ) -> Result<[f64; N]> {
        for number in numbers {
            if !number.is_finite() {
                return Err(self.error(span, format!("found {number} in {of}, expected finite numbers")));
            }
            if number.abs() > LARGEST_NUMBER {
                let message = format!("found {number:?} m or rad in {of}, expected numbers below 1e6 m or rad");
                return Err(self.error(span, message));
            }
        }
        Ok(numbers)
    }

    pub(crate) fn metres<const N: usize>(&self, lengths: [f64; N], span: Range<usize>, of: &str) -> Result<[f64; N]> {
        self.check_numbers(lengths.map(|length| self.length.to_metres(length)), span, of)
    }

    pub(crate) fn radians<const N: usize>(&self, angles: [f64; N], span: Range<usize>, of: &str) -> Result<[f64; N]> {
        self.check_numbers(angles.map(|angle| self.angle.to_radians(angle)), span, of)
    }

    /// A joint's value in radians or metres.
    pub(crate) fn joint_value(&self, kind: JointKind, value: f64) -> f64 {
        match kind {
            JointKind::Revolute => self.angle.to_radians(value),
            JointKind::Prismatic => self.length.to_metres(value),
        }
    }

    /// A name, neither empty nor with a character that XML, and so a URDF, cannot hold.
    pub(crate) fn name(&self, name: &Spanned<String>, of: &str) -> Result<String> {
        if let Some(c) = name.get_ref().chars().find(|&c| c < ' ' && !c.is_ascii_whitespace() || c == '\u{c}') {
            let found = format!("found the control character {} in the name of {of}", c.escape_unicode());
            return Err(self.error(name.span(), format!("{found}, expected characters that can be seen")));
        }
        if name.get_ref().trim().is_empty() {
            return Err(self.error(name.span(), format!("the name of {of} is empty, expected a name")));
        }
        check_name(name.get_ref(), of.strip_prefix("the ").unwrap_or(of))
            .map_err(|error| self.error(name.span(), error.message().to_owned()))?;
        Ok(name.get_ref().clone())
    }

    pub(crate) fn pose(&self, table: &PoseTable, of: &str) -> Result<Pose> {
        let position = self.metres(*table.position.get_ref(), table.position.span(), of)?;
        let given = [span(&table.quaternion_xyzw), span(&table.rpy), span(&table.rotation)];
        if let Some(second) = given.into_iter().flatten().nth(1) {
            let message =
                format!("{of} has more than one orientation, expected one of quaternion_xyzw, rpy and rotation");
            return Err(self.error(second, message));
        }
        let mut turn = Matrix3::identity();
        if let Some(quaternion) = &table.quaternion_xyzw {
            turn = self.quaternion(quaternion, of)?;
        } else if let Some(rpy) = &table.rpy {
            let [roll, pitch, yaw] = self.radians(*rpy.get_ref(), rpy.span(), of)?;
            turn = rotation::from_rpy(roll, pitch, yaw);
        } else if let Some(rows) = &table.rotation {
            turn = self.rotation(rows, of)?;
        }
        Ok(Pose::new(turn, Vector3::from(position)))
    }

    fn quaternion(&self, quaternion: &Spanned<[f64; 4]>, of: &str) -> Result<Matrix3<f64>> {
        let q = Vector4::from(self.check_numbers(*quaternion.get_ref(), quaternion.span(), of)?);
        if (q.norm() - 1.0).abs() > TABLE_ROUNDING {
            let message =
                format!("the quaternion of {of} has length {:.4}, expected a unit quaternion (x, y, z, w)", q.norm());
            return Err(self.error(quaternion.span(), message));
        }
        Ok(rotation::from_quaternion_xyzw(&q))
    }

    fn rotation(&self, rows: &Spanned<[[f64; 3]; 3]>, of: &str) -> Result<Matrix3<f64>> {
        let mut matrix = Matrix3::zeros();
        for (row, numbers) in rows.get_ref().iter().enumerate() {
            let numbers = self.check_numbers(*numbers, rows.span(), of)?;
            matrix.set_row(row, &Vector3::from(numbers).transpose());
        }
        let skew = (matrix.transpose() * matrix - Matrix3::identity()).amax();
        if skew > 2.0 * TABLE_ROUNDING {
            let message = format!(
                "the rows of the rotation of {of} are off perpendicular unit vectors by {skew:.4}, expected a rotation matrix"
            );
            return Err(self.error(rows.span(), message));
        }
        if matrix.determinant() < 0.0 {
            let message = format!("the rotation of {of} is a reflection, expected a rotation matrix (determinant +1)");
            return Err(self.error(rows.span(), message));
        }
        // Each step squares the error of at most 4e-3, so three reach rounding.
        Ok((0..3).fold(matrix, |matrix, _| rotation::orthonormalized(&matrix)))
    }
}
