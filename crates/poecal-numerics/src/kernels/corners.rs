//! Corners of one picture side by side: their predicted pixels, the derivatives, and the products of these (theory.md §4, *Pictures*).

use pulp::Simd;

use super::gram::{TILE, add_products, sums_len};
use super::plan::FixedMotion;
use super::vector::{LaneBlock, Lanes, Vectors, WIDTH, parts};

/// Motions of a board in its camera's frame: shifts, and turns about its origin.
pub const MOTIONS: usize = 6;
/// Components of a point.
const POINT: usize = 3;
/// Least share of a point's distance by which it is in front of the camera.
const BEFORE: f64 = 1e-2;

/// [`WIDTH`] corners; those of no weight are padding.
#[derive(Clone, Debug)]
pub struct Corners {
    /// Points of the board, m.
    pub point: [LaneBlock; POINT],
    /// Measured pixels, px.
    pub pixel: [LaneBlock; 2],
    /// Root of the weight, over the standard deviation, 1/px.
    pub root: LaneBlock,
}

impl Corners {
    /// Corners of weight zero.
    pub const NONE: Corners =
        Corners { point: [LaneBlock::ZERO; POINT], pixel: [LaneBlock::ZERO; 2], root: LaneBlock::ZERO };
}

/// A lens of Brown and Conrady, in the order of `LENS_NAMES` of cameras.
#[derive(Clone, Copy, Debug)]
pub struct BrownConrady {
    /// Numbers.
    pub numbers: [f64; 12],
    /// Number of unknown ones, which are the first.
    pub unknown: usize,
    /// Square of the slope from which on larger slopes have smaller images.
    pub turn: f64,
}

/// Products of the derivatives of one picture's corners.
#[derive(Clone, Debug, Default)]
pub struct CornerProducts {
    columns: Vec<LaneBlock>,
    sums: Vec<LaneBlock>,
    /// Motions, unknown numbers of the lens, and residual.
    used: usize,
    /// Upper triangle of their products, row-major.
    pub(crate) all: Vec<f64>,
    /// For each block the products of its corners: of all columns with each of the three components of the point, and of these with one
    /// another.
    pub by_point: Vec<LaneBlock>,
    /// Weight of corners that are not seen.
    pub unseen: f64,
}

impl CornerProducts {
    /// Numbers of a corner's products: of all columns with each component of its point, then of these with one another.
    pub fn of_corner(&self) -> usize {
        POINT * self.used + POINT * (POINT + 1) / 2
    }

    /// The product of two columns; the last column is the residual.
    pub fn product(&self, a: usize, b: usize) -> f64 {
        self.all[a.min(b) * self.used + a.max(b)]
    }

    /// Columns: motions, lens, residual.
    pub fn columns(&self) -> usize {
        self.used
    }
}

/// Computes the products of a picture at a pose; with those of each corner's point if it is unknown.
#[inline(always)]
pub(crate) fn corner_products<S: Simd>(
    simd: S,
    lens: &BrownConrady,
    pose: &FixedMotion,
    corners: &[Corners],
    with_points: bool,
    out: &mut CornerProducts,
) {
    let used = MOTIONS + lens.unknown + 1;
    let (columns, stride) = (used.next_multiple_of(TILE), 2 * corners.len());
    out.used = used;
    out.columns.clear();
    out.columns.resize((columns + POINT) * stride, LaneBlock::ZERO);
    let mut unseen = Lanes::splat(simd, 0.0);
    for (block, corners) in corners.iter().enumerate() {
        for part in parts(simd) {
            let missed = write(simd, (lens, pose), corners, (&mut out.columns[2 * block..], stride, columns), part);
            unseen = unseen + missed;
        }
    }
    out.unseen = unseen.sum();
    out.sums.clear();
    out.sums.resize(sums_len(columns, S::F64_LANES), LaneBlock::ZERO);
    add_products(simd, &out.columns, (stride, stride), columns, &mut out.sums, |_, _| true);
    gather(simd, columns, out);
    out.by_point.clear();
    if with_points {
        for block in 0..corners.len() {
            products_of_points(simd, (used, columns, stride), block, out);
        }
    }
}

/// Sums the lanes of all products.
#[inline(always)]
fn gather<S: Simd>(simd: S, columns: usize, out: &mut CornerProducts) {
    let used = out.used;
    out.all.clear();
    out.all.resize(used * used, 0.0);
    let mut at = 0;
    for i in (0..columns).step_by(TILE) {
        for j in (i..columns).step_by(TILE) {
            for product in 0..TILE * TILE {
                let (a, b) = (i + product / TILE, j + product % TILE);
                if a < used && b < used && a <= b {
                    let wide = &out.sums[at * S::F64_LANES / WIDTH];
                    out.all[a * used + b] = Lanes::load(simd, wide, at % (WIDTH / S::F64_LANES)).sum();
                }
                at += 1;
            }
        }
    }
}

/// Products with the components of the points of one block, corner by corner.
#[inline(always)]
fn products_of_points<S: Simd>(
    simd: S,
    (used, first, stride): (usize, usize, usize),
    block: usize,
    out: &mut CornerProducts,
) {
    let begin = out.by_point.len();
    out.by_point.resize(begin + out.of_corner(), LaneBlock::ZERO);
    let (columns, found) = (&out.columns, &mut out.by_point[begin..]);
    for part in parts(simd) {
        let point = [
            pair(simd, columns, first * stride + 2 * block, part),
            pair(simd, columns, (first + 1) * stride + 2 * block, part),
            pair(simd, columns, (first + 2) * stride + 2 * block, part),
        ];
        for own in 0..used {
            let [a, b] = pair(simd, columns, own * stride + 2 * block, part);
            for k in 0..POINT {
                let [c, d] = point[k];
                a.times_plus(c, b * d).store(&mut found[k * used + own], part);
            }
        }
        let mut at = POINT * used;
        for k in 0..POINT {
            for l in k..POINT {
                let ([a, b], [c, d]) = (point[k], point[l]);
                a.times_plus(c, b * d).store(&mut found[at], part);
                at += 1;
            }
        }
    }
}

/// Writes both rows of a column.
#[inline(always)]
fn put<S: Simd>(out: &mut [LaneBlock], at: usize, [u, v]: [Lanes<S>; 2], part: usize) {
    u.store(&mut out[at], part);
    v.store(&mut out[at + 1], part);
}

/// Both rows of a column.
#[inline(always)]
fn pair<S: Simd>(simd: S, columns: &[LaneBlock], at: usize, part: usize) -> [Lanes<S>; 2] {
    [Lanes::load(simd, &columns[at], part), Lanes::load(simd, &columns[at + 1], part)]
}

/// Writes the columns of one block; returns the squared roots of corners that are not seen.
#[inline(always)]
fn write<S: Simd>(
    simd: S,
    (lens, pose): (&BrownConrady, &FixedMotion),
    corners: &Corners,
    (out, stride, columns): (&mut [LaneBlock], usize, usize),
    part: usize,
) -> Lanes<S> {
    let numbers = &lens.numbers;
    let (fx, fy) = (Lanes::splat(simd, numbers[0]), Lanes::splat(simd, numbers[1]));
    let (cx, cy) = (Lanes::splat(simd, numbers[2]), Lanes::splat(simd, numbers[3]));
    let (k1, k2) = (Lanes::splat(simd, numbers[4]), Lanes::splat(simd, numbers[5]));
    let (p1, p2) = (Lanes::splat(simd, numbers[6]), Lanes::splat(simd, numbers[7]));
    let (k3, k4) = (Lanes::splat(simd, numbers[8]), Lanes::splat(simd, numbers[9]));
    let (k5, k6) = (Lanes::splat(simd, numbers[10]), Lanes::splat(simd, numbers[11]));
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let two = Lanes::splat(simd, 2.0);
    let root = Lanes::load(simd, &corners.root, part);
    let point = Vectors::load(simd, &corners.point, part);
    let FixedMotion { columns: [[a, d, g], [b, e, h], [c, f, i]], translation: [p, q, r] } = *pose;
    let turn = [Vectors::splat(simd, &[a, b, c]), Vectors::splat(simd, &[d, e, f]), Vectors::splat(simd, &[g, h, i])];
    let arm = Vectors([turn[0].dot(point), turn[1].dot(point), turn[2].dot(point)]);
    let [x, y, z] = arm.0;
    let (x, y, z) = (x + Lanes::splat(simd, p), y + Lanes::splat(simd, q), z + Lanes::splat(simd, r));
    // The factor is 1 for a visible corner, else 0.
    let norm = x.times_plus(x, y.times_plus(y, z * z)).sqrt();
    let ahead = z - norm * Lanes::splat(simd, BEFORE);
    let before = ahead.divide_or(ahead, 0.0);
    let w = before.divide_or(z, 0.0);
    let (a, b) = (x * w, y * w);
    let s = a.times_plus(a, b * b);
    let above = s.times_plus(s.times_plus(s.times_plus(k3, k2), k1), one);
    let below = s.times_plus(s.times_plus(s.times_plus(k6, k5), k4), one);
    let inside = Lanes::splat(simd, lens.turn) - s;
    let seen = before * inside.divide_or(inside, 0.0) * below.divide_or(below, 0.0);
    let per = one.divide_or(below, 0.0);
    let radial = above * per;
    let three = Lanes::splat(simd, 3.0);
    let above_slope = s.times_plus(two.times_plus(k2, s * three * k3), k1);
    let below_slope = s.times_plus(two.times_plus(k5, s * three * k6), k4);
    let slope = radial.times_from(below_slope, above_slope) * per;
    let (ab, aa, bb) = (two * a * b, s.times_plus(one, two * a * a), s.times_plus(one, two * b * b));
    let place_x = a.times_plus(radial, p1.times_plus(ab, p2 * aa));
    let place_y = b.times_plus(radial, p1.times_plus(bb, p2 * ab));
    let six = Lanes::splat(simd, 6.0);
    let j00 = radial + two * a * a * slope + two * p1 * b + six * p2 * a;
    let j01 = ab * slope + two * p1 * a + two * p2 * b;
    let j11 = radial + two * b * b * slope + six * p1 * b + two * p2 * a;
    let scale = root * seen;
    let (u, v) = (fx * w * scale, fy * w * scale);
    let by_u = Vectors([u * j00, u * j01, -(u * (j00 * a + j01 * b))]);
    let by_v = Vectors([v * j01, v * j11, -(v * (j01 * a + j11 * b))]);
    // `δ + ω × R P`: the derivative by a rotation is `R P × ∂`.
    let (turn_u, turn_v) = (arm.cross(by_u), arm.cross(by_v));
    for k in 0..POINT {
        put(out, k * stride, [by_u.0[k], by_v.0[k]], part);
        put(out, (POINT + k) * stride, [turn_u.0[k], turn_v.0[k]], part);
        let along = Vectors([turn[0].0[k], turn[1].0[k], turn[2].0[k]]);
        put(out, (columns + k) * stride, [along.dot(by_u), along.dot(by_v)], part);
    }
    let (su, sv) = (scale * fx, scale * fy);
    let (s2, s3) = (s * s, s * s * s);
    let (up, down) = (per, -(radial * per));
    let of_lens = [
        [scale * place_x, zero],
        [zero, scale * place_y],
        [scale, zero],
        [zero, scale],
        [su * a * up * s, sv * b * up * s],
        [su * a * up * s2, sv * b * up * s2],
        [su * ab, sv * bb],
        [su * aa, sv * ab],
        [su * a * up * s3, sv * b * up * s3],
        [su * a * down * s, sv * b * down * s],
        [su * a * down * s2, sv * b * down * s2],
        [su * a * down * s3, sv * b * down * s3],
    ];
    for (k, column) in of_lens.iter().enumerate().take(lens.unknown) {
        put(out, (MOTIONS + k) * stride, *column, part);
    }
    let error_u = scale * (Lanes::load(simd, &corners.pixel[0], part) - fx.times_plus(place_x, cx));
    let error_v = scale * (Lanes::load(simd, &corners.pixel[1], part) - fy.times_plus(place_y, cy));
    put(out, (MOTIONS + lens.unknown) * stride, [error_u, error_v], part);
    root * root * (one - seen)
}
