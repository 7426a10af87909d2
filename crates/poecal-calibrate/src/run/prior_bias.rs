//! Test whether the residuals of a fit are the bias of its prior, and not noise: theory.md §6, *Pull*.

use poecal_numerics::linalg;
use poecal_numerics::solve::NormalEquations;

/// The prior is released if a step without it would leave a smaller share of the variance: the prior bias is then three times the noise.
const LET_GO: f64 = 0.1;
/// Least number of residuals beyond the unknowns: if these are noise, a step leaves so small a share by chance in four of a million sessions.
const REDUNDANT: usize = 15;
/// Share of the prior that stays in that step: directions that the rows do not determine stay unchanged.
const KEPT: f64 = 1e-2;
/// Limit of the share if `JᵀJ` is that of an earlier state.
const NEARLY: f64 = 0.5;
/// Rounding, as a share of the largest information.
const ROUNDING: f64 = 1e-13;
/// The prior is released if the remaining residuals are smaller than any instrument's noise, as a share of the length of physical scaling.
pub(crate) const FINE: f64 = 1e-5;
/// Weight of a released prior, relative to that by the rule: small beside any residual, and large beside rounding.
pub(crate) const RELEASED: f64 = 1e-6;
/// Factor by which a fit without its prior ends sooner: its remaining motion is the rest of the prior bias.
pub(crate) const SOONER: f64 = 1000.0;
/// Mean square of exact residuals over that of rounding: three picometres.
pub(crate) const EXACT: f64 = 1e7;

/// Share of the residuals' variance that is not prior bias, if it is small; `None` if they may be noise. `fitted` is the normal information of a fit,
/// `believed` the prior's part of it, and `seen` recomputes that of the rows.
pub(crate) fn left_by_pull(
    fitted: &NormalEquations,
    believed: &NormalEquations,
    seen: impl FnOnce() -> NormalEquations,
) -> Option<f64> {
    let less = |all: &[f64], part: &[f64]| all.iter().zip(part).map(|(all, part)| all - part).collect();
    let nearly = NormalEquations {
        gram: less(&fitted.gram, &believed.gram),
        gradient: less(&fitted.gradient, &believed.gradient),
        cost: fitted.cost - believed.cost,
        residuals: fitted.residuals,
    };
    remaining_variance(&nearly, believed).filter(|left| *left < NEARLY)?;
    remaining_variance(&seen(), believed).filter(|left| *left < LET_GO)
}

/// Variance of the residuals after a step without the prior, over their mean square; `None` if too few are left to decide.
fn remaining_variance(seen: &NormalEquations, believed: &NormalEquations) -> Option<f64> {
    let n = seen.dim();
    let redundant = seen.residuals.checked_sub(n).filter(|it| *it >= REDUNDANT)?;
    let kept: Vec<f64> = seen.gram.iter().zip(&believed.gram).map(|(own, prior)| own + KEPT * prior).collect();
    let largest = (0..n).map(|i| kept[i * n + i]).fold(0.0, f64::max);
    let factor = linalg::cholesky(&kept, n, ROUNDING * largest)?;
    let step = linalg::cholesky_solve(&factor, &seen.gradient);
    let cost = (seen.cost - seen.predicted_reduction(&step)).max(0.0);
    Some(cost / seen.cost * seen.residuals as f64 / redundant as f64)
}
