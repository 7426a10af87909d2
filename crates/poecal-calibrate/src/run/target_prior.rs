//! Prior of targets' positions near nominal, if the rows leave the positions undetermined: theory.md §6, *Targets*.

use super::CalibrationRun;
use crate::robust::RobustFit;
use crate::steps::fit_progress::{FinishedFit, RegisteredStart};
use poecal_fit::problem::{Prior, Problem};
use poecal_model::measurement::Noise;
use poecal_numerics::linalg;
use poecal_numerics::solve::{LeastSquares as _, NormalEquations};

/// Prior standard deviations of targets' positions that are tried before the widest, metres.
const SIGMAS_M: [f64; 3] = [0.02, 0.06, 0.2];
/// Standard deviation of the positions by the rows and the axes' prior, metres: the least with which another prior of targets matters for left-out
/// rows, and the least with which it decides in the fit.
const MATTERS_M: f64 = 1e-3;
const OPEN_M: f64 = 5e-3;
/// Loss of twice the cost (27) by which the rows contradict a prior: 95 % of χ² with one degree of freedom.
const CONTRADICTED: f64 = 3.84;
/// Rounding of information, as a share of its largest diagonal element.
const ROUNDING: f64 = 1e-14;

/// A run with a narrower prior of its targets' positions, and its fit.
pub(crate) struct NarrowedRun<'a> {
    pub(crate) run: CalibrationRun<'a>,
    pub(crate) start: RegisteredStart,
    pub(crate) fit: RobustFit,
}

impl<'a> CalibrationRun<'a> {
    /// The run with the narrowest prior of targets' positions that the rows do not contradict; `None` if they determine the positions, or contradict
    /// all but the widest.
    pub(crate) fn with_narrower_targets(&self, widest: &RobustFit) -> Option<NarrowedRun<'a>> {
        let open_m = self.open_m(self.prior.as_ref()?, &widest.fitted).filter(|open| *open > MATTERS_M)?;
        let rows = widest.robustness.registration_rows(&self.fit_rows);
        let noise = widest.fitted.noise;
        let least = self.cost(&rows, noise, &widest.fitted)?;
        SIGMAS_M.into_iter().find_map(|sigma_m| {
            let mut run = self.clone();
            run.unknowns.target_sigma_m = Some(sigma_m);
            run.prior = run.options.prior(&run.session(&[]));
            run.open_targets_m = Some(open_m);
            let start = run.register();
            let fit = run.fit_with(&[], &start, run.options.robust).ok()?;
            let lost = 2.0 * (run.cost(&rows, noise, &fit.fitted)? - least);
            (lost <= CONTRADICTED).then_some(NarrowedRun { run, start, fit })
        })
    }

    /// The cost (27) of a fit by these rows, in units of the variance of their whitened residuals if it is above 1.
    fn cost(&self, rows: &[u32], noise: Noise, fitted: &FinishedFit) -> Option<f64> {
        let free = fitted.layout.parameters().map(|(parameter, _)| *parameter).collect();
        let of_rows = Problem::new(self.session(&[]), rows.to_vec(), free, noise).normal(&fitted.estimate);
        let cost = of_rows.cost / of_rows.mean_square().max(1.0) + self.prior.as_ref()?.cost(&fitted.estimate);
        cost.is_finite().then_some(cost)
    }

    /// Standard deviation of the positions of targets by the rows and the axes' prior, metres, at most that of the targets' prior.
    fn open_m(&self, prior: &Prior, fitted: &FinishedFit) -> Option<f64> {
        let sigma_m = prior.target_sigma_m()?;
        let n = fitted.layout.dim();
        let of = |prior: &Prior| {
            let mut normal = NormalEquations::new(n);
            prior.add(&fitted.estimate, &fitted.layout, 1.0, &mut normal);
            normal.gram
        };
        let (all, of_axes) = (of(prior), of(&prior.without_targets()));
        let both: Vec<f64> = fitted.normal.gram.iter().zip(&all).map(|(rows, prior)| rows + prior).collect();
        let largest = (0..n).map(|at| both[at * n + at]).fold(0.0, f64::max);
        let covariance = linalg::inverse(&linalg::cholesky(&both, n, ROUNDING * largest)?);
        let share: f64 = (0..n * n)
            .map(|at| {
                let (i, j) = (at / n, at % n);
                let at_upper = i.min(j) * n + i.max(j);
                covariance[at] * (all[at_upper] - of_axes[at_upper])
            })
            .sum();
        Some(sigma_m * share.max(0.0).sqrt())
    }

    /// States that the rows leave the positions of targets undetermined, and recommends measurements.
    pub(crate) fn open_targets(&self) -> Option<String> {
        let (open_m, sigma_m) = self.open_targets_m.filter(|open| *open > OPEN_M).zip(self.unknowns.target_sigma_m)?;
        Some(format!(
            "the rows leave the place of the target on the last link open (standard deviation {:.0} mm), so it is taken to be within about {:.0} mm of the model's: \
             if it may be farther, measure configurations that turn the tool about other axes, or put its place into the model",
            1e3 * open_m,
            2e3 * sigma_m
        ))
    }
}
