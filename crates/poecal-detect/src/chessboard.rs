//! Plain chessboards: a grid of the right size, with both ends of both sides seen.

use crate::detection::{DetectedBoard, RejectionReason, board_from_growth};
use crate::gray::Gray;
use crate::grid::{CornerGrid, SCALES_PX, grids, middle_slope};
use crate::growth::{BoardGrowth, GridCorner, place_of};
use crate::layout::BoardLayout;

/// Fewest corners from which a grid starts.
const LEAST: usize = 6;
/// Most grids that are tried.
const GRIDS: usize = 6;

/// Finds a chessboard whose corners reach over all its columns and rows.
pub(crate) fn detect(gray: &Gray, layout: &BoardLayout, noise: f64) -> Result<DetectedBoard, RejectionReason> {
    let mut most = 0;
    let mut reason = RejectionReason::NoBoard;
    let of_scale = |blur_px: &f64| grids(gray, noise, *blur_px).into_iter();
    for grid in SCALES_PX.iter().flat_map(|it| of_scale(it).filter(|it| it.len() >= LEAST).take(GRIDS)) {
        if is_larger(layout, grid.iter().map(|it| it.0), 1) {
            reason = RejectionReason::Other;
            continue;
        }
        let Some(growth) = grow_from_grid(gray, layout, noise, &grid) else { continue };
        match name_corners(gray, layout, noise, &growth) {
            Ok(board) => return Ok(board),
            Err(other) if growth.nodes.len() > most => {
                most = growth.nodes.len();
                reason = other;
            }
            Err(_) => {}
        }
    }
    Err(reason)
}

/// All corners around a grid, up to one more than the board has on each side.
fn grow_from_grid<'a>(gray: &'a Gray, layout: &BoardLayout, noise: f64, grid: &CornerGrid) -> Option<BoardGrowth<'a>> {
    let seeded = |first_dark: bool| {
        let mut growth = BoardGrowth::new(gray, noise, layout.plain_reach(), first_dark);
        for (node, place) in grid {
            let Some(slope) = slope_at(grid, *node) else { continue };
            growth.seed(*node, *place, slope);
        }
        growth
    };
    let [one, other] = [seeded(true), seeded(false)];
    let mut growth = if one.nodes.len() >= other.nodes.len() { one } else { other };
    if growth.nodes.len() < LEAST {
        return None;
    }
    growth.prune();
    let longest = layout.inner_corners().into_iter().max()? as i32;
    let [low, high] = extent(growth.nodes.keys().copied())?;
    let span = |k: usize| {
        let more = (longest - (high[k] - low[k])).max(1);
        low[k] - more..=high[k] + more
    };
    let candidates: Vec<GridCorner> = span(1).flat_map(|y| span(0).map(move |x| [x, y])).collect();
    growth.grow(&candidates);
    growth.prune();
    peel(layout, &mut growth);
    Some(growth)
}

/// Removes single corners beyond the board if it has full lines within: background may look like a corner.
fn peel(layout: &BoardLayout, growth: &mut BoardGrowth<'_>) {
    while is_larger(layout, growth.nodes.keys().copied(), 0) {
        let Some([low, high]) = extent(growth.nodes.keys().copied()) else { return };
        let lines = [(0, low[0]), (0, high[0]), (1, low[1]), (1, high[1])];
        let count = |(k, at): (usize, i32)| growth.nodes.keys().filter(|node| node[k] == at).count();
        let Some(line) = lines.into_iter().min_by_key(|line| count(*line)) else { return };
        let across = (high[1 - line.0] - low[1 - line.0] + 1) as usize;
        if count(line) * 4 > across {
            return;
        }
        growth.nodes.retain(|node, _| node[line.0] != line.1);
    }
}

/// The slope at a corner of a grid, from its neighbours, or that of the whole grid.
fn slope_at(grid: &CornerGrid, node: GridCorner) -> Option<nalgebra::Matrix2<f64>> {
    let near: CornerGrid = grid
        .iter()
        .filter(|(other, _)| (other[0] - node[0]).abs() <= 1 && (other[1] - node[1]).abs() <= 1)
        .copied()
        .collect();
    middle_slope(&near).or_else(|| middle_slope(grid))
}

/// First and last columns and rows with corners.
fn extent(nodes: impl Iterator<Item = GridCorner>) -> Option<[GridCorner; 2]> {
    nodes.fold(None, |found, node| {
        let [low, high] = found.unwrap_or([node, node]);
        Some([[0, 1].map(|k| low[k].min(node[k])), [0, 1].map(|k| high[k].max(node[k]))])
    })
}

/// True if corners reach farther than those of the board, and some more.
fn is_larger(layout: &BoardLayout, nodes: impl Iterator<Item = GridCorner>, more: usize) -> bool {
    let [columns, rows] = layout.inner_corners();
    extent(nodes).is_some_and(|[low, high]| {
        let size = [0, 1].map(|k| (high[k] - low[k] + 1) as usize);
        size[0].min(size[1]) > columns.min(rows) + more || size[0].max(size[1]) > columns.max(rows) + more
    })
}

/// The board with its names, if the corners reach over all of it.
fn name_corners(
    gray: &Gray,
    layout: &BoardLayout,
    noise: f64,
    growth: &BoardGrowth<'_>,
) -> Result<DetectedBoard, RejectionReason> {
    let [low, high] = extent(growth.nodes.keys().copied()).ok_or(RejectionReason::NoBoard)?;
    let size = [0, 1].map(|k| (high[k] - low[k] + 1) as usize);
    let [columns, rows] = layout.inner_corners();
    let count = growth.nodes.len();
    if is_larger(layout, growth.nodes.keys().copied(), 0) {
        return Err(RejectionReason::Other);
    }
    if size != [columns, rows] && size != [rows, columns] || count * 2 < layout.corners() {
        return Err(RejectionReason::Few(count));
    }
    if !is_plain(gray, growth) {
        return Err(RejectionReason::Other);
    }
    if !has_rim(gray, growth, low, high) {
        return Err(RejectionReason::Few(count));
    }
    let turns = turns(layout, growth, low, high);
    let Some(turn) = turns.first() else { return Err(RejectionReason::Other) };
    let id = |node: GridCorner| {
        let [x, y] = turn_node(node, low, high, *turn);
        Some(y * columns + x)
    };
    Ok(DetectedBoard { turnable: turns.len() > 1, ..board_from_growth(growth, noise, id) })
}

/// Columns and rows from the first corner, of a board turned by this number of right angles.
fn turn_node(node: GridCorner, low: GridCorner, high: GridCorner, turn: usize) -> [usize; 2] {
    let [left, up] = [node[0] - low[0], node[1] - low[1]];
    let [right, down] = [high[0] - node[0], high[1] - node[1]];
    let place = match turn {
        0 => [left, up],
        1 => [up, right],
        2 => [right, down],
        _ => [down, left],
    };
    place.map(|it| it as usize)
}

/// Turns that map the grid onto the board with matching dark and light squares, the one with the first corner highest in the picture first.
fn turns(layout: &BoardLayout, growth: &BoardGrowth<'_>, low: GridCorner, high: GridCorner) -> Vec<usize> {
    let inner = layout.inner_corners();
    let fits = |turn: &usize| {
        let far = turn_node([high[0], high[1]], low, high, *turn);
        let near = turn_node([low[0], low[1]], low, high, *turn);
        let size = [0, 1].map(|k| far[k].max(near[k]) + 1);
        if size != inner {
            return false;
        }
        let Some(node) = growth.nodes.keys().next() else { return false };
        let [x, y] = turn_node(*node, low, high, *turn);
        // A quarter turn places another square before the corner: dark and light change.
        let dark = growth.dark_before(*node) != (*turn % 2 == 1);
        dark == layout.is_dark(x, y)
    };
    let mut found: Vec<usize> = (0..4).filter(fits).collect();
    if found.is_empty() {
        // A board that begins with a light square is equivalent.
        found = (0..4).filter(|turn| inner_size(low, high, *turn) == inner).collect();
    }
    let height = |turn: &usize| {
        let first = [[low[0], low[1]], [low[0], high[1]], [high[0], high[1]], [high[0], low[1]]];
        let corner = first.iter().find(|node| turn_node(**node, low, high, *turn) == [0, 0]);
        let map = corner.and_then(|node| growth.map_near(place_of(*node)).map(|it| (it.0, place_of(*node))));
        map.and_then(|(map, at)| map.map(at)).map_or(f64::INFINITY, |it| it.x + it.y)
    };
    found.sort_by(|a, b| height(a).total_cmp(&height(b)));
    found
}

fn inner_size(low: GridCorner, high: GridCorner, turn: usize) -> [usize; 2] {
    let size = [0, 1].map(|k| (high[k] - low[k] + 1) as usize);
    if turn.is_multiple_of(2) { size } else { [size[1], size[0]] }
}

/// Standard deviation of the levels across a light square, as a part of half the contrast, from which it is not plain.
const UNEVEN: f64 = 0.45;

/// True if the light squares are plain, unlike those of a board with markers.
fn is_plain(gray: &Gray, growth: &BoardGrowth<'_>) -> bool {
    let mut kinds = [0, 0];
    for (node, saddle) in &growth.nodes {
        let opposite = growth.nodes.get(&[node[0] + 1, node[1] + 1]);
        // The square after a corner has the shade of the one before it.
        let (Some(opposite), false) = (opposite, growth.dark_before(*node)) else { continue };
        let at = |part: f64| gray.level_at(saddle.place + (opposite.place - saddle.place) * part);
        let levels = [0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7, 0.75].map(at);
        let mean = levels.iter().sum::<f64>() / levels.len() as f64;
        let variance = levels.iter().map(|it| (it - mean).powi(2)).sum::<f64>() / levels.len() as f64;
        let spread = (variance - growth.noise * growth.noise).max(0.0).sqrt();
        kinds[usize::from(spread > UNEVEN * saddle.half_contrast.min(opposite.half_contrast))] += 1;
    }
    kinds[1] * 2 <= kinds[0]
}

/// True if the outermost squares of all four sides are visible, as wide as the others, dark and light in turn. A field of tiles is cut off anywhere,
/// and a larger board may continue outside the picture.
fn has_rim(gray: &Gray, growth: &BoardGrowth<'_>, low: GridCorner, high: GridCorner) -> bool {
    let sides = [(0, low[0], -1.0), (0, high[0], 1.0), (1, low[1], -1.0), (1, high[1], 1.0)];
    sides.into_iter().all(|(k, line, way)| {
        let mut kinds = [0, 0];
        for node in growth.nodes.keys().filter(|node| node[k] == line) {
            if let Some(right) = is_rim(gray, growth, *node, k, way) {
                kinds[usize::from(right)] += 1;
            }
        }
        kinds[1] >= 2 && kinds[1] >= 3 * kinds[0]
    })
}

/// True if the squares beyond an outermost corner continue to [`RIM`]; `None` outside the picture.
fn is_rim(gray: &Gray, growth: &BoardGrowth<'_>, node: GridCorner, k: usize, way: f64) -> Option<bool> {
    let (map, _) = growth.map_near(place_of(node))?;
    // In the square before the corner and in the one after it, along the side.
    let level = |beside: f64| {
        let mut sum = 0.0;
        // Several samples, against noise.
        for (aside, out) in [(-0.2, RIM), (0.0, RIM), (0.2, RIM), (-0.1, RIM - 0.15), (0.1, RIM - 0.15)] {
            let mut off = nalgebra::Vector2::new(beside + aside, beside + aside);
            off[k] = way * out;
            let place = map.map(place_of(node) + off).filter(|it| gray.holds(*it, 1.0))?;
            sum += gray.level_at(place) / 5.0;
        }
        Some(sum)
    };
    let rise = level(0.5)? - level(-0.5)?;
    // The shade before the corner is that of the square before it, beyond the corner the opposite.
    let is_dark = growth.dark_before(node) == (way < 0.0);
    Some(if is_dark { rise } else { -rise } > growth.nodes.get(&node)?.half_contrast)
}

/// Distance from the outermost corners at which the outermost squares are examined, squares.
const RIM: f64 = 0.8;

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;

    #[test]
    fn turns_keep_the_hand() {
        // x to the right and y down are preserved: the corner after the first along x, and the one along y, are a right turn apart.
        let (low, high) = ([2, 3], [5, 4]);
        for turn in 0..4 {
            let all: Vec<(GridCorner, [usize; 2])> = (3..=4)
                .flat_map(|y| (2..=5).map(move |x| [x, y]))
                .map(|node| (node, turn_node(node, low, high, turn)))
                .collect();
            let at = |place: [usize; 2]| {
                let node = all.iter().find(|it| it.1 == place).unwrap().0;
                Vector2::new(node[0], node[1])
            };
            let (x, y) = (at([1, 0]) - at([0, 0]), at([0, 1]) - at([0, 0]));
            assert_eq!(x.x * y.y - x.y * y.x, 1, "{turn}");
        }
    }
}
