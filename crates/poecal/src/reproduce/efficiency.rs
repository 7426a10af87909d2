//! Many noisy sessions: how near each formulation comes to the least error that the data allow.

use rayon::prelude::*;

use super::session::Session;
use super::{Efficiency, LENGTH_M, NOISE, Seen, runs, tables};
use crate::error::Result;
use crate::estimate::{Chain, Estimate, Linkage};
use crate::lie::TargetTwist;
use crate::linalg;
use crate::measurement::PoseResidual;
use crate::parameters::Formulation;
use crate::problem::Problem;
use crate::solve::{LeastSquares, Method, Options, minimize};
use nalgebra::Vector3;

/// Configurations of a session.
const ROWS: usize = 60;
/// Iterations after which a fit has failed.
const LIMIT: usize = 60;

/// What is compared: formulation, residual of poses, method.
type Way = (Formulation, PoseResidual, Method);

const POSE_WAYS: [Way; 9] = [
    (Formulation::Adjoint, PoseResidual::Tool, Method::GaussNewton),
    (Formulation::Screw, PoseResidual::Tool, Method::GaussNewton),
    (Formulation::ScrewOffsets, PoseResidual::Tool, Method::GaussNewton),
    (Formulation::AdjointOffsets, PoseResidual::Tool, Method::GaussNewton),
    (Formulation::Adjoint, PoseResidual::Spatial, Method::GaussNewton),
    (Formulation::Screw, PoseResidual::Spatial, Method::GaussNewton),
    (Formulation::ScrewOffsets, PoseResidual::Spatial, Method::GaussNewton),
    (Formulation::AdjointOffsets, PoseResidual::Spatial, Method::GaussNewton),
    (Formulation::Adjoint, PoseResidual::Tool, Method::LevenbergMarquardt),
];

/// Points have one residual only.
const POINT_WAYS: [Way; 5] = [
    (Formulation::Adjoint, PoseResidual::Tool, Method::GaussNewton),
    (Formulation::Screw, PoseResidual::Tool, Method::GaussNewton),
    (Formulation::ScrewOffsets, PoseResidual::Tool, Method::GaussNewton),
    (Formulation::AdjointOffsets, PoseResidual::Tool, Method::GaussNewton),
    (Formulation::Adjoint, PoseResidual::Tool, Method::LevenbergMarquardt),
];

/// All comparisons: one session of configurations for each kind of measurement, its noise drawn anew in every trial.
pub(super) fn efficiency(trials: usize, seed: u64) -> Result<Vec<Efficiency>> {
    let mut found = Vec::new();
    for (seen, ways) in [(Seen::Poses, &POSE_WAYS[..]), (Seen::Points, &POINT_WAYS[..])] {
        let session = Session::new(&tables::nominal(), runs::truth(false), seen, ROWS, seed ^ 0x6372);
        let bound_rms_m = bound_rms_m(&session)?;
        for &way in ways {
            found.push(one(&session, way, trials, bound_rms_m)?);
        }
    }
    Ok(found)
}

fn one(session: &Session, way: Way, trials: usize, bound_rms_m: f64) -> Result<Efficiency> {
    let (formulation, residual, method) = way;
    let ends: Vec<Option<f64>> =
        (0..trials as u64).into_par_iter().map(|trial| fit(session, way, trial)).collect::<Result<_>>()?;
    let errors: Vec<f64> = ends.into_iter().flatten().collect();
    let squares: f64 = errors.iter().map(|error| error * error).sum();
    let held_out_rms_m = (squares / errors.len().max(1) as f64).sqrt();
    Ok(Efficiency {
        formulation,
        measurement: session.seen,
        residual: residual.word().to_owned(),
        method: method.word().to_owned(),
        trials,
        converged: errors.len(),
        held_out_rms_m,
        bound_rms_m,
        ratio: held_out_rms_m / bound_rms_m,
    })
}

/// RMS held-out error of one noisy fit, or nothing if it did not end.
fn fit(session: &Session, (formulation, residual, method): Way, trial: u64) -> Result<Option<f64>> {
    let data = session.data(residual, Some((NOISE, trial)))?;
    let free = session.free(formulation);
    let problem = Problem::new(&data, &session.packed, session.rows(), free, NOISE, LENGTH_M);
    let options = Options { method, iterations: LIMIT, ..Options::default() };
    let (found, _, summary) = minimize(&problem, session.start(), &options);
    Ok(summary.termination.is_success().then(|| session.held_out_rms_m(&found)))
}

/// The least RMS error of predicted positions that an unbiased estimator can have, metres: `tr(J N⁻¹ Jᵀ)` at the truth, N being the
/// information of the minimal basis about what a device with this noise sees.
fn bound_rms_m(session: &Session) -> Result<f64> {
    let data = session.data(PoseResidual::Tool, None)?;
    let free = session.free(Formulation::Adjoint);
    let problem = Problem::new(&data, &session.packed, session.rows(), free, NOISE, LENGTH_M);
    let n = problem.dim();
    let Some(factor) = linalg::cholesky(&problem.normal(&session.truth).gram, n, 0.0) else {
        return Ok(f64::INFINITY);
    };
    Ok((variance(session, &problem, &session.truth, |row| {
        row.iter().zip(linalg::cholesky_solve(&factor, row)).map(|(a, b)| a * b).sum()
    }) / session.unseen.rows() as f64)
        .sqrt())
}

/// Sum over unseen configurations and coordinates of the variance of the predicted position.
fn variance(
    session: &Session,
    problem: &Problem<'_>,
    truth: &Estimate,
    of_row: impl Fn(&[f64]) -> f64,
) -> f64 {
    let linkage = Linkage::new(truth);
    let mut chain = Chain::default();
    let mut twists: Vec<TargetTwist> = vec![(Vector3::zeros(), Vector3::zeros()); problem.dim()];
    let mut sum = 0.0;
    for row in 0..session.unseen.rows() {
        chain.evaluate(&linkage, &session.unseen, row, 0);
        problem.layout().target_twists(&chain, 0, &mut twists);
        for axis in 0..3 {
            let derivative: Vec<f64> = twists.iter().map(|(v, _)| v[axis]).collect();
            sum += of_row(&derivative);
        }
    }
    sum
}
