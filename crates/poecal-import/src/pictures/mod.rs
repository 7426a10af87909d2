//! Pictures and corners as rows, cameras and boards of files.
//!
//! `corner_columns.rs` finds the columns of corners, `keyed_values.rs` the values of a file of cameras or boards by their keys. `board_files.rs` converts
//! boards of other programs into words.

pub(crate) mod append_row;
pub(crate) mod board_files;
pub(crate) mod board_words;
pub(crate) mod boards;
pub(crate) mod camera_tables;
pub(crate) mod camera_trees;
pub(crate) mod cameras;
pub(crate) mod corner_columns;
pub(crate) mod corner_names;
pub(crate) mod gathering;
pub(crate) mod halcon;
pub(crate) mod keyed_values;
pub(crate) mod lens_checks;
pub(crate) mod mrcal;
pub(crate) mod picture_files;
mod pixels;
pub(crate) mod sightings;
pub(crate) mod stored_pictures;
