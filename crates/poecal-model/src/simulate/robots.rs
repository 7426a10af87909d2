//! Robots to simulate: the paper's elbow and other structures.

use nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::random;
use crate::robot::{Joint, JointLimits, Robot};
use poecal_arm::lie::{Pose, Screw, rotation};

/// A robot of joints and a home pose that are known to be valid.
fn robot(name: &str, joints: Vec<Joint>, home: Pose) -> Robot {
    Robot {
        name: name.to_owned(),
        base_name: "base_link".to_owned(),
        tip_name: "tool".to_owned(),
        joints,
        tip: None,
        home,
        targets: Vec::new(),
        mounted: Vec::new(),
        terms: Vec::new(),
        gravity: None,
        masses: Vec::new(),
        factors: Vec::new(),
        instruments: Vec::new(),
    }
}

fn revolute(index: usize, direction: [f64; 3], point: [f64; 3], lower_deg: f64, upper_deg: f64) -> Joint {
    let point = Vector3::from(point);
    let mut joint = Joint::revolute(&format!("joint{}", index + 1), Screw::revolute(&Vector3::from(direction), &point));
    joint.frame.translation = point;
    joint.limits = Some(JointLimits { lower: lower_deg.to_radians(), upper: upper_deg.to_radians() });
    joint
}

fn prismatic(index: usize, direction: [f64; 3], lower: f64, upper: f64) -> Joint {
    let screw = Screw::prismatic(&Vector3::from(direction));
    let mut joint = Joint::prismatic(&format!("joint{}", index + 1), screw);
    joint.limits = Some(JointLimits { lower, upper });
    joint
}

fn pose_at(x: f64, y: f64, z: f64) -> Pose {
    Pose::from_translation(Vector3::new(x, y, z))
}

/// The Googol elbow of lou2009: Table I (lengths, limits) and the nominal screws of Table II.
#[must_use]
pub fn elbow() -> Robot {
    let joints = vec![
        revolute(0, [0.0, 0.0, 1.0], [0.0, 0.0, 0.0], -180.0, 180.0),
        revolute(1, [0.0, 1.0, 0.0], [0.150, 0.0, 0.0], -105.0, 175.0),
        revolute(2, [0.0, -1.0, 0.0], [0.150, 0.0, 0.570], -235.0, 85.0),
        revolute(3, [-1.0, 0.0, 0.0], [0.150, 0.0, 0.720], -180.0, 180.0),
        revolute(4, [0.0, 1.0, 0.0], [0.784, 0.0, 0.720], -40.0, 220.0),
        revolute(5, [-1.0, 0.0, 0.0], [0.784, 0.0, 0.720], -360.0, 360.0),
    ];
    robot("googol_elbow", joints, pose_at(0.834, 0.0, 0.720))
}

/// A SCARA: two parallel revolute joints, a prismatic one and a last revolute one.
#[must_use]
pub fn scara() -> Robot {
    let joints = vec![
        revolute(0, [0.0, 0.0, 1.0], [0.0, 0.0, 0.2], -140.0, 140.0),
        revolute(1, [0.0, 0.0, 1.0], [0.35, 0.0, 0.2], -150.0, 150.0),
        prismatic(2, [0.0, 0.0, -1.0], 0.0, 0.25),
        revolute(3, [0.0, 0.0, 1.0], [0.60, 0.0, 0.2], -180.0, 180.0),
    ];
    robot("scara", joints, pose_at(0.64, 0.02, 0.15))
}

/// A gantry of three prismatic joints with a three-axis wrist.
#[must_use]
pub fn gantry() -> Robot {
    let joints = vec![
        prismatic(0, [1.0, 0.0, 0.0], -0.8, 0.8),
        prismatic(1, [0.0, 1.0, 0.0], -0.6, 0.6),
        prismatic(2, [0.0, 0.0, 1.0], -0.4, 0.4),
        revolute(3, [0.0, 0.0, 1.0], [0.0, 0.0, 1.0], -180.0, 180.0),
        revolute(4, [0.0, 1.0, 0.0], [0.0, 0.0, 0.9], -110.0, 110.0),
        revolute(5, [0.0, 0.0, 1.0], [0.03, 0.0, 0.8], -180.0, 180.0),
    ];
    robot("gantry", joints, pose_at(0.05, 0.02, 0.7))
}

/// A seven-axis arm of the usual alternating kind.
#[must_use]
pub fn seven_axis() -> Robot {
    let joints = vec![
        revolute(0, [0.0, 0.0, 1.0], [0.0, 0.0, 0.0], -170.0, 170.0),
        revolute(1, [0.0, 1.0, 0.0], [0.0, 0.0, 0.34], -120.0, 120.0),
        revolute(2, [0.0, 0.0, 1.0], [0.0, 0.0, 0.5], -170.0, 170.0),
        revolute(3, [0.0, -1.0, 0.0], [0.0, 0.0, 0.74], -120.0, 120.0),
        revolute(4, [0.0, 0.0, 1.0], [0.0, 0.0, 0.9], -170.0, 170.0),
        revolute(5, [0.0, 1.0, 0.0], [0.0, 0.0, 1.14], -120.0, 120.0),
        revolute(6, [0.0, 0.0, 1.0], [0.0, 0.0, 1.2], -175.0, 175.0),
    ];
    robot("seven_axis", joints, pose_at(0.04, 0.03, 1.3))
}

/// A chain of `count` joints with random axes, origins and kinds (one in four prismatic, the first and last revolute).
#[must_use]
pub fn random_chain(count: usize, seed: u64) -> Robot {
    let mut generator = ChaCha8Rng::seed_from_u64(seed ^ 0x0c4a_1d00);
    let mut place = Vector3::zeros();
    let joints = (0..count)
        .map(|index| {
            let slides = index > 0 && index + 1 < count && random::uniform_number(&mut generator) < 0.25;
            let direction = random::direction(&mut generator);
            place += random::direction(&mut generator) * (0.1 + 0.3 * random::uniform_number(&mut generator));
            if slides {
                prismatic(index, direction.into(), -0.3, 0.3)
            } else {
                revolute(index, direction.into(), place.into(), -150.0, 150.0)
            }
        })
        .collect();
    let turn = rotation::exp(&(random::direction(&mut generator) * random::uniform_number(&mut generator)));
    let tip = place + random::direction(&mut generator) * 0.2;
    robot(&format!("random_{count}_{seed}"), joints, Pose::new(turn, tip))
}
