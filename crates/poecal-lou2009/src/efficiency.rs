//! Many noisy sessions: ratio of each formulation's error to the least error that the data allow.

use rayon::prelude::*;

use super::seeds::{SeedPurpose, derive_seed};
use super::session::PaperSession;
use super::{Efficiency, LENGTH_M, MeasurementKind, NOISE, runs, tables};
use crate::{Method, PaperFormulation, PaperResidual};
use nalgebra::{DMatrix, DVector, Vector3};
use poecal_arm::lie::TargetTwist;
use poecal_fit::problem::Problem;
use poecal_fit::state::{Linkage, RowChain};
use poecal_numerics::error::Result;
use poecal_numerics::solve::{LeastSquares, Options};

/// Configurations of a session.
const ROWS: usize = 40;
/// Iterations after which a fit has failed.
const LIMIT: usize = 60;

/// Compared items: formulation, residual of poses, method.
type ComparedMethod = (PaperFormulation, PaperResidual, Method);

const WAYS: [ComparedMethod; 9] = [
    (PaperFormulation::Adjoint, PaperResidual::Tool, Method::GaussNewton),
    (PaperFormulation::Screw, PaperResidual::Tool, Method::GaussNewton),
    (PaperFormulation::ScrewOffsets, PaperResidual::Tool, Method::GaussNewton),
    (PaperFormulation::AdjointOffsets, PaperResidual::Tool, Method::GaussNewton),
    (PaperFormulation::Adjoint, PaperResidual::Spatial, Method::GaussNewton),
    (PaperFormulation::Screw, PaperResidual::Spatial, Method::GaussNewton),
    (PaperFormulation::ScrewOffsets, PaperResidual::Spatial, Method::GaussNewton),
    (PaperFormulation::AdjointOffsets, PaperResidual::Spatial, Method::GaussNewton),
    (PaperFormulation::Adjoint, PaperResidual::Tool, Method::LevenbergMarquardt),
];

/// All comparisons: one session of configurations for each kind of measurement, with new noise in every trial, the same for every combination.
pub(super) fn efficiency(trials: usize, seed: u64) -> Result<Vec<Efficiency>> {
    let mut found = Vec::new();
    for seen in [MeasurementKind::Poses, MeasurementKind::Points] {
        // Points have only one residual.
        let is_own = |way: &ComparedMethod| seen == MeasurementKind::Poses || way.1 == PaperResidual::Tool;
        let ways: Vec<ComparedMethod> = WAYS.into_iter().filter(is_own).collect();
        let rows_seed = derive_seed(seed, SeedPurpose::Fits, 0);
        let session = PaperSession::new(&tables::nominal_robot(), runs::truth(false), seen, ROWS, rows_seed);
        let (bound_rms_m, unknowns) = bound(&session)?;
        let trials: Vec<Vec<Option<f64>>> = (0..trials as u64)
            .into_par_iter()
            .map(|trial| fits(&session, &ways, derive_seed(seed, SeedPurpose::FitNoise, trial)))
            .collect::<Result<_>>()?;
        for (k, &way) in ways.iter().enumerate() {
            let ends: Vec<Option<f64>> = trials.iter().map(|ends| ends[k]).collect();
            found.push(summary(seen, way, &ends, bound_rms_m, unknowns));
        }
    }
    Ok(found)
}

/// Squared held-out errors of one noisy session fitted by every combination; `None` for a fit that did not end.
fn fits(session: &PaperSession, ways: &[ComparedMethod], seed: u64) -> Result<Vec<Option<f64>>> {
    let measured = session.noisy_poses(NOISE, seed);
    let tool = session.data(PaperResidual::Tool, &measured)?;
    let spatial = session.data(PaperResidual::Spatial, &measured)?;
    let fit = |&(formulation, residual, method): &ComparedMethod| {
        let data = if residual == PaperResidual::Tool { &tool } else { &spatial };
        let free = session.free_parameters(formulation);
        let problem = Problem::new(session.session_with_data(data, LENGTH_M), session.rows(), free, NOISE);
        let options = Options { iterations: LIMIT, ..Options::default() };
        let (found, _, summary) = (method.minimize())(&problem, session.start(), &options);
        summary.termination.is_success().then(|| session.held_out_rms_m(&found).powi(2))
    };
    Ok(ways.iter().map(fit).collect())
}

/// Summary of the fits of one combination.
fn summary(
    seen: MeasurementKind,
    way: ComparedMethod,
    ends: &[Option<f64>],
    bound_rms_m: f64,
    unknowns: usize,
) -> Efficiency {
    let squares: Vec<f64> = ends.iter().flatten().copied().collect();
    let count = squares.len() as f64;
    // NaN without any fit.
    let mean = squares.iter().sum::<f64>() / count;
    let variance = squares.iter().map(|square| (square - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
    let least = 1.0 / (2.0 * unknowns as f64 * count).sqrt();
    let scatter = (0.5 * (variance / count).sqrt() / mean).max(least);
    let (formulation, residual, method) = way;
    let ratio = mean.sqrt() / bound_rms_m;
    Efficiency {
        formulation,
        measurement: seen,
        residual: residual.word().to_owned(),
        method: method.word().to_owned(),
        trials: ends.len(),
        converged: squares.len(),
        held_out_rms_m: mean.sqrt(),
        bound_rms_m,
        ratio,
        ratio_sigma: ratio * scatter,
    }
}

/// The least RMS error of predicted positions for any unbiased estimator, metres: `tr(J N⁻¹ Jᵀ)` at the truth, N being the information of the minimal
/// basis from measurements with this noise. It is returned with the number of unknowns.
fn bound(session: &PaperSession) -> Result<(f64, usize)> {
    let data = session.data(PaperResidual::Tool, &session.exact_poses())?;
    let free = session.free_parameters(PaperFormulation::Adjoint);
    let problem = Problem::new(session.session_with_data(&data, LENGTH_M), session.rows(), free, NOISE);
    let n = problem.dim();
    let upper = problem.normal(&session.truth).gram;
    let gram = DMatrix::from_fn(n, n, |a, b| upper[a.min(b) * n + a.max(b)]);
    let Some(factor) = gram.cholesky() else { return Ok((f64::INFINITY, n)) };
    let linkage = Linkage::new(&session.truth);
    let mut chain = RowChain::default();
    let mut twists: Vec<TargetTwist> = vec![(Vector3::zeros(), Vector3::zeros()); n];
    // Variance of the predicted position, summed over unseen configurations and coordinates.
    let mut sum = 0.0;
    for row in 0..session.unseen.rows() {
        chain.evaluate(&linkage, &session.unseen, row, 0);
        problem.layout().target_twists(&chain, 0, &mut twists);
        for axis in 0..3 {
            let derivative = DVector::from_iterator(n, twists.iter().map(|(v, _)| v[axis]));
            sum += factor.solve(&derivative).dot(&derivative);
        }
    }
    Ok(((sum / session.unseen.rows() as f64).sqrt(), n))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_any_fit_there_is_no_ratio() {
        let none = summary(MeasurementKind::Poses, WAYS[0], &[None, None], 1e-5, 30);
        assert!(none.converged == 0 && none.ratio.is_nan() && none.held_out_rms_m.is_nan());
        let some = summary(MeasurementKind::Poses, WAYS[0], &[Some(4e-10), None], 1e-5, 30);
        assert!((some.ratio - 2.0).abs() < 1e-12 && (some.ratio_sigma - 2.0 / 60_f64.sqrt()).abs() < 1e-12);
        assert!(!some.exceeds(&none) && !none.exceeds(&some));
    }
}
