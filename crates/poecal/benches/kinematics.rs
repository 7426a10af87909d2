//! Poses, Jacobians and sag in many configurations, eight side by side, compared with one after the other: nanoseconds per configuration on one
//! thread, the least and the median of turns.
//!
//! `RAYON_NUM_THREADS=1 cargo bench -p poecal --bench kinematics`

#![allow(clippy::print_stdout, reason = "a program that prints what it measures")]

use std::hint::black_box;
use std::time::Instant;

use nalgebra::Vector3;
use poecal_compensate::Kinematics;
use poecal_model::robot::Robot;
use poecal_model::robot::{CompliantDirections, Gravity, JointTerm, Term, TermKind};
use poecal_model::simulate;

const ROWS: usize = 4096;
const TURNS: usize = 60;

fn main() -> Result<(), poecal_numerics::error::Error> {
    println!("{:<34}{:>10}{:>10}{:>10}{:>10}{:>8}", "ns a configuration", "one", "median", "eight", "median", "ratio");
    for (name, robot) in [("elbow", simulate::elbow()), ("elbow with all terms", with_terms())] {
        let kinematics = Kinematics::new(&robot, &[])?;
        let (arm, _) = robot.arm(&[])?;
        let q: Vec<f64> = (0..ROWS * 6).map(|at| 3.0 * (at as f64 * 0.7).sin()).collect();
        let rows = || q.chunks_exact(6);
        let mut bare = robot.clone();
        bare.terms.retain(|it| !it.term.needs_gravity());
        let (bare, _) = bare.arm(&[])?;
        compare(
            &format!("{name}, poses"),
            || rows().map(|q| arm.forward_kinematics(q)).collect::<Vec<_>>(),
            || kinematics.forward_kinematics(&q),
        );
        compare(
            &format!("{name}, Jacobians"),
            || rows().map(|q| arm.jacobian(q)).collect::<Vec<_>>(),
            || kinematics.jacobians(&q),
        );
        compare(
            &format!("{name}, sag"),
            || rows().map(|q| (arm.forward_kinematics(q), bare.forward_kinematics(q))).collect::<Vec<_>>(),
            || kinematics.sag(&q),
        );
    }
    Ok(())
}

/// Sizes of harmonics, couplings and sag of every joint and link of the elbow.
fn with_terms() -> Robot {
    let (mut robot, _) = simulate::elbow().with_compliance(&[0, 1, 2, 3, 4, 5], CompliantDirections::All);
    robot.gravity = Some(Gravity::of_unit_weights(&robot, -Vector3::z()));
    let weights = robot.gravity.as_ref().map_or(0, |it| it.weights.len());
    for joint in 0..robot.joints.len() {
        let mut terms: Vec<Term> = (0..weights).map(|weight| TermKind::Sag.with_index(weight)).collect();
        if robot.joints[joint].give_of.is_none() {
            terms.extend([Term::OFFSET, Term::RATIO, TermKind::Coupled.with_index((joint + 1) % 6)]);
            terms.extend(
                [1, 2].iter().flat_map(|&order| [TermKind::Sine, TermKind::Cosine].map(|kind| kind.with_number(order))),
            );
        }
        robot.terms.extend(terms.into_iter().map(|term| JointTerm { joint, term, coefficient: 3e-4 }));
    }
    robot
}

fn compare<A, B>(name: &str, one: impl Fn() -> A, eight: impl Fn() -> B) {
    let mut times: [Vec<f64>; 2] = Default::default();
    // In turn, so that disturbances of the machine affect both.
    for _ in 0..TURNS {
        let begin = Instant::now();
        black_box(one());
        times[0].push(begin.elapsed().as_secs_f64());
        let begin = Instant::now();
        black_box(eight());
        times[1].push(begin.elapsed().as_secs_f64());
    }
    let [one, eight] = times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        [times[0], times[TURNS / 2]].map(|seconds| 1e9 * seconds / ROWS as f64)
    });
    println!(
        "{name:<34}{:>10.1}{:>10.1}{:>10.1}{:>10.1}{:>8.2}",
        one[0],
        one[1],
        eight[0],
        eight[1],
        one[0] / eight[0]
    );
}
