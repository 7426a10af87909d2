//! The uncertainty that a calibration predicts for rows with device frame and tool refitted holds in a Monte Carlo simulation.

use nalgebra::Vector3;
use poecal_arm::lie::Pose;
use poecal_calibrate::{CalibrationOptions, Judgement, Level, QuantityCoverage, calibrate};
use poecal_model::measurement::{MeasuredQuantities, Noise};
use poecal_model::robot::Robot;
use poecal_model::simulate::{SessionKind, Simulation, elbow, random, seven_axis};
use poecal_results::calibration_file::{CalibrationFile, Inputs};
use poecal_testing::sessions::geometry;
use poecal_testing::trials::trials;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;
use rayon::prelude::*;

/// Fits of each robot and kind, each judged by one session of few rows, so that the refitted frames absorb a large part of the errors.
const FITS: usize = 60;
/// Scatter between fits: of the share inside the bounds, and of the error over the expected one.
const OF_ONE_SHARE: f64 = 0.12;
const OF_ONE_RATIO: f64 = 0.25;
const ROWS: usize = 14;

/// A calibration with stated noise, judged by a session with the device elsewhere and, if it is refitted, another tool.
fn judge_refit(robot: &Robot, kind: SessionKind, seed: u64, refit_tool: bool) -> Judgement {
    let simulation = Simulation { count: 60, seed, ..Simulation::default() };
    let made = simulation.run(robot, kind).unwrap();
    let options = CalibrationOptions {
        held_out: Some(0.0),
        sigma: Noise::new(simulation.noise_position_m, simulation.noise_rotation_rad).map(Some),
        ..geometry()
    };
    let calibration = calibrate(&made.nominal, &made.data, &options).unwrap();
    let file = CalibrationFile::new(&calibration, &made.data, Inputs::default());
    let mut generator = ChaCha8Rng::seed_from_u64(seed ^ 0x0f17);
    let mut actual = made.actual.clone();
    if refit_tool {
        let beside: Vector3<f64> = random::direction(&mut generator) * 0.15;
        actual.home = actual.home * Pose::new(random::rotation(&mut generator), beside);
    }
    let session = Simulation { count: ROWS, ..simulation };
    let other = session.measure(&made.nominal, actual, kind, &mut generator).unwrap();
    file.judge(&other.data, true, refit_tool).unwrap()
}

#[test]
fn a_promise_after_a_refit_is_kept_as_often_as_it_says() {
    for robot in [elbow(), seven_axis()] {
        for kind in [SessionKind::POSE, SessionKind::POINT] {
            for refit_tool in [false, true] {
                let fits = trials(FITS);
                let judgements: Vec<Judgement> = (fits.seeds())
                    .into_par_iter()
                    .map(|seed| judge_refit(&robot, kind, 4000 + seed, refit_tool))
                    .collect();
                let mean = |of: &dyn Fn(&Judgement) -> f64| judgements.iter().map(of).sum::<f64>() / fits.count as f64;
                let share = mean(&|it| it.promised.unwrap().position_mm().inside_bound95);
                let squares = mean(&|it| it.calibrated.position_mm().rms.powi(2));
                let expected = mean(&|it| it.promised.unwrap().position_mm().expected_rms.powi(2));
                let ratio = (squares / expected).sqrt();
                let turns = mean(&|it| it.promised.unwrap().rotation_deg().map_or(0.95, |part| part.inside_bound95));
                println!(
                    "{:10} {:5} tool refitted: {refit_tool:5}, {} fits: {:.1} % inside, rotations {:.1} %, error {ratio:.3} times the expected one",
                    robot.name,
                    kind.word(),
                    fits.count,
                    100.0 * share,
                    100.0 * turns
                );
                let near = 0.04 + fits.tolerance_factor(OF_ONE_SHARE);
                assert!((share - 0.94).abs() < near && (turns - 0.94).abs() < near);
                // A normal error of some thousand components is known to a few per cent. Another tool shows effects that a point on the last axis did
                // not: there the error is that of a few sessions in which the drawing was far off.
                let tolerance = if refit_tool && kind == SessionKind::POINT { 0.4 } else { 0.07 };
                assert!((ratio - 1.0).abs() < tolerance + fits.tolerance_factor(OF_ONE_RATIO));
            }
        }
    }
}

#[test]
fn another_robot_breaks_the_promise_after_a_refit_too() {
    let simulation = Simulation { count: 60, ..Simulation::default() };
    let made = simulation.run(&elbow(), SessionKind::POINT).unwrap();
    let calibration = calibrate(&made.nominal, &made.data, &geometry()).unwrap();
    let file = CalibrationFile::new(&calibration, &made.data, Inputs::default());
    let other = Simulation { seed: 2, ..simulation }.run(&elbow(), SessionKind::POINT).unwrap();
    let judgement = file.judge(&other.data, true, true).unwrap();
    let share = judgement.promised.unwrap().position_mm().inside_bound95;
    println!("{:.1} % inside", 100.0 * share);
    assert!(share < 0.2);
    assert!(judgement.falls_short(Level::Good).unwrap().contains("inside their 95 % bounds, 80 % are required"));
    let own = file.judge(&made.data, true, true).unwrap();
    assert_eq!(own.falls_short(Level::Good), None);
    assert_eq!(own.falls_short(Level::InsideSampledRange), None);
    // One row inside the sampled range is no evidence, several are evidence against all.
    let with_inside = |count: usize| {
        let mut judgement = own.clone();
        let some = judgement.in_sampled_range.as_mut().unwrap();
        let parts = some.promised.parts;
        some.promised.parts = MeasuredQuantities::from_fn(|it| {
            parts.get(it).map(|part| QuantityCoverage { inside_bound95: 0.41, ..part })
        });
        some.count = count;
        judgement
    };
    assert_eq!(with_inside(1).falls_short(Level::Good), None);
    let told = with_inside(1).falls_short(Level::InsideSampledRange).unwrap();
    assert_eq!(told, "only 1 row lies inside the sampled range, too few to judge it");
    for level in [Level::Good, Level::InsideSampledRange] {
        let told = with_inside(50).falls_short(level).unwrap();
        assert!(told.starts_with("41 % of the position errors inside the sampled range are"), "{told}");
    }
}
