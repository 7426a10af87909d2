//! Readings that were taken before the arm came to rest, in every configuration alike (theory.md §9, *Events*).

use nalgebra::{DMatrix, DVector};

use super::hypotheses::MovedPart;
use super::rows::{Optimum, SessionRows};
use poecal_model::measurement::Dataset;
use poecal_model::robot::{JointKind, Robot};

/// Least gain from which the effect is evident, as a multiple of the variance of a number.
const EVIDENT: f64 = 30.0;
/// Least ratio of this gain to the gain by the motion to the configuration after, which no reading follows.
const OF_BEFORE: f64 = 4.0;
/// Least turn of the joint that turns most from one configuration to the next, radians.
const LEAST_TURN: f64 = 0.02;

/// Statement about residuals that follow the motion from the configuration before; `None` if they hardly do, or follow the motion to the one after.
pub(crate) fn describe_early_readings(
    rows: &SessionRows,
    optimum: &Optimum,
    weights: &[f64],
    data: &Dataset,
    robot: &Robot,
) -> Option<String> {
    let of_before = part(rows, optimum, weights, data, robot, true)?;
    let of_after = part(rows, optimum, weights, data, robot, false).map_or(0.0, |it| it.gain);
    let is_evident = of_before.angle_rad > 0.0 && of_before.gain >= EVIDENT && of_before.gain >= OF_BEFORE * of_after;
    is_evident.then(|| {
        format!(
            "the residuals follow the motion from the configuration before ({:.0} standard deviations): it may be that the joints were read {:.2} deg \
             before they came to rest; read them later, or let the arm settle (play of the gears does alike)",
            of_before.gain.sqrt(),
            of_before.angle_rad.to_degrees()
        )
    })
}

/// Part of the residuals that follows a motion.
struct ResidualPart {
    /// Angle of the joint that turns most.
    angle_rad: f64,
    gain: f64,
}

/// Part of the residuals that follows the joints' motion from the row before, or to the row after, relative to its largest turn.
fn part(
    rows: &SessionRows,
    optimum: &Optimum,
    weights: &[f64],
    data: &Dataset,
    robot: &Robot,
    is_before: bool,
) -> Option<ResidualPart> {
    let mut column = DVector::zeros(optimum.residual.len());
    let joints: Vec<(usize, f64, &DMatrix<f64>)> = rows
        .columns
        .iter()
        .filter_map(|columns| {
            let MovedPart::Zero(joint) = columns.moved else { return None };
            let joint = robot.joints.get(joint).filter(|joint| joint.kind == JointKind::Revolute)?;
            let at = data.reading_names().iter().position(|it| *it == joint.reading.name)?;
            Some((at, joint.reading.multiplier, &columns.of))
        })
        .collect();
    for (run, _) in rows.runs.iter().zip(weights).filter(|(_, weight)| **weight > 0.0) {
        let first = *rows.rows.get(run.start)? as usize;
        let last = *rows.rows.get(run.end.checked_sub(1)?)? as usize;
        let (own, other) = if is_before {
            (first, first.checked_sub(1))
        } else {
            (last, Some(last + 1).filter(|it| *it < data.len()))
        };
        let Some(other) = other else { continue };
        let (own, other) = (data.readings(own), data.readings(other));
        let way = |at: usize| own[at] - other[at];
        let largest = joints.iter().map(|(at, multiplier, _)| (multiplier * way(*at)).abs()).fold(0.0, f64::max);
        if largest < LEAST_TURN {
            continue;
        }
        let numbers = rows.numbers(run);
        for (at, multiplier, of) in &joints {
            let share = multiplier * way(*at) / largest;
            numbers.clone().for_each(|number| column[number] += share * of[(number, 0)]);
        }
    }
    let mixed = optimum.whitened.tr_mul(&column);
    let left = column.norm_squared() - mixed.norm_squared();
    let pull = column.dot(&optimum.residual);
    let angle_rad = (left > 1e-6 * column.norm_squared()).then(|| pull / left)?;
    let moved = &column * angle_rad;
    Some(ResidualPart {
        angle_rad,
        gain: angle_rad * pull / optimum.variance / rows.shared_variance(optimum, weights, &moved),
    })
}
