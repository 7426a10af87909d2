//! Where the sums of the hot path belong in the problem's normal information.

use super::column_map::ColumnMap;
use crate::lanes::{Tiles, Totals};

/// Places of a group's products, found once for all passes.
#[derive(Clone, Debug)]
pub(super) struct GramScatter {
    /// Of position columns: index among the sums, and in the Gram matrix.
    seen: Vec<(usize, usize)>,
    /// Of turns: index of the product of their shifts, of what rotation adds, and in the Gram matrix.
    turned: Vec<(usize, usize, usize)>,
    /// By what rotation products of turns are those of their shifts, where that is one number for all rows.
    shared: Option<f64>,
}

impl GramScatter {
    /// For rows so arranged, in a step of `n` unknowns.
    pub(super) fn new(arranged: &ColumnMap, n: usize) -> Self {
        let ColumnMap { plan, turn_places, .. } = arranged;
        let upper = |a: usize, b: usize| a.min(b) * n + a.max(b);
        let columns = plan.columns();
        let places: Vec<usize> = arranged.places().take(columns).collect();
        let tiles = Tiles::new(columns);
        let mut seen = Vec::with_capacity(columns * (columns + 1) / 2);
        for (a, (&place, left)) in places.iter().zip(&tiles.left).enumerate() {
            let others = places.iter().zip(&tiles.right).skip(a);
            seen.extend(others.map(|(&other, right)| (left + right, upper(place, other))));
        }
        let turns = if plan.framed { &plan.turns[..] } else { &[] };
        let own = Tiles::new(turns.len());
        let mut turned = Vec::with_capacity(turns.len() * (turns.len() + 1) / 2);
        for (a, (&shift, &place)) in turns.iter().zip(turn_places).enumerate() {
            for (b, (&other_shift, &other)) in turns.iter().zip(turn_places).enumerate().skip(a) {
                let of_shifts = tiles.left[shift.min(other_shift)] + tiles.right[shift.max(other_shift)];
                turned.push((of_shifts, own.left[a] + own.right[b], upper(place, other)));
            }
        }
        GramScatter { seen, turned, shared: plan.ratio.map(|ratio| (ratio / plan.length_m).powi(2)) }
    }

    /// Adds sums to the upper triangle of a Gram matrix.
    pub(super) fn add(&self, totals: &Totals, gram: &mut [f64]) {
        for &(from, to) in &self.seen {
            gram[to] += totals.products[from];
        }
        for &(of_shifts, own, to) in &self.turned {
            let own = totals.turned.get(own).copied().unwrap_or(0.0);
            gram[to] += self.shared.map_or(own, |factor| factor * (totals.products[of_shifts] + own));
        }
    }
}
