//! Leverage and studentised residual of each row (theory.md §6 (34d), (34e)).

use crate::problem::{Problem, RowBlock};
use crate::state::Estimate;
use poecal_numerics::kernels::{self as lanes, LaneBlock};
use poecal_numerics::solve::NormalEquations;
use poecal_numerics::{linalg, threads};

/// Rows of one work item.
const CHUNK: usize = 1024;
/// Rounding of the normal equations, as a share of their largest diagonal element.
const ROUNDING: f64 = 1e-13;
/// Smallest share of its own variance that a row keeps: with leverage 1 there is no residual to judge it by.
const LEAST_REDUNDANCY: f64 = 1e-3;

/// Leverage and studentised residual of a row (theory.md §6 (34d), (34e)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Influence {
    /// Mean variance of the row's prediction in units of its noise: for a row fitted with weight 1 the mean diagonal of its block of
    /// the hat matrix, from 0 to 1; for others it may exceed that.
    pub leverage: f64,
    /// Length of the residual in units of its own standard deviation: the root of a χ² with as many degrees of freedom as the row has
    /// numbers.
    pub studentized: f64,
}

/// Influence of some rows on a fit with this normal information: theory.md §6 (34d), (34e). `weights` are those of the fit, one a row (0:
/// not fitted); `problem` is without weights. Residual components are first divided by `scale(row, component)`.
#[must_use]
pub fn influence(
    problem: &Problem<'_>,
    estimate: &Estimate,
    normal: &NormalEquations,
    rows: &[u32],
    weights: &[f64],
    scale: impl Fn(u32, usize) -> f64 + Sync,
) -> Vec<Influence> {
    let n = normal.dim();
    let shifts = problem.layout().shifts();
    let largest = (0..n).map(|i| normal.gram[i * n + i]).fold(0.0, f64::max);
    let damping = (ROUNDING * largest).max(f64::MIN_POSITIVE);
    // If numbers are not finite there is no factor, and all influences are 0.
    let factor = linalg::cholesky(&normal.gram, n, damping).unwrap_or_default();
    let level = problem.level();
    threads::concat_chunks(rows, CHUNK, |part, rows| {
        let weights = weights.get(part * CHUNK..).unwrap_or_default();
        let mut found = vec![Influence { leverage: 0.0, studentized: 0.0 }; rows.len()];
        problem.for_row_blocks(estimate, rows, |places, block| {
            let RowBlock { jacobian, residual, numbers } = block;
            let mut weight = LaneBlock::ZERO;
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
    use crate::parameters::{DeviceFrame, Parameter, TargetFrame, TargetPlace, screw_axes};
    use crate::reference;
    use crate::state::{PackedValues, Session};
    use nalgebra::Vector3;
    use poecal_arm::lie::{Pose, rotation};
    use poecal_model::measurement::{Dataset, Measurement, Noise, Quantity};
    use poecal_model::robot::Robot;
    use poecal_model::simulate::{SessionKind, Simulation, elbow, gantry, scara};
    use poecal_numerics::kernels::simd_levels;
    use poecal_numerics::solve::LeastSquares;

    /// The formulas of theory.md, evaluated literally, one row after the other.
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

    /// Rows of which every third has a position only, so that the lanes of one block differ.
    fn mixed_rows(robot: &Robot, count: usize) -> Dataset {
        let mut made = Simulation { count, ..Simulation::default() }.run(robot, SessionKind::POSE).unwrap();
        for observation in made.data.observations.iter_mut().step_by(3) {
            let position = observation.measurement.pose().translation;
            observation.measurement = Measurement::point(position);
        }
        made.data
    }

    #[test]
    fn rows_side_by_side_are_judged_as_each_alone_at_every_level() {
        let robot = &elbow();
        let data = &mixed_rows(robot, 45);
        let packed = PackedValues::from_dataset(robot, data);
        let estimate = Estimate::new(robot, vec![robot.home], Pose::identity());
        let mut free = screw_axes(estimate.kinds());
        free.push(Parameter::TargetFrame(TargetFrame::new(0)));
        let rows = data.all_rows();
        let noise = Noise::new(1e-3, 1e-2);
        let session = Session::new(robot, data, &packed, true).with_length(0.5);
        let problem = Problem::new(session, rows.clone(), free, noise);
        let normal = problem.normal(&estimate);
        let weights: Vec<f64> = rows.iter().map(|row| [1.0, 0.4, 0.0][*row as usize % 3]).collect();
        let scale = |row: u32, component: usize| 1.0 + f64::from(row % 5) + component as f64;

        let n = normal.dim();
        let largest = (0..n).map(|i| normal.gram[i * n + i]).fold(0.0, f64::max);
        let factor = linalg::cholesky(&normal.gram, n, ROUNDING * largest).unwrap();
        let mut expected = Vec::new();
        reference::for_rows(&problem, &estimate, &rows, |row, jacobian, residual| {
            let scaled: Vec<f64> = residual.iter().enumerate().map(|(k, e)| e / scale(row, k)).collect();
            expected.push(by_the_book(&factor, jacobian, &scaled, weights[row as usize]));
        });
        for level in simd_levels() {
            let problem = problem.clone().with_level(level);
            let found = influence(&problem, &estimate, &normal, &rows, &weights, scale);
            assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().zip(&expected) {
                // Rounding, times the condition of the normal equations' factor.
                assert!((found.leverage - expected.leverage).abs() < 1e-9, "{level:?}");
                assert!((found.studentized / expected.studentized - 1.0).abs() < 1e-9, "{level:?}");
            }
        }
    }

    /// Rows of two targets, of which some state noise, with residual rotations of this size.
    fn turned_rows(robot: &Robot, turned_rad: f64) -> Dataset {
        let mut data = mixed_rows(robot, 67);
        data.targets = vec![Some("a".to_owned()), Some("b".to_owned())];
        for (row, observation) in data.observations.iter_mut().enumerate() {
            observation.target = row % 2;
            observation.stated.set(Quantity::Position, (row % 4 == 0).then_some(1e-4 * (1 + row % 5) as f64));
            let turn = rotation::exp(&(Vector3::new(0.6, -0.48, 0.64) * turned_rad));
            let turned = |pose: Pose| Pose::new(turn * pose.rotation, pose.translation);
            observation.measurement = observation.measurement.map_pose(turned).unwrap();
        }
        data
    }

    #[test]
    fn columns_side_by_side_are_those_of_each_row_at_every_level() {
        for (robot, turned_rad) in [elbow(), scara(), gantry()].iter().zip([0.01, 0.4, 3.0]) {
            let data = turned_rows(robot, turned_rad);
            let packed = PackedValues::from_dataset(robot, &data);
            let other = robot.home * Pose::from_translation(Vector3::new(0.1, 0.0, 0.2));
            let device_from_base = Pose::from_xyz_rpy([0.5, -1.0, 0.2], [0.3, -0.2, 1.2]);
            let estimate = Estimate::new(robot, vec![robot.home, other], device_from_base);
            let mut free = screw_axes(estimate.kinds());
            free.push(Parameter::DeviceFrame(DeviceFrame::new(0, Vector3::new(0.3, -0.2, 0.5))));
            free.push(Parameter::TargetPlace(TargetPlace { target: 0 }));
            free.push(Parameter::TargetFrame(TargetFrame::new(1)));
            let rows = data.all_rows();
            let noise = Noise::new(1e-3, 1e-2);
            let session = Session::new(robot, &data, &packed, true).with_length(0.5);
            let problem = Problem::new(session, rows.clone(), free, noise);
            let mut expected = Vec::new();
            reference::for_rows(&problem, &estimate, &rows, |_, jacobian, residual| {
                expected.push((jacobian.to_vec(), residual.to_vec()));
            });
            for level in simd_levels() {
                let mut seen = 0;
                problem.clone().with_level(level).for_row_blocks(&estimate, &rows, |places, block| {
                    for (lane, &place) in places.iter().enumerate() {
                        let (jacobian, residual) = &expected[place as usize];
                        assert_eq!(block.numbers[lane], residual.len());
                        let own = |k: usize| block.jacobian.iter().map(move |column| column[k].0[lane]);
                        let own_jacobian: Vec<f64> = (0..residual.len()).flat_map(own).collect();
                        let own_residual = block.residual.map(|wide| wide.0[lane]);
                        let apart = [
                            relative_distance(&own_jacobian, jacobian),
                            relative_distance(&own_residual[..residual.len()], residual),
                        ];
                        // Rounding of numbers that result from a few products each.
                        assert!(apart.iter().all(|&apart| apart < 1e-14), "{level:?} {place}: {apart:?}");
                        seen += 1;
                    }
                });
                assert_eq!(seen, rows.len());
            }
        }
    }

    /// Difference from the expected numbers, relative to these.
    fn relative_distance(found: &[f64], expected: &[f64]) -> f64 {
        let norm = |values: &mut dyn Iterator<Item = f64>| values.map(|value| value * value).sum::<f64>().sqrt();
        assert_eq!(found.len(), expected.len());
        norm(&mut found.iter().zip(expected).map(|(a, b)| a - b)) / norm(&mut expected.iter().copied())
    }
}
