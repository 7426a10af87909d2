//! Touches of fixed points, and the least squares of tips and points.

use nalgebra::{Matrix3, Vector3};

use super::readings::PoseList;
use poecal_arm::lie::Pose;
use poecal_numerics::distributions::{f_quantile, median};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::linalg::{cholesky, cholesky_solve, symmetric_eigen};

/// Fewest touches.
pub(crate) const FEWEST: usize = 3;
/// Probability with which a session without outliers loses a row.
const LOST: f64 = 0.01;
/// Rounds of robust weights, and of outliers.
const ROUNDS: usize = 40;
/// Least share of the least tilt of all touches that remains without outliers; the same without any single further touch; and the largest
/// number of touches for which the latter is tested.
const STILL_TILTED: f64 = 0.5;
const TILTED_WITHOUT_ONE: f64 = 0.25;
const MANY: usize = 50;

/// Poses in which a tip touched a point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Touches {
    /// Pose `base_from_flange` of each row.
    pub flange: PoseList,
    /// Name of the point of each row; empty if there is one.
    pub points: Vec<String>,
    /// Name of the tip of each row; empty if there is one.
    pub tips: Vec<String>,
}

/// Names of tips and points, and those of each row.
pub(crate) struct TouchLayout {
    pub(crate) tips: Vec<String>,
    pub(crate) points: Vec<String>,
    /// Tip and point of each row.
    pub(crate) rows: Vec<(usize, usize)>,
}

/// A fit: all unknowns, tips first, and the rows that count.
pub(crate) struct TouchFit {
    pub(crate) unknowns: Vec<f64>,
    pub(crate) kept: Vec<bool>,
    pub(crate) sigma_m: f64,
    pub(crate) freedom: f64,
}

impl TouchLayout {
    pub(crate) fn from_touches(touches: &Touches) -> Self {
        let mut layout = TouchLayout { tips: Vec::new(), points: Vec::new(), rows: Vec::new() };
        let index = |names: &mut Vec<String>, name: Option<&String>| {
            let name = name.cloned().unwrap_or_default();
            names.iter().position(|it| *it == name).unwrap_or_else(|| {
                names.push(name);
                names.len() - 1
            })
        };
        for row in 0..touches.flange.poses.len() {
            let tip = index(&mut layout.tips, touches.tips.get(row));
            let point = index(&mut layout.points, touches.points.get(row));
            layout.rows.push((tip, point));
        }
        layout
    }

    pub(crate) fn unknowns(&self) -> usize {
        3 * (self.tips.len() + self.points.len())
    }

    pub(crate) fn refuse_few(&self, touches: &Touches) -> Result<()> {
        for (tip, name) in self.tips.iter().enumerate() {
            let count = self.rows.iter().filter(|it| it.0 == tip).count();
            if count < FEWEST && !touches.tips.is_empty() {
                return ErrorKind::Problem.refuse(format!(
                    "found {count} touches of the tip `{name}`, expected {FEWEST} or more: touch the point with it in other orientations"
                ));
            }
        }
        if 3 * self.rows.len() <= self.unknowns() {
            return ErrorKind::Problem.refuse(format!(
                "found {} touches of {} points, expected three or more of a point: touch each point in several orientations",
                self.rows.len(),
                self.points.len()
            ));
        }
        Ok(())
    }

    /// Least squares with a weight of each row.
    fn solve_weighted(&self, poses: &[Pose], weights: &[f64]) -> Option<Vec<f64>> {
        let n = self.unknowns();
        let (mut gram, mut right) = (vec![0.0; n * n], vec![0.0; n]);
        for ((pose, (tip, point)), weight) in poses.iter().zip(&self.rows).zip(weights) {
            let (tip, point) = (3 * tip, 3 * (self.tips.len() + point));
            for row in 0..3 {
                let entries: [(usize, f64); 4] =
                    std::array::from_fn(
                        |k| {
                            if k < 3 { (tip + k, pose.rotation[(row, k)]) } else { (point + row, -1.0) }
                        },
                    );
                for (i, a) in entries {
                    right[i] -= weight * a * pose.translation[row];
                    for (j, b) in entries {
                        gram[i * n + j] += weight * a * b;
                    }
                }
            }
        }
        let factor = cholesky(&gram, n, 0.0)?;
        let found = cholesky_solve(&factor, &right);
        found.iter().all(|it| it.is_finite()).then_some(found)
    }

    /// Distance of each row's tip from its point.
    pub(crate) fn misses(&self, poses: &[Pose], unknowns: &[f64]) -> Vec<Vector3<f64>> {
        let at = |k: usize| Vector3::new(unknowns[k], unknowns[k + 1], unknowns[k + 2]);
        let rows = poses.iter().zip(&self.rows);
        rows.map(|(pose, (tip, point))| pose.act(&at(3 * tip)) - at(3 * (self.tips.len() + point))).collect()
    }

    /// The fit without outliers: first by least absolute distances, then by least squares of the rows that agree.
    pub(crate) fn robustly(&self, poses: &[Pose]) -> Option<TouchFit> {
        let mut weights = vec![1.0; poses.len()];
        let (_, tilted) = self.least_tilted(poses, &vec![true; poses.len()]);
        let mut unknowns = self.solve_weighted(poses, &weights)?;
        for _ in 0..ROUNDS {
            let lengths: Vec<f64> = self.misses(poses, &unknowns).iter().map(Vector3::norm).collect();
            let middle = median(lengths.iter().copied())?.max(1e-9);
            weights = lengths.iter().map(|it| middle / it.max(0.1 * middle)).collect();
            unknowns = self.solve_weighted(poses, &weights)?;
        }
        let lengths = self.misses(poses, &unknowns).iter().map(Vector3::norm).collect::<Vec<f64>>();
        // A few touches have little redundancy.
        let few = poses.len() as f64 / (poses.len() as f64 - self.unknowns() as f64 / 3.0).max(0.5);
        let mut sigma_m = (few.sqrt() * median(lengths.iter().copied())? / 1.538).max(1e-9);
        let mut kept = vec![true; poses.len()];
        let mut freedom = 3.0 * poses.len() as f64 - self.unknowns() as f64;
        for _ in 0..ROUNDS {
            let lengths: Vec<f64> = self.misses(poses, &unknowns).iter().map(Vector3::norm).collect();
            let cut = 3.0 * f_quantile(LOST / poses.len() as f64, 3.0, freedom.max(1.0));
            let mut next: Vec<bool> = lengths.iter().map(|it| (it / sigma_m).powi(2) <= cut).collect();
            if !self.are_enough(poses, &next, tilted) {
                next.fill(true);
            }
            weights = next.iter().map(|it| f64::from(u8::from(*it))).collect();
            unknowns = self.solve_weighted(poses, &weights)?;
            let misses = self.misses(poses, &unknowns);
            let squares: f64 = misses.iter().zip(&weights).map(|(miss, weight)| weight * miss.norm_squared()).sum();
            freedom = 3.0 * weights.iter().sum::<f64>() - self.unknowns() as f64;
            sigma_m = (squares / freedom.max(1.0)).sqrt().max(1e-10);
            let is_done = next == kept;
            kept = next;
            if is_done {
                break;
            }
        }
        Some(TouchFit { unknowns, kept, sigma_m, freedom })
    }

    /// True if the remaining rows determine all that all touches do, also without any one of them. Rows that alone determine a direction
    /// contradict nothing, and are never left out.
    fn are_enough(&self, poses: &[Pose], kept: &[bool], tilted: f64) -> bool {
        let has = |of: &dyn Fn(&(usize, usize)) -> bool| self.rows.iter().zip(kept).any(|(row, kept)| *kept && of(row));
        let is_tilted = |kept: &[bool], share: f64| self.least_tilted(poses, kept).1 >= share * tilted;
        let without = |row: usize| {
            let others: Vec<bool> = kept.iter().enumerate().map(|(at, kept)| *kept && at != row).collect();
            is_tilted(&others, TILTED_WITHOUT_ONE)
        };
        let count = kept.iter().filter(|it| **it).count();
        count == kept.len()
            || 3 * count > self.unknowns()
                && (0..self.tips.len()).all(|tip| has(&|row| row.0 == tip))
                && (0..self.points.len()).all(|point| has(&|row| row.1 == point))
                && is_tilted(kept, STILL_TILTED)
                && (count > MANY || (0..kept.len()).filter(|row| kept[*row]).all(without))
    }

    /// The direction in the flange along which the orientations of some rows tilted least, and the root mean square change of that unit vector.
    pub(crate) fn least_tilted(&self, poses: &[Pose], kept: &[bool]) -> (Vector3<f64>, f64) {
        let count = kept.iter().filter(|it| **it).count();
        let mut upper = [0.0; 9];
        for (tip, point) in (0..self.tips.len()).flat_map(|tip| (0..self.points.len()).map(move |point| (tip, point))) {
            let rows = poses.iter().zip(&self.rows).zip(kept);
            let own: Vec<&Pose> =
                rows.filter(|((_, row), kept)| **kept && **row == (tip, point)).map(|it| it.0.0).collect();
            let mean = own.iter().map(|it| it.rotation).sum::<Matrix3<f64>>() / own.len().max(1) as f64;
            for pose in own {
                let off = pose.rotation - mean;
                let squares = off.transpose() * off / count as f64;
                for (k, sum) in upper.iter_mut().enumerate() {
                    *sum += squares[(k / 3, k % 3)];
                }
            }
        }
        let (values, vectors) = symmetric_eigen(&upper, 3);
        (Vector3::new(vectors[(0, 0)], vectors[(1, 0)], vectors[(2, 0)]), values[0].max(0.0).sqrt())
    }
}

impl TouchFit {
    /// Root mean square distance of the rows that count.
    pub(crate) fn rms(&self, poses: &[Pose], layout: &TouchLayout) -> f64 {
        let misses = layout.misses(poses, &self.unknowns);
        let kept: Vec<f64> =
            misses.iter().zip(&self.kept).filter(|(_, kept)| **kept).map(|(it, _)| it.norm_squared()).collect();
        (kept.iter().sum::<f64>() / kept.len().max(1) as f64).sqrt()
    }
}
