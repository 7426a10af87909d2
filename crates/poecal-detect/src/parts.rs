//! Connected parts of a picture that are darker than what is around them.

use nalgebra::{Matrix2, Vector2};

use crate::gray::Gray;

/// A picture made ready to tell dark from light.
pub(crate) struct Shades {
    smooth: Vec<u16>,
    sums: Vec<u64>,
    width: usize,
    offset: i32,
}

impl Shades {
    pub(crate) fn new(gray: &Gray, noise: f64) -> Self {
        let smooth = smoothed(gray);
        let sums = sums(&smooth, gray.width());
        Shades { smooth, sums, width: gray.width(), offset: (0.8 * noise).max(2.0) as i32 }
    }

    /// Parts darker than the mean of a window that reaches so many pixels to each side.
    pub(crate) fn dark_parts(&self, half: usize) -> Parts {
        self.darker_parts(half, self.offset)
    }

    /// Parts darker than that by so many gray levels.
    pub(crate) fn darker_parts(&self, half: usize, offset: i32) -> Parts {
        let dark = dark(&self.smooth, &self.sums, self.width, half, offset);
        Parts::new(&dark, self.width)
    }
}

pub(crate) fn cross(a: Vector2<f64>, b: Vector2<f64>) -> f64 {
    a.x * b.y - a.y * b.x
}

/// What a part looks like: the ellipse with its moments.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blob {
    pub(crate) middle: Vector2<f64>,
    /// Covariance of the places of its pixels, pixels².
    pub(crate) spread: Matrix2<f64>,
    /// Pixels.
    pub(crate) area: f64,
}

/// Levels times 16, smoothed over 3 × 3 pixels.
fn smoothed(gray: &Gray) -> Vec<u16> {
    let (width, height) = (gray.width(), gray.height());
    let mut smooth = vec![0_u16; width * height];
    for row in 0..height {
        let above = gray.row(row.saturating_sub(1));
        let own = gray.row(row);
        let below = gray.row((row + 1).min(height - 1));
        let columns: Vec<f32> = (0..width).map(|x| above[x] + 2.0 * own[x] + below[x]).collect();
        let target = &mut smooth[row * width..(row + 1) * width];
        for x in 0..width {
            let sides = columns[x.saturating_sub(1)] + columns[(x + 1).min(width - 1)];
            target[x] = (2.0 * columns[x] + sides) as u16;
        }
    }
    smooth
}

/// Sums of levels above and before each pixel, one row and column more than the picture.
fn sums(smooth: &[u16], width: usize) -> Vec<u64> {
    let height = smooth.len() / width;
    let mut sums = vec![0_u64; (width + 1) * (height + 1)];
    for row in 0..height {
        let mut own = 0;
        for column in 0..width {
            own += u64::from(smooth[row * width + column]);
            let at = (row + 1) * (width + 1) + column + 1;
            sums[at] = sums[at - width - 1] + own;
        }
    }
    sums
}

/// Whether pixels are darker than the mean of a window around them.
fn dark(smooth: &[u16], sums: &[u64], width: usize, half: usize, offset: i32) -> Vec<bool> {
    let height = smooth.len() / width;
    let mut dark = vec![false; smooth.len()];
    for row in 0..height {
        let (top, bottom) = (row.saturating_sub(half), (row + half + 1).min(height));
        let (upper, lower) = (&sums[top * (width + 1)..], &sums[bottom * (width + 1)..]);
        for column in 0..width {
            let (left, right) = (column.saturating_sub(half), (column + half + 1).min(width));
            let area = ((bottom - top) * (right - left)) as u64;
            let sum = lower[right] + upper[left] - lower[left] - upper[right];
            let level = u64::from(smooth[row * width + column]) + (offset * 16) as u64;
            dark[row * width + column] = level * area < sum;
        }
    }
    dark
}

/// Connected dark pixels, as runs in rows.
pub(crate) struct Parts {
    /// First and last column, row.
    runs: Vec<[u32; 3]>,
    /// The first run of the part of each run.
    root: Vec<u32>,
    size: [usize; 2],
}

impl Parts {
    fn new(dark: &[bool], width: usize) -> Self {
        let height = dark.len() / width;
        let mut parts = Parts { runs: Vec::new(), root: Vec::new(), size: [width, height] };
        let mut before = 0..0;
        for row in 0..height {
            let first = parts.runs.len();
            let levels = &dark[row * width..(row + 1) * width];
            let mut column = 0;
            while let Some(from) = levels[column..].iter().position(|it| *it) {
                let from = column + from;
                let to = levels[from..].iter().position(|it| !*it).map_or(width, |it| from + it);
                let own = parts.runs.len() as u32;
                parts.runs.push([from as u32, to as u32 - 1, row as u32]);
                parts.root.push(own);
                column = to;
                if column >= width {
                    break;
                }
            }
            parts.join(before.clone(), first..parts.runs.len());
            before = first..parts.runs.len();
        }
        parts
    }

    /// Joins runs of a row with those of the row above that they touch by a side.
    fn join(&mut self, above: std::ops::Range<usize>, own: std::ops::Range<usize>) {
        let mut from = above.start;
        for at in own {
            let [left, right, _] = self.runs[at];
            while from < above.end && self.runs[from][1] < left {
                from += 1;
            }
            let mut other = from;
            while other < above.end && self.runs[other][0] <= right {
                let (a, b) = (self.find(other as u32), self.find(at as u32));
                self.root[a.max(b) as usize] = a.min(b);
                other += 1;
            }
        }
    }

    fn find(&mut self, mut at: u32) -> u32 {
        while self.root[at as usize] != at {
            let next = self.root[at as usize];
            self.root[at as usize] = self.root[next as usize];
            at = next;
        }
        at
    }

    /// Ends of the runs of each part that is neither small nor at the border.
    pub(crate) fn outlines(mut self, least: u32) -> Vec<Vec<Vector2<f64>>> {
        let mut boxes: Vec<Option<[u32; 4]>> = vec![None; self.runs.len()];
        for at in 0..self.runs.len() {
            let root = self.find(at as u32) as usize;
            let [left, right, row] = self.runs[at];
            let own = boxes[root].get_or_insert([left, right, row, row]);
            *own = [own[0].min(left), own[1].max(right), own[2], row];
        }
        let [width, height] = self.size.map(|it| it as u32);
        let fits = |[left, right, top, bottom]: [u32; 4]| {
            let (across, down) = (right - left + 1, bottom - top + 1);
            across >= least
                && down >= least / 2
                && across.max(down) < width.max(height) / 2
                && left > 0
                && top > 0
                && right + 1 < width
                && bottom + 1 < height
        };
        let mut outlines: Vec<Vec<Vector2<f64>>> = Vec::new();
        let mut place = vec![usize::MAX; self.runs.len()];
        for at in 0..self.runs.len() {
            let root = self.find(at as u32) as usize;
            if !boxes[root].is_some_and(fits) {
                continue;
            }
            if place[root] == usize::MAX {
                place[root] = outlines.len();
                outlines.push(Vec::new());
            }
            let [left, right, row] = self.runs[at].map(f64::from);
            outlines[place[root]].extend([Vector2::new(left, row), Vector2::new(right, row)]);
        }
        outlines
    }

    /// The moments of each part.
    pub(crate) fn blobs(mut self) -> Vec<Blob> {
        // Area, first and second moments.
        let mut sums: Vec<[f64; 6]> = vec![[0.0; 6]; self.runs.len()];
        for at in 0..self.runs.len() {
            let root = self.find(at as u32) as usize;
            let [left, right, row] = self.runs[at].map(f64::from);
            let count = right - left + 1.0;
            let middle = 0.5 * (left + right);
            let square = count * (middle * middle + (count * count - 1.0) / 12.0);
            let own = [count, count * middle, count * row, square, count * middle * row, count * row * row];
            sums[root].iter_mut().zip(own).for_each(|(sum, it)| *sum += it);
        }
        let blob = |[area, x, y, xx, xy, yy]: [f64; 6]| {
            let middle = Vector2::new(x, y) / area;
            let spread = Matrix2::new(xx, xy, xy, yy) / area - middle * middle.transpose();
            Blob { middle, spread: spread + Matrix2::identity() / 12.0, area }
        };
        sums.into_iter().filter(|it| it[0] > 0.0).map(blob).collect()
    }
}
