//! Accuracy of a fit's predicted pixels over the image of a camera (theory.md §4, *Pictures*).

use nalgebra::{DMatrix, Matrix2x6, Matrix6xX, Vector3};

use super::optics::{BestStep, Optics};
use crate::run::CalibrationRun;
use crate::run::pixels::predicted_picture;
use crate::steps::calibrated_fit::CalibratedFit;
use crate::trust::information::FitInformation;
use poecal_arm::lie::{Pose, hat};
use poecal_model::camera::{Camera, middle, motion_by_inverse};
use poecal_model::measurement::Noise;
use poecal_numerics::distributions::median;

/// Most pictures over which the squares are averaged.
const PICTURES: usize = 24;

/// A fitted picture: the pose of its board predicted by the robot, and its derivative by the unknowns.
struct FittedPicture {
    pose: Pose,
    by_unknowns: Matrix6xX<f64>,
    depth_m: f64,
}

/// Uncertainty of predicted pixels by a fit.
pub(crate) struct PixelPrediction {
    covariance: DMatrix<f64>,
    numbers: Option<(Optics, BestStep)>,
    /// Fitted pictures of each camera.
    seen: Vec<Vec<FittedPicture>>,
}

impl PixelPrediction {
    pub(crate) fn from_fit(fit: &CalibratedFit<'_>) -> Option<Self> {
        let CalibratedFit { run, robust, noise_ratios, optics, .. } = fit;
        let weights = robust.weights();
        let information = FitInformation::from_fit(run, noise_ratios, (robust, &weights))?;
        let numbers = optics.as_ref().and_then(|it| Some((it.clone(), it.best_step(run, &information)?)));
        let motions = information.of_pictures(run);
        let cameras = 0..run.data.pictures.cameras.len();
        let seen = cameras.map(|at| run.seen_by(at, (&information, noise_ratios), &motions)).collect();
        Some(PixelPrediction { covariance: information.covariance(), numbers, seen })
    }

    /// Median depth of the boards before a camera, metres; `None` without pictures.
    pub(crate) fn distance_m(&self, camera: usize) -> Option<f64> {
        median(self.seen.get(camera)?.iter().map(|it| it.depth_m)).filter(|it| *it > 0.0)
    }

    /// Root mean square error of the predicted pixel of a point before a camera, by the covariance of all fitted unknowns; `None` beyond the lens.
    pub(crate) fn off_px(&self, (at, camera): (usize, &Camera), point: &Vector3<f64>) -> Option<f64> {
        let found = camera.lens.projection(point)?;
        let seen = self.seen.get(at)?;
        let mut squares = 0.0;
        for FittedPicture { pose, by_unknowns, .. } in seen {
            let mut by_pose = Matrix2x6::zeros();
            by_pose.fixed_view_mut::<2, 3>(0, 0).copy_from(&found.by_point);
            by_pose.fixed_view_mut::<2, 3>(0, 3).copy_from(&(found.by_point * hat(&(point - pose.translation)) * -1.0));
            let by_robot = by_pose * by_unknowns;
            squares += (&by_robot * &self.covariance * by_robot.transpose()).trace();
            if let Some((optics, best)) = &self.numbers {
                let by_numbers = optics.by_lens(at, &found) - &by_robot * &best.follow;
                squares += (&by_numbers * &best.covariance * by_numbers.transpose()).trace();
            }
        }
        (!seen.is_empty()).then(|| (squares.max(0.0) / seen.len() as f64).sqrt())
    }
}

impl CalibrationRun<'_> {
    /// Evenly spaced pictures of a camera.
    fn seen_by(
        &self,
        camera: usize,
        (information, ratios): (&FitInformation<'_>, &[Noise]),
        motions: &[(usize, Matrix6xX<f64>)],
    ) -> Vec<FittedPicture> {
        let pictures = &self.data.pictures;
        let own: Vec<&(usize, Matrix6xX<f64>)> =
            motions.iter().filter(|(at, _)| pictures.all[*at].camera == camera).collect();
        let step = own.len().div_ceil(PICTURES).max(1);
        let of = |(at, motion): &&(usize, Matrix6xX<f64>)| {
            let row = pictures.all.get(*at)?.row;
            let error = self.session(ratios).errors(&[row], information.estimate).pop()?;
            let (picture, pose) = predicted_picture(&self.data, row, &error)?;
            let by_unknowns = if picture.of_camera { motion_by_inverse(&pose) * motion } else { motion.clone() };
            let depth_m = pose.act(&middle(&pictures.boards.get(picture.board)?.points)).z;
            Some(FittedPicture { pose, by_unknowns, depth_m })
        };
        own.iter().step_by(step).filter_map(of).collect()
    }
}
