//! A torso with two arms, seen by a device beside it, by one hand that sees the other, and by planes that both hands touch: ranks in closed form,
//! recovery without noise, and held-out figures with it (theory.md §7).

use poecal_calibrate::{Calibration, CalibrationOptions, Corrections, RobustLoss, calibrate};
use poecal_fit::state::{PackedValues, Session};
use poecal_formats::urdf::{ChainSelection, UrdfDocument};
use poecal_model::measurement::{Dataset, Observation, Quantity};
use poecal_model::robot::Robot;
use poecal_model::simulate::{SessionKind, Simulation, SimulationResult};
use poecal_testing::largest::larger_or_nan;
use poecal_testing::sessions::geometry;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng as _;

/// Unknowns of twice six joints that turn.
const ARMS: usize = 48;
/// Unknowns of the torso: a joint that slides, and one that turns.
const TORSO: usize = 2 + 4;

/// The torso of the tests with the mounts on its links; `base` is its base link, or `torso` for two arms on one base.
fn robot(base: &str, instruments: &[(&str, &str)], targets: &[(&str, &str)]) -> Robot {
    let pairs =
        |pairs: &[(&str, &str)]| pairs.iter().map(|(name, link)| ((*name).to_owned(), (*link).to_owned())).collect();
    let selection = ChainSelection {
        base_link: Some(base.to_owned()),
        instruments: pairs(instruments),
        targets: pairs(targets),
        ..ChainSelection::default()
    };
    let text = include_str!("../../../poecal-testing/data/torso.urdf");
    UrdfDocument::parse(text, "torso.urdf", &selection).unwrap().robot().clone()
}

/// Both hands with a target.
pub(crate) fn both_hands(base: &str) -> Robot {
    robot(base, &[], &[("left", "left_hand"), ("right", "right_hand")])
}

/// The left hand sees the right one.
fn hand_to_hand() -> Robot {
    robot("base_link", &[("eye", "left_hand")], &[("ball", "right_hand")])
}

fn exact_simulation(count: usize) -> Simulation {
    Simulation {
        noise_position_m: 0.0,
        noise_rotation_rad: 0.0,
        count,
        error_rotation_rad: 0.5f64.to_radians(),
        error_position_m: 1e-3,
        ..Simulation::default()
    }
}

fn fit(made: &SimulationResult) -> Calibration {
    let options = CalibrationOptions { robust: RobustLoss::Off, ..geometry() };
    calibrate(&made.nominal, &made.data, &options).unwrap()
}

/// A session with only the first stations, in their order.
fn of_places(made: SimulationResult, count: usize) -> SimulationResult {
    let mut data = Dataset::new(made.data.reading_names().to_vec());
    for (row, observation) in made.data.observations.iter().enumerate() {
        if observation.station >= count {
            continue;
        }
        let target = data.target_index(made.data.targets[observation.target].as_deref());
        let station = data.station_index(made.data.stations[observation.station].as_deref());
        let own = Observation { target, station, ..*observation };
        data.push_observation(made.data.readings(row), own).unwrap();
    }
    SimulationResult { data, ..made }
}

/// Rank and recovery of a session without noise.
fn check(name: &str, made: &SimulationResult, rank: usize, unknowns: usize) {
    let found = fit(made);
    let (identified, held_out) = (&found.identifiability, found.accuracy.held_out.as_ref().unwrap());
    let worst = held_out.calibrated.iter().map(|(_, it)| it.max).fold(0.0, larger_or_nan);
    println!(
        "{name}: rank {} of {}, expected {rank} of {unknowns}; held out {worst:.1e} mm or degrees",
        identified.rank, identified.parameters
    );
    assert_eq!((identified.rank, identified.parameters), (rank, unknowns), "{name}");
    // Tolerance of 1e-9 m, and the same number of degrees.
    assert!(worst < 1e-6, "{name}: {worst:e}");
}

/// All joints between device and hands are observed: g and 6 for each pose target, 3 for each point, 6 for the device less 6 for the base.
#[test]
fn a_device_beside_the_torso_sees_both_hands() {
    for (kind, of_target) in [(SessionKind::POSE, 6), (SessionKind::POINT, 3)] {
        let made = exact_simulation(200).run(&both_hands("base_link"), kind).unwrap();
        let rank = TORSO + ARMS + 2 * of_target;
        check(&format!("device, {}s of both hands", kind.word()), &made, rank, rank);
    }
}

/// From one hand to the other is one chain of twelve joints; the torso moves both hands alike and is not observed. The eye's frame is absorbed by the
/// base, and an anchor shows 3 of its 6 numbers.
#[test]
fn the_left_hand_sees_the_right() {
    let places = [(SessionKind::POSE, 6), (SessionKind::POINT, 3), (SessionKind::DISTANCE, 0)];
    for (kind, more) in places {
        let made =
            exact_simulation(if kind == SessionKind::DISTANCE { 300 } else { 160 }).run(&hand_to_hand(), kind).unwrap();
        assert!(made.data.stations == [Some("eye".to_owned())], "{:?}", made.data.stations);
        check(&format!("hand to hand, {}s", kind.word()), &made, ARMS + more, TORSO + ARMS + more);
    }
}

/// A session of both hands on six planes, three through one point and three through another.
fn on_six_planes(count: usize) -> SimulationResult {
    let first = exact_simulation(count).run(&both_hands("torso"), SessionKind::PLANE).unwrap();
    let mut generator = ChaCha8Rng::seed_from_u64(9);
    let other = Simulation { seed: 2, ..exact_simulation(count) };
    let actual = first.actual.clone();
    let mut more = other.measure(&first.nominal, actual, SessionKind::PLANE, &mut generator).unwrap().data;
    more.stations.iter_mut().flatten().for_each(|name| *name = format!("second {name}"));
    let mut data = first.data.clone();
    data.extend(&more).unwrap();
    SimulationResult { data, ..first }
}

/// Points of both hands on planes. An arm that shares no joint with the other may be moved, turned and scaled by itself in any motion that keeps all
/// planes: 4 degrees of freedom with one plane, 2 with two, 1 with three, none with four (theory.md §7).
#[test]
fn planes_that_both_hands_touch() {
    for (planes, own) in [(1, 4), (2, 2), (3, 1), (4, 0)] {
        let made = of_places(on_six_planes(450), planes);
        // Unknowns without the base's 6: the axes, three numbers of each target and of each plane.
        let unknowns = ARMS + 6 + 3 * planes - 6;
        check(&format!("two arms on {planes} planes"), &made, unknowns - 1 - own, unknowns);
    }
}

/// A moving torso couples the arms. One that turns leaves scaling of the whole, and with a single plane scaling of one arm about the intersection of
/// the axis with it. For one that slides too, a plane observes only the slide's part along its normal. One plane leaves the slide's turn about the
/// normal and scaling with the slide's tilt, two planes the latter, three nothing.
#[test]
fn a_torso_that_moves_ties_both_arms_together() {
    for (base, own, lacking) in [("torso_lift", 4, [2, 1, 1]), ("base_link", TORSO, [2, 1, 0])] {
        for (planes, lacks) in (1..).zip(lacking) {
            let made = of_places(exact_simulation(450).run(&both_hands(base), SessionKind::PLANE).unwrap(), planes);
            let unknowns = own + ARMS + 6 + 3 * planes - 6;
            check(&format!("{base}, arms on {planes} planes"), &made, unknowns - lacks, unknowns);
        }
    }
}

/// With noise of 0.05 mm and 0.01° the error of held-out rows is that noise, and the uncertainty of the fit.
#[test]
fn with_noise_held_out_rows_are_as_good_as_the_noise() {
    let noisy = |count| Simulation { count, ..Simulation::default() };
    let sessions = [
        ("device", both_hands("base_link"), SessionKind::POSE, 300, Quantity::Position, 3.0),
        ("hand to hand", hand_to_hand(), SessionKind::DISTANCE, 600, Quantity::Distance, 1.0),
        ("planes", both_hands("torso"), SessionKind::PLANE, 600, Quantity::Height, 1.0),
    ];
    for (name, robot, kind, count, quantity, components) in sessions {
        let made = noisy(count).run(&robot, kind).unwrap();
        let found = fit(&made);
        let held_out = found.accuracy.held_out.as_ref().unwrap();
        let rms = held_out.calibrated.get(quantity).unwrap().rms;
        let expected = 0.05 * f64::sqrt(components);
        println!("{name}: held out {rms:.4} mm, noise {expected:.4} mm");
        // n unknowns add n / m to the variance of m numbers, some 15 %; 90 rows or more scatter by 7 %.
        assert!((0.8..1.3).contains(&(rms / expected)), "{name}: {rms} mm");
    }
}

/// The rows of the left hand, with the readings of its chain alone.
fn of_left(chain: &Robot, data: &Dataset) -> Dataset {
    let mut own = Dataset::new(chain.reading_names());
    let at: Vec<usize> =
        own.reading_names().iter().map(|name| data.reading_names().iter().position(|it| it == name).unwrap()).collect();
    for (row, observation) in data.observations.iter().enumerate() {
        if data.targets[observation.target].as_deref() == Some("left") {
            let readings: Vec<f64> = at.iter().map(|&at| data.readings(row)[at]).collect();
            own.push(&readings, None, observation.measurement).unwrap();
        }
    }
    own
}

/// Error of the corrected model on other rows, metres (RMS).
fn corrected_m(calibration: &Calibration, unseen: &Dataset, target: Option<&str>) -> f64 {
    let found = calibration.correction.as_ref().unwrap();
    let packed = PackedValues::from_dataset(&found.model.robot, unseen);
    let session = Session::new(&found.model.robot, unseen, &packed, true);
    let is_own = |row: &u32| unseen.targets[unseen.observations[*row as usize].target].as_deref() == target;
    let rows: Vec<u32> = unseen.all_rows().into_iter().filter(is_own).collect();
    let squares: f64 = session.errors(&rows, &found.estimate).iter().map(|it| it.position_m().norm_squared()).sum();
    (squares / rows.len() as f64).sqrt()
}

/// The weight of the arms bends the torso. One tree of both arms knows the position of the other arm; a chain of one arm does not.
#[test]
fn a_tree_of_two_soft_arms_has_half_the_error_of_a_chain() {
    let Ok(Corrections::Sizes(terms)) = "sag=2e-2,tilt=2e-2".parse() else { panic!("no sizes") };
    let tree = both_hands("base_link");
    let selection = ChainSelection { tip_link: Some("left_hand".to_owned()), ..ChainSelection::default() };
    let text = include_str!("../../../poecal-testing/data/torso.urdf");
    let chain = UrdfDocument::parse(text, "torso.urdf", &selection).unwrap().robot().clone();
    let drawn = Simulation { terms, count: 200, seed: 3, ..Simulation::default() };
    let made = drawn.run(&tree, SessionKind::POINT).unwrap();
    let unseen = drawn.held_out(&made, SessionKind::POINT, 100).unwrap();
    let options = CalibrationOptions::default();
    let whole = corrected_m(&calibrate(&tree, &made.data, &options).unwrap(), &unseen, Some("left"));
    let left = of_left(&chain, &made.data);
    let alone = corrected_m(&calibrate(&chain, &left, &options).unwrap(), &of_left(&chain, &unseen), None);
    println!("tree {:.3} mm, chain {:.3} mm", 1e3 * whole, 1e3 * alone);
    assert!(whole < 0.5 * alone);
}
