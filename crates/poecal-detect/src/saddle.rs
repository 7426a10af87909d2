//! Position of a corner: two crossing edges, blurred, fitted to the levels of the surrounding pixels.
//!
//! The model of the light at p is `(m + b S)(1 + g · (p - p₀))`, with S the mean of the product of the signs on both sides of two straight lines
//! under a Gaussian blur. It requires plain squares around a corner. The fit is least squares, so its covariance is that of the corner. A homography
//! keeps edges straight, and so keeps their crossing.

use nalgebra::{Matrix2, SMatrix, SVector, Vector2};

use crate::gray::Gray;
use crate::normal::{LANES, LaneArray, PixelEquations, Pixels, sign_and_bell};
use crate::vector::run_vectorized;

/// Prediction of a corner.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SaddlePrior {
    /// Predicted position, pixels.
    pub(crate) place: Vector2<f64>,
    /// Derivative of the position by x and y of the board, pixels per square.
    pub(crate) slope: Matrix2<f64>,
    /// Extent of its plain squares, squares.
    pub(crate) plain: f64,
    /// True if the square before it in x and y is dark.
    pub(crate) dark_before: bool,
    /// Radius of the search about its predicted position, pixels.
    pub(crate) search_px: f64,
}

/// A detected corner.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Saddle {
    pub(crate) place: Vector2<f64>,
    /// Standard deviation of each coordinate, pixels.
    pub(crate) sigma_px: f64,
    /// Blur, pixels.
    pub(crate) blur_px: f64,
    /// Half of light minus dark, gray levels.
    pub(crate) half_contrast: f64,
}

/// Largest distance of used pixels from the corner, along each edge.
const LARGEST_PX: f64 = 11.0;
/// Smallest window that determines a corner.
const LEAST_PX: f64 = 2.6;
/// Largest residual of the model beyond the noise, as a part of the contrast.
const MISFIT: f64 = 0.22;
/// Largest turn of an edge from its prediction by the board, rad.
const TURN: f64 = 0.45;
/// Floor of the standard deviation, pixels: curved edges, uneven ink.
const FLOOR_PX: f64 = 0.006;
/// Largest standard deviation of an accepted corner, pixels.
const WORST_PX: f64 = 0.4;

/// Finds a corner near its predicted position. `None` if there is none: no two crossing edges, exchanged shades, another direction, too little
/// contrast.
pub(crate) fn refine(gray: &Gray, expected: &SaddlePrior, noise: f64) -> Option<Saddle> {
    let is_front = expected.slope.determinant() > 0.0;
    if !is_front {
        return None;
    }
    let place = search(gray, expected)?;
    let window = CornerWindow::new(expected, LARGEST_PX)?;
    let whole = fit(gray, expected, place, &window, noise);
    if whole.is_some() {
        return whole;
    }
    // Another feature may be near.
    let smaller = CornerWindow::new(expected, LARGEST_PX * 0.45)?;
    fit(gray, expected, place, &smaller, noise)
}

/// A parallelogram around a corner in which its squares are plain.
struct CornerWindow {
    /// Map from pixels to the parallelogram, whose sides are at ±1.
    inverse: Matrix2<f64>,
    sides: Matrix2<f64>,
}

impl CornerWindow {
    fn new(expected: &SaddlePrior, largest_px: f64) -> Option<Self> {
        let area = expected.slope.determinant();
        let mut sides = expected.slope;
        for k in 0..2 {
            let length = expected.slope.column(k).norm();
            // Pixels across per step along.
            let across = area / expected.slope.column(1 - k).norm();
            let free = expected.plain - BLURRED_PX / across;
            let reach = free.max(LEAST_PX / across).min(expected.plain).min(largest_px / length);
            if reach * across < LEAST_PX * 0.8 {
                return None;
            }
            sides.column_mut(k).scale_mut(reach);
        }
        Some(CornerWindow { inverse: sides.try_inverse()?, sides })
    }

    fn pixels(&self, gray: &Gray, middle: Vector2<f64>) -> Pixels {
        let reach = self.sides.column(0).abs() + self.sides.column(1).abs();
        let span = |middle: f64, reach: f64, size: usize| {
            let from = (middle - reach).ceil().max(0.0) as usize;
            from..((middle + reach).floor().max(-1.0) + 1.0).min(size as f64) as usize
        };
        let mut pixels = Pixels::new(middle);
        for row in span(middle.y, reach.y, gray.height()) {
            let levels = gray.row(row);
            let y = row as f64;
            for column in span(middle.x, reach.x, gray.width()) {
                let x = column as f64;
                let own = self.inverse * Vector2::new(x - middle.x, y - middle.y);
                if own.x.abs() <= 1.0 && own.y.abs() <= 1.0 {
                    pixels.push((x - pixels.origin.x) as f32, (y - pixels.origin.y) as f32, levels[column]);
                }
            }
        }
        pixels
    }
}

/// Width of the blur of a marker beyond its border, pixels.
const BLURRED_PX: f64 = 1.2;

/// The position with the most contrast between the two pairs of squares.
fn search(gray: &Gray, expected: &SaddlePrior) -> Option<Vector2<f64>> {
    let window = CornerWindow::new(expected, LARGEST_PX)?;
    const AT: [[f64; 2]; 4] = [[0.3, 0.3], [0.7, 0.7], [0.25, 0.65], [0.65, 0.25]];
    let quarter = |place: Vector2<f64>, x: f64, y: f64| {
        let sum: f64 = AT
            .iter()
            .map(|[a, b]| gray.level_at(place + window.sides.column(0) * (a * x) + window.sides.column(1) * (b * y)))
            .sum();
        sum / AT.len() as f64
    };
    let response = |place: Vector2<f64>| {
        let same = [quarter(place, 1.0, 1.0), quarter(place, -1.0, -1.0)];
        let other = [quarter(place, 1.0, -1.0), quarter(place, -1.0, 1.0)];
        let (dark, light) = if expected.dark_before { (same, other) } else { (other, same) };
        light[0].min(light[1]) - dark[0].max(dark[1])
    };
    let reach = expected.search_px.ceil().clamp(0.0, 12.0) as i32;
    let offsets = (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| (x, y)));
    let near = |(x, y): &(i32, i32)| x * x + y * y <= reach * reach;
    let found: Vec<(Vector2<f64>, f64)> = offsets
        .filter(near)
        .map(|(x, y)| expected.place + Vector2::new(f64::from(x), f64::from(y)))
        .map(|place| (place, response(place)))
        .collect();
    let (best, most) = found.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))?;
    if most <= 0.0 || most.is_nan() {
        return None;
    }
    // Weighted mean near the best: the maximum is flat.
    let (mut sum, mut weights) = (Vector2::zeros(), 0.0);
    for (place, response) in found.iter().filter(|it| it.1 > 0.75 * most && (it.0 - best).norm() < 3.5) {
        sum += place * *response;
        weights += response;
    }
    Some(sum / weights)
}

const UNKNOWNS: usize = 9;
type SaddleUnknowns = SVector<f64, UNKNOWNS>;

/// Crossing lines: position, directions, blur, levels, gradient of the light.
#[derive(Clone)]
struct Crossing {
    place: Vector2<f64>,
    /// Directions of the lines along x and y of the board, rad.
    turns: [f64; 2],
    blur: f64,
    /// Mean level, and half the contrast, positive if the square before the corner is light.
    mean: f64,
    half: f64,
    light: Vector2<f64>,
}

/// Sums over pixels.
struct PixelSums {
    normal: SMatrix<f64, UNKNOWNS, UNKNOWNS>,
    right: SaddleUnknowns,
    squares: f64,
}

impl Crossing {
    fn start(expected: &SaddlePrior, place: Vector2<f64>, pixels: &Pixels) -> Self {
        let count = pixels.len().max(1) as f64;
        let levels = || pixels.iter_pixels().map(|it| f64::from(it[2]));
        let mean = levels().sum::<f64>() / count;
        let spread = (levels().map(|it| (it - mean).powi(2)).sum::<f64>() / count).sqrt();
        let turn = |k: usize| expected.slope[(1, k)].atan2(expected.slope[(0, k)]);
        let half = if expected.dark_before { -spread } else { spread };
        Crossing { place, turns: [turn(0), turn(1)], blur: 1.3, mean, half, light: Vector2::zeros() }
    }

    fn sums(&self, pixels: &Pixels, middle: Vector2<f64>) -> PixelSums {
        let (normal, right, squares) = run_vectorized(
            #[inline(always)]
            || {
                let near = OriginCrossing::new(self, pixels, middle);
                let mut sums = PixelEquations::<UNKNOWNS>::new();
                for (pixels, count) in pixels.chunks() {
                    let (mut rows, mut residuals) = near.rows(pixels);
                    sums.add(&mut rows, &mut residuals, count);
                }
                sums.into_equations()
            },
        );
        PixelSums { normal, right, squares }
    }

    /// Number of pixels with a common error, as in sharpened and compressed pictures: 1 plus twice the correlations of the residuals with those of
    /// the next pixels and those after them, in four directions.
    fn correlated_pixels(&self, pixels: &Pixels, middle: Vector2<f64>) -> f64 {
        let near = OriginCrossing::new(self, pixels, middle);
        let left: Vec<f32> = pixels.chunks().flat_map(|it| near.rows(it.0).1).collect();
        let ends = |k: usize| {
            let places = || pixels.iter_pixels().map(|it| it[k]);
            [places().fold(f32::INFINITY, f32::min), places().fold(f32::NEG_INFINITY, f32::max)]
        };
        let ([left_px, right_px], [top_px, bottom_px]) = (ends(0), ends(1));
        // Row by row, with zeros beside each row.
        let width = (right_px - left_px) as usize + 1 + 2;
        let size = (width * ((bottom_px - top_px) as usize + 1)).next_multiple_of(LANES);
        let mut all = vec![0.0_f32; size + 2 * width + 2];
        for ([x, y, _], own) in pixels.iter_pixels().zip(&left) {
            all[(y - top_px) as usize * width + (x - left_px) as usize] = *own;
        }
        // Those that follow in the row, and those in the next two.
        let beside = [1, 2].into_iter().chain([width, 2 * width].into_iter().flat_map(|it| it - 2..=it + 2));
        let product = |off: usize| {
            let mut sums: LaneArray = [0.0; LANES];
            let (own, other) = (all.as_chunks::<LANES>().0, all[off..].as_chunks::<LANES>().0);
            for (own, other) in own.iter().zip(other).take(size / LANES) {
                for k in 0..LANES {
                    sums[k] += own[k] * other[k];
                }
            }
            sums.iter().map(|it| f64::from(*it)).sum::<f64>()
        };
        let (squares, products) = (product(0), beside.map(product).sum::<f64>());
        1.0 + (2.0 * products / squares.max(1e-12)).max(0.0)
    }

    fn step_by(&self, step: &SaddleUnknowns) -> Self {
        // Beyond a pixel and a third of a radian the derivatives are not valid.
        let long = (step[0].hypot(step[1]) / 1.5).max(step[2].abs().max(step[3].abs()) / 0.35).max(1.0);
        let step = step / long;
        Crossing {
            place: self.place + Vector2::new(step[0], step[1]),
            turns: [self.turns[0] + step[2], self.turns[1] + step[3]],
            blur: (self.blur * step[4].clamp(-0.7, 0.7).exp()).clamp(0.25, 8.0),
            mean: self.mean + step[5],
            half: self.half + step[6],
            light: self.light + Vector2::new(step[7], step[8]),
        }
    }
}

/// A crossing near the origin of pixels.
struct OriginCrossing {
    place: [f32; 2],
    middle: [f32; 2],
    sines: [f32; 2],
    cosines: [f32; 2],
    /// Cosine of the angle between both lines.
    rho: f32,
    blur: f32,
    mean: f32,
    half: f32,
    light: [f32; 2],
}

impl OriginCrossing {
    fn new(crossing: &Crossing, pixels: &Pixels, middle: Vector2<f64>) -> Self {
        let [(s1, c1), (s2, c2)] = crossing.turns.map(f64::sin_cos);
        OriginCrossing {
            place: pixels.offset(crossing.place),
            middle: pixels.offset(middle),
            sines: [s1 as f32, s2 as f32],
            cosines: [c1 as f32, c2 as f32],
            rho: -(c1 * c2 + s1 * s2) as f32,
            blur: crossing.blur as f32,
            mean: crossing.mean as f32,
            half: crossing.half as f32,
            light: [crossing.light.x as f32, crossing.light.y as f32],
        }
    }

    /// Derivatives of the levels of pixels by the unknowns, and the residuals.
    #[inline(always)]
    fn rows(&self, [xs, ys, levels]: &[LaneArray; 3]) -> ([LaneArray; UNKNOWNS], LaneArray) {
        const ROOT: f32 = 0.797_884_6;
        let (mut rows, mut left) = ([[0.0; LANES]; UNKNOWNS], [0.0; LANES]);
        let ([s1, s2], [c1, c2], rho, scale) = (self.sines, self.cosines, self.rho, 1.0 / self.blur);
        for at in 0..LANES {
            let (dx, dy) = (xs[at] - self.place[0], ys[at] - self.place[1]);
            // Signed distances from both lines, in blurs.
            let (h, k) = ((c1 * dy - s1 * dx) * scale, (s2 * dx - c2 * dy) * scale);
            let (eh, gh) = sign_and_bell(h);
            let (ek, gk) = sign_and_bell(k);
            let both = std::f32::consts::FRAC_2_PI * gh * gk;
            let sign = eh * ek + both * skew(rho, h, k);
            let by_h = ROOT * gh * ek - h * both * rho;
            let by_k = ROOT * gk * eh - k * both * rho;
            let (x, y) = (xs[at] - self.middle[0], ys[at] - self.middle[1]);
            let light = 1.0 + self.light[0] * x + self.light[1] * y;
            let base = self.mean + self.half * sign;
            let slope = self.half * light;
            let (to_h, to_k) = (slope * by_h * scale, slope * by_k * scale);
            rows[0][at] = to_h * s1 - to_k * s2;
            rows[1][at] = to_k * c2 - to_h * c1;
            rows[2][at] = -to_h * (c1 * dx + s1 * dy);
            rows[3][at] = to_k * (c2 * dx + s2 * dy);
            rows[4][at] = -slope * (h * by_h + k * by_k);
            rows[5][at] = light;
            rows[6][at] = light * sign;
            rows[7][at] = base * x;
            rows[8][at] = base * y;
            left[at] = levels[at] - base * light;
        }
        (rows, left)
    }
}

/// The part of the blur for lines that are not at right angles: the first terms of Mehler's series.
#[inline(always)]
fn skew(rho: f32, h: f32, k: f32) -> f32 {
    rho * (1.0 + rho * (0.5 * h * k + rho / 6.0 * (h * h - 1.0) * (k * k - 1.0)))
}

/// Fits crossing lines in a window about a position.
fn fit(gray: &Gray, expected: &SaddlePrior, place: Vector2<f64>, window: &CornerWindow, noise: f64) -> Option<Saddle> {
    let mut middle = place;
    let mut pixels = window.pixels(gray, middle);
    if pixels.len() < 2 * UNKNOWNS {
        return None;
    }
    let mut crossing = Crossing::start(expected, place, &pixels);
    for round in 0..2 {
        crossing = descend_crossing(crossing, &pixels, middle, if round == 0 { 8 } else { 12 })?;
        if (crossing.place - expected.place).norm() > expected.search_px + 2.0 {
            return None;
        }
        if round == 0 && (crossing.place - middle).norm() > 0.4 {
            middle = crossing.place;
            pixels = window.pixels(gray, middle);
            if pixels.len() < 2 * UNKNOWNS {
                return None;
            }
        }
    }
    let sums = crossing.sums(&pixels, middle);
    let variance = sums.squares / (pixels.len() - UNKNOWNS) as f64;
    let covariance = sums.normal.cholesky()?.inverse() * (variance * crossing.correlated_pixels(&pixels, middle));
    let sigma_px = (0.5 * (covariance[(0, 0)] + covariance[(1, 1)]) + FLOOR_PX * FLOOR_PX).sqrt();
    let half = if expected.dark_before { -crossing.half } else { crossing.half };
    let start = Crossing::start(expected, place, &pixels);
    let turned = (0..2).map(|k| (crossing.turns[k] - start.turns[k]).abs()).fold(0.0, f64::max);
    let left = (variance - noise * noise).max(0.0).sqrt();
    let inside = window.inverse * (crossing.place - middle);
    let good = half > 2.0
        && half > noise
        && left < MISFIT * half
        && turned < TURN
        && sigma_px < WORST_PX
        && inside.amax() < 0.5
        && gray.holds(crossing.place, 1.0);
    good.then_some(Saddle { place: crossing.place, sigma_px, blur_px: crossing.blur, half_contrast: half })
}

/// Levenberg-Marquardt from a start.
fn descend_crossing(mut crossing: Crossing, pixels: &Pixels, middle: Vector2<f64>, steps: usize) -> Option<Crossing> {
    let mut sums = crossing.sums(pixels, middle);
    let mut damping = 1e-3;
    for _ in 0..steps {
        let mut damped = sums.normal;
        for k in 0..UNKNOWNS {
            damped[(k, k)] = damped[(k, k)] * (1.0 + damping) + 1e-12;
        }
        let step = damped.cholesky()?.solve(&sums.right);
        let next = crossing.step_by(&step);
        let found = next.sums(pixels, middle);
        let moved = (next.place - crossing.place).norm();
        if found.squares <= sums.squares {
            (crossing, sums, damping) = (next, found, damping * 0.1);
        } else {
            damping *= 10.0;
        }
        if moved < 1e-4 || damping > 1e6 {
            break;
        }
    }
    Some(crossing)
}
