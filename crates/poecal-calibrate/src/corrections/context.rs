//! A fit of geometry as the beginning of a fit with terms, and its rows as linear functions.

use std::slice;

use super::choice::{tried_sizes, weight_of_prior};
use super::linear::LinearRows;
use super::modes::Class;
use super::unknowns::{estimate, unknowns};
use crate::run::task::FitTask;
use crate::steps::calibrated_fit::CalibratedFit;
use poecal_fit::problem::Prior;
use poecal_fit::state::{PackedValues, Session, Unknowns};
use poecal_fit::uncertainty::{FitView, PriorInformation, parts_to_leave_out};
use poecal_model::measurement::ByQuantity;
use poecal_model::robot::{CorrectionExtent, CorrectionModel, JointTerm, Robot, Sizes, TermGroup};

/// Most measured numbers from which sizes are chosen.
const NUMBERS: usize = 6000;

/// Geometry with the inputs of a fit of terms.
pub(crate) struct CorrectionContext<'a> {
    pub(crate) geometry: &'a CalibratedFit<'a>,
    pub(crate) session: Session<'a>,
    /// The nominal robot with all terms that geometry has.
    pub(crate) nominal: Robot,
    /// The fitted rows that have a weight.
    pub(crate) rows: Vec<u32>,
    /// Weights of all rows of the data.
    weights: Option<Vec<f64>>,
}

/// Rows of a sample as linear functions, and the parts of them that are left out in turn.
pub(crate) struct RowSample {
    pub(crate) linear: LinearRows,
    pub(crate) parts: Vec<Vec<u32>>,
    pub(crate) configurations: usize,
}

impl<'g> CorrectionContext<'g> {
    pub(crate) fn new(geometry: &'g CalibratedFit<'g>) -> Self {
        let (session, rows, weights) = (geometry.session(), geometry.weighted_rows(), geometry.weights());
        // Terms of geometry itself belong to no group.
        let mut nominal = session.robot.clone();
        for &(joint, term) in &session.unknowns.terms {
            if !nominal.terms.iter().any(|it| (it.joint, it.term) == (joint, term)) {
                nominal.terms.push(JointTerm { joint, term, coefficient: 0.0 });
            }
        }
        CorrectionContext { geometry, session, nominal, rows, weights }
    }

    /// Weight of a row.
    pub(crate) fn weight(&self, row: u32) -> f64 {
        self.weights.as_ref().and_then(|it| it.get(row as usize)).copied().unwrap_or(1.0)
    }

    /// Extent of the model; with sizes, the extent of terms of these sizes.
    pub(crate) fn extent(&self, sizes: Option<Sizes>) -> CorrectionExtent {
        let options = &self.geometry.run.options;
        let gives = sizes.map_or(options.corrections.gives(), |sizes| sizes.gives());
        CorrectionExtent { orders: options.harmonics, gives }
    }

    pub(crate) fn session<'a>(
        &'a self,
        model: &'a CorrectionModel,
        packed: &'a PackedValues,
        unknowns: &'a Unknowns,
    ) -> Session<'a> {
        Session { robot: &model.robot, packed, unknowns, ..self.session }
    }

    pub(crate) fn task<'a>(&'a self, session: Session<'a>, prior: (&'a Prior, f64)) -> FitTask<'a> {
        let (CorrectionContext { rows, weights, .. }, options) = (self, &self.geometry.run.options);
        FitTask { session, rows, weights: weights.as_deref(), prior: Some(prior), options }
    }

    /// A sample of the rows, linear about the calibrated model; `None` if it determines nothing.
    pub(crate) fn sample_rows(&self, model: &CorrectionModel, sizes: Option<Sizes>) -> Option<RowSample> {
        let (of_geometry, noise) = (self.session, self.geometry.noise());
        let (calibrated, options) = (&self.geometry.estimate, &self.geometry.run.options);
        let none = PriorInformation::zero(0);
        let view = FitView {
            session: of_geometry,
            rows: &self.rows,
            free: &[],
            noise,
            noise_is_stated: ByQuantity::default(),
            prior: &none,
            variance: 1.0,
            estimate: calibrated,
        };
        let numbers = |row: &u32| of_geometry.observation(*row).measurement.dim();
        let all: usize = self.rows.iter().map(numbers).sum();
        let most = self.rows.len() * NUMBERS / all.max(NUMBERS);
        let (sample, parts) = parts_to_leave_out(&view, most, options.seed);
        // Only the rows of the sample, so that terms are evaluated at no others.
        let data = of_geometry.data.select_rows(&sample);
        let rows = data.all_rows();
        let among = |row: &u32| sample.binary_search(row).ok().and_then(|at| u32::try_from(at).ok());
        let parts: Vec<Vec<u32>> = parts.iter().map(|part| part.iter().filter_map(among).collect()).collect();
        let weights: Option<Vec<f64>> =
            self.weights.as_ref().map(|_| sample.iter().map(|&row| self.weight(row)).collect());
        let start = estimate(model, calibrated, &data);
        let packed = PackedValues::from_dataset(&model.robot, &data);
        let unknowns = unknowns(model, of_geometry.unknowns, &sizes.unwrap_or(Sizes::ALL));
        let session = Session { data: &data, robot: &model.robot, packed: &packed, unknowns: &unknowns, ..of_geometry };
        let prior = options.prior_with_terms(&session);
        let prior = Some((&prior, 1.0));
        let task = FitTask { session, rows: &rows, weights: weights.as_deref(), prior, options };
        let configurations = data.configurations(&rows).len();
        let weight = weight_of_prior(configurations);
        let classes: Vec<Class> = match sizes {
            None => tried_sizes().map(|(groups, sizes)| (groups, sizes.iter().copied().fold(0.0, f64::max))).collect(),
            Some(sizes) => TermGroup::ALL.iter().map(|group| (slice::from_ref(group), sizes[*group])).collect(),
        };
        let linear = LinearRows::new(&task, model, (&start, noise), (&rows, weight), &classes)?;
        Some(RowSample { linear, parts, configurations })
    }
}
