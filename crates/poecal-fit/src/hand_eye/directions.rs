//! Directions of the two lists of poses, and plausibility of the stated camera mounting.
//!
//! A camera in the hand whose arm's poses are inverted has the equations of a camera beside the robot, with camera and target exchanged. The fit
//! therefore determines only whether an odd number of three statements is wrong: the camera's mounting, the arm's list, the target's list. The
//! wrong one follows from the positions that camera and target would have.

use super::CameraMounting;
use super::equations::{FramePair, PosePair};
use super::findings::{Finding, FindingKind};
use super::fit::{STARTS, medians, start};
use super::types::{Directions, HandEyeOptions};
use poecal_arm::lie::Pose;
use poecal_numerics::distributions::median;
use poecal_numerics::error::{Error, ErrorKind, Result};

/// Pairs of two lists, read in these directions.
pub(crate) fn pairs(flange: &[Pose], target: &[Pose], camera: CameraMounting, by: &Directions) -> Vec<PosePair> {
    let inverts = by.flange_inverted != (camera == CameraMounting::InHand);
    let turned = |pose: &Pose, inverts: bool| if inverts { pose.inverse() } else { *pose };
    let both = flange.iter().zip(target);
    both.map(|(arm, seen)| PosePair { moved: turned(arm, inverts), seen: turned(seen, by.target_inverted) }).collect()
}

/// Errors below which nothing is compared, metres and radians.
const EXACT: f64 = 1e-6;

/// Score of a fit: the sum of the logarithms of the median errors, with the frames and these errors, metres and radians.
pub(crate) fn score(pairs: &[PosePair]) -> Option<(f64, FramePair, (f64, f64))> {
    let frames = start(pairs, STARTS)?;
    let (shift, turn) = medians(pairs, &frames);
    Some((shift.max(EXACT).ln() + turn.max(EXACT).ln(), frames, (shift, turn)))
}

/// Factor by which the product of the median errors must be smaller for a direction to be the better one.
const BETTER: f64 = 2.0;
/// Median angle, radians, above which poses fit in no direction.
const NO_FIT: f64 = 0.1;
/// Largest distance from the flange of an object on it, as a share of the median distance of the flange from the base. A reach is 1.3 to 1.6
/// of these distances, so this is about a third of the reach.
const FARTHEST: f64 = 0.5;
/// Least ratio of the static object's distance from the base to the mounted object's distance from the flange: a nearer object would be inside
/// the robot.
const FARTHER: f64 = 2.0;

/// Distances of camera and target.
#[derive(Clone, Copy)]
struct Distances {
    /// Distance of the mounted object from the flange, metres.
    on_flange: f64,
    /// Distance of the static object from the base, metres.
    in_base: f64,
    /// Median distance of the flange from the base, metres; it is the same for inverted poses.
    of_flange: f64,
}

impl Distances {
    fn from_frames(frames: &FramePair, flange: &[Pose], camera: CameraMounting) -> Self {
        let (of_camera, of_target) = (frames.outer.translation.norm(), frames.inner.translation.norm());
        let (on_flange, in_base) = match camera {
            CameraMounting::InHand => (of_camera, of_target),
            CameraMounting::Beside => (of_target, of_camera),
        };
        let of_flange = median(flange.iter().map(|it| it.translation.norm())).unwrap_or_default();
        Distances { on_flange, in_base, of_flange }
    }

    /// The same distances with the mounted and the static object exchanged.
    fn exchange(self) -> Self {
        Distances { on_flange: self.in_base, in_base: self.on_flange, ..self }
    }

    /// True if a robot can have these distances: the mounted object is near the flange, and the static one is outside the base.
    fn is_plausible(self) -> bool {
        self.on_flange <= FARTHEST * self.of_flange && self.in_base >= FARTHER * self.on_flange
    }

    /// Positions of both, in words.
    fn words(self, camera: CameraMounting) -> String {
        let mm = |metres: f64| 1e3 * metres;
        format!(
            "the {} {:.0} mm from the flange and the {} {:.0} mm from the base",
            camera.on_flange(),
            mm(self.on_flange),
            camera.in_base(),
            mm(self.in_base)
        )
    }
}

/// Directions of the target's list that its poses allow: a camera sees objects in front of it.
fn allowed_directions(target: &[Pose]) -> (bool, bool) {
    let is_before = |it: &Pose| it.translation.z > 0.0 && it.translation.xy().norm() < it.translation.z;
    let as_read = target.iter().all(is_before);
    let turned = target.iter().all(|it| is_before(&it.inverse()));
    // If neither direction is allowed, the camera's axes are not those of OpenCV, and nothing follows.
    (as_read || !turned, turned || !as_read)
}

/// Directions in which the lists fit, with a finding if they are unusual, or if camera and target lie as if they were exchanged.
///
/// # Errors
/// [`ErrorKind::Problem`] if the poses fit in no direction, or if the camera is at the other end. It is also the error if the data do
/// not determine which of both is other than stated.
pub(crate) fn find_directions(
    flange: &[Pose],
    target: &[Pose],
    options: &HandEyeOptions,
) -> Result<(Directions, Option<Finding>)> {
    let camera = options.camera;
    let fit = |directions: &Directions| score(&pairs(flange, target, camera, directions));
    let stated = options.flange_inverted.is_some() && options.target_inverted.is_some();
    let usual = Directions {
        flange_inverted: options.flange_inverted.unwrap_or(false),
        target_inverted: options.target_inverted.unwrap_or(false),
        stated,
    };
    let inverted = Directions { flange_inverted: !usual.flange_inverted, ..usual };
    let (as_usual, as_inverted) = (fit(&usual), fit(&inverted));
    let Some((least, frames, _)) = as_usual else {
        return ErrorKind::Problem.refuse(
            "found poses from which no frame can be computed, expected poses that turn about two axes or more: turn the flange further",
        );
    };
    let better = as_inverted.filter(|(score, _, (_, turn))| *score < least - BETTER.ln() && *turn < NO_FIT);
    let (may_be_as_read, may_be_turned) = allowed_directions(target);
    let target_is_open = options.target_inverted.is_none() && may_be_turned;
    let arm_is_open = options.flange_inverted.is_none();
    let Some((_, frames_inverted, _)) = better else {
        let distances = Distances::from_frames(&frames, flange, camera);
        let is_exchanged = !distances.is_plausible() && distances.on_flange > distances.in_base;
        let is_open = !stated && (arm_is_open || target_is_open);
        return Ok((usual, (is_open && is_exchanged).then(|| exchanged_finding(distances, camera))));
    };
    // These are the distances for the arm's list inverted. For the target's list inverted, and for the other end, camera and target are
    // exchanged.
    let distances = Distances::from_frames(&frames_inverted, flange, camera);
    let target_as_stated = options.target_inverted.is_some() || may_be_as_read;
    if arm_is_open && target_as_stated && distances.is_plausible() {
        return Ok((inverted, Some(inverted_finding(&inverted, camera))));
    }
    let of_target = Directions { target_inverted: true, ..usual };
    if target_is_open && !may_be_as_read {
        return Ok((of_target, Some(inverted_finding(&of_target, camera))));
    }
    let is_certain = distances.exchange().is_plausible() || !arm_is_open;
    Err(at_other_end(distances, camera, (!is_certain && arm_is_open, target_is_open)))
}

fn other_camera(camera: CameraMounting) -> CameraMounting {
    match camera {
        CameraMounting::InHand => CameraMounting::Beside,
        CameraMounting::Beside => CameraMounting::InHand,
    }
}

/// Error of a camera at the other end. `arm` and `target` are true for lists that may be inverted instead.
fn at_other_end(distances: Distances, camera: CameraMounting, (arm, target): (bool, bool)) -> Error {
    let other = other_camera(camera);
    let mut instead = Vec::new();
    if arm {
        instead.push("--flange flange-from-base if the poses of the arm are inverted");
    }
    if target {
        instead.push("--target target-from-camera if those of the target are inverted");
    }
    let instead = match instead.is_empty() {
        true => String::new(),
        false => format!(", or state {}", instead.join(", or ")),
    };
    ErrorKind::Problem.error(format!(
        "found poses that fit a camera {} ({}), and not one {}, expected those of --camera {}: run with --camera {}{instead}",
        place(other),
        distances.exchange().words(other),
        place(camera),
        camera.word(),
        other.word(),
    ))
}

/// Finding of poses that fit as they are stated, but with camera and target at positions where the other one is more likely.
fn exchanged_finding(distances: Distances, camera: CameraMounting) -> Finding {
    let other = other_camera(camera);
    let statement = format!(
        "found {}, as if both were exchanged: if the camera is {} and the poses of the arm are inverted, state --camera {} --flange \
         flange-from-base; if both lists are inverted, --flange flange-from-base --target target-from-camera; if neither, --flange \
         base-from-flange --target camera-from-target",
        distances.words(camera),
        place(other),
        other.word()
    );
    Finding::new(FindingKind::Exchanged, statement, Vec::new())
}

fn place(camera: CameraMounting) -> &'static str {
    match camera {
        CameraMounting::InHand => "in the hand",
        CameraMounting::Beside => "beside the robot",
    }
}

/// Finding of a list that is inverted.
fn inverted_finding(directions: &Directions, camera: CameraMounting) -> Finding {
    let what = match directions.flange_inverted {
        true => "the poses of the arm are inverted (flange from base)",
        false => "the poses of the target are inverted (target from camera)",
    };
    let other = other_camera(camera);
    let statement = format!(
        "{what}: so they fit, and not as base from flange and camera from target; they were inverted back. If the camera is {} instead, run with \
         --camera {}",
        place(other),
        other.word()
    );
    Finding::new(FindingKind::Inverted, statement, Vec::new())
}
