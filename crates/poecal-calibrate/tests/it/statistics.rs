//! With noise, the error of predictions attains the Cramér-Rao bound.

use nalgebra::{DMatrix, DVector, Vector3};
use poecal_arm::lie::rotation;
use poecal_calibrate::{CalibrationOptions, calibrate};
use poecal_fit::parameters::{Parameter, ScrewAxis, TargetFrame, TargetPlace};
use poecal_fit::problem::{Layout, Problem};
use poecal_fit::state::{Estimate, Linkage, PackedValues, RowChain, Session};
use poecal_model::measurement::{Dataset, Noise, Quantity};
use poecal_model::robot::Robot;
use poecal_model::simulate::{SessionKind, Simulation, SimulationResult, elbow, random_configuration};
use poecal_numerics::solve::LeastSquares;
use poecal_testing::trials::{Trials, trials};
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;
use rayon::prelude::*;

const RUNS: usize = 1000;
/// Configurations fitted, and other ones predicted.
const FITTED: usize = 60;
const PREDICTED: usize = 50;
const NOISE: Noise = Noise::new(5e-5, 2e-4);
/// Largest deviation from the bound in that many runs: chance alone causes some 1 % of it.
const TOLERANCE: f64 = 0.05;
/// Standard deviation of one run's mean square over the bound: 1 % times √1,000.
const OF_ONE_RUN: f64 = 0.32;
/// Metres per radian; any value serves.
const LENGTH_M: f64 = 0.5;

/// Mean squared error of position (m²) and rotation (rad²).
type Squares = (f64, f64);

/// All screws and the target; the device's frame is redundant with them.
fn parameters(robot: &Robot, kind: SessionKind) -> Vec<Parameter> {
    let screws = robot.joints.iter().enumerate();
    let mut free: Vec<Parameter> =
        screws.map(|(joint, it)| Parameter::ScrewAxis(ScrewAxis { joint, kind: it.kind })).collect();
    free.push(if kind == SessionKind::POINT {
        Parameter::TargetPlace(TargetPlace { target: 0 })
    } else {
        Parameter::TargetFrame(TargetFrame::new(0))
    });
    free
}

/// The least mean squares of prediction errors that any unbiased estimator can have: `tr(J_h N⁻¹ J_hᵀ)` at the truth.
fn bound(truth: &Estimate, data: &Dataset, unseen: &PackedValues, robot: &Robot, kind: SessionKind) -> Squares {
    let packed = PackedValues::new(robot, data.all_readings(), robot.joints.len());
    let session = Session::new(robot, data, &packed, false).with_length(LENGTH_M);
    let rows = (0..FITTED as u32).collect();
    let problem = Problem::new(session, rows, parameters(robot, kind), NOISE);
    let (n, gram) = (problem.dim(), problem.normal(truth).gram);
    let information = DMatrix::from_fn(n, n, |i, j| gram[i.min(j) * n + i.max(j)]);
    let covariance = information.cholesky().unwrap().inverse();
    let (linkage, mut chain) = (Linkage::new(truth), RowChain::default());
    let mut sums = (0.0, 0.0);
    for row in 0..unseen.rows() {
        chain.evaluate(&linkage, unseen, row, 0);
        let (v, w) = sensitivities(problem.layout(), &chain);
        let variance = |j: &[DVector<f64>; 3]| j.iter().map(|row| row.dot(&(&covariance * row))).sum::<f64>();
        sums.0 += variance(&v) / unseen.rows() as f64;
        sums.1 += variance(&w) / unseen.rows() as f64;
    }
    sums
}

/// Derivatives of the target's position and orientation by all unknowns: three rows each.
fn sensitivities(layout: &Layout, chain: &RowChain) -> ([DVector<f64>; 3], [DVector<f64>; 3]) {
    let zero = || std::array::from_fn(|_| DVector::zeros(layout.dim()));
    let (mut shift, mut turn): ([DVector<f64>; 3], [DVector<f64>; 3]) = (zero(), zero());
    for (parameter, places) in layout.parameters() {
        let mut twists = vec![(Vector3::zeros(), Vector3::zeros()); places.len()];
        parameter.model().target_twists(chain, 0, &mut twists);
        for ((v, w), &(place, scale)) in twists.iter().zip(places) {
            for k in 0..3 {
                shift[k][place] = v[k] / scale;
                turn[k][place] = w[k] / scale;
            }
        }
    }
    (shift, turn)
}

/// Mean squared difference of two models' predictions in the device's frame.
fn difference(a: &Estimate, b: &Estimate, unseen: &PackedValues) -> Squares {
    let (a, b) = (Linkage::new(a), Linkage::new(b));
    let (mut at_a, mut at_b) = (RowChain::default(), RowChain::default());
    let mut sums = (0.0, 0.0);
    for row in 0..unseen.rows() {
        at_a.evaluate(&a, unseen, row, 0);
        at_b.evaluate(&b, unseen, row, 0);
        let shift = at_a.target.translation - at_b.target.translation;
        let turn = rotation::log(&(at_a.target.rotation * at_b.target.rotation.transpose()));
        sums.0 += shift.norm_squared() / unseen.rows() as f64;
        sums.1 += turn.norm_squared() / unseen.rows() as f64;
    }
    sums
}

fn truth(made: &SimulationResult) -> Estimate {
    Estimate::new(&made.actual, vec![made.actual.home], made.device_from_base)
}

/// One calibration with default settings, and its Cramér-Rao bound.
fn run(kind: SessionKind, seed: u64) -> (Squares, Squares) {
    let simulation = Simulation {
        noise_position_m: NOISE[Quantity::Position],
        noise_rotation_rad: NOISE[Quantity::Rotation],
        count: FITTED,
        seed,
        ..Simulation::default()
    };
    let made = simulation.run(&elbow(), kind).unwrap();
    let options = CalibrationOptions { held_out: Some(0.0), tolerance: None, ..Default::default() };
    let result = calibrate(&made.nominal, &made.data, &options).unwrap();
    let mut generator = ChaCha8Rng::seed_from_u64(seed ^ 0xabcd);
    let readings: Vec<f64> = (0..PREDICTED).flat_map(|_| random_configuration(&made.nominal, &mut generator)).collect();
    let unseen = PackedValues::new(&made.nominal, &readings, made.nominal.joints.len());
    let truth = truth(&made);
    (difference(&result.models.calibrated, &truth, &unseen), bound(&truth, &made.data, &unseen, &made.actual, kind))
}

/// Compares root mean squares over all runs, in millionths.
fn judge(what: &str, runs: Trials, found: f64, allowed: f64) {
    let ratio = found / allowed;
    println!(
        "{what}: {:.2}, bound {:.2}, mean square × {ratio:.4} in {} runs",
        found.sqrt() * 1e6,
        allowed.sqrt() * 1e6,
        runs.count
    );
    assert!((ratio - 1.0).abs() < TOLERANCE + runs.tolerance_factor(OF_ONE_RUN));
}

/// Mean squared errors over all runs, and mean bounds.
fn runs(kind: SessionKind) -> (Trials, Squares, Squares) {
    let runs = trials(RUNS);
    let all: Vec<(Squares, Squares)> = runs.seeds().into_par_iter().map(|seed| run(kind, seed)).collect();
    let mean = |value: fn(&(Squares, Squares)) -> f64| all.iter().map(value).sum::<f64>() / runs.count as f64;
    let found = (mean(|it| it.0.0), mean(|it| it.0.1));
    let allowed = (mean(|it| it.1.0), mean(|it| it.1.1));
    (runs, found, allowed)
}

#[test]
fn errors_of_pose_calibrations_are_at_the_bound() {
    let (runs, found, allowed) = runs(SessionKind::POSE);
    judge("poses, position (µm)", runs, found.0, allowed.0);
    judge("poses, rotation (µrad)", runs, found.1, allowed.1);
}

/// Points do not determine the target's orientation: positions alone are judged.
#[test]
fn errors_of_point_calibrations_are_at_the_bound() {
    let (runs, found, allowed) = runs(SessionKind::POINT);
    judge("points, position (µm)", runs, found.0, allowed.0);
}

#[test]
fn errors_of_mixed_calibrations_are_at_the_bound() {
    let (runs, found, allowed) = runs(SessionKind::MIXED);
    judge("mixed, position (µm)", runs, found.0, allowed.0);
    judge("mixed, rotation (µrad)", runs, found.1, allowed.1);
}
