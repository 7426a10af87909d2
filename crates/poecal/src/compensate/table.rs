//! Compensation of tables of joint readings.

use std::path::Path;

use super::{Compensation, Summary};
use crate::error::{Error, ErrorKind, Result};
use crate::io::measurements::{ReadOptions, RewrittenTable, rewrite_joints};
use crate::robot::Robot;

/// How tables are compensated.
#[derive(Clone, Debug, Default)]
pub struct TableOptions {
    /// Columns, units and names.
    pub read: ReadOptions,
    /// Compute what is left once more, from the written numbers by the robots' own forward kinematics.
    pub check: bool,
    /// Write the nearest configuration where a pose cannot be reached.
    pub nearest: bool,
}

/// Corrects the joint columns of a CSV row by row ([`rewrite_joints`]), for readings of `nominal` and the robot `actual` at these values of
/// its factors.
///
/// # Errors
/// As [`rewrite_joints`] and [`Compensation::new`]; [`ErrorKind::Problem`] if a pose cannot be reached by an arm of six or more joints
/// and `nearest` is not set.
pub fn compensate_table(
    path: impl AsRef<Path>,
    (nominal, actual): (&Robot, &Robot),
    factors: &[f64],
    options: &TableOptions,
    out: &mut dyn FnMut(&str) -> Result<()>,
) -> Result<(Summary, RewrittenTable)> {
    let path = path.as_ref();
    let mut compensation = Compensation::new(nominal, actual, factors)?;
    let mut summary = Summary::new(&compensation);
    let mut plain = actual.clone();
    // Factors are values of this compensation, no columns of the program.
    plain.factors.clear();
    plain.terms.clear();
    let is_free = compensation.readings().len() >= 6;
    let mut with_factors: Vec<f64> = Vec::new();
    let mut checked = options.check.then(Default::default);
    let mut change = |row: &crate::io::measurements::JointRow<'_>, numbers: &mut [f64]| -> Result<()> {
        let found = compensation.joints(row.readings);
        if is_free && !options.nearest && !found.is_reached() {
            let message = format!(
                "the actual robot cannot reach the pose of this row: {:.3} mm and {:.4} degrees are left at the nearest configuration, expected \
                 poses in reach: leave out the row, or take --nearest",
                found.left_m * 1e3,
                found.left_rad.to_degrees()
            );
            return Err(Error::new(ErrorKind::Problem, message).at_line(path, row.line));
        }
        summary.include(row.line, row.readings, &found);
        numbers.copy_from_slice(found.readings);
        if let Some((metres, radians)) = &mut checked {
            with_factors.clear();
            with_factors.extend_from_slice(found.readings);
            with_factors.extend_from_slice(factors);
            let (m, rad): (f64, f64) =
                actual.forward_kinematics(&with_factors).apart(&nominal.forward_kinematics(row.readings));
            super::Largest::include(metres, m, row.line);
            super::Largest::include(radians, rad, row.line);
        }
        Ok(())
    };
    let table = rewrite_joints(path, &plain, &options.read, &mut change, out)?;
    summary.checked = checked;
    Ok((summary, table))
}
