//! An unknown lens, and its estimate.

use poecal_arm::lie::Pose;
use poecal_model::camera::{Lens, LensSearch, LensState, PictureNumber};

/// An unknown lens, with the pictures that determine it.
#[derive(Clone, Debug, PartialEq)]
pub struct UnknownLens {
    pub(crate) search: LensSearch,
    pub(crate) state: LensState,
}

/// A lens that was estimated with the frames.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundLens {
    /// Lens.
    pub lens: Lens,
    /// Numbers with their standard deviations, and the bend of a flat board, which is estimated with them.
    pub numbers: Vec<PictureNumber>,
    /// The same numbers by the pictures alone.
    pub alone: Vec<PictureNumber>,
    /// Distance of the camera from the true one that 95 % of such results would not exceed if the estimated lens were exact, metres.
    pub known_bound95_m: f64,
    /// Difference of the lens of the pictures from that of the arm, in units of its noise; 1 if noise explains it.
    pub apart: f64,
}

impl UnknownLens {
    /// Poses of the rows by their corners as these are numbered, and the turn of a board that was counted from its other end.
    pub(crate) fn choose_poses(&self, target: &[Pose]) -> Vec<(Pose, Pose)> {
        let pictures = &self.state.pictures;
        let of = |(row, chosen): (usize, &Pose)| {
            let Some(picture) = pictures.all.get(row) else { return (*chosen, Pose::identity()) };
            let half_turn = pictures.boards.get(picture.board).and_then(|board| board.half_turn());
            let turned =
                half_turn.and_then(|turn| picture.poses.iter().find(|it| **it * turn == *chosen).map(|it| (*it, turn)));
            turned.unwrap_or((*chosen, Pose::identity()))
        };
        target.iter().enumerate().map(of).collect()
    }
}
