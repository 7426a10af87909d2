//! Errors of several rows: measured minus predicted.

use pulp::Simd;

use super::frame::Frame;
use super::turn::Turn;
use super::vector::{Lanes, Vectors, Wide, parts};

/// Frames of several rows: columns of rotations, and origins.
pub type Frames = [[Wide; 3]; 4];

/// Writes position errors and, if any row is `framed`, rotation errors `log(Y Rᵀ)` (theory.md §4 (16)), from the last links as
/// [`last_links`](super::last_links) writes them, the targets in the last link, and the measured targets.
#[inline(always)]
pub(crate) fn errors<S: Simd>(
    simd: S,
    links: &[[Wide; 4]; 3],
    [x, y, z, place]: &Frames,
    [own_x, own_y, own_z, own_place]: &Frames,
    framed: bool,
    out: &mut [[Wide; 3]; 2],
) {
    for part in parts(simd) {
        let mut link = Frame([[Lanes::splat(simd, 0.0); 4]; 3]);
        for (row, wide) in link.0.iter_mut().zip(links) {
            for (number, wide) in row.iter_mut().zip(wide) {
                *number = Lanes::load(simd, wide, part);
            }
        }
        let predicted = moved(simd, &link, place, part) + link.origin();
        (Vectors::load(simd, own_place, part) - predicted).store(&mut out[0], part);
        if framed {
            let own = [
                Vectors::load(simd, own_x, part),
                Vectors::load(simd, own_y, part),
                Vectors::load(simd, own_z, part),
            ];
            let predicted =
                [moved(simd, &link, x, part), moved(simd, &link, y, part), moved(simd, &link, z, part)];
            Turn::new(simd, &own, &predicted).r.store(&mut out[1], part);
        }
    }
}

/// A vector of the last link in the device's axes.
#[inline(always)]
fn moved<S: Simd>(simd: S, link: &Frame<S>, vector: &[Wide; 3], part: usize) -> Vectors<S> {
    let [x, y, z] = Vectors::load(simd, vector, part).0;
    link.column(0).times_plus(x, link.column(1).times_plus(y, link.column(2).scale(z)))
}
