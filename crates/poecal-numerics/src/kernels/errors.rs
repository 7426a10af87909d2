//! Errors of several rows: measured minus predicted.

use pulp::Simd;

use super::frame::KernelFrame;
use super::turn::ResidualRotations;
use super::vector::{LaneBlock, Lanes, Vectors, parts};

/// Frames of several rows: columns of rotations, and origins.
pub type FrameColumns = [[LaneBlock; 3]; 4];

/// Writes position errors and, if any row is `framed`, rotation errors `log(Y Rᵀ)` (theory.md §4 (16)), from the last links as
/// [`last_links`](super::last_links) writes them, the targets in the last link, and the measured targets.
#[inline(always)]
pub(crate) fn errors<S: Simd>(
    simd: S,
    links: &[[LaneBlock; 4]; 3],
    [x, y, z, place]: &FrameColumns,
    [own_x, own_y, own_z, own_place]: &FrameColumns,
    framed: bool,
    out: &mut [[LaneBlock; 3]; 2],
) {
    for part in parts(simd) {
        let mut link = KernelFrame([[Lanes::splat(simd, 0.0); 4]; 3]);
        for (row, wide) in link.0.iter_mut().zip(links) {
            for (number, wide) in row.iter_mut().zip(wide) {
                *number = Lanes::load(simd, wide, part);
            }
        }
        let predicted = rotate_vector(simd, &link, place, part) + link.origin();
        (Vectors::load(simd, own_place, part) - predicted).store(&mut out[0], part);
        if framed {
            let own =
                [Vectors::load(simd, own_x, part), Vectors::load(simd, own_y, part), Vectors::load(simd, own_z, part)];
            let predicted = [
                rotate_vector(simd, &link, x, part),
                rotate_vector(simd, &link, y, part),
                rotate_vector(simd, &link, z, part),
            ];
            ResidualRotations::new(simd, &own, &predicted).r.store(&mut out[1], part);
        }
    }
}

/// A vector of the last link in the device's axes.
#[inline(always)]
fn rotate_vector<S: Simd>(simd: S, link: &KernelFrame<S>, vector: &[LaneBlock; 3], part: usize) -> Vectors<S> {
    let [x, y, z] = Vectors::load(simd, vector, part).0;
    link.column(0).times_plus(x, link.column(1).times_plus(y, link.column(2).scale(z)))
}
