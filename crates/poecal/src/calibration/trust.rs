//! How far a calibration can be trusted: cross-validation, uncertainty of predictions and of each screw, and the effect of each correction.

use nalgebra::Matrix3;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::suspicion::{JointCorrection, suspicions};
use super::{CoverageCheck, Models};
use crate::analysis::{JointCoverage, PLAUSIBLE, coverage};
use crate::estimate::{Estimate, Packed, Session, rms_m, sample_rows};
use crate::gauge::{Deviation, screw_deviations};
use crate::measurement::Quantity;
use crate::problem::Layout;
use crate::robot::{Joint, JointKind, Robot};
use crate::simulate::random;
use crate::solve::Normal;
use crate::start::{Registration, register_again};
use crate::uncertainty::{
    Bootstrap, CrossValidation, Discrepancy, Quantile, Remainder, Uncertainty, View, bootstrap,
    cross_validate, discrepancy,
};

/// Number of random configurations within the joint range.
const CONFIGURATIONS: usize = 400;
/// Number of parts of each joint's range.
const PARTS: usize = 6;
/// Most targets over which expected errors are taken.
const MOST_TARGETS: usize = 12;
/// Rows by which the effect of each correction is computed.
const EFFECT_SAMPLE: usize = 300;

/// Expected errors of predicted positions, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expected {
    /// Root mean square distance.
    pub sigma_m: f64,
    /// Mean of the 95 % bounds.
    pub bound_m: f64,
    /// Largest of these.
    pub worst_bound_m: f64,
}

impl Expected {
    /// From covariances of positions, `sqrt(mean tr P_p)` and bounds: theory.md §9 (40).
    fn of(errors: &[Matrix3<f64>], quantile: Quantile) -> Self {
        let count = errors.len().max(1) as f64;
        let bounds = errors.iter().map(|covariance| quantile.bound(covariance));
        Expected {
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
    /// From and to, radians or metres.
    pub range: [f64; 2],
    /// Expected root mean square distance, metres.
    pub sigma_m: f64,
}

/// How far a calibration can be trusted.
///
/// ```
/// # use poecal::{CalibrationOptions, Kind, Simulation, calibrate, simulate::elbow};
/// # let made = Simulation { count: 40, ..Simulation::default() }.run(&elbow(), Kind::Pose)?;
/// # let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// let expected = calibration.trust.range.ok_or("too few rows")?;
/// println!("{:.3} mm (RMS) to be expected anywhere within the limits", expected.sigma_m * 1e3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Trust {
    /// Sampled part of each joint's range.
    pub coverage: Vec<JointCoverage>,
    /// Cross-validation; `None` with too few rows.
    pub cross_validation: Option<CrossValidation>,
    /// Covariance of the unknowns, and model error.
    pub uncertainty: Option<Uncertainty>,
    /// Bootstrap of predictions; `None` with too few rows.
    pub bootstrap: Option<Bootstrap>,
    /// Expected error in the measured configurations.
    pub measured: Option<Expected>,
    /// Expected error anywhere within the limits.
    pub range: Option<Expected>,
    /// Expected error by parts of each joint's range.
    pub parts: Vec<RangePart>,
    /// Coverage on the held-out rows; `None` without any.
    pub held_out: Option<CoverageCheck>,
    /// Correction of each joint.
    pub joints: Vec<JointCorrection>,
}

/// A finished fit.
pub(super) struct Finished<'a> {
    pub(super) view: View<'a>,
    pub(super) layout: &'a Layout,
    pub(super) normal: &'a Normal,
    pub(super) remainder: &'a Remainder,
    pub(super) models: &'a Models,
    pub(super) seed: u64,
}

/// Judges a finished fit.
pub(super) fn trust(finished: &Finished<'_>) -> Trust {
    let view = &finished.view;
    let Session { robot, data, packed, .. } = view.session;
    let cross_validation = cross_validate(view, finished.seed);
    let found = discrepancy(view, finished.normal, finished.remainder, cross_validation.as_ref());
    let uncertainty = uncertainty(finished, &found);
    let sample = sample_rows(view.rows, CONFIGURATIONS);
    let sampled: Vec<f64> =
        sample.iter().flat_map(|&row| packed.joint_values(row as usize).iter().copied()).collect();
    let coverage = coverage(&view.session, view.rows);
    let ranges = ranges(robot, &coverage);
    let anywhere = anywhere(robot, &ranges, finished.seed);
    let (mut measured, mut range, mut parts) = (None, None, Vec::new());
    if let Some(uncertainty) = &uncertainty {
        let quantile = uncertainty.quantiles()[Quantity::Position];
        let targets = data.targets.len().clamp(1, MOST_TARGETS);
        let of = |values: &[f64]| -> Vec<Vec<Matrix3<f64>>> {
            let packed = Packed::of_values(robot, values);
            (0..targets).map(|target| uncertainty.positions(&packed, target)).collect()
        };
        measured = Some(Expected::of(&of(&sampled).concat(), quantile));
        let errors = of(&anywhere);
        range = Some(Expected::of(&errors.concat(), quantile));
        parts = range_parts(&ranges, &anywhere, &errors);
    }
    Trust {
        joints: joints(finished, uncertainty.as_ref()),
        coverage,
        cross_validation,
        uncertainty,
        bootstrap: bootstrap(view, finished.seed),
        measured,
        range,
        parts,
        held_out: None,
    }
}

fn uncertainty(finished: &Finished<'_>, found: &Discrepancy) -> Option<Uncertainty> {
    let normal = finished.normal;
    if finished.remainder.numbers <= normal.dim() {
        return None;
    }
    Uncertainty::new(&finished.view, finished.layout.clone(), &normal.gram, found)
}

/// Usable range of each joint: its limits; of a revolute joint at most a turn, about the middle of the sampled range; of a prismatic joint
/// without limits the sampled range.
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

/// Joint values of random readings that keep all joints in their ranges: joints of one reading move together.
fn anywhere(robot: &Robot, ranges: &[[f64; 2]], seed: u64) -> Vec<f64> {
    let indices = robot.reading_indices();
    let readings = indices.iter().max().map_or(0, |last| last + 1);
    let mut allowed = vec![[f64::NEG_INFINITY, f64::INFINITY]; readings];
    for ((joint, &index), [lower, upper]) in robot.joints.iter().zip(&indices).zip(ranges) {
        let ends = [lower, upper].map(|value| (value - joint.reading.offset) / joint.reading.multiplier);
        if let Some(both) = allowed.get_mut(index).filter(|_| ends.iter().all(|end| end.is_finite())) {
            *both = [both[0].max(ends[0].min(ends[1])), both[1].min(ends[0].max(ends[1]))];
        }
    }
    let mut generator = ChaCha8Rng::seed_from_u64(seed ^ 0x616e_7977);
    let mut values = Vec::with_capacity(CONFIGURATIONS * ranges.len());
    for _ in 0..CONFIGURATIONS {
        let drawn: Vec<f64> = allowed
            .iter()
            .map(|[lower, upper]| lower + (upper - lower).max(0.0) * random::uniform(&mut generator))
            .map(|reading| if reading.is_finite() { reading } else { 0.0 })
            .collect();
        values.extend(
            robot.joints.iter().zip(&indices).map(|(joint, &index)| joint.reading.value(drawn[index])),
        );
    }
    values
}

/// Mean squares of the expected errors of all targets by parts of each joint's range.
fn range_parts(ranges: &[[f64; 2]], values: &[f64], errors: &[Vec<Matrix3<f64>>]) -> Vec<RangePart> {
    let joints = ranges.len();
    let mut parts = Vec::new();
    for (joint, &[lower, upper]) in ranges.iter().enumerate() {
        let width = (upper - lower) / PARTS as f64;
        if width <= 0.0 {
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

/// Correction of each joint with its uncertainty and effect.
fn joints(finished: &Finished<'_>, uncertainty: Option<&Uncertainty>) -> Vec<JointCorrection> {
    let view = &finished.view;
    let Session { robot, length_m, .. } = view.session;
    let calibrated = &finished.models.calibrated;
    let deviations = screw_deviations(calibrated, robot, finished.layout, length_m, view.session.base_free());
    let nominal: Vec<_> = robot.joints.iter().map(|joint| joint.screw).collect();
    let rows = sample_rows(view.rows, EFFECT_SAMPLE);
    let mut joints: Vec<JointCorrection> = deviations
        .into_iter()
        .enumerate()
        .map(|(joint, deviation)| {
            let (sigma_tilt_rad, sigma_shift_m) = sigmas(&deviation, uncertainty, length_m);
            let mut screws = calibrated.screws();
            screws[joint] = nominal[joint];
            let left = registered_again(finished, &rows, &calibrated.with_screws(&screws));
            JointCorrection {
                tilt_rad: deviation.tilt_rad,
                shift_m: deviation.shift_m,
                sigma_tilt_rad,
                sigma_shift_m,
                left_nominal_rms_m: rms_m(&view.session.errors(&rows, &left)),
                suspicious: None,
            }
        })
        .collect();
    let suspicions = suspicions(view, finished.normal, &joints);
    joints.iter_mut().zip(suspicions).for_each(|(joint, words)| joint.suspicious = words);
    joints
}

/// Standard deviations of tilt and shift; `None` where they exceed half of the uncertainty of a nominal model.
fn sigmas(
    deviation: &Deviation,
    uncertainty: Option<&Uncertainty>,
    length_m: f64,
) -> (Option<f64>, Option<f64>) {
    const DETERMINED: f64 = 0.5;
    let of = |rows: &[Vec<f64>; 3], most: f64| {
        let variance: f64 = rows.iter().map(|row| uncertainty.map_or(0.0, |it| it.variance(row))).sum();
        Some(variance.sqrt()).filter(|sigma| uncertainty.is_some() && *sigma < DETERMINED * most)
    };
    let tilt = of(&deviation.tilt_by_step, PLAUSIBLE);
    let shift = of(&deviation.shift_by_step, PLAUSIBLE * length_m);
    // The place of an axis of unknown direction means little.
    if tilt.is_some() && shift.is_some() { (tilt, shift) } else { (None, None) }
}

/// An estimate with tool and device frame refitted.
fn registered_again(finished: &Finished<'_>, rows: &[u32], start: &Estimate) -> Estimate {
    let view = &finished.view;
    let registration = Registration { session: view.session, rows, noise: view.noise, targets_free: true };
    register_again(&registration, start)
}
