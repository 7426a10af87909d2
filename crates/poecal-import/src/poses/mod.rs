//! Poses of the flange and of the target that it carries, as lists and as pairs.
//!
//! `pose_columns.rs` converts names of columns to forms, `pose_file.rs` reads one file, with joint readings too, `pose_lists.rs` one file or two.
//! `samples.rs` reads lists of other programs, `matrix_columns.rs` matrices in columns, `picture_poses.rs` the target by corners. `pose_readings.rs` finds
//! other interpretations of the numbers.

pub(crate) mod matrix_columns;
pub(crate) mod paired_readings;
pub(crate) mod picture_poses;
pub(crate) mod pose_columns;
pub(crate) mod pose_file;
pub(crate) mod pose_lists;
pub(crate) mod pose_owner;
pub(crate) mod pose_readings;
pub(crate) mod pose_table;
pub(crate) mod samples;
