//! How much each row decides its own prediction, and how far it is off when that is allowed for (theory.md §6 (34d), (34e)).

use crate::estimate::Estimate;
use crate::lanes::{self, Level, Wide};
use crate::linalg;
use crate::problem::{Abreast, Problem};
use crate::solve::Normal;
use crate::threads;

/// Rows that one thread takes at a time.
const CHUNK: usize = 1024;
/// Share of the largest diagonal element that rounding makes of the normal equations' small eigenvalues.
const ROUNDING: f64 = 1e-13;
/// What a row keeps of its own variance at least: one that decides its prediction alone leaves no residual to judge it by.
const LEAST_REDUNDANCY: f64 = 1e-3;

/// What a row means to a fit, and the fit to it.
///
/// ```
/// let row = poecal::analysis::Influence { leverage: 0.1, studentized: 1.7 };
/// assert!(row.leverage < 1.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Influence {
    /// Mean variance of the row's prediction in units of its noise: for a row fitted with weight 1 the mean diagonal of its block of
    /// the hat matrix, from 0 to 1; for others it may exceed that.
    pub leverage: f64,
    /// Length of the residual in units of its own standard deviation: the root of a χ² of as many degrees of freedom as the row has
    /// numbers.
    pub studentized: f64,
}

/// Influence of some rows on a fit with this normal information; `weights` by which they were fitted, one a row (0: not fitted).
/// `problem` is without weights. Residual components are divided by `scale(row, component)` first.
#[must_use]
pub fn influence(
    problem: &Problem<'_>,
    estimate: &Estimate,
    normal: &Normal,
    rows: &[u32],
    weights: &[f64],
    scale: impl Fn(u32, usize) -> f64 + Sync,
) -> Vec<Influence> {
    let n = normal.dim();
    let shifts = problem.layout().shifts();
    let largest = (0..n).map(|i| normal.gram[i * n + i]).fold(0.0, f64::max);
    let damping = (ROUNDING * largest).max(f64::MIN_POSITIVE);
    // Of numbers that are not finite there is none, and no row means anything.
    let factor = linalg::cholesky(&normal.gram, n, damping).unwrap_or_default();
    let level = Level::best();
    threads::concat_chunks(rows, CHUNK, |part, rows| {
        let weights = weights.get(part * CHUNK..).unwrap_or_default();
        let mut found = vec![Influence { leverage: 0.0, studentized: 0.0 }; rows.len()];
        problem.for_rows_abreast(estimate, rows, |places, abreast| {
            let Abreast { jacobian, residual, numbers } = abreast;
            let mut weight = Wide::ZERO;
            for ((lane, &place), &numbers) in places.iter().enumerate().zip(&*numbers) {
                weight.0[lane] = weights.get(place as usize).copied().unwrap_or(1.0);
                for (k, residual) in residual.iter_mut().enumerate().take(numbers) {
                    residual.0[lane] /= scale(rows[place as usize], k);
                }
            }
            let [trace, squared] =
                lanes::influences(level, &factor, shifts, jacobian, residual, &weight, LEAST_REDUNDANCY);
            for (lane, &place) in places.iter().enumerate() {
                found[place as usize] = Influence {
                    leverage: trace.0[lane] / numbers[lane].max(1) as f64,
                    studentized: squared.0[lane].max(0.0).sqrt(),
                };
            }
        });
        found
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::Packed;
    use crate::lie::Pose;
    use crate::measurement::{Measurement, Noise, PointMeasurement};
    use crate::parameters::{Formulation, Parameter, TargetFrame};
    use crate::simulate::{Kind, Simulation, elbow};
    use crate::solve::LeastSquares;

    /// The formulas of theory.md as they stand there, one row after the other.
    fn by_the_book(factor: &linalg::Factor, jacobian: &[f64], residual: &[f64], weight: f64) -> Influence {
        let (dim, n) = (residual.len(), jacobian.len() / residual.len());
        let row = |i: usize| &jacobian[i * n..(i + 1) * n];
        let solved: Vec<Vec<f64>> = (0..dim).map(|i| linalg::cholesky_solve(factor, row(i))).collect();
        let hat: Vec<f64> = (0..dim * dim).map(|k| linalg::dot(row(k / dim), &solved[k % dim])).collect();
        let solved = |x: &[f64], share: f64, diagonal: f64| {
            let matrix: Vec<f64> = hat.iter().map(|h| share * h).collect();
            linalg::cholesky_solve(&linalg::cholesky(&matrix, dim, diagonal).unwrap(), x)
        };
        let left_out = solved(residual, -weight, 1.0 + LEAST_REDUNDANCY);
        let squared = linalg::dot(residual, &solved(&left_out, 1.0 - weight, 1.0));
        let leverage = (0..dim).map(|i| hat[i * dim + i]).sum::<f64>() / dim as f64;
        Influence { leverage, studentized: squared.sqrt() }
    }

    #[test]
    fn rows_side_by_side_are_judged_as_each_alone() {
        let mut made = Simulation { count: 45, ..Simulation::default() }.run(&elbow(), Kind::Pose).unwrap();
        // Every third row has a position only: lanes of one block then differ.
        for observation in made.data.observations.iter_mut().step_by(3) {
            let position = observation.measurement.pose().translation;
            observation.measurement = Measurement::Point(PointMeasurement { position });
        }
        let (data, robot) = (&made.data, &made.nominal);
        let packed = Packed::new(robot, data.all_readings(), data.reading_names().len());
        let estimate = Estimate::new(robot, vec![robot.home], Pose::identity());
        let mut free = Formulation::Adjoint.joint_parameters(&estimate.kinds);
        free.push(Parameter::TargetFrame(TargetFrame { target: 0 }));
        let rows = data.all_rows();
        let noise = Noise { position_m: 1e-3, rotation_rad: 1e-2 };
        let problem = Problem::new(data, &packed, rows.clone(), free, noise, 0.5);
        let normal = problem.normal(&estimate);
        let weights: Vec<f64> = rows.iter().map(|row| [1.0, 0.4, 0.0][*row as usize % 3]).collect();
        let scale = |row: u32, component: usize| 1.0 + f64::from(row % 5) + component as f64;
        let found = influence(&problem, &estimate, &normal, &rows, &weights, scale);

        let n = normal.dim();
        let largest = (0..n).map(|i| normal.gram[i * n + i]).fold(0.0, f64::max);
        let factor = linalg::cholesky(&normal.gram, n, ROUNDING * largest).unwrap();
        let mut expected = Vec::new();
        problem.for_rows(&estimate, &rows, |row, jacobian, residual| {
            let scaled: Vec<f64> = residual.iter().enumerate().map(|(k, e)| e / scale(row, k)).collect();
            expected.push(by_the_book(&factor, jacobian, &scaled, weights[row as usize]));
        });
        let mut worst: f64 = 0.0;
        for (found, expected) in found.iter().zip(&expected) {
            worst = worst.max((found.leverage - expected.leverage).abs());
            worst = worst.max((found.studentized / expected.studentized - 1.0).abs());
        }
        println!("{} rows, largest difference {worst:.1e}", found.len());
        assert_eq!(found.len(), expected.len());
        // Rounding, times the condition of the normal equations' factor.
        assert!(worst < 1e-9);
    }
}
