//! Grids of squares: crossings of two edges, joined along the edges.

use std::collections::{BTreeMap, VecDeque};

use nalgebra::{Matrix2, Vector2};

use crate::gray::Gray;
use crate::growth::GridCorner;
use crate::normal::LANES;
use crate::vector::run_vectorized;

/// Corners of one grid, each with its column and row.
pub(crate) type CornerGrid = Vec<(GridCorner, Vector2<f64>)>;

/// Blurs before second derivatives are taken, pixels: for sharp pictures, and for dim or blurred ones.
pub(crate) const SCALES_PX: [f64; 2] = [1.8, 3.6];
/// Least strength of a crossing relative to that of noise.
const BESIDE_NOISE: f64 = 5.0;
/// Least strength of a crossing, gray levels, times the square of the blur.
const LEAST: f64 = 1.1;
/// Least ratio of the smaller curvature to the larger one: edges at an angle of 28°.
const NARROW: f64 = 0.06;
/// Farthest point of zero gradient from the strongest saddle, blurs.
const LEVEL: f64 = 0.8;
/// Radius at which edges are searched for, blurs.
const RING: f64 = 3.3;
/// Most crossings that are joined.
const MOST: usize = 8000;
/// Number of crossings above which only near ones are joined.
const MANY: usize = 2000;
/// Distance of the crossings that are tried first, pixels.
const NEAR_PX: f64 = 80.0;
/// Longest side of a square, as a part of the picture's longer side.
const LONGEST: f64 = 0.25;
/// Least cosine between an edge and the direction to the next corner, and between the edges of both.
const ALONG: f64 = 0.97;
const ALIKE: f64 = 0.90;

/// A crossing of two edges.
struct Cross {
    place: Vector2<f64>,
    strength: f64,
    /// Directions of both edges; the second is to the right of the first, and between them it is light.
    edges: [Vector2<f64>; 2],
    /// The next crossings along the first and the second edge, and against them.
    next: [Option<usize>; 4],
}

impl Cross {
    /// One of the four directions: along both edges, then against them.
    fn direction(&self, k: usize) -> Vector2<f64> {
        if k < 2 { self.edges[k] } else { -self.edges[k - 2] }
    }
}

/// Grids of squares in a picture, the largest first: x and y as on a board seen from the front.
pub(crate) fn grids(gray: &Gray, noise: f64, blur_px: f64) -> Vec<CornerGrid> {
    let smooth = gray.blur(blur_px, 2.6);
    // Noise has a standard deviation of `0.244 / σ³` of a pixel's in a second derivative.
    let least = (LEAST / blur_px.powi(2)).max(BESIDE_NOISE * 0.244 / blur_px.powi(3) * noise);
    let mut crosses = crosses(&smooth, least, blur_px);
    join(&smooth, &mut crosses);
    let mut free = vec![true; crosses.len()];
    let mut grids: Vec<CornerGrid> = Vec::new();
    for first in 0..crosses.len() {
        if free[first] && crosses[first].next.iter().flatten().count() >= 2 {
            grids.push(grid_from(&crosses, first, &mut free));
        }
    }
    grids.retain(|grid| grid.len() >= 4);
    grids.sort_by_key(|grid| std::cmp::Reverse(grid.len()));
    grids
}

/// Pixels to each side among which a saddle is the strongest.
const BESIDE: usize = 3;
/// Rows that are kept for that.
const KEPT: usize = 2 * BESIDE + 1;

/// Points whose second derivatives are those of a saddle, the strongest first.
fn crosses(smooth: &Gray, least: f64, blur_px: f64) -> Vec<Cross> {
    let mut found = run_vectorized(
        #[inline(always)]
        || peaks(smooth, least.powi(2) as f32, blur_px),
    );
    found.sort_by(|a, b| b.strength.total_cmp(&a.strength));
    found.truncate(MOST);
    found
}

/// The saddles, row by row.
#[inline(always)]
fn peaks(smooth: &Gray, least: f32, blur_px: f64) -> Vec<Cross> {
    let (width, height) = (smooth.width(), smooth.height());
    // The last rows of strengths in turn.
    let mut kept = vec![0.0_f32; KEPT * width];
    let mut found = Vec::new();
    for row in 0..height {
        let target = &mut kept[row % KEPT * width..(row % KEPT + 1) * width];
        if row < 2 || row + 2 >= height {
            target.fill(0.0);
        } else {
            strengths([row - 2, row - 1, row, row + 1, row + 2].map(|it| smooth.row(it)), target);
        }
        let middle = row.saturating_sub(BESIDE);
        if middle <= BESIDE || row + 1 >= height || width <= 2 * (BESIDE + 1) {
            continue;
        }
        let own = &kept[middle % KEPT * width..(middle % KEPT + 1) * width];
        let inner = &own[BESIDE + 1..width - BESIDE - 1];
        for (at, many) in inner.chunks(LANES).enumerate() {
            if !many.iter().fold(false, |any, it| any | (*it >= least)) {
                continue;
            }
            for (k, strength) in many.iter().enumerate() {
                let x = BESIDE + 1 + at * LANES + k;
                let is_largest = |levels: &[f32]| {
                    levels[x - BESIDE..=x + BESIDE].iter().fold(true, |all, it| all & (it <= strength))
                };
                if *strength >= least && is_largest(own) && kept.chunks_exact(width).all(is_largest) {
                    found.extend(cross_at(smooth, [x, middle], *strength, blur_px));
                }
            }
        }
    }
    found
}

/// Strength of the pixels of a row as saddles, by the surrounding rows.
#[inline(always)]
#[allow(clippy::needless_range_loop)]
fn strengths(rows: [&[f32]; 5], target: &mut [f32]) {
    let width = target.len();
    let rows = rows.map(|it| &it[..width]);
    for x in 2..width.saturating_sub(2) {
        let [xx, xy, yy] = second_derivatives(&rows, x);
        target[x] = xy * xy - xx * yy;
    }
}

/// Second derivatives by x twice, by both, and by y twice: differences of differences, so that a straight edge has none across itself.
#[inline(always)]
fn second_derivatives(rows: &[&[f32]; 5], x: usize) -> [f32; 3] {
    let middle = rows[2];
    let xx = middle[x - 2] + middle[x + 2] - 2.0 * middle[x];
    let xy = rows[1][x - 1] + rows[3][x + 1] - rows[1][x + 1] - rows[3][x - 1];
    let yy = rows[0][x] + rows[4][x] - 2.0 * middle[x];
    [0.25 * xx, 0.25 * xy, 0.25 * yy]
}

/// A saddle with its edges.
fn cross_at(smooth: &Gray, [x, row]: [usize; 2], own: f32, blur_px: f64) -> Option<Cross> {
    let rows = [row - 2, row - 1, row, row + 1, row + 2].map(|it| smooth.row(it));
    let [xx, xy, yy] = second_derivatives(&rows, x).map(f64::from);
    let (middle, half) = (0.5 * (xx + yy), (0.25 * (xx - yy).powi(2) + xy * xy).sqrt());
    let (up, down) = (half + middle, half - middle);
    let is_saddle = up.min(down) > NARROW * up.max(down);
    if !is_saddle {
        return None;
    }
    // The gradient is zero at a saddle; on edges and at their ends it is not.
    let slope_x = 0.5 * f64::from(rows[2][x + 1] - rows[2][x - 1]);
    let slope_y = 0.5 * f64::from(rows[3][x] - rows[1][x]);
    let area = xx * yy - xy * xy;
    let off = Vector2::new(yy * slope_x - xy * slope_y, xx * slope_y - xy * slope_x) / area;
    if off.norm() > LEVEL * blur_px {
        return None;
    }
    let place = Vector2::new(x as f64, row as f64) - off;
    Some(Cross { place, strength: f64::from(own), edges: edges(smooth, place, RING * blur_px)?, next: [None; 4] })
}

/// Directions of the edges through a point: a ring around it changes between dark and light four times. Second derivatives contain them too, but
/// spread ink, or scattered light, biases those more.
fn edges(smooth: &Gray, place: Vector2<f64>, radius_px: f64) -> Option<[Vector2<f64>; 2]> {
    const POINTS: usize = 32;
    let direction = |k: f64| {
        let (sin, cos) = (k / POINTS as f64 * std::f64::consts::TAU).sin_cos();
        Vector2::new(cos, sin)
    };
    let mut levels = [0.0; POINTS];
    for (k, level) in levels.iter_mut().enumerate() {
        *level = smooth.level_at(place + direction(k as f64) * radius_px);
    }
    let limit =
        0.5 * (levels.iter().copied().fold(f64::INFINITY, f64::min) + levels.iter().copied().fold(0.0, f64::max));
    let mut changes = [(0.0, false); 4];
    let mut count = 0;
    for (k, level) in levels.iter().enumerate() {
        let next = levels[(k + 1) % POINTS];
        if (*level < limit) != (next < limit) {
            let change = changes.get_mut(count)?;
            *change = (k as f64 + (limit - level) / (next - level), next >= limit);
            count += 1;
        }
    }
    if count != 4 {
        return None;
    }
    // Each edge goes through the middle: the directions of its two ends are opposite.
    let edge = |k: usize| (direction(changes[k].0) - direction(changes[k + 2].0)).try_normalize(1.0);
    let (one, other) = (edge(0)?, edge(1)?);
    // Clockwise behind the first edge it becomes light.
    Some(if changes[0].1 { [one, other] } else { [other, -one] })
}

/// Joins each crossing with the nearest ones along its edges, if both choose each other.
fn join(smooth: &Gray, crosses: &mut [Cross]) {
    let size = smooth.width().max(smooth.height()) as f64;
    let longest = if crosses.len() > MANY { 3.0 * NEAR_PX } else { LONGEST * size };
    let cells = CellIndex::new(crosses);
    let nearest: Vec<[Option<usize>; 4]> = (0..crosses.len())
        .map(|own| {
            let mut found = [None; 4];
            neighbours(smooth, crosses, own, &cells.find_near(crosses[own].place, NEAR_PX), &mut found);
            if found.contains(&None) {
                neighbours(smooth, crosses, own, &cells.find_near(crosses[own].place, longest), &mut found);
            }
            found
        })
        .collect();
    for own in 0..crosses.len() {
        for k in 0..4 {
            let other = nearest[own][k].filter(|other| nearest[*other].contains(&Some(own)));
            crosses[own].next[k] = other;
        }
    }
}

/// Crossings by the cell of the picture that contains them.
struct CellIndex(BTreeMap<(i32, i32), Vec<usize>>);

impl CellIndex {
    fn new(crosses: &[Cross]) -> Self {
        let mut cells: BTreeMap<_, Vec<usize>> = BTreeMap::new();
        for (at, cross) in crosses.iter().enumerate() {
            cells.entry(CellIndex::cell(cross.place)).or_default().push(at);
        }
        CellIndex(cells)
    }

    fn cell(place: Vector2<f64>) -> (i32, i32) {
        ((place.x / NEAR_PX) as i32, (place.y / NEAR_PX) as i32)
    }

    /// Crossings within a distance of a point.
    fn find_near(&self, place: Vector2<f64>, reach_px: f64) -> Vec<usize> {
        let (x, y) = CellIndex::cell(place);
        let reach = (reach_px / NEAR_PX).ceil() as i32;
        let columns = (x - reach)..=(x + reach);
        let cells = columns.flat_map(|x| self.0.range((x, y - reach)..=(x, y + reach)));
        cells.flat_map(|it| it.1.iter().copied()).collect()
    }
}

/// The nearest crossings along the edges of one, in the directions without a neighbour.
fn neighbours(smooth: &Gray, crosses: &[Cross], own: usize, candidates: &[usize], found: &mut [Option<usize>; 4]) {
    let from = &crosses[own];
    let mut near: [Vec<(f64, usize)>; 4] = Default::default();
    for at in candidates.iter().copied() {
        let way = crosses[at].place - from.place;
        let length = way.norm();
        if at == own || length < 6.0 {
            continue;
        }
        // A near corner may be off its edge by some pixels.
        let straight = (ALONG * length).min((length * length - 9.0).max(0.0).sqrt());
        for (k, list) in near.iter_mut().enumerate() {
            if from.direction(k).dot(&way) > straight {
                list.push((length, at));
            }
        }
    }
    for (k, list) in near.iter_mut().enumerate() {
        if found[k].is_some() {
            continue;
        }
        list.sort_by(|a, b| a.0.total_cmp(&b.0));
        let next = list.iter().take(6).map(|it| it.1).find(|at| is_next(smooth, from, &crosses[*at]));
        found[k] = next;
    }
}

/// True if two crossings are the ends of one edge: dark on the same side all along, and light and dark exchanged beyond.
fn is_next(smooth: &Gray, from: &Cross, to: &Cross) -> bool {
    let way = (to.place - from.place).normalize();
    let which = |cross: &Cross| {
        let along = [0, 1].map(|k| cross.edges[k].dot(&way).abs());
        (usize::from(along[1] > along[0]), along[0].max(along[1]))
    };
    let ((own, _), (other, along)) = (which(from), which(to));
    // The first edge of a corner is the second one of the next.
    if own == other || along < ALIKE {
        return false;
    }
    let similar = from.strength / to.strength;
    if !(0.04..25.0).contains(&similar) {
        return false;
    }
    let across = Vector2::new(-way.y, way.x);
    let length = (to.place - from.place).norm();
    let beside = across * (0.18 * length).clamp(2.5, 6.0);
    let steps = [0.25, 0.4, 0.5, 0.6, 0.75].map(|part| {
        let at = from.place + (to.place - from.place) * part;
        smooth.level_at(at + beside) - smooth.level_at(at - beside)
    });
    let least = steps.iter().map(|it| it.abs()).fold(f64::INFINITY, f64::min);
    let most = steps.iter().map(|it| it.abs()).fold(0.0, f64::max);
    let one_sided = steps.iter().all(|it| *it > 0.0) || steps.iter().all(|it| *it < 0.0);
    one_sided && least > 0.35 * most && least > 2.0
}

/// All crossings that are joined with one, with columns and rows.
fn grid_from(crosses: &[Cross], first: usize, free: &mut [bool]) -> CornerGrid {
    // Axes x and y of the grid at each crossing.
    let mut frames: BTreeMap<usize, (GridCorner, [Vector2<f64>; 2])> = BTreeMap::new();
    let mut taken: BTreeMap<GridCorner, usize> = BTreeMap::new();
    let [a, b] = crosses[first].edges;
    frames.insert(first, ([0, 0], [a, b]));
    taken.insert([0, 0], first);
    free[first] = false;
    let mut queue = VecDeque::from([first]);
    while let Some(own) = queue.pop_front() {
        let Some((node, [x, y])) = frames.get(&own).copied() else { continue };
        for (k, other) in crosses[own].next.iter().enumerate() {
            let Some(other) = other.filter(|it| free[*it]) else { continue };
            let way = crosses[own].direction(k);
            let (along, across) = (way.dot(&x), way.dot(&y));
            let step =
                if along.abs() > across.abs() { [along.signum() as i32, 0] } else { [0, across.signum() as i32] };
            let place = [node[0] + step[0], node[1] + step[1]];
            if taken.contains_key(&place) {
                continue;
            }
            taken.insert(place, other);
            frames.insert(other, (place, [nearest_axis(&crosses[other], x), nearest_axis(&crosses[other], y)]));
            free[other] = false;
            queue.push_back(other);
        }
    }
    taken.into_iter().map(|(node, at)| (node, crosses[at].place)).collect()
}

/// The direction of an edge that is nearest to another one.
fn nearest_axis(cross: &Cross, axis: Vector2<f64>) -> Vector2<f64> {
    let mut best = cross.direction(0);
    for k in 1..4 {
        if cross.direction(k).dot(&axis) > best.dot(&axis) {
            best = cross.direction(k);
        }
    }
    best
}

/// The affine map of a whole grid, pixels per square.
pub(crate) fn middle_slope(grid: &CornerGrid) -> Option<Matrix2<f64>> {
    let count = grid.len() as f64;
    let at = |node: GridCorner| Vector2::new(f64::from(node[0]), f64::from(node[1]));
    let plane = grid.iter().map(|it| at(it.0)).sum::<Vector2<f64>>() / count;
    let picture = grid.iter().map(|it| it.1).sum::<Vector2<f64>>() / count;
    let (mut spread, mut both) = (Matrix2::zeros(), Matrix2::zeros());
    for (node, place) in grid {
        let off = at(*node) - plane;
        spread += off * off.transpose();
        both += (place - picture) * off.transpose();
    }
    Some(both * spread.try_inverse()?)
}
