//! All kinds of measurements: recovery without noise, ranks in closed form, efficiency with noise, mixtures, known lengths, anchors that are held
//! out, and files (theory.md §4, §7).

use poecal_calibrate::{Calibration, CalibrationOptions, Corrections, ModelAccuracy, RobustLoss, calibrate};
use poecal_fit::analysis::Cause;
use poecal_fit::state::{PackedValues, Session};
use poecal_import::{ReadOptions, parse};
use poecal_model::measurement::{Dataset, KnownLength, Noise, Quantity, Set};
use poecal_model::robot::{Joint, Robot, Tolerance};
use poecal_model::simulate::{SessionKind, Simulation, SimulationResult, elbow, random_chain, seven_axis};
use poecal_testing::largest::larger_or_nan;
use poecal_testing::sessions::geometry;
use poecal_testing::trials::trials;

/// Kinds without a device frame. The first number is the rank that they add to 4 for each revolute joint and 2 for each prismatic one. The second
/// one is the number of undetermined unknowns: the size of the robot if nothing has a length.
const KINDS: [(SessionKind, i32, usize); 10] = [
    (SessionKind::DISTANCE, 6, 0),
    (SessionKind::CHANGE, 9, 0),
    (SessionKind::SPHERE, 0, 1),
    (SessionKind::SOCKET, 2, 1),
    (SessionKind::PLANE, 5, 1),
    (SessionKind::HEIGHT, 6, 0),
    (SessionKind::FLUSH, 4, 1),
    (SessionKind::BALL_BAR, -3, 0),
    (SessionKind::RELATIVE, 0, 0),
    (SessionKind::COMPONENT, 2, 0),
];

fn g(robot: &Robot) -> usize {
    let unknowns = |joint: &Joint| if joint.screw.is_prismatic() { 2 } else { 4 };
    robot.joints.iter().map(unknowns).sum()
}

fn exact_simulation(count: usize, seed: u64) -> Simulation {
    let (error_rotation_rad, error_position_m) = (0.5f64.to_radians(), 1e-3);
    Simulation {
        noise_position_m: 0.0,
        noise_rotation_rad: 0.0,
        count,
        seed,
        error_rotation_rad,
        error_position_m,
        ..Simulation::default()
    }
}

fn fit(made: &SimulationResult) -> Calibration {
    let options = CalibrationOptions { robust: RobustLoss::Off, ..geometry() };
    calibrate(&made.nominal, &made.data, &options).unwrap()
}

/// Largest error of all lengths and angles of held-out rows, millimetres and degrees.
fn largest_error(found: &Calibration) -> f64 {
    let held_out = found.accuracy.held_out.as_ref().unwrap();
    held_out.calibrated.iter().map(|(_, it)| it.max).fold(0.0, larger_or_nan)
}

#[test]
fn each_kind_alone_finds_the_robot_and_has_the_rank_of_the_closed_form() {
    for robot in [random_chain(6, 5), seven_axis(), elbow()] {
        for (kind, more, lacks) in KINDS {
            let made = exact_simulation(150, 1).run(&robot, kind).unwrap();
            let found = fit(&made);
            // A prismatic joint has a length.
            let slides = robot.joints.iter().any(|joint| joint.screw.is_prismatic());
            let (more, lacks) = if slides { (more + lacks as i32, 0) } else { (more, lacks) };
            let rank = (g(&robot) as i32 + more) as usize;
            let identified = &found.identifiability;
            println!(
                "{:8} {:16} rank {} of {}, held out {:.1e} mm",
                robot.name,
                kind.word(),
                identified.rank,
                identified.parameters,
                largest_error(&found)
            );
            // 1e-9 m, and the same number of degrees.
            assert!(largest_error(&found) < 1e-6, "{} {}: {:e}", robot.name, kind.word(), largest_error(&found));
            assert_eq!(
                (identified.rank, identified.parameters),
                (rank, rank + lacks),
                "{} {}",
                robot.name,
                kind.word()
            );
        }
    }
}

/// Directions determine only one direction of the tip: 2 for each revolute joint, and 2.
#[test]
fn directions_tell_directions_alone() {
    for robot in [elbow(), seven_axis()] {
        let made = exact_simulation(100, 1).run(&robot, SessionKind::DIRECTION).unwrap();
        let found = fit(&made);
        assert!(largest_error(&found) < 1e-9, "{:e}", largest_error(&found));
        assert_eq!(found.identifiability.rank, 2 * robot.joints.len() + 2);
    }
}

/// A known distance of two sockets determines the size.
#[test]
fn one_known_length_gives_the_scale() {
    let mut made = exact_simulation(150, 2).run(&elbow(), SessionKind::SOCKET).unwrap();
    let without = fit(&made);
    println!("{:?}", without.identifiability.unidentifiable);
    assert_eq!(without.identifiability.unidentifiable[0].cause, Cause::NoLength);
    let known = KnownLength { stations: [0, 1], length_m: 0.2, sigma_m: KnownLength::SIGMA_M };
    made.data.lengths = vec![known];
    let found = fit(&made);
    assert_eq!((found.identifiability.rank, found.identifiability.parameters), (27, 27));
    assert!(found.identifiability.unidentifiable.is_empty());
    // The size is right, and so are predictions anywhere.
    let other = exact_simulation(60, 2).held_out(&made, SessionKind::DISTANCE, 60).unwrap();
    assert_eq!(other.len(), 60);
    let apart = |estimate: &poecal_fit::state::Estimate| {
        let [a, b] = [0, 1].map(|station| estimate.device(station).inverse().translation);
        (a - b).norm()
    };
    let size = apart(&found.models.calibrated) - 0.2;
    println!("{:e} m with it, {:e} m without", size, apart(&without.models.calibrated) - 0.2);
    assert!(size.abs() < 1e-9);
    assert!((apart(&without.models.calibrated) - 0.2).abs() > 1e-6);
}

/// Distances, sockets, planes and points of one robot in one fit.
#[test]
fn kinds_are_mixed() {
    let robot = elbow();
    let simulation = exact_simulation(60, 3);
    let first = simulation.run(&robot, SessionKind::DISTANCE).unwrap();
    let mut data = first.data.clone();
    for kind in [SessionKind::SOCKET, SessionKind::PLANE, SessionKind::SPHERE, SessionKind::CHANGE] {
        let mut more = simulation.held_out(&first, kind, 40).unwrap();
        // The zero of changes is one of an instrument.
        more.stations.iter_mut().flatten().for_each(|name| *name = format!("{} {name}", kind.word()));
        data.extend(&more).unwrap();
    }
    let made = SimulationResult { data, ..first };
    let found = fit(&made);
    println!(
        "rank {} of {}, {:e} mm",
        found.identifiability.rank,
        found.identifiability.parameters,
        largest_error(&found)
    );
    assert!(largest_error(&found) < 1e-6);
    assert_eq!(found.identifiability.rank, found.identifiability.parameters);
}

/// The Cramér-Rao bound of the fitted values: `E Σ |f(x̂) - f(x)|² = n σ²` over the rows of a fit with n unknowns. The truth f(x) is from the same
/// session without noise. For touches the configurations have the noise, and `E Σ e² = (m - n) σ²` holds for the residuals.
#[test]
fn fits_reach_the_bound_of_cramer_and_rao() {
    let trials = trials(60).at_least(30);
    let sigma = Noise::new(5e-5, 1e-4);
    for (kind, ..) in KINDS {
        let (mut squares, mut expected) = (0.0, 0.0);
        for seed in trials.seeds() {
            let without = exact_simulation(110, seed);
            let noisy = Simulation { noise_position_m: 5e-5, noise_rotation_rad: 1e-4, ..without };
            let mut made = noisy.run(&elbow(), kind).unwrap();
            let options = CalibrationOptions {
                robust: RobustLoss::Off,
                held_out: Some(0.0),
                // Without a length, noise would shrink the robot.
                tolerance: kind.is_touched().then(Tolerance::default),
                sigma: sigma.map(Some),
                diagnose: false,
                ..geometry()
            };
            let found = calibrate(&made.nominal, &made.data, &options).unwrap();
            let numbers: usize = made.data.observations.iter().map(|row| row.measurement.dim()).sum();
            let unknowns = found.identifiability.rank;
            if kind.is_touched() {
                expected += (numbers - unknowns) as f64;
            } else {
                made.data = without.run(&elbow(), kind).unwrap().data;
                expected += unknowns as f64;
            }
            let packed = PackedValues::from_dataset(&made.nominal, &made.data);
            let session = Session::new(&made.nominal, &made.data, &packed, true);
            for error in session.errors(&made.data.all_rows(), &found.models.calibrated) {
                let whitened = error.numbers().map(|(channel, e)| (e / sigma[channel.quantity]).powi(2));
                squares += whitened.sum::<f64>();
            }
        }
        println!("{:16} {:.4}", kind.word(), squares / expected);
        // 60 sessions of some 25 unknowns, each of variance 2: a standard deviation of 3.7 %; of some 100 residuals less.
        let (most, sigma) = if kind.is_touched() { (0.05, 0.16) } else { (0.11, 0.28) };
        let most = most + trials.tolerance_factor(sigma);
        assert!((squares / expected - 1.0).abs() < most, "{}: {}", kind.word(), squares / expected);
    }
}

/// Without a length and without a tolerance, the robot that fits best is a point.
#[test]
fn a_tolerance_is_needed_where_nothing_has_a_length() {
    let options = CalibrationOptions { tolerance: None, ..geometry() };
    for (kind, is_refused) in [(SessionKind::SOCKET, true), (SessionKind::PLANE, true), (SessionKind::DISTANCE, false)]
    {
        let made = exact_simulation(80, 1).run(&elbow(), kind).unwrap();
        let found = calibrate(&made.nominal, &made.data, &options);
        assert_eq!(found.is_err(), is_refused, "{}", kind.word());
        if let Err(error) = found {
            assert!(
                error.to_string().starts_with("found no tolerance, and nothing measured that has a length"),
                "{error}"
            );
        }
    }
}

/// Anchors that only held-out rows name are estimated from these rows; the figure is the error that the constraint leaves.
#[test]
fn held_out_sockets_are_judged_by_their_own_mean() {
    let made = exact_simulation(160, 4).run(&elbow(), SessionKind::SOCKET).unwrap();
    for fitted in 0..2 {
        let mut data = made.data.clone();
        for row in &mut data.observations {
            row.set = Some(if row.station == fitted { Set::Fit } else { Set::HeldOut });
        }
        let found = fit(&SimulationResult { data, ..made.clone() });
        let held_out = found.accuracy.held_out.as_ref().unwrap();
        let residual = held_out.calibrated.residual_mm.unwrap();
        println!("{:e} mm, before {:e} mm", residual.max, held_out.registered.residual_mm.unwrap().max);
        assert_eq!(residual, held_out.calibrated.get(Quantity::Contact).unwrap());
        assert!(residual.max < 1e-6 && held_out.registered.residual_mm.unwrap().rms > 1.0);
        // One socket, whichever is the first in the file, determines all but the size.
        let told = &found.identifiability;
        assert_eq!((told.rank, told.parameters), (23, 24));
        let expected_m = found.trust.expected.measured.as_ref().unwrap().sigma_m;
        println!("expected error {expected_m:e} m");
        assert!(expected_m < 0.01);
    }
}

/// Sizes of terms are chosen by the rows of the socket that is fitted, whichever others are held out.
#[test]
fn sizes_are_chosen_where_other_sockets_are_held_out() {
    let Ok(Corrections::Sizes(terms)) = "sag=2e-3,tilt=1e-3".parse() else { panic!("no sizes") };
    let made = Simulation { terms, count: 160, seed: 4, ..Simulation::default() };
    let mut made = made.run(&elbow(), SessionKind::SOCKET).unwrap();
    for row in &mut made.data.observations {
        row.set = Some(if row.station == 0 { Set::Fit } else { Set::HeldOut });
    }
    let found = calibrate(&made.nominal, &made.data, &CalibrationOptions::default()).unwrap();
    let correction = found.correction.as_ref().unwrap();
    let error = |of: &ModelAccuracy| of.residual_mm.unwrap().rms;
    let held_out = found.accuracy.held_out.as_ref().unwrap();
    let (before, after) = (error(&held_out.calibrated), error(held_out.corrected.as_ref().unwrap()));
    println!("{:?} of {} sizes: {before:.3} mm to {after:.3} mm", correction.reason, correction.tried.len());
    assert!(correction.tried.len() > 3 && after <= 1.02 * before);
}

/// Corrections are fitted for these kinds too.
#[test]
fn corrections_are_fitted_where_there_is_no_device() {
    let made = Simulation { count: 200, ..Simulation::default() }.run(&elbow(), SessionKind::DISTANCE).unwrap();
    let options = CalibrationOptions { corrections: Corrections::Auto, ..geometry() };
    let found = calibrate(&made.nominal, &made.data, &options).unwrap();
    assert!(found.correction.is_some());
}

/// Rows may be distributed over anchors without changing the data otherwise.
#[test]
fn a_single_unnamed_socket_is_a_fixed_point() {
    let text = "joint1,joint2,joint3,joint4,socket\n0,0.1,0.1,0,post\n0.2,0.1,0.1,0,post\n";
    let file = parse(text, "a table", &poecal_model::simulate::scara(), &ReadOptions::default()).unwrap();
    assert_eq!(file.data.stations, [Some("post".to_owned())]);
    let of = |data: &Dataset| data.observations.iter().all(|row| row.measurement.has(Quantity::Contact));
    assert!(of(&file.data));
}

/// Residuals of touches inside and outside a sphere of unknown radius have different signs, so that their mean is near zero. The zero of the sphere
/// is fitted with them.
#[test]
fn residuals_of_a_sphere_have_their_sign() {
    let simulation = Simulation { count: 150, ..Simulation::default() };
    let made = simulation.run(&elbow(), SessionKind::SPHERE).unwrap();
    let options = CalibrationOptions { robust: RobustLoss::Off, ..geometry() };
    let found = calibrate(&made.nominal, &made.data, &options).unwrap();
    let packed = PackedValues::from_dataset(&made.nominal, &made.data);
    let session = Session::new(&made.nominal, &made.data, &packed, true);
    let errors = session.errors(&found.fit_rows, &found.models.calibrated);
    let all: Vec<f64> = errors.iter().flat_map(|it| it.numbers().map(|(_, e)| e)).collect();
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    let rms = (all.iter().map(|e| e * e).sum::<f64>() / all.len() as f64).sqrt();
    println!("mean {:.2e} mm, RMS {:.4} mm", 1e3 * mean, 1e3 * rms);
    // The zero is an unknown, and so their mean vanishes except for the prior; with one sign it would be 0.8 of the RMS.
    assert!(mean.abs() < 0.01 * rms, "{mean:e} m of {rms:e} m");
}

/// Rows that show an orientation without a position are neither poses nor points.
#[test]
fn flush_faces_and_directions_are_no_poses() {
    let robot = poecal_model::simulate::scara();
    for (header, row, quantity) in
        [("plane,contact", "table,flush", "height"), ("direction,tilt_x,tilt_y", "gravity,0.1,0", "tilt")]
    {
        let text = format!("joint1,joint2,joint3,joint4,{header}\n0,0.1,0.1,0,{row}\n0.2,0.1,0.1,0,{row}\n");
        let file = parse(&text, "a table", &robot, &ReadOptions::default()).unwrap();
        let found = &file.understood[0];
        println!("{header}: {} points, {} poses, {:?}", found.points, found.poses, found.others);
        assert_eq!((found.points, found.poses, found.others.get(quantity)), (0, 0, Some(&2)));
    }
}
