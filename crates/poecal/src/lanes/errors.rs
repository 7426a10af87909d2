//! What was measured less what is predicted, of several rows.

use super::frame::Frame;
use super::turn::Turn;
use super::vector::{Vector, Vectors, WIDTH, Wide};

/// Frames of several rows: columns of rotations, and origins.
pub(crate) type Frames = [[Wide; 3]; 4];

/// Writes position errors and, if any row is `framed`, rotation errors `log(Y Rᵀ)`: of the measured targets, and of those predicted at the
/// `ends` of the last links (these as [`last_links`](super::last_links) writes them).
#[inline(always)]
pub(super) fn errors<V: Vector>(
    links: &[[Wide; 4]; 3],
    ends: &Frames,
    measured: &Frames,
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
        let moved = |end: &[Wide; 3], from: Vectors<V>| {
            let [x, y, z] = Vectors::load(end, part).0;
            link.column(0).times_plus(x, link.column(1).times_plus(y, link.column(2).times_plus(z, from)))
        };
        let nowhere = Vectors([V::splat(0.0); 3]);
        let [own @ .., place] = measured;
        (Vectors::load(place, part) - moved(&ends[3], link.origin())).store(&mut out[0], part);
        if framed {
            let own =
                [Vectors::load(&own[0], part), Vectors::load(&own[1], part), Vectors::load(&own[2], part)];
            let predicted = [moved(&ends[0], nowhere), moved(&ends[1], nowhere), moved(&ends[2], nowhere)];
            Turn::new(&own, &predicted).r.store(&mut out[1], part);
        }
    }
}
