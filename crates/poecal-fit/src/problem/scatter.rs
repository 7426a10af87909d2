//! Places of the hot path's sums in the problem's `JᵀJ`.

use super::kernel_columns::{KernelColumns, StepColumn};
use poecal_numerics::kernels::{PassTotals, TILE, TileIndex};

/// Places of a group's products, computed once for all passes.
#[derive(Clone, Debug)]
pub(crate) enum GramScatter {
    /// Each column is an unknown of its own.
    Plain(PlainScatter),
    /// Some columns are no unknowns, or one unknown has several.
    Listed(ListedScatter),
}

impl GramScatter {
    /// Places for rows of this column map, with `n` unknowns.
    pub(crate) fn new(arranged: &KernelColumns, n: usize) -> Self {
        match PlainScatter::new(arranged, n) {
            Some(plain) => GramScatter::Plain(plain),
            None => GramScatter::Listed(ListedScatter::new(arranged, n)),
        }
    }

    /// Adds sums to the upper triangle of a Gram matrix.
    pub(crate) fn add(&self, totals: &PassTotals, gram: &mut [f64]) {
        match self {
            GramScatter::Plain(plain) => plain.add(totals, gram),
            GramScatter::Listed(listed) => listed.add(totals, gram),
        }
    }
}

/// Places of columns that are an unknown each: a list of all products would take longer to make than a small fit takes to use it.
#[derive(Clone, Debug)]
pub(crate) struct PlainScatter {
    /// Begin of each position column's row in the matrix, and its place in a step.
    at: Vec<(usize, usize)>,
    /// The same places of the rotation columns, with those of their products among the sums, and of their translation columns.
    turns_at: Vec<(usize, usize)>,
    turns: TileIndex,
    of_shifts: TileIndex,
    /// Factor `ρ²/L²` of theory.md §6 (28a), if it is the same for all rows.
    shared: Option<f64>,
}

impl PlainScatter {
    /// Places of these columns. `None` if a column is no unknown, or not the only one of its unknown.
    fn new(arranged: &KernelColumns, n: usize) -> Option<Self> {
        let plan = &arranged.plan;
        let mut is_known = vec![false; n];
        for place in arranged.step_columns() {
            let known = is_known.get_mut(place.at)?;
            if place.sign != 1.0 || std::mem::replace(known, true) {
                return None;
            }
        }
        let columns = plan.columns();
        let turns = if plan.is_pose() { &plan.turns[..] } else { &[] };
        if !turns.is_sorted() {
            return None;
        }
        let tiles = TileIndex::new(columns);
        let of_shifts = TileIndex {
            left: turns.iter().map(|&shift| tiles.left[shift]).collect(),
            right: turns.iter().map(|&shift| tiles.right[shift]).collect(),
        };
        let of_place = |place: StepColumn| (place.at * n, place.at);
        Some(PlainScatter {
            at: arranged.step_columns().take(columns).map(of_place).collect(),
            turns_at: arranged.turn_places().iter().take(turns.len()).copied().map(of_place).collect(),
            turns: TileIndex::new(turns.len()),
            of_shifts,
            shared: plan.ratio.map(|ratio| (ratio / plan.length_m).powi(2)),
        })
    }

    fn add(&self, totals: &PassTotals, gram: &mut [f64]) {
        // A product has two places in the matrix; the upper one is the earlier.
        let place = |(row, at): (usize, usize), (other_row, other): (usize, usize)| (row + other).min(other_row + at);
        let mut tiles = totals.products.as_chunks::<{ TILE * TILE }>().0.iter();
        for (first, left) in self.at.chunks(TILE).enumerate() {
            for (second, right) in self.at.chunks(TILE).enumerate().skip(first) {
                let Some(tile) = tiles.next() else { return };
                match (left, right) {
                    (&[a, b, c], right @ &[_, _, _]) if second > first => {
                        for (other, of_row) in [a, b, c].into_iter().zip(tile.as_chunks::<TILE>().0) {
                            for (at, product) in right.iter().zip(of_row) {
                                gram[place(other, *at)] += product;
                            }
                        }
                    }
                    _ => {
                        for (k, other) in left.iter().enumerate() {
                            let above = if second > first { 0 } else { k };
                            for (l, at) in right.iter().enumerate().skip(above) {
                                gram[place(*other, *at)] += tile[k * TILE + l];
                            }
                        }
                    }
                }
            }
        }
        if let (Some(factor), true) = (self.shared, totals.turned.is_empty()) {
            // The curvature of the logarithm is left out: rotations add nothing of their own.
            for (first, (&a, left)) in self.turns_at.iter().zip(&self.of_shifts.left).enumerate() {
                for (&b, right) in self.turns_at[first..].iter().zip(&self.of_shifts.right[first..]) {
                    gram[place(a, b)] += factor * totals.products[left + right];
                }
            }
            return;
        }
        let (own, of_shifts, has_own) = (&self.turns, &self.of_shifts, !totals.turned.is_empty());
        for (first, &a) in self.turns_at.iter().enumerate() {
            let (left, left_of_shift) = (own.left[first], of_shifts.left[first]);
            let rights = own.right[first..].iter().zip(&of_shifts.right[first..]);
            for (&b, (right, right_of_shift)) in self.turns_at[first..].iter().zip(rights) {
                let own = if has_own { totals.turned[left + right] } else { 0.0 };
                let turned = match self.shared {
                    Some(factor) => factor * (totals.products[left_of_shift + right_of_shift] + own),
                    None => own,
                };
                gram[place(a, b)] += turned;
            }
        }
    }
}

/// Places of every product.
#[derive(Clone, Debug, Default)]
pub(crate) struct ListedScatter {
    /// Position columns: index among the sums, and in the Gram matrix.
    position: Vec<(usize, usize)>,
    /// Rotation columns: index of the product of their translation columns, of the rotation rows' sum, and in the Gram matrix.
    rotation: Vec<(usize, usize, usize)>,
    /// Products, of both kinds, of a column with a negative sign, or of two columns of one unknown: the index in the Gram matrix, with a
    /// factor.
    position_scaled: Vec<(usize, usize, f64)>,
    rotation_scaled: Vec<(usize, usize, usize, f64)>,
    /// Factor `ρ²/L²` of theory.md §6 (28a), if it is the same for all rows.
    shared: Option<f64>,
}

impl ListedScatter {
    fn new(arranged: &KernelColumns, n: usize) -> Self {
        let plan = &arranged.plan;
        let upper = |a: usize, b: usize| a.min(b) * n + a.max(b);
        // For two columns of one unknown, the product counts twice on the diagonal.
        let factor = |a: (usize, StepColumn), b: (usize, StepColumn)| {
            let twice = if a.0 != b.0 && a.1.at == b.1.at { 2.0 } else { 1.0 };
            twice * a.1.sign * b.1.sign
        };
        let columns = plan.columns();
        let places: Vec<StepColumn> = arranged.step_columns().take(columns).collect();
        let tiles = TileIndex::new(columns);
        let mut made = ListedScatter {
            position: Vec::with_capacity(columns * (columns + 1) / 2),
            shared: plan.ratio.map(|ratio| (ratio / plan.length_m).powi(2)),
            ..ListedScatter::default()
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
        let own = TileIndex::new(turns.len());
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

    fn add(&self, totals: &PassTotals, gram: &mut [f64]) {
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
