//! Rows × columns: the only module where measurements and parameters meet. It assembles the normal equations, and has no algorithms.
//!
//! `row_group.rs` has rows of one instrument, target and form, `column_map.rs` the unknowns in the order of the kernels; both are made once a
//! problem. `fast.rs` sums all rows, eight side by side, and rows that are neither points nor poses by `Problem::shaped` within the kernel.
//! `prior.rs` is the prior about nominal, `layout.rs` moves the state by a step, `curvature.rs` has second derivatives. `null_directions.rs` has the
//! motions without effect if blocks are held, `bundle.rs` all corners of pictures at once. The Jacobian is never stored: memory is the data and a few
//! matrices of unknowns × unknowns.

mod bundle;
mod bundle_desk;
mod bundle_solve;
mod column_map;
mod curvature;
mod deviations;
mod fast;
mod form;
mod groups;
mod kernel_columns;
mod layout;
mod lengths;
mod null_directions;
mod prior;
mod refit;
mod row_block;
mod row_group;
mod scatter;

pub use bundle::Bundle;
pub use bundle_solve::BundleOptimum;
pub use layout::Layout;
pub use poecal_numerics::kernels::{SimdLevel, simd_levels, stated_level};
pub use prior::{Prior, TermPrior};
pub use refit::Refit;
pub(crate) use row_block::RowBlock;

use crate::parameters::Parameter;
use crate::state::{Estimate, RangeModel, RangeTerm, Session};
use groups::{Accumulate, FastRows};
use poecal_arm::lie::Pose;
use poecal_model::measurement::{Channels, FormulatedMeasurement, Measurement, NUMBERS, Noise, Sensitivity};
use poecal_numerics::kernels::ShapedRow;
use poecal_numerics::solve::{LeastSquares, NormalEquations};
use std::sync::OnceLock;

/// Largest number of unknowns of a fit: its time grows with the cube of their number, its memory with the square. 1,000 take about
/// half a minute of one core.
pub const MOST_UNKNOWNS: usize = 1000;
/// Largest number of rows among which the farthest measurement is sought.
const SEEN: usize = 500;

/// A calibration problem: rows of the data, free parameters, and the noise that whitens residuals (theory.md §6 (27) and (28)).
#[derive(Clone, Debug)]
pub struct Problem<'a> {
    session: Session<'a>,
    rows: Vec<u32>,
    layout: Layout,
    noise: Noise,
    weights: Option<&'a [f64]>,
    /// Prior of the axes, and its weight.
    prior: Option<(&'a Prior, f64)>,
    /// Measurements that replace the data's, one for each row of the data.
    measured: Option<Vec<Measurement>>,
    rounding_m: f64,
    /// Instruction set of the hot path.
    level: SimdLevel,
    /// Groups of rows, once they are built.
    fast: OnceLock<FastRows>,
}

impl<'a> Problem<'a> {
    /// A problem over some rows of a session. `noise` holds where a row states none.
    #[must_use]
    pub fn new(session: Session<'a>, rows: Vec<u32>, free: Vec<Parameter>, noise: Noise) -> Self {
        // A few roundings of about the largest number, the distance from the device.
        let farthest = |&row: &u32| session.observation(row).measurement.position().map_or(0.0, |it| it.amax());
        let some = rows.iter().step_by(rows.len().div_ceil(SEEN).max(1));
        let farthest = some.map(farthest);
        let rounding_m = 4.0 * f64::EPSILON * farthest.fold(1.0, f64::max);
        Problem {
            session,
            rows,
            layout: Layout::new(free, session.length_m),
            noise,
            weights: None,
            prior: None,
            measured: None,
            rounding_m,
            level: SimdLevel::best_level(),
            fast: OnceLock::new(),
        }
    }

    /// The same problem with another instruction set, for tests and comparisons. The baseline replaces one that the machine lacks.
    #[must_use]
    pub fn with_level(mut self, level: SimdLevel) -> Self {
        self.level = level;
        self.fast = OnceLock::new();
        self
    }

    /// Instruction set of the hot path.
    pub(crate) fn level(&self) -> SimdLevel {
        self.level
    }

    /// The same problem with a weight for every row of the data: its noise is divided by the weight's square root, and a weight of
    /// zero leaves it out (theory.md §6 (34b)).
    #[must_use]
    pub fn with_weights(mut self, weights: &'a [f64]) -> Self {
        self.rows.retain(|&row| weights.get(row as usize).is_none_or(|&weight| weight > 0.0));
        self.weights = Some(weights);
        self.fast = OnceLock::new();
        self
    }

    /// Weight of a row.
    #[must_use]
    pub fn weight(&self, row: u32) -> f64 {
        self.weights.and_then(|weights| weights.get(row as usize)).copied().unwrap_or(1.0)
    }

    /// The same problem with a prior of the axes, if there is one, and its weight: the variance of the whitened residuals
    /// (theory.md §6 (27a)).
    #[must_use]
    pub fn with_prior(mut self, prior: Option<(&'a Prior, f64)>) -> Self {
        self.prior = prior;
        self
    }

    /// Adds known lengths and the prior to the normal information of the measurements.
    fn with_all(&self, state: &Estimate, normal: NormalEquations) -> NormalEquations {
        let mut normal = self.add_lengths(state, normal);
        if let Some((prior, weight)) = self.prior {
            prior.add(state, &self.layout, weight, &mut normal);
        }
        normal
    }

    /// Robot and measurements.
    #[must_use]
    pub fn session(&self) -> &Session<'a> {
        &self.session
    }

    /// Order and scale of the unknowns.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Rows of the problem.
    #[must_use]
    pub fn rows(&self) -> &[u32] {
        &self.rows
    }

    /// Noise that whitens a row: the W of theory.md §4 (17), divided by the root of the row's weight (theory.md §6 (34b)).
    #[must_use]
    pub fn noise(&self, row: usize) -> Noise {
        let noise = self.session.noise_of(&self.session.data.observations[row], self.noise);
        let Some(weight) = self.weights.and_then(|weights| weights.get(row)) else { return noise };
        let root = weight.sqrt();
        noise.map(|sigma| sigma / root)
    }

    /// Makes the noise of a row's position the same in all directions (theory.md §4 (17a)).
    fn make_alike(
        &self,
        row: usize,
        channels: &Channels,
        residual: &mut [f64; NUMBERS],
        sensitivity: &mut [Sensitivity; NUMBERS],
    ) {
        let Some(shape) = self.session.data.noise_shape(&self.session.data.observations[row]) else { return };
        shape.whiten(channels, residual.as_chunks_mut::<1>().0);
        shape.whiten(channels, sensitivity);
    }

    /// Measurement of a row.
    fn measurement(&self, row: usize) -> &Measurement {
        let instead = self.measured.as_ref().and_then(|measured| measured.get(row));
        instead.unwrap_or(&self.session.data.observations[row].measurement)
    }

    /// Measurement of a row, with the formulation of its residual.
    fn formulated_measurement(&self, row: usize) -> FormulatedMeasurement<'_> {
        FormulatedMeasurement::new(self.measurement(row), self.session.data.pose_residual)
    }

    /// Replaces the measurements, one for each row of the data; the configurations stay.
    fn set_measurements(&mut self, measured: &[Measurement]) {
        let is_alike = self.rows.iter().all(|&row| {
            let before = self.measurement(row as usize).function();
            measured.get(row as usize).is_none_or(|measured| measured.function() == before)
        });
        let own = self.measured.get_or_insert_default();
        own.clear();
        own.extend_from_slice(measured);
        if let Some(mut fast) = self.fast.take()
            && is_alike
        {
            fast.pack(self);
            self.fast = OnceLock::from(fast);
        }
    }
}

impl Problem<'_> {
    /// Whitened residual and sensitivity of a row for its predicted target, theory.md §4 (17).
    pub(crate) fn shape_row(&self, row: usize, predicted: &Pose, range: Option<&RangeModel>) -> ShapedRow {
        let written = self.formulated_measurement(row);
        let (channels, noise) = (written.measurement.channels(), self.noise(row));
        let mut shaped = ShapedRow::NONE;
        let read = range.map_or(*predicted, |range| range.locate_target(predicted));
        written.residual(&read, &mut shaped.residual);
        written.sensitivity(&read, &mut shaped.sensitivity);
        if let Some(range) = range {
            range.pull_back(predicted, &mut shaped.sensitivity);
        }
        let ShapedRow { residual, sensitivity } = &mut shaped;
        self.make_alike(row, channels, residual, sensitivity);
        for ((e, numbers), channel) in residual.iter_mut().zip(sensitivity).zip(channels) {
            let sigma = noise[channel.quantity];
            *e /= sigma;
            numbers.iter_mut().for_each(|number| *number /= sigma);
        }
        shaped
    }

    /// Whitened columns of terms of a row's range, for its predicted target: `S (p/|p|)` and `S p` (theory.md §5 (25b)), over the scale of each.
    pub(crate) fn range_columns(
        &self,
        row: usize,
        predicted: &Pose,
        range: Option<&RangeModel>,
        terms: &[(RangeTerm, f64)],
        out: &mut [[f64; NUMBERS]],
    ) {
        let written = self.formulated_measurement(row);
        let (channels, noise) = (written.measurement.channels(), self.noise(row));
        let mut sensitivity = [[0.0; 6]; NUMBERS];
        written.sensitivity(&range.map_or(*predicted, |range| range.locate_target(predicted)), &mut sensitivity);
        for (&(term, scale), out) in terms.iter().zip(out) {
            let moved = RangeModel::motion(predicted, term) / scale;
            for ((out, [x, y, z, ..]), channel) in out.iter_mut().zip(&sensitivity).zip(channels) {
                *out = (x * moved.x + y * moved.y + z * moved.z) / noise[channel.quantity];
            }
        }
    }

    /// Groups of rows, in the form of the kernels.
    fn fast(&self, state: &Estimate) -> &FastRows {
        match self.fast.get() {
            Some(fast) => fast,
            None => {
                // The value is built outside `get_or_init`: a rayon thread that waits may re-enter this function.
                let made = FastRows::new(self, state, self.level);
                self.fast.get_or_init(|| made)
            }
        }
    }
}

impl LeastSquares for Problem<'_> {
    type State = Estimate;

    fn dim(&self) -> usize {
        self.layout.dim()
    }

    fn normal(&self, state: &Estimate) -> NormalEquations {
        self.with_all(state, self.fast(state).normal(self, state, Accumulate::All))
    }

    fn nearly_normal(&self, state: &Estimate) -> NormalEquations {
        self.with_all(state, self.fast(state).normal(self, state, Accumulate::GaussNewton))
    }

    fn gradient(&self, state: &Estimate) -> Option<NormalEquations> {
        Some(self.with_all(state, self.fast(state).normal(self, state, Accumulate::Gradient)))
    }

    fn second_order(&self, state: &Estimate, step: &[f64]) -> Vec<f64> {
        self.second_order_of(state, step)
    }

    fn curvature(&self, state: &Estimate) -> Option<Vec<f64>> {
        self.curvature_of(state)
    }

    fn project_constraints(&self, step: &mut [f64]) {
        self.layout.project_constraints(step);
    }

    fn rounding(&self) -> f64 {
        let noise = self.noise;
        let relative = noise.iter().map(|(_, sigma)| self.rounding_m / sigma);
        relative.fold(0.0, f64::max).powi(2)
    }

    fn retract(&self, state: &Estimate, step: &[f64]) -> Estimate {
        self.layout.retract(state, step)
    }
}
