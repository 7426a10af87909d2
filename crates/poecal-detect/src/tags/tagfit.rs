//! The corners of a tag with known cells: the whole tag is fitted to the picture.
//!
//! The model is the tag seen through a homography, slightly bent as by a lens, blurred, with a gradient of the light. Every edge between cells
//! contributes to the corners, not only the four sides. An edge beside another one within the blur causes no bias, as the model has both.

use nalgebra::SMatrix;

use crate::gray::Gray;
use crate::normal::{LANES, PixelEquations, lanes};
use crate::patch::{PatchModel, TagCells, TagPatch};
use crate::quads::Quad;
use crate::tagmodel::{TagModel, TagUnknowns, UNKNOWNS, bend_at};
use crate::vector::run_vectorized;

/// A fitted tag.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FittedTag {
    pub(crate) corners: Quad,
    /// Standard deviation of each coordinate of each corner, pixels.
    pub(crate) sigma_px: [f64; 4],
    pub(crate) blur_px: f64,
    /// Residual of the model beyond the noise, as a part of the contrast.
    misfit: f64,
    /// Share of the pixels that are not covered.
    bare: f64,
}

impl FittedTag {
    /// True if only a tag explains it: a requirement beside the code for dictionaries with so few bits that clutter contains codes.
    pub(crate) fn is_evident(&self) -> bool {
        self.misfit < CLEAR && self.bare > BARE
    }
}

/// Number of the unknowns of the shape, which are first, and of the shades.
const SHAPE: usize = 11;
const SHADES: usize = UNKNOWNS - SHAPE;

/// Prior standard deviation of the bend, 1 / pixels: a lens with a strong distortion near its border.
const BEND: f64 = 1e-4;
/// Largest residual of the model beyond the noise, as a part of the contrast.
const MISFIT: f64 = 0.25;
/// Largest residual of an evident tag, and the least share of its pixels that are not covered. All of 203 drawn tags except one have 0.012 and
/// nothing covered. Clutter with a code by chance, in four of 1,000 pictures, has a larger residual or is covered more.
const CLEAR: f64 = 0.06;
const BARE: f64 = 0.98;
/// Least share of uncovered pixels of any tag; and of a tag that is not clear, some of whose corners are covered too, and inaccurate.
const PART: f64 = 0.95;
const MOST_OF_IT: f64 = 0.99;
/// Floor of the standard deviation, pixels: uneven ink, paper that is not flat.
const FLOOR_PX: f64 = 0.012;
/// Largest standard deviation of an accepted corner, pixels.
const WORST_PX: f64 = 0.5;
/// Round after which covered pixels are excluded. The first finds the shades.
const LIMITED: usize = 2;

/// Fits a tag near a quadrangle. `None` if there is no tag.
pub(crate) fn fit(gray: &Gray, cells: &TagCells, quad: &Quad, noise: f64) -> Option<FittedTag> {
    let patch = TagPatch::new(gray, quad, noise)?;
    let mut model = TagModel::start(*quad);
    let mut seen = patch.blurred_model(&model, cells)?;
    let mut limit = f64::INFINITY;
    let mut sums = model.sums(&patch, &seen, limit);
    let mut damping = 1e-3;
    for round in 0..14 {
        let mut damped = sums.normal;
        for k in 0..UNKNOWNS {
            damped[(k, k)] = damped[(k, k)] * (1.0 + damping) + 1e-9;
        }
        let next = model.step_by(&damped.cholesky()?.solve(&sums.right));
        // The first step finds the shades.
        let next_seen = if model.is_blank() { seen.clone() } else { patch.blurred_model(&next, cells)? };
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
    model.judge(&sums, quad, noise)
}

struct TagSums {
    normal: SMatrix<f64, UNKNOWNS, UNKNOWNS>,
    right: TagUnknowns,
    squares: f64,
    /// Squares of the residuals of all pixels, and their number.
    left: f64,
    count: usize,
    kept: usize,
}

impl TagModel {
    fn sums(&self, patch: &TagPatch, seen: &PatchModel, limit: f64) -> TagSums {
        let mut sums = run_vectorized(
            #[inline(always)]
            || {
                let mut adder = PixelAdder::new(self, limit);
                let ([width, height], first) = (patch.size, patch.first_offset());
                for row in 1..height - 1 {
                    for column in (1..width - 1).step_by(LANES) {
                        let off = [first[0] + column as f32, first[1] + row as f32];
                        let count = (width - 1 - column).min(LANES);
                        adder.add(patch, seen, (row * width + column, count), off);
                    }
                }
                adder.finish_sums()
            },
        );
        let stiff = patch.variance / (BEND * BEND);
        for k in 0..2 {
            sums.normal[(8 + k, 8 + k)] += stiff;
            sums.right[8 + k] -= stiff * self.bend[k];
            sums.squares += stiff * self.bend[k] * self.bend[k];
        }
        sums
    }

    fn judge(&self, sums: &TagSums, quad: &Quad, noise: f64) -> Option<FittedTag> {
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
            && bare > if misfit < CLEAR { PART } else { MOST_OF_IT }
            && sigma_px.iter().all(|it| *it < WORST_PX);
        good.then_some(FittedTag { corners: self.corners, sigma_px, blur_px: self.blur, misfit, bare })
    }
}

/// Sums over pixels: those near no edge between cells inform the shades alone, the last unknowns.
struct PixelAdder {
    edge: PixelEquations<UNKNOWNS>,
    plain: PixelEquations<SHADES>,
    /// Numbers of the model.
    dark: f32,
    contrast: f32,
    slope: [f32; 2],
    sides: [f32; 2],
    square_blur: f32,
    limit: f64,
    count: usize,
    kept: usize,
}

impl PixelAdder {
    fn new(model: &TagModel, limit: f64) -> Self {
        PixelAdder {
            edge: PixelEquations::new(),
            plain: PixelEquations::new(),
            dark: model.dark as f32,
            contrast: (model.light - model.dark) as f32,
            slope: [model.slope.x as f32, model.slope.y as f32],
            sides: model.squared_sides().map(|it| it as f32),
            square_blur: (model.blur * model.blur) as f32,
            limit,
            count: 0,
            kept: 0,
        }
    }

    /// Adds a number of pixels from one on, by its position relative to the middle.
    #[inline(always)]
    fn add(&mut self, patch: &TagPatch, seen: &PatchModel, (at, count): (usize, usize), [x, y]: [f32; 2]) {
        let width = patch.size[0];
        let counts = lanes(&seen.counts, at);
        let counted = counts[..count].iter().sum::<f32>() as usize;
        if counted == 0 {
            return;
        }
        let shade = |at: usize| lanes(&seen.shade, at);
        let (s, levels) = (shade(at), lanes(&patch.levels, at));
        let (left, right, up, down) = (shade(at - 1), shade(at + 1), shade(at - width), shade(at + width));
        let limit = self.limit as f32;
        let (mut residuals, mut keeps, mut shades) = ([0.0; LANES], [0.0; LANES], [[0.0; LANES]; SHADES]);
        for k in 0..LANES {
            let dx = x + k as f32;
            let light = 1.0 + self.slope[0] * dx + self.slope[1] * y;
            let base = self.dark + self.contrast * s[k];
            let residual = levels[k] - base * light;
            // A covered pixel counts by its number alone.
            keeps[k] = if residual.abs() <= limit { counts[k] } else { 0.0 };
            residuals[k] = residual * keeps[k];
            let light = light * keeps[k];
            (shades[0][k], shades[1][k]) = (light * (1.0 - s[k]), light * s[k]);
            (shades[2][k], shades[3][k]) = (base * dx * keeps[k], base * y * keeps[k]);
        }
        self.count += counted;
        self.kept += keeps[..count].iter().sum::<f32>() as usize;
        let is_plain = (0..LANES)
            .fold(true, |all, k| all & (left[k] == s[k]) & (right[k] == s[k]) & (up[k] == s[k]) & (down[k] == s[k]));
        if is_plain {
            self.plain.add(&mut shades, &mut residuals, count);
            return;
        }
        let (own_x, own_y) = (lanes(&seen.own[0], at), lanes(&seen.own[1], at));
        let mut rows = [[0.0; LANES]; UNKNOWNS];
        for k in 0..LANES {
            let contrast = self.contrast * (shades[0][k] + shades[1][k]);
            let curve = left[k] + right[k] + up[k] + down[k] - 4.0 * s[k];
            // As the tag moves by a step, the pixel sees the part before it.
            let by_x = -0.5 * (right[k] - left[k]) * contrast;
            let by_y = -0.5 * (down[k] - up[k]) * contrast;
            let (u, v) = (own_x[k], own_y[k]);
            let weights = [(1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v, bend_at([u, v], self.sides)];
            for corner in 0..5 {
                rows[2 * corner][k] = by_x * weights[corner];
                rows[2 * corner + 1][k] = by_y * weights[corner];
            }
            rows[10][k] = contrast * self.square_blur * curve;
        }
        rows[SHAPE..].copy_from_slice(&shades);
        self.edge.add(&mut rows, &mut residuals, count);
    }

    fn finish_sums(self) -> TagSums {
        let PixelAdder { edge, plain, limit, count, kept, .. } = self;
        let ((mut normal, mut right, mut left), plain) = (edge.into_equations(), plain.into_equations());
        let mut own = normal.fixed_view_mut::<SHADES, SHADES>(SHAPE, SHAPE);
        own += plain.0;
        let mut own = right.fixed_rows_mut::<SHADES>(SHAPE);
        own += plain.1;
        left += plain.2;
        // Without a limit no pixel exceeds it.
        let beyond = if count > kept { (count - kept) as f64 * limit * limit } else { 0.0 };
        TagSums { normal, right, squares: left + beyond, left, count, kept }
    }
}
