//! Comparison of pairs with other orders: evidently right, wrong, or no better.

use super::{EVIDENT, FEWEST_PAIRS, RowPair, UnpairedRows};

/// Rows by which one file may begin later.
const SHIFTS: usize = 3;
/// Number of random orders with which pairs are compared.
const BY_CHANCE: usize = 3;

/// Another order of joint readings and measurements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowOrder {
    /// The measurements begin this many rows later than the joint readings.
    MeasuredLater(usize),
    /// The joint readings begin this many rows later than the measurements.
    JointsLater(usize),
    /// One of them is in reverse order.
    Reversed,
}

/// Agreement of pairs with the nominal robot; errors are medians, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Agreement {
    /// The pairs agree evidently, and no other order does.
    Right {
        /// Error of the pairs.
        missed_m: f64,
    },
    /// Another order evidently agrees better.
    Other {
        /// Error of the pairs.
        missed_m: f64,
        /// The other order.
        order: RowOrder,
        /// Error of the other order.
        other_m: f64,
    },
    /// Another order agrees as well.
    Alike {
        /// Error of the pairs.
        missed_m: f64,
        /// The other order.
        order: RowOrder,
        /// Error of the other order.
        other_m: f64,
    },
    /// The pairs agree no better than by chance.
    None {
        /// Error of the pairs.
        missed_m: f64,
    },
}

impl Agreement {
    /// Error of the pairs, metres.
    #[must_use]
    pub fn missed_m(&self) -> f64 {
        match *self {
            Agreement::Right { missed_m }
            | Agreement::Other { missed_m, .. }
            | Agreement::Alike { missed_m, .. }
            | Agreement::None { missed_m } => missed_m,
        }
    }
}

impl UnpairedRows<'_> {
    /// Agreement of pairs with the nominal robot, compared with their other orders; `None` if no comparison is possible, as with few pairs.
    #[must_use]
    pub fn agreement(&self, pairs: &[RowPair]) -> Option<Agreement> {
        if pairs.len() < FEWEST_PAIRS {
            return None;
        }
        let missed_m = self.median_error(pairs)?;
        let others = orders(pairs.len()).into_iter().filter_map(|order| {
            let other = reorder_pairs(pairs, order);
            (other.len() >= FEWEST_PAIRS).then(|| Some((order, self.median_error(&other)?)))?
        });
        let best = others.min_by(|a, b| a.1.total_cmp(&b.1));
        let by_chance = (0..BY_CHANCE).filter_map(|k| self.median_error(&shuffled(pairs, k)));
        let by_chance = by_chance.fold(f64::INFINITY, f64::min);
        let least = best.map_or(missed_m, |it| it.1.min(missed_m));
        if EVIDENT * least > by_chance {
            return Some(Agreement::None { missed_m });
        }
        Some(match best {
            Some((order, other_m)) if EVIDENT * other_m < missed_m => Agreement::Other { missed_m, order, other_m },
            Some((order, other_m)) if other_m < EVIDENT * missed_m => Agreement::Alike { missed_m, order, other_m },
            _ => Agreement::Right { missed_m },
        })
    }
}

/// Multiple of the usual error beyond which a pair is wrong, and up to which one is right.
const WRONG: f64 = 8.0;
const RIGHT: f64 = 3.0;

impl UnpairedRows<'_> {
    /// Pairs on which the nominal robot's error is far larger than on the others: indices into the pairs, with the error of each, metres,
    /// and the median of all.
    #[must_use]
    pub fn find_wrong_pairs(&self, pairs: &[RowPair]) -> (Vec<(usize, f64)>, f64) {
        let Some((estimate, usual)) = self.register_pairs(pairs) else { return (Vec::new(), f64::NAN) };
        let errors = self.errors_of(pairs, &estimate);
        (errors.into_iter().enumerate().filter(|it| it.1 > WRONG * usual).collect(), usual)
    }

    /// Pairs whose measurements belong to each other's joint readings: indices into the pairs, each with the one whose readings it fits.
    #[must_use]
    pub fn find_exchanged_pairs(&self, pairs: &[RowPair]) -> Vec<(usize, usize)> {
        let Some((estimate, usual)) = self.register_pairs(pairs) else { return Vec::new() };
        let errors = self.errors_of(pairs, &estimate);
        let wrong: Vec<usize> = errors.iter().enumerate().filter(|it| *it.1 > WRONG * usual).map(|it| it.0).collect();
        // A larger number of wrong pairs is no exchange.
        if wrong.len() > pairs.len() / 4 {
            return Vec::new();
        }
        let crossed: Vec<(usize, usize)> = (wrong.iter())
            .flat_map(|one| wrong.iter().filter(move |other| *other != one).map(move |other| (*one, *other)))
            .collect();
        let tried: Vec<RowPair> = crossed.iter().map(|(one, other)| (pairs[*other].0, pairs[*one].1)).collect();
        let found = self.errors_of(&tried, &estimate);
        crossed.into_iter().zip(found).filter(|it| it.1 < RIGHT * usual).map(|it| it.0).collect()
    }
}

fn orders(count: usize) -> Vec<RowOrder> {
    let shifts = 1..=SHIFTS.min(count.saturating_sub(1));
    shifts.flat_map(|by| [RowOrder::MeasuredLater(by), RowOrder::JointsLater(by)]).chain([RowOrder::Reversed]).collect()
}

/// Pairs in another order.
fn reorder_pairs(pairs: &[RowPair], order: RowOrder) -> Vec<RowPair> {
    let joints = || pairs.iter().map(|it| it.0);
    let shots = || pairs.iter().map(|it| it.1);
    match order {
        RowOrder::MeasuredLater(by) => joints().skip(by).zip(shots()).collect(),
        RowOrder::JointsLater(by) => joints().zip(shots().skip(by)).collect(),
        RowOrder::Reversed => joints().rev().zip(shots()).collect(),
    }
}

/// Pairs in a random order, the same in every run.
fn shuffled(pairs: &[RowPair], seed: usize) -> Vec<RowPair> {
    let mut joints: Vec<usize> = pairs.iter().map(|it| it.0).collect();
    // A step that has no divisor in common with the number of pairs takes every one once.
    let count = joints.len().max(1);
    let step = [7, 11, 13, 17, 19, 23].into_iter().filter(|it| !count.is_multiple_of(*it)).nth(seed % 4).unwrap_or(1);
    joints = (0..count).filter_map(|at| joints.get((at * step + count / 2) % count)).copied().collect();
    joints.into_iter().zip(pairs.iter().map(|it| it.1)).collect()
}
