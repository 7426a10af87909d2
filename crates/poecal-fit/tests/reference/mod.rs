//! Reference of the kernels: every measurement and parameter by its own formulas, row after row.

use nalgebra::{Matrix3, Vector3};
use poecal_arm::lie::{Pose, TargetTwist};
use poecal_fit::parameters::Parameter;
use poecal_fit::problem::Problem;
use poecal_fit::state::{Estimate, Linkage, RangeModel, RowChain};
use poecal_model::measurement::NUMBERS;
use poecal_numerics::solve::{LeastSquares as _, NormalEquations};

/// Calls `each` with the whitened Jacobian of the prediction (row-major) and residual of each row in turn (theory.md §4 (17)).
pub(crate) fn for_rows(
    problem: &Problem<'_>,
    state: &Estimate,
    rows: &[u32],
    mut each: impl FnMut(u32, &[f64], &[f64]),
) {
    let (n, session) = (problem.dim(), problem.session());
    let (linkage, mut chain) = (Linkage::new(state), RowChain::default());
    let mut twists = vec![(Vector3::zeros(), Vector3::zeros()); n];
    for &row in rows {
        let observation = &session.data.observations[row as usize];
        chain.evaluate(&linkage, session.packed, row as usize, observation);
        problem.layout().target_twists(&chain, observation.target, &mut twists);
        let seen_at = as_read(problem, state, &chain, &mut twists);
        let (mut residual, mut sensitivity) = ([0.0; NUMBERS], [[0.0; 6]; NUMBERS]);
        let seen = observation.measurement;
        match (observation.measurement.frame(), session.data.pose_residual) {
            (Some(pose), Some(other)) => {
                other.residual(&pose, &chain.target, &mut residual);
                other.sensitivity(&pose, &chain.target, &mut sensitivity);
            }
            _ => {
                seen.residual(&seen_at, &mut residual);
                seen.sensitivity(&seen_at, &mut sensitivity);
            }
        }
        let noise = problem.noise(row as usize);
        let mut jacobian = Vec::with_capacity(seen.dim() * n);
        for ((e, [a, b, c, p, q, r]), channel) in residual.iter_mut().zip(sensitivity).zip(seen.channels()) {
            let sigma = noise[channel.quantity];
            *e /= sigma;
            jacobian.extend(
                twists.iter().map(|(v, w)| (Vector3::new(a, b, c).dot(v) + Vector3::new(p, q, r).dot(w)) / sigma),
            );
        }
        each(row, &jacobian, &residual[..seen.dim()]);
    }
}

/// The target at the position that the zero and scale of its instrument yield, and the twists of all unknowns as motions of it (theory.md
/// §4 (15d)).
fn as_read(problem: &Problem<'_>, state: &Estimate, chain: &RowChain, twists: &mut [TargetTwist]) -> Pose {
    let range = state.range(chain.station);
    if range == RangeModel::default() {
        return chain.target;
    }
    let place = chain.target.translation;
    let direction = place.normalize();
    let along = direction * direction.transpose();
    let moved =
        Matrix3::identity() * (1.0 + range.scale) + (Matrix3::identity() - along) * (range.zero_m / place.norm());
    for (parameter, places) in problem.layout().parameters() {
        if !matches!(parameter, Parameter::RangeUnknown(_)) {
            places.iter().for_each(|&(at, _)| twists[at].0 = moved * twists[at].0);
        }
    }
    range.locate_target(&chain.target)
}

/// Normal information of a problem without a prior, theory.md §6 (28).
pub(crate) fn normal(problem: &Problem<'_>, state: &Estimate) -> NormalEquations {
    let mut normal = NormalEquations::new(problem.dim());
    for_rows(problem, state, problem.rows(), |_, jacobian, e| normal.add_rows(jacobian, e, 0));
    normal
}
