//! Plane projective maps.

use nalgebra::{Matrix2, Matrix3, SMatrix, SVector, Vector2, Vector3};

/// A map of a board's plane onto a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Homography {
    matrix: Matrix3<f64>,
}

/// A point of the plane, its position in the picture, and its weight.
pub(crate) type PointPair = (Vector2<f64>, Vector2<f64>, f64);

/// Pairs near a point of the plane, with weights that decrease with the distance from it: by their standard deviation, and the largest distance.
pub(crate) fn weight_pairs_near(
    pairs: impl IntoIterator<Item = PointPair>,
    point: Vector2<f64>,
    [deviation, farthest]: [f64; 2],
) -> Vec<PointPair> {
    let weighed = |(plane, place, weight): PointPair| {
        let square = (plane - point).norm_squared();
        let fallen = weight * (-0.5 * square / (deviation * deviation)).exp();
        (square < farthest * farthest).then_some((plane, place, fallen))
    };
    pairs.into_iter().filter_map(weighed).collect()
}

/// The map near a point of the plane, from the surrounding pairs without that point, and the distance of the nearest of them.
pub(crate) fn map_near(
    pairs: impl IntoIterator<Item = PointPair>,
    point: Vector2<f64>,
    reach: [f64; 2],
) -> Option<(Homography, f64)> {
    let square = |it: &PointPair| (it.0 - point).norm_squared();
    let around = weight_pairs_near(pairs.into_iter().filter(|it| square(it) > 1e-6), point, reach);
    let nearest = around.iter().map(square).fold(f64::INFINITY, f64::min);
    Some((Homography::fit(&around)?, nearest.sqrt()))
}

impl Homography {
    /// The map that fits pairs best: the direct linear transformation with both sides centred and scaled. `None` with fewer than four pairs, or for
    /// collinear points.
    pub(crate) fn fit(pairs: &[PointPair]) -> Option<Self> {
        if pairs.len() < 4 {
            return None;
        }
        let from = PointScaling::new(pairs.iter().map(|it| (it.0, it.2)))?;
        let to = PointScaling::new(pairs.iter().map(|it| (it.1, it.2)))?;
        // The last element is fixed to 1, so there are eight unknowns. In coordinates about the middle of the points it is not near 0.
        let mut normal = SMatrix::<f64, 8, 8>::zeros();
        let mut right = SVector::<f64, 8>::zeros();
        for (plane, picture, weight) in pairs {
            let (p, q) = (from.apply(*plane), to.apply(*picture));
            let rows = [
                ([p.x, p.y, 1.0, 0.0, 0.0, 0.0, -p.x * q.x, -p.y * q.x], q.x),
                ([0.0, 0.0, 0.0, p.x, p.y, 1.0, -p.x * q.y, -p.y * q.y], q.y),
            ];
            for (row, value) in rows {
                let row = SVector::<f64, 8>::from(row);
                normal += row * row.transpose() * *weight;
                right += row * (value * weight);
            }
        }
        let trace = normal.trace();
        let factor = normal.cholesky()?;
        let least = (0..8).map(|k| factor.l_dirty()[(k, k)]).fold(f64::INFINITY, f64::min);
        let is_determined = least * least > 1e-10 * trace;
        if !is_determined {
            return None;
        }
        let h = factor.solve(&right);
        let matrix = Matrix3::new(h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1.0);
        let whole = to.matrix().try_inverse()? * matrix * from.matrix();
        whole.iter().all(|it| it.is_finite()).then_some(Homography { matrix: whole })
    }

    /// The map of four corners.
    pub(crate) fn of_corners(plane: &[Vector2<f64>; 4], picture: &[Vector2<f64>; 4]) -> Option<Self> {
        let pairs = [0, 1, 2, 3].map(|k| (plane[k], picture[k], 1.0));
        Homography::fit(&pairs)
    }

    /// Position of a point of the plane in the picture; `None` behind the horizon.
    pub(crate) fn map(&self, point: Vector2<f64>) -> Option<Vector2<f64>> {
        let mapped = self.matrix * Vector3::new(point.x, point.y, 1.0);
        let place = mapped.xy() / mapped.z;
        (place.x.is_finite() && place.y.is_finite() && mapped.z * self.matrix[(2, 2)] > 0.0).then_some(place)
    }

    /// Rows of the matrix relative to an origin at which its last row is 1.
    pub(crate) fn rows_about(&self, origin: Vector2<f64>) -> [[f32; 3]; 3] {
        let moved = self.matrix * Matrix3::new_translation(&origin);
        let scaled = moved / moved[(2, 2)];
        [0, 1, 2].map(|row| [0, 1, 2].map(|column| scaled[(row, column)] as f32))
    }

    /// Derivative of the position in the picture by the point: columns are by x and y of the plane.
    pub(crate) fn slope(&self, point: Vector2<f64>) -> Option<Matrix2<f64>> {
        let mapped = self.matrix * Vector3::new(point.x, point.y, 1.0);
        let scale = 1.0 / mapped.z;
        let place = mapped.xy() * scale;
        let part = |column: usize| {
            let by = self.matrix.column(column);
            Vector2::new(by.x - place.x * by.z, by.y - place.y * by.z) * scale
        };
        let slope = Matrix2::from_columns(&[part(0), part(1)]);
        slope.iter().all(|it| it.is_finite()).then_some(slope)
    }
}

/// Transformation that moves the middle of points to zero, and scales their spread to one.
struct PointScaling {
    middle: Vector2<f64>,
    factor: f64,
}

impl PointScaling {
    fn new(points: impl Iterator<Item = (Vector2<f64>, f64)> + Clone) -> Option<Self> {
        let total: f64 = points.clone().map(|it| it.1).sum();
        let middle = points.clone().map(|it| it.0 * it.1).sum::<Vector2<f64>>() / total;
        let spread = (points.map(|it| (it.0 - middle).norm_squared() * it.1).sum::<f64>() / total).sqrt();
        (spread > 0.0 && spread.is_finite()).then(|| PointScaling { middle, factor: 1.0 / spread })
    }

    fn apply(&self, point: Vector2<f64>) -> Vector2<f64> {
        (point - self.middle) * self.factor
    }

    fn matrix(&self) -> Matrix3<f64> {
        let shift = -self.middle * self.factor;
        Matrix3::new(self.factor, 0.0, shift.x, 0.0, self.factor, shift.y, 0.0, 0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_comes_back_from_its_points() {
        let truth = Homography { matrix: Matrix3::new(80.0, -7.0, 500.0, 12.0, 60.0, 300.0, 0.02, -0.03, 1.0) };
        let places = (0..4).flat_map(|x| (0..3).map(move |y| Vector2::new(f64::from(x), f64::from(y))));
        let pairs: Vec<PointPair> = places.map(|it| (it, truth.map(it).unwrap(), 2.0)).collect();
        let found = Homography::fit(&pairs).unwrap();
        let at = Vector2::new(1.3, 0.7);
        let error = (found.map(at).unwrap() - truth.map(at).unwrap()).norm();
        let step = Vector2::new(1e-6, 0.0);
        let slope = (truth.map(at + step).unwrap() - truth.map(at).unwrap()) / 1e-6;
        println!("error {error:.1e} px, slope off by {:.1e}", (slope - truth.slope(at).unwrap().column(0)).norm());
        // Rounding, times the condition of eight unknowns; differences of 1e-6.
        assert!(error < 1e-8 && (slope - truth.slope(at).unwrap().column(0)).norm() < 1e-3);
        let line: Vec<PointPair> = (0..6).map(|k| (Vector2::new(f64::from(k), 0.0), Vector2::zeros(), 1.0)).collect();
        assert!(Homography::fit(&line).is_none() && Homography::fit(&pairs[..3]).is_none());
    }
}
