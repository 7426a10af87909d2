//! What configurations leave open is said in words, and changes no prediction: constructed cases, with the sentences expected.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

use nalgebra::Vector3;
use poecal::analysis::{Cause, Identifiability, Session, identify};
use poecal::calibration::{CalibrationOptions, calibrate};
use poecal::lie::{Pose, Screw};
use poecal::measurement::{Dataset, Measurement, PointMeasurement, PoseMeasurement};
use poecal::robot::{Joint, Robot};
use poecal::simulate::{Kind, Simulation, elbow, gantry, random, random_configuration, scara, seven_axis};
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

/// Rounding of positions some metres away, magnified by condition numbers of some thousand.
const EXACT_M: f64 = 1e-9;

/// Readings that a motion makes of random ones.
fn session(robot: &Robot, count: usize, motion: impl Fn(&mut [f64], &mut ChaCha8Rng)) -> Vec<Vec<f64>> {
    let mut generator = ChaCha8Rng::seed_from_u64(7);
    (0..count)
        .map(|_| {
            let mut readings = random_configuration(robot, &mut generator);
            motion(&mut readings, &mut generator);
            readings
        })
        .collect()
}

fn words(found: &Identifiability) -> String {
    let mut lines = vec![format!("{} of {}", found.rank, found.parameters)];
    for (what, list) in [("open", &found.unidentifiable), ("weak", &found.weak)] {
        lines.extend(list.iter().map(|it| format!("{what} {}: {}", it.directions, it.description)));
    }
    lines.join("\n")
}

fn foreseen(robot: &Robot, kind: Kind, rows: &[Vec<f64>]) -> Identifiability {
    identify(robot, &rows.concat(), &Session { kind, ..Session::default() }).unwrap().identifiability
}

#[test]
fn explore() {
    let deg = std::f64::consts::PI / 180.0;
    let none = |_: &mut [f64], _: &mut ChaCha8Rng| {};
    let e = elbow();
    let show = |name: &str, robot: &Robot, kind: Kind, rows: &[Vec<f64>]| {
        println!("== {name} {kind:?}\n{}", words(&foreseen(robot, kind, rows)));
    };
    for kind in [Kind::Pose, Kind::Point] {
        show("elbow", &e, kind, &session(&e, 60, none));
        show("joint3 jitter", &e, kind, &session(&e, 60, |q, g| q[2] = 0.5 + 3e-4 * random::normal(g)));
        show("joint3 still", &e, kind, &session(&e, 60, |q, _| q[2] = 0.5));
        show("wrist frozen", &e, kind, &session(&e, 60, |q, _| q[3..].copy_from_slice(&[0.3, 0.4, 0.5])));
        show("joint5 5 deg", &e, kind, &session(&e, 60, |q, g| q[4] = 1.0 + 5.0 * deg * random::uniform(g)));
        show("joint5 1 deg", &e, kind, &session(&e, 60, |q, g| q[4] = 1.0 + 1.0 * deg * random::uniform(g)));
        show("2,3 together keep", &e, kind, &session(&e, 60, |q, _| q[2] = q[1] + 0.3));
        show("2,3 together 2x", &e, kind, &session(&e, 60, |q, _| q[2] = 0.5 * q[1] + 0.3));
        show(
            "1 orientation of 2,3,5",
            &e,
            kind,
            &session(&e, 60, |q, _| {
                q[0] = 0.0;
                q[3] = 0.0;
                q[5] = 0.0;
                q[4] = q[2] - q[1];
            }),
        );
        show("few", &e, kind, &session(&e, 4, none));
        show("repeated", &e, kind, &(0..60).map(|k| session(&e, 4, none)[k % 4].clone()).collect::<Vec<_>>());
        show("all small", &e, kind, &session(&e, 60, |q, _| q.iter_mut().for_each(|x| *x *= 0.03)));
        show("scara", &scara(), kind, &session(&scara(), 60, none));
        show("scara one orientation", &scara(), kind, &session(&scara(), 60, |q, _| q[3] = -q[0] - q[1]));
        show("gantry", &gantry(), kind, &session(&gantry(), 60, none));
        show("gantry slide", &gantry(), kind, &session(&gantry(), 60, |q, _| q[1] = 0.1));
        show(
            "gantry wrist frozen",
            &gantry(),
            kind,
            &session(&gantry(), 60, |q, _| q[3..].copy_from_slice(&[0.3, 0.4, 0.5])),
        );
        show("seven", &seven_axis(), kind, &session(&seven_axis(), 60, none));
        show("seven elbow frozen", &seven_axis(), kind, &session(&seven_axis(), 60, |q, _| q[3] = 0.0));
        show("seven elbow frozen bent", &seven_axis(), kind, &session(&seven_axis(), 60, |q, _| q[3] = 1.0));
    }
}
