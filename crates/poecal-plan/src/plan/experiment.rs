//! A planned session: its unknowns with their priors, and the rows of configurations as linear functions of these.

use nalgebra::{DMatrix, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::blocks::ConfigurationRows;
use super::options::PlannedFit;
use poecal_arm::lie::Pose;
use poecal_calibrate::{unknowns, whitened_rows};
use poecal_fit::analysis::{PlannedSession, predicted_data};
use poecal_fit::parameters::Parameter;
use poecal_fit::problem::{Layout, Prior, Problem, TermPrior};
use poecal_fit::state::{Estimate, Linkage, PackedValues, RowChain, Session, Unknowns, nominal_estimate, radian_m};
use poecal_model::measurement::{Dataset, Noise};
use poecal_model::robot::{CorrectionExtent, CorrectionModel, Corrections, Robot, Sizes, Tolerance};
use poecal_model::simulate::random_configuration;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::linalg;
use poecal_numerics::solve::{Options, minimize};

/// Configurations of the workspace.
pub(crate) const WORKSPACE: usize = 1000;
/// Number of random configurations that scale unknowns and combine terms, and their seed.
pub(crate) const SAMPLE: usize = 400;
const SEED: u64 = 1;
/// Most iterations of a fit while rows arrive.
const ITERATIONS: usize = 30;

/// A planned session at the nominal model: columns, priors, and the expected size of noise and joint terms.
pub(crate) struct PlannedExperiment {
    /// The nominal robot.
    pub(crate) robot: Robot,
    /// The same with the terms of the joints.
    pub(crate) model: Robot,
    pub(crate) session: PlannedSession,
    pub(crate) unknowns: Unknowns,
    pub(crate) estimate: Estimate,
    /// A row of each pair of an instrument and a target, if measurements have begun.
    pub(crate) template: Option<Dataset>,
    /// Terms with their prior standard deviations.
    pub(crate) deviations: Vec<TermPrior>,
    pub(crate) tolerance: Tolerance,
    /// Free parameters: of the sample, so that device frames turn about the same points for any rows.
    pub(crate) free: Vec<Parameter>,
    pub(crate) targets: usize,
    pub(crate) length_m: f64,
    /// Number of repetitions of a configuration so that each station measures it once.
    pub(crate) repeats: usize,
    /// Number of components measured in a configuration.
    pub(crate) numbers: usize,
    /// Indices of geometry's unknowns in a step.
    pub(crate) geometry: Vec<usize>,
    /// Indices of the terms.
    pub(crate) terms: Vec<usize>,
    /// Each term in units of its prior standard deviation, combined to modes.
    pub(crate) turn: DMatrix<f64>,
    /// Prior information of geometry.
    pub(crate) prior: DMatrix<f64>,
    /// Robot error beyond geometry, metres: of the stated error, the part by the terms and the rest.
    pub(crate) robot_error_m: f64,
    pub(crate) rest_m: f64,
    /// Stated remaining error of the corrected model, metres: the same if it is not stated.
    pub(crate) left_m: f64,
    /// Information of a row for a fit that treats all of the robot error as noise, as a share of that for one that knows the terms.
    pub(crate) share: f64,
    /// True if the robot error is a guess.
    pub(crate) is_guess: bool,
}

impl PlannedExperiment {
    /// Refuses kinds of measurement whose configurations cannot be chosen freely.
    pub(crate) fn new(robot: &Robot, fit: &PlannedFit) -> Result<Self> {
        PlannedExperiment::make(robot, fit, None)
    }

    /// An experiment of begun measurements, about an estimate that predicts them: its rows are like theirs.
    pub(crate) fn from_begun(robot: &Robot, fit: &PlannedFit, data: &Dataset, registered: &Estimate) -> Result<Self> {
        PlannedExperiment::make(robot, fit, Some((data, registered)))
    }

    fn make(robot: &Robot, fit: &PlannedFit, begun: Option<(&Dataset, &Estimate)>) -> Result<Self> {
        let kind = fit.session.kind;
        if !kind.is_chosen_freely() {
            return ErrorKind::Option.refuse(format!(
                "found the kind `{}`, expected one whose configurations can be chosen freely, as point, pose or distance: of what is touched, \
                 measure a dozen rows and ask poecal plan --rows",
                kind.word()
            ));
        }
        let robot = if begun.is_some() { robot.clone() } else { with_targets(robot, fit) };
        let sizes = match fit.corrections {
            Corrections::Off => Sizes::NONE,
            Corrections::Sizes(sizes) => sizes,
            Corrections::Auto | Corrections::All => Sizes::COMMON,
        };
        let extent = CorrectionExtent { gives: fit.corrections.gives(), ..CorrectionExtent::default() };
        let every = vec![true; robot.joints.len()];
        let corrected = CorrectionModel::new(&robot, fit.gravity, &every, extent).with_sizes(&sizes);
        let has_terms = sizes != Sizes::NONE && corrected.terms().next().is_some();
        let deviations: Vec<f64> = corrected.deviations(&sizes).collect();
        let unknowns = unknowns(&corrected, &Unknowns::USUAL, &sizes);
        // Without terms the robot has no compliant joints either.
        let (model, unknowns) =
            if has_terms { (corrected.robot.clone(), unknowns) } else { (robot.clone(), Unknowns::USUAL) };
        let mut generator = ChaCha8Rng::seed_from_u64(SEED);
        let sample: Vec<f64> = (0..SAMPLE).flat_map(|_| random_configuration(&robot, &mut generator)).collect();
        let width = robot.reading_names().len();
        let mut found = PlannedExperiment {
            length_m: radian_m(&robot, &PackedValues::new(&robot, &sample, width)),
            estimate: Estimate::new(&model, vec![model.home], Pose::identity()),
            template: begun.map(|(data, _)| data.select_rows(&one_of_each(data))),
            deviations: Vec::new(),
            tolerance: fit.tolerance.unwrap_or(Tolerance::WIDE),
            free: Vec::new(),
            targets: 1,
            robot,
            model,
            session: fit.session,
            unknowns,
            repeats: 1,
            numbers: 0,
            geometry: Vec::new(),
            terms: Vec::new(),
            turn: DMatrix::zeros(0, 0),
            prior: DMatrix::zeros(0, 0),
            robot_error_m: 0.0,
            rest_m: 0.0,
            left_m: 0.0,
            share: 1.0,
            is_guess: fit.robot_error.is_none(),
        };
        found.settle(&sample, fit, (&deviations, &corrected), begun)?;
        Ok(found)
    }

    /// Number of readings of a configuration.
    pub(crate) fn width(&self) -> usize {
        self.robot.reading_names().len().max(1)
    }

    /// Metres per radian.
    pub(crate) fn length_m(&self) -> f64 {
        self.length_m
    }

    /// Information of a row for the calibrated model, as a share of that for the corrected one.
    pub(crate) fn share(&self) -> f64 {
        self.share
    }

    /// Number of unknowns of geometry.
    pub(crate) fn geometry(&self) -> usize {
        self.geometry.len()
    }

    fn repeat_readings(&self, readings: &[f64]) -> Vec<f64> {
        readings.chunks_exact(self.width()).flat_map(|own| own.repeat(self.repeats)).collect()
    }

    /// Rows of configurations, and device frames other than the model's.
    pub(crate) fn data(&self, readings: &[f64]) -> Result<(Dataset, Vec<Pose>)> {
        let Some(template) = &self.template else {
            return predicted_data(&self.robot, &self.repeat_readings(readings), &self.session);
        };
        let mut data = template.select_rows(&[]);
        for own in readings.chunks_exact(self.width()) {
            for observation in &template.observations {
                data.push_observation(own, *observation)?;
            }
        }
        Ok((data, Vec::new()))
    }

    /// An estimate of the robot as one of the robot with compliant joints and terms of zero.
    pub(crate) fn with_gives(&self, registered: &Estimate, data: &Dataset) -> Estimate {
        let mut estimate = nominal_estimate(&self.model, data);
        estimate.base_from_target.clone_from(&registered.base_from_target);
        estimate.device_from_base = registered.device_from_base;
        estimate.further_devices.clone_from(&registered.further_devices);
        estimate
    }

    /// The fit of geometry and terms with their priors to rows, starting at the estimate, and its remaining cost.
    pub(crate) fn fit_terms(&self, data: &Dataset) -> (Estimate, f64) {
        let packed = PackedValues::from_dataset(&self.model, data);
        let session = self.session_of(data, &packed);
        let prior = Prior::from_session(&session, self.tolerance).with_terms(self.deviations.clone());
        let problem = Problem::new(session, data.all_rows(), self.free.clone(), self.session.noise)
            .with_prior(Some((&prior, 1.0)));
        let options = Options { iterations: ITERATIONS, ..Options::default() };
        let (estimate, normal, _) = minimize(&problem, self.estimate.clone(), &options);
        (estimate, normal.cost)
    }

    /// Whitened rows of measurements at the estimate, as [`PlannedExperiment::blocks`], and their residuals; each row a block of its own.
    pub(crate) fn rows(&self, data: &Dataset) -> (DMatrix<f64>, nalgebra::DVector<f64>) {
        let packed = PackedValues::from_dataset(&self.model, data);
        let rows = data.all_rows();
        let problem = Problem::new(self.session_of(data, &packed), rows.clone(), self.free.clone(), self.session.noise);
        let (_, jacobian, residuals) = whitened_rows(&problem, &self.estimate, &rows);
        let (g, c) = (self.geometry.len(), self.turn.ncols());
        let mut own = DMatrix::zeros(jacobian.nrows(), g + c);
        own.columns_mut(0, g).copy_from(&jacobian.select_columns(&self.geometry));
        own.columns_mut(g, c).copy_from(&(jacobian.select_columns(&self.terms) * &self.turn));
        (own, residuals)
    }

    /// Noise of each quantity, including errors that neither geometry nor terms describe.
    pub(crate) fn noise(&self) -> Noise {
        self.session.noise
    }

    /// Squares of the terms at the estimate in units of their prior variances, and the number of determined terms.
    pub(crate) fn size_of_terms(&self, covariance: &DMatrix<f64>, geometry: usize) -> (f64, f64) {
        let own = self.deviations.iter().filter(|it| it.deviation > 0.0);
        let size = own.map(|it| (self.estimate.coefficient(it.joint, it.term) / it.deviation).powi(2)).sum();
        let modes = covariance.nrows() - geometry;
        let open: f64 = (geometry..covariance.nrows()).map(|at| covariance[(at, at)]).sum();
        (size, (modes as f64 - open).max(0.0))
    }

    /// Columns among those of geometry that shift a target.
    pub(crate) fn shifts_of(&self, target: usize) -> Vec<usize> {
        let layout = Layout::new(self.free.clone(), self.length_m);
        let own = layout.parameters().filter_map(|(parameter, places)| {
            let (of, motions) = parameter.target_motions()?;
            let count = motions.iter().take_while(|motion| **motion < 3).count();
            (of == target).then(|| places[..count].iter().map(|it| it.0).collect::<Vec<_>>())
        });
        own.flatten().filter_map(|place| self.geometry.binary_search(&place).ok()).collect()
    }

    pub(crate) fn session_of<'a>(&'a self, data: &'a Dataset, packed: &'a PackedValues) -> Session<'a> {
        Session::new(&self.model, data, packed, self.session.device_free)
            .with_unknowns(&self.unknowns)
            .with_length(self.length_m)
    }

    /// The rows of configurations as linear functions of geometry and modes.
    pub(crate) fn blocks(&self, readings: &[f64]) -> Result<ConfigurationRows> {
        const CHUNK: usize = 512;
        let columns = self.geometry.len() + self.turn.ncols();
        let mut values = Vec::with_capacity(readings.len() / self.width() * self.numbers * columns);
        for some in readings.chunks(CHUNK * self.width()) {
            let (data, _) = self.data(some)?;
            let packed = PackedValues::from_dataset(&self.model, &data);
            let rows = data.all_rows();
            let session = self.session_of(&data, &packed);
            let problem = Problem::new(session, rows.clone(), self.free.clone(), self.session.noise);
            let (_, jacobian, _) = whitened_rows(&problem, &self.estimate, &rows);
            if !jacobian.iter().all(|value| value.is_finite()) {
                return ErrorKind::Measurement.refuse("found joint readings beyond what can be computed with, expected radians and metres: check their units");
            }
            let terms = jacobian.select_columns(&self.terms) * &self.turn;
            for row in 0..jacobian.nrows() {
                values.extend(self.geometry.iter().map(|&place| jacobian[(row, place)]));
                values.extend(terms.row(row).iter());
            }
        }
        Ok(ConfigurationRows { values, numbers: self.numbers, columns })
    }

    /// Second moments of the motion of the targets by the unknowns, mean over configurations, m² for steps of one.
    pub(crate) fn moments(&self, readings: &[f64]) -> DMatrix<f64> {
        let (own, _) = self.motions(readings);
        // A mean over configurations and targets of three numbers each.
        own.transpose() * &own * (3.0 / own.nrows().max(1) as f64)
    }

    /// The motion of the targets by the unknowns of geometry in each configuration.
    pub(crate) fn each_moment(&self, readings: &[f64]) -> Vec<DMatrix<f64>> {
        let (own, targets) = self.motions(readings);
        let each = 3 * targets;
        (0..own.nrows() / each).map(|at| own.view((at * each, 0), (each, self.geometry())).into_owned()).collect()
    }

    /// Three rows of each target in each configuration, and the number of targets.
    fn motions(&self, readings: &[f64]) -> (DMatrix<f64>, usize) {
        let columns = self.geometry.len() + self.turn.ncols();
        let layout = Layout::new(self.free.clone(), self.length_m);
        let packed = PackedValues::new(&self.model, readings, self.width());
        let linkage = Linkage::new(&self.estimate);
        let (mut chain, mut twists) = (RowChain::default(), vec![(Vector3::zeros(), Vector3::zeros()); layout.dim()]);
        let targets = self.targets;
        let mut found = DMatrix::zeros(3 * packed.rows() * targets, layout.dim());
        for row in 0..packed.rows() {
            for target in 0..targets {
                chain.evaluate(&linkage, &packed, row, target);
                layout.target_twists(&chain, target, &mut twists);
                for (column, (v, _)) in twists.iter().enumerate() {
                    for number in 0..3 {
                        found[(3 * (row * targets + target) + number, column)] = v[number];
                    }
                }
            }
        }
        let mut own = DMatrix::zeros(found.nrows(), columns);
        let g = self.geometry.len();
        own.columns_mut(0, g).copy_from(&found.select_columns(&self.geometry));
        own.columns_mut(g, columns - g).copy_from(&(found.select_columns(&self.terms) * &self.turn));
        (own, targets)
    }
}

/// The inverse of a symmetric positive definite matrix.
pub(crate) fn inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = matrix.nrows();
    let factor = linalg::cholesky(matrix.as_slice(), n, f64::MIN_POSITIVE)?;
    Some(DMatrix::from_row_slice(n, n, &linalg::inverse(&factor)))
}

/// The robot with the targets of a nest at the tip: at one offset, several turned about the tip's z.
fn with_targets(robot: &Robot, fit: &PlannedFit) -> Robot {
    let Some(offset) = fit.target_offset else { return robot.clone() };
    let mut robot = robot.clone();
    let body = robot.tip_body();
    let count = fit.targets.max(1);
    let mounts = (0..count).map(|at| {
        let turn = std::f64::consts::TAU * at as f64 / count as f64;
        let (s, c) = turn.sin_cos();
        let place = Vector3::new(c * offset.x - s * offset.y, s * offset.x + c * offset.y, offset.z);
        robot.mount(&format!("target{}", at + 1), body, &(robot.home * Pose::from_translation(place)))
    });
    robot.mounted = mounts.collect();
    robot
}

/// The first row of each pair of an instrument and a target.
fn one_of_each(data: &Dataset) -> Vec<u32> {
    let mut known: Vec<(usize, usize)> = Vec::new();
    let mut rows = Vec::new();
    for (row, observation) in (0..).zip(&data.observations) {
        let pair = (observation.station, observation.target);
        if !known.contains(&pair) {
            known.push(pair);
            rows.push(row);
        }
    }
    rows
}

pub(crate) fn undetermined_error() -> poecal_numerics::error::Error {
    ErrorKind::Problem.error(
        "found configurations whose information cannot be inverted, expected finite sizes of joints, noise and tolerances: check the units of the model",
    )
}
