//! Worked examples of lynch2017 (Modern Robotics): forward kinematics, space Jacobian and logarithm of its 6R arm (Example 4.5, a UR5),
//! and the sample calls of the book's library. Beyond the digits that the book prints, the numbers are those of its Python package
//! (`modern_robotics` 1.1.1: `FKinSpace`, `JacobianSpace`, `MatrixLog6`). Its twists are `(ω; v)`.

use nalgebra::{Matrix3, Vector3};
use poecal_arm::lie::{Pose, Screw, Twist};
use poecal_model::robot::{Joint, Robot};
use poecal_testing::largest::larger_or_nan;
use std::f64::consts::{FRAC_PI_2, PI};

/// Rounding of some ten products of numbers below ten, on both sides.
const ROUNDING: f64 = 1e-14;

fn pose(rows: [[f64; 4]; 3]) -> Pose {
    Pose::new(Matrix3::from_fn(|k, column| rows[k][column]), Vector3::from_fn(|k, _| rows[k][3]))
}

fn twist([wx, wy, wz, vx, vy, vz]: [f64; 6]) -> Twist {
    Twist::new(Vector3::new(vx, vy, vz), Vector3::new(wx, wy, wz))
}

fn robot_difference(a: &Pose, b: &Pose) -> f64 {
    larger_or_nan((a.rotation - b.rotation).amax(), (a.translation - b.translation).amax())
}

/// Space Jacobian: each axis after the motions of the joints before it.
fn space_jacobian(axes: &[Twist], values: &[f64]) -> Vec<Twist> {
    let mut before = Pose::identity();
    let mut columns = Vec::new();
    for (axis, value) in axes.iter().zip(values) {
        columns.push(before.transform(axis));
        before = before * Pose::exp(&Twist::new(axis.v * *value, axis.w * *value));
    }
    columns
}

fn largest_difference(found: &[Twist], expected: &[[f64; 6]]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let differences = found.iter().zip(expected).map(|(a, b)| (a.to_vector() - twist(*b).to_vector()).amax());
    differences.fold(0.0, larger_or_nan)
}

/// Example 4.5: lengths in metres.
fn ur5() -> Robot {
    let (l1, l2, w1, w2, h1, h2) = (0.425, 0.392, 0.109, 0.082, 0.089, 0.095);
    let axes = [
        [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, -h1, 0.0, 0.0],
        [0.0, 1.0, 0.0, -h1, 0.0, l1],
        [0.0, 1.0, 0.0, -h1, 0.0, l1 + l2],
        [0.0, 0.0, -1.0, -w1, l1 + l2, 0.0],
        [0.0, 1.0, 0.0, h2 - h1, 0.0, l1 + l2],
    ];
    let joint = |(k, axis): (usize, &[f64; 6])| {
        Joint::revolute(&format!("joint{}", k + 1), Screw::project(&twist(*axis)).unwrap())
    };
    let home = pose([[-1.0, 0.0, 0.0, l1 + l2], [0.0, 0.0, 1.0, w1 + w2], [0.0, 1.0, 0.0, h1 - h2]]);
    Robot::new("ur5", axes.iter().enumerate().map(joint).collect(), home).unwrap()
}

#[test]
fn the_arm_of_example_4_5_stands_where_the_book_has_it() {
    let robot = ur5();
    // The pose is as printed: one elbow and one wrist turned by a right angle.
    let printed = pose([[0.0, -1.0, 0.0, 0.095], [1.0, 0.0, 0.0, 0.109], [0.0, 0.0, 1.0, 0.988]]);
    let first = robot_difference(&robot.forward_kinematics(&[0.0, -FRAC_PI_2, 0.0, 0.0, FRAC_PI_2, 0.0]), &printed);
    let values = [0.3, -1.1, 0.7, -0.4, 1.2, 2.5];
    let tip = robot.forward_kinematics(&values);
    let second = robot_difference(
        &tip,
        &pose([
            [0.00374228141325621, 0.8582182859245064, 0.5132712431401414, 0.60407968080285],
            [-0.7804488281072905, -0.3183994209505737, 0.5380719612136429, 0.3320621493984958],
            [0.6252084628632123, -0.40259555690933974, 0.6686039152750141, 0.6090535018756715],
        ]),
    );
    let axes: Vec<Twist> = robot.joints.iter().map(|joint| joint.screw.twist()).collect();
    let jacobian = largest_difference(
        &space_jacobian(&axes, &values),
        &[
            [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
            [-0.29552020666133955, 0.955336489125606, 0.0, -0.08502494753217893, -0.02630129839285922, 0.0],
            [
                -0.29552020666133955,
                0.955336489125606,
                0.0,
                -0.4468711844708753,
                -0.13823345626283065,
                0.1927783516058703,
            ],
            [-0.29552020666133955, 0.955336489125606, 0.0, -0.5927052008322411, -0.183345203949564, 0.5538342612550011],
            [
                0.6853164493328193,
                0.2119932202323977,
                -0.6967067093471653,
                -0.3181024774736568,
                0.7713647579917611,
                -0.07819181390804802,
            ],
            [
                0.5132712431401413,
                0.5380719612136429,
                0.668603915275014,
                -0.10569655903580877,
                -0.09128039167628377,
                0.15460038635734763,
            ],
        ],
    );
    let logarithm = largest_difference(
        &[tip.log()],
        &[[
            -0.9441177162534753,
            -0.11234778517662428,
            -1.6446774482938045,
            0.30654240610082417,
            0.45092964900105226,
            0.7717332493603182,
        ]],
    );
    println!("printed {first:.1e}, tip {second:.1e}, Jacobian {jacobian:.1e}, logarithm {logarithm:.1e}");
    assert!(first < ROUNDING && second < ROUNDING && jacobian < ROUNDING && logarithm < ROUNDING);
}

/// Sample calls of the book's library; the third axis of the first has a pitch.
#[test]
fn sample_calls_of_the_library_come_out() {
    let axes = [[0.0, 0.0, 1.0, 4.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 1.0, 0.0], [0.0, 0.0, -1.0, -6.0, 0.0, -0.1]];
    let home = pose([[-1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 6.0], [0.0, 0.0, -1.0, 2.0]]);
    let motions = axes.iter().zip([FRAC_PI_2, 3.0, PI]).map(|(axis, value)| {
        let Twist { v, w } = twist(*axis);
        Pose::exp(&Twist::new(v * value, w * value))
    });
    let tip = motions.fold(Pose::identity(), |before, motion| before * motion) * home;
    let expected = pose([[0.0, 1.0, 0.0, -5.0], [1.0, 0.0, 0.0, 4.0], [0.0, 0.0, -1.0, 1.6858407346410207]]);
    let axes = [
        [0.0, 0.0, 1.0, 0.0, 0.2, 0.2],
        [1.0, 0.0, 0.0, 2.0, 0.0, 3.0],
        [0.0, 1.0, 0.0, 0.0, 2.0, 1.0],
        [1.0, 0.0, 0.0, 0.2, 0.3, 0.4],
    ];
    let jacobian = largest_difference(
        &space_jacobian(&axes.map(twist), &[0.2, 1.1, 0.1, 1.2]),
        &[
            [0.0, 0.0, 1.0, 0.0, 0.2, 0.2],
            [0.9800665778412416, 0.19866933079506122, 0.0, 1.9521863824506809, 0.4365413247037721, 2.960266133840988],
            [
                -0.09011563789485476,
                0.4445543984476258,
                0.8912073600614354,
                -2.2163521568962983,
                -2.4371257276533216,
                3.2357306532803087,
            ],
            [
                0.957494264730031,
                0.28487556541794845,
                -0.04528405057966491,
                -0.5116153729819478,
                2.7753571339551537,
                2.22512443353574,
            ],
        ],
    );
    println!("tip {:.1e}, Jacobian {jacobian:.1e}", robot_difference(&tip, &expected));
    assert!(robot_difference(&tip, &expected) < ROUNDING && jacobian < ROUNDING);
}
