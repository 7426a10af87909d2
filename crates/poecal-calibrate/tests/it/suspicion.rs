//! A joint with a bad transmission, or with a larger axis error than the others, is named; a sound robot raises no suspicion.

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, rotation};
use poecal_calibrate::calibrate;
use poecal_model::measurement::{Dataset, Measurement};
use poecal_model::offsets::into_screws;
use poecal_model::robot::{JointKind, Robot, Sizes};
use poecal_model::simulate::{SessionKind, Simulation, elbow, gantry, random, random_configuration, scara, seven_axis};
use poecal_testing::sessions::geometry;
use poecal_testing::trials::trials;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;
use rayon::prelude::*;

/// Noise of the simulated points, metres.
const NOISE_M: f64 = 5e-5;

/// The suspicious joints with the words about them.
fn name_suspects(robot: &Robot, data: &Dataset) -> Vec<(usize, String)> {
    let found = calibrate(robot, data, &geometry()).unwrap();
    let joints = found.trust.joints.into_iter().enumerate();
    joints.filter_map(|(joint, it)| Some((joint, it.suspicious?))).collect()
}

/// Points of a robot one of whose joints errs by `amplitude` twice a turn (sliding: as a bow).
fn with_bad_transmission(robot: &Robot, joint: usize, amplitude: f64, seed: u64) -> Dataset {
    let simulation = Simulation { seed, ..Simulation::default() };
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    let actual = simulation.perturb(robot, &mut generator);
    let mut data = Dataset::new(robot.reading_names());
    for _ in 0..200 {
        let readings = random_configuration(robot, &mut generator);
        let mut turned = readings.clone();
        turned[joint] += match robot.joints[joint].kind {
            JointKind::Revolute => amplitude * (2.0 * readings[joint] + 0.4).sin(),
            JointKind::Prismatic => amplitude * (readings[joint] * 8.0).cos(),
        };
        // A point beside the last axis, so that every joint moves it.
        let seen = actual.forward_kinematics(&turned).act(&Vector3::new(0.1, 0.02, 0.05));
        let position = seen + random::normal_vector(&mut generator) * NOISE_M;
        data.push(&readings, None, Measurement::point(position)).unwrap();
    }
    data
}

#[test]
fn a_bad_transmission_is_named() {
    let (mut right, mut all) = (0, 0);
    let seeds = trials(5).seeds();
    for robot in [elbow(), seven_axis(), scara(), gantry()] {
        for joint in 0..robot.joints.len() {
            let amplitude = match robot.joints[joint].kind {
                JointKind::Revolute => 1e-3,
                JointKind::Prismatic => 3e-4,
            };
            let found: Vec<_> = (seeds.clone())
                .into_par_iter()
                .map(|seed| name_suspects(&robot, &with_bad_transmission(&robot, joint, amplitude, 40 + seed)))
                .collect();
            let hits = found
                .iter()
                .filter(|it| it.iter().any(|(named, words)| *named == joint && words.contains("follow its position")));
            let hits = hits.count();
            println!("{:12} {:12} {hits} of {seeds:?}: {:?}", robot.name, robot.joints[joint].name, found[0]);
            right += hits;
            all += found.len();
        }
    }
    println!("{right} of {all} bad transmissions named");
    assert!(right * 10 >= all * 9);
}

#[test]
fn an_axis_that_stands_out_is_named() {
    let (mut right, mut others, mut all) = (0, 0, 0);
    for robot in [elbow(), seven_axis()] {
        for joint in 0..robot.joints.len() {
            let simulation = Simulation {
                error_rotation_rad: 3e-3,
                error_position_m: 4e-4,
                count: 100,
                seed: 7 + joint as u64,
                ..Simulation::default()
            };
            let mut generator = ChaCha8Rng::seed_from_u64(simulation.seed);
            let mut actual = simulation.perturb(&robot, &mut generator);
            let origin = robot.joints[joint].frame.translation;
            let z = robot.joints[joint].screw.direction();
            let across = z.cross(&random::direction(&mut generator)).normalize();
            let turn = rotation::exp(&(across * 0.05));
            let shift = z.cross(&across) * 8e-3;
            let motion = Pose::new(turn, origin + shift - turn * origin);
            let mut screws: Vec<_> = actual.joints.iter().map(|joint| joint.screw).collect();
            screws[joint] = screws[joint].transform(&motion);
            actual = actual.with_screws(&screws);
            let made = simulation.measure(&robot, actual, SessionKind::POSE, &mut generator).unwrap();
            let found = name_suspects(&made.nominal, &made.data);
            println!("{:12} {:12} {found:?}", robot.name, robot.joints[joint].name);
            right += usize::from(found.iter().any(|(named, _)| *named == joint));
            others += found.iter().filter(|(named, _)| *named != joint).count();
            all += 1;
        }
    }
    println!("{right} of {all} axes named, {others} others");
    // With the device anywhere, an error of the first axis is also one of all the others.
    assert!(right + 2 >= all && others <= 2);
}

/// Fault of a robot beside its usual errors.
#[derive(Clone, Copy, Debug)]
enum Fault {
    Nothing,
    Zero(usize),
    Axis(usize),
}

/// Sizes of the faults, radians.
const ZERO_RAD: f64 = 0.2 * std::f64::consts::PI / 180.0;
const AXIS_RAD: f64 = 0.1 * std::f64::consts::PI / 180.0;

/// A session of a robot with a fault of some size, usual errors of all axes, compliant joints, and a device anywhere.
fn faulty_session(robot: &Robot, fault: Fault, seed: u64) -> Dataset {
    let mut generator = ChaCha8Rng::seed_from_u64(seed ^ 0xfa_017);
    let sign = if random::uniform_number(&mut generator) < 0.5 { -1.0 } else { 1.0 };
    let actual = match fault {
        Fault::Nothing => robot.clone(),
        Fault::Zero(joint) => {
            let offsets: Vec<f64> =
                (0..robot.joints.len()).map(|k| if k == joint { sign * ZERO_RAD } else { 0.0 }).collect();
            into_screws(robot, &offsets).unwrap()
        }
        Fault::Axis(joint) => {
            let origin = robot.joints[joint].frame.translation;
            let z = robot.joints[joint].screw.direction();
            let across = z.cross(&random::direction(&mut generator)).normalize();
            let turn = rotation::exp(&(across * AXIS_RAD));
            let mut screws: Vec<_> = robot.joints.iter().map(|joint| joint.screw).collect();
            screws[joint] = screws[joint].transform(&Pose::new(turn, origin - turn * origin));
            robot.with_screws(&screws)
        }
    };
    let simulation = Simulation {
        error_rotation_rad: 0.03f64.to_radians(),
        error_position_m: 2e-4,
        noise_position_m: NOISE_M,
        count: 60,
        terms: Sizes::SMALL,
        seed,
        ..Simulation::default()
    };
    let kind = if (seed / 8).is_multiple_of(2) { SessionKind::POSE } else { SessionKind::POINT };
    simulation.run(&actual, kind).unwrap().data
}

/// The robot with its tip beside the last axis, so that a reflector shows the turn of the last joint.
fn with_tool(robot: Robot) -> Robot {
    let tool = Pose::from_translation(Vector3::new(0.1, 0.05, 0.1));
    Robot { home: robot.home * tool, ..robot }
}

/// A fault is attributed to its joint for any device frame and tool: zeros between the first joint, whose zero the base absorbs, and the last, whose
/// zero the tool absorbs, and axes of all joints.
#[test]
fn the_joint_that_is_off_is_named() {
    let robots = [elbow(), seven_axis()].map(with_tool);
    let trials = trials(200).at_least(30);
    let judged = |seed: u64, fault: Fault| {
        let robot = &robots[seed as usize % robots.len()];
        let found = calibrate(robot, &faulty_session(robot, fault, 3000 + seed), &geometry()).unwrap();
        let joints = found.trust.joints.iter().enumerate();
        let named: Vec<(usize, String)> = joints
            .filter_map(|(joint, it)| Some((joint, it.suspicious.clone()?)))
            .filter(|(_, words)| words.starts_with("its "))
            .collect();
        (fault, named)
    };
    let of = |seed: u64| {
        let count = robots[seed as usize % robots.len()].joints.len() as u64;
        if seed % 4 < 2 {
            Fault::Zero((1 + seed / 4 % (count - 2)) as usize)
        } else {
            Fault::Axis((seed / 4 % count) as usize)
        }
    };
    let found: Vec<_> = trials.seeds().into_par_iter().map(|seed| judged(seed, of(seed))).collect();
    let (mut right, mut both, mut alone) = (0, 0, 0);
    for (fault, named) in &found {
        let (Fault::Zero(joint) | Fault::Axis(joint)) = *fault else { unreachable!() };
        let is_right = named.iter().any(|(at, _)| *at == joint);
        right += usize::from(is_right);
        both += usize::from(named.len() > 1);
        alone += usize::from(is_right && named.len() == 1);
        if !is_right || named.len() > 1 {
            println!("{fault:?}: {named:?}");
        }
    }
    let sound: Vec<_> = trials.seeds().into_par_iter().map(|seed| judged(seed, Fault::Nothing)).collect();
    let alarms = sound.iter().filter(|(_, named)| !named.is_empty()).count();
    let count = found.len();
    println!("{right} of {count} faults named, {alone} alone, {both} with another; {alarms} sound robots suspected");
    let share = |allowed: f64| (allowed + trials.more_of_a_share(allowed)) * count as f64;
    assert!((count - right) as f64 <= share(0.03));
    assert!(both as f64 <= share(0.2));
    assert!(alarms as f64 <= share(0.06));
}

#[test]
fn sound_robots_are_not_suspected() {
    let robots = [elbow(), scara(), seven_axis(), gantry()];
    let sessions = trials(400);
    let false_alarms: usize = (sessions.seeds())
        .into_par_iter()
        .map(|seed| {
            let simulation = Simulation { seed: 900 + seed, count: 60, ..Simulation::default() };
            let kind = if seed % 2 == 0 { SessionKind::POSE } else { SessionKind::POINT };
            let made = simulation.run(&robots[seed as usize / 2 % 4], kind).unwrap();
            name_suspects(&made.nominal, &made.data).len()
        })
        .sum();
    println!("{false_alarms} false alarms on {} sound robots", sessions.count);
    assert!(false_alarms as f64 <= (0.01 + sessions.more_of_a_share(0.01)) * sessions.count as f64);
}
