//! Predictions of two robots in the same random configurations.

use nalgebra::{Matrix4, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::{EndConstraint, OffsetOptions};
use crate::robot::Robot;
use crate::simulate::random_configuration;
use poecal_arm::lie::{Pose, rotation};
use poecal_numerics::linalg;

/// Distance and angle between the tips of two robots, over random configurations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TipError {
    /// Root mean square of the distance, metres.
    pub rms_m: f64,
    /// Largest distance, metres.
    pub max_m: f64,
    /// Root mean square of the angle, radians.
    pub rms_rad: f64,
    /// Largest angle, radians.
    pub max_rad: f64,
}

/// Random configurations, with the pose of the actual robot's tip in each.
pub(crate) struct PredictionSample {
    readings: Vec<Vec<f64>>,
    actual: Vec<Pose>,
    tip: EndConstraint,
}

impl PredictionSample {
    pub(crate) fn new(nominal: &Robot, actual: &Robot, options: &OffsetOptions) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(options.seed);
        let readings: Vec<Vec<f64>> =
            (0..options.configurations).map(|_| random_configuration(nominal, &mut generator)).collect();
        let actual = readings.iter().map(|readings| actual.forward_kinematics(readings)).collect();
        PredictionSample { readings, actual, tip: options.tip }
    }

    /// Readings of each configuration with the actual tip.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = (&[f64], &Pose)> {
        self.readings.iter().map(Vec::as_slice).zip(&self.actual)
    }

    /// Best motion of the tip if it is free, and the errors between the tips of `robot`, moved by `base`, and the actual one.
    pub(crate) fn compare(&self, robot: &Robot, base: &Pose) -> (Pose, TipError) {
        let tips: Vec<Pose> = self.readings.iter().map(|readings| *base * robot.forward_kinematics(readings)).collect();
        let tip_motion = match self.tip {
            EndConstraint::Kept => Pose::identity(),
            EndConstraint::Free => mean(tips.iter().zip(&self.actual).map(|(tip, actual)| tip.inverse() * *actual)),
        };
        let (mut squares_m2, mut squares_rad2, mut max_m, mut max_rad) = (0.0, 0.0, 0.0_f64, 0.0_f64);
        for (tip, actual) in tips.iter().zip(&self.actual) {
            let tip = *tip * tip_motion;
            let distance_m = (tip.translation - actual.translation).norm();
            let angle_rad = rotation::log(&(tip.rotation * actual.rotation.transpose())).norm();
            squares_m2 += distance_m * distance_m;
            squares_rad2 += angle_rad * angle_rad;
            max_m = max_m.max(distance_m);
            max_rad = max_rad.max(angle_rad);
        }
        let count = tips.len().max(1) as f64;
        let error =
            TipError { rms_m: (squares_m2 / count).sqrt(), max_m, rms_rad: (squares_rad2 / count).sqrt(), max_rad };
        (tip_motion, error)
    }
}

/// Pose with the least sum of squares of distances and of chords between rotations to all of them (theory.md §8
/// (38c)).
fn mean(poses: impl Iterator<Item = Pose>) -> Pose {
    let (mut sum, mut products, mut count) = (Vector3::zeros(), Matrix4::zeros(), 0.0);
    for pose in poses {
        let quaternion = rotation::to_quaternion_xyzw(&pose.rotation);
        sum += pose.translation;
        products += quaternion * quaternion.transpose();
        count += 1.0;
    }
    if count == 0.0 {
        return Pose::identity();
    }
    let turn = rotation::from_quaternion_xyzw(&linalg::dominant_eigenvector(&products));
    Pose::new(turn, sum / count)
}
