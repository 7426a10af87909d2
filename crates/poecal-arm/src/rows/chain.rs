//! Tips, and how they move, of several configurations side by side.

use super::frames::{Frames, Row, Vectors, add_times, cosines_and_sines, cross};
use super::weights::{self, Bodies};
use crate::arm::Arm;
use crate::placed::MOST_JOINTS;
use crate::real::{Real, SMALL, is_plain, small};

/// What is wanted of a pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Wanted {
    /// Tips alone.
    Tips,
    /// Tips without what weights add.
    Unloaded,
    /// Tips, and how they move with each reading.
    Motions,
}

/// Several configurations of an arm, its tips there, and how these move.
#[derive(Clone, Debug)]
pub(super) struct Rows<const N: usize> {
    pub(super) q: [Row<N>; MOST_JOINTS],
    pub(super) tip: Frames<N>,
    /// Of each reading `velocity = v + w × tip` and `angular = w`, in the base.
    v: [Vectors<N>; MOST_JOINTS],
    w: [Vectors<N>; MOST_JOINTS],
    found: [[Row<N>; 2]; MOST_JOINTS],
    bodies: Bodies<N>,
}

impl<const N: usize> Rows<N> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Rows {
            q: [[0.0; N]; MOST_JOINTS],
            tip: Frames::BASE,
            v: [[[0.0; N]; 3]; MOST_JOINTS],
            w: [[[0.0; N]; 3]; MOST_JOINTS],
            found: [[[1.0; N], [0.0; N]]; MOST_JOINTS],
            bodies: [Frames::BASE; MOST_JOINTS + 1],
        }
    }

    /// How the tips' points move with a reading, and how they turn.
    #[inline(always)]
    pub(super) fn column(&self, reading: usize) -> [Vectors<N>; 2] {
        let w = self.w[reading];
        let mut moves = cross(&w, &self.tip.at);
        for (moves, v) in moves.iter_mut().zip(&self.v[reading]) {
            for l in 0..N {
                moves[l] += v[l];
            }
        }
        [moves, w]
    }

    /// Takes an arm to these configurations.
    #[inline(always)]
    pub(super) fn place(&mut self, arm: &Arm, wanted: Wanted) {
        if wanted == Wanted::Motions {
            self.v[..arm.joints()].fill([[0.0; N]; 3]);
            self.w[..arm.joints()].fill([[0.0; N]; 3]);
        }
        match arm.real() {
            Some(real) => self.place_real(real, wanted),
            None => self.place_rigid(arm, wanted),
        }
    }

    #[inline(always)]
    fn place_rigid(&mut self, arm: &Arm, wanted: Wanted) {
        let chain = arm.chain();
        let mut frame = Frames::of(&chain.start);
        for (index, link) in chain.links.iter().enumerate() {
            frame.tilt(&link.origin, link.tilt);
            if wanted == Wanted::Motions {
                self.moves(index, &motion(&frame, link.slides), &[1.0; N]);
            }
            if link.slides {
                frame.slide(&self.q[index]);
            }
            let mut angles = [link.turned; N];
            for l in 0..N {
                angles[l] += if link.slides { 0.0 } else { self.q[index][l] };
            }
            frame.turn_by(&cosines_and_sines(&angles));
        }
        frame.advance(&chain.tip);
        self.tip = frame;
    }

    #[inline(always)]
    fn place_real(&mut self, real: &Real, wanted: Wanted) {
        if real.has_functions {
            for (found, q) in self.found.iter_mut().zip(&self.q[..real.readings]) {
                *found = cosines_and_sines(q);
            }
        }
        let has_weights = wanted != Wanted::Unloaded && !real.pulls.is_empty();
        if has_weights {
            weights::place(real, &self.q, &self.found, &mut self.bodies);
        }
        let mut pulls = real.pulls.iter().filter(|_| has_weights).peekable();
        let mut frame = Frames::BASE;
        for (index, link) in real.links.iter().enumerate() {
            frame.advance(&link.frame);
            let motion = motion(&frame, link.slides);
            let mut value = [link.value.constant; N];
            for &(reading, factor) in &link.value.linear {
                for l in 0..N {
                    value[l] += factor * self.q[reading][l];
                }
                if wanted == Wanted::Motions {
                    self.moves(reading, &motion, &[factor; N]);
                }
            }
            for wave in &link.value.waves {
                let [c, s] = match wave.order {
                    1.0 if is_plain(wave) => self.found[wave.reading],
                    2.0 if is_plain(wave) => doubled(&self.found[wave.reading]),
                    order => {
                        let mut angles = self.q[wave.reading];
                        for angle in &mut angles {
                            *angle = order * (wave.factor * *angle + wave.offset);
                        }
                        cosines_and_sines(&angles)
                    }
                };
                let mut slope = [0.0; N];
                for l in 0..N {
                    value[l] += wave.cosine * c[l] + wave.sine * s[l];
                    slope[l] = wave.order * wave.factor * (wave.sine * c[l] - wave.cosine * s[l]);
                }
                if wanted == Wanted::Motions {
                    self.moves(wave.reading, &motion, &slope);
                }
            }
            if let Some((_, pull)) = pulls.next_if(|(of, _)| *of == index) {
                let given = pull.values(real, &self.bodies);
                for l in 0..N {
                    value[l] += given[l];
                }
                if wanted == Wanted::Motions {
                    let (v, w) = (&mut self.v, &mut self.w);
                    pull.slopes(
                        real,
                        &self.bodies,
                        #[inline(always)]
                        |reading, slope| {
                            add_times(&mut v[reading], &motion[0], slope);
                            add_times(&mut w[reading], &motion[1], slope);
                        },
                    );
                }
            }
            if link.slides {
                frame.slide(&value);
            } else {
                frame.turn_by(&cosines_and_sines_of(&value));
            }
        }
        frame.advance(&real.tip);
        self.tip = frame;
    }

    /// Adds a joint's motion to that of a reading.
    #[inline(always)]
    fn moves(&mut self, reading: usize, [v, w]: &[Vectors<N>; 2], slope: &Row<N>) {
        add_times(&mut self.v[reading], v, slope);
        add_times(&mut self.w[reading], w, slope);
    }
}

/// Motion of a joint along or about z of its frame.
#[inline(always)]
fn motion<const N: usize>(frame: &Frames<N>, slides: bool) -> [Vectors<N>; 2] {
    if slides { [frame.z, [[0.0; N]; 3]] } else { [cross(&frame.at, &frame.z), frame.z] }
}

/// Cosines and sines of twice the angles.
#[inline(always)]
fn doubled<const N: usize>([c, s]: &[Row<N>; 2]) -> [Row<N>; 2] {
    let mut out = [[0.0; N]; 2];
    for l in 0..N {
        out[0][l] = c[l] * c[l] - s[l] * s[l];
        out[1][l] = 2.0 * c[l] * s[l];
    }
    out
}

/// Cosines and sines, of small angles by fewer terms, as of one configuration alone.
#[inline(always)]
fn cosines_and_sines_of<const N: usize>(angles: &Row<N>) -> [Row<N>; 2] {
    let mut out = [[0.0; N]; 2];
    for l in 0..N {
        (out[0][l], out[1][l]) = small(angles[l]);
    }
    if angles.iter().any(|it| it.abs() >= SMALL) {
        let whole = cosines_and_sines(angles);
        for l in 0..N {
            let is_small = angles[l].abs() < SMALL;
            for k in 0..2 {
                out[k][l] = if is_small { out[k][l] } else { whole[k][l] };
            }
        }
    }
    out
}
