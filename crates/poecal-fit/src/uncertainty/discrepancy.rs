//! Model error, estimated from the residuals.

use super::folds::CrossValidation;
use super::residual_variance::{Attribution, ResidualVariance};
use super::view::FitView;
use super::{clusters, neighbours, serial_correlation};
use poecal_model::camera::{Centre, CommonError, Picture};
use poecal_model::measurement::{ByQuantity, Noise, Quantity};
use poecal_numerics::solve::NormalEquations;
use poecal_numerics::unit::Unit;

/// Model error and noise, estimated from the residuals (theory.md §9 (40) and (41)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Discrepancy {
    /// Factor κ of the covariance of the unknowns over that of independent residuals, at least 1.
    pub scatter: f64,
    /// Factor κ outside the sampled range, where model error is a bias, which does not average out.
    pub extrapolation: f64,
    /// Standard deviation of each component of the model error.
    pub standard_deviation: Noise,
    /// Standard deviation of each component of the instrument's noise.
    pub noise: Noise,
    /// Source of the residuals of position, and of those of rotation.
    pub attribution: ByQuantity<Attribution>,
    /// Degrees of freedom of these standard deviations and of the variance of the residuals, of positions and of rotations; infinite
    /// if they are stated.
    pub freedom: ByQuantity<f64>,
    /// Correlation of the residuals of consecutive rows, if it is significant.
    pub lag_one: Option<f64>,
}

impl Discrepancy {
    /// No model error, and known noise.
    #[must_use]
    pub fn zero() -> Self {
        let zero = Noise::new(0.0, 0.0);
        Discrepancy {
            scatter: 1.0,
            extrapolation: 1.0,
            standard_deviation: zero,
            noise: zero,
            attribution: ByQuantity::from_fn(|_| Attribution::StatedNoise),
            freedom: ByQuantity::from_fn(|_| f64::INFINITY),
            lag_one: None,
        }
    }
}

/// Attributes the residuals of a fit to robot or instrument, and estimates the factors of its covariance (theory.md §9 (41) and (43)).
/// They count as the robot's, unless stated noise or the scatter of repeated measurements explains them and they have no structure.
#[must_use]
pub fn discrepancy(
    view: &FitView<'_>,
    normal: &NormalEquations,
    remainder: &ResidualVariance,
    cross_validation: Option<&CrossValidation>,
) -> Discrepancy {
    let lag_one = serial_correlation::correlation(view);
    let by_place = clusters::inflation(view, normal, clusters::clusters);
    let by_time = lag_one.and_then(|_| clusters::inflation(view, normal, clusters::in_order));
    let alike = neighbours::correlated_quantities(view);
    let structured = by_place.is_some() || lag_one.is_some();
    let own = ByQuantity::from_fn(|quantity| remainder.parts[quantity].attribute(structured || alike[quantity]));
    let own = ByQuantity::from_fn(|quantity| match of_pictures(view, quantity) {
        Some(common) => remainder.parts[quantity].with_robot_part(common),
        None => own[quantity],
    });
    // A quantity that was not measured is predicted as well as the others of its unit.
    let is_measured =
        |quantity: &Quantity| remainder.parts[*quantity].stated.is_some() || view.session.data.has(*quantity);
    let settled = ByQuantity::from_fn(|quantity| {
        let like = |other: &Quantity| other.unit() == quantity.unit() && is_measured(other);
        let instead = Quantity::ALL.into_iter().find(like).filter(|_| !is_measured(&quantity));
        own[instead.unwrap_or(quantity)]
    });
    let leading = settled[Quantity::Position];
    let scatter = by_place.unwrap_or(1.0).max(by_time.unwrap_or(1.0));
    let blocks = cross_validation.filter(|_| leading.attribution == Attribution::Robot).map_or(1.0, |found| {
        let squares = found.blocked.iter().map(|block| block.growth.max(0.0).powi(2)).sum::<f64>();
        // The covariance of a sample's unknowns is larger, so that the same error is a smaller multiple of it.
        (squares / found.blocked.len().max(1) as f64).sqrt() / found.sampled
    });
    Discrepancy {
        scatter,
        extrapolation: scatter.max(blocks),
        standard_deviation: settled.map(|it| it.robot),
        noise: settled.map(|it| it.instrument),
        attribution: settled.map(|it| it.attribution),
        freedom: settled.map(|it| it.freedom),
        lag_one,
    }
}

/// Standard deviation of the shared error of a picture's corners, if all rows are pictures: an error of the configuration, and no noise.
fn of_pictures(view: &FitView<'_>, quantity: Quantity) -> Option<f64> {
    let pictures = &view.session.data.pictures;
    let is_picture = |row: &u32| pictures.index_of_row(*row).is_some();
    if pictures.is_empty() || !view.rows.iter().all(is_picture) {
        return None;
    }
    let CommonError { shift_m, turn_rad, about, .. } = pictures.common;
    // If it turns about the other of camera and board, the subject of the row is carried along: two thirds of the square in each direction.
    let is_other = |picture: &&Picture| (about == Centre::Camera) != picture.of_camera;
    let arms = pictures.all.iter().filter(is_other);
    let arms = arms.filter_map(|it| view.session.data.observations.get(it.row as usize));
    let squares: f64 = arms.map(|row| row.measurement.pose().translation.norm_squared()).sum();
    let carried = turn_rad * turn_rad * squares / pictures.all.len() as f64 * 2.0 / 3.0;
    match quantity.unit() {
        Unit::Metre => Some((shift_m * shift_m + carried).sqrt()),
        Unit::Radian => Some(turn_rad),
        Unit::One | Unit::Second => None,
    }
}
