//! The pixels around a tag, and a model's view of them.

use nalgebra::Vector2;

use crate::gray::Gray;
use crate::normal::LANES;
use crate::quads::Quad;
use crate::tagmodel::{BentTagMap, TagModel};
use crate::vector::run_vectorized;

/// Width of the light rim that is fitted with the tag, cells.
const RIM: f64 = 0.7;
/// Pixels left around a tag for the blur.
const AROUND: f64 = 6.0;
/// Most pixels around a tag.
const MOST: f64 = 2e6;

/// Cells of a tag with its border, row by row; dark ones are marked.
pub(crate) struct TagCells {
    pub(crate) side: usize,
    pub(crate) dark: Vec<bool>,
}

impl TagCells {
    /// The dark part of an upright rectangle between two corners, cells.
    #[inline(always)]
    pub(crate) fn dark_part(&self, low: [f32; 2], high: [f32; 2]) -> f32 {
        let side = self.side as f32;
        // The first cell of each axis, and the one behind the last.
        let first = |at: f32| at.clamp(0.0, side) as i32;
        let end = |at: f32| first(at) + i32::from(at.min(side) > first(at) as f32);
        let (columns, rows) = (first(low[0])..end(high[0]), first(low[1])..end(high[1]));
        let is_dark =
            |row: i32, column: i32| self.dark.get(row as usize * self.side + column as usize).is_some_and(|it| *it);
        // Most rectangles are within a cell.
        let inside = low[0].min(low[1]) >= 0.0 && high[0].max(high[1]) <= side;
        if inside && columns.len() == 1 && rows.len() == 1 {
            return f32::from(u8::from(is_dark(rows.start, columns.start)));
        }
        // The length of the rectangle on a row or column of cells.
        let part = |at: i32, low: f32, high: f32| high.min(at as f32 + 1.0) - low.max(at as f32);
        let mut sum = 0.0;
        for row in rows {
            let down = part(row, low[1], high[1]);
            for column in columns.clone() {
                if is_dark(row, column) {
                    sum += down * part(column, low[0], high[0]);
                }
            }
        }
        sum / ((high[0] - low[0]) * (high[1] - low[1]))
    }
}

/// The pixels around a tag, with [`LANES`] more behind the last.
pub(crate) struct TagPatch {
    pub(crate) first: [usize; 2],
    pub(crate) size: [usize; 2],
    pub(crate) levels: Vec<f32>,
    pub(crate) middle: Vector2<f64>,
    /// Variance of the noise.
    pub(crate) variance: f64,
}

/// A model in a patch: the light of pixels, their positions on the tag, and 1 for used pixels, 0 for others.
#[derive(Clone)]
pub(crate) struct PatchModel {
    pub(crate) shade: Vec<f32>,
    pub(crate) own: [Vec<f32>; 2],
    pub(crate) counts: Vec<f32>,
}

impl TagPatch {
    pub(crate) fn new(gray: &Gray, quad: &Quad, noise: f64) -> Option<Self> {
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
        let mut levels = Vec::with_capacity(size[0] * size[1] + LANES);
        for row in first[1]..first[1] + size[1] {
            levels.extend_from_slice(&gray.row(row)[first[0]..first[0] + size[0]]);
        }
        levels.extend([0.0; LANES]);
        let middle = (quad.iter().sum::<Vector2<f64>>() * 0.25).map(f64::round);
        Some(TagPatch { first, size, levels, middle, variance: noise * noise })
    }

    /// The first pixel, relative to the middle.
    pub(crate) fn first_offset(&self) -> [f32; 2] {
        [self.first[0] as f64 - self.middle.x, self.first[1] as f64 - self.middle.y].map(|it| it as f32)
    }

    /// The light of the pixels by a model, blurred, from 0 to 1.
    pub(crate) fn blurred_model(&self, model: &TagModel, cells: &TagCells) -> Option<PatchModel> {
        let back = model.tag_homography()?.rows_about(self.middle);
        let mut seen = run_vectorized(
            #[inline(always)]
            || self.sharp_model(model, &BentTagMap::new(model, back), cells),
        );
        let mut shade = std::mem::take(&mut seen.shade);
        shade.truncate(self.size[0] * self.size[1]);
        seen.shade = Gray::new(self.size[0], self.size[1], shade).ok()?.blur(model.blur, 3.2).into_levels();
        seen.shade.extend([0.0; LANES]);
        Some(seen)
    }

    /// The light without blur.
    #[inline(always)]
    fn sharp_model(&self, model: &TagModel, bent: &BentTagMap, cells: &TagCells) -> PatchModel {
        let ([width, height], first) = (self.size, self.first_offset());
        let all = |it: f32| vec![it; self.levels.len()];
        let mut seen = PatchModel { shade: all(1.0), own: [all(0.0), all(0.0)], counts: all(0.0) };
        let (side, rim) = (cells.side as f32, RIM as f32 / cells.side as f32);
        for row in 0..height {
            let columns = model.span(self.first, self.size, row);
            for column in columns.clone().step_by(LANES) {
                let mut own = [[0.0; LANES]; 2];
                let mut half = [[0.0; LANES]; 2];
                let mut beyond = [0.0; LANES];
                for k in 0..LANES {
                    let place = [first[0] + (column + k) as f32, first[1] + row as f32];
                    let (at, spread, is_there) = bent.map(place);
                    let off = (-at[0]).max(at[0] - 1.0).max((-at[1]).max(at[1] - 1.0));
                    beyond[k] = if is_there { off } else { 1.0 };
                    ([own[0][k], own[1][k]], [half[0][k], half[1][k]]) = (at, spread);
                }
                // A cell farther from the edge than the width of a pixel has one shade.
                let mut shade = [1.0; LANES];
                let count = (columns.end - column).min(LANES);
                for k in (0..count).filter(|k| beyond[*k] < 0.3) {
                    let reach = [0, 1].map(|axis| half[axis][k].max(1e-6));
                    let low = [0, 1].map(|axis| (own[axis][k] - reach[axis]) * side);
                    let high = [0, 1].map(|axis| (own[axis][k] + reach[axis]) * side);
                    shade[k] = 1.0 - cells.dark_part(low, high);
                }
                let at = row * width + column;
                seen.shade[at..at + count].copy_from_slice(&shade[..count]);
                for (to, own) in seen.own.iter_mut().zip(&own) {
                    to[at..at + count].copy_from_slice(&own[..count]);
                }
                let counts = beyond.map(|it| f32::from(u8::from(it < rim)));
                seen.counts[at..at + count].copy_from_slice(&counts[..count]);
            }
        }
        seen
    }
}
