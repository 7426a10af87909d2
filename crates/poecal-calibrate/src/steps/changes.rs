//! The correction of each joint in parts, with directions and standard deviations.

use nalgebra::Vector3;

use poecal_fit::analysis::PLAUSIBLE;
use poecal_fit::gauge::{ScrewDeviation, screw_motions};
use poecal_fit::problem::Layout;
use poecal_fit::state::Session;
use poecal_fit::uncertainty::{FitView, Uncertainty};
use poecal_model::offsets::{ChangeBySteps, Changes, EndConstraint, JointChange};
use poecal_model::robot::{Joint, JointKind, Robot};

/// Standard deviations, as shares of those of a nominal model, up to which a quantity is determined.
const DETERMINED: f64 = 0.5;

/// Derivatives of a vector by each scaled unknown: three rows.
type VectorDerivatives = [Vec<f64>; 3];

/// Standard deviations of tilt and shift; `None` if they exceed half of the uncertainty of a nominal model.
pub(crate) fn sigmas(
    (tilt, shift): (&VectorDerivatives, &VectorDerivatives),
    uncertainty: Option<&Uncertainty>,
    length_m: f64,
) -> (Option<f64>, Option<f64>) {
    let tilt = sigma(tilt, uncertainty, PLAUSIBLE);
    let shift = sigma(shift, uncertainty, PLAUSIBLE * length_m);
    // The position of an axis of unknown direction is not meaningful.
    if tilt.is_some() && shift.is_some() { (tilt, shift) } else { (None, None) }
}

/// Standard deviation of a number or vector, whose nominal model is uncertain by `most`.
fn sigma(rows: &[Vec<f64>], uncertainty: Option<&Uncertainty>, most: f64) -> Option<f64> {
    let uncertainty = uncertainty?;
    let variance: f64 = rows.iter().map(|row| uncertainty.variance(row)).sum();
    Some(variance.sqrt()).filter(|sigma| *sigma < DETERMINED * most)
}

/// The correction of each joint, with its derivatives by the unknowns. In a robot with branches offsets are not separated from the axes.
pub(crate) fn joint_changes(
    view: &FitView<'_>,
    layout: &Layout,
    uncertainty: Option<&Uncertainty>,
    deviations: &[ScrewDeviation],
) -> Vec<(JointChange, ChangeBySteps)> {
    let session = &view.session;
    let Session { robot: nominal, length_m, .. } = *session;
    let calibrated = view.estimate;
    let actual = Robot { terms: calibrated.terms.clone(), ..nominal.with_screws(&calibrated.screws()) };
    let base = if session.base_free() { EndConstraint::Free } else { EndConstraint::Kept };
    let Ok(changes) = Changes::from_robots(nominal, &actual, base) else {
        let joints = nominal.joints.iter().zip(&actual.joints).zip(deviations);
        let of = |(pair, deviation): (_, &ScrewDeviation)| {
            let by_steps = ChangeBySteps {
                offset: vec![0.0; layout.dim()],
                tilt: deviation.tilt_by_step.clone(),
                shift: deviation.shift_by_step.clone(),
            };
            (of_axis(pair, deviation, uncertainty, length_m), by_steps)
        };
        return joints.map(of).collect();
    };
    let by_steps = changes.by_steps(&screw_motions(calibrated, layout));
    let with_sigmas = |(change, by_steps): (&JointChange, ChangeBySteps)| {
        let (sigma_tilt, sigma_shift) = sigmas((&by_steps.tilt, &by_steps.shift), uncertainty, length_m);
        let most = if change.kind == JointKind::Revolute { PLAUSIBLE } else { PLAUSIBLE * length_m };
        let change = JointChange {
            sigma_offset: sigma(std::slice::from_ref(&by_steps.offset), uncertainty, most),
            sigma_tilt,
            sigma_shift,
            is_estimated: uncertainty.is_some(),
            ..*change
        };
        (change, by_steps)
    };
    changes.joints.iter().zip(by_steps).map(with_sigmas).collect()
}

/// The correction of an axis alone.
fn of_axis(
    (nominal, actual): (&Joint, &Joint),
    deviation: &ScrewDeviation,
    uncertainty: Option<&Uncertainty>,
    length_m: f64,
) -> JointChange {
    let by_steps = (&deviation.tilt_by_step, &deviation.shift_by_step);
    let (sigma_tilt, sigma_shift) = sigmas(by_steps, uncertainty, length_m);
    let at = actual.screw.nearest_point(&nominal.frame.translation);
    let shift = match actual.kind {
        JointKind::Revolute => at - nominal.frame.translation,
        JointKind::Prismatic => Vector3::zeros(),
    };
    let across = nominal.screw.direction().cross(&actual.screw.direction());
    JointChange {
        kind: actual.kind,
        at,
        offset: None,
        tilt: across.try_normalize(0.0).map_or_else(Vector3::zeros, |axis| axis * deviation.tilt_rad),
        shift,
        sigma_offset: None,
        sigma_tilt,
        sigma_shift,
        is_estimated: uncertainty.is_some(),
    }
}
