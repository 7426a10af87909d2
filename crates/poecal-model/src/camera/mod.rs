//! Cameras: lenses, boards of known points, and the poses of boards that fit pictures.
//!
//! `sighting.rs` estimates the pose of a board that fits its corners, with its information; `pnp.rs` and `poses.rs` find all possible poses of a
//! board, without a guess. `common.rs` has the shared error of the corners of one picture. Robots and rows of a session are not here: a picture
//! becomes one row (`measurement/pictures.rs`), a pose whose noise has the shape of its corners.

mod board;
mod camera_entries;
mod common;
mod guess;
mod lens;
mod patterns;
mod picture;
mod picture_unknowns;
mod pictures;
mod pnp;
mod poses;
mod region;
mod search;
mod shape;
mod sighting;
mod views;

pub use board::{Board, dimensions, middle, normal};
pub use camera_entries::{BoardEntry, CameraEntry, LARGEST_SIDE, PointEntry, size_of_pictures};
pub use common::{Centre, CommonError, motion_by_inverse};
pub use guess::{FlatView, guessed_lens};
pub use lens::{Distortion, LENS_NAMES, LENS_NUMBERS, Lens, Projection};
pub use picture::{Camera, Corner, Picture};
pub use picture_unknowns::{
    OTHER_LENS, PictureInformation, PictureNumber, PictureUnknown, PictureUnknowns, changed_numbers,
};
pub use pictures::Pictures;
pub use pnp::poses_of_rays;
pub use region::{KEYS as REGION_KEYS, Region};
pub use search::{LensSearch, LensState};
pub use shape::is_flat_sheet;
pub use sighting::{Sighting, SightingInput, move_pose};
pub use views::CameraViews;
