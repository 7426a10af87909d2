//! Configurations that were measured several times: how well the robot came back, and how far from where a model says.

use nalgebra::Vector3;

use super::{Calibration, RowError, row_errors};
use crate::estimate::{Estimate, Packed};
use crate::measurement::Dataset;

/// Rows of one configuration from which on its scatter is stated; ISO 9283 asks for 30.
const ROWS: usize = 3;
/// Standard deviations that are added to the mean distance, as in ISO 9283.
const DEVIATIONS: f64 = 3.0;

/// One target in one configuration that was measured at least three times (theory.md §9 (44)).
///
/// ```
/// use poecal::calibration::RepeatedPose;
/// let pose = RepeatedPose { rows: vec![0, 1, 2], accuracy_m: [2e-3, 1e-3, 2e-4], repeatability_m: 5e-5 };
/// assert!(pose.repeatability_m < pose.accuracy_m[2]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct RepeatedPose {
    /// Its rows.
    pub rows: Vec<u32>,
    /// Distance from where the nominal, registered and calibrated model say to the mean of the measured positions, metres.
    pub accuracy_m: [f64; 3],
    /// Mean distance of the measured positions from their mean, and three standard deviations of it, metres.
    pub repeatability_m: f64,
}

/// Every configuration and target with three rows or more whose joint readings are equal to the last digit, in the order measured.
///
/// ```
/// use poecal::calibration::{CalibrationOptions, calibrate, repeatability};
/// use poecal::simulate::{Kind, Simulation, elbow};
/// let made = Simulation::default().run(&elbow(), Kind::Point)?;
/// let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// assert!(repeatability(&calibration, &made.data).is_empty());
/// # Ok::<(), poecal::Error>(())
/// ```
#[must_use]
pub fn repeatability(calibration: &Calibration, data: &Dataset) -> Vec<RepeatedPose> {
    let groups = groups(data);
    if groups.is_empty() {
        return Vec::new();
    }
    let packed = Packed::new(&calibration.nominal, data.all_readings(), data.reading_names().len());
    let models = &calibration.models;
    let poses = groups.into_iter().map(|rows| {
        let errors = |estimate: &Estimate| row_errors(data, &packed, &rows, estimate);
        let accuracy = |estimate| mean(&errors(estimate)).norm();
        let accuracy_m = [&models.nominal, &models.registered, &models.calibrated].map(accuracy);
        let repeatability_m = scatter(&errors(&models.calibrated));
        RepeatedPose { rows, accuracy_m, repeatability_m }
    });
    poses.collect()
}

/// Rows of equal readings and target, at least [`ROWS`] each.
fn groups(data: &Dataset) -> Vec<Vec<u32>> {
    let key = |row: u32| data.readings(row as usize).iter().map(|value| value.to_bits());
    let target = |row: u32| data.observations[row as usize].target;
    let mut order = data.all_rows();
    order.sort_by(|&a, &b| target(a).cmp(&target(b)).then_with(|| key(a).cmp(key(b))).then(a.cmp(&b)));
    let same = |a: &u32, b: &u32| target(*a) == target(*b) && key(*a).eq(key(*b));
    let mut groups: Vec<Vec<u32>> =
        order.chunk_by(same).filter(|group| group.len() >= ROWS).map(<[u32]>::to_vec).collect();
    groups.sort_by_key(|group| group.first().copied());
    groups
}

/// The mean of the errors: all of them are seen from the same prediction.
fn mean(errors: &[RowError]) -> Vector3<f64> {
    errors.iter().map(|error| error.position_m).sum::<Vector3<f64>>() / errors.len().max(1) as f64
}

/// Mean distance from the mean, and three standard deviations of that distance.
fn scatter(errors: &[RowError]) -> f64 {
    let middle = mean(errors);
    let distances: Vec<f64> = errors.iter().map(|error| (error.position_m - middle).norm()).collect();
    let count = distances.len().max(2) as f64;
    let average = distances.iter().sum::<f64>() / count;
    let squares: f64 = distances.iter().map(|distance| (distance - average).powi(2)).sum();
    average + DEVIATIONS * (squares / (count - 1.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scatter_is_the_mean_distance_and_three_deviations() {
        let at = |x: f64| RowError { position_m: Vector3::new(x, 1.0, 0.0), rotation_rad: None };
        // Distances from the mean 2: 2, 1, 3; their mean is 2, their standard deviation 1.
        assert_eq!(scatter(&[at(0.0), at(1.0), at(5.0)]), 5.0);
        assert_eq!(mean(&[at(0.0), at(1.0), at(5.0)]), Vector3::new(2.0, 1.0, 0.0));
    }
}
