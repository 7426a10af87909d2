//! What a pass over rows gives.

use super::gram::TILE;

/// Sums of one pass over some rows.
pub(crate) struct Totals {
    /// Products of position columns, tile after tile: see [`product`].
    pub(crate) products: Vec<f64>,
    /// What rotation rows add to products of turns, likewise.
    pub(crate) turned: Vec<f64>,
    /// `Jᵀe` of shifts, then of turns.
    pub(crate) gradient: Vec<f64>,
    /// `½ Σ e²`.
    pub(crate) cost: f64,
}

impl Totals {
    /// Adds those of other rows.
    pub(crate) fn add(&mut self, other: &Totals) {
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

/// Where the product of two of `columns` columns is in a sum of tiles, for `a ≤ b`.
pub(crate) fn product(columns: usize, a: usize, b: usize) -> usize {
    let tiles = columns.div_ceil(TILE);
    let (row, column) = (a / TILE, b / TILE);
    let before = row * tiles - row * row.saturating_sub(1) / 2;
    (before + column - row) * TILE * TILE + a % TILE * TILE + b % TILE
}
