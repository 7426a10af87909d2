//! Cameras: lenses, boards of known points, and the poses of boards that fit pictures.
//!
//! `sighting.rs` estimates the pose of a board that fits its corners, with its information; `pnp.rs` and `poses.rs` find all possible poses of a
//! board, without a guess. `common.rs` has the shared error of the corners of one picture. Robots and rows of a session are not here: a picture
//! becomes one row (`measurement/pictures.rs`), a pose whose noise has the shape of its corners.

mod board;
mod common;
mod guess;
mod lens;
mod patterns;
mod picture;
mod pictures;
mod pnp;
mod poses;
mod region;
mod search;
mod shape;
mod sighting;
mod stored;
mod unknown;
mod views;

pub use board::{Board, dimensions, middle, normal};
pub use common::{Centre, CommonError, motion_by_inverse};
pub use guess::{FlatView, guessed_lens};
pub use lens::{Distortion, LENS_NAMES, LENS_NUMBERS, Lens, Projection};
pub use picture::{Camera, Corner, Picture};
pub use pictures::Pictures;
pub use pnp::poses_of_rays;
pub use region::{KEYS as REGION_KEYS, Region};
pub use search::{LensSearch, LensState};
pub use shape::is_flat_sheet;
pub use sighting::{Sighting, View, moved};
pub use stored::{BoardEntry, CameraEntry, LARGEST_SIDE, PointEntry, size_of_pictures};
pub use unknown::{
    OTHER_LENS, OwnInformation, PictureNumber, PictureUnknown, PictureUnknowns, changed_numbers,
};
pub use views::Views;
