//! Sums of products of columns in register tiles: most of the time of a fit.

use pulp::Simd;

use super::vector::{LaneBlock, Lanes, WIDTH, parts};

/// Columns of one side of a tile: nine sums in registers hide the latency of their additions, and six loads feed nine products.
pub const TILE: usize = 3;

/// Length, in `LaneBlock`s, of the accumulators of all tiles of this number of columns, for vectors of `lanes` lanes.
pub(crate) fn sums_len(columns: usize, lanes: usize) -> usize {
    let tiles = columns / TILE;
    (tiles * (tiles + 1) / 2 * TILE * TILE * lanes).div_ceil(WIDTH)
}

/// Adds the products of each pair of columns, summed over rows but not over lanes. A column is `stride` wide numbers long, of which
/// the first `used` count; `columns` is a multiple of [`TILE`]. Tiles at pairs of columns that are not `needed` stay unchanged.
#[inline(always)]
pub(crate) fn add_products<S: Simd>(
    simd: S,
    jacobian: &[LaneBlock],
    (stride, used): (usize, usize),
    columns: usize,
    sums: &mut [LaneBlock],
    needed: impl Fn(usize, usize) -> bool,
) {
    let mut at = 0;
    for i in (0..columns).step_by(TILE) {
        for j in (i..columns).step_by(TILE) {
            if !needed(i, j) {
                at += TILE * TILE;
                continue;
            }
            let tile = tile(simd, &jacobian[i * stride..], &jacobian[j * stride..], stride, used);
            for sum in tile {
                sum.add_to(&mut sums[at * S::F64_LANES / WIDTH], at % (WIDTH / S::F64_LANES));
                at += 1;
            }
        }
    }
}

/// The nine products of two groups of three columns.
#[inline(always)]
fn tile<S: Simd>(
    simd: S,
    left: &[LaneBlock],
    right: &[LaneBlock],
    stride: usize,
    used: usize,
) -> [Lanes<S>; TILE * TILE] {
    let (a, b, c) = (&left[..used], &left[stride..stride + used], &left[2 * stride..2 * stride + used]);
    let (d, e, f) = (&right[..used], &right[stride..stride + used], &right[2 * stride..2 * stride + used]);
    let mut sums = [Lanes::splat(simd, 0.0); TILE * TILE];
    for k in 0..used {
        for part in parts(simd) {
            let left = [Lanes::load(simd, &a[k], part), Lanes::load(simd, &b[k], part), Lanes::load(simd, &c[k], part)];
            let right =
                [Lanes::load(simd, &d[k], part), Lanes::load(simd, &e[k], part), Lanes::load(simd, &f[k], part)];
            for row in 0..TILE {
                for column in 0..TILE {
                    let sum = &mut sums[row * TILE + column];
                    *sum = left[row].times_plus(right[column], *sum);
                }
            }
        }
    }
    sums
}
