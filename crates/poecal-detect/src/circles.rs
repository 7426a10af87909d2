//! Grids of dots: their middles, corrected for the offset due to the tilt of a circle.

use nalgebra::{Matrix2, Vector2};

use crate::bias::bias;
use crate::board_completeness::is_whole;
use crate::dark_regions::{Blob, SmoothedPicture};
use crate::detection::{DetectedBoard, DetectedCorner, PointKind, RejectionReason};
use crate::ellipse::{self, Dot};
use crate::gray::Gray;
use crate::growth::GridCorner;
use crate::homography::PointPair;
use crate::lattice::{Lattice, lattices, map_near, prune};
use crate::layout::BoardLayout;
use crate::median::median;
use crate::numbered_dots::{NumberedDots, OFF, keep_round, pairs, radius, seek};

/// Candidate dots for each dot of the board, of which one picture may have more.
const FOR_EACH: usize = 3;
/// Most lattices that are tried.
const LATTICES: usize = 5;
/// Share of the dots that may lie beyond the board, as one in this number: other objects that look like dots.
const BEYOND: usize = 12;
/// Fewest pixels of a dot.
const FEWEST_PX: u32 = 12;
/// Difference of middles, pixels, and relative difference of shapes, up to which two candidates are the same.
const SAME: (f64, f64) = (0.3, 0.03);

/// Finds a grid of dots that reaches over all its columns and rows.
pub(crate) fn detect(
    gray: &Gray,
    layout: &BoardLayout,
    noise: f64,
    most: usize,
) -> Result<DetectedBoard, RejectionReason> {
    // The limit is at least a multiple of the board's own number of dots.
    let most = most.max(FOR_EACH * layout.corners());
    of_dots(gray, layout, noise, &dots(gray, noise, most)?)
}

/// Finds the grid among detected dots.
pub(crate) fn of_dots(
    gray: &Gray,
    layout: &BoardLayout,
    noise: f64,
    dots: &[Dot],
) -> Result<DetectedBoard, RejectionReason> {
    let (mut most, mut reason) = (0, RejectionReason::NoBoard);
    for lattice in lattices(dots).into_iter().take(LATTICES) {
        match name_dots(gray, layout, noise, dots, &lattice) {
            Ok(found) => return Ok(found),
            Err(other) if lattice.len() > most => (most, reason) = (lattice.len(), other),
            Err(_) => {}
        }
    }
    Err(reason)
}

/// Dark dots of any size, at most `most` candidates: each is compared with all others.
pub(crate) fn dots(gray: &Gray, noise: f64, most: usize) -> Result<Vec<Dot>, RejectionReason> {
    let shades = SmoothedPicture::new(gray, noise);
    let longest = gray.width().max(gray.height());
    let mut found: Vec<Dot> = Vec::new();
    // A candidate that is no dot appears in several windows, too.
    let mut refused: Vec<(Vector2<f64>, Matrix2<f64>)> = Vec::new();
    for half in [longest / 110, longest / 36, longest / 12].map(|it| it.max(7)) {
        for blob in shades.dark_parts(half).blobs(FEWEST_PX) {
            let Some(to_circle) = round(&blob) else { continue };
            let known = |it: &Dot| (it.to_circle * (it.place - blob.middle)).norm() < 0.5;
            let same = |it: &(Vector2<f64>, Matrix2<f64>)| {
                (it.0 - blob.middle).norm() < SAME.0 && (it.1 - to_circle).norm() < SAME.1 * to_circle.norm()
            };
            if found.iter().any(known) || refused.iter().any(same) {
                continue;
            }
            if found.len() + refused.len() >= most {
                return Err(RejectionReason::Many(most));
            }
            match ellipse::fit(gray, blob.middle, to_circle, noise) {
                Some(dot) => found.push(dot),
                None => refused.push((blob.middle, to_circle)),
            }
        }
    }
    Ok(found)
}

/// Matrix that maps a part of the picture to a circle, if it is nearly an ellipse.
fn round(blob: &Blob) -> Option<Matrix2<f64>> {
    // The area of the ellipse with the moments of the part.
    let area = 4.0 * std::f64::consts::PI * blob.spread.determinant().sqrt();
    let axes = blob.spread.symmetric_eigen();
    let (least, most) = (axes.eigenvalues.min(), axes.eigenvalues.max());
    let is_round = (0.85..1.15).contains(&(blob.area / area)) && most < 25.0 * least;
    if !is_round || least <= 0.0 {
        return None;
    }
    let scale = Matrix2::from_diagonal(&axes.eigenvalues.map(|it| 0.5 / it.sqrt()));
    Some(axes.eigenvectors * scale * axes.eigenvectors.transpose())
}

/// Column and row on the board of a node of a lattice that is turned by this number of right angles.
fn on_board(layout: &BoardLayout, node: GridCorner, turn: usize) -> GridCorner {
    let [u, v] = node;
    let [a, b] = match turn {
        0 => [u, v],
        1 => [v, -u],
        2 => [-u, -v],
        _ => [-v, u],
    };
    // The rows of an asymmetric grid are diagonals of its lattice.
    if layout.is_asymmetric() { [a - b, a + b] } else { [a, b] }
}

/// Dots by columns and rows, without single ones beyond the board.
fn peel_single_dots(layout: &BoardLayout, lattice: &Lattice, turn: usize) -> Vec<(GridCorner, usize)> {
    let mut nodes: Vec<(GridCorner, usize)> =
        lattice.iter().map(|(node, dot)| (on_board(layout, *node, turn), *dot)).collect();
    let size = layout.inner_corners();
    let least = nodes.len() - nodes.len() / BEYOND;
    while let Some([low, high]) = extent(&nodes) {
        let beyond = (0..2).filter(|k| (high[*k] - low[*k] + 1) as usize > size[*k]);
        let lines = beyond.flat_map(|k| [(k, low[k]), (k, high[k])]);
        let count = |(k, at): (usize, i32)| nodes.iter().filter(|it| it.0[k] == at).count();
        let Some((k, at)) = lines.min_by_key(|line| count(*line)) else { break };
        if count((k, at)) * 4 > size[1 - k] {
            break;
        }
        nodes.retain(|it| it.0[k] != at);
        if nodes.len() < least {
            break;
        }
    }
    nodes
}

fn extent(nodes: &[(GridCorner, usize)]) -> Option<[GridCorner; 2]> {
    let (first, _) = nodes.first()?;
    Some(nodes.iter().fold([*first, *first], |[low, high], (node, _)| {
        [[0, 1].map(|k| low[k].min(node[k])), [0, 1].map(|k| high[k].max(node[k]))]
    }))
}

/// The dots of a turned lattice with their numbers, if they extend over exactly the board.
fn number_dots(
    layout: &BoardLayout,
    dots: &[Dot],
    lattice: &Lattice,
    turn: usize,
) -> Result<NumberedDots, RejectionReason> {
    let nodes = peel_single_dots(layout, lattice, turn);
    let [low, high] = extent(&nodes).ok_or(RejectionReason::NoBoard)?;
    let (seen, size) = ([0, 1].map(|k| (high[k] - low[k] + 1) as usize), layout.inner_corners());
    if seen[0].min(seen[1]) > size[0].min(size[1]) || seen[0].max(seen[1]) > size[0].max(size[1]) {
        return Err(RejectionReason::Other);
    }
    if seen != size || nodes.len() * 5 < layout.corners() * 3 {
        return Err(RejectionReason::Few(nodes.len()));
    }
    let number = |node: GridCorner| layout.dot_at([0, 1].map(|k| (node[k] - low[k]) as usize));
    let all = nodes.iter().map(|(node, dot)| Some((number(*node)?, *dots.get(*dot)?)));
    all.collect::<Option<_>>().ok_or(RejectionReason::Other)
}

/// The board, if the lattice fits: among several fitting turns, the one whose first dot is farthest to the upper left.
fn name_dots(
    gray: &Gray,
    layout: &BoardLayout,
    noise: f64,
    dots: &[Dot],
    lattice: &Lattice,
) -> Result<DetectedBoard, RejectionReason> {
    let mut reason = RejectionReason::NoBoard;
    let mut fitting: Vec<(f64, NumberedDots)> = Vec::new();
    for turn in 0..4 {
        match number_dots(layout, dots, lattice, turn) {
            Ok(named) => {
                let first =
                    map_near(&pairs(layout, &named), layout.corner(0)).and_then(|it| it.0.map(layout.corner(0)));
                fitting.push((first.map_or(f64::INFINITY, |it| it.x + it.y), named));
            }
            Err(other) if matches!(reason, RejectionReason::NoBoard | RejectionReason::Few(_)) => reason = other,
            Err(_) => {}
        }
    }
    let turnable = fitting.len() > 1;
    let (_, mut named) = fitting.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).ok_or(reason)?;
    prune(layout, &mut named, |it| it.place, OFF);
    let radius = radius(layout, &named).ok_or(RejectionReason::NoBoard)?;
    keep_round(layout, &mut named, radius);
    seek(gray, layout, noise, &mut named, radius);
    keep_round(layout, &mut named, radius);
    prune(layout, &mut named, |it| it.place, OFF);
    if named.len() * 20 < layout.corners() * 13 || named.len() < 6 {
        return Err(RejectionReason::Few(named.len()));
    }
    if !is_whole(gray, layout, noise, &named, radius) {
        return Err(RejectionReason::Other);
    }
    let corners = correct_middles(layout, &named, radius);
    let blur_px = median(named.values().map(|it| it.blur_px)).unwrap_or(0.0);
    Ok(DetectedBoard { corners, markers: 0, turnable, blur_px, noise })
}

/// The middles of the circles: measured middles less the offset due to the tilt.
fn correct_middles(layout: &BoardLayout, named: &NumberedDots, radius: f64) -> Vec<DetectedCorner> {
    let measured = pairs(layout, named);
    let mut better = measured.clone();
    for _ in 0..2 {
        let moved = |(point, place, weight): &PointPair| {
            (*point, place - bias(&better, *point, radius).unwrap_or_default(), *weight)
        };
        better = measured.iter().map(moved).collect();
    }
    let corner = |((id, dot), (_, place, _)): ((&usize, &Dot), &PointPair)| DetectedCorner {
        id: *id,
        kind: PointKind::Dot,
        u_px: place.x,
        v_px: place.y,
        sigma_px: dot.sigma_px,
    };
    named.iter().zip(&better).map(corner).collect()
}
