//! Lenses: projection of a point in front of a camera into its picture (theory.md §4, *Pictures*).

use nalgebra::{Matrix2, Matrix2x3, Vector2, Vector3};
use serde::{Deserialize, Serialize};

/// Largest number of parameters of a lens: focal lengths, centre, and eight of distortion.
pub const LENS_NUMBERS: usize = 12;

/// Names of the numbers of a lens, in the order of their derivatives.
pub const LENS_NAMES: [&str; LENS_NUMBERS] = ["fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"];

/// Model of the deviation of rays from those of a pinhole.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Distortion {
    /// Brown and Conrady, coefficients in OpenCV's order: k1, k2, p1, p2, k3, and k4, k5, k6 of the denominator.
    Brown([f64; 8]),
    /// Kannala and Brandt for wide angles, as OpenCV's `fisheye`: k1 to k4 of the angle.
    Fisheye([f64; 4]),
}

/// A camera's lens, in pixels of OpenCV's convention: the centre of the first pixel is (0, 0).
///
/// ```
/// use nalgebra::Vector3;
/// use poecal_model::camera::Lens;
/// let lens = Lens::pinhole([1000.0, 1000.0], [640.0, 360.0]);
/// assert_eq!(lens.pixel(&Vector3::new(0.1, 0.0, 1.0)), Some([740.0, 360.0].into()));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lens {
    /// Focal lengths along u and v, pixels.
    pub focal_px: [f64; 2],
    /// Intersection of the axis with the picture, pixels.
    pub centre_px: [f64; 2],
    /// Distortion.
    pub distortion: Distortion,
    /// Width and height of the picture, pixels, if they are known.
    pub size_px: Option<[u32; 2]>,
}

/// A pixel with its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// The pixel.
    pub pixel: Vector2<f64>,
    /// Derivative by the point, pixels per metre.
    pub by_point: Matrix2x3<f64>,
    /// Derivative by the numbers of the lens, in the order of [`LENS_NAMES`].
    pub by_lens: [[f64; LENS_NUMBERS]; 2],
}

/// Position of a point in the plane of a pinhole with focal length 1, its derivative by the point, and those by the coefficients of the
/// distortion.
type PinholePoint = (Vector2<f64>, Matrix2x3<f64>, [[f64; 8]; 2]);

/// Position of a ray of slopes x/z and y/z in the plane of a pinhole with focal length 1, with derivatives.
struct DistortedSlopes {
    place: Vector2<f64>,
    by_ray: Matrix2<f64>,
    by_coefficients: [[f64; 8]; 2],
}

/// Slopes x/z and y/z beyond which no ray is considered: 84 degrees from the axis.
const STEEPEST: f64 = 10.0;
/// Angle from the axis beyond which a fisheye sees nothing.
const WIDEST: f64 = 2.6;

impl Lens {
    /// A lens without distortion.
    #[must_use]
    pub fn pinhole(focal_px: [f64; 2], centre_px: [f64; 2]) -> Self {
        Lens { focal_px, centre_px, distortion: Distortion::Brown([0.0; 8]), size_px: None }
    }

    /// Pixel of a point in the camera's frame (metres: x right, y down, z forward). `None` behind the camera, and beyond the radius where the
    /// distortion turns back, so that a second ray would have the same pixel.
    #[must_use]
    pub fn pixel(&self, point: &Vector3<f64>) -> Option<Vector2<f64>> {
        self.projection(point).map(|found| found.pixel)
    }

    /// The same pixel with derivatives.
    #[must_use]
    pub fn projection(&self, point: &Vector3<f64>) -> Option<Projection> {
        let [fx, fy] = self.focal_px;
        let [cx, cy] = self.centre_px;
        let (place, mut by_point, by_coefficients) = match self.distortion {
            Distortion::Brown(k) => {
                if point.z <= point.norm() * 1e-2 {
                    return None;
                }
                let (a, b) = (point.x / point.z, point.y / point.z);
                let bent = brown(&k, a, b)?;
                let w = 1.0 / point.z;
                let slopes = Matrix2x3::new(w, 0.0, -a * w, 0.0, w, -b * w);
                (bent.place, bent.by_ray * slopes, bent.by_coefficients)
            }
            Distortion::Fisheye(k) => fisheye(&k, point)?,
        };
        let [x, y] = [place.x, place.y];
        let mut by_lens = [[0.0; LENS_NUMBERS]; 2];
        (by_lens[0][0], by_lens[1][1]) = (x, y);
        (by_lens[0][2], by_lens[1][3]) = (1.0, 1.0);
        for (row, (own, focal)) in by_lens.iter_mut().zip(by_coefficients.iter().zip([fx, fy])) {
            row[4..].iter_mut().zip(own).for_each(|(out, value)| *out = focal * value);
        }
        by_point.row_mut(0).scale_mut(fx);
        by_point.row_mut(1).scale_mut(fy);
        Some(Projection { pixel: Vector2::new(fx * x + cx, fy * y + cy), by_point, by_lens })
    }

    /// Direction of the ray of a pixel, in the camera's frame; `None` if no ray has it.
    #[must_use]
    pub fn ray(&self, pixel: &Vector2<f64>) -> Option<Vector3<f64>> {
        let place = Vector2::new(
            (pixel.x - self.centre_px[0]) / self.focal_px[0],
            (pixel.y - self.centre_px[1]) / self.focal_px[1],
        );
        let ray = match self.distortion {
            Distortion::Brown(k) => undistort(&k, place)?,
            Distortion::Fisheye(k) => {
                let bent = place.norm();
                let mut angle = bent;
                for _ in 0..NEWTON {
                    let (value, slope) = bent_angle(&k, angle);
                    angle -= (value - bent) / slope;
                }
                let (value, slope) = bent_angle(&k, angle);
                if !((value - bent).abs() < 1e-9 && slope > 0.0 && (0.0..WIDEST).contains(&angle)) {
                    return None;
                }
                let across = if bent > 0.0 { angle.sin() / bent } else { 1.0 };
                Vector3::new(place.x * across, place.y * across, angle.cos())
            }
        };
        Some(ray.normalize())
    }

    /// Numbers, in the order of [`LENS_NAMES`].
    #[must_use]
    pub fn numbers(&self) -> [f64; LENS_NUMBERS] {
        let mut numbers = [0.0; LENS_NUMBERS];
        numbers[..2].copy_from_slice(&self.focal_px);
        numbers[2..4].copy_from_slice(&self.centre_px);
        match &self.distortion {
            Distortion::Brown(k) => numbers[4..].copy_from_slice(k),
            Distortion::Fisheye(k) => numbers[4..8].copy_from_slice(k),
        }
        numbers
    }

    /// The same lens with other numbers.
    #[must_use]
    pub fn with_numbers(&self, numbers: &[f64; LENS_NUMBERS]) -> Self {
        let [fx, fy, cx, cy, k @ ..] = *numbers;
        let distortion = match self.distortion {
            Distortion::Brown(_) => Distortion::Brown(k),
            Distortion::Fisheye(_) => Distortion::Fisheye([k[0], k[1], k[2], k[3]]),
        };
        Lens { focal_px: [fx, fy], centre_px: [cx, cy], distortion, ..*self }
    }

    /// Square of the slope from the axis at which the positions of a lens of Brown and Conrady turn back.
    pub fn turn(&self) -> f64 {
        const PARTS: u32 = 512;
        const HALVINGS: usize = 50;
        let Distortion::Brown(k) = self.distortion else { return STEEPEST * STEEPEST };
        let at = |part: u32| STEEPEST * f64::from(part) / f64::from(PARTS);
        let is_seen = |slope: f64| brown(&k, slope, 0.0).is_some();
        let Some(part) = (1..=PARTS).find(|part| !is_seen(at(*part))) else { return STEEPEST * STEEPEST };
        let (mut inside, mut outside) = (at(part - 1), at(part));
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            if is_seen(middle) { inside = middle } else { outside = middle }
        }
        inside * inside
    }

    /// Mean focal length, pixels.
    #[must_use]
    pub fn focal(&self) -> f64 {
        (self.focal_px[0] * self.focal_px[1]).abs().sqrt()
    }
}

/// Steps of Newton's method, which doubles the digits in each.
const NEWTON: usize = 30;

/// Brown and Conrady: `x = a R + 2 p1 a b + p2 (r² + 2 a²)`, `y = b R + p1 (r² + 2 b²) + 2 p2 a b` with `R = (1 + k1 r² +
/// k2 r⁴ + k3 r⁶)/(1 + k4 r² + k5 r⁴ + k6 r⁶)`. `None` where a larger slope would have a smaller image.
fn brown(&[k1, k2, p1, p2, k3, k4, k5, k6]: &[f64; 8], a: f64, b: f64) -> Option<DistortedSlopes> {
    let s = a * a + b * b;
    let above = 1.0 + s * (k1 + s * (k2 + s * k3));
    let below = 1.0 + s * (k4 + s * (k5 + s * k6));
    let radial = above / below;
    let above_slope = k1 + s * (2.0 * k2 + s * 3.0 * k3);
    let below_slope = k4 + s * (2.0 * k5 + s * 3.0 * k6);
    let slope = (above_slope - radial * below_slope) / below;
    // d(r R)/dr = R + 2 r² dR/ds must stay above zero from the axis to here.
    if s > STEEPEST * STEEPEST
        || below <= 0.0
        || radial + 2.0 * s * slope <= 0.0
        || turns_back(&[k1, k2, k3, k4, k5, k6], s)
    {
        return None;
    }
    let place = Vector2::new(
        a * radial + 2.0 * p1 * a * b + p2 * (s + 2.0 * a * a),
        b * radial + p1 * (s + 2.0 * b * b) + 2.0 * p2 * a * b,
    );
    let cross = 2.0 * a * b * slope + 2.0 * p1 * a + 2.0 * p2 * b;
    let by_ray = Matrix2::new(
        radial + 2.0 * a * a * slope + 2.0 * p1 * b + 6.0 * p2 * a,
        cross,
        cross,
        radial + 2.0 * b * b * slope + 6.0 * p1 * b + 2.0 * p2 * a,
    );
    let of = |c: f64, both: f64, square: f64, first: bool| {
        let (up, down) = (c / below, -c * radial / below);
        let [p1, p2] = if first { [both, square] } else { [square, both] };
        [up * s, up * s * s, p1, p2, up * s * s * s, down * s, down * s * s, down * s * s * s]
    };
    let both = 2.0 * a * b;
    let by_coefficients = [of(a, both, s + 2.0 * a * a, true), of(b, both, s + 2.0 * b * b, false)];
    Some(DistortedSlopes { place, by_ray, by_coefficients })
}

/// True if the image of a ray turns back before this square of its slope.
fn turns_back(&[k1, k2, k3, k4, k5, k6]: &[f64; 6], s: f64) -> bool {
    const PARTS: usize = 16;
    // `1 + 3 k1 s + 5 k2 s² + 7 k3 s³` without its positive terms decreases everywhere: above zero here, it is so before.
    let is_polynomial = k4 == 0.0 && k5 == 0.0 && k6 == 0.0;
    let least = 1.0 + s * (3.0 * k1.min(0.0) + s * (5.0 * k2.min(0.0) + s * 7.0 * k3.min(0.0)));
    let is_plain = is_polynomial && least > 0.0;
    !is_plain
        && (1..PARTS).any(|part| {
            let s = s * (part as f64 / PARTS as f64).powi(2);
            let above = 1.0 + s * (k1 + s * (k2 + s * k3));
            let below = 1.0 + s * (k4 + s * (k5 + s * k6));
            let slope = k1 + s * (2.0 * k2 + s * 3.0 * k3) - above / below * (k4 + s * (2.0 * k5 + s * 3.0 * k6));
            below <= 0.0 || above / below + 2.0 * s * slope / below <= 0.0
        })
}

/// Ray of an image position, by Newton's method from the axis outward.
fn undistort(k: &[f64; 8], place: Vector2<f64>) -> Option<Vector3<f64>> {
    let mut slopes = place;
    let miss = |slopes: Vector2<f64>| brown(k, slopes.x, slopes.y).map(|bent| (bent.place - place, bent.by_ray));
    // A start beyond the turn is brought back into the field of view.
    for _ in 0..NEWTON {
        if miss(slopes).is_some() {
            break;
        }
        slopes *= 0.8;
    }
    for _ in 0..NEWTON {
        let (error, slope) = miss(slopes)?;
        let determinant = slope.determinant();
        let inverse = Matrix2::new(slope[(1, 1)], -slope[(0, 1)], -slope[(1, 0)], slope[(0, 0)]) / determinant;
        let mut step = inverse * error;
        // The step is halved until it stays on this side of the turn and is nearer.
        let mut is_nearer = false;
        for _ in 0..NEWTON {
            is_nearer = miss(slopes - step).is_some_and(|(next, _)| next.norm() < error.norm());
            if is_nearer {
                break;
            }
            step *= 0.5;
        }
        if !is_nearer {
            break;
        }
        slopes -= step;
    }
    let (error, _) = miss(slopes)?;
    (error.norm() < 1e-9).then(|| Vector3::new(slopes.x, slopes.y, 1.0))
}

/// Distorted angle of an angle from the axis, and its slope.
fn bent_angle(&[k1, k2, k3, k4]: &[f64; 4], angle: f64) -> (f64, f64) {
    let s = angle * angle;
    let value = angle * (1.0 + s * (k1 + s * (k2 + s * (k3 + s * k4))));
    let slope = 1.0 + s * (3.0 * k1 + s * (5.0 * k2 + s * (7.0 * k3 + s * 9.0 * k4)));
    (value, slope)
}

/// Kannala and Brandt: the position is `θ_d (x, y)/r` with `θ = atan2(r, z)` and `θ_d = θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸)`.
fn fisheye(k: &[f64; 4], point: &Vector3<f64>) -> Option<PinholePoint> {
    let across = Vector2::new(point.x, point.y);
    let (r, d) = (across.norm(), point.norm_squared());
    let angle = r.atan2(point.z);
    let (bent, slope) = bent_angle(k, angle);
    if !(d > 0.0 && angle < WIDEST && slope > 0.0) {
        return None;
    }
    let mut by_coefficients = [[0.0; 8]; 2];
    if r < 1e-9 * point.z.abs() {
        if point.z <= 0.0 {
            return None;
        }
        let (w, x) = (1.0 / point.z, across / point.z);
        let by_point = Matrix2x3::new(w, 0.0, -x.x * w, 0.0, w, -x.y * w);
        return Some((x, by_point, by_coefficients));
    }
    let unit = across / r;
    let s = angle * angle;
    let mut power = angle;
    let [by_u, by_v] = &mut by_coefficients;
    for (by_u, by_v) in by_u.iter_mut().zip(by_v).take(4) {
        power *= s;
        (*by_u, *by_v) = (unit.x * power, unit.y * power);
    }
    // θ moves by (z dr - r dz)/d, the unit vector across by (I - u uᵀ)/r.
    let around = (Matrix2::identity() - unit * unit.transpose()) * (bent / r);
    let outward = unit * unit.transpose() * (slope * point.z / d);
    let flat = around + outward;
    let deep = unit * (-slope * r / d);
    let by_point = Matrix2x3::new(flat[(0, 0)], flat[(0, 1)], deep.x, flat[(1, 0)], flat[(1, 1)], deep.y);
    Some((unit * bent, by_point, by_coefficients))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lenses() -> [Lens; 4] {
        let base = Lens::pinhole([1510.0, 1490.0], [960.0, 610.0]);
        [
            base,
            Lens { distortion: Distortion::Brown([-0.18, 0.04, 1e-3, -7e-4, -0.01, 0.0, 0.0, 0.0]), ..base },
            Lens { distortion: Distortion::Brown([0.4, 0.1, 4e-4, 2e-4, 0.02, 0.5, 0.15, 0.01]), ..base },
            Lens { distortion: Distortion::Fisheye([-0.02, 0.01, -0.004, 0.0005]), ..base },
        ]
    }

    /// Differences of 1e-6 have errors of about 1e-6 for derivatives of size 1e3: half of the digits.
    #[test]
    fn derivatives_are_those_of_differences() {
        let mut worst: f64 = 0.0;
        for lens in lenses() {
            for point in [[0.1, -0.2, 1.0], [0.4, 0.3, 0.9], [-0.3, 0.1, 2.0], [0.01, 0.0, 0.5]] {
                let point = Vector3::from(point);
                let found = lens.projection(&point).unwrap();
                let h = 1e-6;
                for k in 0..3 {
                    let step = Vector3::ith(k, h);
                    let slope =
                        (lens.pixel(&(point + step)).unwrap() - lens.pixel(&(point - step)).unwrap()) / (2.0 * h);
                    worst = worst.max((slope - found.by_point.column(k)).norm() / 1e3);
                }
                let numbers = lens.numbers();
                let used = if matches!(lens.distortion, Distortion::Fisheye(_)) { 8 } else { LENS_NUMBERS };
                for k in 0..used {
                    let at = |h: f64| {
                        let mut moved = numbers;
                        moved[k] += h;
                        lens.with_numbers(&moved).pixel(&point).unwrap()
                    };
                    let slope = (at(h) - at(-h)) / (2.0 * h);
                    let own = Vector2::new(found.by_lens[0][k], found.by_lens[1][k]);
                    worst = worst.max((slope - own).norm() / 1e3);
                }
            }
        }
        println!("derivatives of lenses: {worst:.1e} of 1e3 px");
        assert!(worst < 1e-8, "{worst:e}");
    }

    #[test]
    fn a_ray_has_its_pixel_and_none_behind_the_turn() {
        let mut worst: f64 = 0.0;
        for lens in lenses() {
            for pixel in [[0.0, 0.0], [960.0, 610.0], [1900.0, 30.0], [400.0, 1100.0]] {
                let pixel = Vector2::from(pixel);
                let ray = lens.ray(&pixel).unwrap();
                worst = worst.max((lens.pixel(&(ray * 0.7)).unwrap() - pixel).norm());
            }
        }
        println!("pixels of rays of pixels: {worst:.1e} px");
        assert!(worst < 1e-6, "{worst:e}");
        let strong = Lens { distortion: Distortion::Brown([-0.3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]), ..lenses()[0] };
        // r (1 - 0.3 r²) turns at r² = 1/0.9.
        assert!(strong.pixel(&Vector3::new(1.05, 0.0, 1.0)).is_some());
        assert_eq!(strong.pixel(&Vector3::new(1.06, 0.0, 1.0)), None);
        // Beyond the zero of the polynomial its image returns.
        assert_eq!(strong.pixel(&Vector3::new(3.0, 0.0, 1.0)), None);
        assert_eq!(strong.pixel(&Vector3::new(0.1, 0.0, -1.0)), None);
        assert_eq!(strong.pixel(&Vector3::zeros()), None);
    }
}
