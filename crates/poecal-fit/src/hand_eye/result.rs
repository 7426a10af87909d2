//! The steps in order, and their result.

use nalgebra::Vector3;

use super::bounds::{FrameEstimate, FrameSide, bound_frame};
use super::directions::{find_directions, pairs};
use super::equations::{PosePair, errors, sight_axes};
use super::findings::{Finding, FindingKind, list_rows};
use super::fit::{HandEyeFit, sizes};
use super::flange_turns::{refuse_one_axis, turns};
use super::lens::{self, FitWithLens, LensCoupling, LensFit};
use super::noise::FrameCovariance;
use super::readings::{PoseList, least_score, misread_angles, misreading_error, refuse_other_lengths};
use super::types::{
    Directions, FlangeTurns, HandEye, HandEyeLevel, HandEyeOptions, HandEyeOutlier, HandEyeRowError, HeldOutErrors,
};
use super::unknown_lens::FoundLens;
use super::{CameraMounting, bound_simulation, other_poses, scale, session_motion, verdict};
use poecal_arm::lie::{Pose, rotation};
use poecal_numerics::error::{ErrorKind, Result};

/// Fewest poses.
const FEWEST: usize = 4;
/// Difference below which numbers of two rows are equal, m and rad.
const SAME: f64 = 1e-9;

/// Pose of a camera, from poses of the flange and of a target that were taken together. `name` returns the name of a row in messages.
///
/// # Errors
/// [`ErrorKind::Problem`] if the poses are too few, turn about one axis only, or do not fit together for a reason that can be named: their
/// units, conventions, order or directions.
///
/// ```
/// use poecal_fit::hand_eye::{CameraMounting, HandEyeOptions, hand_eye};
/// use poecal_arm::lie::Pose;
/// let (camera, board) = (Pose::from_xyz_rpy([0.04, -0.06, 0.09], [0.1, 0.0, 1.5]), Pose::from_xyz_rpy([0.6, 0.1, 0.0], [3.1, 0.0, 0.2]));
/// let flange: Vec<Pose> = (0..10).map(|k| f64::from(k)).map(|k| {
///     Pose::from_xyz_rpy([0.5 + 0.02 * k, 0.1 * k.sin(), 0.6], [3.0 + 0.3 * (1.3 * k).sin(), 0.3 * (2.1 * k).cos(), 0.4 * k.sin()])
/// }).collect();
/// let seen: Vec<Pose> = flange.iter().map(|it| (*it * camera).inverse() * board).collect();
/// let found = hand_eye(&flange.into(), &seen.into(), &HandEyeOptions::new(CameraMounting::InHand), &|row| format!("row {}", row + 1))?;
/// assert!((found.on_flange.pose.translation - camera.translation).norm() < 1e-9);
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
pub fn hand_eye(
    flange: &PoseList,
    target: &PoseList,
    options: &HandEyeOptions,
    name: &dyn Fn(usize) -> String,
) -> Result<HandEye> {
    let count = flange.poses.len();
    if count != target.poses.len() {
        return ErrorKind::Problem.refuse(format!(
            "found {count} poses of the arm and {} of the target, expected as many: join them by a column of names",
            target.poses.len()
        ));
    }
    refuse_other_lengths(&flange.poses, &target.poses)?;
    // Corners determine the board as the camera sees it.
    let target_inverted = options.target_inverted.or(target.lens.as_ref().map(|_| false));
    let options = &HandEyeOptions { target_inverted, ..*options };
    let mut findings = Vec::new();
    let target = &with_settled_poses(flange, target, (options, name), &mut findings);
    let mut counted = once_each(flange, target, name, &mut findings);
    refuse_few(flange, &counted)?;
    let turns = turns(&flange.poses, &counted);
    // Angles in another unit have hardly any rotation.
    refuse_one_axis(&turns).map_err(|error| misread_angles(flange, target, options).unwrap_or(error))?;
    if let Some(error) = mistake(flange, target, options) {
        return Err(error);
    }
    let part = |poses: &[Pose], rows: &[usize]| -> Vec<Pose> { rows.iter().map(|&row| poses[row]).collect() };
    let [arm, seen] = [&flange.poses, &target.poses].map(|poses| part(poses, &counted));
    let (directions, said) = find_directions(&arm, &seen, options)?;
    findings.extend(said);
    let all = pairs(&flange.poses, &target.poses, options.camera, &directions);
    let of = |rows: &[usize]| -> Vec<PosePair> { rows.iter().map(|&row| all[row]).collect() };
    if let Some(step) = session_motion::find_move(&of(&counted)) {
        let (longer, finding) = leave_moved_out(&step, &counted, options.camera, name);
        findings.push(finding);
        counted = longer;
    }
    let fitted = |poses: &[Pose], before: Option<&HandEyeFit>| {
        let all = pairs(&flange.poses, poses, options.camera, &directions);
        fitted_again(&all, &counted, before)
    };
    let with_lens = match &target.lens {
        Some(lens) => lens::refit_with_lens(lens, &target.poses, &fitted),
        None => fitted(&target.poses, None).map(|(fit, _)| FitWithLens::from_known_lens(target.poses.clone(), fit)),
    };
    let Some(FitWithLens { target: poses, fit, joint }) = with_lens else {
        return ErrorKind::Problem.refuse(
            "found poses that do not determine where the camera is, expected turns about two axes or more: add poses that turn about a second axis",
        );
    };
    let all = pairs(&flange.poses, &poses, options.camera, &directions);
    let found = assemble_result(&all, &counted, (&fit, joint, directions, turns), options.camera, findings, name)?;
    Ok(found.with_lens_doubt(target.lens_doubt.as_ref()))
}

/// The target's list, with those of several poses that agree with the other rows.
fn with_settled_poses(
    flange: &PoseList,
    target: &PoseList,
    (options, name): (&HandEyeOptions, &dyn Fn(usize) -> String),
    findings: &mut Vec<Finding>,
) -> PoseList {
    let (poses, rows) = other_poses::settle_poses(&flange.poses, target, options);
    if !rows.is_empty() {
        let statement = format!(
            "took another pose of the board by the same corners in {}: so the pictures agree",
            list_rows(&rows, name)
        );
        findings.push(Finding::new(FindingKind::OtherPose, statement, rows));
    }
    PoseList { poses, ..target.clone() }
}

/// Fit of some rows, from an earlier one if there is one, with the rows that count (as measured about its point).
fn fitted_again(all: &[PosePair], counted: &[usize], before: Option<&HandEyeFit>) -> Option<LensFit> {
    let rows: Vec<PosePair> = counted.iter().map(|&row| all[row]).collect();
    let fit = match before {
        Some(before) => HandEyeFit::from_start(&rows, before.own_frames()),
        None => HandEyeFit::from_pairs(&rows),
    }?;
    let about = fit.seen_about(&rows);
    let kept = counted.iter().copied().zip(about).zip(&fit.kept);
    let kept = kept.filter(|(_, kept)| **kept).map(|(row, _)| row).collect();
    Some((fit, kept))
}

/// Leaves out the poses before or after a move, and returns those that stay.
fn leave_moved_out(
    step: &session_motion::RelativeMotion,
    counted: &[usize],
    camera: CameraMounting,
    name: &dyn Fn(usize) -> String,
) -> (Vec<usize>, Finding) {
    let row = counted[step.from];
    let (before, after) = counted.split_at(step.from);
    let (longer, left_out) = if before.len() >= after.len() { (before, after) } else { (after, before) };
    let statement = format!(
        "{} moved by {:.2} mm and {:.2} deg before {}: the {} poses {} it were left out; fix it, and measure again",
        session_motion::moved_object(step.side, camera),
        1e3 * step.shift_m,
        step.turn_rad.to_degrees(),
        name(row),
        left_out.len(),
        if before.len() >= after.len() { "from" } else { "before" }
    );
    (longer.to_vec(), Finding::new(FindingKind::Moved, statement, left_out.to_vec()))
}

/// Result of a fit, with its findings and verdict.
fn assemble_result(
    all: &[PosePair],
    counted: &[usize],
    (fit, joint, directions, turns): (&HandEyeFit, Option<LensCoupling>, Directions, FlangeTurns),
    camera: CameraMounting,
    mut findings: Vec<Finding>,
    name: &dyn Fn(usize) -> String,
) -> Result<HandEye> {
    let rows: Vec<PosePair> = counted.iter().map(|&row| all[row]).collect();
    let kept = fit.rows(&fit.seen_about(&rows));
    let Some(spread) = FrameCovariance::from_pairs(&fit.noise, &kept, &fit.frames) else {
        return ErrorKind::Problem.refuse(
            "found poses that determine the camera's place in some directions only, expected turns about two axes or more: add such poses",
        );
    };
    let ([of_camera, of_target], lens) = with_bounds(spread, &rows, fit, joint);
    let (on_flange, in_base) = match camera {
        CameraMounting::InHand => (of_camera, of_target),
        CameraMounting::Beside => (of_target, of_camera),
    };
    let is_kept = |row: usize| counted.iter().position(|it| *it == row).is_some_and(|at| fit.kept[at]);
    let frames = fit.own_frames();
    let rows_errors: Vec<HandEyeRowError> = (all.iter().enumerate())
        .map(|(row, pair)| {
            let (shift_m, turn_rad) = sizes(&errors(pair, &frames));
            HandEyeRowError { shift_m, turn_rad, is_fitted: is_kept(row) }
        })
        .collect();
    let outliers = find_outliers((all, counted), &rows_errors, fit);
    say_outliers(&outliers, name, &mut findings);
    let held_out = held_out(&rows, fit);
    let noise = [0, 2, 3, 5].map(|number| fit.noise.sigma(number));
    let distance = poecal_numerics::distributions::median(kept.iter().map(|it| it.seen.translation.norm()));
    let distance = distance.unwrap_or_default();
    let scale = scale::length_scale((&rows, &kept), fit, verdict::inconsistent(&noise, distance).is_none());
    // Positions of camera and target follow from lengths that are wrong.
    findings.retain(|it| it.kind != FindingKind::Exchanged || !scale.is_some_and(scale::is_gross));
    let mut result = HandEye {
        camera,
        on_flange,
        in_base,
        directions,
        level: HandEyeLevel::Good,
        reasons: Vec::new(),
        noise,
        noise_about: fit.point,
        residual: root_mean_squares(&rows_errors),
        held_out,
        rows: rows_errors,
        outliers,
        turns,
        findings,
        lens,
    };
    verdict::judge(&mut result, scale, distance);
    Ok(result)
}

/// Camera and target with their bounds, which contain the uncertainty of an unknown lens.
fn with_bounds(
    spread: FrameCovariance,
    rows: &[PosePair],
    fit: &HandEyeFit,
    joint: Option<LensCoupling>,
) -> ([FrameEstimate; 2], Option<FoundLens>) {
    let factors = bound_simulation::factors(&fit.rows(rows), fit);
    let by = |spread: &FrameCovariance, side: FrameSide| {
        let (by_m, by_rad) = factors.factors_of_side(side);
        let placed = bound_frame(spread, &fit.frames, &fit.point, side);
        FrameEstimate { bound95_m: by_m * placed.bound95_m, bound95_rad: by_rad * placed.bound95_rad, ..placed }
    };
    let both = |spread: &FrameCovariance| [FrameSide::Camera, FrameSide::Target].map(|side| by(spread, side));
    let Some(LensCoupling { found, covariance, freedom, larger }) = joint else {
        return (both(&spread), None);
    };
    let spread = spread.enlarge(larger);
    let known_bound95_m = by(&spread, FrameSide::Camera).bound95_m;
    (both(&spread.with_part(covariance, freedom)), Some(FoundLens { known_bound95_m, ..found }))
}

/// Rows that were left out of a fit of some.
fn find_outliers(
    (all, counted): (&[PosePair], &[usize]),
    errors: &[HandEyeRowError],
    fit: &HandEyeFit,
) -> Vec<HandEyeOutlier> {
    counted
        .iter()
        .filter(|row| !errors[**row].is_fitted)
        .map(|&row| {
            let HandEyeRowError { shift_m, turn_rad, .. } = errors[row];
            HandEyeOutlier { row, shift_m, turn_rad, is_flipped: is_flipped(&all[row], fit) }
        })
        .collect()
}

/// Rows without those that repeat an earlier one.
fn once_each(
    flange: &PoseList,
    target: &PoseList,
    name: &dyn Fn(usize) -> String,
    findings: &mut Vec<Finding>,
) -> Vec<usize> {
    let same = |one: &Pose, other: &Pose| {
        let (shift, turn) = one.distance_and_angle(other);
        shift < SAME && turn < 1e-7
    };
    let mut counted: Vec<usize> = Vec::new();
    let mut repeated = Vec::new();
    for row in 0..flange.poses.len() {
        let earlier = counted
            .iter()
            .find(|&&it| same(&flange.poses[it], &flange.poses[row]) && same(&target.poses[it], &target.poses[row]));
        match earlier {
            Some(&it) => repeated.push((row, it)),
            None => counted.push(row),
        }
    }
    if !repeated.is_empty() {
        let words: Vec<String> =
            repeated.iter().take(4).map(|&(row, it)| format!("{} repeats {}", name(row), name(it))).collect();
        let more = if repeated.len() > 4 { format!(" and {} more", repeated.len() - 4) } else { String::new() };
        let statement = format!(
            "{}{more}: the same numbers of arm and target count once; measure each pose anew",
            words.join(", ")
        );
        findings.push(Finding::new(FindingKind::Repeated, statement, repeated.iter().map(|it| it.0).collect()));
    }
    counted
}

/// Refuses if the number of different poses is too small for any test.
fn refuse_few(flange: &PoseList, counted: &[usize]) -> Result<()> {
    let mut different: Vec<&Pose> = Vec::new();
    for &row in counted {
        let pose = &flange.poses[row];
        let is_new = different.iter().all(|it| {
            let (shift, turn) = it.distance_and_angle(pose);
            shift > 1e-5 || turn > 1e-4
        });
        if is_new {
            different.push(pose);
        }
        if different.len() >= FEWEST {
            return Ok(());
        }
    }
    let count = different.len();
    ErrorKind::Problem.refuse(format!(
        "found {count} different pose{}, expected {FEWEST} or more, and 15 to 30 for a good result: three poses fit themselves, and show no error; \
         add poses that turn about different axes",
        if count == 1 { "" } else { "s" }
    ))
}

/// Median errors, metres and radians, above which other readings are tried.
const SUSPICIOUS: (f64, f64) = (3e-3, 5e-3);

/// The most likely mistake in the poses, if they fit badly as they are.
fn mistake(flange: &PoseList, target: &PoseList, options: &HandEyeOptions) -> Option<poecal_numerics::error::Error> {
    let (score, (shift, turn)) = least_score(&flange.poses, &target.poses, options)?;
    (shift > SUSPICIOUS.0 || turn > SUSPICIOUS.1).then(|| misreading_error(flange, target, options, score)).flatten()
}

/// True if a row is right once its board is turned to the other of the two poses that look alike from afar.
fn is_flipped(pair: &PosePair, fit: &HandEyeFit) -> bool {
    let predicted = fit.own_frames().predict(&pair.moved);
    let normal = pair.seen.rotation.column(2).into_owned();
    let along: Vector3<f64> = sight_axes(&pair.seen).row(2).transpose();
    let other = 2.0 * normal.dot(&along) * along - normal;
    let turned = rotation::shortest_arc(&normal, &other) * pair.seen.rotation;
    let off = |seen: &nalgebra::Matrix3<f64>| rotation::log(&(seen * predicted.rotation.transpose())).norm();
    let (as_read, as_other) = (off(&pair.seen.rotation), off(&turned));
    as_read > 0.1 && as_other < 0.35 * as_read
}

fn say_outliers(outliers: &[HandEyeOutlier], name: &dyn Fn(usize) -> String, findings: &mut Vec<Finding>) {
    let rows = |flipped: bool| -> Vec<usize> {
        outliers.iter().filter(|it| it.is_flipped == flipped).map(|it| it.row).collect()
    };
    let (flipped, others) = (rows(true), rows(false));
    let verb = |count: usize| if count == 1 { "is" } else { "are" };
    if !flipped.is_empty() {
        let statement = format!(
            "{} {} flipped: a flat board seen from its other side would look the same; left out; take the other solution (OpenCV: solvePnPGeneric with \
             SOLVEPNP_IPPE), or tilt the board further",
            list_rows(&flipped, name),
            verb(flipped.len())
        );
        findings.push(Finding::new(FindingKind::Flipped, statement, flipped));
    }
    if !others.is_empty() {
        let worst = outliers.iter().filter(|it| !it.is_flipped).max_by(|a, b| a.shift_m.total_cmp(&b.shift_m));
        let size = worst.map_or(String::new(), |it| {
            format!(" (up to {:.1} mm and {:.2} deg)", 1e3 * it.shift_m, it.turn_rad.to_degrees())
        });
        let statement = format!(
            "{} contradict{} all others{size} and {} left out: look at these pictures and poses",
            list_rows(&others, name),
            if others.len() == 1 { "s" } else { "" },
            verb(others.len())
        );
        findings.push(Finding::new(FindingKind::Outliers, statement, others));
    }
}

/// Errors of rows in five parts, each predicted by the others.
fn held_out(rows: &[PosePair], fit: &HandEyeFit) -> Option<HeldOutErrors> {
    let kept = fit.rows(rows);
    if kept.len() < 6 {
        return None;
    }
    let folds = if kept.len() < 10 { kept.len() } else { 5 };
    let (mut squares_m, mut squares_rad) = (0.0, 0.0);
    for fold in 0..folds {
        let of = |held: bool| -> Vec<PosePair> {
            kept.iter().enumerate().filter(|(k, _)| (k % folds == fold) == held).map(|(_, it)| *it).collect()
        };
        let frames = fit.of_target(&fit.refit(&of(false))?);
        for pair in of(true) {
            let (shift, turn) = sizes(&errors(&pair, &frames));
            squares_m += shift * shift;
            squares_rad += turn * turn;
        }
    }
    let count = kept.len() as f64;
    Some(HeldOutErrors { rows: kept.len(), rms_m: (squares_m / count).sqrt(), rms_rad: (squares_rad / count).sqrt() })
}

fn root_mean_squares(rows: &[HandEyeRowError]) -> (f64, f64) {
    let fitted: Vec<&HandEyeRowError> = rows.iter().filter(|it| it.is_fitted).collect();
    let of = |size: &dyn Fn(&HandEyeRowError) -> f64| {
        (fitted.iter().map(|it| size(it).powi(2)).sum::<f64>() / fitted.len().max(1) as f64).sqrt()
    };
    (of(&|it| it.shift_m), of(&|it| it.turn_rad))
}
