//! Pose accuracy and repeatability of configurations that were measured several times (ISO 9283).

use nalgebra::Vector3;
use serde::Serialize;

use crate::{Calibration, RowError};
use poecal_fit::state::{Estimate, Session, turn_to_first};
use poecal_model::measurement::{Dataset, Quantity};

/// Fewest rows of one configuration; ISO 9283 requires 30.
const ROWS: usize = 3;
/// Readings (radians, metres) within this belong to one configuration: encoder differences of a robot that returned.
const SAME: f64 = 1e-4;
/// Standard deviations added to the mean distance, as in ISO 9283.
const DEVIATIONS: f64 = 3.0;

/// One target in one configuration that was measured at least three times (theory.md §9 (46)).
#[derive(Clone, Debug, PartialEq)]
pub struct RepeatedPose {
    /// Its rows.
    pub rows: Vec<u32>,
    /// Quantity of the compared errors: the first of its measurements, for poses and points the position.
    pub quantity: Quantity,
    /// Length of the mean error of the nominal, registered and calibrated model: A of theory.md §9 (46), metres or radians.
    pub accuracy: [f64; 3],
    /// Mean distance of the errors from their mean, plus three standard deviations: R of theory.md §9 (46), metres or radians, by the
    /// calibrated model.
    pub repeatability: f64,
}

/// Scatter of rows of one configuration, of measurements that judge a calibration.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RepeatScatter {
    /// Number of targets in configurations with three rows or more.
    pub poses: usize,
    /// Number of their rows.
    pub rows: usize,
    /// The compared quantity: that of the first of them.
    pub quantity: Quantity,
    /// The smallest repeatability of a pose (theory.md §9 (46)), millimetres or degrees.
    pub smallest: f64,
    /// The largest repeatability.
    pub largest: f64,
}

/// Scatter of the rows of each configuration by a state of the robot; `None` if nothing was measured three times.
pub(crate) fn repeat_scatter(session: &Session<'_>, data: &Dataset, estimate: &Estimate) -> Option<RepeatScatter> {
    let groups = groups(data);
    let quantity = leading_quantity(data, *groups.first()?.first()?)?;
    let is_own = |rows: &&Vec<u32>| rows.first().and_then(|row| leading_quantity(data, *row)) == Some(quantity);
    let own: Vec<&Vec<u32>> = groups.iter().filter(is_own).collect();
    let all = own.iter().map(|rows| {
        let mut errors = session.errors(rows, estimate);
        turn_to_first(data, rows, estimate, &mut errors);
        quantity.unit().in_shown_unit(scatter(&errors))
    });
    let (smallest, largest) = all.fold((f64::INFINITY, 0.0), |it: (f64, f64), own| (it.0.min(own), it.1.max(own)));
    Some(RepeatScatter { poses: own.len(), rows: own.iter().map(|it| it.len()).sum(), quantity, smallest, largest })
}

/// Every target and configuration with three rows or more, in the order measured: theory.md §9 (46). Readings within 0.0001 rad or 0.1 mm
/// are one configuration; errors are from each row's own prediction, which allows for the difference.
#[must_use]
pub fn repeatability(calibration: &Calibration, data: &Dataset) -> Vec<RepeatedPose> {
    let groups = groups(data);
    if groups.is_empty() {
        return Vec::new();
    }
    let packed = calibration.packed_values(data);
    let session = calibration.session(data, &packed);
    let models = &calibration.models;
    let poses = groups.into_iter().filter_map(|rows| {
        let quantity = leading_quantity(data, *rows.first()?)?;
        let errors = |estimate: &Estimate| {
            let mut errors = session.errors(&rows, estimate);
            turn_to_first(data, &rows, estimate, &mut errors);
            errors
        };
        let accuracy = |estimate| mean(&errors(estimate)).norm();
        let accuracy = [&models.nominal, &models.registered, &models.calibrated].map(accuracy);
        let repeatability = scatter(&errors(&models.calibrated));
        Some(RepeatedPose { rows, quantity, accuracy, repeatability })
    });
    poses.collect()
}

/// Rows of one subject ([`Dataset::subject`]), quantity and configuration (the readings of the group's first row), at least [`ROWS`].
fn groups(data: &Dataset) -> Vec<Vec<u32>> {
    let class = |row: u32| (data.subject(row), leading_quantity(data, row));
    data.group_similar(&data.all_rows(), SAME, ROWS, class)
}

/// The first quantity that a row measured.
fn leading_quantity(data: &Dataset, row: u32) -> Option<Quantity> {
    let channels = data.observations[row as usize].measurement.channels();
    channels.first().map(|channel| channel.quantity)
}

/// The mean of the errors.
fn mean(errors: &[RowError]) -> Vector3<f64> {
    errors.iter().map(RowError::lead).sum::<Vector3<f64>>() / errors.len().max(1) as f64
}

/// Mean distance from the mean, plus three standard deviations of it: R of theory.md §9 (46).
fn scatter(errors: &[RowError]) -> f64 {
    let middle = mean(errors);
    let distances: Vec<f64> = errors.iter().map(|error| (error.lead() - middle).norm()).collect();
    let count = distances.len().max(2) as f64;
    let average = distances.iter().sum::<f64>() / count;
    let squares: f64 = distances.iter().map(|distance| (distance - average).powi(2)).sum();
    average + DEVIATIONS * (squares / (count - 1.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_model::measurement::Measurement;

    #[test]
    fn rows_of_one_configuration_are_found_whatever_their_order() {
        let mut data = Dataset::new(vec!["a".to_owned(), "b".to_owned()]);
        let rows = [
            ([0.0, 1.0], "p"),
            ([0.5, 0.5], "p"),
            ([5e-5, 1.0], "p"),
            ([0.0, 1.0], "q"),
            ([0.0, 1.0], "p"),
            ([2e-4, 1.0], "p"),
        ];
        for (readings, target) in rows {
            let seen = Measurement::point(Vector3::zeros());
            data.push(&readings, Some(target), seen).unwrap();
        }
        assert_eq!(groups(&data), [vec![0, 2, 4]]);
    }

    #[test]
    fn scatter_is_the_mean_distance_and_three_deviations() {
        let at = |x: f64| RowError::of_position(Vector3::new(x, 1.0, 0.0));
        // Distances from the mean 2: 2, 1, 3; their mean is 2, their standard deviation 1.
        assert_eq!(scatter(&[at(0.0), at(1.0), at(5.0)]), 5.0);
        assert_eq!(mean(&[at(0.0), at(1.0), at(5.0)]), Vector3::new(2.0, 1.0, 0.0));
    }
}
