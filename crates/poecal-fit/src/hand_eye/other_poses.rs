//! Choice among several poses that fit the corners of a picture: the one that agrees with the other pictures.

use super::CameraMounting;
use super::directions::pairs;
use super::fit::{STARTS, medians, start};
use super::readings::PoseList;
use super::types::{Directions, HandEyeOptions};
use poecal_arm::lie::{Pose, rotation};

/// Largest number of rounds in which pictures take another of their poses.
const ROUNDS: usize = 6;

/// The target's poses, for each row the one that agrees with the other rows, and the rows in which that is not the first.
pub(crate) fn settle_poses(flange: &[Pose], target: &PoseList, options: &HandEyeOptions) -> (Vec<Pose>, Vec<usize>) {
    if target.other_poses.is_empty() {
        return (target.poses.clone(), Vec::new());
    }
    // Both directions are tried, whatever is stated: the camera may be at the other end.
    let tried = [false, true].into_iter().filter_map(|flange_inverted| {
        let directions = Directions { flange_inverted, target_inverted: false, stated: false };
        by_rounds(flange, target, options.camera, &directions)
    });
    let best = tried.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, poses)| poses);
    let poses = best.unwrap_or_else(|| target.poses.clone());
    let changed = poses.iter().zip(&target.poses).enumerate().filter(|(_, (one, first))| one != first);
    let changed = changed.map(|(row, _)| row).collect();
    (poses, changed)
}

/// Poses in one direction of the arm's, with the median angle of their errors.
fn by_rounds(
    flange: &[Pose],
    target: &PoseList,
    camera: CameraMounting,
    directions: &Directions,
) -> Option<(f64, Vec<Pose>)> {
    let mut poses = target.poses.clone();
    let mut best: Option<(f64, Vec<Pose>)> = None;
    for _ in 0..ROUNDS {
        let rows = pairs(flange, &poses, camera, directions);
        let frames = start(&rows, STARTS)?;
        let (_, off) = medians(&rows, &frames);
        if best.as_ref().is_none_or(|(least, _)| off < *least) {
            best = Some((off, poses.clone()));
        }
        let mut has_changed = false;
        for (row, pair) in rows.iter().enumerate() {
            let predicted = frames.predict(&pair.moved);
            let turned = |pose: &&Pose| rotation::log(&(pose.rotation * predicted.rotation.transpose())).norm();
            let first = target.poses.get(row).into_iter();
            let nearest = first
                .chain(target.other_poses.get(row).into_iter().flatten())
                .min_by(|a, b| turned(a).total_cmp(&turned(b)));
            if let (Some(pose), Some(nearest)) = (poses.get_mut(row), nearest)
                && pose != nearest
            {
                (*pose, has_changed) = (*nearest, true);
            }
        }
        if !has_changed {
            break;
        }
    }
    best
}
