//! Dark quadrangles on light ground: candidates for markers.

use nalgebra::Vector2;

use crate::dark_regions::{SmoothedPicture, cross};
use crate::gray::Gray;

/// Corners of a quadrangle, clockwise in the picture.
pub(crate) type Quad = [Vector2<f64>; 4];

/// Shortest side, pixels.
const SHORTEST_PX: f64 = 9.0;

/// Half pixels to each side of a line in which an edge is searched for, and half the width over which its step of light is measured.
const STEPS: usize = 8;
const ASIDE: usize = 2;

/// Dark quadrangles. Windows of two sizes separate dark from light.
pub(crate) fn quads(gray: &Gray, noise: f64) -> Vec<Quad> {
    of_limits(gray, &[(0.8 * noise).max(2.0)], noise)
}

/// Dark quadrangles that may touch others with their corners: darker thresholds separate them.
pub(crate) fn quads_apart(gray: &Gray, noise: f64) -> Vec<Quad> {
    of_limits(gray, &[(0.8 * noise).max(2.0), 8.0_f64.max(noise), 22.0, 45.0], noise)
}

/// Quadrangles darker by some thresholds than the surrounding mean.
fn of_limits(gray: &Gray, limits: &[f64], noise: f64) -> Vec<Quad> {
    let shades = SmoothedPicture::new(gray, noise);
    let longest = gray.width().max(gray.height());
    let mut found: Vec<Quad> = Vec::new();
    for half in [longest / 110, longest / 36].map(|it| it.max(7)) {
        for limit in limits {
            for part in shades.darker_parts(half, *limit as i32).outlines(SHORTEST_PX as u32) {
                let Some(quad) = quad_of(&part).and_then(|it| on_edges(gray, &it)) else { continue };
                let same = |other: &Quad| (0..4).all(|k| other.iter().any(|it| (it - quad[k]).norm() < 2.0));
                if !found.iter().any(same) {
                    found.push(quad);
                }
            }
        }
    }
    found
}

/// The convex hull of points that are sorted by rows, clockwise in the picture.
fn hull(points: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.y.total_cmp(&b.y).then(a.x.total_cmp(&b.x)));
    let half = |points: &mut dyn Iterator<Item = Vector2<f64>>| {
        let mut chain: Vec<Vector2<f64>> = Vec::new();
        for point in points {
            while let [.., a, b] = chain.as_slice() {
                if cross(b - a, point - b) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut whole = half(&mut sorted.iter().copied());
    whole.extend(half(&mut sorted.iter().rev().copied()));
    whole
}

/// Twice the area of a polygon, positive if it is clockwise in the picture.
fn area(points: &[Vector2<f64>]) -> f64 {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(a, b)| cross(*a, *b)).sum()
}

/// The quadrangle of an outline, if it is nearly one: the largest one within its hull.
fn quad_of(outline: &[Vector2<f64>]) -> Option<Quad> {
    let hull = hull(outline);
    let count = hull.len();
    if count < 4 {
        return None;
    }
    let whole = area(&hull);
    let mut best: (f64, [usize; 4]) = (0.0, [0; 4]);
    for first in 0..count - 2 {
        let (mut second, mut fourth) = (first + 1, first + 2);
        for third in first + 2..count {
            let across = hull[third] - hull[first];
            let off = |at: usize| cross(across, hull[at % count] - hull[first]);
            // The farthest point on each side moves on with the diagonal.
            while second + 1 < third && off(second + 1) < off(second) {
                second += 1;
            }
            fourth = fourth.max(third);
            while fourth + 1 < first + count && off(fourth + 1) > off(fourth) {
                fourth += 1;
            }
            let found = off(fourth) - off(second);
            if found > best.0 {
                best = (found, [first, second, third, fourth % count]);
            }
        }
    }
    let (largest, corners) = best;
    let quad = corners.map(|at| hull[at]);
    let shortest = (0..4).map(|k| (quad[(k + 1) % 4] - quad[k]).norm()).fold(f64::INFINITY, f64::min);
    // A marker's ink fills its outline from border to border.
    (largest > 0.84 * whole && shortest >= SHORTEST_PX * 0.6).then_some(quad)
}

/// A quadrangle with its sides on the edges in the picture.
fn on_edges(gray: &Gray, quad: &Quad) -> Option<Quad> {
    let sides: Vec<(Vector2<f64>, Vector2<f64>)> =
        (0..4).map(|k| edge(gray, quad[k], quad[(k + 1) % 4])).collect::<Option<_>>()?;
    let mut found = *quad;
    for (k, corner) in found.iter_mut().enumerate() {
        let ((a, along), (b, other)) = (sides[(k + 3) % 4], sides[k]);
        let area = cross(along, other);
        if area.abs() < 0.15 {
            return None;
        }
        let place = a + along * (cross(b - a, other) / area);
        if (place - *corner).norm() > 4.0 {
            return None;
        }
        *corner = place;
    }
    (area(&found) > 0.0).then_some(found)
}

/// A point on the edge beside the line from one corner to the next, and its direction: a fit to the steepest steps from light to dark.
fn edge(gray: &Gray, from: Vector2<f64>, to: Vector2<f64>) -> Option<(Vector2<f64>, Vector2<f64>)> {
    let length = (to - from).norm();
    let along = (to - from) / length;
    // Into the quadrangle: it is clockwise in the picture.
    let inwards = Vector2::new(-along.y, along.x);
    let samples = (length * 0.8).clamp(6.0, 40.0) as usize;
    let reach = (length * 0.12).clamp(2.0, 0.5 * STEPS as f64);
    let steps = (reach * 2.0).ceil() as i32;
    let mut points = Vec::with_capacity(samples);
    let mut levels = [0.0; 2 * (STEPS + ASIDE) + 1];
    let levels = &mut levels[..2 * (steps as usize + ASIDE) + 1];
    let mut falls = [0.0; 2 * STEPS + 1];
    let falls = &mut falls[..2 * steps as usize + 1];
    for k in 0..samples {
        let at = from + (to - from) * (0.1 + 0.8 * (k as f64 + 0.5) / samples as f64);
        for (step, level) in levels.iter_mut().enumerate() {
            *level = gray.level_at(at + inwards * ((step as f64 - f64::from(steps) - ASIDE as f64) * 0.5));
        }
        for (step, fall) in falls.iter_mut().enumerate() {
            *fall = levels[step] - levels[step + 2 * ASIDE];
        }
        let (best, fall) = falls.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        if fall <= 1.0 || best == 0 || best + 1 == falls.len() {
            continue;
        }
        let bend = falls[best - 1] + falls[best + 1] - 2.0 * fall;
        let shift = if bend < 0.0 { 0.5 * (falls[best - 1] - falls[best + 1]) / bend } else { 0.0 };
        let step = (best as i32 - steps) as f64 + shift.clamp(-0.5, 0.5);
        points.push((at + inwards * (step * 0.5), fall));
    }
    if points.len() * 2 < samples {
        return None;
    }
    line(&points, along)
}

/// The line through weighted points, fitted twice: the second time without distant points.
fn line(points: &[(Vector2<f64>, f64)], along: Vector2<f64>) -> Option<(Vector2<f64>, Vector2<f64>)> {
    let mut kept = points.to_vec();
    let mut found = None;
    for _ in 0..3 {
        let total: f64 = kept.iter().map(|it| it.1).sum();
        let middle = kept.iter().map(|it| it.0 * it.1).sum::<Vector2<f64>>() / total;
        let across = Vector2::new(-along.y, along.x);
        let (mut squares, mut products) = (0.0, 0.0);
        for (point, weight) in &kept {
            let off = point - middle;
            squares += weight * off.dot(&along).powi(2);
            products += weight * off.dot(&along) * off.dot(&across);
        }
        let direction = (along + across * (products / squares)).try_normalize(1e-9)?;
        found = Some((middle, direction));
        kept.retain(|(point, _)| cross(direction, point - middle).abs() < 0.7);
        if kept.len() < 4 {
            break;
        }
    }
    found
}
