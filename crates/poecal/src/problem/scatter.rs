//! Places of the hot path's sums in the problem's `JᵀJ`.

use super::column_map::{ColumnMap, Place};
use crate::lanes::{Tiles, Totals};

/// Places of a group's products, computed once for all passes.
#[derive(Clone, Debug, Default)]
pub(super) struct GramScatter {
    /// Position columns: index among the sums, and in the Gram matrix.
    position: Vec<(usize, usize)>,
    /// Rotation columns: index of the product of their translation columns, of the rotation rows' sum, and in the Gram matrix.
    rotation: Vec<(usize, usize, usize)>,
    /// Of both, those of a column with a negative sign, or of two columns of one unknown: the index in the Gram matrix, with a factor.
    position_scaled: Vec<(usize, usize, f64)>,
    rotation_scaled: Vec<(usize, usize, usize, f64)>,
    /// Factor `ρ²/L²` of theory.md §6 (28a), if it is the same for all rows.
    shared: Option<f64>,
}

impl GramScatter {
    /// Places for rows of this column map, with `n` unknowns.
    pub(super) fn new(arranged: &ColumnMap, n: usize) -> Self {
        let plan = &arranged.plan;
        let upper = |a: usize, b: usize| a.min(b) * n + a.max(b);
        // Of two columns of one unknown, the product counts twice on the diagonal.
        let factor = |a: (usize, Place), b: (usize, Place)| {
            let twice = if a.0 != b.0 && a.1.at == b.1.at { 2.0 } else { 1.0 };
            twice * a.1.sign * b.1.sign
        };
        let columns = plan.columns();
        let places: Vec<Place> = arranged.places().take(columns).collect();
        let tiles = Tiles::new(columns);
        let mut made = GramScatter {
            position: Vec::with_capacity(columns * (columns + 1) / 2),
            shared: plan.ratio.map(|ratio| (ratio / plan.length_m).powi(2)),
            ..GramScatter::default()
        };
        for (a, (&place, left)) in places.iter().zip(&tiles.left).enumerate() {
            for (b, (&other, right)) in places.iter().zip(&tiles.right).enumerate().skip(a) {
                if !(place.is_unknown() && other.is_unknown()) {
                    continue;
                }
                let (from, to) = (left + right, upper(place.at, other.at));
                match factor((a, place), (b, other)) {
                    1.0 => made.position.push((from, to)),
                    factor => made.position_scaled.push((from, to, factor)),
                }
            }
        }
        let turns = if plan.is_pose() { &plan.turns[..] } else { &[] };
        let own = Tiles::new(turns.len());
        made.rotation.reserve(turns.len() * (turns.len() + 1) / 2);
        for (a, (&shift, &place)) in turns.iter().zip(arranged.turn_places()).enumerate() {
            for (b, (&other_shift, &other)) in turns.iter().zip(arranged.turn_places()).enumerate().skip(a) {
                let of_shifts = tiles.left[shift.min(other_shift)] + tiles.right[shift.max(other_shift)];
                let (own, to) = (own.left[a] + own.right[b], upper(place.at, other.at));
                match factor((a, place), (b, other)) {
                    1.0 => made.rotation.push((of_shifts, own, to)),
                    factor => made.rotation_scaled.push((of_shifts, own, to, factor)),
                }
            }
        }
        made
    }

    /// Adds sums to the upper triangle of a Gram matrix.
    pub(super) fn add(&self, totals: &Totals, gram: &mut [f64]) {
        for &(from, to) in &self.position {
            gram[to] += totals.products[from];
        }
        for &(from, to, factor) in &self.position_scaled {
            gram[to] += factor * totals.products[from];
        }
        let turned = |of_shifts: usize, own: usize| {
            let own = totals.turned.get(own).copied().unwrap_or(0.0);
            self.shared.map_or(own, |factor| factor * (totals.products[of_shifts] + own))
        };
        for &(of_shifts, own, to) in &self.rotation {
            gram[to] += turned(of_shifts, own);
        }
        for &(of_shifts, own, to, factor) in &self.rotation_scaled {
            gram[to] += factor * turned(of_shifts, own);
        }
    }
}
