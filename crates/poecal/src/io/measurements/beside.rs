//! What files that are read together are to each other.

use std::path::Path;

use super::configurations::is_folder;
use super::corner_columns::{are_corners, are_readings_of_pictures};
use super::mapping::ColumnMap;
use super::picture_files::NO_CAMERA;
use super::table::Table;
use super::text::Blocks;
use crate::error::{Error, ErrorKind};
use crate::io::disk::is_file;
use crate::robot::Robot;

/// Whether a file has readings of joints by picture. One that cannot be read is named when it is read.
pub(super) fn has_readings_of_pictures(path: &Path, robot: &Robot, map: &ColumnMap) -> bool {
    // A pipe is read once.
    if !is_file(path) && !is_folder(path) {
        return false;
    }
    let table = Blocks::open_or_join(path, "a measurement file (CSV)")
        .and_then(|blocks| Table::open(path, blocks, map));
    table.is_ok_and(|table| are_readings_of_pictures(&table.header, &robot.reading_names(), map))
}

/// The error of readings of pictures that are read without a camera, where another file has their corners.
pub(super) fn beside(
    error: Error,
    path: &Path,
    paths: &[&Path],
    (robot, map, without_camera): (&Robot, &ColumnMap, bool),
) -> Error {
    // Readings of pictures without a camera are taken for measurements.
    let has_corners = |other: &&&Path| {
        let blocks = Blocks::open(other, "a measurement file (CSV)");
        let table = blocks.and_then(|blocks| Table::open(other, blocks, map));
        **other != path
            && is_file(other)
            && table.is_ok_and(|table| {
                are_corners(&table.header, &robot.reading_names(), map).is_ok_and(|are_corners| are_corners)
            })
    };
    if without_camera && let Some(corners) = paths.iter().find(has_corners) {
        return Error::new(ErrorKind::Measurement, NO_CAMERA).in_file(corners);
    }
    error
}
