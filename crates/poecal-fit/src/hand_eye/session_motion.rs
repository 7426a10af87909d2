//! Motion of the camera or the target during the session: frames of the rows before and after differ by more than noise.

use super::CameraMounting;
use super::bounds::{FrameSide, difference, frame_of_side};
use super::equations::{PosePair, errors};
use super::fit::{FEW_STARTS, HandEyeFit, sizes, start};
use super::noise::FrameCovariance;
use poecal_arm::lie::Pose;

/// Fewest rows of a part.
const PART: usize = 5;
/// Largest number of split points that are tried.
const PLACES: usize = 40;
/// Probability by chance, over all split points.
const CHANCE: f64 = 1e-3;

/// A move between two rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RelativeMotion {
    /// First row after it.
    pub(crate) from: usize,
    /// The frame that moved.
    pub(crate) side: FrameSide,
    pub(crate) shift_m: f64,
    pub(crate) turn_rad: f64,
}

/// The move in the rows, if there is one.
pub(crate) fn find_move(pairs: &[PosePair]) -> Option<RelativeMotion> {
    let count = pairs.len();
    // The ends of a long session are too short to be parts.
    let part = PART.max(count / 8);
    if count < 2 * part {
        return None;
    }
    let every = ((count - 2 * part) / PLACES + 1).max(1);
    let places = (part..=count - part).step_by(every);
    let scores = places.filter_map(|at| Some((score_rows(&pairs[..at])? + score_rows(&pairs[at..])?, at)));
    let (_, at) = scores.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?;
    let (first, second) = (HandEyeFit::from_pairs(&pairs[..at])?, HandEyeFit::from_pairs(&pairs[at..])?);
    let [before, after] = [(&first, &pairs[..at]), (&second, &pairs[at..])]
        .map(|(fit, rows)| FrameCovariance::from_pairs(&fit.noise, &fit.rows(&fit.seen_about(rows)), &fit.frames));
    let (before, after) = (before?, after?);
    let chance = CHANCE / (count / every) as f64;
    let ratio = |side: FrameSide| {
        let one = (&first.frames, &first.point, &before, &first.noise);
        difference(one, (&second.frames, &second.point, &after, &second.noise), side, chance)
    };
    let sides = [FrameSide::Camera, FrameSide::Target].map(|side| (ratio(side).unwrap_or(0.0), side));
    let (most, side) = if sides[0].0 > sides[1].0 { sides[0] } else { sides[1] };
    if most <= 1.0 {
        return None;
    }
    let pose = |fit: &HandEyeFit| frame_of_side(&fit.frames, &fit.point, side).0;
    let (shift_m, turn_rad) = Pose::distance_and_angle(&pose(&first), &pose(&second));
    Some(RelativeMotion { from: at, side, shift_m, turn_rad })
}

/// Score of rows by themselves: their number times the logarithms of their mean errors.
fn score_rows(pairs: &[PosePair]) -> Option<f64> {
    let frames = start(pairs, FEW_STARTS)?;
    let count = pairs.len() as f64;
    let sums =
        pairs.iter().map(|pair| sizes(&errors(pair, &frames))).fold((0.0, 0.0), |sum, it| (sum.0 + it.0, sum.1 + it.1));
    Some(count * ((sums.0 / count).max(1e-9).ln() + (sums.1 / count).max(1e-9).ln()))
}

/// The moved object, in words.
pub(crate) fn moved_object(side: FrameSide, camera: CameraMounting) -> &'static str {
    match (side, camera) {
        (FrameSide::Camera, CameraMounting::InHand) => "the camera on the flange",
        (FrameSide::Target, CameraMounting::InHand) => "the target",
        (FrameSide::Camera, CameraMounting::Beside) => "the camera",
        (FrameSide::Target, CameraMounting::Beside) => "the target on the flange",
    }
}
