//! Stated uncertainty holds in a Monte Carlo simulation, and reports no discrepancy if there is only noise.

use nalgebra::Vector3;
use poecal_arm::lie::rotation;
use poecal_calibrate::{CalibrationOptions, JointCorrection, calibrate};
use poecal_fit::state::{Linkage, PackedValues, RowChain};
use poecal_model::measurement::{Dataset, Noise};
use poecal_model::robot::{Robot, Tolerance};
use poecal_model::simulate::{SessionKind, Simulation, elbow, gantry, random, random_configuration, scara, seven_axis};
use poecal_testing::sessions::{geometry, with_threads};
use poecal_testing::trials::trials;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;
use rayon::prelude::*;

/// Fits of all robots and kinds.
const FITS: usize = 1040;
/// Predictions judged for each fit.
const PREDICTIONS: usize = 20;

/// Counts of one fit's predictions.
#[derive(Clone, Copy, Default)]
struct Tally {
    /// Components of position and rotation inside ± 1.96 standard deviations, and their number.
    inside: usize,
    of: usize,
    /// Distances within their bound, and their number.
    bounded: usize,
    predictions: usize,
    /// Mean `eᵀ P⁻¹ e` of the positions.
    nees: f64,
    /// True if errors beyond noise were claimed.
    claimed: bool,
}

fn tally_session(robot: &Robot, kind: SessionKind, seed: u64) -> Tally {
    let made = Simulation { count: 70, seed, ..Simulation::default() }.run(robot, kind).unwrap();
    let simulated = Simulation::default();
    // Nothing is unmodelled: the noise is stated, and there is no prior.
    let options = CalibrationOptions {
        held_out: Some(0.0),
        tolerance: None,
        sigma: Noise::new(simulated.noise_position_m, simulated.noise_rotation_rad).map(Some),
        ..geometry()
    };
    let found = calibrate(&made.nominal, &made.data, &options).unwrap();
    let uncertainty = found.trust.uncertainty.unwrap();
    let mut generator = ChaCha8Rng::seed_from_u64(seed ^ 0x7a11);
    let readings: Vec<f64> = (0..PREDICTIONS).flat_map(|_| random_configuration(robot, &mut generator)).collect();
    let packed = PackedValues::new(robot, &readings, robot.joints.len());
    let linkage = Linkage::new(&uncertainty.estimate);
    let mut chain = RowChain::default();
    let mut tally = Tally {
        claimed: uncertainty.discrepancy.scatter > 1.0
            || uncertainty.discrepancy.standard_deviation[poecal_model::measurement::Quantity::Position] > 0.0,
        ..Tally::default()
    };
    for (row, expected) in uncertainty.predictions(&packed, 0).into_iter().enumerate() {
        chain.evaluate(&linkage, &packed, row, 0);
        let values = &readings[row * robot.joints.len()..(row + 1) * robot.joints.len()];
        let truth = made.device_from_base * made.actual.forward_kinematics(values);
        let shift = truth.translation - chain.target.translation;
        let mut judge = |error: &Vector3<f64>, covariance: &nalgebra::Matrix3<f64>| {
            for k in 0..3 {
                tally.inside += usize::from(error[k].abs() < 1.96 * covariance[(k, k)].sqrt());
                tally.of += 1;
            }
        };
        judge(&shift, &expected.position);
        if kind == SessionKind::POSE {
            let turn = rotation::log(&(truth.rotation * chain.target.rotation.transpose()));
            judge(&turn, &expected.rotation);
        }
        tally.bounded += usize::from(shift.norm() < expected.bound_position_m());
        tally.predictions += 1;
        tally.nees += 1.0 / PREDICTIONS as f64 * shift.dot(&expected.position.cholesky().unwrap().solve(&shift));
    }
    tally
}

#[test]
fn stated_intervals_hold() {
    let trials = trials(FITS);
    let (mut all, mut fits, mut claims) = (Tally::default(), 0, 0);
    let each = trials.count.div_ceil(8) as u64;
    for robot in [elbow(), scara(), seven_axis(), gantry()] {
        for kind in [SessionKind::POSE, SessionKind::POINT] {
            let tallies: Vec<Tally> =
                (0..each).into_par_iter().map(|seed| tally_session(&robot, kind, 1000 + seed)).collect();
            let sum = |of: fn(&Tally) -> usize| tallies.iter().map(of).sum::<usize>();
            let (inside, of) = (sum(|it| it.inside), sum(|it| it.of));
            let nees = tallies.iter().map(|it| it.nees).sum::<f64>() / each as f64;
            println!(
                "{:12} {:5}: {:.1} % of components, {:.1} % of distances, NEES {nees:.2} of 3",
                robot.name,
                kind.word(),
                100.0 * inside as f64 / of as f64,
                100.0 * sum(|it| it.bounded) as f64 / sum(|it| it.predictions) as f64
            );
            all.inside += inside;
            all.of += of;
            all.bounded += sum(|it| it.bounded);
            all.predictions += sum(|it| it.predictions);
            all.nees += nees * each as f64;
            fits += each;
            claims += tallies.iter().filter(|it| it.claimed).count();
        }
    }
    let (components, distances) = (all.inside as f64 / all.of as f64, all.bounded as f64 / all.predictions as f64);
    let nees = all.nees / fits as f64;
    println!("{fits} fits: {components:.4}, {distances:.4}, NEES {nees:.3}, {claims} with errors beyond noise");
    // Errors of predictions of one fit are correlated: its share is 1 for most fits, and small for some.
    let near = 0.02 + trials.tolerance_factor(0.1);
    assert!((components - 0.95).abs() < near && (distances - 0.95).abs() < near);
    // The 95 % band of the mean of `fits` values of χ² with 3 degrees of freedom.
    assert!((nees - 3.0).abs() < 1.96 * (6.0 / fits as f64).sqrt());
    assert!((claims as f64) < (0.04 + trials.more_of_a_share(0.04)) * fits as f64);
}

#[test]
fn same_bytes_whatever_the_threads() {
    let made = Simulation { count: 2500, ..Simulation::default() }.run(&elbow(), SessionKind::POINT).unwrap();
    let once = calibrate(&made.nominal, &made.data, &geometry()).unwrap();
    let again = with_threads(1, || calibrate(&made.nominal, &made.data, &geometry())).unwrap();
    assert!(format!("{:?}", once.trust) == format!("{:?}", again.trust));
}

/// A robot whose links sag, which the model does not describe: prediction errors elsewhere exceed the noise, and stay within the stated uncertainty.
#[test]
fn errors_that_the_model_does_not_describe_are_stated() {
    let robot = elbow();
    let mut inside = 0;
    let mut all = 0;
    let sessions = trials(40);
    for seed in sessions.seeds() {
        let simulation = Simulation { count: 300, seed, device_anywhere: false, ..Simulation::default() };
        let made = simulation.run(&robot, SessionKind::POINT).unwrap();
        let sag = |readings: &[f64]| {
            let reach = readings[1].cos() * 0.57 + (readings[1] - readings[2]).sin() * 0.63;
            Vector3::new(0.0, 0.0, -8e-4 * reach * reach.abs())
        };
        let mut data = poecal_model::measurement::Dataset::new(robot.reading_names());
        for row in 0..made.data.len() {
            let position = made.data.observations[row].measurement.pose().translation + sag(made.data.readings(row));
            let point = poecal_model::measurement::Measurement::point(position);
            data.push(made.data.readings(row), None, point).unwrap();
        }
        let options = CalibrationOptions { held_out: Some(0.0), ..geometry() };
        let found = calibrate(&robot, &data, &options).unwrap();
        let uncertainty = found.trust.uncertainty.unwrap();
        let mut generator = ChaCha8Rng::seed_from_u64(seed ^ 0x7a12);
        let readings: Vec<f64> = (0..50).flat_map(|_| random_configuration(&robot, &mut generator)).collect();
        let packed = PackedValues::new(&robot, &readings, 6);
        let linkage = Linkage::new(&uncertainty.estimate);
        let mut chain = RowChain::default();
        for (row, expected) in uncertainty.predictions(&packed, 0).into_iter().enumerate() {
            chain.evaluate(&linkage, &packed, row, 0);
            let values = &readings[6 * row..6 * row + 6];
            let truth = made.actual.forward_kinematics(values).translation + sag(values);
            inside += usize::from((truth - chain.target.translation).norm() < expected.bound_position_m());
            all += 1;
        }
    }
    let share = inside as f64 / f64::from(all);
    println!(
        "with sagging links {:.1} % of the errors of {} sessions are within their bound",
        100.0 * share,
        sessions.count
    );
    assert!(share > 0.9 - sessions.tolerance_factor(0.1));
}

/// Resampled noise spreads predictions as the covariance states: the samples use neither its variance nor the equality of rows.
#[test]
fn drawing_rows_anew_agrees_with_the_covariance_where_there_is_only_noise() {
    let mut ratios = Vec::new();
    let sessions = trials(10);
    for robot in [elbow(), scara(), seven_axis(), gantry()] {
        for seed in sessions.seeds() {
            let made =
                Simulation { count: 200, seed, ..Simulation::default() }.run(&robot, SessionKind::POINT).unwrap();
            let found = calibrate(&made.nominal, &made.data, &geometry()).unwrap();
            let bootstrap = found.trust.bootstrap.unwrap();
            ratios.push(bootstrap.sigma_m / bootstrap.formal_sigma_m);
        }
    }
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    let (least, most) = ratios.iter().fold((f64::MAX, 0.0_f64), |(a, b), &r| (a.min(r), b.max(r)));
    println!("drawn anew over formal: mean {mean:.3}, {least:.2} to {most:.2}");
    // One step with the information of all rows neglects that each sample's own information varies: the result is some per cent too small with few
    // rows.
    assert!((0.9..1.1).contains(&mean) && least > 0.7 && most < 1.4);
}

/// Errors that neighbours share are no white noise: six rows with a common error determine little more than one, which the bootstrap shows.
#[test]
fn drawing_rows_anew_sees_what_neighbours_share() {
    let robot = elbow();
    let mut generator = ChaCha8Rng::seed_from_u64(5);
    let actual = Simulation::default().perturb(&robot, &mut generator);
    let mut data = poecal_model::measurement::Dataset::new(robot.reading_names());
    for _ in 0..60 {
        let near = random_configuration(&robot, &mut generator);
        let shared = random::normal_vector(&mut generator) * 2e-4;
        for _ in 0..6 {
            let readings: Vec<f64> = near.iter().map(|value| value + 1e-2 * random::normal(&mut generator)).collect();
            let seen = actual.forward_kinematics(&readings).translation;
            let position = seen + shared + random::normal_vector(&mut generator) * 2e-5;
            let point = poecal_model::measurement::Measurement::point(position);
            data.push(&readings, None, point).unwrap();
        }
    }
    let options = CalibrationOptions { held_out: Some(0.0), ..geometry() };
    let found = calibrate(&robot, &data, &options).unwrap();
    let bootstrap = found.trust.bootstrap.unwrap();
    let ratio = bootstrap.sigma_m / bootstrap.formal_sigma_m;
    println!("six alike: drawn anew {:.4} mm, {ratio:.2} times the formal", 1e3 * bootstrap.sigma_m);
    // Rows that are all alike in groups of six would make it the root of six, 2.4; neighbourhoods of four show about the root of four.
    assert!((1.5..2.6).contains(&ratio));
}

/// Least determined shares of the axes' tilts and shifts.
fn least_shares(robot: &Robot, data: &Dataset, tolerance: Option<Tolerance>) -> [Option<f64>; 2] {
    let options = CalibrationOptions { tolerance, ..geometry() };
    let found = calibrate(robot, data, &options).unwrap();
    let least =
        |of: fn(&JointCorrection) -> Option<f64>| found.trust.joints.iter().filter_map(of).min_by(f64::total_cmp);
    [least(|it| it.tilt_from_data), least(|it| it.shift_from_data)]
}

/// With points far beyond the unknowns the determined share is nearly 1; with a tolerance far below the noise of the data it is nearly 0; without a
/// tolerance there is none. Touched planes do not determine the size, which the tolerance alone supplies.
#[test]
fn what_the_data_said_and_what_the_tolerance_said_are_told_apart() {
    let tolerance = |angle_rad, length_m| Some(Tolerance { angle_rad, length_m });
    let points = Simulation { count: 100, ..Simulation::default() }.run(&elbow(), SessionKind::POSE).unwrap();
    let of = |data: &Dataset, tolerance| least_shares(&points.nominal, data, tolerance);
    let (usual, tight) = (of(&points.data, Tolerance::default().into()), of(&points.data, tolerance(1e-7, 1e-7)));
    let none = of(&points.data, None);
    let planes = Simulation { count: 120, ..Simulation::default() }.run(&elbow(), SessionKind::PLANE).unwrap();
    let touched = of(&planes.data, Tolerance::default().into());
    println!("poses: {usual:?}, tight {tight:?}, none {none:?}; touched planes {touched:?}");
    assert!(usual.iter().all(|share| share.unwrap() > 0.99));
    assert!(tight.iter().all(|share| share.unwrap() < 0.01));
    assert_eq!(none, [None, None]);
    assert!(touched[1].unwrap() < 0.9);
}
