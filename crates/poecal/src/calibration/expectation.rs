//! Whether the errors of a calibration on other measurements are those that it promised.

use nalgebra::Matrix3;
use serde::Serialize;

use super::trust::inside;
use crate::analysis::JointCoverage;
use crate::estimate::{Packed, RowError};
use crate::measurement::{Dataset, Noise};
use crate::robot::Robot;
use crate::uncertainty::Uncertainty;

/// What a calibration promises of its predictions.
///
/// ```no_run
/// use poecal::calibration::Promise;
/// use poecal::io::calibration_file::CalibrationFile;
/// let file = CalibrationFile::read("calibration.json")?;
/// let (uncertainty, targets) = file.uncertainty(&[None])?;
/// let noise = file.noise()?;
/// let promise = Promise { uncertainty: &uncertainty, targets: &targets, noise, noise_is_stated: false, coverage: &file.coverage };
/// assert_eq!(promise.targets.len(), 1);
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Promise<'a> {
    /// Covariance of the unknowns and what the model does not describe.
    pub uncertainty: &'a Uncertainty,
    /// For each target of the judging measurements, which of the uncertainty's targets it is.
    pub targets: &'a [usize],
    /// Noise of a measurement that states none itself.
    pub noise: Noise,
    /// Whether that noise was stated, and not what the residuals showed.
    pub noise_is_stated: bool,
    /// What of each joint's range was sampled.
    pub coverage: &'a [JointCoverage],
}

/// How errors compare with what was promised (theory.md §9 (40)).
///
/// ```
/// let kept = poecal::calibration::Kept { expected_rms_mm: 0.67, inside_bound95: 0.97, inside_sampled_range: 1.0 };
/// assert!(kept.inside_bound95 > 0.95);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Kept {
    /// Root mean square distance to expect between measured and predicted positions, millimetres.
    pub expected_rms_mm: f64,
    /// Share of the position errors within their own 95 % bound.
    pub inside_bound95: f64,
    /// Share of the configurations with every joint inside the range that was sampled.
    pub inside_sampled_range: f64,
}

impl Promise<'_> {
    /// Compares the errors of all rows of some measurements.
    #[must_use]
    pub fn kept(&self, robot: &Robot, data: &Dataset, packed: &Packed, errors: &[RowError]) -> Kept {
        let rows = data.observations.iter().enumerate().map(|(row, observation)| {
            (row, self.targets.get(observation.target).copied().unwrap_or_default())
        });
        let promised = self.uncertainty.predictions_of(rows, packed);
        // What the residuals showed holds the noise already, unless it was stated or nothing but noise was found.
        let noise_beside = self.noise_is_stated || self.uncertainty.discrepancy.position_m == 0.0;
        let (mut squares, mut within) = (0.0, 0usize);
        for ((mut promised, error), observation) in promised.into_iter().zip(errors).zip(&data.observations) {
            let usual = if noise_beside { self.noise.position_m } else { 0.0 };
            let sigma = observation.sigma_position_m.unwrap_or(usual);
            promised.position += Matrix3::identity() * (sigma * sigma);
            squares += promised.position.trace();
            within += usize::from(error.position_m.norm() <= promised.bound_position_m());
        }
        let sampled = (0..data.len()).filter(|&row| inside(robot, self.coverage, data.readings(row))).count();
        let count = errors.len().max(1) as f64;
        Kept {
            expected_rms_mm: 1e3 * (squares / count).sqrt(),
            inside_bound95: within as f64 / count,
            inside_sampled_range: sampled as f64 / count,
        }
    }
}
