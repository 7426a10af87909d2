//! Roles of files that are read together.

use std::path::Path;

use super::join_plan::{FileRole, part};
use crate::instruments::{MEASURED, OpeningContext};
use crate::pictures::corner_columns::{are_corners, are_readings_of_pictures};
use crate::pictures::picture_files::NO_CAMERA;
use crate::table::FileTable;
use crate::table::configurations::advice;
use crate::table::header_cells::HeaderCell;
use crate::table::mapping::ColumnMap;
use crate::table::text::LineBlocks;
use poecal_model::robot::Robot;
use poecal_numerics::error::{Error, ErrorKind, MissingColumn};

/// True if a file has joint readings by picture. A file that cannot be read is refused when it is read.
pub(crate) fn has_readings_of_pictures(path: &Path, robot: &Robot, map: &ColumnMap) -> bool {
    let table = LineBlocks::open_or_join(path, MEASURED).and_then(|blocks| FileTable::open(path, blocks, map));
    table.is_ok_and(|table| are_readings_of_pictures(&table.header, &robot.reading_names(), map))
}

/// The error of a file with joint readings only, or measurements only, without a counterpart.
pub(crate) fn lone_file_error(error: Error, path: &Path, opening: &OpeningContext<'_>, map: &ColumnMap) -> Error {
    let Some(missing) = error.missing_column() else { return error };
    let (is_lone, found, other) = match part(path, *opening, map).map(|it| it.part) {
        Ok(FileRole::Joints) => (true, "joint readings and nothing that was measured", "measurements"),
        Ok(FileRole::Measured { .. }) => (false, "measurements and no joint readings", "joint readings"),
        Ok(FileRole::Whole) | Err(_) => return error,
    };
    let table = opening.blocks(path, MEASURED).and_then(|it| FileTable::open(path, it, map));
    let Ok(table) = table else { return error };
    // In a file in our form, a column may have another name.
    let names = opening.robot.reading_names();
    let is_all = is_lone && table.header.cells.iter().all(|it| names.contains(&it.name) || it.name == "id");
    if table.is_made() || is_all {
        let message = format!("found {found}, expected both: name the file of the {other} beside it{}", advice(path));
        return Error::new(ErrorKind::Measurement, message).in_file(path);
    }
    // A column with a name like a missing one may be it under another name.
    let header = || table.header.cells.iter();
    let is_axis = |it: &HeaderCell| {
        let mut letters = it.name.chars().map(|it| it.to_ascii_lowercase());
        letters.next().is_some_and(|it| "xyz".contains(it)) && !letters.next().is_some_and(char::is_alphanumeric)
    };
    let says_it = if is_lone {
        missing == MissingColumn::Position && !header().any(is_axis)
    } else {
        missing == MissingColumn::Joint && !header().any(|it| names.contains(&it.name))
    };
    if !says_it {
        return error;
    }
    error.with_more(&format!("or name the file of the {other} beside it"))
}

/// The error of joint readings by picture that are read without a camera, if another file has the corners.
pub(crate) fn missing_camera_error(
    error: Error,
    path: &Path,
    paths: &[&Path],
    (robot, map, without_camera): (&Robot, &ColumnMap, bool),
) -> Error {
    // Joint readings by picture without a camera are taken for measurements.
    let has_corners = |other: &&&Path| {
        let blocks = LineBlocks::open(other, MEASURED);
        let table = blocks.and_then(|blocks| FileTable::open(other, blocks, map));
        **other != path
            && table.is_ok_and(|table| {
                are_corners(&table.header, &robot.reading_names(), map).is_ok_and(|are_corners| are_corners)
            })
    };
    if without_camera && let Some(corners) = paths.iter().find(has_corners) {
        return Error::new(ErrorKind::Measurement, NO_CAMERA).in_file(corners);
    }
    error
}
