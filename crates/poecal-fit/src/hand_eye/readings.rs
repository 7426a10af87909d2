//! Lists of poses, their other possible readings, and the reading that fits if the stated one does not.

use super::CameraMounting;
use super::directions::{pairs, score};
use super::flange_turns::{refuse_one_axis, turns};
use super::types::{Directions, HandEyeOptions};
use super::unknown_lens::UnknownLens;
use nalgebra::{Matrix3, Vector3};
use poecal_arm::lie::Pose;
use poecal_numerics::error::{Error, ErrorKind, Result};

/// Poses of one list, and other readings of its columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PoseList {
    /// Poses as they were read.
    pub poses: Vec<Pose>,
    /// Other interpretations of the same numbers, reported if one of them fits and this one does not.
    pub others: Vec<ListReading>,
    /// For each row, other poses that fit the picture nearly as well, such as the second one of a flat board; empty if there are none at
    /// all.
    pub other_poses: Vec<Vec<Pose>>,
    /// Unknown lens with which the poses were estimated from pictures, one a row; `None` if the lens is known, or there are no pictures.
    pub lens: Option<UnknownLens>,
    /// Statement that the pictures by themselves contradict the lens with which the poses were estimated.
    pub lens_doubt: Option<String>,
}

/// Another reading of a list.
#[derive(Clone, Debug, PartialEq)]
pub struct ListReading {
    /// Finding and remedy, as the end of a sentence.
    pub advice: String,
    /// Poses by this reading.
    pub poses: Vec<Pose>,
}

impl PoseList {
    /// The list of some rows, in this order, with the same lens.
    #[must_use]
    pub fn select_rows(&self, rows: &[usize]) -> Self {
        let of = |poses: &[Pose]| rows.iter().filter_map(|&row| poses.get(row)).copied().collect();
        let others = self.others.iter().map(|it| ListReading { advice: it.advice.clone(), poses: of(&it.poses) });
        let other_poses = match self.other_poses.is_empty() {
            true => Vec::new(),
            false => rows.iter().filter_map(|&row| self.other_poses.get(row)).cloned().collect(),
        };
        PoseList {
            poses: of(&self.poses),
            others: others.collect(),
            other_poses,
            lens: None,
            lens_doubt: self.lens_doubt.clone(),
        }
    }
}

impl From<Vec<Pose>> for PoseList {
    fn from(poses: Vec<Pose>) -> Self {
        PoseList { poses, ..PoseList::default() }
    }
}

/// Factor by which the product of the median errors must be smaller for another reading to be the right one.
const EVIDENT: f64 = 8.0;
/// Median errors, metres and radians, above which no reading fits.
const GOOD: (f64, f64) = (0.03, 0.1);
/// Median distance from the base, metres, beyond which no arm reaches.
const FARTHEST: f64 = 25.0;
/// Median distance, metres, below which an arm does not move.
const NEAREST: f64 = 0.02;
/// The same distance for a camera.
const NEAREST_SEEN: f64 = 2e-3;

/// Refuses lengths that only another unit explains.
pub(crate) fn refuse_other_lengths(flange: &[Pose], target: &[Pose]) -> Result<()> {
    refuse_lengths("arm", flange, NEAREST)?;
    refuse_lengths("target", target, NEAREST_SEEN)
}

/// The same check for an arm alone.
pub(crate) fn refuse_arm_lengths(flange: &[Pose]) -> Result<()> {
    refuse_lengths("arm", flange, NEAREST)
}

fn refuse_lengths(list: &str, poses: &[Pose], nearest: f64) -> Result<()> {
    let Some(middle) = poecal_numerics::distributions::median(poses.iter().map(|it| it.translation.norm())) else {
        return Ok(());
    };
    if middle > FARTHEST {
        return ErrorKind::Problem.refuse(format!(
                "found positions of the {list} {middle:.0} m away (median), expected those of a robot: if they are millimetres, write `[mm]` behind \
                 the names of their columns, or --units mm"
            ));
    }
    if middle < nearest && middle > 0.0 {
        return ErrorKind::Problem.refuse(format!(
                "found positions of the {list} {:.2} mm away (median), expected those of a robot: if they are metres, write `[m]` behind the names \
                 of their columns, or --units m",
                1e3 * middle
            ));
    }
    Ok(())
}

/// Error that names another reading which fits evidently better than the stated one, in any direction; `None` if there is no such reading.
pub(crate) fn misreading_error(
    flange: &PoseList,
    target: &PoseList,
    options: &HandEyeOptions,
    found: f64,
) -> Option<Error> {
    let mut best: Option<(f64, String)> = None;
    let mut consider = |flange: &[Pose], target: &[Pose], advice: &str| {
        let Some((score, (shift, turn))) = least_score(flange, target, options) else { return };
        if shift < GOOD.0
            && turn < GOOD.1
            && score < found - EVIDENT.ln()
            && best.as_ref().is_none_or(|(least, _)| score < least - 0.1)
        {
            best = Some((score, advice.to_owned()));
        }
    };
    for (first, second, advice) in orders(flange.poses.len()) {
        let of = |poses: &[Pose], rows: &[usize]| -> Vec<Pose> {
            rows.iter().filter_map(|&row| poses.get(row)).copied().collect()
        };
        consider(&of(&flange.poses, &first), &of(&target.poses, &second), &advice);
    }
    for reading in &flange.others {
        consider(&reading.poses, &target.poses, &reading.advice);
    }
    for reading in &target.others {
        consider(&flange.poses, &reading.poses, &reading.advice);
    }
    for (list, poses) in [("arm", &flange.poses), ("target", &target.poses)] {
        for (poses, what) in mirror_poses(poses) {
            let advice = format!(
                "{what} of the {list}: its frame is left-handed, or a sign is wrong; export it in a right-handed frame"
            );
            if list == "arm" {
                consider(&poses, &target.poses, &advice)
            } else {
                consider(&flange.poses, &poses, &advice)
            }
        }
    }
    best.map(|(_, advice)| {
        ErrorKind::Problem.error(format!(
            "found poses that do not fit together as they are, expected one session; they fit with {advice}"
        ))
    })
}

/// Error that names another reading of the arm's orientations. By that reading, poses that turn about one axis turn about several, and fit.
pub(crate) fn misread_angles(flange: &PoseList, target: &PoseList, options: &HandEyeOptions) -> Option<Error> {
    let (as_read, _) = least_score(&flange.poses, &target.poses, options)?;
    let fits = flange.others.iter().filter_map(|reading| {
        let all: Vec<usize> = (0..reading.poses.len()).collect();
        let turns_enough = refuse_one_axis(&turns(&reading.poses, &all)).is_ok();
        let (score, (shift, turn)) = least_score(&reading.poses, &target.poses, options)?;
        let fits = shift < GOOD.0 && turn < GOOD.1 && score < as_read - EVIDENT.ln();
        (turns_enough && fits).then_some((score, &reading.advice))
    });
    let (_, advice) = fits.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(ErrorKind::Problem.error(format!(
        "found poses of the arm that hardly turn, or about one axis only, expected turns about two axes or more; the poses fit with {advice}"
    )))
}

/// Best score over the directions that are allowed, and its median errors.
pub(crate) fn least_score(flange: &[Pose], target: &[Pose], options: &HandEyeOptions) -> Option<(f64, (f64, f64))> {
    let of = |flange_inverted: bool| {
        let directions =
            Directions { flange_inverted, target_inverted: options.target_inverted.unwrap_or(false), stated: false };
        score(&pairs(flange, target, CameraMounting::Beside, &directions)).map(|(score, _, errors)| (score, errors))
    };
    [of(false), of(true)].into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0))
}

/// Other orders of the second list: rows of both, and the remedy.
fn orders(count: usize) -> Vec<(Vec<usize>, Vec<usize>, String)> {
    let all = || (0..count).collect::<Vec<_>>();
    let mut orders = Vec::new();
    for step in 1..=3.min(count.saturating_sub(5)) {
        let later = |by: &str| {
            format!(
                "the target's poses {step} row{} {by}: the two lists do not begin at the same pose; join them by a column of names, or remove what \
                 is in one of them only",
                if step == 1 { "" } else { "s" }
            )
        };
        let (start, end): (Vec<usize>, Vec<usize>) = ((0..count - step).collect(), (step..count).collect());
        orders.push((start.clone(), end.clone(), later("earlier")));
        orders.push((end, start, later("later")));
    }
    let advice = "join them by a column of names, as `image`, in both";
    orders.push((all(), all().into_iter().rev().collect(), format!("the target's poses in reverse order: {advice}")));
    for first in [0, 1] {
        let mut sorted = all();
        sorted.sort_by_key(|row| (row + first).to_string());
        if sorted != all() {
            let advice = format!("one list in the order 1, 10, 11, 2 of names as text: {advice}");
            orders.push((sorted.clone(), all(), advice.clone()));
            orders.push((all(), sorted, advice));
        }
    }
    orders
}

/// Poses with one axis mirrored: all of a frame, or positions alone.
fn mirror_poses(poses: &[Pose]) -> Vec<(Vec<Pose>, &'static str)> {
    let mirror = |axis: usize| {
        let mut signs = Vector3::repeat(1.0);
        signs[axis] = -1.0;
        Matrix3::from_diagonal(&signs)
    };
    let whole = mirror(2);
    let mut all = vec![(
        poses.iter().map(|it| Pose::new(whole * it.rotation * whole, whole * it.translation)).collect(),
        "an axis mirrored in the poses",
    )];
    for (axis, what) in
        ["x mirrored in the positions", "y mirrored in the positions", "z mirrored in the positions"].iter().enumerate()
    {
        let by = mirror(axis);
        all.push((poses.iter().map(|it| Pose::new(it.rotation, by * it.translation)).collect(), *what));
    }
    let turned = poses.iter().map(|it| Pose::new(it.rotation.transpose(), it.translation)).collect();
    all.push((turned, "orientations inverted in the poses"));
    all
}
