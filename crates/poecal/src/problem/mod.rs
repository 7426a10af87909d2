//! Rows × columns: measurements and parameters meet here and nowhere else. Assembly only, no algorithms.

mod column_map;
mod fast;
mod layout;
mod prior;
mod refit;
mod row_block;
mod row_by_row;
mod row_group;
mod scatter;

pub use crate::lanes::{Level, levels};
pub use layout::Layout;
pub use prior::Prior;
pub use refit::Refit;
pub(crate) use row_block::RowBlock;

use crate::estimate::{Estimate, Packed};
use crate::measurement::{Dataset, Measurement, Noise, Written};
use crate::parameters::Parameter;
use crate::solve::{LeastSquares, Normal};
use fast::{Accumulate, Fast};
use std::mem::discriminant;
use std::sync::OnceLock;

/// Unknowns that a fit has at most: its work grows with the cube of their number, its memory with the square. 1,000 take about half a
/// minute of one core.
pub const MOST_UNKNOWNS: usize = 1000;
/// Rows of which the farthest measurement is looked for, at most.
const SEEN: usize = 500;

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
}

impl Problem<'_> {
    /// Whether the kernels serve this problem in this state: points and poses with the residuals of their types; screws in the minimal
    /// basis, targets and device frames; no joint offsets. Whatever else there is takes the row-by-row path.
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
                // Built outside `get_or_init`: a rayon thread that waits may re-enter this function.
                let made = Fast::new(self, self.level);
                self.fast.get_or_init(|| made)
            }
        };
        fast.as_ref()
    }
}

impl LeastSquares for Problem<'_> {
    type State = Estimate;

    fn dim(&self) -> usize {
        self.layout.dim()
    }

    fn normal(&self, state: &Estimate) -> Normal {
        match self.fast(state) {
            Some(fast) => self.believing(state, fast.normal(self, state, Accumulate::All)),
            None => self.normal_row_by_row(state),
        }
    }

    fn nearly_normal(&self, state: &Estimate) -> Normal {
        match self.fast(state) {
            Some(fast) => self.believing(state, fast.normal(self, state, Accumulate::GaussNewton)),
            None => self.normal_row_by_row(state),
        }
    }

    fn gradient(&self, state: &Estimate) -> Option<Normal> {
        self.fast(state).map(|fast| self.believing(state, fast.normal(self, state, Accumulate::Gradient)))
    }

    fn second_order(&self, state: &Estimate, step: &[f64]) -> Vec<f64> {
        self.second_order_by_rows(state, step)
    }

    fn curvature(&self, state: &Estimate) -> Option<Vec<f64>> {
        self.curvature_by_rows(state)
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
