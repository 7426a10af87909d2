//! Rows × columns: measurements and parameters meet here and nowhere else. Assembly only, no algorithms.

mod abreast;
mod alike;
mod arrangement;
mod fast;
mod layout;
mod prior;
mod refit;
mod scatter;

pub use crate::lanes::{Level, levels};
pub(crate) use abreast::Abreast;
pub use layout::Layout;
pub use prior::Prior;
pub use refit::Refit;

use crate::estimate::{Chain, Estimate, Linkage, Packed};
use crate::lie::TargetTwist;
use crate::measurement::{Dataset, Measurement, Noise, Written};
use crate::parameters::{Parameter, Wrench};
use crate::solve::{LeastSquares, Normal};
use crate::threads;
use fast::{Fast, Sums};
use nalgebra::Vector3;
use std::mem::discriminant;
use std::sync::OnceLock;

/// Unknowns that a fit has at most: its work grows with the cube of their number, its memory with the square. 1,000 take about half a
/// minute of one core.
pub const MOST_UNKNOWNS: usize = 1000;
/// Rows that one partial sum takes in. Fixed, so that the result does not depend on the number of threads.
const CHUNK: usize = 1024;
/// Partial sums that exist at a time: memory beside the data stays bounded.
const GROUP: usize = 64;
/// Rows of which the farthest measurement is looked for, at most.
const SEEN: usize = 500;
/// Rows whose Jacobian is held at a time.
const BLOCK: usize = 16;

/// A calibration problem: which rows of which data, what is free, and the noise by which residuals are whitened
/// (theory.md §6 (27) and (28)).
///
/// ```
/// # use nalgebra::Vector3;
/// # use poecal::{lie::{Pose, Screw}, robot::{Joint, Robot, JointKind}, measurement::*};
/// use poecal::{estimate::{Estimate, Packed}, parameters::*, problem::Problem, solve::{minimize, Options}};
/// # let joint = Joint::revolute("a", Screw::revolute(&Vector3::y(), &Vector3::x()));
/// # let robot = Robot::new("r", vec![joint], Pose::from_translation(Vector3::new(0.3, 0.2, 0.1)))?;
/// # let mut data = Dataset::new(robot.reading_names());
/// # for reading in [0.0, 1.0, 2.0] {
/// #     let position = robot.forward_kinematics(&[reading]).act(&Vector3::new(0.01, 0.0, 0.0));
/// #     data.push(&[reading], None, Measurement::Point(PointMeasurement { position }))?;
/// # }
/// let packed = Packed::new(&robot, data.all_readings(), 1);
/// let free = vec![Parameter::TargetPlace(TargetPlace { target: 0 })];
/// let noise = Noise { position_m: 1e-4, rotation_rad: 1e-4 };
/// let problem = Problem::new(&data, &packed, vec![0, 1, 2], free, noise, 1.0);
/// let start = Estimate::new(&robot, vec![robot.home], Pose::identity());
/// let (found, _, _) = minimize(&problem, start, &Options::default());
/// assert!((found.base_from_target[0].translation.x - 0.31).abs() < 1e-12);
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Problem<'a> {
    data: &'a Dataset,
    packed: &'a Packed,
    rows: Vec<u32>,
    layout: Layout,
    noise: Noise,
    weights: Option<&'a [f64]>,
    /// What the drawing is worth, and by how much it counts.
    prior: Option<(&'a Prior, f64)>,
    /// What is taken for measured instead of the data, one a row of the data.
    measured: Option<Vec<Measurement>>,
    rounding_m: f64,
    /// By which instructions the hot path runs.
    level: Level,
    /// The rows packed for the hot path; `None` inside where it does not serve.
    fast: OnceLock<Option<Fast>>,
}

impl<'a> Problem<'a> {
    /// A problem over some rows of the data. `noise` holds where a row states none; `length_m` makes radians comparable with metres.
    #[must_use]
    pub fn new(
        data: &'a Dataset,
        packed: &'a Packed,
        rows: Vec<u32>,
        free: Vec<Parameter>,
        noise: Noise,
        length_m: f64,
    ) -> Self {
        // A few roundings of the largest number in sight, or about that: the distance from the device.
        let position = |&row: &u32| data.observations[row as usize].measurement.residual_model().position();
        let some = rows.iter().step_by(rows.len().div_ceil(SEEN).max(1));
        let farthest = some.map(|row| position(row).amax());
        let rounding_m = 4.0 * f64::EPSILON * farthest.fold(1.0, f64::max);
        Problem {
            data,
            packed,
            rows,
            layout: Layout::new(free, length_m),
            noise,
            weights: None,
            prior: None,
            measured: None,
            rounding_m,
            level: Level::best(),
            fast: OnceLock::new(),
        }
    }

    /// The same problem, its sums computed by other instructions: for tests and comparisons. Those that the machine lacks are replaced
    /// by the baseline.
    #[must_use]
    pub fn with_level(mut self, level: Level) -> Self {
        self.level = level;
        self.fast = OnceLock::new();
        self
    }

    /// By which instructions the hot path runs.
    pub(crate) fn level(&self) -> Level {
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

    /// The same problem with a belief about the axes, if there is one, beside the measurements. It counts as many times as its weight
    /// says: as much as the variance of the whitened residuals really is (theory.md §6 (27a)).
    #[must_use]
    pub fn with_prior(mut self, prior: Option<(&'a Prior, f64)>) -> Self {
        self.prior = prior;
        self
    }

    /// Adds the belief to what measurements say.
    fn believing(&self, state: &Estimate, mut normal: Normal) -> Normal {
        if let Some((prior, weight)) = self.prior {
            prior.add(state, &self.layout, weight, &mut normal);
        }
        normal
    }

    /// The arrangement of the unknowns.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// The rows that the problem takes in.
    #[must_use]
    pub fn rows(&self) -> &[u32] {
        &self.rows
    }

    /// The noise that whitens a row.
    #[must_use]
    pub fn noise(&self, row: usize) -> Noise {
        let noise = self.data.observations[row].noise_or(self.noise);
        let Some(weight) = self.weights.and_then(|weights| weights.get(row)) else { return noise };
        let root = weight.sqrt();
        Noise { position_m: noise.position_m / root, rotation_rad: noise.rotation_rad / root }
    }

    /// What was measured in a row.
    fn measurement(&self, row: usize) -> &Measurement {
        let instead = self.measured.as_ref().and_then(|measured| measured.get(row));
        instead.unwrap_or(&self.data.observations[row].measurement)
    }

    /// What was measured in a row, and how its error is written.
    fn written(&self, row: usize) -> Written<'_> {
        Written::new(self.measurement(row), self.data.pose_residual)
    }

    /// Takes these measurements, one a row of the data, for measured in the same configurations.
    fn set_measurements(&mut self, measured: &[Measurement]) {
        let is_alike = self.rows.iter().all(|&row| {
            let before = discriminant(self.measurement(row as usize));
            measured.get(row as usize).is_none_or(|measured| discriminant(measured) == before)
        });
        let own = self.measured.get_or_insert_default();
        own.clear();
        own.extend_from_slice(measured);
        if let Some(Some(mut fast)) = self.fast.take()
            && is_alike
        {
            fast.pack(self);
            self.fast = OnceLock::from(Some(fast));
        }
    }

    /// Gives the whitened Jacobian of the prediction (row-major) and residual of each of some rows of the data, in turn.
    pub fn for_rows(&self, state: &Estimate, rows: &[u32], mut each: impl FnMut(u32, &[f64], &[f64])) {
        let n = self.layout.dim();
        let linkage = Linkage::new(state);
        let mut chain = Chain::default();
        let mut columns: Vec<TargetTwist> = vec![(Vector3::zeros(), Vector3::zeros()); n];
        let mut jacobian = vec![0.0; 6 * n];
        let mut residual = [0.0; 6];
        for &row in rows {
            let observation = &self.data.observations[row as usize];
            let written = self.written(row as usize);
            let measurement = written.model();
            let (noise, dim) = (self.noise(row as usize), measurement.dim());
            chain.evaluate(&linkage, self.packed, row as usize, observation);
            self.layout.target_twists(&chain, observation.target, &mut columns);
            measurement.project(&chain.target, &columns, &noise, n, &mut jacobian);
            measurement.residual(&chain.target, &noise, &mut residual);
            each(row, &jacobian[..dim * n], &residual[..dim]);
        }
    }

    /// Sums what `add` makes of each fixed chunk of rows, in the order of the rows whatever the number of threads.
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

    /// Gathers the rows' Jacobian and residuals in blocks, and hands each block over.
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
            let observation = &self.data.observations[row];
            let written = self.written(row);
            let measurement = written.model();
            chain.evaluate(linkage, self.packed, row, observation);
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

/// Rows of the Jacobian waiting to be accumulated.
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

impl Problem<'_> {
    /// Whether the kernels serve this problem in this state: points and poses with the residuals of their types; screws in the minimal
    /// basis, targets and device frames; no joint offsets. Whatever else there is takes the general path, row by row.
    #[doc(hidden)]
    #[must_use]
    pub fn is_served(&self, state: &Estimate) -> bool {
        self.data.pose_residual.is_none() && self.layout.is_minimal() && state.is_for_kernels()
    }

    /// The hot path, if it serves this problem in this state.
    fn fast(&self, state: &Estimate) -> Option<&Fast> {
        if !self.is_served(state) {
            return None;
        }
        let fast = match self.fast.get() {
            Some(fast) => fast,
            None => {
                // Made before the cell is touched: threads work together here, and one that waits for the others might come by again.
                let made = Fast::new(self, self.level);
                self.fast.get_or_init(|| made)
            }
        };
        fast.as_ref()
    }

    /// [`LeastSquares::normal`] by the general path, which serves every problem: row after row, as measurements and parameters write it.
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
        self.believing(state, seen)
    }
}

impl LeastSquares for Problem<'_> {
    type State = Estimate;

    fn dim(&self) -> usize {
        self.layout.dim()
    }

    fn normal(&self, state: &Estimate) -> Normal {
        match self.fast(state) {
            Some(fast) => self.believing(state, fast.normal(self, state, Sums::All)),
            None => self.normal_row_by_row(state),
        }
    }

    fn nearly_normal(&self, state: &Estimate) -> Normal {
        match self.fast(state) {
            Some(fast) => self.believing(state, fast.normal(self, state, Sums::Nearly)),
            None => self.normal_row_by_row(state),
        }
    }

    fn gradient(&self, state: &Estimate) -> Option<Normal> {
        self.fast(state).map(|fast| self.believing(state, fast.normal(self, state, Sums::Gradient)))
    }

    fn second_order(&self, state: &Estimate, step: &[f64]) -> Vec<f64> {
        // Central second difference along the step; 0.1 of the step keeps both truncation and rounding far below what a
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
                    let observation = &self.data.observations[row];
                    let written = self.written(row);
                    let measurement = written.model();
                    let noise = self.noise(row);
                    chain.evaluate(&ahead, self.packed, row, observation);
                    measurement.residual(&chain.target, &noise, &mut e_ahead);
                    chain.evaluate(&behind, self.packed, row, observation);
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

    fn curvature(&self, state: &Estimate) -> Option<Vec<f64>> {
        if !self.layout.has_curvature() {
            return None;
        }
        let linkage = Linkage::new(state);
        let total = self.sum_chunks(|rows| {
            let mut normal = Normal::new(self.layout.dim());
            let mut chain = Chain::default();
            for &row in rows {
                let row = row as usize;
                let observation = &self.data.observations[row];
                chain.evaluate(&linkage, self.packed, row, observation);
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

    fn project_constraints(&self, step: &mut [f64]) {
        self.layout.project_constraints(step);
    }

    fn rounding(&self) -> f64 {
        let noise = self.noise;
        (self.rounding_m / noise.position_m).max(self.rounding_m / noise.rotation_rad).powi(2)
    }

    fn retract(&self, state: &Estimate, step: &[f64]) -> Estimate {
        self.layout.retract(state, step)
    }
}
