//! ChArUco boards: markers first, corners from them.

use nalgebra::Vector2;

use crate::found::{Found, Rejected, found};
use crate::gray::Gray;
use crate::grid::{Grid, SCALES_PX, grids};
use crate::growth::{Growth, Node};
use crate::homography::{Homography, Pair};
use crate::layout::Layout;
use crate::markers::{Marker, Reader};
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
pub(crate) fn detect(gray: &Gray, layout: &Layout, reader: &Reader, noise: f64) -> Result<Found, Rejected> {
    let first = of_quads(gray, layout, reader, noise, &quads(gray, noise));
    if first.is_ok() || matches!(first, Err(Rejected::Other)) {
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
        if matches!(best, Err(Rejected::NoBoard)) {
            best = other;
        }
    }
    best
}

/// Finds a board by the markers in quadrangles.
pub(crate) fn of_quads(
    gray: &Gray,
    layout: &Layout,
    reader: &Reader,
    noise: f64,
    quads: &[Quad],
) -> Result<Found, Rejected> {
    let markers: Vec<Marker> = quads.iter().filter_map(|quad| reader.read(gray, quad)).collect();
    of_markers(gray, layout, reader, noise, &markers)
}

/// Markers in the light squares of a grid.
fn markers_of_grid(gray: &Gray, layout: &Layout, reader: &Reader, grid: &Grid) -> Vec<Marker> {
    let side = layout.markers.as_ref().map_or(0.5, |it| it.1);
    let at = |node: Node| grid.iter().find(|it| it.0 == node).map(|it| it.1);
    let cell = |node: &Node| -> Option<Marker> {
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
    layout: &Layout,
    reader: &Reader,
    noise: f64,
    markers: &[Marker],
) -> Result<Found, Rejected> {
    let (map, agreeing) = consensus(layout, markers).ok_or(Rejected::NoBoard)?;
    let others = markers.len() - agreeing.len() - strangers_outside(layout, &map, markers, &agreeing);
    if others * DOUBT > agreeing.len() {
        return Err(Rejected::Other);
    }
    let mut growth = Growth::new(gray, noise, layout.plain(), layout.first_dark);
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
        return Err(Rejected::NoBoard);
    }
    if growth.nodes.len() < LEAST_CORNERS {
        return Err(Rejected::Few(growth.nodes.len()));
    }
    let Again { right, wrong, unread } = read_again(gray, layout, reader, &growth);
    if wrong * DOUBT > right || !is_marker_side(layout, &growth, markers, &agreeing) {
        return Err(Rejected::Other);
    }
    // Another board with the same markers agrees in a few. In a blurred one no other marker may be left to contradict, but not all corners of this
    // board are present.
    let markers = right.max(agreeing.len());
    let is_doubtful = growth.nodes.len() < nodes.len() && markers * READ < right + unread;
    if markers < LEAST_MARKERS || is_doubtful {
        return Err(Rejected::Few(growth.nodes.len()));
    }
    let [columns, _] = layout.inner();
    let id = |[x, y]: Node| Some((y - 1) as usize * columns + (x - 1) as usize);
    Ok(Found { markers, ..found(&growth, noise, id) })
}

fn nodes_of(layout: &Layout) -> Vec<Node> {
    let [columns, rows] = layout.squares.map(|it| it as i32);
    (1..rows).flat_map(|y| (1..columns).map(move |x| [x, y])).collect()
}

/// The markers, by their indices in the list, that one map of the board explains, and the map: from a pair of them, or from the only one.
pub(crate) fn consensus(layout: &Layout, markers: &[Marker]) -> Option<(Homography, Vec<usize>)> {
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
        let pairs: Vec<Pair> = [a, b]
            .iter()
            .flat_map(|at| known[*at].1.into_iter().zip(known[*at].2).map(|(p, q)| (p, q, 1.0)))
            .collect();
        let Some(map) = Homography::fit(&pairs) else { continue };
        let near = (known[a].1[0] + known[b].1[0]) * 0.5;
        let agreeing: Vec<usize> =
            known.iter().filter(|it| agrees(&map, &it.1, &it.2, near)).map(|it| it.0).collect();
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
fn strangers_outside(layout: &Layout, map: &Homography, markers: &[Marker], agreeing: &[usize]) -> usize {
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
struct Again {
    right: usize,
    wrong: usize,
    unread: usize,
}

fn read_again(gray: &Gray, layout: &Layout, reader: &Reader, growth: &Growth<'_>) -> Again {
    let mut again = Again { right: 0, wrong: 0, unread: 0 };
    for id in 0..layout.marker_count() {
        let Some(quad) = predicted(layout, growth, id) else { continue };
        if !quad.iter().all(|it| gray.holds(*it, 0.0)) {
            continue;
        }
        match reader.read(gray, &quad) {
            Some(marker) if marker.id == id && (marker.corners[0] - quad[0]).norm() < 1e-9 => {
                again.right += 1
            }
            Some(_) => again.wrong += 1,
            None => again.unread += 1,
        }
    }
    again
}

fn predicted(layout: &Layout, growth: &Growth<'_>, id: usize) -> Option<Quad> {
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
fn is_marker_side(layout: &Layout, growth: &Growth<'_>, markers: &[Marker], agreeing: &[usize]) -> bool {
    let diagonals = |quad: &Quad| (quad[2] - quad[0]).norm() + (quad[3] - quad[1]).norm();
    let parts = agreeing.iter().filter_map(|at| {
        let marker = markers.get(*at)?;
        Some(diagonals(&marker.corners) / diagonals(&predicted(layout, growth, marker.id)?))
    });
    median(parts).is_none_or(|it| (it - 1.0).abs() < SIDE)
}
