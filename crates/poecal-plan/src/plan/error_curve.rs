//! Expected errors, of planned configurations or of an existing list.

use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::experiment::{PlannedExperiment, WORKSPACE, undetermined_error};
use super::options::PlannedFit;
use super::state::{CovarianceState, CriterionContext, CriterionWeights, WorkspaceErrors};
use poecal_model::robot::Robot;
use poecal_model::simulate::Configurations;
use poecal_numerics::error::Result;

/// Ten more configurations that gain less than this share are not worth it.
const WORTH_IT: f64 = 0.05;

/// Expected root mean square errors of the tip over the workspace, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpectedErrors {
    /// Undetermined part of the calibrated model: by noise and prior, and by effects beyond geometry in excess of the robot error.
    pub undetermined_m: f64,
    /// Robot error: the part that no geometry describes.
    pub robot_m: f64,
    /// Undetermined part of the corrected model.
    pub corrected_undetermined_m: f64,
    /// Part that neither geometry nor terms of the joints describe.
    pub corrected_robot_m: f64,
}

impl ExpectedErrors {
    pub(crate) fn new(experiment: &PlannedExperiment, squares: &WorkspaceErrors) -> Self {
        ExpectedErrors::from_seen_noise(experiment, squares, [1.0; 2])
    }

    /// The errors if noise and terms are scaled by these factors of their variances.
    pub(crate) fn from_seen_noise(
        experiment: &PlannedExperiment,
        squares: &WorkspaceErrors,
        [noise, terms]: [f64; 2],
    ) -> Self {
        let (robot, rest) = (experiment.robot_error_m, experiment.rest_m);
        let of_terms = (robot * robot - rest * rest).max(0.0) * terms;
        // Chosen rows may leave less of the terms than random ones do in the limit, which is the stated robot error.
        let beyond = (squares.terms - of_terms).max(0.0);
        ExpectedErrors {
            undetermined_m: (squares.true_noise + beyond).max(0.0).sqrt(),
            robot_m: (of_terms.min(squares.terms) + rest * rest * noise).sqrt(),
            corrected_undetermined_m: squares.corrected.max(0.0).sqrt(),
            corrected_robot_m: experiment.left_m * noise.sqrt(),
        }
    }

    /// Expected error of the calibrated model.
    #[must_use]
    pub fn calibrated_m(&self) -> f64 {
        self.undetermined_m.hypot(self.robot_m)
    }

    /// Expected error of the corrected model.
    #[must_use]
    pub fn corrected_m(&self) -> f64 {
        self.corrected_undetermined_m.hypot(self.corrected_robot_m)
    }
}

/// Expected errors with this number of planned configurations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// Number of configurations.
    pub count: usize,
    /// Expected errors.
    pub expected: ExpectedErrors,
}

/// Expected errors of a list of configurations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ListExpectation {
    /// The errors.
    pub errors: ExpectedErrors,
    /// True if the robot error is a guess: 0.3 mm for each metre of reach.
    pub robot_error_is_a_guess: bool,
}

/// Expected errors, over the workspace within the limits, of a fit of measurements in the supplied configurations; `readings` in the order of
/// [`Robot::reading_names`], one configuration after the other, radians and metres.
///
/// ```
/// use poecal_plan::plan::{PlannedFit, expected_errors};
/// use poecal_model::simulate::elbow;
/// // Readings that fill their range: fractions of multiples of irrational numbers, from -2.5 to 2.5 radians.
/// let reading = |k: usize| 5.0 * ((k as f64 * [0.618, 0.414, 0.732, 0.236, 0.646, 0.317][k % 6]).fract() - 0.5);
/// let of = |rows: usize| {
///     let readings: Vec<f64> = (0..6 * rows).map(reading).collect();
///     expected_errors(&elbow(), &readings, &PlannedFit::default())
/// };
/// assert!(of(60)?.errors.corrected_m() < of(15)?.errors.corrected_m());
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
///
/// # Errors
/// As [`super::plan()`].
pub fn expected_errors(robot: &Robot, readings: &[f64], fit: &PlannedFit) -> Result<ListExpectation> {
    let count = readings.len() / robot.reading_names().len().max(1);
    let experiment = PlannedExperiment::new(robot, &PlannedFit { count, ..fit.clone() })?;
    let mut generator = ChaCha8Rng::seed_from_u64(fit.count as u64);
    let configurations = Configurations::new(&experiment.robot);
    let workspace: Vec<f64> = (0..WORKSPACE).flat_map(|_| configurations.random(&mut generator)).collect();
    let blocks = experiment.blocks(readings)?;
    let corrected = if blocks.columns > experiment.geometry() { 1.0 } else { 0.0 };
    let weights = CriterionWeights { calibrated: 1.0, corrected, determinant: 0.0 };
    let aim = CriterionContext::new(&experiment.prior, experiment.moments(&workspace), weights, experiment.share());
    let (_, squares) = CovarianceState::new(&aim, &blocks.gram(0..blocks.count())).ok_or_else(undetermined_error)?;
    let errors = ExpectedErrors::new(&experiment, &squares);
    Ok(ListExpectation { errors, robot_error_is_a_guess: experiment.is_guess })
}

/// The smallest number of the curve from which ten more gain less than a share of both errors.
pub(crate) fn sufficient_count(curve: &[CurvePoint]) -> Option<usize> {
    let errors = |at: f64| -> Option<[f64; 2]> {
        let above = curve.iter().position(|point| point.count as f64 >= at)?;
        let of = |point: &CurvePoint| [point.expected.calibrated_m(), point.expected.corrected_m()];
        let (b, count) = (of(&curve[above]), curve[above].count as f64);
        let Some(before) = above.checked_sub(1).map(|it| &curve[it]) else { return Some(b) };
        let (a, first) = (of(before), before.count as f64);
        let share = (at - first) / (count - first);
        Some([0, 1].map(|k| a[k] + share * (b[k] - a[k])))
    };
    let gains_little = |point: &&CurvePoint| {
        let (Some(now), Some(then)) = (errors(point.count as f64), errors(point.count as f64 + 10.0)) else {
            return false;
        };
        (0..2).all(|k| then[k] >= (1.0 - WORTH_IT) * now[k])
    };
    curve.iter().find(gains_little).map(|point| point.count)
}

#[cfg(test)]
mod tests {
    use crate::plan::{PlanOptions, PlannedFit, plan};
    use nalgebra::Vector3;
    use poecal_model::simulate::elbow;

    /// The reduction by more rows decreases with their number and never vanishes, with three targets in a configuration or one.
    #[test]
    fn more_rows_always_remove_something() {
        for targets in [1, 3] {
            let fit = PlannedFit {
                count: 60,
                targets,
                target_offset: Some(Vector3::new(0.1, 0.0, 0.05)),
                ..PlannedFit::default()
            };
            let options = PlanOptions { fit, candidates: 400, ..PlanOptions::default() };
            let curve = plan(&elbow(), &options).unwrap().curve;
            let left_mm: Vec<f64> = curve.iter().map(|it| 1e3 * it.expected.undetermined_m).collect();
            println!("{targets} targets: {left_mm:.4?} mm");
            // The error due to noise decreases with the root of the number. Each of the chosen rows is worth less than those before, and the share of
            // the terms is random, so that half of this decrease is required. With fewer rows the prior decides.
            let curve: Vec<_> = curve.into_iter().filter(|it| it.count >= 20).collect();
            for (few, more) in curve.iter().zip(&curve[1..]) {
                let root = (few.count as f64 / more.count as f64).sqrt();
                let [few, more] = [few, more].map(|it| it.expected.undetermined_m);
                assert!(more >= 0.5 * root * few && more < 1.05 * few, "{few} to {more}");
            }
            // The whole is the sum of squares of its parts.
            let total = curve[0].expected;
            assert!(
                (total.calibrated_m().powi(2) - total.undetermined_m.powi(2) - total.robot_m.powi(2)).abs() < 1e-18
            );
        }
    }
}
