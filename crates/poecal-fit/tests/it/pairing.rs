//! Joint readings and measurements without an assignment of one to the other: pairs by the nominal robot.

use poecal_fit::start::{Agreement, RowPair, UnpairedRows};
use poecal_model::measurement::{Dataset, Observation, RowLocation, SessionKind};
use poecal_model::robot::Robot;
use poecal_model::simulate::{Simulation, elbow};
use rand_chacha::ChaCha8Rng;
use rand_core::{Rng as _, SeedableRng as _};

use poecal_testing::trials::trials;

/// A whole number below another.
fn draw_below(random: &mut ChaCha8Rng, count: usize) -> usize {
    (random.next_u64() % count as u64) as usize
}

/// Order of the measurements.
type Shots = dyn Fn(&mut ChaCha8Rng) -> Vec<usize>;

/// Joint readings of a session, and its measurements in some order without them.
struct Session {
    robot: Robot,
    joints: Vec<f64>,
    data: Dataset,
}

/// A robot with errors of 0.2 degrees and 1 mm a joint, measured with noise of 0.05 mm and 0.01 degrees.
fn session(kind: SessionKind, count: usize, seed: u64, shots: &Shots) -> (Session, Vec<usize>) {
    let simulation = Simulation {
        error_rotation_rad: 0.2_f64.to_radians(),
        error_position_m: 1e-3,
        noise_position_m: 5e-5,
        noise_rotation_rad: 0.01_f64.to_radians(),
        count,
        seed,
        device_anywhere: true,
        ..Simulation::default()
    };
    let made = simulation.run(&elbow(), kind).unwrap();
    let shots = shots(&mut ChaCha8Rng::seed_from_u64(seed));
    let mut data = Dataset::new(made.data.reading_names().to_vec());
    (data.targets, data.stations) = (made.data.targets.clone(), made.data.stations.clone());
    let nothing = vec![0.0; made.data.reading_names().len()];
    for (at, shot) in shots.iter().enumerate() {
        let source = RowLocation { file: 0, line: at as u32 + 2 };
        data.push_observation(&nothing, Observation { source, ..made.data.observations[*shot] }).unwrap();
    }
    let joints = (0..count).flat_map(|row| made.data.readings(row).to_vec()).collect();
    (Session { robot: made.nominal, joints, data }, shots)
}

#[test]
fn lists_of_unequal_length_are_paired_rightly() {
    let (mut right, mut wrong, mut left_out) = (0, 0, 0);
    let trials = trials(200).at_least(12);
    let all = trials.count;
    for seed in 0..all {
        let kind = [SessionKind::POINT, SessionKind::POSE][seed % 2];
        let (session, shots) = session(kind, 60, seed as u64, &|random| {
            let mut rows: Vec<usize> = (0..60).collect();
            for at in (1..60).rev() {
                rows.swap(at, draw_below(random, at + 1));
            }
            let (lost, doubled) = (&rows[..5], &rows[5..7]);
            let mut shots: Vec<usize> =
                (0..60).filter(|it| !lost.contains(it)).chain(doubled.iter().copied()).collect();
            shots.sort_unstable();
            shots
        });
        let rows = UnpairedRows::new(&session.robot, &session.joints, &session.data);
        let found = rows.align_lists().unwrap();
        let is_right = |pair: &RowPair| shots[pair.1] == pair.0;
        let bad = found.pairs.iter().filter(|pair| !is_right(pair)).count();
        wrong += bad;
        left_out += shots.len() - found.pairs.len();
        right += usize::from(bad == 0 && found.unread.is_empty());
    }
    println!("{right} of {all} sessions paired rightly, {wrong} wrong pairs, {left_out} left out");
    assert!(right * 100 >= 97 * all && wrong == 0, "{right} {wrong}");
}

#[test]
fn wrong_orders_of_equal_counts_are_named() {
    let all = trials(200).at_least(12).count;
    let mut named = [0; 4];
    for seed in 0..all {
        let kind = [SessionKind::POINT, SessionKind::POSE][seed % 2];
        let exchanged = |random: &mut ChaCha8Rng| {
            let mut rows: Vec<usize> = (0..60).collect();
            let one = draw_below(random, 59);
            rows.swap(one, one + 1 + draw_below(random, 59 - one));
            rows
        };
        let orders: [&Shots; 4] = [
            &|_| (0..60).collect(),
            &|_| (0..60).map(|row| (row + 1) % 60).collect(),
            &|_| (0..60).rev().collect(),
            &exchanged,
        ];
        for (order, named) in orders.into_iter().zip(&mut named) {
            let (session, shots) = session(kind, 60, seed as u64, order);
            let rows = UnpairedRows::new(&session.robot, &session.joints, &session.data);
            let pairs: Vec<RowPair> = (0..60).map(|row| (row, row)).collect();
            let agrees = matches!(rows.agreement(&pairs), Some(Agreement::Right { .. }));
            let said = rows.find_exchanged_pairs(&pairs);
            let is_plain = shots.iter().copied().eq(0..60);
            let crossed = |(one, other): &(usize, usize)| shots[*one] == *other;
            *named += usize::from(if is_plain {
                agrees && said.is_empty()
            } else {
                !agrees || said.len() == 2 && said.iter().all(crossed)
            });
        }
    }
    println!("of {all}: right {}, shifted {}, reversed {}, two exchanged {}", named[0], named[1], named[2], named[3]);
    assert!(named.iter().all(|it| it * 100 >= 99 * all), "{named:?}");
}

#[test]
fn lists_of_very_unequal_length_have_no_order_and_take_no_time() {
    let (session, _) = session(SessionKind::POINT, 24, 3, &|_| (0..24).collect());
    // There are as many rows as in a recording, in no order.
    let rows = (0..5600).flat_map(|at| {
        let width = session.data.reading_names().len();
        let row = at * 7 % 24;
        session.joints[row * width..(row + 1) * width].to_vec()
    });
    let joints: Vec<f64> = rows.collect();
    let begun = std::time::Instant::now();
    assert!(UnpairedRows::new(&session.robot, &joints, &session.data).align_lists().is_none());
    println!("{:?}", begun.elapsed());
    assert!(begun.elapsed().as_secs() < 5);
}
