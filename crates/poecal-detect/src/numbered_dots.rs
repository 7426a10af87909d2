//! Dots with their numbers on a board: their size, and the search for missing ones.

use std::collections::BTreeMap;

use nalgebra::{Matrix2, Vector2};

use crate::ellipse::{self, Dot};
use crate::gray::Gray;
use crate::homography::PointPair;
use crate::lattice::map_near;
use crate::layout::BoardLayout;
use crate::median::median;

/// Dots by their numbers on the board.
pub(crate) type NumberedDots = BTreeMap<usize, Dot>;

/// Largest distance of a dot from its prediction by neighbours, pixels and parts of the unit.
pub(crate) const OFF: (f64, f64) = (0.8, 0.035);
/// Largest deviation of a dot's radius from that of the others, as a part and in pixels.
const ROUND: (f64, f64) = (0.08, 0.5);
/// Largest ratio of a dot's misfit to the median one, and to the contrast: beyond them, an occlusion covers a part of it.
const COVERED: (f64, f64) = (4.0, 0.03);
/// Largest distance of a missing dot from the nearest detected one, units.
pub(crate) const NEAR: f64 = 2.1;

pub(crate) fn pairs(layout: &BoardLayout, named: &NumberedDots) -> Vec<PointPair> {
    named.iter().map(|(id, dot)| (layout.corner(*id), dot.place, 1.0)).collect()
}

/// The radius of a dot, units, and pixels of a unit.
pub(crate) fn radius_of(all: &[PointPair], point: Vector2<f64>, dot: &Dot) -> Option<[f64; 2]> {
    let slope = map_near(all, point)?.0.slope(point)?.determinant();
    (slope > 0.0).then_some([(1.0 / (dot.to_circle.determinant() * slope)).sqrt(), slope.sqrt()])
}

/// The median radius of the dots, units.
pub(crate) fn radius(layout: &BoardLayout, named: &NumberedDots) -> Option<f64> {
    let all = pairs(layout, named);
    let radius = |(id, dot): (&usize, &Dot)| Some(radius_of(&all, layout.corner(*id), dot)?[0]);
    median(named.iter().filter_map(radius))
}

/// Removes dots that differ in size from the others.
pub(crate) fn keep_round(layout: &BoardLayout, named: &mut NumberedDots, radius: f64) {
    let all = pairs(layout, named);
    named.retain(|id, dot| is_alike(&all, layout.corner(*id), dot, radius));
    let usual = median(named.values().map(|it| it.misfit)).unwrap_or(0.0);
    named.retain(|_, dot| dot.misfit < COVERED.0 * usual + COVERED.1);
}

pub(crate) fn is_alike(all: &[PointPair], point: Vector2<f64>, dot: &Dot, radius: f64) -> bool {
    radius_of(all, point, dot)
        .is_some_and(|[own, unit_px]| (own / radius - 1.0).abs() < ROUND.0 + ROUND.1 / (radius * unit_px))
}

/// Searches for missing dots at their predicted positions.
pub(crate) fn seek(gray: &Gray, layout: &BoardLayout, noise: f64, named: &mut NumberedDots, radius: f64) {
    let all = pairs(layout, named);
    let missing = (0..layout.corners()).filter(|id| !named.contains_key(id));
    let sought = missing.filter_map(|id| Some((id, dot_at(gray, noise, &all, layout.corner(id), radius)?)));
    named.extend(sought.collect::<Vec<_>>());
}

/// The dot at a point of the board's plane, if there is one of the usual size at its predicted position.
pub(crate) fn dot_at(gray: &Gray, noise: f64, all: &[PointPair], point: Vector2<f64>, radius: f64) -> Option<Dot> {
    let (map, nearest) = map_near(all, point).filter(|it| it.1 < NEAR)?;
    let (place, slope) = (map.map(point)?, map.slope(point)?);
    let spread = slope * slope.transpose() * (radius * radius);
    let axes = spread.symmetric_eigen();
    if axes.eigenvalues.min() <= 0.0 {
        return None;
    }
    let scale = Matrix2::from_diagonal(&axes.eigenvalues.map(|it| 1.0 / it.sqrt()));
    let to_circle = axes.eigenvectors * scale * axes.eigenvectors.transpose();
    let dot = ellipse::fit(gray, place, to_circle, noise)?;
    let limit = (OFF.0 + OFF.1 * slope.determinant().abs().sqrt()) * nearest.max(1.0);
    ((dot.place - place).norm() < limit && is_alike(all, point, &dot, radius)).then_some(dot)
}
