//! Grids of dots: their middles, corrected by what the tilt of a circle moves the middle of its picture.

use std::collections::BTreeMap;

use nalgebra::{Matrix2, Vector2};

use crate::bias::bias;
use crate::ellipse::{self, Dot};
use crate::found::{Corner, Found, Kind, Rejected};
use crate::gray::Gray;
use crate::growth::Node;
use crate::homography::{Homography, Pair};
use crate::lattice::{Lattice, lattices, map_near, prune};
use crate::layout::Layout;
use crate::median::median;
use crate::parts::{Blob, Shades};

/// Dots by their numbers on the board.
type Named = BTreeMap<usize, Dot>;

/// Most lattices that are tried.
const LATTICES: usize = 5;
/// Largest distance of a dot from where its neighbours have it, pixels and parts of the unit.
const OFF: (f64, f64) = (0.8, 0.035);
/// Largest deviation of a dot's radius from that of the others, as a part and in pixels.
const ROUND: (f64, f64) = (0.08, 0.5);
/// One dot of so many may be beyond the board: something else that looks like one.
const BEYOND: usize = 12;
/// Largest misfit of a dot beside the median one, and beside the contrast: of more, something covers a part of it.
const COVERED: (f64, f64) = (4.0, 0.03);
/// Difference of middles, pixels, and of shapes, as a part, up to which two parts are one.
const SAME: (f64, f64) = (0.3, 0.03);
/// Least part of the outer dots that must be seen.
const OUTLINE: f64 = 0.55;
/// How far a missing dot may be from the nearest one that was found, units.
const NEAR: f64 = 2.1;
/// How far from its middle a missing dot is looked at, units; largest difference from the paper of what is bare, as a part of half the contrast; and
/// how many missing dots may be bare.
const INSIDE: f64 = 0.12;
const EVEN: f64 = 0.3;
const GAPS: usize = 2;
/// How far beyond the outer dots there is paper, from their middles, units.
const PAPER: f64 = 0.8;

/// Finds a grid of dots that reaches over all its columns and rows.
pub(crate) fn detect(gray: &Gray, layout: &Layout, noise: f64) -> Result<Found, Rejected> {
    of_dots(gray, layout, noise, &dots(gray, noise))
}

/// The same of dots that were found.
pub(crate) fn of_dots(gray: &Gray, layout: &Layout, noise: f64, dots: &[Dot]) -> Result<Found, Rejected> {
    let (mut most, mut reason) = (0, Rejected::NoBoard);
    for lattice in lattices(dots).into_iter().take(LATTICES) {
        match named(gray, layout, noise, dots, &lattice) {
            Ok(found) => return Ok(found),
            Err(other) if lattice.len() > most => (most, reason) = (lattice.len(), other),
            Err(_) => {}
        }
    }
    Err(reason)
}

/// Dark dots of any size.
pub(crate) fn dots(gray: &Gray, noise: f64) -> Vec<Dot> {
    let shades = Shades::new(gray, noise);
    let longest = gray.width().max(gray.height());
    let mut found: Vec<Dot> = Vec::new();
    // What is no dot is a part of several windows, too.
    let mut refused: Vec<(Vector2<f64>, Matrix2<f64>)> = Vec::new();
    for half in [longest / 110, longest / 36, longest / 12].map(|it| it.max(7)) {
        for blob in shades.dark_parts(half).blobs() {
            let Some(to_circle) = round(&blob) else { continue };
            let known = |it: &Dot| (it.to_circle * (it.place - blob.middle)).norm() < 0.5;
            let same = |it: &(Vector2<f64>, Matrix2<f64>)| {
                (it.0 - blob.middle).norm() < SAME.0 && (it.1 - to_circle).norm() < SAME.1 * to_circle.norm()
            };
            if found.iter().any(known) || refused.iter().any(same) {
                continue;
            }
            match ellipse::fit(gray, blob.middle, to_circle, noise) {
                Some(dot) => found.push(dot),
                None => refused.push((blob.middle, to_circle)),
            }
        }
    }
    found
}

/// What makes a circle of a part of the picture, if it is nearly an ellipse.
fn round(blob: &Blob) -> Option<Matrix2<f64>> {
    // The area of the ellipse with the moments of the part.
    let area = 4.0 * std::f64::consts::PI * blob.spread.determinant().sqrt();
    let axes = blob.spread.symmetric_eigen();
    let (least, most) = (axes.eigenvalues.min(), axes.eigenvalues.max());
    let is_round = blob.area >= 12.0 && (0.85..1.15).contains(&(blob.area / area)) && most < 25.0 * least;
    if !is_round || least <= 0.0 {
        return None;
    }
    let scale = Matrix2::from_diagonal(&axes.eigenvalues.map(|it| 0.5 / it.sqrt()));
    Some(axes.eigenvectors * scale * axes.eigenvectors.transpose())
}

/// Column and row on the board of a node of a lattice that is turned by so many right angles.
fn on_board(layout: &Layout, node: Node, turn: usize) -> Node {
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
fn peeled(layout: &Layout, lattice: &Lattice, turn: usize) -> Vec<(Node, usize)> {
    let mut nodes: Vec<(Node, usize)> =
        lattice.iter().map(|(node, dot)| (on_board(layout, *node, turn), *dot)).collect();
    let size = layout.inner();
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

fn extent(nodes: &[(Node, usize)]) -> Option<[Node; 2]> {
    let (first, _) = nodes.first()?;
    Some(nodes.iter().fold([*first, *first], |[low, high], (node, _)| {
        [[0, 1].map(|k| low[k].min(node[k])), [0, 1].map(|k| high[k].max(node[k]))]
    }))
}

/// The dots of a turned lattice with their numbers, if they reach over the board and no farther.
fn numbered(layout: &Layout, dots: &[Dot], lattice: &Lattice, turn: usize) -> Result<Named, Rejected> {
    let nodes = peeled(layout, lattice, turn);
    let [low, high] = extent(&nodes).ok_or(Rejected::NoBoard)?;
    let (seen, size) = ([0, 1].map(|k| (high[k] - low[k] + 1) as usize), layout.inner());
    if seen[0].min(seen[1]) > size[0].min(size[1]) || seen[0].max(seen[1]) > size[0].max(size[1]) {
        return Err(Rejected::Other);
    }
    if seen != size || nodes.len() * 5 < layout.corners() * 3 {
        return Err(Rejected::Few(nodes.len()));
    }
    let number = |node: Node| layout.dot_at([0, 1].map(|k| (node[k] - low[k]) as usize));
    let all = nodes.iter().map(|(node, dot)| Some((number(*node)?, *dots.get(*dot)?)));
    all.collect::<Option<_>>().ok_or(Rejected::Other)
}

/// The board, if a lattice is one: of several turns that fit, the one whose first dot is highest to the left.
fn named(
    gray: &Gray,
    layout: &Layout,
    noise: f64,
    dots: &[Dot],
    lattice: &Lattice,
) -> Result<Found, Rejected> {
    let mut reason = Rejected::NoBoard;
    let mut fitting: Vec<(f64, Named)> = Vec::new();
    for turn in 0..4 {
        match numbered(layout, dots, lattice, turn) {
            Ok(named) => {
                let first = map_near(&pairs(layout, &named), layout.corner(0))
                    .and_then(|it| it.0.map(layout.corner(0)));
                fitting.push((first.map_or(f64::INFINITY, |it| it.x + it.y), named));
            }
            Err(other) if matches!(reason, Rejected::NoBoard | Rejected::Few(_)) => reason = other,
            Err(_) => {}
        }
    }
    let turnable = fitting.len() > 1;
    let (_, mut named) = fitting.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).ok_or(reason)?;
    prune(layout, &mut named, |it| it.place, OFF);
    let radius = radius(layout, &named).ok_or(Rejected::NoBoard)?;
    keep_round(layout, &mut named, radius);
    seek(gray, layout, noise, &mut named, radius);
    keep_round(layout, &mut named, radius);
    prune(layout, &mut named, |it| it.place, OFF);
    if named.len() * 20 < layout.corners() * 13 || named.len() < 6 {
        return Err(Rejected::Few(named.len()));
    }
    if !has_outline(layout, &named) || !has_paper(gray, layout, &named) || has_gaps(gray, layout, &named) {
        return Err(Rejected::Other);
    }
    let corners = corrected(layout, &named, radius);
    let blur_px = median(named.values().map(|it| it.blur_px)).unwrap_or(0.0);
    Ok(Found { corners, markers: 0, turnable, blur_px, noise })
}

fn pairs(layout: &Layout, named: &Named) -> Vec<Pair> {
    named.iter().map(|(id, dot)| (layout.corner(*id), dot.place, 1.0)).collect()
}

/// The radius of a dot, units, and pixels of a unit.
fn radius_of(all: &[Pair], point: Vector2<f64>, dot: &Dot) -> Option<[f64; 2]> {
    let slope = map_near(all, point)?.0.slope(point)?.determinant();
    (slope > 0.0).then_some([(1.0 / (dot.to_circle.determinant() * slope)).sqrt(), slope.sqrt()])
}

/// The median radius of the dots, units.
fn radius(layout: &Layout, named: &Named) -> Option<f64> {
    let all = pairs(layout, named);
    let radius = |(id, dot): (&usize, &Dot)| Some(radius_of(&all, layout.corner(*id), dot)?[0]);
    median(named.iter().filter_map(radius))
}

/// Takes dots away that are not as large as the others.
fn keep_round(layout: &Layout, named: &mut Named, radius: f64) {
    let all = pairs(layout, named);
    named.retain(|id, dot| is_alike(&all, layout.corner(*id), dot, radius));
    let usual = median(named.values().map(|it| it.misfit)).unwrap_or(0.0);
    named.retain(|_, dot| dot.misfit < COVERED.0 * usual + COVERED.1);
}

fn is_alike(all: &[Pair], point: Vector2<f64>, dot: &Dot, radius: f64) -> bool {
    radius_of(all, point, dot)
        .is_some_and(|[own, unit_px]| (own / radius - 1.0).abs() < ROUND.0 + ROUND.1 / (radius * unit_px))
}

/// Seeks dots that were not found, where the others have them.
fn seek(gray: &Gray, layout: &Layout, noise: f64, named: &mut Named, radius: f64) {
    let all = pairs(layout, named);
    for id in 0..layout.corners() {
        if named.contains_key(&id) {
            continue;
        }
        let point = layout.corner(id);
        let Some((map, nearest)) = map_near(&all, point).filter(|it| it.1 < NEAR) else { continue };
        let (Some(place), Some(slope)) = (map.map(point), map.slope(point)) else { continue };
        let spread = slope * slope.transpose() * (radius * radius);
        let axes = spread.symmetric_eigen();
        if axes.eigenvalues.min() <= 0.0 {
            continue;
        }
        let scale = Matrix2::from_diagonal(&axes.eigenvalues.map(|it| 1.0 / it.sqrt()));
        let to_circle = axes.eigenvectors * scale * axes.eigenvectors.transpose();
        let Some(dot) = ellipse::fit(gray, place, to_circle, noise) else { continue };
        let limit = (OFF.0 + OFF.1 * slope.determinant().abs().sqrt()) * nearest.max(1.0);
        if (dot.place - place).norm() < limit && is_alike(&all, point, &dot, radius) {
            named.insert(id, dot);
        }
    }
}

/// Whether most of the outer dots are seen: a board that is cut out of a field across its rows has corners of it only.
fn has_outline(layout: &Layout, named: &Named) -> bool {
    let [columns, rows] = layout.inner().map(|it| it as f64);
    // In every second row of an asymmetric grid the outer dots are a column further inside.
    let inside = if layout.is_asymmetric() { 1.5 } else { 0.5 };
    let is_outer = |id: &usize| {
        let point = layout.corner(*id);
        point.x < 1.0 + inside || point.x > columns - inside || point.y < 1.5 || point.y > rows - 0.5
    };
    let outer = (0..layout.corners()).filter(is_outer).count();
    named.keys().filter(|id| is_outer(id)).count() as f64 >= OUTLINE * outer as f64
}

/// Whether there is paper around the outer dots: what is cut off from a field of dots has none.
fn has_paper(gray: &Gray, layout: &Layout, named: &Named) -> bool {
    let all = pairs(layout, named);
    let [columns, rows] = layout.inner().map(|it| it as f64);
    let mut kinds = [0, 0];
    for (id, dot) in named {
        let point = layout.corner(*id);
        let Some((map, _)) = map_near(&all, point) else { continue };
        for (is_outer, way) in [
            (point.x <= 1.0, [-1.0, 0.0]),
            (point.x >= columns, [1.0, 0.0]),
            (point.y <= 1.0, [0.0, -1.0]),
            (point.y >= rows, [0.0, 1.0]),
        ] {
            if !is_outer {
                continue;
            }
            for part in [PAPER - 0.15, PAPER] {
                let Some(place) = map.map(point + Vector2::from(way) * part) else { continue };
                if gray.holds(place, 1.0) {
                    kinds[usize::from(gray.at(place) > dot.mean)] += 1;
                }
            }
        }
    }
    kinds[0] * 9 <= kinds[1]
}

/// Whether there is bare paper where several dots should be: a part of another grid has its dots elsewhere, and what covers a board is seldom as even
/// and as light as its paper.
fn has_gaps(gray: &Gray, layout: &Layout, named: &Named) -> bool {
    let all = pairs(layout, named);
    let is_bare = |id: &usize| -> Option<bool> {
        let point = layout.corner(*id);
        let (map, _) = map_near(&all, point).filter(|it| it.1 < NEAR)?;
        let near = named.iter().min_by(|a, b| {
            let far = |it: &usize| (layout.corner(*it) - point).norm();
            far(a.0).total_cmp(&far(b.0))
        })?;
        let paper = near.1.mean + near.1.half_contrast;
        let own = levels(gray, &map, point, INSIDE)?;
        Some(own.iter().all(|it| (it - paper).abs() < EVEN * near.1.half_contrast))
    };
    let missing = (0..layout.corners()).filter(|id| !named.contains_key(id));
    missing.filter(|id| is_bare(id).unwrap_or(false)).count() > GAPS
}

/// Levels at four places around a point of the board, so many units from it; `None` if one is not in the picture.
fn levels(gray: &Gray, map: &Homography, point: Vector2<f64>, way: f64) -> Option<[f64; 4]> {
    let mut found = [0.0; 4];
    for (out, way) in found.iter_mut().zip([[way, 0.0], [-way, 0.0], [0.0, way], [0.0, -way]]) {
        let place = map.map(point + Vector2::from(way)).filter(|it| gray.holds(*it, 1.0))?;
        *out = gray.at(place);
    }
    Some(found)
}

/// The middles of the circles: with what the tilt moves the middle of their pictures taken away.
fn corrected(layout: &Layout, named: &Named, radius: f64) -> Vec<Corner> {
    let measured = pairs(layout, named);
    let mut better = measured.clone();
    for _ in 0..2 {
        let moved = |(point, place, weight): &Pair| {
            (*point, place - bias(&better, *point, radius).unwrap_or_default(), *weight)
        };
        better = measured.iter().map(moved).collect();
    }
    let corner = |((id, dot), (_, place, _)): ((&usize, &Dot), &Pair)| Corner {
        id: *id,
        kind: Kind::Dot,
        u_px: place.x,
        v_px: place.y,
        sigma_px: dot.sigma_px,
    };
    named.iter().zip(&better).map(corner).collect()
}
