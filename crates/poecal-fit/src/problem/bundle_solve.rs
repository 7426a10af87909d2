//! Optimum of a bundle.

use nalgebra::DVector;

use super::bundle::Bundle;
use crate::state::Estimate;
use poecal_numerics::kernels as lanes;
use poecal_numerics::solve::NormalEquations;

/// Largest number of steps.
const STEPS: usize = 30;
/// Expected fall of the cost, as a share of it, below which a step is the last one.
const SETTLED: f64 = 1e-9;
/// First damping, as a share of the diagonal.
const DAMPING: f64 = 1e-9;

/// Optimum of a bundle.
#[derive(Clone, Debug)]
pub struct BundleOptimum {
    /// Robot, and poses of cameras and boards.
    pub estimate: Estimate,
    /// Unknown numbers of cameras and boards, in standard deviations of their prior.
    pub numbers: DVector<f64>,
    /// Half the squares of the corners and of the numbers' prior, in standard deviations.
    pub cost: f64,
    /// Number of passes over the corners.
    pub passes: usize,
}

impl Bundle<'_> {
    /// Optimum from a start.
    #[must_use]
    pub fn solve(&self, start: &Estimate, numbers: &DVector<f64>) -> BundleOptimum {
        let (mut estimate, mut numbers) = (start.clone(), numbers.clone());
        let mut sums = self.normal(&estimate, &numbers);
        let (mut damping, mut passes) = (DAMPING, 1);
        for _ in 0..STEPS {
            let Some(step) = self.step(&sums, damping) else {
                damping = (damping * 100.0).max(DAMPING);
                continue;
            };
            let fall = 0.5 * step.iter().zip(&sums.gradient).map(|(a, b)| a * b).sum::<f64>();
            let robot = self.layout.dim();
            let next = self.layout.retract(&estimate, &step[..robot]);
            let next_numbers = &numbers + DVector::from_column_slice(&step[robot..]);
            if fall <= SETTLED * sums.cost {
                return BundleOptimum { estimate: next, numbers: next_numbers, cost: sums.cost - fall, passes };
            }
            let found = self.normal(&next, &next_numbers);
            passes += 1;
            if found.cost < sums.cost {
                (estimate, numbers, sums) = (next, next_numbers, found);
                damping = (damping * 0.01).max(DAMPING);
            } else {
                damping = (damping * 100.0).max(1e-4);
            }
        }
        BundleOptimum { estimate, numbers, cost: sums.cost, passes }
    }

    /// Gauss-Newton step with a damping of the diagonal; `None` if the damped matrix is singular.
    fn step(&self, sums: &NormalEquations, damping: f64) -> Option<Vec<f64>> {
        let n = sums.gradient.len();
        let mut gram = sums.gram.clone();
        let least = 1e-12 * (0..self.layout.dim()).map(|k| gram[k * n + k]).fold(0.0, f64::max);
        gram.iter_mut().step_by(n + 1).for_each(|value| *value += damping * *value + least);
        let factor = lanes::cholesky(self.level, &gram, n, 0.0)?;
        let mut step = sums.gradient.clone();
        lanes::solve(self.level, &factor, &mut step);
        step.iter().all(|it| it.is_finite()).then_some(step)
    }
}
