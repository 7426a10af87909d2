//! The row-by-row path: every kind of measurement and parameter by its own formulas. It is the reference of the kernels, serves all
//! problems that they do not, and sums the curvature of every problem.

use nalgebra::Vector3;

use super::Problem;
use crate::estimate::{Chain, Estimate, Linkage};
use crate::lie::TargetTwist;
use crate::parameters::Wrench;
use crate::solve::{LeastSquares as _, Normal};
use crate::threads;

/// Rows of one partial sum. Fixed, so that the result does not depend on the number of threads.
const CHUNK: usize = 1024;
/// Partial sums held at a time, so that memory beside the data stays bounded.
const GROUP: usize = 64;
/// Rows of one block of the Jacobian.
const BLOCK: usize = 16;

impl Problem<'_> {
    /// Calls `each` with the whitened Jacobian of the prediction (row-major) and residual of each row in turn (theory.md §4 (17)).
    pub fn for_rows(&self, state: &Estimate, rows: &[u32], mut each: impl FnMut(u32, &[f64], &[f64])) {
        let n = self.layout.dim();
        let linkage = Linkage::new(state);
        let mut chain = Chain::default();
        let mut columns: Vec<TargetTwist> = vec![(Vector3::zeros(), Vector3::zeros()); n];
        let mut jacobian = vec![0.0; 6 * n];
        let mut residual = [0.0; 6];
        for &row in rows {
            let observation = self.session.observation(row);
            let written = self.written(row as usize);
            let measurement = written.model();
            let (noise, dim) = (self.noise(row as usize), measurement.dim());
            chain.evaluate(&linkage, self.session.packed, row as usize, observation);
            self.layout.target_twists(&chain, observation.target, &mut columns);
            measurement.project(&chain.target, &columns, &noise, n, &mut jacobian);
            measurement.residual(&chain.target, &noise, &mut residual);
            each(row, &jacobian[..dim * n], &residual[..dim]);
        }
    }

    /// [`LeastSquares::normal`] by the general path, which serves every problem: theory.md §6 (28), row after row.
    #[must_use]
    pub fn normal_row_by_row(&self, state: &Estimate) -> Normal {
        let linkage = Linkage::new(state);
        let seen = self.sum_chunks(|rows| {
            let mut normal = Normal::new(self.layout.dim());
            self.for_blocks(
                &linkage,
                rows,
                |chain, row, out| {
                    self.written(row).model().residual(&chain.target, &self.noise(row), out);
                },
                &mut normal,
            );
            normal
        });
        self.add_prior(state, seen)
    }

    /// [`LeastSquares::second_order`]: `Jᵀ e''` of theory.md §6 (31).
    pub(super) fn second_order_by_rows(&self, state: &Estimate, step: &[f64]) -> Vec<f64> {
        // Central second difference along the step: at 0.1 of the step, truncation and rounding are both far below the accuracy that a
        // correction of the step needs.
        const FRACTION: f64 = 0.1;
        let along = |sign: f64| {
            let part: Vec<f64> = step.iter().map(|s| sign * FRACTION * s).collect();
            Linkage::new(&self.retract(state, &part))
        };
        let (ahead, behind) = (along(1.0), along(-1.0));
        let linkage = Linkage::new(state);
        let total = self.sum_chunks(|rows| {
            let mut normal = Normal::new(self.layout.dim());
            let mut chain = Chain::default();
            let (mut e_ahead, mut e_behind) = ([0.0; 6], [0.0; 6]);
            self.for_blocks(
                &linkage,
                rows,
                |here, row, out| {
                    let observation = &self.session.data.observations[row];
                    let written = self.written(row);
                    let measurement = written.model();
                    let noise = self.noise(row);
                    chain.evaluate(&ahead, self.session.packed, row, observation);
                    measurement.residual(&chain.target, &noise, &mut e_ahead);
                    chain.evaluate(&behind, self.session.packed, row, observation);
                    measurement.residual(&chain.target, &noise, &mut e_behind);
                    measurement.residual(&here.target, &noise, out);
                    for (e, (a, b)) in out.iter_mut().zip(e_ahead.iter().zip(&e_behind)) {
                        *e = (a + b - 2.0 * *e) / (FRACTION * FRACTION);
                    }
                },
                &mut normal,
            );
            normal
        });
        total.gradient
    }

    /// [`LeastSquares::curvature`]: the C of theory.md §6 (31a).
    pub(super) fn curvature_by_rows(&self, state: &Estimate) -> Option<Vec<f64>> {
        if !self.layout.has_curvature() {
            return None;
        }
        let linkage = Linkage::new(state);
        let total = self.sum_chunks(|rows| {
            let mut normal = Normal::new(self.layout.dim());
            let mut chain = Chain::default();
            for &row in rows {
                let row = row as usize;
                let observation = &self.session.data.observations[row];
                if observation.from.is_some() {
                    // An unknown that moves the target twice has no formula for its second derivative.
                    return normal;
                }
                chain.evaluate(&linkage, self.session.packed, row, observation);
                let written = self.written(row);
                let Some((force, torque)) = written.model().wrench(&chain.target, &self.noise(row)) else {
                    return normal;
                };
                normal.residuals += 1;
                let wrench = Wrench { force, torque };
                self.layout.add_curvature(&chain, observation.target, &wrench, &mut normal.gram);
            }
            normal
        });
        (total.residuals == self.rows.len()).then_some(total.gram)
    }

    /// Adds up `add` of each fixed chunk of rows, in the order of the rows whatever the number of threads.
    fn sum_chunks(&self, add: impl Fn(&[u32]) -> Normal + Sync + Send) -> Normal {
        if self.rows.len() <= CHUNK {
            return add(&self.rows);
        }
        let mut total = Normal::new(self.layout.dim());
        for group in self.rows.chunks(CHUNK * GROUP) {
            let parts = threads::map_chunks(group, CHUNK, |_, rows| add(rows));
            parts.iter().for_each(|part| total.add(part));
        }
        total
    }

    /// Gathers Jacobian and residuals of the rows in blocks, and adds each block to the normal equations.
    fn for_blocks(
        &self,
        linkage: &Linkage,
        rows: &[u32],
        mut residual: impl FnMut(&Chain, usize, &mut [f64]),
        normal: &mut Normal,
    ) {
        let n = self.layout.dim();
        let mut chain = Chain::default();
        let mut columns: Vec<TargetTwist> = vec![(Vector3::zeros(), Vector3::zeros()); n];
        let mut jacobian = vec![0.0; 6 * n];
        let mut residuals = [0.0; 6];
        let mut full = Block::default();
        let mut turning = Block::default();
        for (count, &row) in rows.iter().enumerate() {
            let row = row as usize;
            let observation = &self.session.data.observations[row];
            let written = self.written(row);
            let measurement = written.model();
            chain.evaluate(linkage, self.session.packed, row, observation);
            self.layout.target_twists(&chain, observation.target, &mut columns);
            let (dim, split) = (measurement.dim(), measurement.rotation_row());
            measurement.project(&chain.target, &columns, &self.noise(row), n, &mut jacobian);
            residual(&chain, row, &mut residuals);
            full.push(&jacobian[..split * n], &residuals[..split]);
            turning.push(&jacobian[split * n..dim * n], &residuals[split..dim]);
            if count % BLOCK == BLOCK - 1 {
                full.flush(normal, 0);
                turning.flush(normal, self.layout.shifts());
            }
        }
        full.flush(normal, 0);
        turning.flush(normal, self.layout.shifts());
    }
}

/// Rows of the Jacobian that are not yet accumulated.
#[derive(Default)]
struct Block {
    rows: Vec<f64>,
    residuals: Vec<f64>,
}

impl Block {
    fn push(&mut self, rows: &[f64], residuals: &[f64]) {
        self.rows.extend_from_slice(rows);
        self.residuals.extend_from_slice(residuals);
    }

    fn flush(&mut self, normal: &mut Normal, start: usize) {
        normal.add_rows(&self.rows, &self.residuals, start);
        self.rows.clear();
        self.residuals.clear();
    }
}
