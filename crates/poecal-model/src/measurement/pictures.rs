//! Pictures among the rows of a session.

use std::borrow::Cow;

use nalgebra::{Matrix6, Vector6};

use super::{Dataset, Measurement, Noise, NoiseShape, Observation, Quantity, RowLocation, Set};
use crate::camera::{Centre, CommonError, Picture, Sighting, motion_by_inverse};
use poecal_arm::lie::{Pose, rotation};
use poecal_numerics::distributions::median;
use poecal_numerics::error::Result;
use poecal_numerics::linalg;

/// Smallest standard deviation of a corner, pixels: below it is rounding.
const FINEST_PX: f64 = 1e-3;
/// Factor of the others' residuals beyond which the corners of a picture do not count in the noise.
const ODD: f64 = 3.0;

impl Dataset {
    /// Adds a picture as a row: of its board as the target, measured by its camera.
    ///
    /// # Errors
    /// As [`Dataset::push`]. The inner result is a message if no pose of the board fits its corners; then nothing is added.
    pub fn push_picture(
        &mut self,
        readings: &[f64],
        picture: Picture,
        (set, source): (Option<Set>, RowLocation),
    ) -> Result<std::result::Result<(), String>> {
        let row = u32::try_from(self.len()).unwrap_or(u32::MAX);
        let mut picture = Picture { row, ..picture };
        let names = self.pictures.cameras.get(picture.camera).zip(self.pictures.boards.get(picture.board));
        let Some((camera, board)) = names.map(|(camera, board)| (camera.name.clone(), board.name.clone())) else {
            return Ok(Err("no camera or board".to_owned()));
        };
        match self.pictures.view(&picture).map(|view| view.poses()) {
            Some(Ok(poses)) => picture.poses = poses,
            Some(Err(reason)) => return Ok(Err(reason)),
            None => return Ok(Err("no camera or board".to_owned())),
        }
        if self.is_empty() && self.stations.is_empty() {
            self.stations.push(Some(camera.clone()));
        }
        let (target, station) = (self.target_index(Some(&board)), self.station_index(Some(&camera)));
        let first = picture.poses.first().copied().unwrap_or_else(Pose::identity);
        let measurement = Measurement::of_pose(&first);
        let observation = Observation { station, set, source, ..Observation::new(target, measurement) };
        self.push_observation(readings, observation)?;
        self.pictures.all.push(picture);
        Ok(Ok(()))
    }

    /// Estimates the noise of corners that state none, by the residuals of the poses of their pictures. It makes each picture the row of
    /// its pose.
    pub fn settle_pixels(&mut self) {
        let data = self;
        if data.pictures.is_empty() {
            return;
        }
        let count = data.pictures.all.len();
        let found: Vec<Sighting> = (0..count).filter_map(|at| data.sighting(at)).collect();
        if let Some(sigma_px) = data.corner_noise(&found, 0.0) {
            data.pictures.sigma_px = sigma_px;
        }
        data.state_pictures();
    }

    /// The data with the shared error of a picture's corners from another session.
    pub fn with_common(&self, common: CommonError) -> Cow<'_, Self> {
        if self.pictures.is_empty() || self.pictures.common == common {
            return Cow::Borrowed(self);
        }
        let mut data = self.clone();
        data.pictures.common = common;
        data.state_pictures();
        Cow::Owned(data)
    }

    /// Sighting of a picture at the pose of its row.
    fn sighting(&self, at: usize) -> Option<Sighting> {
        let picture = self.pictures.all.get(at)?;
        let measured = self.observations.get(picture.row as usize)?.measurement.pose();
        self.pictures.view(picture)?.sighting(&picture.directed_measurement(&measured), true)
    }

    fn state_pictures(&mut self) {
        for at in 0..self.pictures.all.len() {
            if let Some(sighting) = self.sighting(at) {
                self.state_picture(at, &sighting);
            }
        }
    }

    /// Noise of corners that state none, pixels, by the residuals of sightings of which a fit used `unknowns` degrees of freedom; `None` if
    /// all state it.
    pub fn corner_noise(&self, sightings: &[Sighting], unknowns: f64) -> Option<f64> {
        let mut corners = self.pictures.all.iter().flat_map(|it| &it.corners);
        if corners.all(|corner| corner.sigma_px.is_some()) {
            return None;
        }
        let found = sightings.iter().filter(|it| it.freedom > 1.0).map(|it| (it.cost_px2, it.freedom));
        let found: Vec<(f64, f64)> = found.collect();
        let usual = median(found.iter().map(|(cost, freedom)| cost / freedom)).unwrap_or(0.0);
        let usual_ones = found.iter().filter(|(cost, freedom)| cost / freedom <= ODD * ODD * usual);
        let (cost, freedom) = usual_ones.fold((0.0, 0.0), |sum, it| (sum.0 + it.0, sum.1 + it.1));
        // At least half of the degrees of freedom are left.
        let left = (freedom - unknowns).max(0.5 * freedom);
        (left > 0.0).then(|| (cost / left).sqrt().max(FINEST_PX))
    }

    /// Whitening of the row of a picture, as it is stated.
    pub fn whitening_of_picture(&self, row: u32) -> Option<Matrix6<f64>> {
        let observation = self.observations.get(row as usize)?;
        let own = observation.noise_or(Noise::new(1.0, 1.0));
        let shape = self.noise_shape(observation)?;
        Some(shape.whitening([own[Quantity::Position], own[Quantity::Rotation]]))
    }

    /// Makes the row of a picture the pose of a sighting, with its noise.
    pub fn state_picture(&mut self, at: usize, sighting: &Sighting) {
        let Some(picture) = self.pictures.all.get_mut(at) else { return };
        let pose = picture.directed_measurement(&sighting.camera_from_board);
        picture.corners.iter_mut().zip(&sighting.weights).for_each(|(corner, weight)| corner.weight = *weight);
        let row = picture.row as usize;
        let seen = (&sighting.camera_from_board, sighting.information);
        let whitening = picture_whitening(self.pictures.common, seen, picture.of_camera);
        let sigmas = spread(&whitening);
        let shape = NoiseShape::of_pose(&whitening, sigmas);
        let [shift_m, turn_rad] = sigmas;
        let Some(observation) = self.observations.get_mut(row) else { return };
        observation.measurement = Measurement::of_pose(&pose);
        observation.stated.set(Quantity::Position, Some(shift_m));
        observation.stated.set(Quantity::Rotation, Some(turn_rad));
        match observation.noise_shape.and_then(|own| self.noise_shapes.get_mut(own as usize)) {
            Some(own) => *own = shape,
            None => {
                observation.noise_shape = u32::try_from(self.noise_shapes.len()).ok();
                self.noise_shapes.push(shape);
            }
        }
    }
}

/// Whitening of the row of a picture: by the pose of its board in the camera's frame with its information, and by the shared error of the
/// corners.
#[must_use]
pub fn picture_whitening(
    common: CommonError,
    (camera_from_board, information): (&Pose, Matrix6<f64>),
    of_camera: bool,
) -> Matrix6<f64> {
    let about = SightingAbout::new((camera_from_board, information), common.about);
    common.whitening(&about.information, camera_from_board.translation.norm()) * about.from_row(of_camera)
}

/// A sighting as motions about a centre: of the board in the camera's frame, or of the camera in the board's.
pub struct SightingAbout {
    /// Information of the corners on these motions.
    pub information: Matrix6<f64>,
    centre: Centre,
    camera_from_board: Pose,
}

impl SightingAbout {
    /// Sighting about one of the two.
    #[must_use]
    pub fn new((camera_from_board, information): (&Pose, Matrix6<f64>), centre: Centre) -> Self {
        let camera_from_board = *camera_from_board;
        let information = match centre {
            Centre::Board => information,
            Centre::Camera => {
                let back = motion_by_inverse(&camera_from_board);
                back.transpose() * information * back
            }
        };
        SightingAbout { information, centre, camera_from_board }
    }

    /// Motions about the centre by those of a row: of the board in the camera's frame, or, `of_camera`, of the camera in the board's.
    #[must_use]
    pub fn from_row(&self, of_camera: bool) -> Matrix6<f64> {
        match (self.centre, of_camera) {
            (Centre::Board, false) | (Centre::Camera, true) => Matrix6::identity(),
            (Centre::Board, true) => motion_by_inverse(&self.camera_from_board),
            (Centre::Camera, false) => motion_by_inverse(&self.camera_from_board.inverse()),
        }
    }
}

/// Standard deviations of the components of a pose by its whitening, `√(tr Σ/3)` of its shift (m) and of its turn (rad).
fn spread(whitening: &Matrix6<f64>) -> [f64; 2] {
    // Metres and radians are scaled to equal information.
    let size = |first: usize| whitening.fixed_columns::<3>(first).norm().max(f64::MIN_POSITIVE);
    let length_m = size(3) / size(0);
    let mut information = whitening.transpose() * whitening;
    information.fixed_rows_mut::<3>(3).scale_mut(1.0 / length_m);
    information.fixed_columns_mut::<3>(3).scale_mut(1.0 / length_m);
    match linalg::cholesky_6(information) {
        Some(factor) => {
            let covariance = factor.inverse();
            let mean = |first: usize| (first..first + 3).map(|k| covariance[(k, k)]).sum::<f64>() / 3.0;
            [mean(0).sqrt(), mean(3).sqrt() / length_m]
        }
        None => [0, 3].map(|first| 3f64.sqrt() / size(first)),
    }
}

/// Deviation of a measured pose from a predicted one: shift, and turn about its origin, in the axes of their common parent (theory.md §4
/// (16)).
#[must_use]
pub fn deviation(measured: &Pose, predicted: &Pose) -> Vector6<f64> {
    let shift = measured.translation - predicted.translation;
    let turn = rotation::log(&(measured.rotation * predicted.rotation.transpose()));
    Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
}
