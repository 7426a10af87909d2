//! Connected parts of a picture that are darker than their surroundings.

use nalgebra::{Matrix2, Vector2};

use crate::gray::Gray;
use crate::vector::{change, run_vectorized};

/// A picture prepared for the separation of dark from light: levels times 16, smoothed over 3 × 3 pixels, and their means over 2 × 2.
pub(crate) struct SmoothedPicture {
    smooth: Vec<u16>,
    width: usize,
    halved: Vec<u16>,
    offset: i32,
}

/// Most pixels of the halved picture to each side of a window: sums of its levels are below 2³¹.
const FARTHEST: usize = 360;

impl SmoothedPicture {
    pub(crate) fn new(gray: &Gray, noise: f64) -> Self {
        let (smooth, halved) = run_vectorized(
            #[inline(always)]
            || smooth_levels(gray),
        );
        SmoothedPicture { smooth, width: gray.width(), halved, offset: (0.8 * noise).max(2.0) as i32 }
    }

    /// Parts darker than the mean of a window that extends by this number of pixels to each side.
    pub(crate) fn dark_parts(&self, half: usize) -> DarkRegions {
        self.darker_parts(half, self.offset)
    }

    /// Parts darker than that by this number of gray levels. The mean is that of the halved picture.
    pub(crate) fn darker_parts(&self, half: usize, offset: i32) -> DarkRegions {
        run_vectorized(
            #[inline(always)]
            || self.parts((half / 2).clamp(1, FARTHEST), offset),
        )
    }

    #[inline(always)]
    fn parts(&self, half: usize, offset: i32) -> DarkRegions {
        let (width, height) = (self.width, self.smooth.len() / self.width);
        let mut parts = DarkRegions { runs: Vec::new(), root: Vec::new(), size: [width, height] };
        let mut window = LevelWindow::new(&self.halved, width.div_ceil(2), half);
        let mut limits = vec![0_u16; 2 * width.div_ceil(2)];
        let mut dark = vec![0_u8; width.next_multiple_of(u64::BITS as usize)];
        let mut before = 0..0;
        for (row, levels) in self.smooth.chunks_exact(width).enumerate() {
            if row % 2 == 0 {
                window.limits(row / 2, offset, &mut limits);
            }
            change(&mut dark, [levels, &limits], |_, [level, limit]| u8::from(level < limit));
            let first = parts.runs.len();
            parts.add(&dark, row as u32);
            parts.join(before, first..parts.runs.len());
            before = first..parts.runs.len();
        }
        parts
    }
}

/// Sums of the levels in a window about each pixel of a row of a picture.
struct LevelWindow<'a> {
    levels: &'a [u16],
    width: usize,
    half: usize,
    /// Sums of the rows of the window by columns, and of the columns before each. The latter may overflow; their differences do not.
    columns: Vec<u32>,
    before: Vec<u32>,
}

impl<'a> LevelWindow<'a> {
    fn new(levels: &'a [u16], width: usize, half: usize) -> Self {
        let (columns, before) = (vec![0; width], vec![0; width + 1]);
        let mut window = LevelWindow { levels, width, half, columns, before };
        (0..half.min(levels.len() / width)).for_each(|row| window.add(row));
        window
    }

    fn row(&self, row: usize) -> &'a [u16] {
        &self.levels[row * self.width..(row + 1) * self.width]
    }

    #[inline(always)]
    fn add(&mut self, row: usize) {
        let levels = self.row(row);
        change(&mut self.columns, [levels], |sum, [it]| sum + u32::from(it));
    }

    /// Levels below which pixels of the next row are dark, each for two columns of the whole picture.
    #[inline(always)]
    fn limits(&mut self, row: usize, offset: i32, limits: &mut [u16]) {
        let (height, half) = (self.levels.len() / self.width, self.half);
        if row + half < height {
            self.add(row + half);
        }
        if row > half {
            let past = self.row(row - half - 1);
            change(&mut self.columns, [past], |sum, [it]| sum - u32::from(it));
        }
        let mut sum = 0_u32;
        for (place, column) in self.before[1..].iter_mut().zip(&self.columns) {
            sum = sum.wrapping_add(*column);
            *place = sum;
        }
        let rows = (row + half + 1).min(height) - row.saturating_sub(half);
        let width = self.width;
        let limit = |left: u32, right: u32, part: f32| {
            let mean = right.wrapping_sub(left) as i32 as f32 * part;
            (round_to_whole(mean) - offset * 16).max(0) as u16
        };
        let inner = half.min(width)..width.saturating_sub(half).max(half.min(width));
        for column in (0..inner.start).chain(inner.end..width) {
            let (left, right) = (column.saturating_sub(half), (column + half + 1).min(width));
            let part = 1.0 / (rows * (right - left)) as f32;
            limits[2 * column..2 * column + 2].fill(limit(self.before[left], self.before[right], part));
        }
        let part = 1.0 / (rows * (2 * half + 1)) as f32;
        let ends = [self.before.as_slice(), &self.before[(2 * half + 1).min(width)..]];
        let inner = &mut limits[2 * inner.start..2 * inner.end];
        change(inner.as_chunks_mut().0, ends, |_, [left, right]| [limit(left, right, part); 2]);
    }
}

pub(crate) fn cross(a: Vector2<f64>, b: Vector2<f64>) -> f64 {
    a.x * b.y - a.y * b.x
}

/// Shape of a part: the ellipse with its moments.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blob {
    pub(crate) middle: Vector2<f64>,
    /// Covariance of the positions of its pixels, pixels².
    pub(crate) spread: Matrix2<f64>,
    /// Area, pixels.
    pub(crate) area: f64,
}

/// The nearest integer to a number from 0 to 65,535.
#[inline(always)]
fn round_to_whole(number: f32) -> i32 {
    // A number of this size is an integer: its last bits are the number. Conversions check for invalid numbers, one by one.
    const WHOLE: f32 = 8_388_608.0;
    ((number + WHOLE).to_bits() & 0xf_ffff) as i32
}

/// Levels times 16, smoothed over 3 × 3 pixels, and means over 2 × 2 of them.
#[inline(always)]
fn smooth_levels(gray: &Gray) -> (Vec<u16>, Vec<u16>) {
    let (width, height) = (gray.width(), gray.height());
    let mut smooth = vec![0_u16; width * height];
    let mut halved = vec![0_u16; width.div_ceil(2) * height.div_ceil(2)];
    let mut columns = vec![0.0_f32; width + 2];
    for (row, target) in smooth.chunks_exact_mut(width).enumerate() {
        let above = gray.row(row.saturating_sub(1));
        let own = gray.row(row);
        let below = gray.row((row + 1).min(height - 1));
        change(&mut columns[1..], [above, own, below], |_, [above, own, below]| above + 2.0 * own + below);
        (columns[0], columns[width + 1]) = (columns[1], columns[width]);
        // Levels out of range are accepted.
        let around = [&columns[..], &columns[1..], &columns[2..]];
        change(target, around, |_, [left, own, right]| {
            round_to_whole((2.0 * own + (left + right)).clamp(0.0, 65_535.0)) as u16
        });
    }
    for (target, rows) in halved.chunks_exact_mut(width.div_ceil(2)).zip(smooth.chunks(2 * width)) {
        let (upper, lower) = rows.split_at(width);
        let lower = if lower.is_empty() { upper } else { lower };
        let pairs = [upper.as_chunks::<2>().0, lower.as_chunks::<2>().0];
        change(target, pairs, |_, [upper, lower]| {
            let [a, b, c, d] = [upper[0], upper[1], lower[0], lower[1]].map(u32::from);
            ((a + b + c + d) / 4) as u16
        });
        if width % 2 == 1
            && let Some(last) = target.last_mut()
        {
            *last = ((u32::from(upper[width - 1]) + u32::from(lower[width - 1])) / 2) as u16;
        }
    }
    (smooth, halved)
}

/// Mark in place of the number of a part that is too small.
const NO_PART: u32 = u32::MAX;

/// Connected dark pixels, as runs in rows.
pub(crate) struct DarkRegions {
    /// First and last column, row.
    runs: Vec<[u32; 3]>,
    /// The first run of the part of each run.
    root: Vec<u32>,
    size: [usize; 2],
}

impl DarkRegions {
    /// Adds the runs of ones in a row, which is padded with zeros to a multiple of 64.
    #[inline(always)]
    fn add(&mut self, dark: &[u8], row: u32) {
        let (mut last, mut from) = (0, 0);
        for (at, many) in dark.chunks_exact(u64::BITS as usize).enumerate() {
            let mut word = 0_u64;
            for (k, eight) in many.as_chunks::<8>().0.iter().enumerate() {
                // Eight bytes of 0 or 1 as eight bits.
                word |= (u64::from_le_bytes(*eight).wrapping_mul(0x0102_0408_1020_4080) >> 56) << (8 * k);
            }
            let mut changes = word ^ (word << 1 | last);
            last = word >> 63;
            while changes != 0 {
                let column = at as u32 * u64::BITS + changes.trailing_zeros();
                let begins = word >> (column % u64::BITS) & 1 == 1;
                changes &= changes - 1;
                if begins {
                    from = column;
                } else {
                    self.push([from, column - 1, row]);
                }
            }
        }
        if last == 1 {
            self.push([from, dark.len() as u32 - 1, row]);
        }
    }

    fn push(&mut self, run: [u32; 3]) {
        self.root.push(self.runs.len() as u32);
        self.runs.push(run);
    }

    /// Joins runs of a row with those of the row above that share a side.
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

    /// Number of the part of each first run, for parts of at least this size, and their count. In pictures of noise most parts are small, and the
    /// data kept for each part would take many times the memory of the picture.
    fn number_parts(&mut self, least: u32, size_of: impl Fn([u32; 3]) -> u32) -> (Vec<u32>, usize) {
        let mut numbers = vec![0_u32; self.runs.len()];
        for at in 0..self.runs.len() {
            let root = self.find(at as u32) as usize;
            numbers[root] += size_of(self.runs[at]);
        }
        let mut count = 0;
        for number in &mut numbers {
            if *number >= least.max(1) {
                (*number, count) = (count as u32, count + 1);
            } else {
                *number = NO_PART;
            }
        }
        (numbers, count)
    }

    /// Ends of the runs of each part that is neither small nor at the border.
    pub(crate) fn outlines(mut self, least: u32) -> Vec<Vec<Vector2<f64>>> {
        // A part has a run or more in each of its rows.
        let (numbers, count) = self.number_parts(least / 2, |_| 1);
        let mut boxes = vec![[u32::MAX, 0, u32::MAX, 0]; count];
        for at in 0..self.runs.len() {
            let number = numbers[self.find(at as u32) as usize];
            let [left, right, row] = self.runs[at];
            let Some(own) = boxes.get_mut(number as usize) else { continue };
            *own = [own[0].min(left), own[1].max(right), own[2].min(row), row];
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
        let mut place = vec![usize::MAX; count];
        for at in 0..self.runs.len() {
            let number = numbers[self.find(at as u32) as usize] as usize;
            if !boxes.get(number).is_some_and(|it| fits(*it)) {
                continue;
            }
            if place[number] == usize::MAX {
                place[number] = outlines.len();
                outlines.push(Vec::new());
            }
            let [left, right, row] = self.runs[at].map(f64::from);
            outlines[place[number]].extend([Vector2::new(left, row), Vector2::new(right, row)]);
        }
        outlines
    }

    /// Moments of each part with at least this number of pixels.
    pub(crate) fn blobs(mut self, least: u32) -> Vec<Blob> {
        let (numbers, count) = self.number_parts(least, |[left, right, _]| right - left + 1);
        // Area, first and second moments.
        let mut sums: Vec<[f64; 6]> = vec![[0.0; 6]; count];
        for at in 0..self.runs.len() {
            let number = numbers[self.find(at as u32) as usize];
            let [left, right, row] = self.runs[at].map(f64::from);
            let count = right - left + 1.0;
            let middle = 0.5 * (left + right);
            let square = count * (middle * middle + (count * count - 1.0) / 12.0);
            let own = [count, count * middle, count * row, square, count * middle * row, count * row * row];
            let Some(sums) = sums.get_mut(number as usize) else { continue };
            sums.iter_mut().zip(own).for_each(|(sum, it)| *sum += it);
        }
        let blob = |[area, x, y, xx, xy, yy]: [f64; 6]| {
            let middle = Vector2::new(x, y) / area;
            let spread = Matrix2::new(xx, xy, xy, yy) / area - middle * middle.transpose();
            Blob { middle, spread: spread + Matrix2::identity() / 12.0, area }
        };
        sums.into_iter().map(blob).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dark_pixels_are_below_the_mean_of_their_window() {
        for (width, height) in [(23, 9), (64, 11), (130, 7)] {
            let levels = (0..width * height).map(|k| (k * k * 37 % 251) as f32).collect();
            let gray = Gray::new(width, height, levels).unwrap();
            let shades = SmoothedPicture::new(&gray, 0.0);
            let (columns, rows) = (width.div_ceil(2), height.div_ceil(2));
            for half in [2, 4, 7, 22, 60] {
                let parts = shades.darker_parts(half, 3);
                let is_dark = |x: usize, y: usize| {
                    let holds = |it: &[u32; 3]| it[2] as usize == y && (it[0]..=it[1]).contains(&(x as u32));
                    parts.runs.iter().filter(|it| holds(it)).count()
                };
                for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
                    let near = |at: usize, own: usize| (at).abs_diff(own / 2) <= half / 2;
                    let inside = |it: &usize| near(it % columns, x) && near(it / columns, y);
                    let window: Vec<u64> =
                        (0..columns * rows).filter(inside).map(|it| shades.halved[it].into()).collect();
                    let mean = window.iter().sum::<u64>() / window.len() as u64;
                    let level = u64::from(shades.smooth[y * width + x]);
                    let (dark, light) = (level + 48 < mean, level + 48 > mean + 1);
                    assert!(is_dark(x, y) == usize::from(dark) || !dark && !light, "{half} {x} {y}");
                }
            }
        }
    }

    #[test]
    fn runs_end_where_they_end() {
        let mut parts = DarkRegions { runs: Vec::new(), root: Vec::new(), size: [128, 1] };
        let dark: Vec<u8> = (0..128).map(|k| u8::from((20..53).contains(&k) || k == 63 || k > 125)).collect();
        parts.add(&dark, 4);
        parts.add(&[1; 64], 5);
        assert_eq!(parts.runs, [[20, 52, 4], [63, 63, 4], [126, 127, 4], [0, 63, 5]]);
    }
}
