//! Which way round the two lists of poses are.

use super::CameraPlace;
use super::equations::{Frames, Pair};
use super::fit::{STARTS, medians, start};
use super::types::{Directions, HandEyeOptions};
use poecal_arm::lie::Pose;
use poecal_numerics::error::{ErrorKind, Result};

/// The pairs of two lists, read in these directions.
pub(crate) fn pairs(flange: &[Pose], target: &[Pose], camera: CameraPlace, by: &Directions) -> Vec<Pair> {
    let inverts = by.flange_inverted != (camera == CameraPlace::InHand);
    let turned = |pose: &Pose, inverts: bool| if inverts { pose.inverse() } else { *pose };
    let both = flange.iter().zip(target);
    both.map(|(arm, seen)| Pair { moved: turned(arm, inverts), seen: turned(seen, by.target_inverted) })
        .collect()
}

/// Errors below which nothing is compared, metres and radians.
const EXACT: f64 = 1e-6;

/// How well poses fit: the sum of the logarithms of the median errors, with the frames and these errors, metres and radians.
pub(crate) fn score(pairs: &[Pair]) -> Option<(f64, Frames, (f64, f64))> {
    let frames = start(pairs, STARTS)?;
    let (shift, turn) = medians(pairs, &frames);
    Some((shift.max(EXACT).ln() + turn.max(EXACT).ln(), frames, (shift, turn)))
}

/// How much smaller the product of the median errors must be for a direction to be the better one.
const BETTER: f64 = 2.0;
/// How many times nearer to its parent a camera in the hand is than the board, if the directions follow from that.
const NEARER: f64 = 1.5;

/// A direction with how well it fits.
struct Candidate {
    directions: Directions,
    score: f64,
    frames: Frames,
}

/// The directions in which the lists fit, and a sentence if they are not the usual ones.
///
/// Both lists the other way round fit as well, with the two frames exchanged: then what is on the flange is nearer to it than what stays
/// is to the base.
pub(crate) fn found(
    flange: &[Pose],
    target: &[Pose],
    options: &HandEyeOptions,
) -> Result<(Directions, Option<String>)> {
    let camera = options.camera;
    let stated = options.flange_inverted.is_some() && options.target_inverted.is_some();
    let allowed = |stated: Option<bool>| match stated {
        Some(it) => vec![it],
        None => vec![false, true],
    };
    let mut candidates = Vec::new();
    for flange_inverted in allowed(options.flange_inverted) {
        for target_inverted in allowed(options.target_inverted) {
            let directions = Directions { flange_inverted, target_inverted, stated };
            if let Some((score, frames, _)) = score(&pairs(flange, target, camera, &directions)) {
                candidates.push(Candidate { directions, score, frames });
            }
        }
    }
    let Some(usual) = candidates.first() else {
        return ErrorKind::Problem.refuse(
            "found poses from which no frame can be computed, expected poses that turn about two axes or more: turn the flange further",
        );
    };
    // Both lists inverted are the same equations as none, and one is the same as the other.
    let is_mixed = |it: &Candidate| it.directions.flange_inverted != it.directions.target_inverted;
    let least = |mixed: bool| {
        let own = candidates.iter().filter(|it| is_mixed(it) == mixed);
        own.map(|it| it.score).fold(f64::INFINITY, f64::min)
    };
    let mixed_is_better = least(true) < least(false) - BETTER.ln();
    if candidates.len() == 1 {
        return Ok((usual.directions, None));
    }
    if !mixed_is_better && !is_mixed(usual) {
        return Ok((usual.directions, exchanged(usual, camera)));
    }
    let good: Vec<&Candidate> = candidates.iter().filter(|it| is_mixed(it) == mixed_is_better).collect();
    other_directions(&good, target, camera)
}

/// Distances of what is on the flange from it, and of what stays from the base.
fn distances(frames: &Frames, camera: CameraPlace) -> (f64, f64) {
    let (of_camera, of_target) = (frames.outer.translation.norm(), frames.inner.translation.norm());
    match camera {
        CameraPlace::InHand => (of_camera, of_target),
        CameraPlace::Beside => (of_target, of_camera),
    }
}

/// What is said where the usual directions fit, but both lists the other way round would be likelier.
fn exchanged(usual: &Candidate, camera: CameraPlace) -> Option<String> {
    let (on_flange, in_base) = distances(&usual.frames, camera);
    (on_flange > 2.0 * in_base && on_flange > 1.0).then(|| {
        format!(
            "the {} is {on_flange:.2} m from the flange and the {} {in_base:.2} m from the base: if that is the other way round, both lists are \
             inverted (--flange flange-from-base --target target-from-camera)",
            camera.on_flange(),
            camera.in_base()
        )
    })
}

/// Where the usual directions do not fit: the others, if it can be said which list is inverted.
fn other_directions(
    good: &[&Candidate],
    target: &[Pose],
    camera: CameraPlace,
) -> Result<(Directions, Option<String>)> {
    let (Some(first), rest) = (good.first(), good.get(1)) else {
        return ErrorKind::Problem
            .refuse("found poses that fit in no direction, expected poses of one session: check both lists");
    };
    let other_place = match camera {
        CameraPlace::InHand => CameraPlace::Beside,
        CameraPlace::Beside => CameraPlace::InHand,
    };
    let Some(second) = rest else {
        return Ok((first.directions, Some(inverted(&first.directions, other_place))));
    };
    // A camera sees what is before it: then the target's list is as it should be.
    let is_before = |it: &Pose| it.translation.z > 0.0 && it.translation.xy().norm() < it.translation.z;
    let as_read = target.iter().all(is_before);
    let turned = target.iter().all(|it| is_before(&it.inverse()));
    if as_read && !turned {
        return ErrorKind::Problem.refuse(format!(
            "found poses that do not fit a camera {} and do fit one {}, expected those of --camera {}: run with --camera {}, or state --flange \
             flange-from-base if the poses of the arm are inverted",
            place(camera),
            place(other_place),
            camera.word(),
            other_place.word()
        ));
    }
    let near = |it: &Candidate| {
        let (on_flange, in_base) = distances(&it.frames, camera);
        on_flange / in_base.max(1e-9)
    };
    let target_first = turned && !as_read;
    let (one, other) = (near(first), near(second));
    let (mut chosen, mut ratio) = if one <= other { (first, other / one) } else { (second, one / other) };
    if target_first && let Some(candidate) = good.iter().find(|it| it.directions.target_inverted) {
        (chosen, ratio) = (candidate, f64::INFINITY);
    }
    if ratio < NEARER {
        return ErrorKind::Problem.refuse(format!(
            "found poses that fit with one of the lists inverted, and as well with the other, expected base from flange and camera from target: \
             state --flange flange-from-base or --target target-from-camera, or --camera {}",
            other_place.word()
        ));
    }
    Ok((chosen.directions, Some(inverted(&chosen.directions, other_place))))
}

fn place(camera: CameraPlace) -> &'static str {
    match camera {
        CameraPlace::InHand => "in the hand",
        CameraPlace::Beside => "beside the robot",
    }
}

/// The sentence about lists that are inverted.
fn inverted(directions: &Directions, other_place: CameraPlace) -> String {
    let what = match (directions.flange_inverted, directions.target_inverted) {
        (true, true) => "both lists are inverted",
        (true, false) => "the poses of the arm are inverted (flange from base)",
        (false, _) => "the poses of the target are inverted (target from camera)",
    };
    format!(
        "{what}: so they fit, and not as base from flange and camera from target; they were inverted back. If the camera is {} instead, run with \
         --camera {}",
        place(other_place),
        other_place.word()
    )
}
