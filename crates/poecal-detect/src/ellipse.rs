//! Position of a dark dot: a blurred ellipse on light ground, fitted to the levels of the surrounding pixels.
//!
//! The model of the light at p is `(m + b s)(1 + g · (p - p₀))`, with s the sign of the distance from the ellipse under a Gaussian blur. Dots are
//! dark within. Both shades are unknowns, so neither a gradient of the light nor a wrong threshold between dark and light moves the centre.

use nalgebra::{Matrix2, SMatrix, SVector, Vector2};

use crate::gray::Gray;
use crate::normal::{LANES, LaneArray, PixelEquations, Pixels, sign_and_bell};
use crate::vector::run_vectorized;

/// A detected dot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dot {
    /// The middle of the ellipse.
    pub(crate) place: Vector2<f64>,
    /// Matrix that maps the ellipse to a unit circle.
    pub(crate) to_circle: Matrix2<f64>,
    /// Standard deviation of each coordinate, pixels.
    pub(crate) sigma_px: f64,
    /// Blur, pixels.
    pub(crate) blur_px: f64,
    /// Half of light minus dark, gray levels.
    pub(crate) half_contrast: f64,
    /// Level between dark and light.
    pub(crate) mean: f64,
    /// Residual of the ellipse beyond the noise, as a part of the half contrast.
    pub(crate) misfit: f64,
}

const UNKNOWNS: usize = 10;
type EllipseUnknowns = SVector<f64, UNKNOWNS>;

/// Largest residual of the model beyond the noise, as a part of the contrast.
const MISFIT: f64 = 0.22;
/// Floor of the standard deviation, pixels: uneven ink and light, pixels of a finite size.
const FLOOR_PX: f64 = 0.008;
/// Largest standard deviation of an accepted centre, pixels.
const WORST_PX: f64 = 0.4;
/// Shortest half axis, pixels.
const SHORTEST_PX: f64 = 1.6;
/// Least half contrast, gray levels.
const LEAST_HALF: f64 = 2.0;
/// Number of pixels that suffices for a coarse fit.
const ENOUGH: usize = 200;
/// Largest residual of a coarse fit to a part of the pixels, which has not converged.
const COARSE_MISFIT: f64 = 0.28;
/// Longest last step, pixels, and its largest relative gain of the squares: for a first fit, and for the last one.
const COARSE: [f64; 2] = [0.05, 0.02];
const FINE: [f64; 2] = [2e-3, 1e-4];
/// Most fitted pixels.
const MOST: usize = 40_000;

/// Finds a dot near an ellipse: its middle, and the matrix that maps it to a unit circle. `None` if there is no dot.
pub(crate) fn fit(gray: &Gray, place: Vector2<f64>, to_circle: Matrix2<f64>, noise: f64) -> Option<Dot> {
    let pixels = window(gray, place, &to_circle)?;
    let start = EllipseModel::start(place, to_circle, &pixels);
    let reach = to_circle.try_inverse()?.norm() * 0.35 + 1.5;
    let coarse = fit_coarse(start, &pixels, noise).filter(|it| (it.place - place).norm() < 1.2 * reach)?;
    let mut middle = coarse.place;
    let mut pixels = window(gray, middle, &coarse.to_circle)?;
    let (mut model, mut sums) = descend_dot(coarse, &pixels, middle, FINE)?;
    // A misplaced window omits informative pixels, and includes some of other dots.
    if is_far(&coarse, &model) {
        middle = model.place;
        pixels = window(gray, middle, &model.to_circle)?;
        (model, sums) = descend_dot(model, &pixels, middle, FINE)?;
    }
    let dot = model.judge(&sums, pixels.len(), noise)?;
    let sound = (dot.place - place).norm() < reach && gray.holds(dot.place, 1.0);
    sound.then_some(dot)
}

/// A fit to a part of the pixels, which nearly converges, and rejects most candidates that are no dots: most candidates are none.
fn fit_coarse(start: EllipseModel, pixels: &Pixels, noise: f64) -> Option<EllipseModel> {
    // Blur reduces the contrast of a small dot only to a limited extent.
    if start.half < 0.5 * noise.max(LEAST_HALF) {
        return None;
    }
    let few = thin_pixels(pixels);
    let (model, sums) = descend_dot(start, &few, start.place, COARSE)?;
    let most = 1.5 * noise * noise + (COARSE_MISFIT * model.half).powi(2);
    (model.half > 0.0 && sums.squares < most * few.len() as f64).then_some(model)
}

/// True if a fit is farther from its start than the window of its pixels may be.
fn is_far(start: &EllipseModel, fit: &EllipseModel) -> bool {
    let grown = (fit.to_circle - start.to_circle).norm() / start.to_circle.norm();
    (fit.place - start.place).norm() > 0.3 || grown > 0.03
}

/// Pixels that are spread evenly, if there are many.
fn thin_pixels(pixels: &Pixels) -> Pixels {
    let step = [10, 5, 2].into_iter().find(|step| pixels.len() >= step * ENOUGH).unwrap_or(1);
    let first = pixels.origin.x as i64 + 3 * pixels.origin.y as i64;
    let mut kept = Pixels::new(pixels.origin);
    for [x, y, level] in pixels.iter_pixels() {
        if (first + x as i64 + 3 * y as i64) % step as i64 == 0 {
            kept.push(x, y, level);
        }
    }
    kept
}

/// The pixels of an ellipse, and of the light around it up to a near dot.
fn window(gray: &Gray, middle: Vector2<f64>, to_circle: &Matrix2<f64>) -> Option<Pixels> {
    let axes = to_circle.try_inverse()?;
    let least = axes.symmetric_eigenvalues().min();
    if least < SHORTEST_PX {
        return None;
    }
    let beyond = (0.6 * least).clamp(2.6, 6.0);
    let within = (0.8 * least).clamp(2.6, 9.0);
    let reach = Vector2::new(axes.row(0).norm() + beyond, axes.row(1).norm() + beyond);
    if !gray.holds(middle - reach, 0.0) || !gray.holds(middle + reach, 0.0) || reach.x * reach.y > MOST as f64 {
        return None;
    }
    let mut pixels = Pixels::new(middle);
    let [x, y] = pixels.offset(middle);
    let outline = EllipseOutline::new(to_circle, [x, y]);
    let columns = (middle.x - reach.x).ceil() as usize..(middle.x + reach.x) as usize + 1;
    let from = columns.start as f32 - pixels.origin.x as f32;
    let mut offs: Vec<LaneArray> = vec![[0.0; LANES]; columns.len().div_ceil(LANES)];
    for row in (middle.y - reach.y).ceil() as usize..=(middle.y + reach.y) as usize {
        let y = row as f32 - pixels.origin.y as f32;
        run_vectorized(
            #[inline(always)]
            || outline.row(from, y, &mut offs),
        );
        for (k, level) in gray.row(row).get(columns.clone())?.iter().enumerate() {
            let off = offs[k / LANES][k % LANES];
            // Pixels deep inside contain no information on the position.
            if off < beyond as f32 && off > -within as f32 {
                pixels.push(from + k as f32, y, *level);
            }
        }
    }
    (pixels.len() >= 3 * UNKNOWNS).then_some(pixels)
}

/// The outline of an ellipse near the origin of pixels.
struct EllipseOutline {
    place: [f32; 2],
    /// Symmetric matrix that maps the ellipse to a unit circle: both diagonal elements, and the one beside them.
    to_circle: [f32; 3],
}

/// Distance of a point from an ellipse, with derivatives.
struct EllipseDistance {
    /// Distance to first order, positive outside.
    off: f32,
    /// Direction of its increase.
    outwards: [f32; 2],
    /// Unit direction in the circle, and derivative of the radius along `outwards`.
    circle: [f32; 2],
    steep: f32,
}

impl EllipseOutline {
    fn new(to_circle: &Matrix2<f64>, place: [f32; 2]) -> Self {
        let to_circle = [to_circle[(0, 0)], to_circle[(1, 1)], to_circle[(0, 1)]].map(|it| it as f32);
        EllipseOutline { place, to_circle }
    }

    /// The distance of a point from the ellipse, by its vector from the middle.
    #[inline(always)]
    fn distance(&self, dx: f32, dy: f32) -> EllipseDistance {
        let [xx, yy, xy] = self.to_circle;
        let (x, y) = (xx * dx + xy * dy, xy * dx + yy * dy);
        let radius = (x * x + y * y).sqrt().max(1e-6);
        let (x, y) = (x / radius, y / radius);
        let (slope_x, slope_y) = (xx * x + xy * y, xy * x + yy * y);
        let steep = (slope_x * slope_x + slope_y * slope_y).sqrt().max(1e-9);
        let scale = 1.0 / steep;
        EllipseDistance {
            off: (radius - 1.0) * scale,
            outwards: [slope_x * scale, slope_y * scale],
            circle: [x, y],
            steep,
        }
    }

    /// The distances of the pixels of a row from the ellipse.
    #[inline(always)]
    fn row(&self, from: f32, y: f32, offs: &mut [LaneArray]) {
        for (at, offs) in offs.iter_mut().enumerate() {
            let first = from + (at * LANES) as f32 - self.place[0];
            for (k, off) in offs.iter_mut().enumerate() {
                *off = self.distance(first + k as f32, y - self.place[1]).off;
            }
        }
    }
}

#[derive(Clone, Copy)]
struct EllipseModel {
    place: Vector2<f64>,
    to_circle: Matrix2<f64>,
    blur: f64,
    mean: f64,
    half: f64,
    light: Vector2<f64>,
}

struct EllipseSums {
    normal: SMatrix<f64, UNKNOWNS, UNKNOWNS>,
    right: EllipseUnknowns,
    squares: f64,
}

impl EllipseModel {
    fn start(place: Vector2<f64>, to_circle: Matrix2<f64>, pixels: &Pixels) -> Self {
        let outline = EllipseOutline::new(&to_circle, pixels.offset(place));
        // Inside and outside pixels.
        let (mut sums, mut counts) = ([0.0; 2], [0.0; 2]);
        for [x, y, level] in pixels.iter_pixels() {
            let side = outline.distance(x - outline.place[0], y - outline.place[1]).off >= 0.0;
            sums[usize::from(side)] += f64::from(level);
            counts[usize::from(side)] += 1.0;
        }
        let [dark, light] = [0, 1].map(|k| sums[k] / f64::max(counts[k], 1.0));
        let (mean, half) = (0.5 * (light + dark), 0.5 * (light - dark));
        EllipseModel { place, to_circle, blur: 1.2, mean, half, light: Vector2::zeros() }
    }

    fn sums(&self, pixels: &Pixels, middle: Vector2<f64>) -> EllipseSums {
        let outline = EllipseOutline::new(&self.to_circle, pixels.offset(self.place));
        let middle = pixels.offset(middle);
        let (normal, right, squares) = run_vectorized(
            #[inline(always)]
            || {
                let mut sums = PixelEquations::<UNKNOWNS>::new();
                for (pixels, count) in pixels.chunks() {
                    let (mut rows, mut residuals) = self.rows(&outline, middle, pixels);
                    sums.add(&mut rows, &mut residuals, count);
                }
                sums.into_equations()
            },
        );
        EllipseSums { normal, right, squares }
    }

    /// Derivatives of the levels of pixels by the unknowns, and the residuals.
    #[inline(always)]
    fn rows(
        &self,
        outline: &EllipseOutline,
        middle: [f32; 2],
        [xs, ys, levels]: &[LaneArray; 3],
    ) -> ([LaneArray; UNKNOWNS], LaneArray) {
        const ROOT: f32 = 0.797_884_6;
        let (mut rows, mut left) = ([[0.0; LANES]; UNKNOWNS], [0.0; LANES]);
        let [by_blur, mean, half] = [1.0 / self.blur, self.mean, self.half].map(|it| it as f32);
        let slopes = [self.light.x as f32, self.light.y as f32];
        for at in 0..LANES {
            let (dx, dy) = (xs[at] - outline.place[0], ys[at] - outline.place[1]);
            let EllipseDistance { off, outwards, circle, steep } = outline.distance(dx, dy);
            let (x, y) = (xs[at] - middle[0], ys[at] - middle[1]);
            let light = 1.0 + slopes[0] * x + slopes[1] * y;
            let (sign, bell) = sign_and_bell(off * by_blur);
            let base = mean + half * sign;
            let slope = half * light * ROOT * bell * by_blur;
            let part = slope / steep;
            let along = [circle[0] * part, circle[1] * part];
            rows[0][at] = -slope * outwards[0];
            rows[1][at] = -slope * outwards[1];
            rows[2][at] = along[0] * dx;
            rows[3][at] = along[0] * dy + along[1] * dx;
            rows[4][at] = along[1] * dy;
            rows[5][at] = -slope * off;
            rows[6][at] = light;
            rows[7][at] = light * sign;
            rows[8][at] = base * x;
            rows[9][at] = base * y;
            left[at] = levels[at] - base * light;
        }
        (rows, left)
    }

    fn step_by(&self, step: &EllipseUnknowns) -> Self {
        let change = Matrix2::new(step[2], step[3], step[3], step[4]);
        let size = change.norm() / self.to_circle.norm();
        let long = (step[0].hypot(step[1]) / 1.5).max(size / 0.25).max(1.0);
        let step = step / long;
        EllipseModel {
            place: self.place + Vector2::new(step[0], step[1]),
            to_circle: self.to_circle + change / long,
            blur: (self.blur * step[5].clamp(-0.7, 0.7).exp()).clamp(0.25, 8.0),
            mean: self.mean + step[6],
            half: self.half + step[7],
            light: self.light + Vector2::new(step[8], step[9]),
        }
    }

    /// The dot, if the model explains the pixels.
    fn judge(&self, sums: &EllipseSums, pixels: usize, noise: f64) -> Option<Dot> {
        let variance = sums.squares / pixels.saturating_sub(UNKNOWNS).max(1) as f64;
        let covariance = sums.normal.cholesky()?.inverse() * variance;
        let sigma_px = (0.5 * (covariance[(0, 0)] + covariance[(1, 1)]) + FLOOR_PX * FLOOR_PX).sqrt();
        let left = (variance - noise * noise).max(0.0).sqrt();
        let axes = self.to_circle.symmetric_eigenvalues();
        let good = self.half > LEAST_HALF
            && self.half > noise
            && left < MISFIT * self.half
            && sigma_px < WORST_PX
            && axes.min() > 0.0
            && axes.max() < 1.0 / SHORTEST_PX
            && self.blur * axes.max() < 0.75;
        // Residual beyond the noise that chance does not explain.
        let chance = 1.0 + 2.5 * (2.0 / pixels as f64).sqrt();
        let beyond = (variance - noise * noise * chance).max(0.0).sqrt();
        let (EllipseModel { place, to_circle, blur, mean, half, .. }, misfit) = (*self, beyond / self.half);
        good.then_some(Dot { place, to_circle, sigma_px, blur_px: blur, half_contrast: half, mean, misfit })
    }
}

/// Levenberg-Marquardt from a start, until a step is short and its gain small.
fn descend_dot(
    mut model: EllipseModel,
    pixels: &Pixels,
    middle: Vector2<f64>,
    [short_px, little]: [f64; 2],
) -> Option<(EllipseModel, EllipseSums)> {
    let mut sums = model.sums(pixels, middle);
    let mut damping = 1e-3;
    for _ in 0..10 {
        let mut damped = sums.normal;
        for k in 0..UNKNOWNS {
            damped[(k, k)] = damped[(k, k)] * (1.0 + damping) + 1e-12;
        }
        let next = model.step_by(&damped.cholesky()?.solve(&sums.right));
        let found = next.sums(pixels, middle);
        if found.squares <= sums.squares {
            let moved = (next.place - model.place).norm();
            let gained = sums.squares - found.squares;
            (model, sums, damping) = (next, found, damping * 0.1);
            if moved < short_px && gained < little * sums.squares {
                break;
            }
        } else {
            damping *= 10.0;
            if damping > 1e5 {
                break;
            }
        }
    }
    Some((model, sums))
}
