//! Joint offsets as screws and back: exact in both directions for all robots; and the result if robots differ by more than offsets.

use std::f64::consts::PI;

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, Screw, rotation};
use poecal_model::offsets::{EndConstraint, OffsetExplanation, OffsetOptions, explain, explain_screws, into_screws};
use poecal_model::robot::{Joint, JointKind, Reading, Robot};
use poecal_model::simulate::{
    Simulation, elbow, gantry, random, random_chain, random_configuration, scara, seven_axis,
};
use poecal_numerics::error::ErrorKind;
use poecal_testing::largest::larger_or_nan;
use poecal_testing::sessions::random_twist;
use poecal_testing::trials::trials;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

/// Rounding of products of up to nine motions of a robot of metres.
const EXACT: f64 = 1e-12;

fn robots() -> Vec<Robot> {
    let random = (0..20).map(|seed| random_chain(3 + seed as usize % 7, seed));
    [elbow(), scara(), gantry(), seven_axis()].into_iter().chain(random).collect()
}

/// Random offsets up to `angle_deg`, and of 50 mm.
fn random_offsets(robot: &Robot, angle_deg: f64, generator: &mut ChaCha8Rng) -> Vec<f64> {
    let sizes = robot.joints.iter().map(|joint| match joint.kind {
        JointKind::Revolute => angle_deg.to_radians(),
        JointKind::Prismatic => 0.05,
    });
    sizes.map(|size| size * (2.0 * random::uniform_number(generator) - 1.0)).collect()
}

/// Largest distance and angle between `base * robot(θ + offsets) * tip` and `other(θ)` on random configurations.
fn difference(robot: &Robot, offsets: &[f64], ends: [&Pose; 2], other: &Robot, generator: &mut ChaCha8Rng) -> f64 {
    let mut largest = 0.0_f64;
    for _ in 0..100 {
        let readings = random_configuration(robot, generator);
        let values: Vec<f64> = robot.joint_values(&readings).iter().zip(offsets).map(|(v, o)| v + o).collect();
        let tip = *ends[0] * robot.motion(&values) * robot.home * *ends[1];
        let expected = other.forward_kinematics(&readings);
        largest = larger_or_nan(largest, (tip.translation - expected.translation).norm());
        largest = larger_or_nan(largest, rotation::log(&(tip.rotation * expected.rotation.transpose())).norm());
    }
    largest
}

/// Largest difference of offsets that are determined.
fn offset_error(found: &OffsetExplanation, put_in: &[f64]) -> f64 {
    let determined = (0..put_in.len()).filter(|joint| !found.undetermined.contains(joint));
    determined.map(|joint| (found.offsets[joint] - put_in[joint]).abs()).fold(0.0, larger_or_nan)
}

/// Largest remainder of screws and home pose.
fn remainder(found: &OffsetExplanation) -> f64 {
    let joints = found.joints.iter().flat_map(|joint| [joint.tilt_rad, joint.shift_m.unwrap_or(0.0)]);
    let home = found.home.iter().flat_map(|home| [home.position_m, home.rotation_rad]);
    joints.chain(home).fold(0.0, larger_or_nan)
}

#[test]
fn offsets_become_screws_and_offsets_again() {
    for angle_deg in [5.0, 170.0] {
        let mut worst = [0.0_f64; 4];
        for (seed, robot) in robots().iter().enumerate() {
            let mut generator = ChaCha8Rng::seed_from_u64(seed as u64);
            let offsets = random_offsets(robot, angle_deg, &mut generator);
            let actual = into_screws(robot, &offsets).unwrap();
            let found = explain(robot, &actual, &OffsetOptions::default()).unwrap();
            let identity = Pose::identity();
            let same = difference(robot, &offsets, [&identity; 2], &actual, &mut generator);
            let back = into_screws(robot, &found.offsets).unwrap();
            let zero = vec![0.0; offsets.len()];
            let predicted = difference(&back, &zero, [&identity; 2], &actual, &mut generator);
            let figures = [
                same,
                offset_error(&found, &offsets),
                remainder(&found),
                larger_or_nan(predicted, found.with_offsets.max_m),
            ];
            let words = figures.map(|figure| format!("{figure:.0e}")).join(" ");
            println!("{} ±{angle_deg}°: {words}, not told {:?}", robot.name, found.undetermined);
            assert!(found.undetermined.is_empty(), "{}: {:?}", robot.name, found.undetermined);
            worst.iter_mut().zip(figures).for_each(|(worst, figure)| *worst = larger_or_nan(*worst, figure));
        }
        println!(
            "±{angle_deg}°: f'(θ) = f(θ+δ) {:.1e}, offsets {:.1e}, remainder {:.1e}, prediction {:.1e}",
            worst[0], worst[1], worst[2], worst[3]
        );
        assert!(worst.iter().all(|&figure| figure < EXACT), "{worst:?}");
    }
}

#[test]
fn free_base_and_tip_are_found_too() {
    let mut worst = [0.0_f64; 3];
    for (seed, robot) in robots().iter().enumerate() {
        // Small offsets are the easy case; every third robot has them.
        for &angle_deg in if seed % 3 == 0 { [170.0, 5.0].as_slice() } else { &[170.0] } {
            let mut generator = ChaCha8Rng::seed_from_u64(100 + seed as u64);
            let offsets = random_offsets(robot, angle_deg, &mut generator);
            let mut actual = into_screws(robot, &offsets).unwrap();
            let base = Pose::exp(&random_twist(2.0, 0.5, &mut generator));
            for joint in &mut actual.joints {
                joint.screw = joint.screw.transform(&base);
                joint.frame = base * joint.frame;
            }
            actual.home = base * actual.home * Pose::exp(&random_twist(1.0, 0.3, &mut generator));
            let options =
                OffsetOptions { base: EndConstraint::Free, tip: EndConstraint::Free, ..OffsetOptions::default() };
            let found = explain(robot, &actual, &options).unwrap();
            let ends = [&found.base_motion, &found.tip_motion];
            let predicted = difference(robot, &found.offsets, ends, &actual, &mut generator);
            let figures = [offset_error(&found, &offsets), remainder(&found), predicted];
            let words = figures.map(|figure| format!("{figure:.0e}")).join(" ");
            println!("{} ±{angle_deg}°: {words}, not told {:?}", robot.name, found.undetermined);
            let last = robot.joints.len() - 1;
            assert!(found.undetermined.contains(&0) && found.undetermined.contains(&last));
            assert!(found.offsets[0].abs() < EXACT && found.offsets[last].abs() < EXACT);
            worst.iter_mut().zip(figures).for_each(|(worst, figure)| *worst = larger_or_nan(*worst, figure));
        }
    }
    println!("offsets {:.1e}, remainder {:.1e}, prediction {:.1e}", worst[0], worst[1], worst[2]);
    assert!(worst.iter().all(|&figure| figure < EXACT), "{worst:?}");
}

#[test]
fn what_cannot_be_told_is_named_and_as_small_as_possible() {
    // Two coaxial joints: only the sum of their offsets is determined, and each has half of it.
    let axis = Screw::revolute(&Vector3::z(), &Vector3::zeros());
    let arm = Screw::revolute(&Vector3::y(), &Vector3::new(0.3, 0.0, 0.2));
    let joints = vec![Joint::revolute("a", axis), Joint::revolute("b", axis), Joint::revolute("c", arm)];
    let robot = Robot::new("coaxial", joints, Pose::from_translation(Vector3::new(0.8, 0.1, 0.2))).unwrap();
    let actual = into_screws(&robot, &[0.3, 0.1, -0.7]).unwrap();
    let found = explain(&robot, &actual, &OffsetOptions::default()).unwrap();
    assert_eq!(found.undetermined, [0, 1]);
    let half = [found.offsets[0] - 0.2, found.offsets[1] - 0.2, found.offsets[2] + 0.7];
    assert!(half.iter().all(|error| error.abs() < EXACT), "{:?}", found.offsets);
    assert!(remainder(&found) < EXACT && found.with_offsets.max_m < EXACT);
    // The tool is refitted: the tip can replace the last joint's offset.
    let options = OffsetOptions { tip: EndConstraint::Free, ..OffsetOptions::default() };
    let found = explain(&elbow(), &into_screws(&elbow(), &[0.1; 6]).unwrap(), &options).unwrap();
    assert_eq!(found.undetermined, [5]);
    assert!(found.home.is_none() && found.offsets[5].abs() < EXACT && found.with_offsets.max_m < EXACT);
    // With one joint and a free tip, no offset is determined.
    let single = Robot::new("single", vec![Joint::revolute("a", arm)], Pose::identity()).unwrap();
    let found = explain(&single, &into_screws(&single, &[0.5]).unwrap(), &options).unwrap();
    assert_eq!((found.undetermined.as_slice(), found.offsets.as_slice()), (&[0][..], &[0.0][..]));
    assert!(found.with_offsets.max_m < EXACT);
    // Only parallel axes follow the third joint of a SCARA, which slides along them.
    let found = explain(&scara(), &into_screws(&scara(), &[0.1, 0.2, 0.03, 0.4]).unwrap(), &options).unwrap();
    assert_eq!(found.undetermined, [2, 3]);
    // A model that states 90° as 1.5708 rad has two axes that are nearly one; that difference determines nothing.
    let mut rounded = robot.clone();
    let tilt = Pose::from_xyz_rpy([0.0; 3], [3.7e-6, 0.0, 0.0]);
    rounded.joints[1].screw = axis.transform(&tilt);
    let mut actual = into_screws(&rounded, &[0.02, 0.01, -0.03]).unwrap();
    actual.joints[1].screw = actual.joints[1].screw.transform(&Pose::from_xyz_rpy([0.0; 3], [0.0, 0.002, 0.0]));
    let found = explain(&rounded, &actual, &OffsetOptions::default()).unwrap();
    println!("nearly coaxial: {:?}", found.offsets);
    assert_eq!(found.undetermined, [0, 1]);
    assert!((found.offsets[0] - 0.015).abs() < 0.001 && (found.offsets[1] - 0.015).abs() < 0.001);
}

/// Screw errors make offsets as uncertain as they are large; this many times their size is an outlier on well-built arms.
const SCATTER: f64 = 3.0;

#[test]
fn screw_errors_remain_and_hardly_move_the_offsets() {
    let error = Simulation { error_rotation_rad: 0.1f64.to_radians(), error_position_m: 1e-4, ..Simulation::default() };
    for (name, robot) in [("elbow", elbow()), ("seven_axis", seven_axis())] {
        let mut worst = 0.0_f64;
        for seed in trials(50).seeds() {
            let mut generator = ChaCha8Rng::seed_from_u64(seed);
            let offsets = random_offsets(&robot, 2.0, &mut generator);
            let actual = error.perturb(&into_screws(&robot, &offsets).unwrap(), &mut generator);
            let found = explain_screws(&robot, &actual, &OffsetOptions::default()).unwrap();
            worst = larger_or_nan(worst, offset_error(&found, &offsets));
            let tilts = found.joints.iter().map(|joint| joint.tilt_rad);
            let rms = (tilts.map(|tilt| tilt * tilt).sum::<f64>() / offsets.len() as f64).sqrt();
            assert!(rms > 0.2 * error.error_rotation_rad && rms < 2.0 * error.error_rotation_rad, "{rms}");
            assert!(found.with_offsets.rms_m < 0.5 * found.without_offsets.rms_m);
        }
        println!("{name}: 0.1° of screw errors move offsets by up to {:.3}°", worst.to_degrees());
        assert!(worst < SCATTER * error.error_rotation_rad, "{worst}");
    }
}

/// A remainder above this many times the squares of the screw errors would be another minimum.
const OTHER_MINIMUM: f64 = 4.0;

#[test]
fn the_least_minimum_is_found_beside_screw_errors_of_one_degree() {
    let error = Simulation { error_position_m: 1e-3, ..Simulation::default() };
    let (mut worst, mut count) = (0.0_f64, 0);
    for robot in robots() {
        let length_m = robot.arm_m() / 3.0;
        let put_in_m2 = (length_m * error.error_rotation_rad).powi(2) + error.error_position_m.powi(2);
        for (seed, end) in
            trials(10).seeds().flat_map(|seed| [(seed, EndConstraint::Kept), (seed, EndConstraint::Free)])
        {
            let mut generator = ChaCha8Rng::seed_from_u64(seed);
            let offsets = random_offsets(&robot, 170.0, &mut generator);
            let actual = error.perturb(&into_screws(&robot, &offsets).unwrap(), &mut generator);
            let options = OffsetOptions { base: end, tip: end, configurations: 1, ..OffsetOptions::default() };
            let found = explain_screws(&robot, &actual, &options).unwrap();
            let joints = found.joints.iter().map(|joint| (joint.tilt_rad, joint.shift_m.unwrap_or(0.0)));
            let home = found.home.iter().map(|home| (home.rotation_rad, home.position_m));
            let left_m2: f64 = joints.chain(home).map(|(turn, shift)| (length_m * turn).powi(2) + shift.powi(2)).sum();
            worst = larger_or_nan(worst, left_m2 / put_in_m2 / (robot.joints.len() + 1) as f64);
            count += 1;
        }
    }
    println!("{count} explanations leave at most {worst:.2} of the squares put in");
    assert!(worst < OTHER_MINIMUM, "{worst}");
}

#[test]
fn a_screw_error_that_no_offset_can_make_is_the_remainder() {
    // No offset moves the first screw of a kept base.
    let mut actual = elbow();
    let tilt = Pose::from_xyz_rpy([0.0; 3], [0.001, 0.0, 0.0]);
    actual.joints[0].screw = actual.joints[0].screw.transform(&tilt);
    let found = explain_screws(&elbow(), &actual, &OffsetOptions::default()).unwrap();
    assert!((found.joints[0].tilt_rad - 0.001).abs() < 1e-9, "{:?}", found.joints[0]);
    assert!(found.offsets.iter().all(|offset| offset.abs() < 1e-9));
    assert!(found.joints[1..].iter().all(|joint| joint.tilt_rad < 1e-9));
}

#[test]
fn offsets_of_half_a_turn_are_positive() {
    let mut offsets = [0.0; 6];
    offsets[3] = -PI;
    let found = explain(&elbow(), &into_screws(&elbow(), &offsets).unwrap(), &OffsetOptions::default()).unwrap();
    assert!((found.offsets[3].abs() - PI).abs() < EXACT && found.offsets[3] > -PI, "{:?}", found.offsets);
}

#[test]
fn mimic_joints_frames_limits_and_targets() {
    let mut robot = scara();
    robot.joints[1].reading = Reading { name: "joint1".into(), multiplier: -0.5, offset: 0.1 };
    robot.targets = vec![("ball".into(), Pose::from_translation(Vector3::x()))];
    let offsets = [0.2, -0.3, 0.01, 0.4];
    let actual = into_screws(&robot, &offsets).unwrap();
    let mut generator = ChaCha8Rng::seed_from_u64(7);
    assert!(difference(&robot, &offsets, [&Pose::identity(); 2], &actual, &mut generator) < EXACT);
    assert_eq!(actual.targets, robot.targets);
    let mut motion = Pose::identity();
    for ((joint, before), offset) in actual.joints.iter().zip(&robot.joints).zip(offsets) {
        motion = motion * before.screw.exp(offset);
        assert!(((motion * before.frame).rotation - joint.frame.rotation).norm() < EXACT);
        assert!((joint.screw.nearest_point(&joint.frame.translation) - joint.frame.translation).norm() < EXACT);
        assert_eq!((joint.limits, &joint.reading), (before.limits, &before.reading));
    }
    assert!(offset_error(&explain(&robot, &actual, &OffsetOptions::default()).unwrap(), &offsets) < EXACT);
}

#[test]
fn robots_that_are_not_one_are_refused() {
    let message = |nominal: &Robot, actual: &Robot| {
        let error = explain(nominal, actual, &OffsetOptions::default()).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Option);
        error.to_string()
    };
    assert_eq!(
        message(&elbow(), &scara()),
        "found an actual robot of 4 joints, expected the 6 of the nominal one: compare two models of one robot"
    );
    assert_eq!(
        message(&elbow(), &gantry()),
        "found the prismatic joint `joint1` in the actual robot, expected a revolute one as in the nominal robot"
    );
    let mut renamed = elbow();
    renamed.joints.swap(2, 3);
    assert_eq!(
        message(&elbow(), &renamed),
        "found joint `joint4` at place 3 of the actual robot, expected `joint3` as in the nominal one: compare two models of one robot"
    );
    let mut mimic = elbow();
    mimic.joints[2].reading.name = "joint2".into();
    assert_eq!(
        message(&elbow(), &mimic),
        "found joint `joint3` with another relation to its reading in the actual robot, expected the same mimic relation as in the nominal one"
    );
    let wrong = |offsets: &[f64]| into_screws(&elbow(), offsets).unwrap_err().to_string();
    assert_eq!(wrong(&[0.0; 5]), "found 5 offsets for robot `googol_elbow`, expected one for each of its 6 joints");
    assert_eq!(
        wrong(&[0.0, f64::NAN, 0.0, 0.0, 0.0, 0.0]),
        "found the offset NaN of joint `joint2`, expected a finite one"
    );
}
