//! Sums of products of the rows of a least-squares fit to pixels, many pixels side by side.
//!
//! Rows are single precision, which exceeds that of levels; their sums are double after every thousand pixels.

use nalgebra::{SMatrix, SVector, Vector2};

/// Pixels side by side.
pub(crate) const LANES: usize = 16;
/// A number for each of them.
pub(crate) type LaneArray = [f32; LANES];
/// Numbers side by side from an index on.
#[inline(always)]
pub(crate) fn lanes(all: &[f32], at: usize) -> &LaneArray {
    all.get(at..).and_then(<[f32]>::first_chunk).unwrap_or(&[0.0; LANES])
}

/// Additions before sums are added to those of double precision.
const MANY: usize = 64;

/// Pixels with their levels, [`LANES`] side by side; positions are relative to an origin near them, which is a pixel.
pub(crate) struct Pixels {
    pub(crate) origin: Vector2<f64>,
    /// Columns, rows and levels.
    all: Vec<[LaneArray; 3]>,
    count: usize,
}

impl Pixels {
    pub(crate) fn new(near: Vector2<f64>) -> Self {
        Pixels { origin: near.map(f64::round), all: Vec::with_capacity(64), count: 0 }
    }

    #[inline]
    pub(crate) fn push(&mut self, x: f32, y: f32, level: f32) {
        let lane = self.count % LANES;
        if lane == 0 {
            self.all.push([[0.0; LANES]; 3]);
        }
        if let Some([xs, ys, levels]) = self.all.last_mut() {
            (xs[lane], ys[lane], levels[lane]) = (x, y, level);
        }
        self.count += 1;
    }

    pub(crate) fn len(&self) -> usize {
        self.count
    }

    /// Columns, rows and levels of pixels side by side, and their number.
    #[inline(always)]
    pub(crate) fn chunks(&self) -> impl Iterator<Item = (&[LaneArray; 3], usize)> {
        self.all.iter().enumerate().map(|(at, it)| (it, (self.count - at * LANES).min(LANES)))
    }

    /// Column, row and level of each pixel.
    pub(crate) fn iter_pixels(&self) -> impl Iterator<Item = [f32; 3]> {
        (0..self.count).map(|at| self.all[at / LANES].map(|it| it[at % LANES]))
    }

    /// Position relative to the origin.
    pub(crate) fn offset(&self, place: Vector2<f64>) -> [f32; 2] {
        (place - self.origin).map(|it| it as f32).into()
    }
}

/// The normal equations of rows.
pub(crate) struct PixelEquations<const N: usize> {
    /// Products below the diagonal.
    products: [[LaneArray; N]; N],
    right: [LaneArray; N],
    squares: LaneArray,
    waiting: usize,
    whole: (SMatrix<f64, N, N>, SVector<f64, N>, f64),
}

#[inline(always)]
fn add(sum: &mut LaneArray, a: &LaneArray, b: &LaneArray) {
    for k in 0..LANES {
        sum[k] += a[k] * b[k];
    }
}

fn total(lanes: &LaneArray) -> f64 {
    lanes.iter().map(|it| f64::from(*it)).sum()
}

impl<const N: usize> PixelEquations<N> {
    pub(crate) fn new() -> Self {
        PixelEquations {
            products: [[[0.0; LANES]; N]; N],
            right: [[0.0; LANES]; N],
            squares: [0.0; LANES],
            waiting: 0,
            whole: (SMatrix::zeros(), SVector::zeros(), 0.0),
        }
    }

    /// Adds the first `count` of rows side by side with their residuals.
    #[inline(always)]
    pub(crate) fn add(&mut self, rows: &mut [LaneArray; N], residuals: &mut LaneArray, count: usize) {
        if count < LANES {
            rows.iter_mut().for_each(|row| row[count..].fill(0.0));
            residuals[count..].fill(0.0);
        }
        for i in 0..N {
            for j in 0..=i {
                add(&mut self.products[i][j], &rows[i], &rows[j]);
            }
            add(&mut self.right[i], &rows[i], residuals);
        }
        add(&mut self.squares, residuals, residuals);
        self.waiting += 1;
        if self.waiting == MANY {
            self.take();
        }
    }

    fn take(&mut self) {
        for i in 0..N {
            for j in 0..=i {
                self.whole.0[(i, j)] += total(&self.products[i][j]);
                self.products[i][j] = [0.0; LANES];
            }
            self.whole.1[i] += total(&self.right[i]);
            self.right[i] = [0.0; LANES];
        }
        self.whole.2 += total(&self.squares);
        self.squares = [0.0; LANES];
        self.waiting = 0;
    }

    /// The matrix, the right side, and the sum of the squares of the residuals.
    pub(crate) fn into_equations(mut self) -> (SMatrix<f64, N, N>, SVector<f64, N>, f64) {
        self.take();
        self.whole.0.fill_upper_triangle_with_lower_triangle();
        self.whole
    }
}

/// Mean of a sign at a distance of this number of standard deviations, and exp(-x²/2): 7.1.26 of abramowitz1964, to 2e-7.
#[inline(always)]
pub(crate) fn sign_and_bell(x: f32) -> (f32, f32) {
    let bell = exp(-0.5 * x * x);
    let z = x.abs() * std::f32::consts::FRAC_1_SQRT_2;
    let t = 1.0 / (1.0 + 0.327_591_1 * z);
    let series = t * (0.254_829_6 + t * (-0.284_496_74 + t * (1.421_413_8 + t * (-1.453_152 + t * 1.061_405_4))));
    ((1.0 - series * bell).copysign(x), bell)
}

/// Exponential of a non-positive number.
#[inline(always)]
fn exp(x: f32) -> f32 {
    // A number of this size is an integer: its last bits are the nearest integer.
    const WHOLE: f32 = 12_582_912.0;
    let power = x.max(-80.0) * std::f32::consts::LOG2_E;
    let shifted = power + WHOLE;
    let part = (power - (shifted - WHOLE)) * std::f32::consts::LN_2;
    let series = 1.0
        + part * (1.0 + part * (0.5 + part * (1.0 / 6.0 + part * (1.0 / 24.0 + part * (1.0 / 120.0 + part / 720.0)))));
    series * f32::from_bits((shifted.to_bits() << 23).wrapping_add(1.0_f32.to_bits()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_those_of_single_rows() {
        for count in [0, 1, 15, 16, 17, 40, 1100] {
            let mut pixels = Pixels::new(Vector2::zeros());
            (0..count).for_each(|k| pixels.push((k % 13) as f32, 1.0, (k % 7) as f32 - 2.5));
            let mut found = PixelEquations::<3>::new();
            for ([xs, ys, levels], used) in pixels.chunks() {
                found.add(&mut [*ys, *xs, xs.map(|it| it * it)], &mut levels.clone(), used);
            }
            let (normal, right, squares) = found.into_equations();
            let row = |[x, y, level]: [f32; 3]| (SVector::from([y, x, x * x].map(f64::from)), f64::from(level));
            let rows: Vec<_> = pixels.iter_pixels().map(row).collect();
            let expected = rows.iter().fold(SMatrix::zeros(), |sum, it| sum + it.0 * it.0.transpose());
            // Integers and halves: without rounding.
            assert_eq!(normal, expected);
            assert_eq!(right, rows.iter().fold(SVector::zeros(), |sum, it| sum + it.0 * it.1));
            assert_eq!(squares, rows.iter().map(|it| it.1 * it.1).sum::<f64>());
        }
    }

    #[test]
    fn the_bell_is_exact_to_single_precision() {
        for k in -4000..4000 {
            let x = k as f32 / 200.0;
            let (sign, bell) = sign_and_bell(x);
            let expected = (-0.5 * f64::from(x).powi(2)).exp();
            assert!((f64::from(bell) - expected).abs() < 3e-7, "{x}: {bell}");
            assert!(sign.abs() <= 1.0 && (sign >= 0.0) == (x >= 0.0));
        }
        assert_eq!(sign_and_bell(60.0).0, 1.0);
    }
}
