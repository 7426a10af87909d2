//! An unknown lens from pictures whose poses are free (theory.md §4, *Pictures*).
//!
//! The bend of a flat board is estimated with the lens. Otherwise a bend of a few tenths of a millimetre, that of paper on cardboard, would be
//! taken for a change of the focal length by a percent. That is many times its standard deviation by the noise of corners.

use nalgebra::{DMatrix, DVector, Matrix6xX};

use super::{
    Board, Lens, Picture, PictureInformation, PictureNumber, PictureUnknown, PictureUnknowns, Pictures, SightingInput,
    is_flat_sheet,
};
use poecal_arm::lie::Pose;
use poecal_numerics::linalg;

/// Largest number of steps to the lens of pictures alone.
const STEPS: usize = 60;
/// Largest step of a number, standard deviations of its prior.
const FARTHEST: f64 = 2.0;
/// Least gain of a step, squared standard deviations.
const LEAST: f64 = 1e-9;
/// Number of standard deviations by which pictures must differ more than by the noise of their corners.
const SPREAD: f64 = 4.0;

/// Search for the lens of the one camera of some pictures, by their corners with free poses of the pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct LensSearch {
    unknowns: PictureUnknowns,
    count: usize,
    /// Numbers that stay as they are: the scales of the board, which the pictures do not determine.
    held: Vec<usize>,
    /// Factor by which the shared error of a picture's corners reduces their information on the numbers.
    shared: f64,
}

/// Pictures with a lens, and their information on another one.
#[derive(Clone, Debug, PartialEq)]
pub struct LensState {
    /// The pictures with this lens, with the weights of their corners and the noise of them.
    pub pictures: Pictures,
    /// Pose of the board in the camera's frame in each picture.
    pub poses: Vec<Pose>,
    /// Derivatives of each of these poses (m, rad, in the camera's axes) by each number, in standard deviations of its prior.
    pub follow: Vec<Matrix6xX<f64>>,
    /// The numbers, in standard deviations of their prior from the first guess.
    pub step: DVector<f64>,
    /// Information of the numbers in these deviations, with the prior.
    pub information: DMatrix<f64>,
    /// Gradient.
    pub pull: DVector<f64>,
    /// Degrees of freedom of the corners' noise.
    pub freedom: f64,
    /// Variance ratio of the pictures' information on the numbers: observed over that by independent noise of the corners.
    pub spread: f64,
}

impl LensSearch {
    /// Search for the camera of pictures, whose lens is a first guess; with its state. `None` if there is no such camera.
    #[must_use]
    pub fn from_pictures(pictures: &Pictures) -> Option<(Self, LensState)> {
        let first = pictures.all.first()?;
        let lens = PictureUnknown::Lens(first.camera);
        let is_sheet = pictures.boards.get(first.board).is_some_and(is_flat_sheet);
        let of = |parts: &[PictureUnknown]| PictureUnknowns::new(&pictures.cameras, &pictures.boards, parts);
        let lens_alone = of(&[lens]).count();
        let unknowns = if is_sheet { of(&[lens, PictureUnknown::Board(first.board)]) } else { of(&[lens]) };
        let count = unknowns.count();
        let held = if is_sheet { vec![lens_alone, lens_alone + 1] } else { Vec::new() };
        let poses = pictures.all.iter().map(|it| it.poses.first().copied()).collect::<Option<Vec<Pose>>>()?;
        let search = LensSearch { unknowns, count, held, shared: 1.0 };
        let state = search.state_at(pictures, &poses, DVector::zeros(count));
        (count > 0).then_some((search, state))
    }

    /// State after a step of the numbers; each pose is the best one near that of this state, or near another one of `poses`.
    #[must_use]
    pub fn step_by(&self, from: &LensState, poses: &[Pose], by: &DVector<f64>) -> LensState {
        let by = by * (FARTHEST / by.amax().max(FARTHEST));
        self.state_at(&from.pictures, poses, &from.step + by)
    }

    /// The search with the information of the pictures reduced by their variance ratio at a state. The shared error of a picture's corners, by a
    /// board or a lens of another shape than is fitted, counts once in each picture.
    #[must_use]
    pub fn with_spread_of(&self, state: &LensState) -> Self {
        LensSearch { shared: (self.shared * state.spread).max(1.0), ..self.clone() }
    }

    /// Lens that the pictures determine by themselves; `None` if they do not.
    #[must_use]
    pub fn lens_alone(&self, start: &LensState) -> Option<LensState> {
        let mut state = start.clone();
        for _ in 0..STEPS {
            let by = linalg::solve_symmetric(state.information.clone(), &state.pull)?;
            if by.dot(&state.pull) < LEAST {
                break;
            }
            state = self.step_by(&state, &state.poses, &by);
        }
        state.step.iter().all(|it| it.is_finite()).then_some(state)
    }

    /// Numbers of the lens of a state, with these standard deviations in units of those of the prior.
    #[must_use]
    pub fn numbers(&self, state: &LensState, deviations: &[f64]) -> Vec<PictureNumber> {
        self.unknowns.numbers(&state.step, deviations)
    }

    fn state_at(&self, before: &Pictures, poses: &[Pose], step: DVector<f64>) -> LensState {
        let mut pictures = before.clone();
        // The boards stay flat: for a flat one the second pose is known.
        let (cameras, bent) = self.unknowns.apply_step(&step);
        pictures.cameras = cameras;
        let sightings: Vec<_> = (pictures.all.iter().zip(poses))
            .map(|(picture, pose)| view(&pictures, &bent, picture)?.sighting(pose, true))
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
        // Corners with a stated noise are never better than that.
        let states = pictures.all.iter().flat_map(|it| &it.corners).all(|corner| corner.sigma_px.is_some());
        let excess = squares / freedom;
        let excess = if states { excess.max(1.0) } else { excess.max(1e-6) };
        let mut own = PictureInformation::zero(self.count);
        let mut squared = DMatrix::zeros(self.count, self.count);
        let mut follow = Vec::with_capacity(found.len());
        for (picture, pose) in pictures.all.iter().zip(&found) {
            let before = own.pull.clone();
            let added = view(&pictures, &bent, picture).map(|view| {
                let information = view.information(pose);
                self.unknowns.add((picture.camera, picture.board), &view, (pose, &information), &mut own)
            });
            let mut added = added.unwrap_or_else(|| Matrix6xX::zeros(self.count));
            self.held.iter().for_each(|&at| added.column_mut(at).fill(0.0));
            follow.push(added);
            let mut pull = &own.pull - before;
            self.held.iter().for_each(|&at| pull[at] = 0.0);
            squared += &pull * pull.transpose();
        }
        for &at in &self.held {
            own.gram.row_mut(at).fill(0.0);
            own.gram.column_mut(at).fill(0.0);
            own.pull[at] = 0.0;
        }
        let by = excess * self.shared;
        let information = &own.gram / by + DMatrix::identity(self.count, self.count);
        let spread = spread(&information, &(squared / (by * by)), &(own.gram / by), found.len());
        let pull = own.pull / by - &step;
        if !states {
            pictures.sigma_px *= excess.sqrt();
        }
        LensState { pictures, poses: found, follow, step, information, pull, freedom, spread }
    }
}

/// A picture with bent boards.
fn view<'a>(pictures: &'a Pictures, bent: &'a [Board], picture: &'a Picture) -> Option<SightingInput<'a>> {
    let lens = &pictures.cameras.get(picture.camera)?.lens;
    Some(SightingInput::new(picture, lens, bent.get(picture.board)?, pictures.sigma_px))
}

/// Ratio of the squared gradients of pictures to their expectation by the information; 1 if it exceeds 1 by no more than chance.
fn spread(information: &DMatrix<f64>, squared: &DMatrix<f64>, expected: &DMatrix<f64>, pictures: usize) -> f64 {
    let count = information.nrows();
    let Some(factor) = linalg::cholesky(information.as_slice(), count, 0.0) else { return 1.0 };
    let inverse = DMatrix::from_row_slice(count, count, &linalg::inverse(&factor));
    // Numbers that the prior determines do not count. At the best lens the gradients of all pictures cancel.
    let determined = (&inverse * expected).trace();
    let rows = pictures as f64;
    let ratio = (inverse * squared).trace() / determined * rows / (rows - 1.0).max(1.0);
    let chance = SPREAD * (2.0 / (rows * determined)).sqrt();
    if determined > 1.0 && ratio > 1.0 + chance { ratio } else { 1.0 }
}

impl LensState {
    /// The lens.
    #[must_use]
    pub fn lens(&self) -> Option<Lens> {
        let camera = self.pictures.all.first()?.camera;
        self.pictures.cameras.get(camera).map(|it| it.lens)
    }
}
