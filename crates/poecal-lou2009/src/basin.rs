//! Basin of convergence of each formulation.

use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;
use rayon::prelude::*;

use super::seeds::{SeedPurpose, derive_seed};
use super::session::PaperSession;
use super::{Basin, LENGTH_M, MeasurementKind, tables};
use crate::{Method, PaperFormulation, PaperResidual};
use poecal_arm::lie::Pose;
use poecal_fit::problem::Problem;
use poecal_fit::state::Estimate;
use poecal_model::measurement::Noise;
use poecal_model::simulate::Simulation;
use poecal_numerics::error::Result;
use poecal_numerics::solve::Options;

/// Configurations of a session.
const ROWS: usize = 60;
/// Angles by which every axis and the tip are displaced, degrees, and millimetres for each degree.
const ERRORS_DEG: [f64; 4] = [1.0, 5.0, 10.0, 20.0];
const MM_PER_DEG: f64 = 5.0;
/// Held-out error below which the truth is reached, metres.
const REACHED_M: f64 = 1e-6;
/// Iterations after which a fit has failed. Gauss-Newton that converges does so in a dozen.
const LIMIT: usize = 40;

/// Formulation and method.
const WAYS: [(PaperFormulation, Method); 6] = [
    (PaperFormulation::Adjoint, Method::GaussNewton),
    (PaperFormulation::Screw, Method::GaussNewton),
    (PaperFormulation::ScrewOffsets, Method::GaussNewton),
    (PaperFormulation::AdjointOffsets, Method::GaussNewton),
    (PaperFormulation::Adjoint, Method::LevenbergMarquardt),
    (PaperFormulation::Screw, Method::LevenbergMarquardt),
];

/// Shares of noise-free fits that reach the truth, for each formulation, kind of measurement and size of error.
pub(super) fn basin(trials: usize, seed: u64) -> Result<Vec<Basin>> {
    let mut found = Vec::new();
    for seen in [MeasurementKind::Poses, MeasurementKind::Points] {
        let mut by_error = Vec::new();
        for error_deg in ERRORS_DEG {
            let reached: Vec<[bool; WAYS.len()]> = (0..trials as u64)
                .into_par_iter()
                .map(|trial| reaching_methods(seen, error_deg, seed, trial))
                .collect::<Result<_>>()?;
            by_error.push((error_deg, reached));
        }
        for (way, (formulation, method)) in WAYS.into_iter().enumerate() {
            for (error_deg, reached) in &by_error {
                let count = reached.iter().filter(|reached| reached[way]).count();
                found.push(Basin {
                    formulation,
                    measurement: seen,
                    residual: residual(seen, method).word().to_owned(),
                    method: method.word().to_owned(),
                    error_deg: *error_deg,
                    error_mm: error_deg * MM_PER_DEG,
                    trials,
                    share: count as f64 / trials as f64,
                });
            }
        }
    }
    Ok(found)
}

/// The paper's residual of poses belongs to the paper's method. Points have only one residual.
fn residual(seen: MeasurementKind, method: Method) -> PaperResidual {
    match (seen, method) {
        (MeasurementKind::Poses, Method::GaussNewton) => PaperResidual::Spatial,
        (MeasurementKind::Poses, Method::LevenbergMarquardt) | (MeasurementKind::Points, _) => PaperResidual::Tool,
    }
}

/// Marks the formulations and methods that reach a random truth from the nominal elbow.
fn reaching_methods(seen: MeasurementKind, error_deg: f64, seed: u64, trial: u64) -> Result<[bool; WAYS.len()]> {
    let nominal = tables::nominal_robot();
    let simulation = Simulation {
        error_rotation_rad: error_deg.to_radians(),
        error_position_m: error_deg * MM_PER_DEG * 1e-3,
        ..Simulation::default()
    };
    let mut generator = ChaCha8Rng::seed_from_u64(derive_seed(seed, SeedPurpose::Truth, trial));
    let actual = simulation.perturb(&nominal, &mut generator);
    let truth = Estimate::new(&actual, vec![actual.home], Pose::identity());
    let session = PaperSession::new(&nominal, truth, seen, ROWS, derive_seed(seed, SeedPurpose::TruthRows, trial));
    // A radian counts as the length of the arm that it moves, so that neither outweighs the other.
    let noise = Noise::new(LENGTH_M, 1.0);
    let exact = session.exact_poses();
    let mut reached = [false; WAYS.len()];
    for (reached, (formulation, method)) in reached.iter_mut().zip(WAYS) {
        let data = session.data(residual(seen, method), &exact)?;
        let free = session.free_parameters(formulation);
        let problem = Problem::new(session.session_with_data(&data, LENGTH_M), session.rows(), free, noise);
        let options = Options { iterations: LIMIT, ..Options::default() };
        let (found, _, _) = (method.minimize())(&problem, session.start(), &options);
        *reached = session.held_out_rms_m(&found) < REACHED_M;
    }
    Ok(reached)
}
