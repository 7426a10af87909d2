//! Tips of tools on arms with errors: within their bounds, not determined by three touches that agree, and poses that are the tip's own.

use nalgebra::Vector3;

use super::draw::LinearCongruential;
use super::{FindingKind, HandEyeLevel, TouchedTool, Touches, tool_tip};
use poecal_arm::lie::{Pose, Screw, rotation};
use poecal_model::robot::Robot;
use poecal_model::simulate::elbow;
use poecal_numerics::error::Result;
use poecal_testing::trials::trials;

const TIP: [f64; 3] = [0.15, 0.012, -0.003];
const PIN: [f64; 3] = [0.75, 0.1, 0.35];

/// An arm whose joints deviate from their nominal pose in the joint before, by these standard deviations of angle and position.
fn perturb_arm(nominal: &Robot, rotation_rad: f64, position_m: f64, draw: &mut LinearCongruential) -> Robot {
    let mut motion = Pose::identity();
    let mut screws = Vec::new();
    for joint in &nominal.joints {
        let at = Pose::from_translation(joint.frame.translation);
        let error = Pose::new(rotation::exp(&draw.vector(rotation_rad)), draw.vector(position_m));
        motion = motion * at * error * at.inverse();
        screws
            .push(Screw::revolute(&(motion.rotation * joint.screw.direction()), &motion.act(&joint.frame.translation)));
    }
    let mut actual = nominal.with_screws(&screws);
    actual.home = motion * nominal.home;
    actual
}

/// Pose on the pendant in a configuration near which the actual arm's tip touches the pin, with noise of each component.
fn shown_pose(nominal: &Robot, actual: &Robot, readings: &[f64], noise: Vector3<f64>) -> Pose {
    let pose = nominal.forward_kinematics(readings);
    let error = actual.forward_kinematics(readings) * pose.inverse();
    let (tip, pin) = (Vector3::from(TIP), Vector3::from(PIN));
    let place = error.rotation.transpose() * (pin - error.translation) - pose.rotation * tip;
    Pose::new(pose.rotation, place + noise)
}

/// A configuration whose tool points down, tilted by the fifth joint and turned about itself by the last one.
fn draw_tilted(draw: &mut LinearCongruential) -> Vec<f64> {
    let middle = [0.1, 0.5, -0.4, 0.0, 0.9, 0.0];
    let spread = [0.25, 0.12, 0.12, 0.6, 0.5, 2.4];
    middle.iter().zip(spread).map(|(middle, spread)| middle + spread * (2.0 * draw.uniform_number() - 1.0)).collect()
}

/// Three touches that turn the last joint alone, and two that are tilted.
fn upright_touches() -> [Vec<f64>; 5] {
    let turned = |last: f64| vec![0.1, 0.5, -0.4, 0.0, 0.9, last];
    [turned(0.0), turned(1.6), turned(3.0), vec![0.1, 0.5, -0.4, 0.5, 1.4, 0.4], vec![0.1, 0.5, -0.4, -0.5, 0.4, -0.7]]
}

fn solve_tip(poses: Vec<Pose>) -> Result<TouchedTool> {
    let touches = Touches { flange: poses.into(), ..Touches::default() };
    tool_tip(&touches, &|row| format!("touch {}", row + 1))
}

fn miss_m(found: &TouchedTool) -> f64 {
    (found.tips[0].placed.pose.translation - Vector3::from(TIP)).norm()
}

/// Errors of the axes are 0.03° and 0.2 mm, those of touches 0.1 mm. The bound of each tip is below its length.
#[test]
fn tips_on_arms_with_errors_are_within_their_bounds_as_often_as_promised() {
    let sessions = trials(200).at_least(60);
    let nominal = elbow();
    let (mut inside, mut good, mut bounds) = (0, 0, Vec::new());
    for seed in sessions.seeds() {
        let mut draw = LinearCongruential::new(seed + 300);
        let actual = perturb_arm(&nominal, 0.03f64.to_radians(), 2e-4, &mut draw);
        let count = 4 + (seed % 9) as usize;
        let poses = (0..count).map(|_| {
            let (readings, noise) = (draw_tilted(&mut draw), draw.vector(1e-4));
            shown_pose(&nominal, &actual, &readings, noise)
        });
        let found = solve_tip(poses.collect()).unwrap();
        let bound = found.tips[0].placed.bound95_m;
        inside += usize::from(miss_m(&found) <= bound);
        good += usize::from(found.level == HandEyeLevel::Good);
        bounds.push(1e3 * bound);
        assert!(found.level != HandEyeLevel::DoNotUse && bound < 0.02, "{seed}: {} {:?}", 1e3 * bound, found.reasons);
    }
    bounds.sort_by(f64::total_cmp);
    let share = inside as f64 / sessions.count as f64;
    println!(
        "{inside} of {} inside, bounds {:.2} mm (median), {:.2} mm at most; {good} good",
        sessions.count,
        bounds[bounds.len() / 2],
        bounds[bounds.len() - 1]
    );
    // 95 % of 200 to two standard errors.
    let more = sessions.more_of_a_share(0.95);
    assert!((0.90 - more..=0.98 + more).contains(&share), "{share}");
}

/// Three touches that turn about one axis agree with any length, so that they must not outvote the others.
#[test]
fn touches_that_alone_show_the_length_are_not_left_out() {
    let sessions = trials(120).at_least(40);
    let nominal = elbow();
    let (mut inside, mut worst): (usize, f64) = (0, 0.0);
    for seed in sessions.seeds() {
        let mut draw = LinearCongruential::new(seed + 900);
        let touch = |(at, readings): (usize, &Vec<f64>)| {
            let noise = draw.vector(if at < 3 { 1.5e-4 } else { 4e-3 });
            shown_pose(&nominal, &nominal, readings, noise)
        };
        let found = solve_tip(upright_touches().iter().enumerate().map(touch).collect()).unwrap();
        assert!(found.outliers.is_empty(), "{seed}: {:?}", found.outliers);
        worst = worst.max(miss_m(&found));
        inside += usize::from(miss_m(&found) <= found.tips[0].placed.bound95_m);
        let squares: f64 = found.rows.iter().map(|it| it.shift_m * it.shift_m).sum();
        // Five touches have fifteen numbers for six unknowns.
        assert!((squares / 9.0 - found.sigma_m * found.sigma_m).abs() < 1e-9 * squares);
    }
    let share = inside as f64 / sessions.count as f64;
    println!("{inside} of {} inside, off by {:.1} mm at most", sessions.count, 1e3 * worst);
    // Two tilted touches determine a component to 4 mm; the limit is four standard deviations.
    assert!(share >= 0.88 - sessions.more_of_a_share(0.95) && worst < 0.03, "{share} {worst}");
}

#[test]
fn a_wrong_touch_among_many_is_left_out_and_named() {
    let nominal = elbow();
    let mut draw = LinearCongruential::new(5);
    let mut poses: Vec<Pose> = (0..9)
        .map(|_| {
            let (readings, noise) = (draw_tilted(&mut draw), draw.vector(1e-4));
            shown_pose(&nominal, &nominal, &readings, noise)
        })
        .collect();
    poses[6].translation.x += 4e-3;
    let found = solve_tip(poses).unwrap();
    println!("{:?} {:.3} mm", found.outliers, 1e3 * miss_m(&found));
    assert_eq!(found.outliers, [6]);
    assert!(found.findings.iter().any(|it| it.kind == FindingKind::Outliers));
    // Eight touches have errors of 0.1 mm.
    assert!(miss_m(&found) < 4e-4);
}

#[test]
fn poses_of_the_tip_itself_are_named() {
    let nominal = elbow();
    let mut draw = LinearCongruential::new(8);
    let tip = Pose::from_translation(TIP.into());
    let poses: Vec<Pose> = (0..8)
        .map(|_| {
            let (readings, noise) = (draw_tilted(&mut draw), draw.vector(3e-4));
            shown_pose(&nominal, &nominal, &readings, noise) * tip
        })
        .collect();
    let found = solve_tip(poses).unwrap();
    println!("{:?}", found.reasons);
    assert_eq!(found.level, HandEyeLevel::DoNotUse);
    assert!(found.reasons[0].contains("these are poses of the tip, whose tool was active in the controller"));
}
