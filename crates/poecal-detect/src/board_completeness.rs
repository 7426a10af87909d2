//! Decision whether dots are a whole board, and no part of a larger pattern.

use nalgebra::Vector2;

use crate::gray::Gray;
use crate::homography::Homography;
use crate::lattice::map_near;
use crate::layout::BoardLayout;
use crate::numbered_dots::{NEAR, NumberedDots, dot_at, pairs};

/// Least share of the outer dots that must be visible.
const OUTLINE: f64 = 0.55;
/// Distance from the middle of a missing dot at which it is examined, units; largest difference of bare paper from the paper around, as a part of
/// half the contrast; and most missing dots that may be bare.
const INSIDE: f64 = 0.12;
const EVEN: f64 = 0.3;
const GAPS: usize = 2;
/// Distance from the middles of the outer dots at which there must be paper, units.
const PAPER: f64 = 0.8;
/// Most dots that may be at the next positions beyond the board.
const BEYOND: usize = 1;

/// True if dots are all of a board with bare surroundings.
pub(crate) fn is_whole(gray: &Gray, layout: &BoardLayout, noise: f64, named: &NumberedDots, radius: f64) -> bool {
    has_outline(layout, named)
        && has_paper(gray, layout, named)
        && !has_gaps(gray, layout, named)
        && !goes_on(gray, layout, noise, named, radius)
}

/// True if most of the outer dots are visible: a board that is cut diagonally out of a field has only corners of it.
fn has_outline(layout: &BoardLayout, named: &NumberedDots) -> bool {
    let [columns, rows] = layout.inner_corners().map(|it| it as f64);
    // In every second row of an asymmetric grid the outer dots are a column further inside.
    let inside = if layout.is_asymmetric() { 1.5 } else { 0.5 };
    let is_outer = |id: &usize| {
        let point = layout.corner(*id);
        point.x < 1.0 + inside || point.x > columns - inside || point.y < 1.5 || point.y > rows - 0.5
    };
    let outer = (0..layout.corners()).filter(is_outer).count();
    named.keys().filter(|id| is_outer(id)).count() as f64 >= OUTLINE * outer as f64
}

/// True if there is paper around the outer dots: a part of a larger field of dots has none.
fn has_paper(gray: &Gray, layout: &BoardLayout, named: &NumberedDots) -> bool {
    let all = pairs(layout, named);
    let [columns, rows] = layout.inner_corners().map(|it| it as f64);
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
                    kinds[usize::from(gray.level_at(place) > dot.mean)] += 1;
                }
            }
        }
    }
    kinds[0] * 9 <= kinds[1]
}

/// True if there is bare paper at several expected dots: a part of another grid has its dots elsewhere, and an occlusion is seldom as even and as
/// light as paper.
fn has_gaps(gray: &Gray, layout: &BoardLayout, named: &NumberedDots) -> bool {
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

/// True if dots continue beyond the board: as large as its own, and at the next positions. The rest of a field has them; by chance there is only a
/// single one.
fn goes_on(gray: &Gray, layout: &BoardLayout, noise: f64, named: &NumberedDots, radius: f64) -> bool {
    let all = pairs(layout, named);
    let [columns, rows] = layout.inner_corners().map(|it| it as i32);
    let is_beyond = |[x, y]: [i32; 2]| x == 0 || y == 0 || x > columns || y > rows;
    // In an asymmetric grid every second node of a row has a dot.
    let has_dot = |[x, y]: [i32; 2]| !layout.is_asymmetric() || (x + y) % 2 == 0;
    let places = (0..=rows + 1).flat_map(|y| (0..=columns + 1).map(move |x| [x, y]));
    let beyond = places.filter(|it| is_beyond(*it) && has_dot(*it));
    let there =
        |[x, y]: [i32; 2]| dot_at(gray, noise, &all, Vector2::new(f64::from(x), f64::from(y)), radius).is_some();
    beyond.filter(|it| there(*it)).count() > BEYOND
}

/// Levels at four points around a point of the board, at this distance, units; `None` if one is not in the picture.
fn levels(gray: &Gray, map: &Homography, point: Vector2<f64>, way: f64) -> Option<[f64; 4]> {
    let mut found = [0.0; 4];
    for (out, way) in found.iter_mut().zip([[way, 0.0], [-way, 0.0], [0.0, way], [0.0, -way]]) {
        let place = map.map(point + Vector2::from(way)).filter(|it| gray.holds(*it, 1.0))?;
        *out = gray.level_at(place);
    }
    Some(found)
}
