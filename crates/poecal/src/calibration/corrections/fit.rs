//! The fit of screws and terms together.

use nalgebra::Vector3;

use super::choice::{Choice, HALF, choose};
use super::model::moving;
use super::{CorrectionModel, Sizes, TriedSizes};
use crate::calibration::fit::Task;
use crate::calibration::found::OngoingFit;
use crate::calibration::noise::{NoiseSource, stated};
use crate::calibration::{Calibration, CalibrationOptions, estimate_noise};
use crate::estimate::{Estimate, Packed, RowError, Session, Unknowns};
use crate::measurement::{ByQuantity, Dataset, Noise};
use crate::problem::Prior;
use crate::robot::{Robot, Tolerance};
use crate::uncertainty::{PriorInformation, View, parts_to_leave_out};

/// Most rounds of re-estimating the noise.
const ROUNDS: usize = 4;
/// Most rows from which sizes are chosen.
const SAMPLE: usize = 2000;
/// Change of the noise below which it stays, as a share.
const SETTLED: f64 = 0.02;

/// A fit of screws and terms: the robot that it found, with all that predicts rows.
///
/// ```
/// use nalgebra::Vector3;
/// use poecal::calibration::{CalibrationOptions, Sizes, calibrate, correct};
/// use poecal::simulate::{Kind, Simulation, elbow};
/// let made = Simulation::default().run(&elbow(), Kind::Pose)?;
/// let options = CalibrationOptions::default();
/// let calibration = calibrate(&made.nominal, &made.data, &options)?;
/// let found = correct(&calibration, &made.data, -Vector3::z(), Some(Sizes::COMMON), &options);
/// assert_eq!(found.errors(&made.data, &calibration.held_out_rows).len(), calibration.held_out_rows.len());
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Correction {
    /// The robot with its gives and terms, as in the model.
    pub model: CorrectionModel,
    /// Prior sizes of the groups of terms.
    pub sizes: Sizes,
    /// Sizes that cross-validation tried, if it chose.
    pub tried: Vec<TriedSizes>,
    /// What was fitted.
    pub unknowns: Unknowns,
    /// What was found.
    pub estimate: Estimate,
    /// Noise of the fit.
    pub noise: Noise,
    packed: Packed,
}

impl Correction {
    /// The robot that was found: with its gives and its terms, at the model's tip. It predicts as the fit does.
    #[must_use]
    pub fn robot(&self) -> Robot {
        let found = self.model.robot.with_screws(&self.estimate.screws());
        Robot { terms: self.estimate.terms.clone(), ..found }
    }

    /// Errors of rows of the data that were fitted ([`Session::errors`]).
    #[must_use]
    pub fn errors(&self, data: &Dataset, rows: &[u32]) -> Vec<RowError> {
        Session::new(&self.model.robot, data, &self.packed, true).errors(rows, &self.estimate)
    }
}

/// Fits screws and terms together, from a finished calibration (theory.md §6, *Corrections*): with these sizes, or with those that
/// cross-validation chooses. Gravity is a direction in the base frame.
#[must_use]
pub fn correct(
    calibration: &Calibration,
    data: &Dataset,
    gravity: Vector3<f64>,
    sizes: Option<Sizes>,
    options: &CalibrationOptions,
) -> Correction {
    let own = calibration.packed(data);
    let geometry = Geometry { calibration, session: calibration.session(data, &own), options };
    let moves = moving(&calibration.nominal, &own, &calibration.fit_rows);
    let all = CorrectionModel::new(&calibration.nominal, gravity, &moves);
    let start = all.estimate(&calibration.models.calibrated, data);
    match sizes {
        Some(sizes) => geometry.fit(&all.with_sizes(&sizes), start, calibration.noise, sizes, None).0,
        None => {
            let (tried, choice) = geometry.fit(&all, start, calibration.noise, Sizes::ALL, Some(all.clone()));
            let Choice { sizes, tried: scores } =
                choice.unwrap_or(Choice { sizes: Sizes::COMMON, tried: Vec::new() });
            let model = all.with_sizes(&sizes);
            let mut start = model.estimate(&calibration.models.calibrated, data);
            for (to, from) in model.places.iter().zip(&all.places) {
                start.base_from_axis[*to] = tried.estimate.base_from_axis[*from];
            }
            start.base_from_target.clone_from(&tried.estimate.base_from_target);
            start.device_from_base = tried.estimate.device_from_base;
            start.further_devices.clone_from(&tried.estimate.further_devices);
            let (found, _) = geometry.fit(&model, start, tried.noise, sizes, None);
            Correction { tried: scores, ..found }
        }
    }
}

/// A finished calibration, from which corrections are fitted.
struct Geometry<'a> {
    calibration: &'a Calibration,
    session: Session<'a>,
    options: &'a CalibrationOptions,
}

impl Geometry<'_> {
    /// The fit of a model with these sizes, and the choice of sizes from its information, if a model is to be chosen for.
    fn fit(
        &self,
        model: &CorrectionModel,
        start: Estimate,
        noise: Noise,
        sizes: Sizes,
        chosen_for: Option<CorrectionModel>,
    ) -> (Correction, Option<Choice>) {
        let Geometry { calibration, session, options } = self;
        let rows = &calibration.fit_rows;
        let packed = Packed::of(&model.robot, session.data);
        let unknowns = model.unknowns(session.unknowns);
        let session = Session { robot: &model.robot, packed: &packed, unknowns: &unknowns, ..*session };
        let tolerance = options.tolerance.unwrap_or(Tolerance::WIDE);
        let prior = Prior::new(&model.robot, tolerance, session.base_free()).with_terms(model.priors(&sizes));
        let weights: Option<Vec<f64>> = calibration
            .robustness
            .loss
            .map(|_| calibration.robustness.rows.iter().map(|row| row.weight).collect());
        let weight = 1.0 + session.data.configurations(rows).len() as f64 / HALF;
        let task =
            Task { session, rows, weights: weights.as_deref(), prior: Some((&prior, weight)), options };
        let (estimate, noise) = fitted(&task, start, (noise, calibration.noise_source));
        let choice = chosen_for.map(|model| {
            let none = PriorInformation::none(0);
            let view = View {
                session,
                rows,
                free: &[],
                noise,
                noise_is_stated: ByQuantity::default(),
                prior: &none,
                variance: 1.0,
                estimate: &estimate,
            };
            let parts = parts_to_leave_out(&view, SAMPLE, options.seed);
            choose(&Task { prior: Some((&prior, 1.0)), ..task }, &model, (&estimate, noise), &parts)
        });
        (
            Correction { model: model.clone(), sizes, tried: Vec::new(), unknowns, estimate, noise, packed },
            choice,
        )
    }
}

/// The optimum with the noise estimated anew.
fn fitted(task: &Task<'_>, start: Estimate, (noise, source): (Noise, NoiseSource)) -> (Estimate, Noise) {
    let (mut estimate, mut noise) = (start, noise);
    for _ in 0..ROUNDS {
        let found = OngoingFit::new(task.fit(estimate, noise));
        let known = task.effective_unknowns(&found);
        estimate = found.estimate;
        if source != NoiseSource::Estimated {
            break;
        }
        let Some(better) = estimate_noise(&task.session, task.rows, &estimate, known, None, noise) else {
            break;
        };
        let better = stated(task.options, better);
        let change = better.iter().map(|(quantity, sigma)| (sigma / noise[quantity]).ln().abs());
        let is_settled = change.fold(0.0, f64::max) < SETTLED;
        noise = better;
        if is_settled {
            break;
        }
    }
    (estimate, noise)
}
