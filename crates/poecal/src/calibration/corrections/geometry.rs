//! A fit of geometry as the beginning of a fit with terms, and its rows as linear functions.

use std::slice;

use super::choice::weight_of_prior;
use super::grid::CHOSEN;
use super::linear::Linear;
use super::modes::Class;
use super::unknowns::{estimate, unknowns};
use crate::calibration::fit::Task;
use crate::calibration::{CalibrationOptions, Loss, NoiseSource, Robust, RowJudgement};
use crate::estimate::{Estimate, Packed, Session, Unknowns};
use crate::measurement::{ByQuantity, Noise};
use crate::problem::Prior;
use crate::robot::{CorrectionModel, Extent, JointTerm, Robot, Sizes, TermGroup};
use crate::uncertainty::{PriorInformation, View, parts_to_leave_out};

/// Most rows from which sizes are chosen.
const SAMPLE: usize = 2000;

/// A fit of geometry alone, with which corrections begin.
#[derive(Clone, Copy)]
pub(in crate::calibration) struct Geometry<'a> {
    pub(in crate::calibration) session: Session<'a>,
    pub(in crate::calibration) options: &'a CalibrationOptions,
    /// The calibrated model.
    pub(in crate::calibration) estimate: &'a Estimate,
    pub(in crate::calibration) noise: Noise,
    pub(in crate::calibration) noise_source: NoiseSource,
    pub(in crate::calibration) loss: Option<Loss>,
    /// Judgement of each row.
    pub(in crate::calibration) judged: &'a [RowJudgement],
    pub(in crate::calibration) fit_rows: &'a [u32],
    pub(in crate::calibration) held_out_rows: &'a [u32],
}

impl Geometry<'_> {
    /// The suspected rows, in the order of the data.
    pub(in crate::calibration) fn suspects(&self) -> impl Iterator<Item = u32> {
        let rows = (0..).zip(self.judged).filter(|(_, row)| row.suspected);
        rows.map(|(row, _)| row)
    }

    /// Whether a row is suspected.
    pub(in crate::calibration) fn suspects_row(&self, row: u32) -> bool {
        self.judged.get(row as usize).is_some_and(|it| it.suspected)
    }

    /// The fitted rows that have a weight: others say nothing of the noise either.
    pub(super) fn weighted_rows(&self) -> Vec<u32> {
        let weights = self.weights();
        let weight = |row: u32| weights.as_ref().and_then(|it| it.get(row as usize));
        let counts = |row: &u32| weight(*row).is_none_or(|weight| *weight > 0.0);
        self.fit_rows.iter().copied().filter(counts).collect()
    }

    /// Weights of all rows of the data after a robust fit: those of a loss that was asked for; otherwise only suspected rows lose theirs.
    pub(super) fn weights(&self) -> Option<Vec<f64>> {
        let is_chosen = matches!(self.options.robust, Robust::Loss(_));
        let weight = |row: &RowJudgement| if row.suspected || is_chosen { row.weight } else { 1.0 };
        self.loss.map(|_| self.judged.iter().map(weight).collect())
    }
}

/// Geometry with what a fit of terms needs beside it.
pub(super) struct CorrectionContext<'a> {
    pub(super) geometry: Geometry<'a>,
    /// The nominal robot with all terms that geometry has.
    pub(super) nominal: Robot,
    /// The fitted rows that have a weight.
    pub(super) rows: Vec<u32>,
    /// Weights of all rows of the data.
    weights: Option<Vec<f64>>,
}

/// Rows of a sample as linear functions, and the parts of them that are left out in turn.
pub(super) struct Sampled {
    pub(super) linear: Linear,
    pub(super) parts: Vec<Vec<u32>>,
    pub(super) configurations: usize,
}

impl<'g> CorrectionContext<'g> {
    pub(super) fn new(geometry: Geometry<'g>) -> Self {
        let (rows, weights) = (geometry.weighted_rows(), geometry.weights());
        // Terms that geometry has are of no group.
        let mut nominal = geometry.session.robot.clone();
        for &(joint, term) in &geometry.session.unknowns.terms {
            if !nominal.terms.iter().any(|it| (it.joint, it.term) == (joint, term)) {
                nominal.terms.push(JointTerm { joint, term, coefficient: 0.0 });
            }
        }
        CorrectionContext { geometry, nominal, rows, weights }
    }

    /// Weight of a row.
    pub(super) fn weight(&self, row: u32) -> f64 {
        self.weights.as_ref().and_then(|it| it.get(row as usize)).copied().unwrap_or(1.0)
    }

    /// How far the model reaches; for terms of these sizes as far as they do.
    pub(super) fn extent(&self, sizes: Option<Sizes>) -> Extent {
        let options = self.geometry.options;
        let gives = sizes.map_or(options.corrections.gives(), |sizes| sizes.gives());
        Extent { orders: options.harmonics, gives }
    }

    pub(super) fn session<'a>(
        &'a self,
        model: &'a CorrectionModel,
        packed: &'a Packed,
        unknowns: &'a Unknowns,
    ) -> Session<'a> {
        Session { robot: &model.robot, packed, unknowns, ..self.geometry.session }
    }

    pub(super) fn task<'a>(&'a self, session: Session<'a>, prior: (&'a Prior, f64)) -> Task<'a> {
        let CorrectionContext { rows, weights, geometry, .. } = self;
        Task { session, rows, weights: weights.as_deref(), prior: Some(prior), options: geometry.options }
    }

    /// A sample of the rows, linear about the calibrated model; none if that determines nothing.
    pub(super) fn sampled(&self, model: &CorrectionModel, sizes: Option<Sizes>) -> Option<Sampled> {
        let Geometry { session: of_geometry, options, noise, estimate: calibrated, .. } = self.geometry;
        let none = PriorInformation::none(0);
        let view = View {
            session: of_geometry,
            rows: &self.rows,
            free: &[],
            noise,
            noise_is_stated: ByQuantity::default(),
            prior: &none,
            variance: 1.0,
            estimate: calibrated,
        };
        let (sample, parts) = parts_to_leave_out(&view, SAMPLE, options.seed);
        // The rows of the sample alone, so that terms are evaluated at no others.
        let data = of_geometry.data.only(&sample);
        let rows = data.all_rows();
        let among = |row: &u32| sample.binary_search(row).ok().and_then(|at| u32::try_from(at).ok());
        let parts: Vec<Vec<u32>> = parts.iter().map(|part| part.iter().filter_map(among).collect()).collect();
        let weights: Option<Vec<f64>> =
            self.weights.as_ref().map(|_| sample.iter().map(|&row| self.weight(row)).collect());
        let start = estimate(model, calibrated, &data);
        let packed = Packed::of(&model.robot, &data);
        let unknowns = unknowns(model, of_geometry.unknowns, &sizes.unwrap_or(Sizes::ALL));
        let session =
            Session { data: &data, robot: &model.robot, packed: &packed, unknowns: &unknowns, ..of_geometry };
        let prior = options.prior_with_terms(&session);
        let prior = Some((&prior, 1.0));
        let task = Task { session, rows: &rows, weights: weights.as_deref(), prior, options };
        let configurations = data.configurations(&rows).len();
        let weight = weight_of_prior(configurations);
        let classes: Vec<Class> = match sizes {
            None => {
                CHOSEN.map(|(groups, sizes)| (groups, sizes.iter().copied().fold(0.0, f64::max))).to_vec()
            }
            Some(sizes) => {
                TermGroup::ALL.iter().map(|group| (slice::from_ref(group), sizes[*group])).collect()
            }
        };
        let linear = Linear::new(&task, model, (&start, noise), (&rows, weight), &classes)?;
        Some(Sampled { linear, parts, configurations })
    }
}
