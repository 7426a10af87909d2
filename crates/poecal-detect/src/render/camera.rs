//! A camera with radial distortion.

use nalgebra::{Vector2, Vector3};

/// A camera: pinhole with `k1` and `k2` of OpenCV.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderCamera {
    /// Columns and rows of its pictures.
    pub size: [usize; 2],
    /// Focal lengths, pixels.
    pub focal_px: [f64; 2],
    /// The principal point, pixels.
    pub centre_px: [f64; 2],
    /// Radial distortion: `r (1 + k1 r² + k2 r⁴)`.
    pub distortion: [f64; 2],
}

impl RenderCamera {
    /// Pixel of a point in the camera's frame; `None` behind the camera, or so far from the axis that the distortion folds.
    #[must_use]
    pub fn project(&self, point: &Vector3<f64>) -> Option<Vector2<f64>> {
        let plane = point.xy() / point.z;
        let [k1, k2] = self.distortion;
        let square = plane.norm_squared();
        let is_unfolded = 1.0 + 3.0 * k1 * square + 5.0 * k2 * square * square > 0.0;
        let is_seen = point.z > 0.0 && is_unfolded;
        if !is_seen {
            return None;
        }
        let seen = plane * (1.0 + square * (k1 + k2 * square));
        Some(Vector2::new(seen.x * self.focal_px[0] + self.centre_px[0], seen.y * self.focal_px[1] + self.centre_px[1]))
    }

    /// The ray of a pixel, with z = 1.
    #[must_use]
    pub fn ray(&self, place_px: Vector2<f64>) -> Vector3<f64> {
        let seen = Vector2::new(
            (place_px.x - self.centre_px[0]) / self.focal_px[0],
            (place_px.y - self.centre_px[1]) / self.focal_px[1],
        );
        let [k1, k2] = self.distortion;
        let target = seen.norm();
        // Newton's method for the radius: quadratic, from a start that is off by a few per cent.
        let mut radius = target;
        for _ in 0..6 {
            let square = radius * radius;
            let value = radius * (1.0 + square * (k1 + k2 * square)) - target;
            let slope = 1.0 + square * (3.0 * k1 + 5.0 * k2 * square);
            radius -= value / slope.max(0.1);
        }
        let factor = if target > 0.0 { radius / target } else { 1.0 };
        Vector3::new(seen.x * factor, seen.y * factor, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_is_seen_where_it_came_from() {
        let camera = RenderCamera {
            size: [1920, 1200],
            focal_px: [1500.0, 1490.0],
            centre_px: [950.0, 610.0],
            distortion: [-0.18, 0.02],
        };
        let mut worst: f64 = 0.0;
        for at in [[0.0, 0.0], [950.0, 610.0], [1919.0, 1199.0], [30.0, 700.0]] {
            let place = Vector2::from(at);
            worst = worst.max((camera.project(&camera.ray(place)).unwrap() - place).norm());
        }
        println!("worst {worst:.1e} px");
        // Newton's method has converged: the rest is rounding.
        assert!(worst < 1e-9);
    }
}
