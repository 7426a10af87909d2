//! The arm that computes kinematics, compared with the robot from which it is made.

use std::f64::consts::PI;

use nalgebra::Vector3;
use poecal_arm::lie::rotation;
use poecal_arm::{AllBranches, Arm};
use poecal_compensate::Kinematics;
use poecal_model::robot::{Body, CompliantDirections, FactorReading, Gravity, JointTerm, Mass, Robot, Term, TermKind};
use poecal_model::simulate;

use poecal_model::simulate::random;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng as _;

use crate::two_arms::both_hands;
use poecal_testing::sessions::lifting_robot;

/// A number between -1 and 1.
fn draw_number(numbers: &mut ChaCha8Rng) -> f64 {
    2.0 * random::uniform_number(numbers) - 1.0
}

/// A robot whose joints and links deflect in every modelled direction, by up to `size` rad (and m/3).
fn with_compliance_everywhere(robot: &Robot, size: f64, numbers: &mut ChaCha8Rng) -> Robot {
    let all: Vec<usize> = (0..robot.joints.len()).collect();
    let (mut robot, _) = robot.with_compliance(&all, CompliantDirections::All);
    robot.factors = vec![FactorReading { name: "temperature".into(), reference: 20.0 }, FactorReading::new("payload")];
    robot.gravity = Some(Gravity::of_unit_weights(&robot, Vector3::new(0.1, 0.2, -1.0)));
    let bodies = [(1, 3.0), (robot.joints.len() - 1, 1.5)];
    robot.masses =
        bodies.map(|(at, kg)| Mass { body: Body::Link(at), place: random::normal_vector(numbers), kg }).into();
    let weights = robot.gravity.as_ref().unwrap().weights.len();
    for joint in 0..robot.joints.len() {
        let mut terms = vec![Term::OFFSET, Term::RATIO, TermKind::Masses.with_number(0)];
        terms.push(TermKind::Factor.with_index(0));
        terms.push(TermKind::Payload.with_index(1));
        terms.push(TermKind::Coupled.with_index((joint + 7) % robot.joints.len()));
        terms.extend((0..weights).map(|weight| TermKind::Sag.with_index(weight)));
        for order in [1, 2] {
            terms.extend([TermKind::Sine, TermKind::Cosine].map(|it| it.with_number(order)));
        }
        let slides = robot.joints[joint].kind == poecal_model::robot::JointKind::Prismatic;
        let share = if slides { size / 3.0 } else { size } / terms.len() as f64;
        robot.terms.extend(terms.into_iter().map(|term| JointTerm {
            joint,
            term,
            coefficient: share * draw_number(numbers),
        }));
    }
    robot
}

#[test]
fn an_arm_is_where_its_robot_is() {
    let mut numbers = ChaCha8Rng::seed_from_u64(11);
    for (name, robot) in
        [("elbow", simulate::elbow()), ("with a lift", lifting_robot()), ("torso", both_hands("base_link"))]
    {
        let robot = with_compliance_everywhere(&robot, 0.02, &mut numbers);
        let factors = [26.0, 1.5];
        let (arm, readings) = robot.arm(&factors).unwrap();
        let names = robot.reading_names();
        let mut worst = 0.0_f64;
        for _ in 0..200 {
            let q: Vec<f64> = readings.iter().map(|_| PI * draw_number(&mut numbers)).collect();
            let mut all = vec![0.0; names.len()];
            readings.iter().zip(&q).for_each(|(&at, q)| all[at] = *q);
            let count = all.len();
            all[count - 2..].copy_from_slice(&factors);
            let (one, other) = (arm.forward_kinematics(&q), robot.forward_kinematics(&all));
            worst = worst.max((one.translation - other.translation).norm());
            worst = worst.max((one.rotation - other.rotation).norm());
        }
        println!("{name}: {} readings, apart by {worst:.1e}", readings.len());
        assert!(worst < 1e-13, "{name}: {worst}");
    }
}

#[test]
fn branches_of_a_bent_arm_reach_the_pose() {
    let mut numbers = ChaCha8Rng::seed_from_u64(12);
    let robot = with_compliance_everywhere(&simulate::elbow(), 0.005, &mut numbers);
    let (arm, _): (Arm, _) = robot.arm(&[20.0, 2.0]).unwrap();
    let all = AllBranches::new(&arm).unwrap();
    let (mut worst, mut branches, mut own, mut count) = (0.0_f64, 0, 0, 0);
    for _ in 0..500 {
        let q = [0; 6].map(|_| PI * draw_number(&mut numbers));
        if arm.smallest_singular_value(&q) < 0.01 {
            continue;
        }
        count += 1;
        let target = arm.forward_kinematics(&q);
        let found = all.branches_at(&target);
        for branch in found.as_slice() {
            let there = arm.forward_kinematics(branch);
            worst = worst.max((there.translation - target.translation).norm());
            worst = worst.max((there.rotation - target.rotation).norm());
        }
        branches += found.as_slice().len();
        let is_own = |it: &[f64; 6]| it.iter().zip(q).all(|(a, b)| (a - b).abs() < 1e-9);
        own += usize::from(found.as_slice().iter().any(is_own));
    }
    println!("{own} of {count} configurations found among {branches} branches; largest remainder {worst:.1e}");
    assert!(worst < 1e-10 && own == count && branches > 2 * count);
}

/// Readings of this many configurations, one after the other.
fn draw_rows(rows: usize, width: usize, numbers: &mut ChaCha8Rng) -> Vec<f64> {
    (0..rows * width).map(|_| PI * draw_number(numbers)).collect()
}

#[test]
fn many_configurations_are_what_each_is_alone() {
    let mut numbers = ChaCha8Rng::seed_from_u64(12);
    for (name, robot) in
        [("elbow", simulate::elbow()), ("with a lift", lifting_robot()), ("torso", both_hands("base_link"))]
    {
        for size in [0.0, 0.02, 0.4] {
            let factors = [26.0, 1.5];
            let robot =
                if size == 0.0 { robot.clone() } else { with_compliance_everywhere(&robot, size, &mut numbers) };
            let (arm, own) = robot.arm(&factors).unwrap();
            let kinematics = Kinematics::new(&robot, &factors).unwrap();
            let width = robot.joint_reading_names().len();
            let (mut worst, mut equal, mut rows) = (0.0_f64, 0, 0);
            // Also counts that eight does not divide, and more than a thread takes at a time.
            for count in [0, 1, 7, 8, 13, 1100] {
                let readings = draw_rows(count, width, &mut numbers);
                let tips = kinematics.forward_kinematics(&readings);
                let jacobians = kinematics.jacobians(&readings);
                assert_eq!((tips.len(), jacobians.len()), (count, 6 * width * count));
                for (row, all) in readings.chunks_exact(width).enumerate() {
                    let q: Vec<f64> = own.iter().map(|&at| all[at]).collect();
                    let alone = arm.forward_kinematics(&q);
                    worst = worst.max((alone.translation - tips[row].translation).amax());
                    worst = worst.max((alone.rotation - tips[row].rotation).amax());
                    equal += usize::from(alone == tips[row]);
                    rows += 1;
                    for (reading, (v, w)) in arm.jacobian(&q).iter().take(own.len()).enumerate() {
                        for (k, it) in v.iter().chain(w.iter()).enumerate() {
                            let found = jacobians[(6 * row + k) * width + own[reading]];
                            worst = worst.max((found - it).abs());
                        }
                    }
                }
            }
            println!("{name}, terms of {size}: apart by {worst:.1e}; {equal} of {rows} poses the same bits");
            // Rounding of the motions of some twenty joints, up to 2 m.
            assert!(worst < 4e-15, "{name}, {size}: {worst}");
        }
    }
}

#[test]
fn jacobians_are_the_differences_of_poses() {
    let mut numbers = ChaCha8Rng::seed_from_u64(13);
    for (name, robot) in
        [("elbow", simulate::elbow()), ("with a lift", lifting_robot()), ("torso", both_hands("base_link"))]
    {
        let robot = with_compliance_everywhere(&robot, 0.1, &mut numbers);
        let kinematics = Kinematics::new(&robot, &[26.0, 1.5]).unwrap();
        let width = robot.joint_reading_names().len();
        let readings = draw_rows(50, width, &mut numbers);
        let jacobians = kinematics.jacobians(&readings);
        let (mut worst, mut of_weights) = (0.0_f64, 0.0_f64);
        let mut unloaded = robot.clone();
        unloaded.gravity = None;
        unloaded.terms.retain(|it| !it.term.needs_gravity());
        let without = Kinematics::new(&unloaded, &[26.0, 1.5]).unwrap().jacobians(&readings);
        for (it, without) in jacobians.iter().zip(&without) {
            of_weights = of_weights.max((it - without).abs());
        }
        let step = 1e-6;
        for reading in 0..width {
            let moved = |by: f64| {
                let mut moved = readings.clone();
                moved.iter_mut().skip(reading).step_by(width).for_each(|it| *it += by);
                kinematics.forward_kinematics(&moved)
            };
            for (row, (after, before)) in moved(step).iter().zip(moved(-step)).enumerate() {
                let v = (after.translation - before.translation) / (2.0 * step);
                let w = rotation::log(&(after.rotation * before.rotation.transpose())) / (2.0 * step);
                for (k, it) in v.iter().chain(w.iter()).enumerate() {
                    worst = worst.max((jacobians[(6 * row + k) * width + reading] - it).abs());
                }
            }
        }
        println!("{name}: off by {worst:.1e}; what weights add is up to {of_weights:.1e}");
        // Rounding of poses over the step, and its square.
        assert!(worst < 3e-9 && of_weights > 1e-4, "{name}: {worst}, {of_weights}");
    }
}

#[test]
fn sag_is_what_the_terms_of_weights_do() {
    let mut numbers = ChaCha8Rng::seed_from_u64(14);
    for (name, robot) in
        [("elbow", simulate::elbow()), ("with a lift", lifting_robot()), ("torso", both_hands("base_link"))]
    {
        let robot = with_compliance_everywhere(&robot, 0.02, &mut numbers);
        let factors = [26.0, 1.5];
        let mut unloaded = robot.clone();
        unloaded.terms.retain(|it| !it.term.needs_gravity());
        let width = robot.joint_reading_names().len();
        let mut readings = draw_rows(100, width, &mut numbers);
        // Joints of other branches are at zero for an arm.
        let (_, own) = robot.arm(&factors).unwrap();
        readings.iter_mut().enumerate().filter(|(at, _)| !own.contains(&(at % width))).for_each(|(_, it)| *it = 0.0);
        let sag = Kinematics::new(&robot, &factors).unwrap().sag(&readings);
        let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
        for (row, sag) in readings.chunks_exact(width).zip(&sag) {
            let all: Vec<f64> = row.iter().chain(&factors).copied().collect();
            let (with, without) = (robot.forward_kinematics(&all), unloaded.forward_kinematics(&all));
            let shift = with.translation - without.translation;
            let turn = rotation::log(&(with.rotation * without.rotation.transpose()));
            for (it, sag) in shift.iter().chain(turn.iter()).zip(sag) {
                worst = worst.max((it - sag).abs());
                largest = largest.max(it.abs());
            }
        }
        println!("{name}: sag of up to {largest:.1e}, off by {worst:.1e}");
        assert!(worst < 1e-13 && largest > 1e-4, "{name}: {worst}, {largest}");
        assert!(Kinematics::new(&unloaded, &factors).unwrap().sag(&readings).concat().iter().all(|it| *it == 0.0));
    }
}
