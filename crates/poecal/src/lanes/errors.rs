//! Errors of several rows: measured minus predicted.

use super::frame::Frame;
use super::turn::Turn;
use super::vector::{Vector, Vectors, WIDTH, Wide};

/// Frames of several rows: columns of rotations, and origins.
pub(crate) type Frames = [[Wide; 3]; 4];

/// Writes position errors and, if any row is `framed`, rotation errors `log(Y Rᵀ)` (theory.md §4 (16)), from the last links as
/// [`last_links`](super::last_links) writes them, the targets in the last link, and the measured targets.
#[inline(always)]
pub(super) fn errors<V: Vector>(
    links: &[[Wide; 4]; 3],
    [x, y, z, place]: &Frames,
    [own_x, own_y, own_z, own_place]: &Frames,
    framed: bool,
    out: &mut [[Wide; 3]; 2],
) {
    for part in 0..WIDTH / V::LANES {
        let mut link = Frame([[V::splat(0.0); 4]; 3]);
        for (row, wide) in link.0.iter_mut().zip(links) {
            for (number, wide) in row.iter_mut().zip(wide) {
                *number = V::load(wide, part);
            }
        }
        let predicted = moved(&link, place, part) + link.origin();
        (Vectors::load(own_place, part) - predicted).store(&mut out[0], part);
        if framed {
            let own = [Vectors::load(own_x, part), Vectors::load(own_y, part), Vectors::load(own_z, part)];
            let predicted = [moved(&link, x, part), moved(&link, y, part), moved(&link, z, part)];
            Turn::new(&own, &predicted).r.store(&mut out[1], part);
        }
    }
}

/// A vector of the last link in the device's axes.
#[inline(always)]
fn moved<V: Vector>(link: &Frame<V>, vector: &[Wide; 3], part: usize) -> Vectors<V> {
    let [x, y, z] = Vectors::load(vector, part).0;
    link.column(0).times_plus(x, link.column(1).times_plus(y, link.column(2).scale(z)))
}
