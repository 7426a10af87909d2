//! Poses of the flange and of what it holds, as lists and as pairs.

pub(crate) mod paired_readings;
pub(crate) mod picture_poses;
pub(crate) mod pose_columns;
pub(crate) mod pose_file;
pub(crate) mod pose_lists;
pub(crate) mod pose_names;
pub(crate) mod pose_readings;
pub(crate) mod pose_table;
