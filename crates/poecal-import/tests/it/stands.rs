//! Recordings of a robot with static intervals, with clocks of their own: the static intervals of both belong together.

use std::fmt::Write as _;
use std::fs;

use poecal_arm::lie::{Pose, rotation};
use poecal_import::{ReadOptions, read};
use poecal_model::measurement::SessionKind;
use poecal_model::simulate::{Simulation, elbow};
use rand_chacha::ChaCha8Rng;
use rand_core::{Rng as _, SeedableRng as _};

use poecal_testing::files::Folder;
use poecal_testing::trials::trials;

/// A number from 0 to 1.
fn uniform_number(random: &mut ChaCha8Rng) -> f64 {
    (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

/// An approximately standard normal number: the sum of twelve uniform ones.
fn normal(random: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| uniform_number(random)).sum::<f64>() - 6.0
}

/// Beginning and end of each static interval, seconds.
fn stands(random: &mut ChaCha8Rng, count: usize) -> Vec<(f64, f64)> {
    let mut time = 0.3 * uniform_number(random);
    (0..count)
        .map(|_| {
            let begin = time;
            let end = begin + 0.5 + 0.8 * uniform_number(random);
            time = end + 0.5 + 0.6 * uniform_number(random);
            (begin, end)
        })
        .collect()
}

/// The static interval at a time, and the progress of the robot to the next one.
fn place(stands: &[(f64, f64)], time: f64) -> (usize, f64) {
    let at = stands.partition_point(|it| it.0 <= time).saturating_sub(1);
    let end = stands[at].1;
    match stands.get(at + 1) {
        Some(next) if time > end => {
            let share = (time - end) / (next.0 - end);
            (at, share * share * (3.0 - 2.0 * share))
        }
        _ => (at, 0.0),
    }
}

/// For each row that was read, the static intervals of its readings and of its measurement.
struct Joined {
    rows: Vec<(usize, usize)>,
    stands: usize,
    lag_s: f64,
    said: String,
    /// Rate, times of lost frames, and the static intervals, in words.
    about: String,
}

/// A session of 20 to 60 static intervals, written as two recordings and read again; `None` if it is refused.
fn session(seed: u64) -> Option<Joined> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let random = &mut random;
    let count = 20 + (random.next_u64() % 41) as usize;
    let is_posed = seed.is_multiple_of(2);
    let simulation = Simulation {
        error_rotation_rad: 0.2_f64.to_radians(),
        error_position_m: 1e-3,
        noise_position_m: 0.0,
        noise_rotation_rad: 0.0,
        count,
        seed,
        device_anywhere: true,
        ..Simulation::default()
    };
    let made = simulation.run(&elbow(), if is_posed { SessionKind::POSE } else { SessionKind::POINT }).unwrap();
    let spans = stands(random, count);
    let (from, to) = (spans[0].0, spans[count - 1].1);
    let lag_s = 60.0 * uniform_number(random) - 30.0;
    let next = |at: usize| (at + 1).min(count - 1);
    let mut joints = format!("time,{}\n", made.data.reading_names().join(","));
    for step in 0.. {
        let time = from + f64::from(step) / 125.0;
        if time > to {
            break;
        }
        let (at, share) = place(&spans, time);
        let readings: Vec<String> = (made.data.readings(at).iter().zip(made.data.readings(next(at))))
            // The encoder has a limited number of digits.
            .map(|(one, other)| format!("{:.6}", one + share * (other - one) + 1e-5 * normal(random)))
            .collect();
        writeln!(joints, "{:.4},{}", 5000.0 + time, readings.join(",")).unwrap();
    }
    let rate = [100.0, 50.0, 10.0][(random.next_u64() % 3) as usize];
    let gap = from + (to - from - 1.0) * uniform_number(random);
    let mut seen = "time,x,y,z".to_owned() + if is_posed { ",qx,qy,qz,qw\n" } else { "\n" };
    for step in 0.. {
        let time = from + f64::from(step) / rate;
        if time > to {
            break;
        }
        // Single frames, and a whole second, are lost.
        if uniform_number(random) < 0.02 || (gap..gap + 1.0).contains(&time) {
            continue;
        }
        let (at, share) = place(&spans, time);
        let pose = |row: usize| made.data.observations[row].measurement.pose();
        let (one, other) = (pose(at), pose(next(at)));
        let turn = rotation::log(&(one.rotation.transpose() * other.rotation)) * share;
        let noise = [0.0; 3].map(|_| 1e-3 * normal(random));
        let pose = Pose::new(
            one.rotation * rotation::exp(&turn) * rotation::exp(&noise.into()),
            one.translation + (other.translation - one.translation) * share,
        );
        let position = pose.translation.map(|it| it + 2e-4 * normal(random));
        write!(seen, "{:.4},{:.6},{:.6},{:.6}", 5000.0 + time + lag_s, position.x, position.y, position.z).unwrap();
        if is_posed {
            let [x, y, z, w] = pose.quaternion_xyzw();
            write!(seen, ",{x:.6},{y:.6},{z:.6},{w:.6}").unwrap();
        }
        seen.push('\n');
    }
    let folder = Folder::new();
    let paths = [folder.path("joints.csv"), folder.path("seen.csv")];
    fs::write(&paths[0], joints).unwrap();
    fs::write(&paths[1], seen).unwrap();
    let file =
        read(&paths, &made.nominal, &ReadOptions::default()).map_err(|error| println!("{seed}: {error}")).ok()?;
    let nearest = |far: &dyn Fn(usize) -> f64| (0..count).min_by(|a, b| far(*a).total_cmp(&far(*b))).unwrap();
    let rows = (0..file.data.len())
        .map(|row| {
            let own = file.data.readings(row);
            let of_joints = nearest(&|at| own.iter().zip(made.data.readings(at)).map(|(a, b)| (a - b).abs()).sum());
            let position = file.data.observations[row].measurement.position().unwrap();
            let of_seen = nearest(&|at| (made.data.observations[at].measurement.position().unwrap() - position).norm());
            (of_joints, of_seen)
        })
        .collect();
    Some(Joined {
        rows,
        stands: count,
        lag_s,
        said: file.notes.join("\n"),
        about: format!("{rate} frames a second, lost from {gap:.2} s on; {spans:.2?}"),
    })
}

#[test]
fn stands_of_two_recordings_are_joined_rightly() {
    let trials = trials(200).at_least(12);
    let all = trials.count;
    let (mut right, mut refused, mut wrong, mut paired, mut possible) = (0, 0, 0, 0, 0);
    for seed in 0..all {
        let Some(found) = session(seed as u64) else {
            refused += 1;
            continue;
        };
        let bad = found.rows.iter().filter(|it| it.0 != it.1).count();
        wrong += bad;
        paired += found.rows.len();
        possible += found.stands;
        let lag = found.said.split("at a lag of ").nth(1).and_then(|it| it.split(' ').next()?.parse::<f64>().ok());
        let is_near = lag.is_some_and(|it| (it - found.lag_s).abs() < 0.1);
        if bad > 0 || !is_near {
            let which: Vec<_> = found.rows.iter().filter(|it| it.0 != it.1).collect();
            println!(
                "{seed}: {which:?} of {} wrong, lag {lag:?} of {}, {}",
                found.rows.len(),
                found.lag_s,
                found.about
            );
        }
        right += usize::from(bad == 0 && is_near);
    }
    println!("of {all}: {right} right, {refused} refused; {wrong} wrong pairs, {paired} of {possible} stands");
    assert!((right + refused) * 100 >= 98 * all && wrong == 0 && refused * 50 <= all, "{right} {refused} {wrong}");
}

#[test]
fn a_program_that_repeats_itself_is_refused_until_the_lag_is_stated() {
    let made = Simulation { count: 8, seed: 3, ..Simulation::default() }.run(&elbow(), SessionKind::POSE).unwrap();
    // The same configurations occur three times, each for a second.
    let spans: Vec<(f64, f64)> = (0..24).map(|at| (2.0 * f64::from(at), 2.0 * f64::from(at) + 1.0)).collect();
    let (mut joints, mut seen) =
        (format!("time,{}\n", made.data.reading_names().join(",")), "time,x,y,z,qx,qy,qz,qw\n".to_owned());
    for step in 0..4700 {
        let time = 0.01 * f64::from(step);
        let (at, share) = place(&spans, time);
        let (one, other) = (at % 8, (at + 1) % 8);
        let readings: Vec<String> = (made.data.readings(one).iter().zip(made.data.readings(other)))
            .map(|(a, b)| format!("{:.6}", a + share * (b - a)))
            .collect();
        writeln!(joints, "{time},{}", readings.join(",")).unwrap();
        let pose = made.data.observations[one].measurement.pose();
        let [x, y, z, w] = pose.quaternion_xyzw();
        let far = if share > 0.0 && share < 1.0 { share } else { 0.0 };
        let at = pose.translation;
        writeln!(seen, "{},{:.6},{},{},{x},{y},{z},{w}", time + 7.0, at.x + far, at.y, at.z).unwrap();
    }
    let folder = Folder::new();
    let paths = [folder.path("joints.csv"), folder.path("seen.csv")];
    fs::write(&paths[0], joints).unwrap();
    fs::write(&paths[1], seen).unwrap();
    let error = read(&paths, &made.nominal, &ReadOptions::default()).unwrap_err().to_string();
    println!("{error}");
    assert!(error.contains("at several lags of the clocks alike") && error.contains("--lag"), "{error}");
    let options = ReadOptions { lag: Some("7s+-2s".parse().unwrap()), ..ReadOptions::default() };
    let file = read(&paths, &made.nominal, &options).unwrap();
    assert!(file.data.len() >= 22, "{}", file.data.len());
    assert!(file.notes.iter().any(|it| it.contains("at a lag of 7.0")), "{:?}", file.notes);
}
