//! Sums of one pass over rows.

use super::gram::TILE;

/// Sums of one pass over some rows.
pub struct PassTotals {
    /// Products of position columns, tile after tile: see [`TileIndex`].
    pub products: Vec<f64>,
    /// Sums that rotation rows add to the products of rotation columns, in the same order.
    pub turned: Vec<f64>,
    /// `Jᵀe` of translation columns, then of rotation columns.
    pub gradient: Vec<f64>,
    /// `½ Σ e²`.
    pub cost: f64,
}

impl PassTotals {
    /// Adds the sums of other rows.
    pub fn add(&mut self, other: &PassTotals) {
        let pairs = [
            (&mut self.products, &other.products),
            (&mut self.turned, &other.turned),
            (&mut self.gradient, &other.gradient),
        ];
        for (own, others) in pairs {
            own.iter_mut().zip(others).for_each(|(own, other)| *own += other);
        }
        self.cost += other.cost;
    }
}

/// Index of the product of columns `a ≤ b` in a sum of tiles: `left[a] + right[b]`.
#[derive(Clone, Debug)]
pub struct TileIndex {
    /// Part of the index by the first column.
    pub left: Vec<usize>,
    /// Part of the index by the second column.
    pub right: Vec<usize>,
}

impl TileIndex {
    /// Index for this number of columns.
    pub fn new(columns: usize) -> Self {
        let tiles = columns.div_ceil(TILE);
        // The tiles of row `r` follow those of the rows above, each one shorter; the first of its own is on the diagonal.
        let before = |r: usize| r * tiles - r * (r + 1) / 2;
        TileIndex {
            left: (0..columns).map(|a| before(a / TILE) * TILE * TILE + a % TILE * TILE).collect(),
            right: (0..columns).map(|b| b / TILE * TILE * TILE + b % TILE).collect(),
        }
    }
}
