//! Further starts if a fit may have converged to a local minimum, and the choice among equal optima.

use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::task::FitTask;
use crate::nominal_estimate;
use crate::steps::fit_progress::SolverReport;
use poecal_fit::gauge;
use poecal_fit::problem::Problem;
use poecal_fit::state::{Estimate, Session, rms_m, sample_rows};
use poecal_model::measurement::Noise;
use poecal_model::simulate::random;
use poecal_numerics::solve::{LeastSquares as _, NormalEquations, Options};

/// Rows on which further starts are compared.
const RESTART_SAMPLE: usize = 200;

impl FitTask<'_> {
    /// Further starts if the error suggests a local minimum: random screws around the registered ones, on a subsample. Returns a clearly
    /// better start, if one was found, and the number of starts.
    pub(crate) fn restart(
        &self,
        registered: &Estimate,
        fitted: &Estimate,
        noise: Noise,
    ) -> Option<(Option<Estimate>, usize)> {
        let sample = sample_rows(self.rows, RESTART_SAMPLE);
        let problem = |estimate: &Estimate| {
            Problem::new(self.session, sample.clone(), self.free_parameters(estimate), noise).with_prior(self.prior)
        };
        if self.options.restarts == 0 || !self.is_suspicious(self.position_rms(fitted)) {
            return None;
        }
        let after = problem(fitted).normal(fitted).cost;
        let options = Options { iterations: 40, decrement: 1e-3, ..self.options.solver };
        let mut generator = ChaCha8Rng::seed_from_u64(self.options.seed ^ 0x5eed);
        let mut best: (f64, Option<Estimate>) = (0.8 * after, None);
        let mut tried = 0;
        while tried < self.options.restarts {
            tried += 1;
            let scale = [0.05, 0.1, 0.2, 0.4][tried % 4];
            let start = self.scatter_axes(registered, scale, &mut generator);
            let (found, normal, _) = self.minimize(&problem(&start), start, &options);
            if normal.cost < best.0 {
                best.0 = 0.999 * normal.cost;
                if !self.is_suspicious(self.position_rms(&found)) {
                    best.1 = Some(found);
                    break;
                }
                best.1 = Some(found);
            }
        }
        Some((best.1, tried))
    }

    /// Root mean square distance from prediction to measurement, metres.
    fn position_rms(&self, estimate: &Estimate) -> f64 {
        rms_m(&self.session.errors(self.rows, estimate))
    }

    /// The estimate with every axis tilted by about `scale` radians and shifted by as much of the arm's length.
    fn scatter_axes(&self, estimate: &Estimate, scale: f64, generator: &mut ChaCha8Rng) -> Estimate {
        let layout = self.problem(estimate, Noise::new(1.0, 1.0)).layout().clone();
        let step: Vec<f64> =
            (0..layout.dim()).map(|_| scale * self.session.length_m * random::normal(generator)).collect();
        layout.retract(estimate, &step)
    }

    /// Moves along exactly null directions to the screws nearest to nominal; the fit is renewed after each move. An unknown device
    /// frame lets the base follow, which changes no prediction.
    pub(crate) fn settle_null_directions(
        &self,
        estimate: Estimate,
        normal: NormalEquations,
        noise: Noise,
        report: &mut SolverReport,
    ) -> (Estimate, NormalEquations) {
        let (mut estimate, mut normal) = (estimate, normal);
        let Session { robot, data, length_m, .. } = self.session;
        let base_free = self.session.base_free();
        let targets = nominal_estimate(robot, data).base_from_target;
        for _ in 0..8 {
            if base_free {
                let motion = gauge::base_motion(&estimate, robot, &targets, length_m);
                estimate = estimate.rebase(&motion);
            }
            let problem = self.problem(&estimate, noise);
            let layout = problem.layout();
            let Some(step) = gauge::null_step(&estimate, robot, layout, &normal.gram, length_m, base_free) else {
                break;
            };
            let length = step.iter().map(|s| s * s).sum::<f64>().sqrt();
            let (moved, _, summary) = self.minimize(&problem, problem.retract(&estimate, &step), &self.options.solver);
            let moved_normal = problem.normal(&moved);
            if length < 1e-10 || moved_normal.cost > normal.cost * (1.0 + 1e-6) + 1e-12 {
                break;
            }
            (estimate, normal) = (moved, moved_normal);
            report.iterations += summary.iterations;
            report.termination = summary.termination;
        }
        (estimate, normal)
    }
}
