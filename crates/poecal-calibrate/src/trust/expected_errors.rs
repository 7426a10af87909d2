//! Expected errors of predictions: in the measured configurations, inside the measured ranges, anywhere within the limits, and by parts of each
//! joint's range.

use nalgebra::Matrix3;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::domain::Domain;
use super::nominal_errors::NominalError;
use poecal_fit::analysis::JointCoverage;
use poecal_fit::state::{PackedValues, Session, sample_rows};
use poecal_fit::uncertainty::{Attribution, Quantile, Uncertainty};
use poecal_model::measurement::Quantity;
use poecal_model::robot::{Joint, JointKind, Robot};
use poecal_model::simulate::random;

/// Number of random configurations within the joint range.
const CONFIGURATIONS: usize = 400;
/// Number of configurations if there are more unknowns than this: a mean over fewer is as good.
const MANY_UNKNOWNS: usize = 80;
const FEWER: usize = 120;
/// Number of parts of each joint's range.
const PARTS: usize = 6;
/// Most targets over which expected errors are averaged.
const MOST_TARGETS: usize = 12;
/// Expected errors of predicted positions, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpectedPositionErrors {
    /// Root mean square distance.
    pub sigma_m: f64,
    /// Mean of the 95 % bounds.
    pub bound_m: f64,
    /// Largest of these bounds.
    pub worst_bound_m: f64,
}

impl ExpectedPositionErrors {
    /// Expected error from covariances of positions, `sqrt(mean tr P_p)` and bounds: theory.md §9 (40).
    fn from_covariances(errors: &[Matrix3<f64>], quantile: Quantile) -> Self {
        let count = errors.len().max(1) as f64;
        let bounds = errors.iter().map(|covariance| quantile.bound(covariance));
        ExpectedPositionErrors {
            sigma_m: (errors.iter().map(Matrix3::trace).sum::<f64>() / count).sqrt(),
            bound_m: bounds.clone().sum::<f64>() / count,
            worst_bound_m: bounds.fold(0.0, f64::max),
        }
    }
}

/// Expected error in a part of a joint's range, with the other joints anywhere in theirs.
#[derive(Clone, Debug, PartialEq)]
pub struct RangePart {
    /// Index of the joint.
    pub joint: usize,
    /// Lower and upper end, radians or metres.
    pub range: [f64; 2],
    /// Expected root mean square distance, metres.
    pub sigma_m: f64,
}

/// Expected errors of a robot's predictions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Expectations {
    /// In the measured configurations; `None` without an uncertainty.
    pub measured: Option<ExpectedPositionErrors>,
    /// Anywhere between the least and the largest measured value of each joint.
    pub sampled: Option<ExpectedPositionErrors>,
    /// Errors of the nominal model in the same configurations.
    pub nominal: Option<NominalError>,
    /// Anywhere within the limits.
    pub range: Option<ExpectedPositionErrors>,
    /// By parts of each joint's range.
    pub parts: Vec<RangePart>,
}

/// Share of the error in cross-validation, without stated noise, that expected errors contain at least.
const LEAST: f64 = 0.9;

/// Raises the model error of positions if the errors in cross-validation exceed the expected ones in the measured configurations: theory.md §9 (43b).
/// Returns true if it did.
fn raise(uncertainty: &mut Uncertainty, measured: ExpectedPositionErrors, left_out_m: f64) -> bool {
    let found = &mut uncertainty.discrepancy;
    // Residuals that stated noise or repeats explain are not errors of the robot.
    if found.attribution[Quantity::Position] != Attribution::Robot {
        return false;
    }
    let noise = found.noise[Quantity::Position];
    raise_to(uncertainty, measured, (LEAST * left_out_m).powi(2) - 3.0 * noise * noise)
}

/// Raises the model error of positions until this mean square (m²) is expected in the measured configurations. Returns true if it did.
fn raise_to(uncertainty: &mut Uncertainty, measured: ExpectedPositionErrors, square_m2: f64) -> bool {
    let missing = square_m2 - measured.sigma_m.powi(2);
    if !missing.is_finite() || missing <= 0.0 {
        return false;
    }
    let sigma = &mut uncertainty.discrepancy.standard_deviation[Quantity::Position];
    *sigma = (*sigma * *sigma + missing / 3.0).sqrt();
    true
}

impl Domain<'_> {
    /// Expectations of geometry alone if possible terms were tried and rejected: the expected error in the measured configurations is as large as
    /// with these terms.
    pub(crate) fn expectations_with_terms(
        &self,
        (uncertainty, found, with_terms): (&mut Uncertainty, &Expectations, &Expectations),
    ) -> Option<Expectations> {
        let (measured, other) = (found.measured?, with_terms.measured?);
        raise_to(uncertainty, measured, other.sigma_m.powi(2)).then(|| self.expectations(uncertainty))
    }

    /// [`Self::expectations`], with the model error raised to the error of positions in cross-validation (metres, RMS).
    pub(crate) fn expectations_beside(&self, uncertainty: &mut Uncertainty, left_out_m: Option<f64>) -> Expectations {
        let found = self.expectations(uncertainty);
        // Errors of pictures in metres are noise of their corners in a direction that these hardly determine; the robot's errors are estimated
        // separately.
        let pictures = &self.session.data.pictures;
        let is_seen = self.rows.iter().all(|row| pictures.index_of_row(*row).is_some());
        match found.measured.zip(left_out_m).filter(|_| !is_seen) {
            Some((measured, left_out_m)) if raise(uncertainty, measured, left_out_m) => self.expectations(uncertainty),
            _ => found,
        }
    }

    /// Expected errors of the predictions of some targets, from the fitted rows and from random configurations.
    fn expectations(&self, uncertainty: &Uncertainty) -> Expectations {
        let Session { robot, data, packed, .. } = *self.session;
        let count = if uncertainty.layout.dim() > MANY_UNKNOWNS { FEWER } else { CONFIGURATIONS };
        let sample = sample_rows(self.rows, count);
        let measured: Vec<f64> =
            sample.iter().flat_map(|&row| packed.joint_values(row as usize).iter().copied()).collect();
        let box_of_rows: Vec<[f64; 2]> = self.coverage.iter().map(|it| [it.sampled_min, it.sampled_max]).collect();
        let ranges = ranges(robot, self.coverage);
        let [inside, anywhere] = [&box_of_rows, &ranges].map(|it| draw_configurations(robot, it, count, self.seed));
        let quantile = uncertainty.quantiles()[Quantity::Position];
        let targets = data.targets.len().clamp(1, MOST_TARGETS);
        let of = |values: &[f64]| -> Vec<Vec<Matrix3<f64>>> {
            let packed = PackedValues::of_values(robot, values);
            (0..targets).map(|target| uncertainty.positions(&packed, target)).collect()
        };
        let errors = of(&anywhere);
        let sampled = ExpectedPositionErrors::from_covariances(&of(&inside).concat(), quantile);
        let nominal = NominalError::new(self, (uncertainty, sampled.sigma_m), (&inside, targets));
        Expectations {
            measured: Some(ExpectedPositionErrors::from_covariances(&of(&measured).concat(), quantile)),
            sampled: Some(sampled),
            nominal: Some(nominal),
            range: Some(ExpectedPositionErrors::from_covariances(&errors.concat(), quantile)),
            parts: range_parts(robot, &ranges, &anywhere, &errors),
        }
    }
}

/// Usable range of each joint: its limits; for a revolute joint at most a turn, about the middle of the sampled range; for a prismatic joint without
/// limits the sampled range.
fn ranges(robot: &Robot, coverage: &[JointCoverage]) -> Vec<[f64; 2]> {
    let half_turn = std::f64::consts::PI;
    let of = |(joint, coverage): (&Joint, &JointCoverage)| {
        let middle = 0.5 * (coverage.sampled_min + coverage.sampled_max);
        match (joint.kind, coverage.limit_min.zip(coverage.limit_max)) {
            (JointKind::Prismatic, Some((least, most))) => [least, most],
            (JointKind::Revolute, Some((least, most))) if most - least <= 2.0 * half_turn => [least, most],
            (JointKind::Prismatic, None) => [coverage.sampled_min, coverage.sampled_max],
            (JointKind::Revolute, _) => [middle - half_turn, middle + half_turn],
        }
    };
    robot.joints.iter().zip(coverage).map(of).collect()
}

/// Range of each reading that keeps all its joints in theirs: joints of one reading move together. Infinite for a reading that moves no joint.
pub(crate) fn allowed_readings(robot: &Robot, ranges: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let indices = robot.reading_indices();
    let readings = indices.iter().max().map_or(0, |last| last + 1);
    let mut allowed = vec![[f64::NEG_INFINITY, f64::INFINITY]; readings];
    for ((joint, &index), [lower, upper]) in robot.joints.iter().zip(&indices).zip(ranges) {
        let ends = [lower, upper].map(|value| (value - joint.reading.offset) / joint.reading.multiplier);
        if let Some(both) = allowed.get_mut(index).filter(|_| ends.iter().all(|end| end.is_finite())) {
            *both = [both[0].max(ends[0].min(ends[1])), both[1].min(ends[0].max(ends[1]))];
        }
    }
    allowed
}

/// Joint values of random readings that keep all joints in their ranges.
fn draw_configurations(robot: &Robot, ranges: &[[f64; 2]], count: usize, seed: u64) -> Vec<f64> {
    let indices = robot.reading_indices();
    let allowed = allowed_readings(robot, ranges);
    let mut generator = ChaCha8Rng::seed_from_u64(seed ^ 0x616e_7977);
    let mut values = Vec::with_capacity(count * ranges.len());
    for _ in 0..count {
        let readings: Vec<f64> = allowed
            .iter()
            .map(|[lower, upper]| lower + (upper - lower).max(0.0) * random::uniform_number(&mut generator))
            .map(|reading| if reading.is_finite() { reading } else { 0.0 })
            .collect();
        values.extend(robot.joints.iter().zip(&indices).map(|(joint, &index)| joint.reading.value(readings[index])));
    }
    values
}

/// Mean squares of the expected errors of all targets by parts of each joint's range.
fn range_parts(robot: &Robot, ranges: &[[f64; 2]], values: &[f64], errors: &[Vec<Matrix3<f64>>]) -> Vec<RangePart> {
    let joints = ranges.len();
    let mut parts = Vec::new();
    for (joint, &[lower, upper]) in ranges.iter().enumerate() {
        let width = (upper - lower) / PARTS as f64;
        if width <= 0.0 || robot.joints[joint].give_of.is_some() {
            continue;
        }
        for part in 0..PARTS {
            let from = lower + width * part as f64;
            let is_here = |values: &[f64]| (from..=from + width).contains(&values[joint]);
            let here = errors
                .iter()
                .flat_map(|errors| errors.iter().zip(values.chunks_exact(joints)))
                .filter(|(_, values)| is_here(values))
                .map(|(error, _)| error.trace());
            let count = here.clone().count();
            if count > 0 {
                let sigma_m = (here.sum::<f64>() / count as f64).sqrt();
                parts.push(RangePart { joint, range: [from, from + width], sigma_m });
            }
        }
    }
    parts
}
