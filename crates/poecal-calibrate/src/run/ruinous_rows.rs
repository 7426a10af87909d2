//! Rows of a small session that alone ruin its start (theory.md §6, *Outliers*).

use super::CalibrationRun;
use super::fit::free_parameters;
use crate::robust::RobustLoss;
use crate::steps::fit_progress::RegisteredStart;
use poecal_fit::start::{register_robustly, row_distances};
use poecal_numerics::distributions::median;

/// Numbers for each unknown from which a robust fit finds such rows by itself.
const ENOUGH: usize = 4;
/// Distance of a gross row from a robust start, as a multiple of the median over all rows: axes with errors of degrees cause less than a tenth of it.
const GROSS: f64 = 30.0;
/// Ratio of the median distance from the usual start to that from the robust one, if the usual start is ruined.
const RUINED: f64 = 5.0;
/// Largest share of such rows: one in this number, or one.
const ONE_OF: usize = 10;

impl CalibrationRun<'_> {
    /// The run without rows that ruin the start, which are then suspected, with the start of the others.
    pub(crate) fn without_ruinous(self, start: RegisteredStart) -> (Self, RegisteredStart) {
        let rows = self.in_pool(|| self.find_ruinous_rows(&start));
        if rows.is_empty() {
            return (self, start);
        }
        let kept: Vec<u32> = self.fit_rows.iter().copied().filter(|row| !rows.contains(row)).collect();
        let start = self.register_by(&kept);
        (self.leaving_out(rows), start)
    }

    fn find_ruinous_rows(&self, start: &RegisteredStart) -> Vec<u32> {
        let session = self.session(&[]);
        let RegisteredStart { registered, noise, .. } = start;
        if self.options.robust != RobustLoss::Auto || !self.left_out.is_empty() {
            return Vec::new();
        }
        let joints = (self.options.formulation.joint_parameters)(registered.kinds());
        let free = free_parameters(&session, registered, &self.fit_rows, joints);
        let unknowns: usize = free.iter().map(|it| it.model().columns().len()).sum();
        let numbers: usize = self.fit_rows.iter().map(|&row| session.observation(row).measurement.dim()).sum();
        if numbers >= ENOUGH * unknowns {
            return Vec::new();
        }
        let registration = self.registration(session, &self.fit_rows, *noise, true);
        let usual = median(row_distances(&registration, registered).into_iter());
        let distances = row_distances(&registration, &register_robustly(&registration, &self.delivered));
        let Some((usual, middle)) = usual.zip(median(distances.iter().copied())) else { return Vec::new() };
        let is_gross = |distance: &f64| *distance > GROSS * middle;
        let gross: Vec<u32> =
            self.fit_rows.iter().zip(&distances).filter(|it| is_gross(it.1)).map(|it| *it.0).collect();
        let are_few = gross.len() <= (self.fit_rows.len() / ONE_OF).max(1);
        if usual > RUINED * middle && are_few { gross } else { Vec::new() }
    }
}
