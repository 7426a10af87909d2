//! Second derivatives of a problem: along a step, and of the prediction under the residuals' wrench (theory.md §6 (31), (31a)).

use super::groups::{Accumulate, FastRows, SecondDifference};
use super::{Problem, ShapedRow};
use crate::parameters::Wrench;
use crate::state::{Estimate, Linkage, RangeModel, RowChain};
use nalgebra::Vector3;
use poecal_arm::lie::Pose;
use poecal_model::measurement::NUMBERS;
use poecal_numerics::solve::{LeastSquares as _, NormalEquations};
use poecal_numerics::threads;

/// Rows of one partial sum. Fixed, so that the result does not depend on the number of threads.
const CHUNK: usize = 1024;
/// Partial sums held at a time, so that memory beside the data stays bounded.
const GROUP: usize = 64;

impl Problem<'_> {
    /// [`poecal_numerics::solve::LeastSquares::second_order`]: `Jᵀ e''` of theory.md §6 (31).
    pub(crate) fn second_order_of(&self, state: &Estimate, step: &[f64]) -> Vec<f64> {
        // Central second difference along the step: at 0.1 of the step, truncation and rounding are both far below the accuracy that a
        // correction of the step needs.
        const FRACTION: f64 = 0.1;
        let along = |sign: f64| {
            let part: Vec<f64> = step.iter().map(|s| sign * FRACTION * s).collect();
            Linkage::new(&self.retract(state, &part))
        };
        let second = SecondDifference { ahead: along(1.0), behind: along(-1.0), fraction: FRACTION };
        FastRows::with_second_difference(self, state, second).normal(self, state, Accumulate::Gradient).gradient
    }

    /// The residual's second derivative along a step in place of a row's residual.
    pub(crate) fn second_difference(&self, row: usize, second: &SecondDifference, shaped: &mut ShapedRow) {
        let observation = &self.session.data.observations[row];
        let mut chain = RowChain::default();
        let mut at = |linkage: &Linkage| {
            chain.evaluate(linkage, self.session.packed, row, observation);
            self.shape_row(row, &chain.target, linkage.range(observation.station)).residual
        };
        let (ahead, behind) = (at(&second.ahead), at(&second.behind));
        for (e, (a, b)) in shaped.residual.iter_mut().zip(ahead.into_iter().zip(behind)) {
            *e = (a + b - 2.0 * *e) / (second.fraction * second.fraction);
        }
    }

    /// [`poecal_numerics::solve::LeastSquares::curvature`]: the C of theory.md §6 (31a).
    pub(crate) fn curvature_of(&self, state: &Estimate) -> Option<Vec<f64>> {
        if !self.layout.has_curvature() || !state.ranges.iter().all(RangeModel::is_plain) {
            return None;
        }
        let linkage = Linkage::new(state);
        let total = self.sum_chunks(|rows| {
            let mut normal = NormalEquations::new(self.layout.dim());
            let mut chain = RowChain::default();
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
        let written = self.formulated_measurement(row);
        let (channels, noise) = (written.measurement.channels(), self.noise(row));
        let (mut e, mut sensitivity) = ([0.0; NUMBERS], [[0.0; 6]; NUMBERS]);
        written.residual(predicted, &mut e);
        written.sensitivity(predicted, &mut sensitivity);
        self.make_alike(row, channels, &mut e, &mut sensitivity);
        let mut wrench = Wrench { force: Vector3::zeros(), torque: Vector3::zeros() };
        for ((e, [a, b, c, p, q, r]), channel) in e.into_iter().zip(sensitivity).zip(channels) {
            let pull = e / (noise[channel.quantity] * noise[channel.quantity]);
            wrench.force += Vector3::new(a, b, c) * pull;
            wrench.torque += Vector3::new(p, q, r) * pull;
        }
        written.is_wrench().then_some(wrench)
    }

    /// Adds up `add` of each fixed chunk of rows, in the order of the rows whatever the number of threads.
    fn sum_chunks(&self, add: impl Fn(&[u32]) -> NormalEquations + Sync + Send) -> NormalEquations {
        if self.rows.len() <= CHUNK {
            return add(&self.rows);
        }
        let mut total = NormalEquations::new(self.layout.dim());
        for group in self.rows.chunks(CHUNK * GROUP) {
            let parts = threads::map_chunks(group, CHUNK, |_, rows| add(rows));
            parts.iter().for_each(|part| total.add(part));
        }
        total
    }
}
