//! Lists of poses: of an arm's flange, and of a camera's target, side by side in one file or in two.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::picture_poses::{are_corners_of, poses_of_pictures};
use super::pose_columns::{PoseOwner, PoseUnits};
use super::pose_file::{PoseFile, PoseFileList, read_poses};
use crate::ReadOptions;
use crate::table::picture_names::PicturePartners;
use poecal_fit::hand_eye::{PoseList, Touches};
use poecal_model::robot::Robot;
use poecal_numerics::error::{ErrorKind, Result};

/// Options for reading files of poses.
#[derive(Clone, Copy, Debug)]
pub struct PoseSource<'a> {
    /// Units of columns that state none.
    pub units: PoseUnits,
    /// The robot whose joint readings are read instead of the arm's poses.
    pub robot: Option<&'a Robot>,
    /// Cameras and boards of corners in pixels, which are read instead of the target's poses.
    pub pictures: &'a ReadOptions,
}

/// Poses of an arm and of a camera's target, row by row.
#[derive(Clone, Debug, Default)]
pub struct PosePairs {
    /// `base_from_flange`, unless they are inverted.
    pub flange: PoseList,
    /// `camera_from_target`, unless they are inverted.
    pub target: PoseList,
    /// Readings of the joints, one row after the other, if the arm's poses are computed from them; else empty.
    pub joints: Vec<f64>,
    /// Name of each row in messages.
    pub names: Vec<String>,
    /// Interpretation of the columns, a sentence each.
    pub understood: Vec<String>,
    /// Warnings, a sentence each.
    pub warnings: Vec<String>,
    /// SHA-256 of each file by its name.
    pub sha256: BTreeMap<String, String>,
}

/// Poses of an arm in which a tip touched points.
#[derive(Clone, Debug, Default)]
pub struct FlangePoses {
    /// The poses, with the point that each touched and the tip with which it did.
    pub touches: Touches,
    /// Name of each row in messages.
    pub names: Vec<String>,
    /// Interpretation of the columns, a sentence each.
    pub understood: Vec<String>,
    /// Warnings, a sentence each.
    pub warnings: Vec<String>,
    /// SHA-256 of each file by its name.
    pub sha256: BTreeMap<String, String>,
}

/// Reads poses of an arm and of a target, side by side in one file or in two. Two files are joined by a column of names in both, else row by row.
/// The second file may have the corners of pictures instead of the target's poses.
///
/// # Errors
/// [`ErrorKind::File`] if a file cannot be read; [`ErrorKind::Syntax`], [`ErrorKind::Measurement`] and [`ErrorKind::Unit`] if the content is no
/// list of poses, with its position.
pub fn read_pose_pairs(paths: &[PathBuf], source: &PoseSource<'_>) -> Result<PosePairs> {
    let read = |path: &Path, alone: Option<PoseOwner>| read_poses(path, alone, source.units, source.robot);
    match paths {
        [one] => side_by_side(read(one, None)?),
        [first, second] => {
            match [first, second].map(|path| are_corners_of(path)) {
                [false, false] => join_files(read(first, Some(PoseOwner::Arm))?, read(second, Some(PoseOwner::Target))?),
                [false, true] => with_pictures(read(first, Some(PoseOwner::Arm))?, second, source.pictures),
                [true, false] => with_pictures(read(second, Some(PoseOwner::Arm))?, first, source.pictures),
                [true, true] => Err(ErrorKind::Measurement
                    .error("found corners in pixels in both files, expected the arm's poses in one of them")
                    .in_file(first)),
            }
        }
        _ => ErrorKind::Option.refuse(format!(
            "found {} files, expected one with the poses of arm and target side by side, or two: the arm's, then the target's",
            paths.len()
        )),
    }
}

/// Reads poses of an arm, with the columns `point` and `tip` if there are any.
///
/// # Errors
/// Those of [`read_pose_pairs`].
pub fn read_flange_poses(path: &Path, units: PoseUnits, robot: Option<&Robot>) -> Result<FlangePoses> {
    let mut file = read_poses(path, Some(PoseOwner::Arm), units, robot)?;
    let list = file.take(PoseOwner::Arm)?;
    Ok(FlangePoses {
        understood: vec![list.words],
        names: file.row_names(),
        sha256: checksums([&file]),
        touches: Touches { flange: list.poses, points: file.points, tips: file.tips },
        warnings: file.warnings,
    })
}

fn checksums<'a>(files: impl IntoIterator<Item = &'a PoseFile>) -> BTreeMap<String, String> {
    let checksum = |it: &PoseFile| Some((it.path.display().to_string(), it.sha256.clone()?));
    files.into_iter().filter_map(checksum).collect()
}

/// The arm's poses in some rows of its file, each with the target's pose there.
fn pair_poses(arm: &PoseFile, flange: PoseFileList, rows: &[usize], target: (PoseList, String)) -> PosePairs {
    let names = arm.row_names();
    let width = arm.joints.len() / arm.lines.len().max(1);
    let joints = |row: &usize| arm.joints.get(row * width..(row + 1) * width).unwrap_or_default();
    PosePairs {
        flange: flange.poses.select_rows(rows),
        target: target.0,
        joints: rows.iter().flat_map(joints).copied().collect(),
        names: rows.iter().filter_map(|row| names.get(*row).cloned()).collect(),
        understood: vec![flange.words, target.1],
        ..PosePairs::default()
    }
}

fn side_by_side(mut file: PoseFile) -> Result<PosePairs> {
    let (flange, target) = (file.take(PoseOwner::Arm)?, file.take(PoseOwner::Target)?);
    let rows: Vec<usize> = (0..file.lines.len()).collect();
    let pairs = pair_poses(&file, flange, &rows, (target.poses, target.words));
    Ok(PosePairs { sha256: checksums([&file]), warnings: file.warnings, ..pairs })
}

fn join_files(mut first: PoseFile, second: PoseFile) -> Result<PosePairs> {
    let mut warnings = std::mem::take(&mut first.warnings);
    let rows: Vec<(usize, usize)> = if first.names.is_some() && second.names.is_some() {
        by_name(&first, &second, &mut warnings)?
    } else if first.lines.len() == second.lines.len() {
        (0..first.lines.len()).zip(0..).collect()
    } else {
        let message = format!(
            "found {} poses, and {} in {}, expected as many, or a column `image` of names in both files by which they are joined",
            first.lines.len(),
            second.lines.len(),
            second.path.display()
        );
        return Err(ErrorKind::Measurement.error(message).in_file(&first.path));
    };
    let sha256 = checksums([&first, &second]);
    let (left, right): (Vec<usize>, Vec<usize>) = rows.into_iter().unzip();
    // The files may be named in the other order.
    let is_turned = first.lists.iter().all(|list| list.whose == PoseOwner::Target);
    let [mut arm, mut seen] = if is_turned { [second, first] } else { [first, second] };
    let [arm_rows, seen_rows] = if is_turned { [right, left] } else { [left, right] };
    let (flange, target) = (arm.take(PoseOwner::Arm)?, seen.take(PoseOwner::Target)?);
    let pairs = pair_poses(&arm, flange, &arm_rows, (target.poses.select_rows(&seen_rows), target.words));
    Ok(PosePairs { warnings, sha256, ..pairs })
}

/// Poses of an arm, and the corners of pictures that were taken there.
fn with_pictures(mut arm: PoseFile, corners: &Path, options: &ReadOptions) -> Result<PosePairs> {
    let pictures = poses_of_pictures(corners, &arm, options)?;
    let flange = arm.take(PoseOwner::Arm)?;
    let mut sha256 = checksums([&arm]);
    sha256.extend(pictures.sha256);
    let pairs = pair_poses(&arm, flange, &pictures.rows, (pictures.poses, pictures.words));
    let warnings = arm.warnings.into_iter().chain(pictures.warnings).collect();
    Ok(PosePairs { warnings, sha256, ..pairs })
}

/// Rows of the same name, or whose names end in the same number, in the order of the first file.
fn by_name(first: &PoseFile, second: &PoseFile, warnings: &mut Vec<String>) -> Result<Vec<(usize, usize)>> {
    let one = first.rows_by_name()?.unwrap_or_default();
    let other = second.rows_by_name()?.unwrap_or_default();
    let names = |rows: &BTreeMap<_, usize>| rows.keys().copied().collect::<BTreeSet<&String>>();
    let partners = PicturePartners::new(&names(&one), names(&other));
    let pair = |(row, name)| Some((row, *other.get(partners.partner(name)?)?));
    let rows: Vec<(usize, usize)> = first.names.iter().flatten().enumerate().filter_map(pair).collect();
    if rows.is_empty() {
        let message = format!(
            "found no name that is in {} too, expected the same names in both files, or ones that end in the same number, each once",
            second.path.display()
        );
        return Err(ErrorKind::Measurement.error(message).in_file(&first.path));
    }
    warnings.extend(partners.words("poses", rows.len()));
    let alone = one.len() + other.len() - 2 * rows.len();
    if alone > 0 {
        let both = rows.len();
        warnings.push(format!("{alone} poses are in one of the two files only, and left out; {both} are in both"));
    }
    Ok(rows)
}
