//! An unknown lens from pictures whose poses are free (theory.md §4, *Pictures*).

use nalgebra::{DMatrix, DVector, Matrix6xX};

use super::{Lens, OwnInformation, Picture, PictureNumber, PictureUnknown, PictureUnknowns, Pictures};
use poecal_arm::lie::Pose;
use poecal_numerics::linalg;

/// Most steps to the lens of pictures alone.
const STEPS: usize = 60;
/// Largest step of a number, standard deviations of its prior.
const FARTHEST: f64 = 2.0;
/// Squared standard deviations by which a step must be worth it.
const LEAST: f64 = 1e-9;

/// The search for the lens of the one camera of some pictures: what the corners say of it where the poses of the pictures are free.
#[derive(Clone, Debug, PartialEq)]
pub struct LensSearch {
    unknowns: PictureUnknowns,
    count: usize,
}

/// Pictures with a lens, and what they say of another one.
#[derive(Clone, Debug, PartialEq)]
pub struct LensState {
    /// The pictures with this lens, with the weights of their corners and the noise of them.
    pub pictures: Pictures,
    /// The pose of the board in the camera's frame in each picture.
    pub poses: Vec<Pose>,
    /// How each of these poses moves (m, rad, in the camera's axes) by a standard deviation of the prior of each number.
    pub follow: Vec<Matrix6xX<f64>>,
    /// The numbers, in standard deviations of their prior from the first guess.
    pub step: DVector<f64>,
    /// Information of the numbers in these deviations, with the prior.
    pub information: DMatrix<f64>,
    /// Its pull.
    pub pull: DVector<f64>,
    /// Degrees of freedom of the corners' noise.
    pub freedom: f64,
}

impl LensSearch {
    /// Of the camera of pictures, whose lens is a first guess; with the state there. `None` if there is no such camera.
    #[must_use]
    pub fn of(pictures: &Pictures) -> Option<(Self, LensState)> {
        let first = pictures.all.first()?;
        let unknowns =
            PictureUnknowns::new(&pictures.cameras, &pictures.boards, &[PictureUnknown::Lens(first.camera)]);
        let count = unknowns.count();
        let poses = pictures.all.iter().map(|it| it.poses.first().copied()).collect::<Option<Vec<Pose>>>()?;
        let search = LensSearch { unknowns, count };
        let state = search.at(pictures, &poses, DVector::zeros(count));
        (count > 0).then_some((search, state))
    }

    /// The state after a step of the numbers; each pose is the best one near that of this state, or near another one that is given.
    #[must_use]
    pub fn stepped(&self, from: &LensState, poses: &[Pose], by: &DVector<f64>) -> LensState {
        let by = by * (FARTHEST / by.amax().max(FARTHEST));
        self.at(&from.pictures, poses, &from.step + by)
    }

    /// The lens that the pictures determine by themselves. `None` where they do not.
    #[must_use]
    pub fn alone(&self, start: &LensState) -> Option<LensState> {
        let mut state = start.clone();
        for _ in 0..STEPS {
            let by = linalg::solved(state.information.clone(), &state.pull)?;
            if by.dot(&state.pull) < LEAST {
                break;
            }
            state = self.stepped(&state, &state.poses, &by);
        }
        state.step.iter().all(|it| it.is_finite()).then_some(state)
    }

    /// The numbers of the lens of a state, with these standard deviations in those of the prior.
    #[must_use]
    pub fn numbers(&self, state: &LensState, deviations: &[f64]) -> Vec<PictureNumber> {
        self.unknowns.numbers(&state.step, deviations)
    }

    fn at(&self, before: &Pictures, poses: &[Pose], step: DVector<f64>) -> LensState {
        let mut pictures = before.clone();
        pictures.cameras = self.unknowns.at(&step).0;
        let sightings: Vec<_> = (pictures.all.iter().zip(poses))
            .map(|(picture, pose)| pictures.view(picture)?.sighting(pose, true))
            .collect();
        let (mut squares, mut freedom) = (0.0, -(self.count as f64));
        let mut found = Vec::with_capacity(poses.len());
        for ((picture, sighting), pose) in pictures.all.iter_mut().zip(&sightings).zip(poses) {
            found.push(sighting.as_ref().map_or(*pose, |it| it.camera_from_board));
            let Some(sighting) = sighting else { continue };
            (squares, freedom) = (squares + sighting.cost, freedom + sighting.freedom);
            picture.corners.iter_mut().zip(&sighting.weights).for_each(|(corner, weight)| corner.weight = *weight);
        }
        let freedom = freedom.max(1.0);
        // Corners that state their noise are never better than that.
        let states = pictures.all.iter().flat_map(|it| &it.corners).all(|corner| corner.sigma_px.is_some());
        let excess = squares / freedom;
        let excess = if states { excess.max(1.0) } else { excess.max(1e-6) };
        let mut own = OwnInformation::none(self.count);
        let follow = (pictures.all.iter().zip(&found))
            .map(|(picture, pose)| self.added(&pictures, picture, pose, &mut own))
            .collect();
        let information = own.gram / excess + DMatrix::identity(self.count, self.count);
        let pull = own.pull / excess - &step;
        if !states {
            pictures.sigma_px *= excess.sqrt();
        }
        LensState { pictures, poses: found, follow, step, information, pull, freedom }
    }

    /// Adds what a picture says; returns how its pose follows.
    fn added(&self, pictures: &Pictures, picture: &Picture, pose: &Pose, own: &mut OwnInformation) -> Matrix6xX<f64> {
        let Some(view) = pictures.view(picture) else { return Matrix6xX::zeros(self.count) };
        let information = view.information(pose);
        self.unknowns.add((picture.camera, picture.board), &view, (pose, &information), own)
    }
}

impl LensState {
    /// The lens.
    #[must_use]
    pub fn lens(&self) -> Option<Lens> {
        let camera = self.pictures.all.first()?.camera;
        self.pictures.cameras.get(camera).map(|it| it.lens)
    }
}
