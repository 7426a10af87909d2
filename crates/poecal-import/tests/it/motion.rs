//! Recordings of a robot in motion, with clocks of their own: lag and drift are found, and stated with their uncertainty.

use std::fmt::Write as _;
use std::fs;

use poecal_arm::lie::{Pose, rotation};
use poecal_calibrate::CalibrationOptions;
use poecal_calibrate::calibrate;
use poecal_fit::parameters::Parameter;
use poecal_fit::state::ClockTerm;
use poecal_import::{Join, ReadOptions, read};
use poecal_model::measurement::SessionKind;
use poecal_model::robot::Robot;
use poecal_model::simulate::{Configurations, Simulation, elbow, random};
use rand_chacha::ChaCha8Rng;
use rand_core::{Rng as _, SeedableRng as _};

use poecal_testing::files::Folder;
use poecal_testing::trials::trials;

/// Moves between configurations: beginning, configuration and duration of each, and the pause that follows.
struct Moves {
    begins_s: Vec<f64>,
    lasts_s: Vec<f64>,
    places: Vec<Vec<f64>>,
}

impl Moves {
    /// Moves during `span_s`, with a tip speed of up to 0.3 to 1 m/s, with pauses or without.
    fn new(robot: &Robot, span_s: f64, stops: bool, generator: &mut ChaCha8Rng) -> Self {
        let configurations = Configurations::new(robot);
        let mut moves = Moves { begins_s: vec![], lasts_s: vec![], places: vec![configurations.random(generator)] };
        let mut time = 0.0;
        while time < span_s {
            // The move covers a part of the path to a random configuration.
            let far = configurations.random(generator);
            let last = moves.places.last().unwrap().clone();
            let next: Vec<f64> = last.iter().zip(&far).map(|(a, b)| a + 0.5 * (b - a)).collect();
            let tip = |share: f64| {
                let values: Vec<f64> = last.iter().zip(&next).map(|(a, b)| a + share * (b - a)).collect();
                robot.forward_kinematics(&robot.joint_values(&values)).translation
            };
            let length: f64 = (0..20).map(|k| (tip(f64::from(k + 1) / 20.0) - tip(f64::from(k) / 20.0)).norm()).sum();
            let speed = 0.3 + 0.7 * random::uniform_number(generator);
            // The fastest part of a move is 15/8 of its mean.
            let lasts = (1.9 * length / speed).max(0.6);
            moves.begins_s.push(time);
            moves.lasts_s.push(lasts);
            moves.places.push(next);
            time += lasts + if stops { 0.2 + 0.8 * random::uniform_number(generator) } else { 0.0 };
        }
        moves
    }

    /// Repeats the first moves, with a return to the first configuration.
    fn repeat(&mut self, count: usize, span_s: f64) {
        let period = self.begins_s[count];
        let first = self.places[0].clone();
        self.places.truncate(count);
        self.begins_s.truncate(count);
        self.lasts_s.truncate(count);
        let cycles = (span_s / period) as usize + 2;
        let (begins, lasts, places) = (self.begins_s.clone(), self.lasts_s.clone(), self.places.clone());
        for cycle in 1..cycles {
            self.begins_s.extend(begins.iter().map(|it| it + cycle as f64 * period));
            self.lasts_s.extend(&lasts);
            self.places.extend(places.iter().cloned());
        }
        self.places.push(first);
    }

    fn configuration_at(&self, time_s: f64) -> Vec<f64> {
        let at = self.begins_s.partition_point(|it| *it <= time_s).saturating_sub(1);
        let s = ((time_s - self.begins_s[at]) / self.lasts_s[at]).clamp(0.0, 1.0);
        let share = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
        self.places[at].iter().zip(&self.places[at + 1]).map(|(a, b)| a + share * (b - a)).collect()
    }
}

/// Settings of a recorded session.
#[derive(Clone, Copy, Debug)]
struct Recorded {
    span_s: f64,
    joint_rate: f64,
    rate: f64,
    is_posed: bool,
    stops: bool,
    lag_s: f64,
    drift: f64,
    /// Mean lateness of the stamps of the measurements, seconds.
    late_s: f64,
    /// Number of moves after which the program restarts, if it does.
    repeats: Option<usize>,
    /// True if the measurements belong to another session.
    is_other: bool,
}

/// Results of a session.
struct Found {
    lag_s: f64,
    drift: f64,
    /// Standard deviations of the lag and of the drift by the fit.
    sigmas: [f64; 2],
    expected_mm: f64,
    true_mm: f64,
}

fn session(seed: u64, of: &Recorded) -> Result<Found, String> {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    let simulation = Simulation {
        error_rotation_rad: 0.2_f64.to_radians(),
        error_position_m: 1e-3,
        count: 1,
        seed,
        device_anywhere: true,
        ..Simulation::default()
    };
    let made = simulation.run(&elbow(), if of.is_posed { SessionKind::POSE } else { SessionKind::POINT }).unwrap();
    let mut moves = Moves::new(&made.actual, of.span_s, of.stops, &mut generator);
    if let Some(count) = of.repeats {
        moves.repeat(count, of.span_s);
    }
    let mut elsewhere = ChaCha8Rng::seed_from_u64(seed + 1_000_000);
    let other = of.is_other.then(|| Moves::new(&made.actual, of.span_s, of.stops, &mut elsewhere));
    let tip =
        |readings: &[f64]| made.device_from_base * made.actual.forward_kinematics(&made.actual.joint_values(readings));
    let mut joints = format!("time,{}\n", made.data.reading_names().join(","));
    for step in 0..(of.span_s * of.joint_rate) as u32 {
        let time = f64::from(step) / of.joint_rate;
        let readings: Vec<String> = moves
            .configuration_at(time)
            .iter()
            .map(|it| format!("{:.6}", it + 2e-6 * random::normal(&mut generator)))
            .collect();
        writeln!(joints, "{:.5},{}", 100.0 + time, readings.join(",")).unwrap();
    }
    let mut seen = "time,x,y,z".to_owned() + if of.is_posed { ",qx,qy,qz,qw\n" } else { "\n" };
    let middle = 0.5 * of.span_s;
    for step in 0..(of.span_s * of.rate) as u32 {
        let time = f64::from(step) / of.rate;
        let pose = tip(&other.as_ref().unwrap_or(&moves).configuration_at(time));
        let noise = |generator: &mut ChaCha8Rng, size: f64| random::normal_vector(generator) * size;
        let pose = Pose::new(
            pose.rotation * rotation::exp(&noise(&mut generator, 1e-4)),
            pose.translation + noise(&mut generator, 5e-5),
        );
        let late = -of.late_s * (1.0 - random::uniform_number(&mut generator)).ln();
        let stamp = 100.0 + time + of.lag_s + of.drift * (time - middle) + late;
        write!(seen, "{stamp:.5},{:.6},{:.6},{:.6}", pose.translation.x, pose.translation.y, pose.translation.z)
            .unwrap();
        if of.is_posed {
            let [x, y, z, w] = pose.quaternion_xyzw();
            write!(seen, ",{x:.7},{y:.7},{z:.7},{w:.7}").unwrap();
        }
        seen.push('\n');
    }
    let folder = Folder::new();
    let paths = [folder.path("joints.csv"), folder.path("seen.csv")];
    fs::write(&paths[0], joints).unwrap();
    fs::write(&paths[1], seen).unwrap();
    let options = ReadOptions { join: Some(Join::Motion), ..ReadOptions::default() };
    let file = read(&paths, &made.nominal, &options).map_err(|error| error.to_string())?;
    let clock = file.data.moving.clocks[0];
    let calibration =
        calibrate(&made.nominal, &file.data, &CalibrationOptions::default()).map_err(|error| error.to_string())?;
    let uncertainty = calibration.trust.uncertainty.as_ref().ok_or("no uncertainty")?;
    let n = uncertainty.layout.dim();
    let change = uncertainty.estimate.clock(0);
    let mut sigmas = [f64::NAN; 2];
    for (parameter, places) in uncertainty.layout.parameters() {
        if let Parameter::ClockUnknown(it) = parameter {
            let (place, scale) = places[0];
            sigmas[it.term as usize] = uncertainty.covariance[place * n + place].sqrt() / scale;
        }
    }
    let expected_mm = 1e3 * calibration.trust.expected.measured.as_ref().map_or(f64::NAN, |it| it.sigma_m);
    let mut squares = 0.0;
    let target = calibration.targets[0].tip_from_target;
    for _ in 0..200 {
        // The robot's configuration.
        let readings = moves.configuration_at(of.span_s * random::uniform_number(&mut generator));
        let of = |robot: &Robot| robot.forward_kinematics(&robot.joint_values(&readings));
        let predicted = calibration.base_from_device.inverse() * of(&calibration.robot) * target;
        squares += (predicted.translation - tip(&readings).translation).norm_squared();
    }
    Ok(Found {
        lag_s: clock.lag_s + change.term(ClockTerm::Lag),
        drift: clock.drift + change.term(ClockTerm::Drift),
        sigmas,
        expected_mm,
        true_mm: 1e3 * (squares / 200.0).sqrt(),
    })
}

fn draw_recording(generator: &mut ChaCha8Rng) -> Recorded {
    Recorded {
        span_s: 60.0 + 120.0 * random::uniform_number(generator),
        joint_rate: [100.0, 250.0][(generator.next_u64() % 2) as usize],
        rate: [100.0, 250.0, 10.0][(generator.next_u64() % 3) as usize],
        is_posed: generator.next_u64().is_multiple_of(2),
        stops: generator.next_u64().is_multiple_of(2),
        lag_s: 60.0 * random::uniform_number(generator) - 30.0,
        drift: 1e-4 * random::uniform_number(generator) - 5e-5,
        late_s: 0.0,
        repeats: None,
        is_other: false,
    }
}

#[test]
fn lag_and_drift_of_recordings_in_motion_are_found() {
    let trials = trials(200).at_least(8);
    let all = trials.count;
    let (mut refused, mut near, mut long, mut steady, mut covered, mut of_drift) = (0, 0, 0, 0, 0, 0);
    let mut ratios = Vec::new();
    for seed in 0..all as u64 {
        let mut generator = ChaCha8Rng::seed_from_u64(1000 + seed);
        let of = draw_recording(&mut generator);
        let found = match session(seed, &of) {
            Ok(found) => found,
            Err(error) => {
                println!("{seed}: {error} {of:?}");
                refused += 1;
                continue;
            }
        };
        let (lag, drift) = (found.lag_s - of.lag_s, found.drift - of.drift);
        near += usize::from(lag.abs() < 5e-4);
        if of.span_s >= 120.0 {
            long += 1;
            steady += usize::from(drift.abs() < 2e-5);
        }
        covered += usize::from(lag.abs() < 1.96 * found.sigmas[0]);
        of_drift += usize::from(drift.abs() < 1.96 * found.sigmas[1]);
        ratios.push(found.expected_mm / found.true_mm);
        println!(
            "{seed}: lag off by {:.4} ms (σ {:.4}), drift by {:.2} ppm (σ {:.2}); error {:.4} mm, expected {:.4}; {:.0} s, {} poses {}, stops {}",
            1e3 * lag,
            1e3 * found.sigmas[0],
            1e6 * drift,
            1e6 * found.sigmas[1],
            found.true_mm,
            found.expected_mm,
            of.span_s,
            of.rate,
            of.is_posed,
            of.stops
        );
    }
    println!(
        "of {all}: {refused} refused, lag within 0.5 ms {near}, drift within 20 ppm {steady} of {long} from 120 s on, 95 % intervals right {covered} and {of_drift}"
    );
    let made = all - refused;
    assert!(refused * 50 <= all && near * 100 >= 95 * all && steady * 100 >= 95 * long);
    assert!(covered * 100 >= (92 - 12 * usize::from(made < 100)) * made);
}

#[test]
fn stamps_that_are_late_irregularly_are_part_of_the_lag_by_their_mean() {
    const LATE_S: f64 = 0.01;
    let all = trials(60).at_least(4).count;
    let (mut near, mut honest) = (0, 0);
    for seed in 0..all as u64 {
        let mut generator = ChaCha8Rng::seed_from_u64(3000 + seed);
        let of = Recorded { late_s: LATE_S, ..draw_recording(&mut generator) };
        let found = session(seed, &of).unwrap();
        let lag = found.lag_s - of.lag_s - LATE_S;
        // With few rows the mean itself is uncertain: three of its standard deviations are added.
        let of_mean = 3.0 * LATE_S / (of.span_s * of.rate).sqrt();
        near += usize::from(lag.abs() < 1e-3 + of_mean);
        honest += usize::from(found.true_mm < 2.0 * found.expected_mm);
        println!(
            "{seed}: lag off by {:.3} ms; error {:.3} mm, expected {:.3}; {:.0} s at {}",
            1e3 * lag,
            found.true_mm,
            found.expected_mm,
            of.span_s,
            of.rate
        );
    }
    println!("of {all}: {near} within 1 ms of the mean, {honest} with errors below twice the expected one");
    assert!(near * 100 >= 95 * all && honest * 100 >= 95 * all, "{near} {honest}");
}

#[test]
fn recordings_in_motion_of_different_sessions_are_refused_however_short() {
    for seed in 0..8 {
        let mut generator = ChaCha8Rng::seed_from_u64(7000 + seed);
        let span_s = [6.0, 12.0, 40.0][seed as usize % 3];
        let of = Recorded { span_s, is_other: true, lag_s: 0.0, ..draw_recording(&mut generator) };
        let error = session(seed, &of).err().unwrap_or_default();
        println!("{span_s} s: {error}");
        assert!(error.contains("at no lag") || error.contains("no lag of the clocks"), "{seed}: {error}");
        assert!(!error.contains("like --lag"), "{error}");
    }
}

#[test]
fn a_program_in_motion_that_repeats_itself_has_no_wrong_lag() {
    let all = trials(40).at_least(3).count;
    let (mut refused, mut right) = (0, 0);
    for seed in 0..all as u64 {
        let mut generator = ChaCha8Rng::seed_from_u64(5000 + seed);
        let of = Recorded {
            repeats: Some(4 + (generator.next_u64() % 4) as usize),
            span_s: 60.0,
            ..draw_recording(&mut generator)
        };
        match session(seed, &of) {
            Ok(found) => {
                println!("{seed}: lag off by {:.3} ms", 1e3 * (found.lag_s - of.lag_s));
                right += usize::from((found.lag_s - of.lag_s).abs() < 1e-3);
            }
            Err(error) => {
                refused +=
                    usize::from(error.contains("at several lags of the clocks alike") && error.contains("--lag"));
                if refused == 1 {
                    println!("{error}");
                }
            }
        }
    }
    println!("of {all}: {refused} refused, {right} right");
    assert_eq!(refused + right, all);
}
