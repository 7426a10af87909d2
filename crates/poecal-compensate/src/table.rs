//! Compensation of tables of joint readings.

use std::path::Path;

use super::{ChangeOptions, Compensation, CompensationSummary, ForwardCheck};
use poecal_import::{ReadOptions, RewrittenTable, rewrite_joints};
use poecal_model::robot::Robot;
use poecal_numerics::error::Result;

/// Options of the compensation of tables.
#[derive(Clone, Debug, Default)]
pub struct TableOptions {
    /// Columns, units and names.
    pub read: ReadOptions,
    /// True if the remaining error is recomputed from the written numbers by the robots' own forward kinematics.
    pub check: bool,
    /// Limits of the changes of readings.
    pub change: ChangeOptions,
    /// True if the outcome of every row is kept.
    pub each: bool,
}

/// Corrects the joint columns of a CSV row by row ([`rewrite_joints`]), for readings of `nominal` and the robot `actual` at these values of its
/// factors. Rows that cannot be corrected are unchanged and listed.
///
/// # Errors
/// Those of [`rewrite_joints`] and [`Compensation::new`].
pub fn compensate_table(
    path: impl AsRef<Path>,
    (nominal, actual): (&Robot, &Robot),
    factors: &[f64],
    options: &TableOptions,
    out: &mut dyn FnMut(&str) -> Result<()>,
) -> Result<(CompensationSummary, RewrittenTable)> {
    let path = path.as_ref();
    let mut compensation = Compensation::new(nominal, actual, factors, &options.change)?;
    let mut summary = CompensationSummary::new(&compensation);
    summary.targets = options.each.then(Vec::new);
    let mut plain = actual.clone();
    // Factors are values of this compensation, not columns of the program.
    plain.factors.clear();
    plain.terms.clear();
    let mut with_factors: Vec<f64> = Vec::new();
    let mut checked = options.check.then(ForwardCheck::default);
    let mut change = |row: &poecal_import::JointRow<'_>, numbers: &mut [f64]| -> Result<()> {
        let found = compensation.joints(row.readings);
        numbers.copy_from_slice(found.readings);
        if !found.is_corrected {
            let kept = found.outcome;
            let (left_m, left_rad) = (found.left_m, found.left_rad);
            let reason = compensation.reason(kept, (left_m, left_rad));
            summary.list(row.line, "row", reason);
            return Ok(());
        }
        summary.include(row.line, row.readings, &found);
        if let Some(checked) = &mut checked {
            with_factors.clear();
            with_factors.extend_from_slice(numbers);
            with_factors.extend_from_slice(factors);
            let left =
                actual.forward_kinematics(&with_factors).distance_and_angle(&nominal.forward_kinematics(row.readings));
            checked.include(left, row.line);
            checked.change.include(compensation.share_of_most(row.readings, numbers), row.line);
        }
        Ok(())
    };
    let table = rewrite_joints(path, &plain, &options.read, &mut change, out)?;
    summary.checked = checked;
    Ok((summary, table))
}
