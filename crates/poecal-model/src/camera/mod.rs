//! Cameras: lenses, boards of known points, and the poses from which these look as they were seen.
//!
//! `sighting.rs` finds the pose of a board that has its corners where they were seen, with what they determine of it; `pnp.rs` and `poses.rs` find all
//! poses that a board may have, without a guess; `common.rs` has what the corners of one picture share. No robots, and no rows of a session: a picture
//! becomes one row (`measurement/pictures.rs`), a pose with noise of the shape that its corners have.

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
