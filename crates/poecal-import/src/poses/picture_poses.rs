//! Poses of a board in a camera by its corners, beside poses of an arm that were read elsewhere.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use nalgebra::Vector3;

use super::pose_file::PoseFile;
use crate::ReadOptions;
use crate::pictures::corner_columns::are_corners;
use crate::pictures::picture_files::PictureConfiguration;
use crate::read::MeasurementReader;
use crate::table::FileTable;
use crate::table::mapping::ColumnMap;
use crate::table::text::LineBlocks;
use poecal_arm::lie::{Pose, Screw};
use poecal_fit::hand_eye::PoseList;
use poecal_fit::input_doubts::boards::refuse_wrong_boards;
use poecal_model::camera::{Picture, Pictures};
use poecal_model::robot::{Joint, Robot};
use poecal_numerics::error::{ErrorKind, Result, first_few};

/// Poses of the target by pictures.
pub(crate) struct PicturePoses {
    /// The row of the arm's poses for each picture.
    pub(crate) rows: Vec<usize>,
    pub(crate) poses: PoseList,
    pub(crate) words: String,
    pub(crate) warnings: Vec<String>,
    pub(crate) sha256: BTreeMap<String, String>,
}

/// True if a file has corners in pixels. A file that cannot be read has none here, and is refused later by its expected form.
pub(crate) fn are_corners_of(path: &Path) -> bool {
    let map = ColumnMap::default();
    let table =
        LineBlocks::open(path, "a file of corners (CSV)").and_then(|blocks| FileTable::open(path, blocks, &map));
    table.is_ok_and(|table| are_corners(&table.header, &[], &map).unwrap_or(false))
}

/// Reads a file of corners, whose pictures belong to poses of an arm by their names.
pub(crate) fn poses_of_pictures(path: &Path, arm: &PoseFile, options: &ReadOptions) -> Result<PicturePoses> {
    if options.cameras.is_empty() {
        let message = "found corners in pixels and no lens, expected --lens FILE with the focal lengths and the centre of the camera, or \
                       unknown:1920x1080 with the size of the pictures";
        return Err(ErrorKind::Measurement.error(message).in_file(path));
    }
    let Some(rows) = arm.rows_by_name()? else {
        let message = "found no names of pictures, expected a column `image` in the file of the arm's poses, as in that of the corners";
        return Err(ErrorKind::Measurement.error(message).in_file(&arm.path));
    };
    // The row of the arm's pose replaces its joint readings.
    let stand_in = Robot::new(
        "arm",
        vec![Joint::prismatic("row of the arm's poses", Screw::prismatic(&Vector3::z()))],
        Pose::identity(),
    )?;
    let map = ColumnMap::default();
    let mut reader = MeasurementReader::new(&stand_in, options, &map);
    reader.taken_as = "poses of the arm";
    for (name, row) in rows {
        let place = (arm.path.clone(), arm.lines.get(row).copied().unwrap_or(1));
        let taken = PictureConfiguration { readings: vec![row as f64], set: None, id: String::new(), place };
        reader.taken.insert(name.clone(), taken);
    }
    reader.file(path, LineBlocks::open(path, "a file of corners (CSV)")?)?;
    let mut found = reader.found;
    found.data.settle_pixels();
    refuse_wrong_boards(&found.data).map_err(|error| error.in_file(path))?;
    let pictures = &found.data.pictures;
    refuse_several(pictures).map_err(|error| error.in_file(path))?;
    let poses = PoseList::of_pictures(pictures).map_err(|found| ErrorKind::Measurement.error(found).in_file(path))?;
    let row = |picture: &Picture| found.data.readings(picture.row as usize).first().copied().unwrap_or_default();
    let rows: Vec<usize> = pictures.all.iter().map(|it| row(it) as usize).collect();
    let corners: usize = pictures.all.iter().map(|it| it.corners.len()).sum();
    let words =
        format!("the target: its pose by its corners in each picture ({corners} corners in {} pictures)", rows.len());
    Ok(PicturePoses { rows, poses, words, warnings: found.warnings, sha256: found.sha256 })
}

/// Refuses pictures of several boards, or by several cameras.
fn refuse_several(pictures: &Pictures) -> Result<()> {
    let seen: BTreeSet<(usize, usize)> = pictures.all.iter().map(|it| (it.camera, it.board)).collect();
    if seen.len() > 1 {
        let names: Vec<&str> = (seen.iter())
            .filter_map(|(camera, board)| match seen.iter().any(|it| it.0 != *camera) {
                true => pictures.cameras.get(*camera).map(|it| it.name.as_str()),
                false => pictures.boards.get(*board).map(|it| it.name.as_str()),
            })
            .collect();
        let message = format!(
            "found pictures of several cameras or boards ({}), expected one of each: leave the rows of one",
            first_few(&names)
        );
        return ErrorKind::Measurement.refuse(message);
    }
    Ok(())
}
