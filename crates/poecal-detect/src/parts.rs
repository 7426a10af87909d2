//! Connected parts of a picture that are darker than what is around them.

use nalgebra::{Matrix2, Vector2};

use crate::gray::Gray;

/// A picture made ready to tell dark from light.
pub(crate) struct Shades {
    smooth: Vec<u16>,
    width: usize,
    offset: i32,
}

impl Shades {
    pub(crate) fn new(gray: &Gray, noise: f64) -> Self {
        let smooth = smoothed(gray);
        Shades { smooth, width: gray.width(), offset: (0.8 * noise).max(2.0) as i32 }
    }

    /// Parts darker than the mean of a window that reaches so many pixels to each side.
    pub(crate) fn dark_parts(&self, half: usize) -> Parts {
        self.darker_parts(half, self.offset)
    }

    /// Parts darker than that by so many gray levels.
    pub(crate) fn darker_parts(&self, half: usize, offset: i32) -> Parts {
        let dark = dark(&self.smooth, self.width, half, offset);
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

/// Whether pixels are darker than the mean of a window around them.
fn dark(smooth: &[u16], width: usize, half: usize, offset: i32) -> Vec<bool> {
    let height = smooth.len() / width;
    let mut dark = vec![false; smooth.len()];
    // Sums of the rows of the window by columns, and of the columns before each: whole numbers, which are exact in either form.
    let mut columns = vec![0_u32; width];
    let mut before = vec![0.0; width + 1];
    let row_of = |row: usize| &smooth[row * width..(row + 1) * width];
    let add = |columns: &mut [u32], row: usize| {
        columns.iter_mut().zip(row_of(row)).for_each(|(sum, it)| *sum += u32::from(*it));
    };
    (0..half.min(height)).for_each(|row| add(&mut columns, row));
    for row in 0..height {
        if row + half < height {
            add(&mut columns, row + half);
        }
        if row > half {
            let past = row_of(row - half - 1);
            columns.iter_mut().zip(past).for_each(|(sum, it)| *sum -= u32::from(*it));
        }
        let mut sum = 0.0;
        for (place, column) in before[1..].iter_mut().zip(&columns) {
            sum += f64::from(*column);
            *place = sum;
        }
        let rows = (row + half + 1).min(height) - row.saturating_sub(half);
        let target = &mut dark[row * width..(row + 1) * width];
        darker(row_of(row), &before, (rows, half), f64::from(offset * 16), target);
    }
    dark
}

/// The same of a row, by the sums of its window before each column.
fn darker(levels: &[u16], before: &[f64], (rows, half): (usize, usize), offset: f64, target: &mut [bool]) {
    let width = levels.len();
    let inner = half.min(width)..width.saturating_sub(half).max(half.min(width));
    for column in (0..inner.start).chain(inner.end..width) {
        let (left, right) = (column.saturating_sub(half), (column + half + 1).min(width));
        let area = (rows * (right - left)) as f64;
        target[column] = (f64::from(levels[column]) + offset) * area < before[right] - before[left];
    }
    let area = (rows * (2 * half + 1)) as f64;
    let ends = before.iter().zip(&before[(2 * half + 1).min(width)..]);
    let all = target[inner.clone()].iter_mut().zip(&levels[inner]).zip(ends);
    all.for_each(|((dark, level), (left, right))| *dark = (f64::from(*level) + offset) * area < right - left);
}

/// The next pixel that is dark, or not, from one on.
fn next(levels: &[bool], from: usize, dark: bool) -> Option<usize> {
    // Many at once, while none is.
    const MANY: usize = 16;
    let rest = levels.get(from..)?;
    let skipped = rest.chunks_exact(MANY).take_while(|it| it.iter().all(|it| *it != dark)).count() * MANY;
    rest[skipped..].iter().position(|it| *it == dark).map(|it| from + skipped + it)
}

/// What stands for the number of a part that is too small.
const NO_PART: u32 = u32::MAX;

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
            while let Some(from) = next(levels, column, true) {
                let to = next(levels, from, false).unwrap_or(width);
                let own = parts.runs.len() as u32;
                parts.runs.push([from as u32, to as u32 - 1, row as u32]);
                parts.root.push(own);
                column = to;
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

    /// The number of the part of each first run, of parts of such a size, and how many there are: of pictures of noise most are small, and what is
    /// kept of each part would take many times the memory of the picture.
    fn large(&mut self, least: u32, size_of: impl Fn([u32; 3]) -> u32) -> (Vec<u32>, usize) {
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
        let (numbers, count) = self.large(least / 2, |_| 1);
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

    /// The moments of each part of so many pixels.
    pub(crate) fn blobs(mut self, least: u32) -> Vec<Blob> {
        let (numbers, count) = self.large(least, |[left, right, _]| right - left + 1);
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
        let (width, height) = (23, 9);
        let smooth: Vec<u16> = (0..width * height).map(|k| (k * k * 37 % 4001) as u16).collect();
        for half in [1, 4, 7, 11, 30] {
            let found = dark(&smooth, width, half, 3);
            for (at, is_dark) in found.iter().enumerate() {
                let (x, y) = (at % width, at / width);
                let inside =
                    |it: &usize| (it % width).abs_diff(x) <= half && (it / width).abs_diff(y) <= half;
                let window: Vec<u64> = (0..smooth.len()).filter(inside).map(|it| smooth[it].into()).collect();
                let mean = window.iter().sum::<u64>() as f64 / window.len() as f64;
                assert_eq!(*is_dark, f64::from(smooth[at]) + 48.0 < mean, "{half} {at}");
            }
        }
    }

    #[test]
    fn runs_end_where_they_end() {
        let levels: Vec<bool> = (0..70).map(|k| (20..53).contains(&k) || k == 69).collect();
        assert_eq!([next(&levels, 0, true), next(&levels, 20, false)], [Some(20), Some(53)]);
        assert_eq!(
            [next(&levels, 53, true), next(&levels, 69, false), next(&levels, 70, true)],
            [Some(69), None, None]
        );
    }
}
