//! Model of a tag: seen through a homography, slightly bent as by a lens, blurred, with a gradient of the light.

use nalgebra::{SVector, Vector2};

use crate::homography::Homography;
use crate::quads::Quad;

pub(crate) const UNKNOWNS: usize = 15;
pub(crate) type TagUnknowns = SVector<f64, UNKNOWNS>;

/// The margin beyond the corners of a tag, as a part of their distance from its middle, and additional pixels.
const BEYOND: f64 = 0.25;
const BEYOND_PX: f64 = 3.0;

const SIGNS: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

/// Position, sharpness and shades of a tag in a picture.
#[derive(Clone, Copy)]
pub(crate) struct TagModel {
    pub(crate) corners: Quad,
    pub(crate) bend: Vector2<f64>,
    pub(crate) blur: f64,
    pub(crate) dark: f64,
    pub(crate) light: f64,
    pub(crate) slope: Vector2<f64>,
}

impl TagModel {
    pub(crate) fn start(corners: Quad) -> Self {
        let slope = Vector2::zeros();
        TagModel { corners, bend: Vector2::zeros(), blur: 1.1, dark: 0.0, light: 0.0, slope }
    }

    /// Map from the picture to the tag, without the bend.
    pub(crate) fn tag_homography(&self) -> Option<Homography> {
        Homography::of_corners(&self.corners, &SIGNS.map(Vector2::from))
    }

    /// True if its shades are not yet known.
    pub(crate) fn is_blank(&self) -> bool {
        self.light == self.dark
    }

    /// First and last column in a row that may see the tag or its rim, within a patch.
    pub(crate) fn span(&self, first: [usize; 2], size: [usize; 2], row: usize) -> std::ops::Range<usize> {
        let middle = self.corners.iter().sum::<Vector2<f64>>() * 0.25;
        let around = self.corners.map(|it| {
            let way = it - middle;
            it + way * BEYOND + way.map(|it| BEYOND_PX.copysign(it))
        });
        let y = (row + first[1]) as f64;
        let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
        for k in 0..4 {
            let (a, b) = (around[k], around[(k + 1) % 4]);
            if (a.y <= y) != (b.y <= y) {
                let x = a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y);
                ends = [ends[0].min(x), ends[1].max(x)];
            }
        }
        let column = |x: f64| (x - first[0] as f64).clamp(0.0, size[0] as f64) as usize;
        column(ends[0])..column(ends[1] + 1.0)
    }

    /// Squares of its mean sides, pixels.
    pub(crate) fn squared_sides(&self) -> [f64; 2] {
        let [a, b, c, d] = self.corners;
        [(b - a + c - d).norm_squared() * 0.25, (d - a + c - b).norm_squared() * 0.25]
    }

    pub(crate) fn step_by(&self, step: &TagUnknowns) -> Self {
        let longest = (0..8).map(|k| step[k].abs()).fold(0.0, f64::max);
        let part = if self.is_blank() { 0.0 } else { 1.0 / (longest / 1.2).max(1.0) };
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
}

/// Map from the picture to the tag, by a homography and a bend: relative to the middle of a patch.
pub(crate) struct BentTagMap {
    back: [[f32; 3]; 3],
    bend: [f32; 2],
    sides: [f32; 2],
}

impl BentTagMap {
    pub(crate) fn new(model: &TagModel, back: [[f32; 3]; 3]) -> Self {
        let sides = model.squared_sides();
        BentTagMap { back, bend: [model.bend.x as f32, model.bend.y as f32], sides: sides.map(|it| it as f32) }
    }

    /// Position on the tag without the bend, and 1 over the depth factor.
    #[inline(always)]
    fn flatten_place(&self, [x, y]: [f32; 2]) -> ([f32; 2], f32) {
        let [u, v, w] = self.back.map(|row| row[0] * x + row[1] * y + row[2]);
        let scale = 1.0 / w;
        ([u * scale, v * scale], scale)
    }

    /// Position on the tag; half the sides of the upright rectangle there with the same spread along both of its axes as a pixel; and true if the tag
    /// is near.
    #[inline(always)]
    pub(crate) fn map(&self, [x, y]: [f32; 2]) -> ([f32; 2], [f32; 2], bool) {
        let (first, front) = self.flatten_place([x, y]);
        let bent = bend_at(first, self.sides);
        let ([u, v], scale) = self.flatten_place([x - self.bend[0] * bent, y - self.bend[1] * bent]);
        let [by_u, by_v, by_w] = self.back;
        let length = |row: [f32; 3], own: f32| {
            let (a, b) = (row[0] - own * by_w[0], row[1] - own * by_w[1]);
            0.5 * scale * (a * a + b * b).sqrt()
        };
        let is_there = front > 0.0 && scale > 0.0 && first[0].abs().max(first[1].abs()) <= 3.0;
        ([u, v], [length(by_u, u), length(by_v, v)], is_there)
    }
}

/// The bend at a point of the tag, by the squares of its sides: zero at corners.
#[inline(always)]
pub(crate) fn bend_at([x, y]: [f32; 2], sides: [f32; 2]) -> f32 {
    -(x * (1.0 - x) * sides[0] + y * (1.0 - y) * sides[1])
}
