//! The paper's calibrations from the nominal screws, with every formulation, traced by iteration.

use super::constraints::{WatchedProblem, WatchedState};
use super::seeds::{SeedPurpose, derive_seed};
use super::session::PaperSession;
use super::{ElbowRun, Iteration, LENGTH_M, MeasurementKind, NOISE, literal, tables};
use crate::{PaperFormulation, PaperResidual, gauss_newton};
use poecal_fit::problem::Problem;
use poecal_fit::state::Estimate;
use poecal_model::measurement::{Dataset, Noise, Quantity};
use poecal_numerics::error::Result;
use poecal_numerics::solve::{Options, Termination};

/// Measurements of each kind that a run fits.
const POSES: usize = 30;
const POINTS: usize = 100;

/// Iterations after which a run has failed.
const LIMIT: usize = 50;

/// RMS held-out error below which a noise-free run has reached the truth, metres.
const REACHED_M: f64 = 1e-9;

/// Multiple of the position noise within which a noisy run must predict.
const NOISY_FACTOR: f64 = 10.0;

/// Specification of a run.
#[derive(Clone, Copy)]
struct RunPlan {
    formulation: PaperFormulation,
    seen: MeasurementKind,
    offsets_in_truth: bool,
    noise: bool,
}

/// A run, and its final estimate.
pub(super) struct FinishedRun {
    pub(super) run: ElbowRun,
    pub(super) estimate: Estimate,
}

/// The truth of the experiment: the prescribed screws and point, with joint offsets or without.
pub(super) fn truth(offsets: bool) -> Estimate {
    let robot = tables::prescribed_robot();
    let mut truth = Estimate::new(&robot, vec![robot.home], poecal_arm::lie::Pose::identity());
    if offsets {
        truth = truth.with_offsets(&tables::PRESCRIBED_OFFSETS_DEG.map(f64::to_radians));
    }
    truth
}

/// All runs: every formulation, poses and points, with and without offsets and noise.
pub(super) fn runs(seed: u64) -> Result<Vec<FinishedRun>> {
    let mut runs = Vec::new();
    for seen in [MeasurementKind::Poses, MeasurementKind::Points] {
        for offsets_in_truth in [false, true] {
            for noise in [false, true] {
                for formulation in PaperFormulation::ALL {
                    runs.push(run(RunPlan { formulation, seen, offsets_in_truth, noise }, seed)?);
                }
            }
        }
    }
    Ok(runs)
}

/// The configurations of the runs of a kind, and the actual robot.
pub(super) fn session(offsets_in_truth: bool, seen: MeasurementKind, seed: u64) -> PaperSession {
    let count = match seen {
        MeasurementKind::Poses => POSES,
        MeasurementKind::Points => POINTS,
    };
    let seed = derive_seed(seed, SeedPurpose::Runs, 0);
    PaperSession::new(&tables::nominal_robot(), truth(offsets_in_truth), seen, count, seed)
}

/// One run by plain Gauss-Newton, with the paper's residual of poses.
fn run(plan: RunPlan, seed: u64) -> Result<FinishedRun> {
    let session = session(plan.offsets_in_truth, plan.seen, seed);
    let measured = if plan.noise {
        session.noisy_poses(NOISE, derive_seed(seed, SeedPurpose::RunNoise, 0))
    } else {
        session.exact_poses()
    };
    let data = session.data(PaperResidual::Spatial, &measured)?;
    let sigma = if plan.noise { NOISE } else { Noise::new(1.0, 1.0) };
    let free = session.free_parameters(plan.formulation);
    let problem = Problem::new(session.session_with_data(&data, LENGTH_M), session.rows(), free, sigma);
    let once = Options { iterations: 1, ..Options::default() };

    let mut state = WatchedState::new(session.start());
    let mut trace = vec![iteration(&session, &data, &state.estimate)];
    let termination = loop {
        let (next, _, summary) = gauss_newton(&WatchedProblem(&problem), state.clone(), &once);
        if summary.iterations == 0 || trace.len() > LIMIT {
            break summary.termination;
        }
        state = next;
        trace.push(iteration(&session, &data, &state.estimate));
        if !matches!(summary.termination, Termination::IterationLimit) {
            break summary.termination;
        }
    };
    let run = measures(&session, plan, &state, trace, (problem.layout().dim(), termination));
    Ok(FinishedRun { run, estimate: state.estimate })
}

/// Report of a run that ended.
fn measures(
    session: &PaperSession,
    plan: RunPlan,
    state: &WatchedState,
    trace: Vec<Iteration>,
    (unknowns, termination): (usize, Termination),
) -> ElbowRun {
    let estimate = &state.estimate;
    let held_out_rms_m = session.held_out_rms_m(estimate);
    let most = if plan.noise { NOISY_FACTOR * NOISE[Quantity::Position] } else { REACHED_M };
    let matrix = matrix(session, estimate, plan.formulation);
    let error = ScrewError::from_estimates(estimate, &session.truth);
    let equivalent = ScrewError::from_estimates(&estimate.without_offsets(), &session.truth.without_offsets());
    ElbowRun {
        formulation: plan.formulation,
        measurement: plan.seen,
        offsets_in_truth: plan.offsets_in_truth,
        noise: plan.noise,
        measurements: session.packed.rows(),
        iterations: trace.len() - 1,
        converged: termination.is_success() && held_out_rms_m < most,
        parameters: matrix.ncols(),
        rank: literal::singular_values(&matrix).1,
        unknowns,
        held_out_rms_m,
        screw_error_max: error.maximum(),
        screw_error_max_v_m: error.v_m,
        screw_error_max_omega: error.omega,
        equivalent_screw_error_max: equivalent.maximum(),
        equivalent_screw_error_max_v_m: equivalent.v_m,
        equivalent_screw_error_max_omega: equivalent.omega,
        constraint_miss_pitch_m: state.miss.pitch_m,
        constraint_miss_length: state.miss.length,
        offset_error_max_deg: plan.formulation.has_offsets().then(|| offset_error_deg(estimate, &session.truth)),
        trace,
    }
}

/// Residual and parameter error of an estimate.
fn iteration(session: &PaperSession, data: &Dataset, estimate: &Estimate) -> Iteration {
    let errors = session.session_with_data(data, LENGTH_M).errors(&session.rows(), estimate);
    let squares: f64 = errors.iter().map(|error| error.position_m().norm_squared()).sum();
    Iteration {
        residual_rms_m: (squares / errors.len() as f64).sqrt(),
        screw_error_max: ScrewError::from_estimates(estimate, &session.truth).maximum(),
    }
}

/// Largest differences of screws' coordinates.
#[derive(Clone, Copy, Default)]
struct ScrewError {
    v_m: f64,
    omega: f64,
}

impl ScrewError {
    fn from_estimates(found: &Estimate, truth: &Estimate) -> Self {
        let pairs = found.screws().into_iter().zip(truth.screws());
        pairs.fold(ScrewError::default(), |worst, (a, b)| ScrewError {
            v_m: worst.v_m.max((a.v() - b.v()).amax()),
            omega: worst.omega.max((a.w() - b.w()).amax()),
        })
    }

    fn maximum(self) -> f64 {
        self.v_m.max(self.omega)
    }
}

/// Largest difference of a joint offset, degrees, modulo whole turns.
fn offset_error_deg(found: &Estimate, truth: &Estimate) -> f64 {
    let offsets = [found.offsets(), truth.offsets()];
    let pairs = offsets[0].iter().zip(&offsets[1]);
    pairs.map(|(a, b)| (a - b).sin().atan2((a - b).cos()).abs().to_degrees()).fold(0.0, f64::max)
}

/// The paper's own matrix at an estimate, on the configurations of a session.
pub(super) fn matrix(
    session: &PaperSession,
    estimate: &Estimate,
    formulation: PaperFormulation,
) -> nalgebra::DMatrix<f64> {
    // Offsets belong to the joint values.
    let mut robot = session.nominal.with_screws(&estimate.screws());
    robot.home = estimate.base_from_target[0];
    let values = |row| {
        let nominal = session.packed.joint_values(row);
        nominal.iter().zip(&estimate.offsets()).map(|(value, offset)| value + offset).collect()
    };
    let values: Vec<Vec<f64>> = (0..session.packed.rows()).map(values).collect();
    literal::stack_matrices(&robot, &values, formulation, session.seen, LENGTH_M)
}
