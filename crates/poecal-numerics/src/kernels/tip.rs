//! The chain alone: frames of the last link in several rows.

use pulp::Simd;

use super::frame::{KernelFrame, move_row, turn_row};
use super::plan::FixedMotion;
use super::vector::{LaneBlock, Lanes, parts};

/// Writes the frame of the last link after all motions, `X T_n` of theory.md §4 (13), as rows of `[x, y, z, origin]`. The input has for
/// each joint true if it is revolute, its frame in the one before at zero joint values, and `(cos θ, sin θ)` or `(θ, 0)`.
#[inline(always)]
pub(crate) fn last_links<S: Simd>(
    simd: S,
    joints: &[(bool, FixedMotion)],
    values: &[[LaneBlock; 2]],
    out: &mut [[LaneBlock; 4]; 3],
) {
    for part in parts(simd) {
        let mut link = KernelFrame([[Lanes::splat(simd, 0.0); 4]; 3]);
        for (index, ((turns, step), [cosine, sine])) in joints.iter().zip(values).enumerate() {
            if index == 0 {
                link = KernelFrame::from_step(simd, step);
            }
            let (cosine, sine) = (Lanes::load(simd, cosine, part), Lanes::load(simd, sine, part));
            for row in &mut link.0 {
                *row = move_row(if index == 0 { *row } else { turn_row(simd, *row, step) }, *turns, cosine, sine);
            }
        }
        for (row, out) in link.0.iter().zip(&mut *out) {
            row.iter().zip(out).for_each(|(number, out)| number.store(out, part));
        }
    }
}
