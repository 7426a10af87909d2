//! The corners of a tag whose cells are known: all of it fitted to the picture.
//!
//! The model is the tag seen through a homography, bent a little as a lens bends it, blurred, with a slope of the light. Every edge between cells
//! tells of the corners, not only the four sides; an edge beside another one within the blur does no harm, as the model has both.

use nalgebra::{SMatrix, SVector, Vector2};

use crate::gray::Gray;
use crate::homography::Homography;
use crate::normal::Normal;
use crate::quads::Quad;

/// The cells of a tag with its border, row by row: whether they are dark.
pub(crate) struct Cells {
    pub(crate) side: usize,
    pub(crate) dark: Vec<bool>,
}

impl Cells {
    /// The dark part of an upright rectangle: its middle, and half of its sides, in sides of the tag.
    fn dark_part(&self, middle: Vector2<f64>, half: Vector2<f64>) -> f64 {
        let side = self.side as f64;
        let half = half.sup(&Vector2::repeat(1e-6)) * side;
        let (low, high) = (middle * side - half, middle * side + half);
        // The first cell of each axis, and the one behind the last. Short whole numbers are turned into others faster.
        let first = |at: f64| at.clamp(0.0, side) as i32;
        let end = |at: f64| first(at) + i32::from(at.min(side) > f64::from(first(at)));
        let columns = first(low.x)..end(high.x);
        let rows = first(low.y)..end(high.y);
        let is_dark = |row: i32, column: i32| {
            self.dark.get(row as usize * self.side + column as usize).is_some_and(|it| *it)
        };
        // Most rectangles are within a cell.
        let inside = low.min() >= 0.0 && high.max() <= side;
        if inside && columns.len() == 1 && rows.len() == 1 {
            return f64::from(u8::from(is_dark(rows.start, columns.start)));
        }
        // How long the rectangle is on a row or column of cells.
        let part = |at: i32, [low, high]: [f64; 2]| high.min(f64::from(at) + 1.0) - low.max(f64::from(at));
        let mut sum = 0.0;
        for row in rows {
            let down = part(row, [low.y, high.y]);
            for column in columns.clone() {
                if is_dark(row, column) {
                    sum += down * part(column, [low.x, high.x]);
                }
            }
        }
        sum / (4.0 * half.x * half.y)
    }
}

/// A tag that was fitted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fitted {
    pub(crate) corners: Quad,
    /// Standard deviation of each coordinate of each corner, pixels.
    pub(crate) sigma_px: [f64; 4],
    pub(crate) blur_px: f64,
    /// Part of the contrast that the model leaves beyond the noise.
    misfit: f64,
    /// Part of the pixels that nothing covers.
    bare: f64,
}

impl Fitted {
    /// Whether it looks like nothing but a tag: what a code with so few bits that clutter has it needs beside the code.
    pub(crate) fn is_evident(&self) -> bool {
        self.misfit < CLEAR && self.bare > BARE
    }
}

const UNKNOWNS: usize = 15;
/// Those of the shape, which are first, and of the shades.
const SHAPE: usize = 11;
const SHADES: usize = UNKNOWNS - SHAPE;
type Unknowns = SVector<f64, UNKNOWNS>;

/// Width of the light rim that is fitted with the tag, cells.
const RIM: f64 = 0.7;
/// Standard deviation of the bend before, 1 / pixels: a lens with a strong distortion near its border.
const BEND: f64 = 1e-4;
/// Largest part of the contrast that the model may leave beyond the noise.
const MISFIT: f64 = 0.25;
/// The same of a tag that is evident, and the least part of its pixels that nothing covers. Of 203 drawn tags all but one leave 0.012 and cover
/// nothing; what has a code by chance, in four of 1,000 pictures of clutter, leaves more or is covered more.
const CLEAR: f64 = 0.06;
const BARE: f64 = 0.98;
/// What no fit is better than, pixels: uneven ink, paper that is not flat.
const FLOOR_PX: f64 = 0.012;
/// Least certain corner that counts, pixels.
const WORST_PX: f64 = 0.5;
/// Round after which pixels that something covers count no more. The first finds the shades.
const LIMITED: usize = 2;
/// Pixels left around a tag for the blur.
const AROUND: f64 = 6.0;
/// Most pixels around a tag.
const MOST: f64 = 2e6;

const SIGNS: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

/// Fits a tag near where a quadrangle is. `None` if the picture has none there.
pub(crate) fn fit(gray: &Gray, cells: &Cells, quad: &Quad, noise: f64) -> Option<Fitted> {
    let patch = Patch::new(gray, quad, noise)?;
    let mut model = Model::start(*quad);
    let mut seen = patch.seen(&model, cells)?;
    let mut limit = f64::INFINITY;
    let mut sums = model.sums(&patch, &seen, limit);
    let mut damping = 1e-3;
    for round in 0..14 {
        let mut damped = sums.normal;
        for k in 0..UNKNOWNS {
            damped[(k, k)] = damped[(k, k)] * (1.0 + damping) + 1e-9;
        }
        let next = model.stepped(&damped.cholesky()?.solve(&sums.right));
        let next_seen = patch.seen(&next, cells)?;
        let found = next.sums(&patch, &next_seen, limit);
        let moved = (0..4).map(|k| (next.corners[k] - model.corners[k]).norm()).fold(0.0, f64::max);
        if found.squares <= sums.squares {
            (model, seen, sums, damping) = (next, next_seen, found, damping * 0.2);
        } else {
            damping *= 8.0;
        }
        if (moved < 0.004 && round > LIMITED) || damping > 1e4 {
            break;
        }
        if round == LIMITED {
            let half = 0.5 * (model.light - model.dark);
            limit = (5.0 * noise).max(0.7 * half).max(1.0);
            sums = model.sums(&patch, &seen, limit);
        }
    }
    model.judged(&sums, quad, noise)
}

/// The pixels around a tag.
struct Patch {
    first: [usize; 2],
    size: [usize; 2],
    levels: Vec<f64>,
    middle: Vector2<f64>,
    /// Variance of the noise.
    variance: f64,
}

/// What a model has in a patch: how light pixels are, and where they are on the tag.
struct Seen {
    shade: Gray,
    /// Place on the tag, and whether it counts.
    at: Vec<Option<Vector2<f64>>>,
}

impl Patch {
    fn new(gray: &Gray, quad: &Quad, noise: f64) -> Option<Self> {
        let side = (quad[2] - quad[0]).norm().max((quad[3] - quad[1]).norm());
        let margin = AROUND + 0.15 * side;
        let low = quad.iter().fold(Vector2::repeat(f64::INFINITY), |sum, it| sum.inf(it)).add_scalar(-margin);
        let high = quad.iter().fold(Vector2::repeat(0.0), |sum, it| sum.sup(it)).add_scalar(margin);
        let first = [low.x.max(0.0) as usize, low.y.max(0.0) as usize];
        let last = [(high.x as usize).min(gray.width() - 1), (high.y as usize).min(gray.height() - 1)];
        let size = [0, 1].map(|k| (last[k] + 1).saturating_sub(first[k]));
        if size[0] < 12 || size[1] < 12 || (size[0] * size[1]) as f64 > MOST {
            return None;
        }
        let rows = first[1]..first[1] + size[1];
        let levels: Vec<f64> = rows
            .flat_map(|row| gray.row(row)[first[0]..first[0] + size[0]].iter().map(|it| f64::from(*it)))
            .collect();
        let middle = quad.iter().sum::<Vector2<f64>>() * 0.25;
        Some(Patch { first, size, levels, middle, variance: noise * noise })
    }

    fn place(&self, at: usize) -> Vector2<f64> {
        let (x, y) = (at % self.size[0] + self.first[0], at / self.size[0] + self.first[1]);
        Vector2::new(x as f64, y as f64)
    }

    /// How light the pixels are by a model, blurred, from 0 to 1.
    fn seen(&self, model: &Model, cells: &Cells) -> Option<Seen> {
        let back = model.back()?;
        let rim = RIM / cells.side as f64;
        let mut at = Vec::with_capacity(self.levels.len());
        let mut shade = Vec::with_capacity(self.levels.len());
        for k in 0..self.levels.len() {
            let flat = model.flat(&back, self.place(k));
            let own = flat.and_then(|it| back.map(it));
            let counts = own.filter(|it| it.min() > -rim && it.max() < 1.0 + rim);
            at.push(counts);
            // A cell farther off than the pixel is wide has one shade.
            let Some((place, middle)) = flat.zip(own.filter(|it| it.min() > -0.3 && it.max() < 1.3)) else {
                shade.push(1.0);
                continue;
            };
            shade.push((1.0 - cells.dark_part(middle, half_pixel(&back, place))) as f32);
        }
        let shade = Gray::new(self.size[0], self.size[1], shade).ok()?.blurred(model.blur, 3.2);
        Some(Seen { shade, at })
    }
}

/// Half the sides of the upright rectangle on the tag that spreads as far along both of its axes as a pixel does there.
fn half_pixel(back: &Homography, place: Vector2<f64>) -> Vector2<f64> {
    let slope = back.slope(place).unwrap_or_default();
    Vector2::new(slope.row(0).norm(), slope.row(1).norm()) * 0.5
}

#[derive(Clone, Copy)]
struct Model {
    corners: Quad,
    bend: Vector2<f64>,
    blur: f64,
    dark: f64,
    light: f64,
    slope: Vector2<f64>,
}

struct Sums {
    normal: SMatrix<f64, UNKNOWNS, UNKNOWNS>,
    right: Unknowns,
    squares: f64,
    /// Squares of what is left of all pixels, and their number.
    left: f64,
    count: usize,
    kept: usize,
}

impl Model {
    fn start(corners: Quad) -> Self {
        let slope = Vector2::zeros();
        Model { corners, bend: Vector2::zeros(), blur: 1.1, dark: 0.0, light: 0.0, slope }
    }

    /// From the picture to the tag, without the bend.
    fn back(&self) -> Option<Homography> {
        Homography::of_corners(&self.corners, &SIGNS.map(Vector2::from))
    }

    /// How much a place on the tag is bent: nothing at corners.
    fn bent(&self, at: Vector2<f64>) -> f64 {
        let [a, b, c, d] = self.corners;
        let (x, y) = ((b - a + c - d).norm_squared() * 0.25, (d - a + c - b).norm_squared() * 0.25);
        -(at.x * (1.0 - at.x) * x + at.y * (1.0 - at.y) * y)
    }

    /// Where a place in the picture would be without the bend, near the tag.
    fn flat(&self, back: &Homography, place: Vector2<f64>) -> Option<Vector2<f64>> {
        let first = back.map(place).filter(|it| it.amax() <= 3.0)?;
        Some(place - self.bend * self.bent(first))
    }

    fn sums(&self, patch: &Patch, seen: &Seen, limit: f64) -> Sums {
        let mut adder = Adder::new(limit);
        let (width, height) = (patch.size[0], patch.size[1]);
        let shades = seen.shade.levels();
        let shade = |at: usize| f64::from(shades[at]);
        for (at, own) in seen.at.iter().enumerate() {
            let (x, y) = (at % width, at / width);
            let Some(own) = own.filter(|_| x > 0 && y > 0 && x + 1 < width && y + 1 < height) else {
                continue;
            };
            let (left, right, up, down) =
                (shade(at - 1), shade(at + 1), shade(at - width), shade(at + width));
            let s = shade(at);
            let off = patch.place(at) - patch.middle;
            let light = 1.0 + self.slope.dot(&off);
            let base = self.dark + (self.light - self.dark) * s;
            let contrast = (self.light - self.dark) * light;
            let residual = patch.levels[at] - base * light;
            let shades = [light * (1.0 - s), light * s, base * off.x, base * off.y];
            let curve = left + right + up + down - 4.0 * s;
            if left == right && up == down && curve == 0.0 {
                adder.plain(shades, residual);
                continue;
            }
            // Where the tag moves by a step, the pixel sees what was before it.
            let (by_x, by_y) = (-0.5 * (right - left) * contrast, -0.5 * (down - up) * contrast);
            let weights =
                [(1.0 - own.x) * (1.0 - own.y), own.x * (1.0 - own.y), own.x * own.y, (1.0 - own.x) * own.y];
            let mut row = [0.0; UNKNOWNS];
            for (k, weight) in weights.into_iter().chain([self.bent(own)]).enumerate() {
                row[2 * k] = by_x * weight;
                row[2 * k + 1] = by_y * weight;
            }
            row[10] = contrast * self.blur * self.blur * curve;
            row[SHAPE..].copy_from_slice(&shades);
            adder.edge(row, residual);
        }
        let mut sums = adder.finished();
        let stiff = patch.variance / (BEND * BEND);
        for k in 0..2 {
            sums.normal[(8 + k, 8 + k)] += stiff;
            sums.right[8 + k] -= stiff * self.bend[k];
            sums.squares += stiff * self.bend[k] * self.bend[k];
        }
        sums
    }

    fn stepped(&self, step: &Unknowns) -> Self {
        let longest = (0..8).map(|k| step[k].abs()).fold(0.0, f64::max);
        // The first step finds the shades.
        let part = if self.light == self.dark { 0.0 } else { 1.0 / (longest / 1.2).max(1.0) };
        let mut next = *self;
        for k in 0..4 {
            next.corners[k] += Vector2::new(step[2 * k], step[2 * k + 1]) * part;
        }
        next.bend += Vector2::new(step[8], step[9]) * part;
        next.blur = (self.blur * (step[10] * part).clamp(-0.5, 0.5).exp()).clamp(0.25, 6.0);
        next.dark += step[11];
        next.light += step[12];
        next.slope += Vector2::new(step[13], step[14]) * part;
        next
    }

    fn judged(&self, sums: &Sums, quad: &Quad, noise: f64) -> Option<Fitted> {
        let half = 0.5 * (self.light - self.dark);
        let variance = sums.left / sums.kept.saturating_sub(UNKNOWNS).max(1) as f64;
        let left = (variance - noise * noise).max(0.0).sqrt();
        let covariance = sums.normal.cholesky()?.inverse() * variance;
        let sigma = |k: usize| {
            let both = covariance[(2 * k, 2 * k)] + covariance[(2 * k + 1, 2 * k + 1)];
            (0.5 * both + FLOOR_PX * FLOOR_PX).sqrt()
        };
        let sigma_px = [0, 1, 2, 3].map(sigma);
        let side = (quad[2] - quad[0]).norm().max((quad[3] - quad[1]).norm());
        let moved = (0..4).map(|k| (quad[k] - self.corners[k]).norm()).fold(0.0, f64::max);
        let (misfit, bare) = (left / half, sums.kept as f64 / sums.count.max(1) as f64);
        let good = half > 2.0
            && half > noise
            && misfit < MISFIT
            && moved < (0.06 * side).max(2.5)
            && sums.kept * 20 > sums.count * 19
            && sigma_px.iter().all(|it| *it < WORST_PX);
        good.then_some(Fitted { corners: self.corners, sigma_px, blur_px: self.blur, misfit, bare })
    }
}

/// Adds pixels up: those near no edge between cells tell of the shades alone, the last unknowns.
struct Adder {
    edge: Normal<UNKNOWNS>,
    plain: Normal<SHADES>,
    limit: f64,
    count: usize,
    kept: usize,
}

impl Adder {
    fn new(limit: f64) -> Self {
        Adder { edge: Normal::new(), plain: Normal::new(), limit, count: 0, kept: 0 }
    }

    /// Whether a pixel counts by more than its number.
    fn keeps(&mut self, residual: f64) -> bool {
        let keeps = residual.abs() <= self.limit;
        self.count += 1;
        self.kept += usize::from(keeps);
        keeps
    }

    fn edge(&mut self, row: [f64; UNKNOWNS], residual: f64) {
        if self.keeps(residual) {
            self.edge.add(row, residual);
        }
    }

    fn plain(&mut self, row: [f64; SHADES], residual: f64) {
        if self.keeps(residual) {
            self.plain.add(row, residual);
        }
    }

    fn finished(self) -> Sums {
        let Adder { edge, plain, limit, count, kept } = self;
        let (normal, right, left) = edge.finished_with(plain);
        // Without a limit none is beyond it.
        let beyond = if count > kept { (count - kept) as f64 * limit * limit } else { 0.0 };
        Sums { normal, right, squares: left + beyond, left, count, kept }
    }
}
