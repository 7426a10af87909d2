//! Dots joined to square lattices: the ellipse of a circle determines the tilt of its plane, and so the positions of its neighbours.

use std::collections::BTreeMap;

use nalgebra::{Matrix2, Vector2};

use crate::ellipse::Dot;
use crate::grid::middle_slope;
use crate::growth::GridCorner;
use crate::homography::{self, Homography, PointPair};
use crate::layout::BoardLayout;

/// Dots with their columns and rows.
pub(crate) type Lattice = BTreeMap<GridCorner, usize>;

/// Farthest neighbour, in radii of the dot.
const FARTHEST: f64 = 9.0;
/// Nearest neighbour, in radii: dots that touch have 2.
const NEAREST: f64 = 2.1;
/// Largest deviation of a dot from its prediction by others, as a part of the pitch.
const ASIDE: f64 = 0.22;
/// Largest ratio of the sizes of neighbours, and of their contrasts; and the ratios for dots that are not next to each other.
const ALIKE: [f64; 2] = [1.45, 1.8];
const ALIKE_FAR: [f64; 2] = [1.25, 1.35];
/// Standard deviation of the weights of dots by their distance, and the largest distance, pitches.
const REACH: [f64; 2] = [1.6, 4.2];

/// The next nodes of a lattice, and those beyond, if an occlusion covers a part of the board.
const STEPS: [GridCorner; 12] =
    [[1, 0], [0, 1], [-1, 0], [0, -1], [1, 1], [-1, 1], [-1, -1], [1, -1], [2, 0], [0, 2], [-2, 0], [0, -2]];

/// Lattices of dots, the largest first: x and y as on a board seen from the front.
pub(crate) fn lattices(dots: &[Dot]) -> Vec<Lattice> {
    let mut free = vec![true; dots.len()];
    let mut all: Vec<Lattice> = Vec::new();
    for first in 0..dots.len() {
        if !free[first] {
            continue;
        }
        let found = bases(dots, first).into_iter().map(|basis| flood_lattice(dots, first, basis));
        let Some(lattice) = found.max_by_key(Lattice::len) else { continue };
        if lattice.len() >= 6 {
            lattice.values().for_each(|at| free[*at] = false);
            all.push(lattice);
        }
    }
    all.sort_by_key(|it| std::cmp::Reverse(it.len()));
    all
}

fn are_similar_dots(a: &Dot, b: &Dot, [largest, strongest]: [f64; 2]) -> bool {
    let size = |it: &Dot| it.to_circle.determinant().sqrt();
    let (ratio, contrast) = (size(a) / size(b), a.half_contrast / b.half_contrast);
    ratio.max(1.0 / ratio) < largest && contrast.max(1.0 / contrast) < strongest
}

/// Steps of the lattice at a dot, pixels: to two equally distant neighbours at a right angle in the plane of the circle.
fn bases(dots: &[Dot], own: usize) -> Vec<Matrix2<f64>> {
    let dot = &dots[own];
    let mut near: Vec<(Vector2<f64>, Vector2<f64>)> = dots
        .iter()
        .enumerate()
        .filter(|(at, it)| *at != own && are_similar_dots(dot, it, ALIKE))
        .map(|(_, it)| (dot.to_circle * (it.place - dot.place), it.place - dot.place))
        .filter(|it| (NEAREST..FARTHEST).contains(&it.0.norm()))
        .collect();
    near.sort_by(|a, b| a.0.norm().total_cmp(&b.0.norm()));
    near.truncate(6);
    let mut found = Vec::new();
    for (k, a) in near.iter().enumerate() {
        for b in &near[k + 1..] {
            let (along, across) = (a.0.dot(&b.0), a.0.x * b.0.y - a.0.y * b.0.x);
            let product = a.0.norm() * b.0.norm();
            let ratio = b.0.norm() / a.0.norm();
            if along.abs() > 0.35 * product || !(0.7..1.43).contains(&ratio) {
                continue;
            }
            let (x, y) = if across > 0.0 { (a.1, b.1) } else { (b.1, a.1) };
            found.push(Matrix2::from_columns(&[x, y]));
        }
    }
    found.truncate(3);
    found
}

/// All dots that are joined with one.
fn flood_lattice(dots: &[Dot], first: usize, basis: Matrix2<f64>) -> Lattice {
    let mut lattice = Lattice::from([([0, 0], first)]);
    let mut places = vec![([0, 0], dots[first].place)];
    let mut taken = vec![false; dots.len()];
    taken[first] = true;
    let mut tried = 0;
    // Near steps from all nodes first.
    while tried < places.len() * 2 {
        let (far, at) = (tried >= places.len(), tried % places.len());
        tried += 1;
        let (before, node) = (places.len(), places[at].0);
        let steps = if far { &STEPS[4..] } else { &STEPS[..4] };
        for step in steps {
            join_dot(dots, &mut lattice, &mut places, &mut taken, (node, *step), &basis);
        }
        if far && places.len() > before {
            tried = before;
        }
    }
    lattice
}

/// Joins the dot that is a step from another one, if there is one.
fn join_dot(
    dots: &[Dot],
    lattice: &mut Lattice,
    places: &mut Vec<(GridCorner, Vector2<f64>)>,
    taken: &mut [bool],
    (node, step): (GridCorner, GridCorner),
    basis: &Matrix2<f64>,
) {
    let next = [node[0] + step[0], node[1] + step[1]];
    if lattice.contains_key(&next) {
        return;
    }
    let Some((place, pitch_px)) = predict_place(places, node, next, basis) else { return };
    let near = |other: usize| (dots[other].place - place).norm();
    let Some(own) = lattice.get(&node).map(|at| dots[*at]) else { return };
    let all = (0..dots.len()).filter(|other| !taken[*other] && near(*other) < ASIDE * pitch_px);
    let limits = if step[0].abs() + step[1].abs() > 1 { ALIKE_FAR } else { ALIKE };
    let best =
        all.filter(|other| are_similar_dots(&dots[*other], &own, limits)).min_by(|a, b| near(*a).total_cmp(&near(*b)));
    if let Some(other) = best {
        taken[other] = true;
        lattice.insert(next, other);
        places.push((next, dots[other].place));
    }
}

/// Position of a node beside another one, by the surrounding nodes, and the length of this step.
fn predict_place(
    places: &[(GridCorner, Vector2<f64>)],
    own: GridCorner,
    next: GridCorner,
    basis: &Matrix2<f64>,
) -> Option<(Vector2<f64>, f64)> {
    let near: Vec<(GridCorner, Vector2<f64>)> =
        places.iter().filter(|it| (it.0[0] - own[0]).abs() <= 2 && (it.0[1] - own[1]).abs() <= 2).copied().collect();
    let place = near.iter().find(|it| it.0 == own)?.1;
    let slope = if near.len() >= 3 { middle_slope(&near).unwrap_or(*basis) } else { *basis };
    let step = Vector2::new(f64::from(next[0] - own[0]), f64::from(next[1] - own[1]));
    let mut way = slope * step;
    // Two dots in a row predict better than the mean.
    let before = [2 * own[0] - next[0], 2 * own[1] - next[1]];
    if let Some((_, before)) = near.iter().find(|it| it.0 == before) {
        way = place - before;
    }
    Some((place + way, way.norm() / step.norm()))
}

/// The map near a point of a board of dots or tags.
pub(crate) fn map_near(pairs: &[PointPair], point: Vector2<f64>) -> Option<(Homography, f64)> {
    homography::map_near(pairs.iter().copied(), point, REACH)
}

/// Removes points of a board that contradict the prediction by the others, the worst first. `off` is the largest distance: pixels, and parts of the
/// unit.
pub(crate) fn prune<T>(
    layout: &BoardLayout,
    found: &mut BTreeMap<usize, T>,
    place: impl Fn(&T) -> Vector2<f64>,
    off: (f64, f64),
) {
    loop {
        let pairs: Vec<PointPair> = found.iter().map(|(id, it)| (layout.corner(*id), place(it), 1.0)).collect();
        let part = |(id, it): (&usize, &T)| {
            let point = layout.corner(*id);
            let part = map_near(&pairs, point).and_then(|(map, nearest)| {
                let unit_px = map.slope(point)?.determinant().abs().sqrt();
                Some((map.map(point)? - place(it)).norm() / ((off.0 + off.1 * unit_px) * nearest.max(1.0)))
            });
            (*id, part.unwrap_or(f64::INFINITY))
        };
        match found.iter().map(part).max_by(|a, b| a.1.total_cmp(&b.1)) {
            Some((worst, part)) if part > 1.0 => found.remove(&worst),
            _ => return,
        };
    }
}
