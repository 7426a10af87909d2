//! Robots and motions that leave directions undetermined, and the expected statements.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{DMatrix, DVector, Vector3};
use poecal_arm::lie::{Pose, Screw, rotation};
use poecal_model::robot::{Joint, Robot};
use poecal_model::simulate::{SessionKind, elbow, gantry, random, random_configuration, scara, seven_axis};
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

const DEG: f64 = PI / 180.0;

/// Transformation of random readings.
pub(crate) type Motion = fn(&Robot, &mut [f64], &mut ChaCha8Rng);

/// A robot, its measurements, the transformation of random readings, their number, and the expected statement.
pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) robot: fn() -> Robot,
    pub(crate) kind: SessionKind,
    pub(crate) motion: Motion,
    pub(crate) count: usize,
    pub(crate) words: &'static str,
}

/// Joint 3 of the elbow stays still except for encoder jitter.
fn jitter(_: &Robot, q: &mut [f64], generator: &mut ChaCha8Rng) {
    q[2] = 0.5 + 3e-4 * (2.0 * random::uniform_number(generator) - 1.0);
}

/// The elbow's axis 6 is vertical, and the tool turns about it.
fn set_upright(_: &Robot, q: &mut [f64], _: &mut ChaCha8Rng) {
    q[3] = 0.0;
    q[4] = FRAC_PI_2 - q[1] + q[2];
}

/// The tip moves anywhere near, in one orientation: readings by Newton's method from a configuration.
fn one_orientation(robot: &Robot, q: &mut [f64], generator: &mut ChaCha8Rng) {
    let middle = [0.1, -0.3, 0.4, 0.5, 1.2, 0.3];
    let turn = robot.forward_kinematics(&middle).rotation;
    let shift = [0; 3].map(|_| 0.2 * random::uniform_number(generator) - 0.1);
    let place = robot.forward_kinematics(&middle).translation + Vector3::from(shift);
    q.copy_from_slice(&middle);
    let miss = |q: &[f64]| {
        let tip = robot.forward_kinematics(q);
        let turned = rotation::log(&(turn * tip.rotation.transpose()));
        let shift = place - tip.translation;
        DVector::from_iterator(6, shift.iter().chain(turned.iter()).copied())
    };
    for _ in 0..30 {
        let now = miss(q);
        let jacobian = DMatrix::from_fn(6, 6, |row, joint| {
            let mut ahead = q.to_vec();
            ahead[joint] += 1e-6;
            (now[row] - miss(&ahead)[row]) / 1e-6
        });
        let step = jacobian.lu().solve(&now).unwrap();
        q.iter_mut().zip(step.iter()).for_each(|(q, step)| *q += step);
    }
    assert!(miss(q).norm() < 1e-9);
}

/// One of four configurations.
fn repeat_configurations(robot: &Robot, q: &mut [f64], generator: &mut ChaCha8Rng) {
    let which = (4.0 * random::uniform_number(generator)) as u64;
    q.copy_from_slice(&random_configuration(robot, &mut ChaCha8Rng::seed_from_u64(which)));
}

/// The elbow with its tool point 0.1 m beside axis 6.
fn bent_tool() -> Robot {
    let mut robot = elbow();
    robot.home.translation += Vector3::new(0.02, 0.06, 0.08);
    robot
}

/// The elbow with its tool point where the wrist's axes meet.
fn wrist_point() -> Robot {
    let mut robot = elbow();
    robot.home.translation = Vector3::new(0.784, 0.0, 0.720);
    robot
}

/// The SCARA with its tool point on its last axis.
fn scara_spindle() -> Robot {
    let mut robot = scara();
    robot.home.translation = Vector3::new(0.60, 0.0, 0.15);
    robot
}

/// A tilting table that turns.
fn positioner() -> Robot {
    let tilt = Joint::revolute("tilt", Screw::revolute(&Vector3::x(), &Vector3::new(0.0, 0.0, 0.8)));
    let turn = Joint::revolute("turntable", Screw::revolute(&Vector3::z(), &Vector3::new(0.0, 0.1, 0.9)));
    Robot::new("positioner", vec![tilt, turn], Pose::from_translation(Vector3::new(0.3, 0.1, 1.0))).unwrap()
}

/// A lifting column whose second stage follows the first, with a turntable on it.
fn column() -> Robot {
    let lift = Joint::prismatic("lift", Screw::prismatic(&Vector3::z()));
    let mut stage = Joint::prismatic("stage", Screw::prismatic(&Vector3::z()));
    stage.reading.name = "lift".to_owned();
    stage.reading.multiplier = 0.5;
    let turn = Joint::revolute("turn", Screw::revolute(&Vector3::z(), &Vector3::new(0.1, 0.0, 0.0)));
    let nod = Joint::revolute("nod", Screw::revolute(&Vector3::y(), &Vector3::new(0.4, 0.0, 0.5)));
    let joints = vec![lift, stage, turn, nod];
    Robot::new("column", joints, Pose::from_translation(Vector3::new(0.7, 0.1, 0.6))).unwrap()
}

const FREE: Motion = |_, _, _| {};

#[rustfmt::skip]
pub(crate) const CASES: &[Case] = &[
    Case {
        name: "all joints move", robot: elbow, kind: SessionKind::POSE, count: 60,
        motion: FREE,
        words: "30 of 30",
    },
    Case {
        name: "jitter, poses", robot: elbow, kind: SessionKind::POSE, count: 60,
        motion: jitter,
        words: "26 of 30\n\
                open 4: joint3 stood still but for the jitter of readings: its screw is undetermined",
    },
    Case {
        name: "jitter, points", robot: bent_tool, kind: SessionKind::POINT, count: 60,
        motion: jitter,
        words: "23 of 27\n\
                open 4: joint3 stood still but for the jitter of readings: its screw is undetermined",
    },
    Case {
        name: "never moved from zero", robot: elbow, kind: SessionKind::POSE, count: 60,
        motion: |_, q, _| q[2] = 0.0,
        words: "26 of 30\n\
                open 4: joint3 never moved: its screw is undetermined",
    },
    Case {
        name: "first joint still", robot: elbow, kind: SessionKind::POSE, count: 60,
        motion: |_, q, _| q[0] = 0.7,
        words: "26 of 30\n\
                open 4: joint1 never moved: its screw is undetermined",
    },
    Case {
        name: "last joint still, points", robot: bent_tool, kind: SessionKind::POINT, count: 60,
        motion: |_, q, _| q[5] = 0.7,
        words: "23 of 27\n\
                open 4: joint6 never moved: its screw is undetermined",
    },
    Case {
        name: "wrist frozen, poses", robot: elbow, kind: SessionKind::POSE, count: 60,
        motion: |_, q, _| q[3..].copy_from_slice(&[0.3, 0.4, 0.5]),
        words: "18 of 30\n\
                open 12: joint4, joint5 and joint6 never moved: their screws are undetermined",
    },
    Case {
        name: "wrist frozen, points", robot: bent_tool, kind: SessionKind::POINT, count: 60,
        motion: |_, q, _| q[3..].copy_from_slice(&[0.3, 0.4, 0.5]),
        words: "15 of 27\n\
                open 12: joint4, joint5 and joint6 never moved: their screws are undetermined",
    },
    Case {
        name: "SCARA points", robot: scara, kind: SessionKind::POINT, count: 60,
        motion: FREE,
        words: "17 of 17",
    },
    Case {
        name: "SCARA, point on the spindle", robot: scara_spindle, kind: SessionKind::POINT, count: 60,
        motion: FREE,
        words: "15 of 17\n\
                open 2: the target is on the axis of joint4 (within 0.0 mm), so the tilt of this axis is not determined; mount the target off the axis",
    },
    Case {
        name: "SCARA without its slide", robot: scara, kind: SessionKind::POSE, count: 60,
        motion: |_, q, _| q[2] = 0.1,
        words: "18 of 20\n\
                open 2: joint3 never moved: its screw is undetermined",
    },
    Case {
        name: "point on the last axis", robot: elbow, kind: SessionKind::POINT, count: 60,
        motion: FREE,
        words: "25 of 27\n\
                open 2: the target is on the axis of joint6 (within 0.0 mm), so the tilt of this axis is not determined; mount the target off the axis",
    },
    Case {
        name: "point where the wrist's axes meet", robot: wrist_point, kind: SessionKind::POINT, count: 60,
        motion: FREE,
        words: "21 of 27\n\
                open 6: the target is on the axes of joint4, joint5 and joint6 (within 0.0 mm), so the tilts of these axes are not determined; mount the target off these axes",
    },
    Case {
        name: "parallel axes together", robot: elbow, kind: SessionKind::POSE, count: 60,
        motion: |_, q, _| q[2] = q[1] + 0.3,
        words: "28 of 30\n\
                open 2: joint2 and joint3: parallel axes, moved only together: their places cannot be separated",
    },
    Case {
        name: "parallel axes together, points", robot: bent_tool, kind: SessionKind::POINT, count: 60,
        motion: |_, q, _| q[2] = q[1] + 0.3,
        words: "25 of 27\n\
                open 2: joint2 and joint3: parallel axes, moved only together: their places cannot be separated",
    },
    Case {
        name: "parallel axes in another ratio", robot: elbow, kind: SessionKind::POSE, count: 60,
        motion: |_, q, _| q[2] = 0.5 * q[1],
        words: "30 of 30",
    },
    Case {
        name: "5 degrees, points", robot: bent_tool, kind: SessionKind::POINT, count: 60,
        motion: |_, q, g| q[4] = 1.0 + 5.0 * DEG * random::uniform_number(g),
        words: "27 of 27\n\
                weak 1: joint5 moved by 4.8 deg only: part of its screw is known to 1.3 mm or 0.14 deg only (without the prior)",
    },
    Case {
        name: "1 degree, poses", robot: elbow, kind: SessionKind::POSE, count: 60,
        motion: |_, q, g| q[4] = 1.0 + DEG * random::uniform_number(g),
        words: "30 of 30\n\
                weak 4: joint5 moved by 1.0 deg only: its screw is known to 2.4 mm or 0.27 deg only (without the prior)",
    },
    Case {
        name: "0.3 degrees, points", robot: bent_tool, kind: SessionKind::POINT, count: 60,
        motion: |_, q, g| q[4] = 1.0 + 0.3 * DEG * random::uniform_number(g),
        words: "25 of 27\n\
                open 2: joint5 moved by 0.3 deg only: part of its screw is lost in the noise\n\
                weak 2: joint5 moved by 0.3 deg only: part of its screw is known to 4.9 mm or 0.52 deg only (without the prior)",
    },
    Case {
        name: "every joint by 5 degrees, points", robot: bent_tool, kind: SessionKind::POINT, count: 60,
        motion: |_, q, g| q.iter_mut().for_each(|q| *q = 0.5 + 5.0 * DEG * random::uniform_number(g)),
        words: "23 of 27\n\
                open 2: joint5 moved by 4.8 deg only: part of its screw is lost in the noise\n\
                open 2: joint6 moved by 4.8 deg only: part of its screw is lost in the noise\n\
                weak 1: joint1 moved by 4.8 deg only: part of its screw is known to 4.0 mm or 0.43 deg only (without the prior)\n\
                weak 1: joint5 moved by 4.8 deg only: part of its screw is known to 3.0 mm or 0.32 deg only (without the prior)\n\
                weak 1: joint6 moved by 4.8 deg only: part of its screw is known to 1.2 mm or 0.13 deg only (without the prior)",
    },
    Case {
        name: "SCARA poses of one orientation", robot: scara, kind: SessionKind::POSE, count: 60,
        motion: |_, q, _| q[3] = -q[0] - q[1],
        words: "18 of 20\n\
                open 2: the tool kept one orientation: its place on the last link and where the axes stand cannot be separated",
    },
    Case {
        name: "elbow poses of one orientation", robot: elbow, kind: SessionKind::POSE, count: 60,
        motion: one_orientation,
        words: "27 of 30\n\
                open 3: the tool kept one orientation: its place on the last link and where the axes stand cannot be separated",
    },
    Case {
        name: "elbow points of one orientation", robot: bent_tool, kind: SessionKind::POINT, count: 60,
        motion: one_orientation,
        words: "23 of 27\n\
                open 4: the tool kept one orientation: its place on the last link and where the axes stand cannot be separated\n\
                weak 6: joint1, joint2, joint3, joint4, joint5 and joint6 moved far enough, but not independently of the others: their screws are known to 9.0 mm or 0.95 deg only (without the prior)",
    },
    Case {
        name: "upright tool", robot: elbow, kind: SessionKind::POSE, count: 60,
        motion: set_upright,
        words: "24 of 30\n\
                open 4: joint4 never moved: its screw is undetermined\n\
                open 1: the tool turned about one direction only: along it, its place on the last link and where the axes stand cannot be separated\n\
                open 1: joint2, joint3 and joint5: parallel axes, moved only together: their places cannot be separated",
    },
    Case {
        name: "too few rows", robot: elbow, kind: SessionKind::POSE, count: 4,
        motion: FREE,
        words: "24 of 30\n\
                open 6: too few rows: 24 numbers for 30 unknowns",
    },
    Case {
        name: "too few rows, points", robot: scara, kind: SessionKind::POINT, count: 5,
        motion: FREE,
        words: "15 of 17\n\
                open 2: too few rows: 15 numbers for 17 unknowns",
    },
    Case {
        name: "the same configurations again", robot: elbow, kind: SessionKind::POSE, count: 60,
        motion: repeat_configurations,
        words: "24 of 30\n\
                open 6: too few configurations: 60 rows repeat 4, which are 24 numbers for 30 unknowns",
    },
    Case {
        name: "gantry with a frozen slide", robot: gantry, kind: SessionKind::POSE, count: 60,
        motion: |_, q, _| q[1] = 0.1,
        words: "22 of 24\n\
                open 2: joint2 never moved: its screw is undetermined",
    },
    Case {
        name: "gantry with a frozen wrist, points", robot: gantry, kind: SessionKind::POINT, count: 60,
        motion: |_, q, _| q[3..].copy_from_slice(&[0.3, 0.4, 0.5]),
        words: "9 of 21\n\
                open 12: joint4, joint5 and joint6 never moved: their screws are undetermined",
    },
    Case {
        name: "slides moved together", robot: gantry, kind: SessionKind::POSE, count: 60,
        motion: |_, q, _| q[1] = 0.5 * q[0] + 0.1,
        words: "23 of 24\n\
                open 1: joint1 and joint2: moved only together: only their common motion is observed, their own directions are not determined",
    },
    Case {
        name: "a stage that follows", robot: column, kind: SessionKind::POSE, count: 60,
        motion: FREE,
        words: "16 of 18\n\
                open 2: lift and stage: moved only together: only their common motion is observed, their own directions are not determined",
    },
    Case {
        name: "positioner", robot: positioner, kind: SessionKind::POSE, count: 60,
        motion: FREE,
        words: "14 of 14",
    },
    Case {
        name: "positioner, table never turned", robot: positioner, kind: SessionKind::POINT, count: 60,
        motion: |_, q, _| q[1] = 0.0,
        words: "7 of 11\n\
                open 4: turntable never moved: its screw is undetermined",
    },
    Case {
        name: "7 axes, elbow frozen straight", robot: seven_axis, kind: SessionKind::POSE, count: 60,
        motion: |_, q, _| q[3] = 0.0,
        words: "30 of 34\n\
                open 4: joint4 never moved: its screw is undetermined",
    },
    Case {
        name: "7 axes, elbow frozen, two together", robot: seven_axis, kind: SessionKind::POSE, count: 60,
        motion: |_, q, _| { q[3] = 0.0; q[4] = -q[2]; },
        words: "26 of 34\n\
                open 4: joint4 never moved: its screw is undetermined\n\
                open 4: joint3 and joint5: parallel axes, moved only together: their places cannot be separated",
    },
];
