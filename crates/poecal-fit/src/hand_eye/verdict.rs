//! Usability of the result, judged by the bounds of its frames and not by the accuracy of a tracker.

use super::findings::{Finding, FindingKind};
use super::scale::{self, NO_CAMERA};
use super::types::{HandEye, HandEyeLevel};
use poecal_model::camera::PictureNumber;

/// Number of rows from which on a result is tested well.
const ENOUGH: usize = 10;
/// Standard deviation of turns about the second axis, radians, that is enough: turns of 20 deg to both sides.
const TURNED: f64 = 0.17;
/// Share of outliers up to which a result is good, and up to which it is used.
const FEW: f64 = 0.2;
const MANY: f64 = 0.4;
/// Largest noise of positions that a camera has, as a share of the distance.
const NO_CAMERA_M: f64 = 0.06;
/// Bound of the camera's position, as a share of its distance from the target, up to which a result is good. Errors of its measurements are then no
/// larger than by a focal length with an error of 1 %.
const NEAR: f64 = 0.01;
/// Factor by which an unknown lens widens that bound, from which on it is reported.
const WIDER: f64 = 2.0;

/// Sets level and reasons, and adds findings of missing moves. `scale` is the ratio of the camera's lengths to the arm's.
pub(crate) fn judge(result: &mut HandEye, scale: Option<f64>, distance_m: f64) {
    let fitted = result.rows.iter().filter(|it| it.is_fitted).count();
    let outliers = result.outliers.len();
    let share = outliers as f64 / (fitted + outliers).max(1) as f64;
    let (mut against, mut weak) = (Vec::new(), Vec::new());
    if let Some(statement) = inconsistent(&result.noise, distance_m).filter(|_| scale.is_none()) {
        result.findings.push(Finding::new(FindingKind::Inconsistent, statement.clone(), Vec::new()));
        against.push(statement);
    }
    against.extend(find_statement(result, FindingKind::Exchanged));
    if share > MANY {
        against.push(format!("{outliers} of {} poses contradict the others", fitted + outliers));
    } else if share > FEW {
        weak.push(format!("{outliers} of {} poses were left out", fitted + outliers));
    }
    if let Some(statement) = scale.filter(|_| against.is_empty()).map(scale::words) {
        result.findings.push(Finding::new(FindingKind::Scale, statement.clone(), Vec::new()));
        against.push(statement);
    }
    if against.is_empty() {
        weak.extend(list_inaccuracies(result, distance_m));
    }
    if fitted < ENOUGH {
        weak.push(format!("{fitted} poses show little of their own errors: take 15 or more"));
    }
    let missing = missing_moves(result);
    weak.extend(missing.iter().cloned());
    result.findings.extend(missing.into_iter().map(|it| Finding::new(FindingKind::MissingMoves, it, Vec::new())));
    if result.findings.iter().any(|it| it.kind == FindingKind::Moved) {
        weak.push("something moved during the session".to_owned());
    }
    (result.level, result.reasons) = HandEyeLevel::from_reasons(against, weak);
}

/// Reason why poses with this noise (across, along, tilts, turn) do not fit together, if they do not.
pub(crate) fn inconsistent(of: &[f64; 4], distance_m: f64) -> Option<String> {
    let noise = of[2].max(of[3]);
    if noise > NO_CAMERA {
        return Some(format!(
            "the poses do not fit together: orientations are off by {:.1} deg, more than the noise of any camera; check that both lists are of the same \
             poses, their conventions of angles, and --camera",
            noise.to_degrees()
        ));
    }
    let places = of[0].max(of[1]);
    (places > (NO_CAMERA_M * distance_m).max(0.01)).then(|| {
        format!(
            "the poses do not fit together: places are off by {:.0} mm, more than the noise of any camera; check units, signs and origins of both lists",
            1e3 * places
        )
    })
}

/// Causes of an inaccurate camera position: an unknown lens, whose findings are added, and a wide bound.
fn list_inaccuracies(result: &mut HandEye, distance_m: f64) -> Vec<String> {
    let mut weak = of_lens(result);
    let bent = result.lens.as_ref().and_then(|lens| describe_bent_board(&lens.numbers));
    let of_lens = weak.iter().cloned().chain(bent).map(|it| Finding::new(FindingKind::Lens, it, Vec::new()));
    result.findings.extend(of_lens);
    let bound = result.camera_frame().bound95_m;
    if bound > NEAR * distance_m {
        weak.push(format!(
            "the camera's position is known to {:.1} mm, {:.1} % of the {distance_m:.2} m at which it sees the target (good: up to {:.0} %)",
            1e3 * bound,
            100.0 * bound / distance_m,
            100.0 * NEAR
        ));
    }
    weak
}

/// A board that is bent by more than its uncertainty; the estimate contains the bend.
fn describe_bent_board(numbers: &[PictureNumber]) -> Option<String> {
    const EVIDENT: f64 = 4.0;
    let bends = || numbers.iter().filter(|it| it.unit == "mm");
    let most = bends().max_by(|a, b| a.found.abs().total_cmp(&b.found.abs()))?;
    bends().any(|it| it.found.abs() > EVIDENT * it.deviation).then(|| {
        format!(
            "the board is bent by {:.2} mm from its middle to its edge, which was taken into account: mount it on a plate that is flat",
            most.found.abs()
        )
    })
}

/// Costs of an unknown lens, and disagreement of pictures and arm on it.
fn of_lens(result: &HandEye) -> Vec<String> {
    let Some(lens) = &result.lens else { return Vec::new() };
    let mut said = Vec::new();
    let focal = |numbers: &[PictureNumber]| numbers.first().map_or((0.0, 0.0), |it| (it.found, it.deviation));
    let (found, alone) = (focal(&lens.numbers), focal(&lens.alone));
    let remedy = "state the lens (--lens FILE), or fit the arm with the camera (poecal calibrate)";
    if lens.apart > 1.0 {
        said.push(format!(
            "the pictures alone show another lens (fx {:.1} px, {:.1} by noise) than they do with the arm's poses (fx {:.1} px), {:.1} times as far apart \
             as noise explains: bounds are so much wider by the lens; {remedy}",
            alone.0, alone.1, found.0, lens.apart
        ));
    }
    let bound = result.camera_frame().bound95_m;
    if bound > WIDER * lens.known_bound95_m {
        said.push(format!(
            "the pictures determine the lens to {:.1} px of {:.0} px of focal length only, and by that the camera's position to {:.1} mm (95 %), where a \
             known lens would leave {:.1} mm: {remedy}",
            found.1,
            found.0,
            1e3 * bound,
            1e3 * lens.known_bound95_m
        ));
    }
    said
}

/// Statement of a kind of finding, if there is one.
fn find_statement(result: &HandEye, kind: FindingKind) -> Option<String> {
    result.findings.iter().find(|it| it.kind == kind).map(|it| it.statement.clone())
}

/// Turns that would help.
fn missing_moves(result: &HandEye) -> Vec<String> {
    let [most, second, _] = result.turns.spread_rad;
    if second >= TURNED {
        return Vec::new();
    }
    let [first, other, _] = result.turns.directions;
    let axis = |it: &nalgebra::Vector3<f64>| {
        // Its largest component is positive.
        let sign = it[it.iamax()].signum();
        format!("({:.2} {:.2} {:.2})", sign * it.x + 0.0, sign * it.y + 0.0, sign * it.z + 0.0)
    };
    let words = if most < TURNED {
        format!(
            "the flange turned by {:.0} deg only (standard deviation): turn it by 20 deg and more about two axes across each other",
            most.to_degrees()
        )
    } else {
        format!(
            "the flange turned by {:.0} deg about its axis {}, and by {:.0} deg about others (standard deviations): turn about a second axis, as {}, by \
             20 deg and more",
            most.to_degrees(),
            axis(&first),
            second.to_degrees(),
            axis(&other)
        )
    };
    vec![words]
}
