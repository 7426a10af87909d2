//! ChArUco boards: markers first, corners from them.

use nalgebra::Vector2;

use crate::detection::{DetectedBoard, RejectionReason, board_from_growth};
use crate::gray::Gray;
use crate::grid::{CornerGrid, SCALES_PX, grids};
use crate::growth::{BoardGrowth, GridCorner};
use crate::homography::{Homography, PointPair};
use crate::layout::BoardLayout;
use crate::markers::{DetectedMarker, MarkerReader};
use crate::median::median;
use crate::quads::{Quad, quads};

/// Fewest corners and markers that form a board.
const LEAST_CORNERS: usize = 4;
const LEAST_MARKERS: usize = 2;
/// Number of corners that suffices without the corners of markers.
const ENOUGH: usize = 9;
/// Number of markers that must agree for each one on the board that does not. With a board of the other pattern six of seven agree, shifted by one
/// square.
const DOUBT: usize = 12;
/// Least share of the markers among the detected corners that must be read, as one in this number, unless the whole board is found.
const READ: usize = 3;
/// Weight of a corner of a marker relative to a corner of squares: its error is five times as large.
const ANCHOR: f64 = 0.04;
/// Largest relative deviation of a marker's side from that of the board.
const SIDE: f64 = 0.12;

/// Finds a board by its markers; if they are too few, by the grid of its squares.
pub(crate) fn detect(
    gray: &Gray,
    layout: &BoardLayout,
    reader: &MarkerReader,
    noise: f64,
) -> Result<DetectedBoard, RejectionReason> {
    let first = of_quads(gray, layout, reader, noise, &quads(gray, noise));
    if first.is_ok() || matches!(first, Err(RejectionReason::Other)) {
        return first;
    }
    let mut best = first;
    for grid in SCALES_PX.iter().flat_map(|blur_px| grids(gray, noise, *blur_px).into_iter().take(4)) {
        let grid = &grid;
        let markers = markers_of_grid(gray, layout, reader, grid);
        let other = of_markers(gray, layout, reader, noise, &markers);
        if other.is_ok() {
            return other;
        }
        if matches!(best, Err(RejectionReason::NoBoard)) {
            best = other;
        }
    }
    best
}

/// Finds a board by the markers in quadrangles.
pub(crate) fn of_quads(
    gray: &Gray,
    layout: &BoardLayout,
    reader: &MarkerReader,
    noise: f64,
    quads: &[Quad],
) -> Result<DetectedBoard, RejectionReason> {
    let markers: Vec<DetectedMarker> = quads.iter().filter_map(|quad| reader.read(gray, quad)).collect();
    of_markers(gray, layout, reader, noise, &markers)
}

/// Markers in the light squares of a grid.
fn markers_of_grid(gray: &Gray, layout: &BoardLayout, reader: &MarkerReader, grid: &CornerGrid) -> Vec<DetectedMarker> {
    let side = layout.markers.as_ref().map_or(0.5, |it| it.1);
    let at = |node: GridCorner| grid.iter().find(|it| it.0 == node).map(|it| it.1);
    let cell = |node: &GridCorner| -> Option<DetectedMarker> {
        let [x, y] = *node;
        let corners = [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]];
        let mut places = [Vector2::zeros(); 4];
        for (place, corner) in places.iter_mut().zip(corners) {
            *place = at(corner)?;
        }
        let unit = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(Vector2::from);
        let map = Homography::of_corners(&unit, &places)?;
        let mut quad: Quad = places;
        for (corner, own) in quad.iter_mut().zip(unit) {
            *corner = map.map(own * side)?;
        }
        reader.read(gray, &quad)
    };
    grid.iter().filter_map(|(node, _)| cell(node)).collect()
}

fn of_markers(
    gray: &Gray,
    layout: &BoardLayout,
    reader: &MarkerReader,
    noise: f64,
    markers: &[DetectedMarker],
) -> Result<DetectedBoard, RejectionReason> {
    let (map, agreeing) = consensus(layout, markers).ok_or(RejectionReason::NoBoard)?;
    let others = markers.len() - agreeing.len() - strangers_outside(layout, &map, markers, &agreeing);
    if others * DOUBT > agreeing.len() {
        return Err(RejectionReason::Other);
    }
    let mut growth = BoardGrowth::new(gray, noise, layout.plain_reach(), layout.first_dark);
    for at in &agreeing {
        let marker = &markers[*at];
        let Some(corners) = layout.marker_corners(marker.id) else { continue };
        growth.anchors.extend(corners.into_iter().zip(marker.corners).map(|(a, b)| (a, b, ANCHOR)));
    }
    let nodes = nodes_of(layout);
    growth.grow(&nodes);
    if growth.nodes.len() >= ENOUGH {
        // Corners of squares are better, if they are numerous enough to check each other.
        growth.anchors.clear();
    }
    growth.prune();
    growth.grow(&nodes);
    growth.prune();
    if growth.nodes.is_empty() {
        return Err(RejectionReason::NoBoard);
    }
    if growth.nodes.len() < LEAST_CORNERS {
        return Err(RejectionReason::Few(growth.nodes.len()));
    }
    let MarkerRecheck { right, wrong, unread } = read_again(gray, layout, reader, &growth);
    if wrong * DOUBT > right || !is_marker_side(layout, &growth, markers, &agreeing) {
        return Err(RejectionReason::Other);
    }
    // Another board with the same markers agrees in a few. In a blurred one no other marker may be left to contradict, but not all corners of this
    // board are present.
    let markers = right.max(agreeing.len());
    let is_doubtful = growth.nodes.len() < nodes.len() && markers * READ < right + unread;
    if markers < LEAST_MARKERS || is_doubtful {
        return Err(RejectionReason::Few(growth.nodes.len()));
    }
    let [columns, _] = layout.inner_corners();
    let id = |[x, y]: GridCorner| Some((y - 1) as usize * columns + (x - 1) as usize);
    Ok(DetectedBoard { markers, ..board_from_growth(&growth, noise, id) })
}

fn nodes_of(layout: &BoardLayout) -> Vec<GridCorner> {
    let [columns, rows] = layout.squares.map(|it| it as i32);
    (1..rows).flat_map(|y| (1..columns).map(move |x| [x, y])).collect()
}

/// The markers, by their indices in the list, that one map of the board explains, and the map: from a pair of them, or from the only one.
pub(crate) fn consensus(layout: &BoardLayout, markers: &[DetectedMarker]) -> Option<(Homography, Vec<usize>)> {
    let known: Vec<(usize, [Vector2<f64>; 4], Quad)> = markers
        .iter()
        .enumerate()
        .filter(|(_, marker)| marker.id < layout.marker_count())
        .filter_map(|(at, marker)| Some((at, layout.marker_corners(marker.id)?, marker.corners)))
        .collect();
    let mut best: Option<(Homography, Vec<usize>)> = None;
    let count = known.len();
    // With many markers not every pair: some hundred suffice to include a good one.
    let step = (count * count / 800).max(1);
    let pairs = (0..count).flat_map(|a| (a..count).map(move |b| (a, b))).filter(|(a, b)| a != b || count < 3);
    for (a, b) in pairs.step_by(step) {
        let pairs: Vec<PointPair> =
            [a, b].iter().flat_map(|at| known[*at].1.into_iter().zip(known[*at].2).map(|(p, q)| (p, q, 1.0))).collect();
        let Some(map) = Homography::fit(&pairs) else { continue };
        let near = (known[a].1[0] + known[b].1[0]) * 0.5;
        let agreeing: Vec<usize> = known.iter().filter(|it| agrees(&map, &it.1, &it.2, near)).map(|it| it.0).collect();
        if !agreeing.is_empty() && best.as_ref().is_none_or(|it| it.1.len() < agreeing.len()) {
            best = Some((map, agreeing));
        }
    }
    best
}

/// True if a marker is at its predicted position, within the tolerance of the lens at this distance from the origin of the map.
fn agrees(map: &Homography, corners: &[Vector2<f64>; 4], seen: &Quad, near: Vector2<f64>) -> bool {
    let side = (seen[2] - seen[0]).norm().max((seen[3] - seen[1]).norm()) * 0.7;
    let limit = side * (0.25 + 0.08 * (corners[0] - near).norm());
    corners
        .iter()
        .zip(seen)
        .all(|(corner, place)| map.map(*corner).is_some_and(|predicted| (predicted - place).norm() < limit))
}

/// Number of disagreeing markers that are far from the board: they do not contradict it.
fn strangers_outside(layout: &BoardLayout, map: &Homography, markers: &[DetectedMarker], agreeing: &[usize]) -> usize {
    let [columns, rows] = layout.squares.map(|it| it as f64);
    let around = [[-1.0, -1.0], [columns + 1.0, -1.0], [columns + 1.0, rows + 1.0], [-1.0, rows + 1.0]];
    let outline: Vec<Vector2<f64>> = around.iter().filter_map(|it| map.map(Vector2::from(*it))).collect();
    let inside = |place: Vector2<f64>| {
        (0..outline.len()).all(|k| {
            let (a, b) = (outline[k], outline[(k + 1) % outline.len()]);
            let (side, off) = (b - a, place - a);
            side.x * off.y - side.y * off.x > 0.0
        })
    };
    let strangers = markers.iter().enumerate().filter(|(at, _)| !agreeing.contains(at));
    strangers.filter(|(_, marker)| !inside(marker.corners.iter().sum::<Vector2<f64>>() * 0.25)).count()
}

/// Counts of the markers at their predicted positions: right ones, wrong ones, and unreadable ones.
struct MarkerRecheck {
    right: usize,
    wrong: usize,
    unread: usize,
}

fn read_again(gray: &Gray, layout: &BoardLayout, reader: &MarkerReader, growth: &BoardGrowth<'_>) -> MarkerRecheck {
    let mut again = MarkerRecheck { right: 0, wrong: 0, unread: 0 };
    for id in 0..layout.marker_count() {
        let Some(quad) = predict_marker(layout, growth, id) else { continue };
        if !quad.iter().all(|it| gray.holds(*it, 0.0)) {
            continue;
        }
        match reader.read(gray, &quad) {
            Some(marker) if marker.id == id && (marker.corners[0] - quad[0]).norm() < 1e-9 => again.right += 1,
            Some(_) => again.wrong += 1,
            None => again.unread += 1,
        }
    }
    again
}

fn predict_marker(layout: &BoardLayout, growth: &BoardGrowth<'_>, id: usize) -> Option<Quad> {
    let corners = layout.marker_corners(id)?;
    let middle = (corners[0] + corners[2]) * 0.5;
    let (map, nearest) = growth.map_near(middle)?;
    if nearest > 0.8 {
        return None;
    }
    let mut quad = corners;
    for corner in &mut quad {
        *corner = map.map(*corner)?;
    }
    Some(quad)
}

/// True if the ratio of the markers to the squares is that of the board.
fn is_marker_side(
    layout: &BoardLayout,
    growth: &BoardGrowth<'_>,
    markers: &[DetectedMarker],
    agreeing: &[usize],
) -> bool {
    let diagonals = |quad: &Quad| (quad[2] - quad[0]).norm() + (quad[3] - quad[1]).norm();
    let parts = agreeing.iter().filter_map(|at| {
        let marker = markers.get(*at)?;
        Some(diagonals(&marker.corners) / diagonals(&predict_marker(layout, growth, marker.id)?))
    });
    median(parts).is_none_or(|it| (it - 1.0).abs() < SIDE)
}
