//! What the model does not describe, as the residuals show it.

use super::folds::CrossValidation;
use super::view::View;
use super::{clusters, neighbours};
use crate::measurement::Noise;
use crate::solve::Normal;

/// What residuals show beside noise.
///
/// ```
/// let none = poecal::uncertainty::Discrepancy::none();
/// assert_eq!((none.inflation, none.standard_deviation.position_m), (1.0, 0.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Discrepancy {
    /// By how much the covariance of the unknowns is larger than white noise would make it, at least 1.
    pub inflation: f64,
    /// Standard deviation of each component of the residuals, stated noise taken off, where they are no mere noise; else zero.
    pub standard_deviation: Noise,
}

impl Discrepancy {
    /// Nothing but noise.
    #[must_use]
    pub fn none() -> Self {
        Discrepancy { inflation: 1.0, standard_deviation: Noise { position_m: 0.0, rotation_rad: 0.0 } }
    }
}

/// Judges by a fit and its normal information whether the residuals are more than noise: alike in neighbouring configurations, or clusters of them pulling together. If so, they
/// count as error of the model wherever it is used, and the covariance grows to what the clusters show, or to what leaving out blocks
/// showed (root mean square of their growths: the worse ones count more, since a robot is used where nobody measured).
#[must_use]
pub fn discrepancy(
    view: &View<'_>,
    normal: &Normal,
    cross_validation: Option<&CrossValidation>,
) -> Discrepancy {
    let clusters = clusters::inflation(view, normal);
    let (position_alike, rotation_alike) = neighbours::alike(view);
    if clusters.is_none() && !position_alike && !rotation_alike {
        return Discrepancy::none();
    }
    let blocks = cross_validation.map_or(1.0, |found| {
        let squares = found.blocked.iter().map(|block| block.growth.max(0.0).powi(2)).sum::<f64>();
        // On a sample the unknowns are known less well, so that the same error is a smaller multiple.
        (squares / found.blocked.len().max(1) as f64).sqrt() / found.sampled
    });
    Discrepancy {
        inflation: clusters.unwrap_or(1.0).max(blocks),
        standard_deviation: beyond_stated_noise(view),
    }
}

/// Standard deviation of each residual component, stated noise taken off.
fn beyond_stated_noise(view: &View<'_>) -> Noise {
    let mut sums = [(0.0, 0.0, 0usize); 2];
    for (&row, error) in view.rows.iter().zip(view.errors(view.rows, view.estimate)) {
        let observation = &view.data.observations[row as usize];
        let usual = |sigma| if view.noise_is_stated { sigma } else { 0.0 };
        let sigmas = [
            observation.sigma_position_m.unwrap_or(usual(view.noise.position_m)),
            observation.sigma_rotation_rad.unwrap_or(usual(view.noise.rotation_rad)),
        ];
        for (sum, (part, sigma)) in
            sums.iter_mut().zip([(Some(error.position_m), sigmas[0]), (error.rotation_rad, sigmas[1])])
        {
            if let Some(part) = part {
                sum.0 += part.norm_squared();
                sum.1 += 3.0 * sigma * sigma;
                sum.2 += 3;
            }
        }
    }
    let [position_m, rotation_rad] =
        sums.map(|(found, stated, count)| ((found - stated).max(0.0) / count.max(1) as f64).sqrt());
    Noise { position_m, rotation_rad }
}
