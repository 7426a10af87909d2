//! Where in the image of a camera a fit predicts pixels well, and where it does not (theory.md §4, *Pictures*).

use nalgebra::{DMatrix, Matrix2x6, Matrix6xX, Vector2, Vector3};

use super::information::FitInformation;
use super::optics::{BestStep, Optics};
use super::robust::RobustFit;
use super::run::Run;
use crate::camera::{Camera, ProjectionMap, middle, motion_by_inverse};
use crate::distributions::median;
use crate::lie::{Pose, hat};
use crate::measurement::Noise;
use crate::start::predicted_pose;

/// Places along the width and the height of the image.
const GRID: [usize; 2] = [9, 7];
/// Most pictures over which the squares are averaged.
const PICTURES: usize = 24;

/// A fitted picture: the pose of its board as the robot predicts it, and how that moves with the unknowns.
struct Seen {
    pose: Pose,
    by_unknowns: Matrix6xX<f64>,
    depth_m: f64,
}

/// What a fit, with the numbers of lenses that it found, says of pixels.
struct Known {
    covariance: DMatrix<f64>,
    numbers: Option<(Optics, BestStep)>,
}

impl Run<'_> {
    /// The map of each camera whose picture has a known size.
    pub(super) fn projection_maps(
        &self,
        ratios: &[Noise],
        fit: &RobustFit,
        optics: Option<&Optics>,
    ) -> Vec<ProjectionMap> {
        let weights = fit.weights();
        let Some(information) = FitInformation::of(self, ratios, (fit, &weights)) else { return Vec::new() };
        let numbers = optics.and_then(|it| Some((it.clone(), it.best_step(self, &information)?)));
        let known = Known { covariance: information.covariance(), numbers };
        let motions = information.of_pictures(self);
        let cameras = self.data.pictures.cameras.iter().enumerate();
        cameras
            .filter_map(|(at, camera)| {
                let seen = self.seen_by(at, (&information, ratios), &motions);
                known.map_of((at, camera), &seen)
            })
            .collect()
    }

    /// Evenly spaced pictures of a camera.
    fn seen_by(
        &self,
        camera: usize,
        (information, ratios): (&FitInformation<'_>, &[Noise]),
        motions: &[(usize, Matrix6xX<f64>)],
    ) -> Vec<Seen> {
        let pictures = &self.data.pictures;
        let own: Vec<&(usize, Matrix6xX<f64>)> =
            motions.iter().filter(|(at, _)| pictures.all[*at].camera == camera).collect();
        let step = own.len().div_ceil(PICTURES).max(1);
        let of = |(at, motion): &&(usize, Matrix6xX<f64>)| {
            let picture = pictures.all.get(*at)?;
            let error = self.session(ratios).errors(&[picture.row], information.estimate).pop()?;
            let measured = self.data.observations.get(picture.row as usize)?.measurement.pose();
            let pose = picture.directed(&predicted_pose(&measured, &error));
            let by_unknowns =
                if picture.of_camera { motion_by_inverse(&pose) * motion } else { motion.clone() };
            let depth_m = pose.act(&middle(&pictures.boards.get(picture.board)?.points)).z;
            Some(Seen { pose, by_unknowns, depth_m })
        };
        own.iter().step_by(step).filter_map(of).collect()
    }
}

impl Known {
    fn map_of(&self, (at, camera): (usize, &Camera), seen: &[Seen]) -> Option<ProjectionMap> {
        let size = camera.lens.size_px?;
        let distance_m = median(seen.iter().map(|it| it.depth_m)).filter(|it| *it > 0.0)?;
        let [columns, rows] = GRID;
        let place = |k: usize, count: usize, size: u32| k as f64 / (count - 1) as f64 * f64::from(size - 1);
        let of = |k: usize| {
            let pixel = Vector2::new(place(k % columns, columns, size[0]), place(k / columns, rows, size[1]));
            let ray = camera.lens.ray(&pixel)?;
            self.off_px((at, camera), &(ray * (distance_m / ray.z)), seen)
        };
        let off_px = (0..columns * rows).map(of).collect();
        Some(ProjectionMap { camera: at, distance_m, size: GRID, off_px })
    }

    /// Root mean square distance of the pixel in which a point would be predicted from where it is, by the covariance of all that was found.
    fn off_px(&self, (at, camera): (usize, &Camera), point: &Vector3<f64>, seen: &[Seen]) -> Option<f64> {
        let found = camera.lens.projection(point)?;
        let mut squares = 0.0;
        for Seen { pose, by_unknowns, .. } in seen {
            let mut by_pose = Matrix2x6::zeros();
            by_pose.fixed_view_mut::<2, 3>(0, 0).copy_from(&found.by_point);
            by_pose
                .fixed_view_mut::<2, 3>(0, 3)
                .copy_from(&(found.by_point * hat(&(point - pose.translation)) * -1.0));
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
