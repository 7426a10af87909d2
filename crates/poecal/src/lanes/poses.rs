//! Poses of a tip in several configurations side by side. No product is fused with a sum, so that the bits are the same by all
//! instructions.

use pulp::Simd;

use std::ops::{Add, Mul};

use super::vector::{Lanes, Wide, parts};

/// The motion of a joint, `I + f F + g G` with two functions f and g of its value (theory.md §1 (2a)): three directions and a translation,
/// by rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exponential {
    pub(crate) first: [[f64; 4]; 3],
    pub(crate) second: [[f64; 4]; 3],
}

impl Exponential {
    /// Moves a pose, by rows, by the joint's motion with these f and g: of one configuration, or of several side by side.
    #[inline(always)]
    pub(crate) fn advance<V: Copy + Add<Output = V> + Mul<Output = V>>(
        &self,
        rows: &mut [[V; 4]; 3],
        first: V,
        second: V,
        splat: impl Fn(f64) -> V,
    ) {
        let change: [[V; 4]; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| first * splat(self.first[i][j]) + second * splat(self.second[i][j]))
        });
        for row in rows {
            let [x, y, z, _] = *row;
            *row = std::array::from_fn(|j| row[j] + (x * change[0][j] + y * change[1][j] + z * change[2][j]));
        }
    }
}

/// The product of the motions of all joints, each with its f and g (theory.md §2 (6)): three directions and a translation, by rows.
#[inline(always)]
pub(super) fn product_of_exponentials<S: Simd>(
    simd: S,
    joints: &[Exponential],
    factors: &[[Wide; 2]],
) -> [[Wide; 4]; 3] {
    let mut out = [[Wide::ZERO; 4]; 3];
    for part in parts(simd) {
        let unit = |i: usize, j: usize| Lanes::splat(simd, f64::from(u8::from(i == j)));
        let mut rows: [[Lanes<S>; 4]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| unit(i, j)));
        for (joint, [first, second]) in joints.iter().zip(factors) {
            joint.advance(
                &mut rows,
                Lanes::load(simd, first, part),
                Lanes::load(simd, second, part),
                |value| Lanes::splat(simd, value),
            );
        }
        for (row, out) in rows.iter().zip(&mut out) {
            row.iter().zip(out).for_each(|(value, out)| value.store(out, part));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::{product_of_exponentials, simd_levels};
    use super::*;

    #[test]
    fn every_level_gives_the_same_bits() {
        let number = |k: usize| ((k * k * 7 + 3 * k) % 17) as f64 / 13.0 - 0.6;
        let by = |seed: usize| std::array::from_fn(|i| std::array::from_fn(|j| number(seed + 4 * i + j)));
        let joints: Vec<Exponential> =
            (0..7).map(|k| Exponential { first: by(12 * k), second: by(91 + 12 * k) }).collect();
        let factors: Vec<[Wide; 2]> = (0..7)
            .map(|k| [5, 31].map(|seed| Wide(std::array::from_fn(|lane| number(seed * k + lane)))))
            .collect();
        let found = simd_levels().into_iter().map(|level| product_of_exponentials(level, &joints, &factors));
        let found: Vec<_> =
            found.map(|rows| rows.map(|row| row.map(|wide| wide.0.map(f64::to_bits)))).collect();
        assert!(found.iter().all(|bits| bits == &found[0]));
    }
}
