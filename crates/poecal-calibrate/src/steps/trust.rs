//! Trust in a calibration: cross-validation, uncertainty of predictions and of each screw, and the effect of each correction.

use super::changes::{joint_changes, sigmas};
use super::joint_correlations::{CommonDirection, common_directions, held_sigmas};
use super::summary::FitSummary;
use crate::CoverageCheck;
use crate::doubts::suspicion::{JointCorrection, suspicions};
use crate::trust::domain::Domain;
use crate::trust::expected_errors::Expectations;
use poecal_fit::analysis::{JointCoverage, coverage};
use poecal_fit::gauge::screw_deviations;
use poecal_fit::start::{Registration, register_again};
use poecal_fit::state::{Estimate, Session, rms_m, sample_rows};
use poecal_fit::uncertainty::{Bootstrap, CrossValidation, FitView, Shares, Uncertainty, bootstrap, discrepancy};
use poecal_model::measurement::Quantity;

/// Rows by which the effect of each correction is computed.
const EFFECT_SAMPLE: usize = 300;

/// Trust in a calibration.
///
/// ```
/// # use poecal_calibrate::CalibrationOptions;
/// # use poecal_model::measurement::SessionKind;
/// # use poecal_model::simulate::{Simulation, elbow};
/// # use poecal_calibrate::calibrate;
/// # let made = Simulation { count: 40, ..Simulation::default() }.run(&elbow(), SessionKind::POSE)?;
/// # let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// let expected = calibration.trust.expected.range.ok_or("too few rows")?;
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
    /// Expected errors.
    pub expected: Expectations,
    /// Coverage on the held-out rows; `None` without any.
    pub held_out: Option<CoverageCheck>,
    /// Correction of each joint.
    pub joints: Vec<JointCorrection>,
    /// Directions in which corrections of several joints are known only together; empty if each is known by itself.
    pub common: Vec<CommonDirection>,
}

/// Judges a finished fit, together with its cross-validation.
pub(crate) fn trust(
    view: &FitView<'_>,
    summary: &FitSummary,
    cross_validation: Option<CrossValidation>,
    (registered, seed): (&Estimate, u64),
) -> Trust {
    let FitSummary { layout, normal, remainder, .. } = summary;
    let found = discrepancy(view, normal, remainder, cross_validation.as_ref());
    let mut uncertainty =
        (remainder.numbers > normal.dim()).then(|| Uncertainty::new(view, layout.clone(), normal, &found)).flatten();
    let coverage = coverage(&view.session, view.rows);
    let left_out_m = cross_validation.as_ref().and_then(|found| found.random.rms.get(Quantity::Position));
    let domain = Domain {
        session: &view.session,
        rows: view.rows,
        coverage: &coverage,
        nominal: (view.session.robot, registered),
        seed,
    };
    let expected = uncertainty
        .as_mut()
        .map_or_else(Expectations::default, |uncertainty| domain.expectations_beside(uncertainty, left_out_m));
    let (joints, common) = joints(view, summary, uncertainty.as_ref());
    Trust {
        joints,
        common,
        coverage,
        cross_validation,
        uncertainty,
        bootstrap: bootstrap(view, seed),
        expected,
        held_out: None,
    }
}

/// Correction of each joint with its uncertainty and effect.
fn joints(
    view: &FitView<'_>,
    FitSummary { layout, normal, .. }: &FitSummary,
    uncertainty: Option<&Uncertainty>,
) -> (Vec<JointCorrection>, Vec<CommonDirection>) {
    let Session { robot, length_m, .. } = view.session;
    let calibrated = view.estimate;
    let deviations = screw_deviations(calibrated, robot, layout, length_m, view.session.base_free());
    let nominal: Vec<_> = robot.joints.iter().map(|joint| joint.screw).collect();
    let rows = sample_rows(view.rows, EFFECT_SAMPLE);
    let shares = Shares::new(view, &normal.gram, normal.dim());
    let from_data = |rows: &[Vec<f64>; 3]| shares.as_ref()?.of_measurements(rows);
    let changes = joint_changes(view, layout, uncertainty, &deviations);
    let held = uncertainty.map_or_else(|| vec![None; changes.len()], |it| held_sigmas(view, normal, it));
    let common = uncertainty.map(|it| common_directions(view, it, &changes, &held));
    let mut joints: Vec<JointCorrection> = deviations
        .into_iter()
        .zip(&changes)
        .enumerate()
        .map(|(joint, (deviation, (change, _)))| {
            let (sigma_tilt_rad, sigma_shift_m) =
                sigmas((&deviation.tilt_by_step, &deviation.shift_by_step), uncertainty, length_m);
            let mut screws = calibrated.screws();
            screws[joint] = nominal[joint];
            let left = registered_again(view, &rows, &calibrated.with_screws(&screws));
            JointCorrection {
                tilt_rad: deviation.tilt_rad,
                shift_m: deviation.shift_m,
                sigma_tilt_rad,
                sigma_shift_m,
                tilt_from_data: from_data(&deviation.tilt_by_step),
                shift_from_data: from_data(&deviation.shift_by_step),
                left_nominal_rms_m: rms_m(&view.session.errors(&rows, &left)),
                held: held.get(joint).copied().flatten(),
                change: *change,
                suspicious: None,
            }
        })
        .collect();
    let suspicions = suspicions(view, normal, &joints, uncertainty);
    joints.iter_mut().zip(suspicions).for_each(|(joint, words)| joint.suspicious = words);
    (joints, common.unwrap_or_default())
}

/// An estimate with tool and device frame refitted.
fn registered_again(view: &FitView<'_>, rows: &[u32], start: &Estimate) -> Estimate {
    let registration = Registration { session: view.session, rows, noise: view.noise, targets_free: true, prior: None };
    register_again(&registration, start)
}
