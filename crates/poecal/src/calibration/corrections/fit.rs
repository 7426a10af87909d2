//! The fit of screws and terms together.

use nalgebra::Vector3;

use super::model::moving;
use super::{CorrectionModel, Sizes};
use crate::calibration::fit::Task;
use crate::calibration::found::OngoingFit;
use crate::calibration::noise::{NoiseSource, stated};
use crate::calibration::{Calibration, CalibrationOptions, estimate_noise};
use crate::estimate::{Estimate, Packed, RowError, Session, Unknowns};
use crate::measurement::{Dataset, Noise};
use crate::problem::Prior;
use crate::robot::Tolerance;

/// Most rounds of re-estimating the noise.
const ROUNDS: usize = 4;
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
/// let found = correct(&calibration, &made.data, -Vector3::z(), &Sizes::COMMON, &options);
/// assert_eq!(found.errors(&made.data, &calibration.held_out_rows).len(), calibration.held_out_rows.len());
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Correction {
    /// The robot with its gives and terms, as in the model.
    pub model: CorrectionModel,
    /// What was fitted.
    pub unknowns: Unknowns,
    /// What was found.
    pub estimate: Estimate,
    /// Noise of the fit.
    pub noise: Noise,
    packed: Packed,
}

impl Correction {
    /// Errors of rows of the data that were fitted ([`Session::errors`]).
    #[must_use]
    pub fn errors(&self, data: &Dataset, rows: &[u32]) -> Vec<RowError> {
        Session::new(&self.model.robot, data, &self.packed, true).errors(rows, &self.estimate)
    }
}

/// Fits screws and terms of these sizes together, from a finished calibration (theory.md §6, *Corrections*). Gravity is a direction in the
/// base frame.
#[must_use]
pub fn correct(
    calibration: &Calibration,
    data: &Dataset,
    gravity: Vector3<f64>,
    sizes: &Sizes,
    options: &CalibrationOptions,
) -> Correction {
    let own = calibration.packed(data);
    let geometry = calibration.session(data, &own);
    let rows = &calibration.fit_rows;
    let moves = moving(&calibration.nominal, &own, rows);
    let model = CorrectionModel::new(&calibration.nominal, gravity, &moves).with_sizes(sizes);
    let packed = Packed::of(&model.robot, data);
    let unknowns = model.unknowns(geometry.unknowns);
    let session = Session { robot: &model.robot, packed: &packed, unknowns: &unknowns, ..geometry };
    let tolerance = options.tolerance.unwrap_or(Tolerance::WIDE);
    let prior = Prior::new(&model.robot, tolerance, session.base_free()).with_terms(model.priors(sizes));
    let weights: Option<Vec<f64>> = calibration
        .robustness
        .loss
        .map(|_| calibration.robustness.rows.iter().map(|row| row.weight).collect());
    let task = Task { session, rows, weights: weights.as_deref(), prior: Some((&prior, 1.0)), options };
    let start = model.estimate(&calibration.models.calibrated, data);
    let (estimate, noise) = fitted(&task, start, (calibration.noise, calibration.noise_source));
    Correction { model, unknowns, estimate, noise, packed }
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
