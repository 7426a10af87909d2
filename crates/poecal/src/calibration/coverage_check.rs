//! Coverage: the share of errors on other measurements inside their predicted 95 % bounds.

use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

use super::accuracy::{ModelAccuracy, model_accuracy};
use crate::analysis::{JointCoverage, inside};
use crate::estimate::{Estimate, RowError, Session};
use crate::measurement::Noise;
use crate::parameters::Parameter;
use crate::uncertainty::{Discrepancy, Quantile, Refit, Uncertainty};

/// Floor of the scatter of exact data: rounding.
pub(super) const ROUNDING: f64 = 1e-12;

/// Predicted uncertainty of a calibration, to be checked on measurements.
///
/// ```no_run
/// use poecal::calibration::PredictedUncertainty;
/// use poecal::io::calibration_file::CalibrationFile;
/// let file = CalibrationFile::read("calibration.json")?;
/// let (uncertainty, targets) = file.uncertainty(&[None])?;
/// let predicted = PredictedUncertainty { uncertainty: &uncertainty, targets: &targets, coverage: &file.coverage };
/// assert_eq!(predicted.targets.len(), 1);
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct PredictedUncertainty<'a> {
    /// Covariance of the unknowns, and model error.
    pub uncertainty: &'a Uncertainty,
    /// For each target of the judging measurements, its number among the uncertainty's targets.
    pub targets: &'a [usize],
    /// Sampled part of each joint's range.
    pub coverage: &'a [JointCoverage],
}

/// Errors compared with their predicted uncertainty (theory.md §9 (40), *Coverage*).
///
/// ```
/// use poecal::calibration::{CoverageCheck, PartCoverage};
/// let position = PartCoverage { expected_rms: 0.67, inside_bound95: 0.97 };
/// let kept = CoverageCheck { position_mm: position, rotation_deg: None, inside_sampled_range: 1.0 };
/// assert!(kept.least_inside() > 0.95);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CoverageCheck {
    /// Of positions, millimetres.
    pub position_mm: PartCoverage,
    /// Of rotations, degrees, if orientation was measured and calibrated.
    pub rotation_deg: Option<PartCoverage>,
    /// Share of the configurations with every joint inside the sampled range.
    pub inside_sampled_range: f64,
}

/// The same for positions or rotations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PartCoverage {
    /// Expected root mean square error between measured and predicted, measurement noise included.
    pub expected_rms: f64,
    /// Share of the errors within their own 95 % bound.
    pub inside_bound95: f64,
}

impl CoverageCheck {
    /// The smaller share of errors within their bounds, of positions and rotations.
    #[must_use]
    pub fn least_inside(&self) -> f64 {
        let rotation = self.rotation_deg.map_or(1.0, |part| part.inside_bound95);
        self.position_mm.inside_bound95.min(rotation)
    }
}

#[derive(Default)]
struct CoverageSums {
    squares: f64,
    within: usize,
    count: usize,
}

impl CoverageSums {
    fn add(&mut self, predicted: &Matrix3<f64>, quantile: &Quantile, error: &Vector3<f64>) {
        self.squares += predicted.trace();
        self.within += usize::from(error.norm() <= quantile.bound(predicted));
        self.count += 1;
    }

    fn part(&self, unit: f64) -> Option<PartCoverage> {
        let count = self.count as f64;
        (self.count > 0).then(|| PartCoverage {
            expected_rms: unit * (self.squares / count).sqrt(),
            inside_bound95: self.within as f64 / count,
        })
    }
}

impl PredictedUncertainty<'_> {
    /// Compares the errors of some rows with their bounds: theory.md §9 (40), *Coverage*.
    #[must_use]
    pub fn check(&self, session: &Session<'_>, rows: &[u32], errors: &[RowError]) -> CoverageCheck {
        let Session { robot, data, packed, .. } = *session;
        let target = |row: &u32| data.observations[*row as usize].target;
        let places = rows
            .iter()
            .map(|row| (*row as usize, self.targets.get(target(row)).copied().unwrap_or_default()));
        let predicted = self.uncertainty.predictions_of(places, packed);
        // The model error contains the noise, unless the two were separated.
        let Noise { position_m, rotation_rad } = self.uncertainty.discrepancy.noise;
        let (mut position, mut rotation) = (CoverageSums::default(), CoverageSums::default());
        let observations = rows.iter().map(|&row| &data.observations[row as usize]);
        for ((predicted, error), observation) in predicted.into_iter().zip(errors).zip(observations) {
            let own = |sigma: Option<f64>, usual: f64| Matrix3::identity() * sigma.unwrap_or(usual).powi(2);
            position.add(
                &(predicted.position + own(observation.sigma_position_m, position_m)),
                &predicted.quantiles[0],
                &error.position_m,
            );
            if let Some(turn) = error.rotation_rad {
                rotation.add(
                    &(predicted.rotation + own(observation.sigma_rotation_rad, rotation_rad)),
                    &predicted.quantiles[1],
                    &turn,
                );
            }
        }
        let is_inside = |row: &&u32| inside(robot, self.coverage, data.readings(**row as usize));
        let sampled = rows.iter().filter(is_inside).count();
        CoverageCheck {
            position_mm: position
                .part(1e3)
                .unwrap_or(PartCoverage { expected_rms: 0.0, inside_bound95: 1.0 }),
            rotation_deg: rotation.part(1f64.to_degrees()),
            inside_sampled_range: sampled as f64 / rows.len().max(1) as f64,
        }
    }
}

/// Errors of the rows inside the sampled range.
///
/// ```
/// use poecal::calibration::{InSampledRange, CoverageCheck, PartCoverage, ModelAccuracy, Statistic};
/// let position_mm = Statistic { mean: 0.1, rms: 0.11, p95: 0.2, max: 0.25 };
/// let part = PartCoverage { expected_rms: 0.1, inside_bound95: 0.95 };
/// let promised = CoverageCheck { position_mm: part, rotation_deg: None, inside_sampled_range: 1.0 };
/// let calibrated = ModelAccuracy { position_mm, rotation_deg: None };
/// assert!(InSampledRange { count: 20, calibrated, promised }.promised.least_inside() > 0.9);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InSampledRange {
    /// Number of rows.
    pub count: usize,
    /// Their errors.
    pub calibrated: ModelAccuracy,
    /// Coverage of their bounds.
    pub promised: CoverageCheck,
}

/// Predictions of the judging rows.
pub(super) struct JudgedRows<'a> {
    pub(super) session: Session<'a>,
    pub(super) estimate: Estimate,
    pub(super) errors: Vec<RowError>,
    /// Refitted parameters.
    pub(super) free: Vec<Parameter>,
}

/// Coverage over all rows, and over those inside the sampled range, if there are any. `None` if the rows do not determine the refitted
/// unknowns.
pub(super) fn coverage_checks(
    predicted: &PredictedUncertainty<'_>,
    refit_tool: bool,
    seen: &JudgedRows<'_>,
) -> Option<(CoverageCheck, Option<InSampledRange>)> {
    let Session { robot, data, .. } = seen.session;
    let refitted = if seen.free.is_empty() { None } else { Some(refitted(predicted, refit_tool, seen)?) };
    let own: Vec<usize> = (0..data.targets.len()).collect();
    let predicted = match &refitted {
        Some(uncertainty) => PredictedUncertainty { uncertainty, targets: &own, ..*predicted },
        None => *predicted,
    };
    let mut rows = data.all_rows();
    let all = predicted.check(&seen.session, &rows, &seen.errors);
    rows.retain(|&row| inside(robot, predicted.coverage, data.readings(row as usize)));
    if rows.is_empty() {
        return Some((all, None));
    }
    let errors: Vec<_> = rows.iter().map(|&row| seen.errors[row as usize]).collect();
    let promised = predicted.check(&seen.session, &rows, &errors);
    let calibrated = model_accuracy(&errors);
    Some((all, Some(InSampledRange { count: rows.len(), calibrated, promised })))
}

/// Uncertainty of the errors that remain after device frame or targets were refitted: theory.md §9, *Coverage*.
fn refitted(
    predicted: &PredictedUncertainty<'_>,
    refit_tool: bool,
    seen: &JudgedRows<'_>,
) -> Option<Uncertainty> {
    let number = |target: usize| predicted.targets.get(target).copied().filter(|_| !refit_tool);
    let targets: Vec<Option<usize>> = (0..seen.session.data.targets.len()).map(number).collect();
    predicted.uncertainty.refitted(&Refit {
        session: seen.session,
        found: &seen.estimate,
        free: &seen.free,
        scatter: scatter(predicted),
        targets: &targets,
    })
}

/// Scatter of a row that states no noise: measurement noise and model error.
fn scatter(predicted: &PredictedUncertainty<'_>) -> Noise {
    let Discrepancy { standard_deviation, noise, .. } = predicted.uncertainty.discrepancy;
    let both = |robot: f64, instrument: f64| robot.hypot(instrument).max(ROUNDING);
    Noise {
        position_m: both(standard_deviation.position_m, noise.position_m),
        rotation_rad: both(standard_deviation.rotation_rad, noise.rotation_rad),
    }
}
