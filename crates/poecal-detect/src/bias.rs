//! Offset between the middle of a circle's image and the image of its middle.
//!
//! The image of a circle is an ellipse whose middle is not the image of the circle's middle: the latter is nearer to the far side. The surrounding
//! map of the plane determines the offset: that of a pinhole, and the part that a lens adds, to second order.

use nalgebra::{Matrix2, SMatrix, SVector, Vector2};

use crate::homography::{Homography, PointPair, weight_pairs_near};

/// Standard deviation of the weights of points by their distance, and the farthest that counts, units of the plane.
const REACH: [f64; 2] = [1.8, 4.5];
/// Points on a circle.
const AROUND: usize = 16;

/// Map of the plane near a point: a homography, and a polynomial of second order on top.
struct PlaneView {
    map: Homography,
    point: Vector2<f64>,
    bend: SMatrix<f64, 6, 2>,
}

fn powers(off: Vector2<f64>) -> SVector<f64, 6> {
    SVector::from([1.0, off.x, off.y, off.x * off.x, off.x * off.y, off.y * off.y])
}

impl PlaneView {
    fn new(pairs: &[PointPair], point: Vector2<f64>) -> Option<Self> {
        let near = weight_pairs_near(pairs.iter().copied(), point, REACH);
        let map = Homography::fit(&near)?;
        let (mut normal, mut right) = (SMatrix::<f64, 6, 6>::zeros(), SMatrix::<f64, 6, 2>::zeros());
        for (plane, place, weight) in &near {
            let (row, left) = (powers(plane - point), place - map.map(*plane)?);
            normal += row * row.transpose() * *weight;
            right += row * left.transpose() * *weight;
        }
        // If points do not determine the second order, it is zero.
        normal += SMatrix::identity() * (1e-6 * normal.trace());
        let bend = normal.cholesky()?.solve(&right);
        Some(PlaneView { map, point, bend })
    }

    fn map_offset(&self, off: Vector2<f64>) -> Option<Vector2<f64>> {
        Some(self.map.map(self.point + off)? + self.bend.transpose() * powers(off))
    }

    fn slope(&self) -> Option<Matrix2<f64>> {
        Some(self.map.slope(self.point)? + self.bend.fixed_rows::<2>(1).transpose())
    }
}

/// Offset from the image of a circle's middle to the middle of the ellipse that fits its image, pixels: by points of the plane and their positions.
pub(crate) fn bias(pairs: &[PointPair], middle: Vector2<f64>, radius: f64) -> Option<Vector2<f64>> {
    let local = PlaneView::new(pairs, middle)?;
    let (own, slope) = (local.map_offset(Vector2::zeros())?, local.slope()? * radius);
    let back = slope.try_inverse()?;
    let mut shift = Vector2::zeros();
    for k in 0..AROUND {
        let (sin, cos) = (k as f64 * std::f64::consts::TAU / AROUND as f64).sin_cos();
        let outwards = Vector2::new(cos, sin);
        // Deviation of the outline from a circle there, in radii; its first harmonic moves the ellipse.
        let off = back * (local.map_offset(outwards * radius)? - own) - outwards;
        shift += outwards * (outwards.dot(&off) * 2.0 / AROUND as f64);
    }
    let bias = slope * shift;
    (bias.x.is_finite() && bias.y.is_finite()).then_some(bias)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_an_ellipse_is_not_that_of_the_circle() {
        let corners = [[0.0, 0.0], [7.0, 0.0], [7.0, 7.0], [0.0, 7.0]].map(Vector2::from);
        let seen = [[100.0, 100.0], [620.0, 110.0], [560.0, 400.0], [180.0, 360.0]].map(Vector2::from);
        let map = Homography::of_corners(&corners, &seen).unwrap();
        let (middle, radius) = (Vector2::new(3.0, 2.0), 0.3);
        // The mean of an ellipse is the middle between the tangents of any direction.
        let points: Vec<Vector2<f64>> = (0..20_000)
            .map(|k| f64::from(k) * std::f64::consts::TAU / 20_000.0)
            .map(|angle| map.map(middle + Vector2::new(angle.cos(), angle.sin()) * radius).unwrap())
            .collect();
        let ends = |k: usize| {
            let values = points.iter().map(|it| it[k]);
            0.5 * (values.clone().fold(f64::INFINITY, f64::min) + values.fold(f64::NEG_INFINITY, f64::max))
        };
        let expected = Vector2::new(ends(0), ends(1)) - map.map(middle).unwrap();
        let plane = (0..8).flat_map(|y| (0..8).map(move |x| Vector2::new(f64::from(x), f64::from(y))));
        let pairs: Vec<PointPair> = plane.map(|it| (it, map.map(it).unwrap(), 1.0)).collect();
        let found = bias(&pairs, middle, radius).unwrap();
        println!("{found:?}, by its tangents {expected:?}");
        // Accuracy of second order: the next term is smaller by the square of the circle's depth over its distance.
        assert!((found - expected).norm() < 0.01 * expected.norm() && expected.norm() > 0.1);
    }
}
