//! A lens that is unknown, and what was found of it.

use poecal_arm::lie::Pose;
use poecal_model::camera::{Lens, LensSearch, LensState, PictureNumber};

/// A lens that is unknown, with the pictures that determine it.
#[derive(Clone, Debug, PartialEq)]
pub struct UnknownLens {
    pub(crate) search: LensSearch,
    pub(crate) state: LensState,
}

/// A lens that was found with the frames.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundLens {
    /// The lens.
    pub lens: Lens,
    /// Its numbers with their standard deviations, and the bend of a flat board, which is found with them.
    pub numbers: Vec<PictureNumber>,
    /// The same by the pictures alone.
    pub alone: Vec<PictureNumber>,
    /// Distance of the camera from the true one that 95 % of such results would not exceed if the lens were known as it was found, metres.
    pub known_bound95_m: f64,
    /// How many times farther than by their noise the lens of the pictures is from that of the arm; 1 where noise explains it.
    pub apart: f64,
}

impl UnknownLens {
    /// Poses of the rows as poses by their corners as they are named, and the turn of a board that was counted from its other end.
    pub(crate) fn chosen(&self, target: &[Pose]) -> Vec<(Pose, Pose)> {
        let pictures = &self.state.pictures;
        let of = |(row, chosen): (usize, &Pose)| {
            let Some(picture) = pictures.all.get(row) else { return (*chosen, Pose::identity()) };
            let half_turn = pictures.boards.get(picture.board).and_then(|board| board.half_turn());
            let turned = half_turn.and_then(|turn| {
                picture.poses.iter().find(|it| **it * turn == *chosen).map(|it| (*it, turn))
            });
            turned.unwrap_or((*chosen, Pose::identity()))
        };
        target.iter().enumerate().map(of).collect()
    }
}
