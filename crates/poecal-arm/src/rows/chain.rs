//! Tips, and their motions, of several configurations side by side.

use nalgebra::Vector3;

use super::frames::{FrameBatch, NumberBatch, VectorBatch, add_times, cosines_and_sines, cross};
use super::weights::{self, NominalBodies};
use crate::arm_state::{ArmState, MOST_JOINTS};
use crate::chain::LinkChain;
use crate::model::Wave;
use crate::real_chain::{Moment, ReadingSum, RealChain, SMALL, is_plain, small_turn};
use crate::terms::Term;

/// Output of a pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum PassOutputs {
    /// Tips alone.
    Tips,
    /// Tips without the deflection under weights.
    Unloaded,
    /// Tips, and their motions with each reading.
    Motions,
    /// The same without the part of compliance under weights in the motions: enough for steps to a configuration.
    Steps,
}

/// Several configurations of an arm of up to `J` readings, its tips there, and their motions.
#[derive(Clone, Debug)]
pub(crate) struct ConfigurationBatch<const N: usize, const J: usize> {
    pub(crate) q: [NumberBatch<N>; J],
    pub(super) tip: FrameBatch<N>,
    /// For each reading `velocity = v + w × tip` and `angular = w`, in the base.
    v: [VectorBatch<N>; J],
    w: [VectorBatch<N>; J],
    found: [[NumberBatch<N>; 2]; J],
    bodies: NominalBodies<N>,
}

impl<const J: usize> ConfigurationBatch<1, J> {
    /// One configuration.
    #[inline(always)]
    pub(crate) fn from_readings(q: &[f64; J]) -> Self {
        let mut rows = ConfigurationBatch::new();
        rows.q.iter_mut().zip(q).for_each(|(to, from)| to[0] = *from);
        rows
    }

    /// The tip and its motions, after `place` has moved the arm.
    #[inline(always)]
    pub(crate) fn place_with(mut self, place: impl FnOnce(&mut Self)) -> ArmState<J> {
        place(&mut self);
        let vector = |of: &VectorBatch<1>| Vector3::new(of[0][0], of[1][0], of[2][0]);
        ArmState { v: self.v.each_ref().map(vector), w: self.w.each_ref().map(vector), tip: self.tip.pose(0) }
    }
}

impl<const N: usize, const J: usize> ConfigurationBatch<N, J> {
    #[inline(always)]
    pub(crate) fn new() -> Self {
        ConfigurationBatch {
            q: [[0.0; N]; J],
            tip: FrameBatch::BASE,
            v: [[[0.0; N]; 3]; J],
            w: [[[0.0; N]; 3]; J],
            found: [[[1.0; N], [0.0; N]]; J],
            bodies: [FrameBatch::BASE; MOST_JOINTS + 1],
        }
    }

    /// Motions of the tips' points with a reading, and their rotations.
    #[inline(always)]
    pub(super) fn column(&self, reading: usize) -> [VectorBatch<N>; 2] {
        let w = self.w[reading];
        let mut moves = cross(&w, &self.tip.at);
        for (moves, v) in moves.iter_mut().zip(&self.v[reading]) {
            for l in 0..N {
                moves[l] += v[l];
            }
        }
        [moves, w]
    }

    /// Moves an arm to these configurations: a chain of screws, or one whose joint values are more than their readings.
    #[inline(always)]
    pub(super) fn place(&mut self, (chain, real): (&LinkChain, Option<&RealChain>), wanted: PassOutputs) {
        if wanted == PassOutputs::Motions {
            self.v[..chain.len()].fill([[0.0; N]; 3]);
            self.w[..chain.len()].fill([[0.0; N]; 3]);
        }
        match real {
            Some(real) => self.place_real(real, wanted),
            None => self.place_rigid(chain, wanted),
        }
    }

    #[inline(always)]
    pub(crate) fn place_rigid(&mut self, chain: &LinkChain, wanted: PassOutputs) {
        // For one configuration, vector instructions compute those of all joints, as many as there may be.
        let count = if N == 1 { J } else { chain.len() };
        let mut angles = self.q;
        for (angle, link) in angles.iter_mut().zip(&chain.links) {
            for it in angle {
                *it = link.turned + if link.slides { 0.0 } else { *it };
            }
        }
        for (found, angle) in self.found.iter_mut().zip(&angles).take(count) {
            *found = cosines_and_sines(angle);
        }
        let mut frame = FrameBatch::from_pose(&chain.start);
        for (index, link) in chain.links.iter().enumerate().take(J) {
            frame.tilt(&link.origin, link.tilt);
            if matches!(wanted, PassOutputs::Motions | PassOutputs::Steps) {
                [self.v[index], self.w[index]] = motion(&frame, link.slides);
            }
            if link.slides {
                frame.slide(&self.q[index]);
            }
            frame.turn_by(&self.found[index]);
        }
        frame.advance(&chain.tip);
        self.tip = frame;
    }

    #[inline(always)]
    pub(crate) fn place_real(&mut self, real: &RealChain, wanted: PassOutputs) {
        if real.has_functions {
            for (found, q) in self.found.iter_mut().zip(&self.q[..real.readings]) {
                *found = cosines_and_sines(q);
            }
        }
        if wanted != PassOutputs::Unloaded && real.has_moments {
            weights::place(real, &self.q, &self.found, &mut self.bodies);
        }
        let moves = matches!(wanted, PassOutputs::Motions | PassOutputs::Steps);
        let mut frame = FrameBatch::BASE;
        for link in &real.links {
            frame.advance(&link.frame);
            let motion = motion(&frame, link.slides);
            let mut value = [link.own.constant; N];
            self.add_linear(&link.own, &mut value);
            if moves {
                self.linear_moves(&link.own, &motion, &[1.0; N]);
            }
            for wave in &link.waves {
                let slope = self.add_wave(wave, &mut value);
                if moves {
                    self.moves(wave.reading, &motion, &slope);
                }
            }
            if let Some(moment) = link.own.moment.as_ref().filter(|_| wanted != PassOutputs::Unloaded) {
                add(&mut value, &moment.values(real, &self.bodies));
                if wanted == PassOutputs::Motions {
                    self.moment_moves(moment, real, &motion, &[1.0; N]);
                }
            }
            for (term, coefficient, of) in &link.curves {
                let slope = self.add_curve((*term, *coefficient, of), real, wanted, &mut value);
                if moves {
                    self.linear_moves(of, &motion, &slope);
                    of.moment.iter().for_each(|it| self.moment_moves(it, real, &motion, &slope));
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

    #[inline(always)]
    fn add_linear(&self, of: &ReadingSum, value: &mut NumberBatch<N>) {
        for &(reading, factor) in &of.linear {
            for l in 0..N {
                value[l] += factor * self.q[reading][l];
            }
        }
    }

    /// Adds a wave; returns its derivative by its reading.
    #[inline(always)]
    fn add_wave(&self, wave: &Wave, value: &mut NumberBatch<N>) -> NumberBatch<N> {
        let [c, s] = match wave.order {
            1.0 if is_plain(wave) => self.found[wave.reading],
            2.0 if is_plain(wave) => double_angles(&self.found[wave.reading]),
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
        slope
    }

    /// Adds another function of a sum; returns its derivative by that sum.
    #[inline(always)]
    fn add_curve(
        &self,
        (term, coefficient, of): (Term, f64, &ReadingSum),
        real: &RealChain,
        wanted: PassOutputs,
        value: &mut NumberBatch<N>,
    ) -> NumberBatch<N> {
        let mut x = [of.constant; N];
        self.add_linear(of, &mut x);
        if let Some(moment) = of.moment.as_ref().filter(|_| wanted != PassOutputs::Unloaded) {
            add(&mut x, &moment.values(real, &self.bodies));
        }
        let mut slope = [0.0; N];
        for l in 0..N {
            let [found, derivative] = term.function(x[l]);
            value[l] += coefficient * found;
            slope[l] = coefficient * derivative;
        }
        slope
    }

    /// Adds a joint's motion with the linear parts of a sum, by a share, to that of their readings.
    #[inline(always)]
    fn linear_moves(&mut self, of: &ReadingSum, motion: &[VectorBatch<N>; 2], share: &NumberBatch<N>) {
        for &(reading, factor) in &of.linear {
            let mut slope = *share;
            for it in &mut slope {
                *it *= factor;
            }
            self.moves(reading, motion, &slope);
        }
    }

    /// The same addition with a moment.
    #[inline(always)]
    fn moment_moves(&mut self, of: &Moment, real: &RealChain, motion: &[VectorBatch<N>; 2], share: &NumberBatch<N>) {
        let (v, w) = (&mut self.v, &mut self.w);
        of.slopes(
            real,
            &self.bodies,
            #[inline(always)]
            |reading, slope| {
                let mut slope = *slope;
                for l in 0..N {
                    slope[l] *= share[l];
                }
                add_times(&mut v[reading], &motion[0], &slope);
                add_times(&mut w[reading], &motion[1], &slope);
            },
        );
    }

    /// Adds a joint's motion to that of a reading.
    #[inline(always)]
    fn moves(&mut self, reading: usize, [v, w]: &[VectorBatch<N>; 2], slope: &NumberBatch<N>) {
        add_times(&mut self.v[reading], v, slope);
        add_times(&mut self.w[reading], w, slope);
    }
}

/// Adds numbers to others.
#[inline(always)]
fn add<const N: usize>(to: &mut NumberBatch<N>, of: &NumberBatch<N>) {
    for l in 0..N {
        to[l] += of[l];
    }
}

/// Motion of a joint along or about z of its frame.
#[inline(always)]
fn motion<const N: usize>(frame: &FrameBatch<N>, slides: bool) -> [VectorBatch<N>; 2] {
    if slides { [frame.z, [[0.0; N]; 3]] } else { [cross(&frame.at, &frame.z), frame.z] }
}

/// Cosines and sines of twice the angles.
#[inline(always)]
fn double_angles<const N: usize>([c, s]: &[NumberBatch<N>; 2]) -> [NumberBatch<N>; 2] {
    let mut out = [[0.0; N]; 2];
    for l in 0..N {
        out[0][l] = c[l] * c[l] - s[l] * s[l];
        out[1][l] = 2.0 * c[l] * s[l];
    }
    out
}

/// Cosines and sines; of small angles by fewer terms, as for one configuration alone.
#[inline(always)]
fn cosines_and_sines_of<const N: usize>(angles: &NumberBatch<N>) -> [NumberBatch<N>; 2] {
    let mut out = [[0.0; N]; 2];
    for l in 0..N {
        (out[0][l], out[1][l]) = small_turn(angles[l]);
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
