//! Places of the hot path's sums in the problem's `JᵀJ`.

use super::column_map::ColumnMap;
use crate::lanes::{Tiles, Totals};

/// Places of a group's products, computed once for all passes.
#[derive(Clone, Debug)]
pub(super) struct GramScatter {
    /// Position columns: index among the sums, and in the Gram matrix.
    position: Vec<(usize, usize)>,
    /// Rotation columns: index of the product of their translation columns, of the rotation rows' sum, and in the Gram matrix.
    rotation: Vec<(usize, usize, usize)>,
    /// Factor `ρ²/L²` of theory.md §6 (28a), if it is the same for all rows.
    shared: Option<f64>,
}

impl GramScatter {
    /// Places for rows of this column map, with `n` unknowns.
    pub(super) fn new(arranged: &ColumnMap, n: usize) -> Self {
        let ColumnMap { plan, turn_places, .. } = arranged;
        let upper = |a: usize, b: usize| a.min(b) * n + a.max(b);
        let columns = plan.columns();
        let places: Vec<usize> = arranged.places().take(columns).collect();
        let tiles = Tiles::new(columns);
        let mut position = Vec::with_capacity(columns * (columns + 1) / 2);
        for (a, (&place, left)) in places.iter().zip(&tiles.left).enumerate() {
            let others = places.iter().zip(&tiles.right).skip(a);
            position.extend(others.map(|(&other, right)| (left + right, upper(place, other))));
        }
        let turns = if plan.framed { &plan.turns[..] } else { &[] };
        let own = Tiles::new(turns.len());
        let mut rotation = Vec::with_capacity(turns.len() * (turns.len() + 1) / 2);
        for (a, (&shift, &place)) in turns.iter().zip(turn_places).enumerate() {
            for (b, (&other_shift, &other)) in turns.iter().zip(turn_places).enumerate().skip(a) {
                let of_shifts = tiles.left[shift.min(other_shift)] + tiles.right[shift.max(other_shift)];
                rotation.push((of_shifts, own.left[a] + own.right[b], upper(place, other)));
            }
        }
        GramScatter { position, rotation, shared: plan.ratio.map(|ratio| (ratio / plan.length_m).powi(2)) }
    }

    /// Adds sums to the upper triangle of a Gram matrix.
    pub(super) fn add(&self, totals: &Totals, gram: &mut [f64]) {
        for &(from, to) in &self.position {
            gram[to] += totals.products[from];
        }
        for &(of_shifts, own, to) in &self.rotation {
            let own = totals.turned.get(own).copied().unwrap_or(0.0);
            gram[to] += self.shared.map_or(own, |factor| factor * (totals.products[of_shifts] + own));
        }
    }
}
