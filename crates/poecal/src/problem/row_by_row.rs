//! The row-by-row path: every kind of measurement and parameter by its own formulas. It is the reference of the kernels, serves all
//! problems that they do not, and sums the curvature of every problem.

use nalgebra::Vector3;

use super::Problem;
use crate::estimate::{Chain, Estimate, Linkage};
use crate::lie::{Pose, TargetTwist};
use crate::measurement::NUMBERS;
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
        let mut jacobian = vec![0.0; NUMBERS * n];
        let mut residual = [0.0; NUMBERS];
        for &row in rows {
            let observation = self.session.observation(row);
            chain.evaluate(&linkage, self.session.packed, row as usize, observation);
            self.layout.target_twists(&chain, observation.target, &mut columns);
            let dim = self.project(row as usize, &chain.target, &columns, &mut jacobian);
            self.residual(row as usize, &chain.target, &mut residual);
            each(row, &jacobian[..dim * n], &residual[..dim]);
        }
    }

    /// The whitened residual of a row for its predicted target.
    fn residual(&self, row: usize, predicted: &Pose, out: &mut [f64]) {
        let written = self.written(row);
        let (seen, noise) = (written.model(), self.noise(row));
        seen.residual(predicted, out);
        for (e, channel) in out.iter_mut().zip(seen.channels()) {
            *e /= noise[channel.quantity];
        }
    }

    /// Writes the whitened sensitivity of the prediction to each column twist, row-major; returns the number of rows.
    fn project(&self, row: usize, predicted: &Pose, columns: &[TargetTwist], out: &mut [f64]) -> usize {
        let written = self.written(row);
        let (seen, noise) = (written.model(), self.noise(row));
        let mut sensitivity = [[0.0; 6]; NUMBERS];
        seen.sensitivity(predicted, &mut sensitivity);
        let rows = sensitivity.iter().zip(seen.channels());
        for ((numbers, channel), out) in rows.zip(out.chunks_exact_mut(columns.len().max(1))) {
            let weight = 1.0 / noise[channel.quantity];
            let [a, b, c, p, q, r] = numbers.map(|number| number * weight);
            for ((v, w), out) in columns.iter().zip(out) {
                *out = a * v.x + b * v.y + c * v.z + p * w.x + q * w.y + r * w.z;
            }
        }
        seen.dim()
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
                |chain, row, out| self.residual(row, &chain.target, out),
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
            let (mut e_ahead, mut e_behind) = ([0.0; NUMBERS], [0.0; NUMBERS]);
            self.for_blocks(
                &linkage,
                rows,
                |here, row, out| {
                    let observation = &self.session.data.observations[row];
                    chain.evaluate(&ahead, self.session.packed, row, observation);
                    self.residual(row, &chain.target, &mut e_ahead);
                    chain.evaluate(&behind, self.session.packed, row, observation);
                    self.residual(row, &chain.target, &mut e_behind);
                    self.residual(row, &here.target, out);
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
                let Some(wrench) = self.wrench(row, &chain.target) else { return normal };
                normal.residuals += 1;
                self.layout.add_curvature(&chain, observation.target, &wrench, &mut normal.gram);
            }
            normal
        });
        (total.residuals == self.rows.len()).then_some(total.gram)
    }

    /// The whitened residual of a row as force and torque on its target, `Sᵀ W e`, where the curvature is theirs (theory.md §6 (31a)).
    fn wrench(&self, row: usize, predicted: &Pose) -> Option<Wrench> {
        let written = self.written(row);
        let (seen, noise) = (written.model(), self.noise(row));
        let (mut e, mut sensitivity) = ([0.0; NUMBERS], [[0.0; 6]; NUMBERS]);
        seen.residual(predicted, &mut e);
        seen.sensitivity(predicted, &mut sensitivity);
        let mut wrench = Wrench { force: Vector3::zeros(), torque: Vector3::zeros() };
        for ((e, [a, b, c, p, q, r]), channel) in e.into_iter().zip(sensitivity).zip(seen.channels()) {
            let pull = e / (noise[channel.quantity] * noise[channel.quantity]);
            wrench.force += Vector3::new(a, b, c) * pull;
            wrench.torque += Vector3::new(p, q, r) * pull;
        }
        seen.is_wrench().then_some(wrench)
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
        let mut jacobian = vec![0.0; NUMBERS * n];
        let mut residuals = [0.0; NUMBERS];
        let mut full = Block::default();
        for (count, &row) in rows.iter().enumerate() {
            let row = row as usize;
            let observation = &self.session.data.observations[row];
            chain.evaluate(linkage, self.session.packed, row, observation);
            self.layout.target_twists(&chain, observation.target, &mut columns);
            let dim = self.project(row, &chain.target, &columns, &mut jacobian);
            residual(&chain, row, &mut residuals);
            full.push(&jacobian[..dim * n], &residuals[..dim]);
            if count % BLOCK == BLOCK - 1 {
                full.flush(normal);
            }
        }
        full.flush(normal);
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

    fn flush(&mut self, normal: &mut Normal) {
        normal.add_rows(&self.rows, &self.residuals, 0);
        self.rows.clear();
        self.residuals.clear();
    }
}
