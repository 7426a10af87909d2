//! Candidates of a plan and configurations of a workspace: drawn at random, or from lists.

use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::conditions::{Checker, Conditions, Obstacle, RefusalCounts};
use super::experiment::WORKSPACE;
use poecal_model::robot::Robot;
use poecal_model::simulate::Configurations;
use poecal_numerics::error::{ErrorKind, Result};

/// Random configurations that are tried for each one of a workspace.
const ATTEMPTS: usize = 200;

/// Random configurations of a workspace: those in which the tip is between two corners, metres in the base frame.
///
/// # Errors
/// [`ErrorKind::Option`] if hardly any configuration within the limits of the joints has its tip there.
pub fn workspace_in(robot: &Robot, corners: &[[f64; 3]; 2], seed: u64) -> Result<Vec<f64>> {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    generator.set_stream(2);
    let configurations = Configurations::new(robot);
    let mut found = Vec::new();
    let mut count = 0;
    for _ in 0..WORKSPACE * ATTEMPTS {
        let readings = configurations.random(&mut generator);
        let tip = robot.forward_kinematics(&readings).translation;
        if (0..3).all(|k| (corners[0][k]..=corners[1][k]).contains(&tip[k])) {
            found.extend(readings);
            count += 1;
            if count == WORKSPACE {
                return Ok(found);
            }
        }
    }
    if count > 0 {
        return Ok(found);
    }
    ErrorKind::Option.refuse(format!(
        "found none of {} random configurations with the tip in the box, expected one that the robot reaches: state it in the base frame",
        WORKSPACE * ATTEMPTS
    ))
}

/// Random configurations that are accepted, up to a number.
pub(crate) fn draw(
    checker: &Checker<'_>,
    count: usize,
    generator: &mut ChaCha8Rng,
    mut accepts: impl FnMut(&Checker<'_>, &[f64]) -> bool,
) -> Vec<f64> {
    let (mut found, mut kept) = (Vec::new(), 0);
    for _ in 0..count * ATTEMPTS {
        let readings = checker.configurations().random(generator);
        if accepts(checker, &readings) {
            found.extend(readings);
            kept += 1;
            if kept == count {
                break;
            }
        }
    }
    found
}

/// Draws random configurations that can be measured.
pub(crate) fn draw_measurable(
    checker: &Checker<'_>,
    count: usize,
    generator: &mut ChaCha8Rng,
    refusals: &mut RefusalCounts,
) -> Vec<f64> {
    draw(checker, count, generator, |checker, readings| {
        let obstacle = checker.obstacle_to_measuring(readings);
        refusals.add(obstacle);
        obstacle.is_none()
    })
}

/// Keeps the configurations of a list that can be measured, with the index of each in the list.
pub(crate) fn keep_measurable(
    checker: &Checker<'_>,
    (list, width): (&[f64], usize),
    conditions: &Conditions,
    refusals: &mut RefusalCounts,
) -> (Vec<f64>, Option<Vec<usize>>) {
    let origins: Vec<usize> = (0..list.len() / width)
        .filter(|&at| {
            let found = checker.obstacle_to_measuring(&list[at * width..(at + 1) * width]);
            // The robot was in these configurations, so no limit of a model forbids them.
            let found = found.filter(|&it| it != Obstacle::Limits || conditions.margin.is_some());
            refusals.add(found);
            found.is_none()
        })
        .collect();
    let own = origins.iter().flat_map(|&at| list[at * width..(at + 1) * width].to_vec());
    (own.collect(), Some(origins.clone()))
}

/// Thins out the configurations of a workspace, at even distances.
pub(crate) fn thin_out(workspace: &[f64], width: usize) -> Vec<f64> {
    let every = (workspace.len() / width).div_ceil(WORKSPACE).max(1);
    workspace.chunks_exact(width).step_by(every).flatten().copied().collect()
}
