//! Unknowns, start and priors of a fit of a model with compliant joints and terms.

use poecal_fit::analysis::ranges;
use poecal_fit::problem::TermPrior;
use poecal_fit::state::{Estimate, KinematicTree, Session, Unknowns};
use poecal_model::measurement::Dataset;
use poecal_model::robot::{CorrectionModel, Sizes};

/// Range of a joint's values in the fitted rows below which it has no term of its own value: jitter of encoders, radians.
const LEAST_RANGE_RAD: f64 = 0.02;

/// Prior standard deviation of each term of the groups.
pub(crate) fn priors(model: &CorrectionModel, sizes: &Sizes) -> Vec<TermPrior> {
    let each = model.terms().zip(model.deviations(sizes));
    each.map(|((joint, term), deviation)| TermPrior { joint, term, deviation }).collect()
}

/// Unknowns of a fit: those of the robot without compliant joints, and the terms of a size above 0.
pub fn unknowns(model: &CorrectionModel, of_geometry: &Unknowns, sizes: &Sizes) -> Unknowns {
    let place = |joint: usize| model.places.get(joint).copied().unwrap_or(joint);
    let own = of_geometry.terms.iter().map(|&(joint, term)| (place(joint), term.reindex(place)));
    let held = of_geometry.held_axes.iter().map(|&joint| place(joint));
    Unknowns {
        held_axes: held.chain(model.gives()).collect(),
        terms: own.chain(model.terms_of(sizes)).collect(),
        ..of_geometry.clone()
    }
}

/// The estimate of a robot without compliant joints, as an estimate of this model.
pub(crate) fn estimate(model: &CorrectionModel, found: &Estimate, data: &Dataset) -> Estimate {
    let tree = KinematicTree::from_robot(&model.robot, data);
    let targets = found.base_from_target.clone();
    let mut estimate = Estimate::from_placed(&model.robot, tree, targets, found.device_from_base);
    estimate.further_devices.clone_from(&found.further_devices);
    estimate.ranges.clone_from(&found.ranges);
    estimate.clocks.clone_from(&found.clocks);
    for (&place, frame) in model.places.iter().zip(&found.base_from_axis) {
        estimate.base_from_axis[place] = *frame;
    }
    for term in &found.terms {
        let place = |joint: usize| model.places.get(joint).copied().unwrap_or(joint);
        *estimate.coefficient_mut(place(term.joint), term.term.reindex(place)) = term.coefficient;
    }
    estimate
}

/// Marks each joint whose value changes among some rows.
pub(crate) fn moving_joints(session: &Session<'_>, rows: &[u32]) -> Vec<bool> {
    ranges(session, rows).into_iter().map(|(least, most)| most - least > LEAST_RANGE_RAD).collect()
}
