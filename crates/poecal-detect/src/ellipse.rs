//! The place of a dark dot: a blurred ellipse on light ground, fitted to the levels of the pixels around.
//!
//! The model of the light at p is `(m + b s)(1 + g · (p - p₀))`, with s the sign of the distance from the ellipse under a Gaussian blur. Dots are
//! dark within. Both shades are unknowns, so neither a slope of the light nor a wrong limit between dark and light moves the centre.

use nalgebra::{Matrix2, SMatrix, SVector, Vector2};

use crate::gray::Gray;
use crate::normal::Normal;
use crate::saddle::sign_and_bell;

/// A dot that was found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dot {
    /// The middle of the ellipse.
    pub(crate) place: Vector2<f64>,
    /// What makes a unit circle of the ellipse.
    pub(crate) to_circle: Matrix2<f64>,
    /// Standard deviation of each coordinate, pixels.
    pub(crate) sigma_px: f64,
    /// Blur, pixels.
    pub(crate) blur_px: f64,
    /// Half of light minus dark, gray levels.
    pub(crate) half_contrast: f64,
    /// Level between dark and light.
    pub(crate) mean: f64,
    /// What the ellipse leaves beyond the noise, as a part of the half contrast.
    pub(crate) misfit: f64,
}

const UNKNOWNS: usize = 10;
/// Those of the shades.
const SHADES: usize = 4;
type Unknowns = SVector<f64, UNKNOWNS>;
/// A pixel and its level.
type Pixel = (Vector2<f64>, f64);

/// Largest part of the contrast that the model may leave beyond the noise.
const MISFIT: f64 = 0.22;
/// What no fit is better than, pixels: uneven ink and light, pixels of a finite size.
const FLOOR_PX: f64 = 0.008;
/// Least certain centre that counts, pixels.
const WORST_PX: f64 = 0.4;
/// Shortest half axis, pixels.
const SHORTEST_PX: f64 = 1.6;
/// Least half contrast, gray levels.
const LEAST_HALF: f64 = 2.0;
/// Pixels that find most of the way.
const ENOUGH: usize = 200;
/// The same of a fit to a part of the pixels, which is not at its end.
const COARSE_MISFIT: f64 = 0.28;
/// Longest last step, pixels, and what it may gain, as a part of the squares: of a first fit, and of the last one.
const COARSE: [f64; 2] = [0.05, 0.02];
const FINE: [f64; 2] = [2e-3, 1e-4];
/// Distance from the edge beyond which a pixel is dark or light, standard deviations of the blur: to 1e-5 of the contrast.
const PLAIN: f64 = 4.5;
/// Most pixels that are fitted.
const MOST: usize = 40_000;

/// Finds a dot near where an ellipse is: its middle, and what makes a unit circle of it. `None` if none is there.
pub(crate) fn fit(gray: &Gray, place: Vector2<f64>, to_circle: Matrix2<f64>, noise: f64) -> Option<Dot> {
    let pixels = window(gray, place, &to_circle)?;
    let start = Model::start(place, to_circle, &pixels);
    let reach = to_circle.try_inverse()?.norm() * 0.35 + 1.5;
    let coarse = begun(start, &pixels, noise).filter(|it| (it.place - place).norm() < 1.2 * reach)?;
    let mut middle = coarse.place;
    let mut pixels = window(gray, middle, &coarse.to_circle)?;
    let (mut model, mut sums) = descended(coarse, &pixels, middle, FINE)?;
    // A window that is off leaves out pixels that tell much, and has some of other dots.
    if is_far(&coarse, &model) {
        middle = model.place;
        pixels = window(gray, middle, &model.to_circle)?;
        (model, sums) = descended(model, &pixels, middle, FINE)?;
    }
    let dot = model.judged(&sums, pixels.len(), noise)?;
    let sound = (dot.place - place).norm() < reach && gray.holds(dot.place, 1.0);
    sound.then_some(dot)
}

/// A fit to a part of the pixels, which goes most of the way, and tells most of what is no dot: that is most of what is tried.
fn begun(start: Model, pixels: &[Pixel], noise: f64) -> Option<Model> {
    // Blur takes a part of the contrast of a small dot, but not so much.
    if start.half < 0.5 * noise.max(LEAST_HALF) {
        return None;
    }
    let few = thinned(pixels);
    let (model, sums) = descended(start, &few, start.place, COARSE)?;
    let most = 1.5 * noise * noise + (COARSE_MISFIT * model.half).powi(2);
    (model.half > 0.0 && sums.squares < most * few.len() as f64).then_some(model)
}

/// Whether a fit is farther from its start than the window of its pixels may be.
fn is_far(start: &Model, fit: &Model) -> bool {
    let grown = (fit.to_circle - start.to_circle).norm() / start.to_circle.norm();
    (fit.place - start.place).norm() > 0.3 || grown > 0.03
}

/// Pixels that are spread evenly, if there are many.
fn thinned(pixels: &[Pixel]) -> Vec<Pixel> {
    let step = [10, 5, 2].into_iter().find(|step| pixels.len() >= step * ENOUGH).unwrap_or(1);
    let kept = |it: &&Pixel| (it.0.x as usize + 3 * it.0.y as usize).is_multiple_of(step);
    pixels.iter().filter(kept).copied().collect()
}

/// The pixels of an ellipse, and of the light around it as far as another dot is not near.
fn window(gray: &Gray, middle: Vector2<f64>, to_circle: &Matrix2<f64>) -> Option<Vec<Pixel>> {
    let axes = to_circle.try_inverse()?;
    let least = axes.symmetric_eigenvalues().min();
    if least < SHORTEST_PX {
        return None;
    }
    let beyond = (0.6 * least).clamp(2.6, 6.0);
    let within = (0.8 * least).clamp(2.6, 9.0);
    let reach = Vector2::new(axes.row(0).norm() + beyond, axes.row(1).norm() + beyond);
    if !gray.holds(middle - reach, 0.0) || !gray.holds(middle + reach, 0.0) || reach.x * reach.y > MOST as f64
    {
        return None;
    }
    let mut pixels = Vec::with_capacity((4.0 * reach.x * reach.y) as usize);
    for row in (middle.y - reach.y).ceil() as usize..=(middle.y + reach.y) as usize {
        let levels = gray.row(row);
        for column in (middle.x - reach.x).ceil() as usize..=(middle.x + reach.x) as usize {
            let place = Vector2::new(column as f64, row as f64);
            let off = distance(to_circle, place - middle).off;
            // Deep within there is nothing that tells the place.
            if off < beyond && off > -within {
                pixels.push((place, f64::from(*levels.get(column)?)));
            }
        }
    }
    (pixels.len() >= 3 * UNKNOWNS).then_some(pixels)
}

/// How far a place is from an ellipse.
struct Off {
    /// To first order, positive outside.
    off: f64,
    /// Which way it grows.
    outwards: Vector2<f64>,
    /// The way there in the circle, of length 1, and how fast the radius grows along `outwards`.
    circle: Vector2<f64>,
    steep: f64,
}

fn distance(to_circle: &Matrix2<f64>, off: Vector2<f64>) -> Off {
    let circle = to_circle * off;
    let radius = circle.norm().max(1e-6);
    let circle = circle / radius;
    let slope = to_circle * circle;
    let steep = slope.norm().max(1e-9);
    Off { off: (radius - 1.0) / steep, outwards: slope / steep, circle, steep }
}

#[derive(Clone, Copy)]
struct Model {
    place: Vector2<f64>,
    to_circle: Matrix2<f64>,
    blur: f64,
    mean: f64,
    half: f64,
    light: Vector2<f64>,
}

struct Sums {
    normal: SMatrix<f64, UNKNOWNS, UNKNOWNS>,
    right: Unknowns,
    squares: f64,
}

impl Model {
    fn start(place: Vector2<f64>, to_circle: Matrix2<f64>, pixels: &[Pixel]) -> Self {
        let mean_of = |inside: bool| {
            let side = pixels.iter().filter(|it| (distance(&to_circle, it.0 - place).off < 0.0) == inside);
            let (sum, count) = side.fold((0.0, 0.0), |sum, it| (sum.0 + it.1, sum.1 + 1.0));
            sum / f64::max(count, 1.0)
        };
        let (dark, light) = (mean_of(true), mean_of(false));
        let (mean, half) = (0.5 * (light + dark), 0.5 * (light - dark));
        Model { place, to_circle, blur: 1.2, mean, half, light: Vector2::zeros() }
    }

    fn sums(&self, pixels: &[Pixel], middle: Vector2<f64>) -> Sums {
        const ROOT: f64 = 0.797_884_560_802_865_4;
        // Pixels far from the edge tell of the shades alone: the last unknowns.
        let (mut edge, mut plain) = (Normal::<UNKNOWNS>::new(), Normal::<SHADES>::new());
        let (plain_px, by_blur) = (PLAIN * self.blur, 1.0 / self.blur);
        for (pixel, level) in pixels {
            let d = pixel - self.place;
            let Off { off, outwards, circle, steep } = distance(&self.to_circle, d);
            let shift = pixel - middle;
            let light = 1.0 + self.light.dot(&shift);
            if off.abs() > plain_px {
                let sign = 1.0_f64.copysign(off);
                let base = self.mean + self.half * sign;
                plain.add([light, light * sign, base * shift.x, base * shift.y], level - base * light);
                continue;
            }
            let (sign, bell) = sign_and_bell(off * by_blur);
            let base = self.mean + self.half * sign;
            let slope = self.half * light * ROOT * bell * by_blur;
            let along = circle * (slope / steep);
            let row = [
                -slope * outwards.x,
                -slope * outwards.y,
                along.x * d.x,
                along.x * d.y + along.y * d.x,
                along.y * d.y,
                -slope * off,
                light,
                light * sign,
                base * shift.x,
                base * shift.y,
            ];
            edge.add(row, level - base * light);
        }
        let (normal, right, squares) = edge.finished_with(plain);
        Sums { normal, right, squares }
    }

    fn stepped(&self, step: &Unknowns) -> Self {
        let change = Matrix2::new(step[2], step[3], step[3], step[4]);
        let size = change.norm() / self.to_circle.norm();
        let long = (step[0].hypot(step[1]) / 1.5).max(size / 0.25).max(1.0);
        let step = step / long;
        Model {
            place: self.place + Vector2::new(step[0], step[1]),
            to_circle: self.to_circle + change / long,
            blur: (self.blur * step[5].clamp(-0.7, 0.7).exp()).clamp(0.25, 8.0),
            mean: self.mean + step[6],
            half: self.half + step[7],
            light: self.light + Vector2::new(step[8], step[9]),
        }
    }

    /// The dot, if the model explains the pixels.
    fn judged(&self, sums: &Sums, pixels: usize, noise: f64) -> Option<Dot> {
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
        // How far beyond the noise it is by more than chance.
        let chance = 1.0 + 2.5 * (2.0 / pixels as f64).sqrt();
        let beyond = (variance - noise * noise * chance).max(0.0).sqrt();
        let (Model { place, to_circle, blur, mean, half, .. }, misfit) = (*self, beyond / self.half);
        good.then_some(Dot { place, to_circle, sigma_px, blur_px: blur, half_contrast: half, mean, misfit })
    }
}

/// Levenberg-Marquardt from a start, until a step is short and gains little.
fn descended(
    mut model: Model,
    pixels: &[Pixel],
    middle: Vector2<f64>,
    [short_px, little]: [f64; 2],
) -> Option<(Model, Sums)> {
    let mut sums = model.sums(pixels, middle);
    let mut damping = 1e-3;
    for _ in 0..10 {
        let mut damped = sums.normal;
        for k in 0..UNKNOWNS {
            damped[(k, k)] = damped[(k, k)] * (1.0 + damping) + 1e-12;
        }
        let next = model.stepped(&damped.cholesky()?.solve(&sums.right));
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
