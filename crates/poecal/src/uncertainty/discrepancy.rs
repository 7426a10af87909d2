//! Model error, as the residuals show it.

use super::folds::CrossValidation;
use super::remainder::{Attribution, Remainder};
use super::view::View;
use super::{clusters, neighbours, order};
use crate::measurement::Noise;
use crate::solve::Normal;

/// Model error and noise, as the residuals show them (theory.md §9 (40) and (41)).
///
/// ```
/// let none = poecal::uncertainty::Discrepancy::none();
/// assert_eq!((none.scatter, none.standard_deviation.position_m), (1.0, 0.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Discrepancy {
    /// Factor κ of the covariance of the unknowns over that of independent residuals, at least 1.
    pub scatter: f64,
    /// The factor outside the sampled range, where model error is a bias, which does not average out.
    pub extrapolation: f64,
    /// Standard deviation of each component of the model error.
    pub standard_deviation: Noise,
    /// Standard deviation of each component of the instrument's noise.
    pub noise: Noise,
    /// Source of the residuals of position, and of those of rotation.
    pub attribution: [Attribution; 2],
    /// Degrees of freedom of these standard deviations and of the variance of the residuals, of positions and of rotations; infinite
    /// where they are stated.
    pub freedom: [f64; 2],
    /// Correlation of the residuals of consecutive rows, if it is significant.
    pub lag_one: Option<f64>,
}

impl Discrepancy {
    /// No model error, and noise that is known.
    #[must_use]
    pub fn none() -> Self {
        let zero = Noise { position_m: 0.0, rotation_rad: 0.0 };
        Discrepancy {
            scatter: 1.0,
            extrapolation: 1.0,
            standard_deviation: zero,
            noise: zero,
            attribution: [Attribution::StatedNoise; 2],
            freedom: [f64::INFINITY; 2],
            lag_one: None,
        }
    }
}

/// Attributes the residuals of a fit to robot or instrument, and finds the factors of its covariance (theory.md §9 (41) and (43)). They
/// count as the robot's unless stated noise or the scatter of repeated measurements explains them and they show no structure.
#[must_use]
pub fn discrepancy(
    view: &View<'_>,
    normal: &Normal,
    remainder: &Remainder,
    cross_validation: Option<&CrossValidation>,
) -> Discrepancy {
    let lag_one = order::correlation(view);
    let by_place = clusters::inflation(view, normal, clusters::clusters);
    let by_time = lag_one.and_then(|_| clusters::inflation(view, normal, clusters::in_order));
    let (position_alike, rotation_alike) = neighbours::alike(view);
    let structured = by_place.is_some() || lag_one.is_some();
    let position = remainder.position.settled(structured || position_alike);
    let rotation = remainder.rotation.settled(structured || rotation_alike);
    let scatter = by_place.unwrap_or(1.0).max(by_time.unwrap_or(1.0));
    let blocks =
        cross_validation.filter(|_| position.attribution == Attribution::Robot).map_or(1.0, |found| {
            let squares = found.blocked.iter().map(|block| block.growth.max(0.0).powi(2)).sum::<f64>();
            // The covariance of a sample's unknowns is larger, so that the same error is a smaller multiple of it.
            (squares / found.blocked.len().max(1) as f64).sqrt() / found.sampled
        });
    Discrepancy {
        scatter,
        extrapolation: scatter.max(blocks),
        standard_deviation: Noise { position_m: position.robot, rotation_rad: rotation.robot },
        noise: Noise { position_m: position.instrument, rotation_rad: rotation.instrument },
        attribution: [position.attribution, rotation.attribution],
        freedom: [position.freedom, rotation.freedom],
        lag_one,
    }
}
