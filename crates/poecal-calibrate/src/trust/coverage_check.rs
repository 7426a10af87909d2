//! Coverage: the share of errors on other measurements inside their predicted 95 % bounds.

use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

use crate::CornerError;
use crate::run::accuracy::{ModelAccuracy, model_accuracy};
use crate::run::station_frames::rows_of_fitted_stations;
use poecal_fit::analysis::{JointCoverage, is_within_ranges};
use poecal_fit::parameters::Parameter;
use poecal_fit::state::{Estimate, Linkage, RowChain, RowError, Session, sample_rows};
use poecal_fit::uncertainty::{Discrepancy, FrameRefit, PredictedError, Uncertainty};
use poecal_model::measurement::{ByQuantity, Dataset, MeasuredQuantities, NUMBERS, Noise, Quantity};
use poecal_numerics::linalg;
use poecal_numerics::unit::Unit;

/// Floor of the scatter of exact data: rounding.
pub(crate) const ROUNDING: f64 = 1e-12;
/// Most held-out rows whose bounds are checked.
const JUDGED: usize = 4000;

/// Predicted uncertainty of a calibration, to be checked on measurements.
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
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CoverageCheck {
    /// Coverage of each measured quantity, millimetres or degrees; of rotations only if they were calibrated too.
    #[serde(flatten)]
    pub parts: MeasuredQuantities<QuantityCoverage>,
    /// Share of the configurations with every joint inside the sampled range.
    pub inside_sampled_range: f64,
}

/// Coverage of one quantity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct QuantityCoverage {
    /// Expected root mean square error between measured and predicted, measurement noise included.
    pub expected_rms: f64,
    /// Share of the errors within their own 95 % bound.
    pub inside_bound95: f64,
}

impl CoverageCheck {
    /// Coverage of positions, millimetres.
    #[must_use]
    pub fn position_mm(&self) -> QuantityCoverage {
        self.parts.position_mm()
    }

    /// Coverage of rotations, degrees, if orientation was measured.
    #[must_use]
    pub fn rotation_deg(&self) -> Option<QuantityCoverage> {
        self.parts.rotation_deg()
    }

    /// The smallest share of errors within their bounds, of all quantities.
    #[must_use]
    pub fn least_inside(&self) -> f64 {
        self.parts.iter().map(|(_, part)| part.inside_bound95).fold(1.0, f64::min)
    }
}

impl Default for QuantityCoverage {
    /// Coverage without any errors.
    fn default() -> Self {
        QuantityCoverage { expected_rms: 0.0, inside_bound95: 1.0 }
    }
}

#[derive(Clone, Copy, Default)]
struct CoverageSums {
    squares: f64,
    within: usize,
    count: usize,
}

impl CoverageSums {
    fn add(&mut self, found: &JudgedError) {
        let Some(promise) = &found.promised else { return };
        self.squares += promise.variance;
        self.within += usize::from(found.length <= promise.bound);
        self.count += 1;
    }

    fn part(&self, unit: Unit) -> Option<QuantityCoverage> {
        let count = self.count as f64;
        (self.count > 0).then(|| QuantityCoverage {
            expected_rms: unit.in_shown_unit(1.0) * (self.squares / count).sqrt(),
            inside_bound95: self.within as f64 / count,
        })
    }
}

/// Error of one quantity in a row of other measurements, metres or radians, and its predictive distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JudgedError {
    /// Length of measured minus predicted.
    pub length: f64,
    /// Measured minus predicted by component, for vectors in the device's axes; NaN for components that were not measured.
    pub residual: [f64; Quantity::MOST_COMPONENTS],
    /// Predictive distribution; `None` without uncertainty.
    pub promised: Option<PredictiveDistribution>,
}

/// Predictive distribution of an error, measurement noise included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictiveDistribution {
    /// Expected square of the error, square metres or square radians.
    pub variance: f64,
    /// Bound below which 95 % of such errors lie.
    pub bound: f64,
}

/// Errors of a row of other measurements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JudgedRow {
    /// Errors of each measured quantity.
    pub errors: MeasuredQuantities<JudgedError>,
    /// True if every joint was inside the sampled range, or if none was stated.
    pub inside_sampled_range: bool,
    /// Error of the corners of a picture; `None` for other rows, and if the model sees none of them.
    pub corners: Option<CornerError>,
}

impl JudgedRow {
    /// A row without a predictive distribution.
    pub(crate) fn from_error(error: &RowError) -> Self {
        let errors = MeasuredQuantities::from_fn(|quantity| JudgedError::from_error(error, quantity, None));
        JudgedRow { errors, inside_sampled_range: true, corners: None }
    }
}

impl JudgedError {
    /// Error of a quantity, if it was measured.
    fn from_error(error: &RowError, quantity: Quantity, promised: Option<PredictiveDistribution>) -> Option<Self> {
        let length = error.length(quantity)?;
        let (measured, vector) = (error.measured_components(quantity), error.vector(quantity));
        let residual = std::array::from_fn(|k| if measured[k] { vector[k] } else { f64::NAN });
        Some(JudgedError { length, residual, promised })
    }
}

impl CoverageCheck {
    /// Coverage over some rows.
    fn from_rows<'a>(rows: impl Iterator<Item = &'a JudgedRow>) -> Self {
        let mut sums: ByQuantity<CoverageSums> = ByQuantity::default();
        let (mut count, mut sampled) = (0_usize, 0_usize);
        for row in rows {
            row.errors.iter().for_each(|(quantity, found)| sums[quantity].add(&found));
            count += 1;
            sampled += usize::from(row.inside_sampled_range);
        }
        CoverageCheck {
            parts: MeasuredQuantities::from_fn(|quantity| sums[quantity].part(quantity.unit())),
            inside_sampled_range: sampled as f64 / count.max(1) as f64,
        }
    }
}

impl PredictedUncertainty<'_> {
    /// Compares the errors of some rows, by the predictions of an estimate, with their bounds: theory.md §9 (40), *Coverage*.
    #[must_use]
    pub fn check(
        &self,
        session: &Session<'_>,
        estimate: &Estimate,
        rows: &[u32],
        errors: &[RowError],
    ) -> CoverageCheck {
        CoverageCheck::from_rows(self.rows(session, estimate, rows, errors).iter())
    }

    /// Errors of some rows with their predictive distributions.
    fn rows(&self, session: &Session<'_>, estimate: &Estimate, rows: &[u32], errors: &[RowError]) -> Vec<JudgedRow> {
        let Session { robot, data, packed, .. } = *session;
        let target = |row: &u32| data.observations[*row as usize].target;
        let places = rows.iter().map(|row| (*row as usize, self.targets.get(target(row)).copied().unwrap_or_default()));
        let predicted = self.uncertainty.predictions_of(places, packed);
        // The model error contains the noise, unless the two were separated.
        let noise = self.uncertainty.discrepancy.noise;
        let mut observed =
            ObservedCoverage { session, estimate, linkage: Linkage::new(estimate), chain: RowChain::default() };
        let all = predicted.into_iter().zip(errors).zip(rows).map(|((predicted, error), &row)| {
            let own = session.noise_of(session.observation(row), noise);
            let errors = MeasuredQuantities::from_fn(|quantity| {
                error.length(quantity)?;
                let of_robot = observed.covariance(&predicted, row, quantity);
                // The noise has as many components as there are numbers.
                let mut of_noise = Matrix3::zeros();
                (0..error.part(quantity).len()).for_each(|k| of_noise[(k, k)] = own[quantity].powi(2));
                let robot = self.uncertainty.discrepancy.standard_deviation[quantity];
                let of_noise = of_picture(data, row, (quantity, robot)).unwrap_or(of_noise);
                let covariance = of_robot + of_noise;
                let bound = predicted.quantiles[quantity].bound(&covariance);
                let promised = Some(PredictiveDistribution { variance: covariance.trace(), bound });
                JudgedError::from_error(error, quantity, promised)
            });
            let inside_sampled_range = is_within_ranges(robot, self.coverage, data.readings(row as usize));
            JudgedRow { errors, inside_sampled_range, corners: None }
        });
        all.collect()
    }
}

/// Covariance of the part of a picture's pose that corners leave undetermined, without the error of its configuration, which belongs to the robot;
/// `None` for other rows.
fn of_picture(data: &Dataset, row: u32, (quantity, robot): (Quantity, f64)) -> Option<Matrix3<f64>> {
    data.pictures.index_of_row(row)?;
    let first = [Quantity::Position, Quantity::Rotation].iter().position(|it| *it == quantity)? * 3;
    let whitening = data.whitening_of_picture(row)?;
    // Metres per radian that balance positions and rotations.
    let size = |first: usize| whitening.fixed_columns::<3>(first).norm().max(f64::MIN_POSITIVE);
    let length_m = size(3) / size(0);
    let mut information = whitening.transpose() * whitening;
    information.fixed_rows_mut::<3>(3).scale_mut(1.0 / length_m);
    information.fixed_columns_mut::<3>(3).scale_mut(1.0 / length_m);
    let all = linalg::cholesky_6(information)?.inverse();
    let unit = if first == 0 { 1.0 } else { 1.0 / length_m };
    let own = all.fixed_view::<3, 3>(first, first).into_owned() * (unit * unit);
    let (values, vectors) = linalg::symmetric_eigen(own.as_slice(), 3);
    let mut left = Matrix3::zeros();
    for (k, value) in values.iter().enumerate() {
        let vector = Vector3::from_fn(|i, _| vectors[(i, k)]);
        left += vector * vector.transpose() * (value - robot * robot).max(0.0);
    }
    Some(left)
}

/// Uncertainty of targets in the observed rows.
struct ObservedCoverage<'a> {
    session: &'a Session<'a>,
    estimate: &'a Estimate,
    linkage: Linkage,
    chain: RowChain,
}

impl ObservedCoverage<'_> {
    /// Covariance of a row's numbers of one quantity: the target's own if its position or orientation was measured, `S P Sᵀ` for any other function,
    /// in the axes of the row's device.
    fn covariance(&mut self, predicted: &PredictedError, row: u32, quantity: Quantity) -> Matrix3<f64> {
        let observation = self.session.observation(row);
        let seen = observation.measurement;
        if quantity == Quantity::Position && seen.position().is_some() {
            return predicted.position;
        }
        if quantity == Quantity::Rotation && seen.orientation().is_some() {
            return predicted.rotation;
        }
        let mut sensitivity = [[0.0; 6]; NUMBERS];
        self.chain.evaluate(&self.linkage, self.session.packed, row as usize, observation);
        seen.sensitivity(&self.chain.target, &mut sensitivity);
        let own = self.estimate.device(observation.station).rotation;
        let turn = own * self.estimate.device_from_base.rotation.transpose();
        let [place, rotation] = [predicted.position, predicted.rotation].map(|it| turn * it * turn.transpose());
        let rows = sensitivity.iter().zip(seen.channels()).filter(|(_, channel)| channel.quantity == quantity);
        let rows: Vec<[Vector3<f64>; 2]> =
            rows.take(3).map(|([a, b, c, p, q, r], _)| [Vector3::new(*a, *b, *c), Vector3::new(*p, *q, *r)]).collect();
        let mut covariance = Matrix3::zeros();
        for (i, [v, w]) in rows.iter().enumerate() {
            for (j, [moved, turned]) in rows.iter().enumerate() {
                covariance[(i, j)] = v.dot(&(place * moved)) + w.dot(&(rotation * turned));
            }
        }
        covariance
    }
}

/// Errors of the rows inside the sampled range.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SampledRangeErrors {
    /// Number of rows.
    pub count: usize,
    /// Their errors.
    pub calibrated: ModelAccuracy,
    /// Coverage of their bounds.
    pub promised: CoverageCheck,
}

/// Predictions of the judging rows.
pub(crate) struct JudgedPredictions<'a> {
    pub(crate) session: Session<'a>,
    pub(crate) estimate: Estimate,
    pub(crate) errors: Vec<RowError>,
    /// Refitted parameters.
    pub(crate) free: Vec<Parameter>,
}

/// All rows with their predictive distributions. `None` if they do not determine the refitted unknowns.
pub(crate) fn promised_rows(
    predicted: &PredictedUncertainty<'_>,
    refit_tool: bool,
    seen: &JudgedPredictions<'_>,
) -> Option<Vec<JudgedRow>> {
    let data = seen.session.data;
    let refitted = if seen.free.is_empty() { None } else { Some(refit_uncertainty(predicted, refit_tool, seen)?) };
    let own: Vec<usize> = (0..data.targets.len()).collect();
    let predicted = match &refitted {
        Some(uncertainty) => PredictedUncertainty { uncertainty, targets: &own, ..*predicted },
        None => *predicted,
    };
    Some(predicted.rows(&seen.session, &seen.estimate, &data.all_rows(), &seen.errors))
}

/// Coverage on held-out rows, at most [`JUDGED`], of a model with its uncertainty and sampled ranges; `None` without rows to which bounds apply.
pub(crate) fn held_out_check(
    (session, estimate): (&Session<'_>, &Estimate),
    (fitted, held_out): (&[u32], &[u32]),
    predicted: Option<(&Uncertainty, &[JointCoverage])>,
) -> Option<CoverageCheck> {
    let (uncertainty, coverage) = predicted?;
    let targets: Vec<usize> = (0..session.data.targets.len()).collect();
    let rows = sample_rows(&rows_of_fitted_stations(session.data, fitted, held_out), JUDGED);
    let errors = session.errors(&rows, estimate);
    let predicted = PredictedUncertainty { uncertainty, targets: &targets, coverage };
    (!rows.is_empty()).then(|| predicted.check(session, estimate, &rows, &errors))
}

/// Coverage over all rows, and over those inside the sampled range, if there are any.
pub(crate) fn coverage_checks(
    data: &Dataset,
    rows: &[JudgedRow],
    errors: &[RowError],
) -> (CoverageCheck, Option<SampledRangeErrors>) {
    let inside = || rows.iter().zip(errors).filter(|(row, _)| row.inside_sampled_range);
    let own = (0..).zip(rows).filter(|(_, row)| row.inside_sampled_range).map(|(at, _)| at);
    let own: Vec<u32> = own.collect();
    let errors: Vec<RowError> = inside().map(|(_, error)| *error).collect();
    let some = (!errors.is_empty()).then(|| SampledRangeErrors {
        count: errors.len(),
        calibrated: model_accuracy(data, &own, &errors),
        promised: CoverageCheck::from_rows(inside().map(|(row, _)| row)),
    });
    (CoverageCheck::from_rows(rows.iter()), some)
}

/// Uncertainty of the errors that remain after device frame or targets were refitted: theory.md §9, *Coverage*.
fn refit_uncertainty(
    predicted: &PredictedUncertainty<'_>,
    refit_tool: bool,
    seen: &JudgedPredictions<'_>,
) -> Option<Uncertainty> {
    let number = |target: usize| predicted.targets.get(target).copied().filter(|_| !refit_tool);
    let targets: Vec<Option<usize>> = (0..seen.session.data.targets.len()).map(number).collect();
    predicted.uncertainty.after_refit(&FrameRefit {
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
    ByQuantity::from_fn(|quantity| standard_deviation[quantity].hypot(noise[quantity]).max(ROUNDING))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_share_inside_is_that_of_the_worst_quantity() {
        let inside = |quantity| if quantity == Quantity::Position { 0.97 } else { 0.93 };
        let part = |quantity| QuantityCoverage { expected_rms: 0.67, inside_bound95: inside(quantity) };
        let parts = MeasuredQuantities::from_fn(|quantity| quantity.is_of_pose().then(|| part(quantity)));
        assert_eq!(CoverageCheck { parts, inside_sampled_range: 1.0 }.least_inside(), 0.93);
    }
}
