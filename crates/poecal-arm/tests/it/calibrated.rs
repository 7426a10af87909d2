//! Nominal arms, and calibrated ones.

use nalgebra::{Matrix6, Vector3, Vector6};
use poecal_arm::Arm;
use poecal_arm::lie::{Pose, Screw, Twist, rotation};

use crate::numbers::Numbers;

/// Joints as (direction, point), and the tip.
type Drawing = (Vec<(Vector3<f64>, [f64; 3])>, [f64; 3]);

pub(crate) const KINDS: [&str; 7] =
    ["three parallel axes", "wrist", "wrist, first axes meet", "shoulder", "offset wrist", "general", "general 2"];

fn drawing(kind: &str) -> Drawing {
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    match kind {
        "three parallel axes" => (
            vec![
                (z, [0.0, 0.0, 0.0]),
                (y, [0.0, 0.0, 0.1625]),
                (y, [0.425, 0.0, 0.1625]),
                (y, [0.8172, 0.0, 0.1625]),
                (-z, [0.8172, 0.1333, 0.0]),
                (y, [0.8172, 0.1333, 0.0628]),
            ],
            [0.8172, 0.2329, 0.0628],
        ),
        "wrist" => (
            vec![
                (z, [0.0, 0.0, 0.0]),
                (y, [0.15, 0.0, 0.45]),
                (y, [0.15, 0.0, 1.05]),
                (x, [0.0, 0.0, 1.25]),
                (y, [0.79, 0.0, 1.25]),
                (x, [0.0, 0.0, 1.25]),
            ],
            [0.9, 0.0, 1.25],
        ),
        "wrist, first axes meet" | "offset wrist" => {
            let last = if kind == "offset wrist" { 0.554 } else { 0.63 };
            (
                vec![
                    (z, [0.0, 0.0, 0.0]),
                    (y, [0.0, 0.0, 0.29]),
                    (y, [0.0, 0.0, 0.56]),
                    (x, [0.0, 0.0, 0.63]),
                    (y, [0.302, 0.0, 0.63]),
                    (x, [0.0, 0.0, last]),
                ],
                [0.374, 0.0, last],
            )
        }
        _ => {
            let mut numbers = Numbers(kind.len() as u64 * 7919);
            let joint = |_| (numbers.vector(), (0.5 * numbers.vector()).into());
            ((0..6).map(joint).collect(), [0.3, -0.2, 0.4])
        }
    }
}

/// An arm whose axes have errors up to these about each direction (rad) and along it (m).
pub(crate) fn arm(kind: &str, angle_rad: f64, length_m: f64) -> Arm {
    let is_shoulder = kind == "shoulder";
    let (joints, tip) = drawing(if is_shoulder { "wrist" } else { kind });
    let mut home = Pose::new(rotation::exp(&Vector3::new(0.2, -0.5, 0.1)), tip.into());
    let mut screws: Vec<Screw> = joints.iter().map(|(w, at)| Screw::revolute(w, &(*at).into())).collect();
    if is_shoulder {
        // The same arm, held at its tip.
        home = home.inverse();
        screws = screws.iter().rev().map(|screw| screw.transform(&home)).collect();
    }
    let mut numbers = Numbers(2009);
    for screw in &mut screws {
        let at = Pose::from_translation(screw.nearest_point(&home.translation));
        let off = Pose::exp(&Twist::new(numbers.vector() * length_m, numbers.vector() * angle_rad));
        *screw = screw.transform(&(at * off * at.inverse()));
    }
    Arm::new(&screws, &home).unwrap()
}

pub(crate) const SEVEN: [&str; 2] = ["seven axes, round wrist", "seven axes, offset wrist"];

/// The same for an arm of seven axes, like collaborative robots: with a spherical shoulder, and a spherical wrist or one whose last axis
/// is offset from the others.
pub(crate) fn arm_of_seven(kind: &str, angle_rad: f64, length_m: f64) -> Arm {
    let (y, z) = (Vector3::y(), Vector3::z());
    let is_round = kind == SEVEN[0];
    let (axes, points) = if is_round {
        ([z, y, z, -y, z, y, z], [0.0, 0.36, 0.36, 0.78, 0.78, 1.18, 1.18].map(|height| [0.0, height]))
    } else {
        let beside = [[0.0, 0.333], [0.0, 0.333], [0.0, 0.333], [0.0825, 0.649], [0.0, 1.033], [0.0, 1.033]];
        let [a, b, c, d, e, f] = beside;
        ([z, y, z, -y, z, -y, -z], [a, b, c, d, e, f, [0.088, 1.033]])
    };
    let mut numbers = Numbers(2009);
    let screws = axes.iter().zip(points).map(|(axis, [x, height])| {
        let axis = rotation::exp(&(numbers.vector() * angle_rad)) * axis;
        Screw::revolute(&axis, &(Vector3::new(x, 0.0, height) + numbers.vector() * length_m))
    });
    let tip = if is_round { Vector3::new(0.0, 0.0, 1.306) } else { Vector3::new(0.088, 0.0, 0.92) };
    Arm::new(&screws.collect::<Vec<Screw>>(), &Pose::from_translation(tip)).unwrap()
}

/// Smallest singular value of the free joints, lengths over reach.
pub(crate) fn smallest_free(arm: &Arm, q: &[f64], held: Option<usize>) -> f64 {
    let jacobian = arm.jacobian(q);
    let mut a = Matrix6::zeros();
    for (v, w) in (0..q.len()).filter(|it| Some(*it) != held).map(|it| jacobian[it]) {
        let v = v / arm.reach_m();
        let column = Vector6::new(v.x, v.y, v.z, w.x, w.y, w.z);
        a += column * column.transpose();
    }
    a.symmetric_eigenvalues().min().max(0.0).sqrt()
}
