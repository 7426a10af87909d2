//! A finished calibration as the beginning of a fit with terms, and its rows as linear functions.

use std::slice;

use super::choice::chosen;
use super::choice::weight_of_prior;
use super::linear::Linear;
use super::modes::Class;
use super::unknowns::{estimate, unknowns};
use crate::calibration::fit::Task;
use crate::calibration::{Calibration, CalibrationOptions};
use crate::estimate::{Packed, Session, Unknowns};
use crate::measurement::ByQuantity;
use crate::problem::Prior;
use crate::robot::{CorrectionModel, Extent, Robot, Sizes, TermGroup};
use crate::uncertainty::{PriorInformation, View, parts_to_leave_out};

/// Most rows from which sizes are chosen.
const SAMPLE: usize = 2000;

/// A finished calibration, from which corrections are fitted.
pub(super) struct Geometry<'a> {
    pub(super) calibration: &'a Calibration,
    pub(super) nominal: Robot,
    pub(super) session: Session<'a>,
    pub(super) options: &'a CalibrationOptions,
    /// The fitted rows that have a weight.
    pub(super) rows: Vec<u32>,
    /// Weights of all rows of the data.
    pub(super) weights: Option<&'a [f64]>,
}

/// Rows of a sample as linear functions, and the parts of them that are left out in turn.
pub(super) struct Sampled {
    pub(super) linear: Linear,
    pub(super) parts: Vec<Vec<u32>>,
    pub(super) configurations: usize,
}

impl Geometry<'_> {
    /// How far the model reaches; for terms of these sizes as far as they do.
    pub(super) fn extent(&self, sizes: Option<Sizes>) -> Extent {
        let gives = sizes.map_or(self.options.corrections.gives(), |sizes| sizes.gives());
        Extent { orders: self.options.harmonics, gives }
    }

    pub(super) fn session<'a>(
        &'a self,
        model: &'a CorrectionModel,
        packed: &'a Packed,
        unknowns: &'a Unknowns,
    ) -> Session<'a> {
        Session { robot: &model.robot, packed, unknowns, ..self.session }
    }

    pub(super) fn task<'a>(&'a self, session: Session<'a>, prior: (&'a Prior, f64)) -> Task<'a> {
        let Geometry { rows, options, weights, .. } = self;
        Task { session, rows, weights: *weights, prior: Some(prior), options }
    }

    pub(super) fn prior(&self, session: &Session<'_>) -> Prior {
        self.options.prior_with_terms(session)
    }

    /// A sample of the rows, linear about the calibrated model; none if that determines nothing.
    pub(super) fn sampled(&self, model: &CorrectionModel, sizes: Option<Sizes>) -> Option<Sampled> {
        let Geometry { calibration, options, .. } = *self;
        let noise = calibration.noise;
        let none = PriorInformation::none(0);
        let view = View {
            session: self.session,
            rows: &self.rows,
            free: &[],
            noise,
            noise_is_stated: ByQuantity::default(),
            prior: &none,
            variance: 1.0,
            estimate: &calibration.models.calibrated,
        };
        let (sample, parts) = parts_to_leave_out(&view, SAMPLE, options.seed);
        // The rows of the sample alone, so that terms are evaluated at no others.
        let data = self.session.data.only(&sample);
        let rows = data.all_rows();
        let among = |row: &u32| sample.binary_search(row).ok().and_then(|at| u32::try_from(at).ok());
        let parts: Vec<Vec<u32>> = parts.iter().map(|part| part.iter().filter_map(among).collect()).collect();
        let weights: Option<Vec<f64>> = self.weights.map(|weights| {
            sample.iter().map(|&row| weights.get(row as usize).copied().unwrap_or(1.0)).collect()
        });
        let start = estimate(model, &calibration.models.calibrated, &data);
        let packed = Packed::of(&model.robot, &data);
        let unknowns = unknowns(model, self.session.unknowns, &sizes.unwrap_or(Sizes::ALL));
        let session = Session {
            data: &data,
            robot: &model.robot,
            packed: &packed,
            unknowns: &unknowns,
            ..self.session
        };
        let prior = self.prior(&session);
        let prior = Some((&prior, 1.0));
        let task = Task { session, rows: &rows, weights: weights.as_deref(), prior, options };
        let configurations = data.configurations(&rows).len();
        let weight = weight_of_prior(configurations);
        let classes: Vec<Class> = match sizes {
            None => {
                chosen().map(|(groups, sizes)| (groups, sizes.iter().copied().fold(0.0, f64::max))).collect()
            }
            Some(sizes) => {
                TermGroup::ALL.iter().map(|group| (slice::from_ref(group), sizes[*group])).collect()
            }
        };
        let linear = Linear::new(&task, model, (&start, noise), (&rows, weight), &classes)?;
        Some(Sampled { linear, parts, configurations })
    }
}
