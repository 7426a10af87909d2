//! Rotation of a joint under weights in several configurations, and its derivatives.

use super::frames::{FrameBatch, NumberBatch, VectorBatch, add_times, cross, dot};
use crate::arm_state::MOST_JOINTS;
use crate::real_chain::{Moment, RealChain};

/// Bodies of the nominal arm, from the base on.
pub(super) type NominalBodies<const N: usize> = [FrameBatch<N>; MOST_JOINTS + 1];

/// A vector that is the same in all configurations.
#[inline(always)]
fn broadcast<const N: usize>(of: &nalgebra::Vector3<f64>) -> VectorBatch<N> {
    [[of.x; N], [of.y; N], [of.z; N]]
}

/// Moves the bodies of a nominal arm to readings, whose cosines and sines are known.
#[inline(always)]
pub(super) fn place<const N: usize>(
    real: &RealChain,
    q: &[NumberBatch<N>],
    found: &[[NumberBatch<N>; 2]],
    bodies: &mut NominalBodies<N>,
) {
    let mut body = FrameBatch::BASE;
    bodies[0] = body;
    for ((frame, drawn), out) in real.drawing.iter().zip(&mut bodies[1..]) {
        body.advance(frame);
        let mut value = [0.0; N];
        for l in 0..N {
            value[l] = drawn.factor * q[drawn.reading][l] + drawn.constant;
        }
        if drawn.screw.is_prismatic() {
            body.slide(&value);
        } else if drawn.factor == 1.0 && drawn.constant == 0.0 {
            body.turn_by(&found[drawn.reading]);
        } else {
            body.turn_by(&super::frames::cosines_and_sines(&value));
        }
        *out = body;
    }
}

impl Moment {
    /// Sum of its weights, its axis, its origin, and the sum of weights times positions less that of the origin.
    #[inline(always)]
    fn parts<const N: usize>(
        &self,
        bodies: &NominalBodies<N>,
    ) -> (f64, VectorBatch<N>, VectorBatch<N>, VectorBatch<N>) {
        let size: f64 = self.weights.iter().map(|(_, size, _)| size).sum();
        let body = &bodies[self.after];
        let axis = body.act(self.direction.into(), 0.0);
        let origin = body.act(self.place.into(), 1.0);
        let mut sum = origin;
        for l in 0..N {
            for it in &mut sum {
                it[l] *= -size;
            }
        }
        for (after, size, place) in &self.weights {
            add_times(&mut sum, &bodies[*after].act((*place).into(), *size), &[1.0; N]);
        }
        (size, axis, origin, sum)
    }

    /// Value of the joint by its weights.
    #[inline(always)]
    pub(super) fn values<const N: usize>(&self, real: &RealChain, bodies: &NominalBodies<N>) -> NumberBatch<N> {
        let gravity = broadcast(&real.gravity);
        let (size, axis, _, sum) = self.parts(bodies);
        if self.slides {
            let mut out = dot(&axis, &gravity);
            for it in &mut out {
                *it *= size;
            }
            return out;
        }
        dot(&axis, &cross(&sum, &gravity))
    }

    /// Reports the derivative of the value by each reading.
    ///
    /// With the sum S of sizes times positions less that of the origin o, the moment is `m = z · (S × g)`. By a rotation about `a` through `p`, a
    /// joint of the nominal arm changes S by `a × (S' − s' p)`. Here S' and s' are sums over the weights that it carries. It changes z by `a × z`
    /// if it carries the axis.
    #[inline(always)]
    pub(super) fn slopes<const N: usize>(
        &self,
        real: &RealChain,
        bodies: &NominalBodies<N>,
        mut tell: impl FnMut(usize, &NumberBatch<N>),
    ) {
        let gravity = broadcast(&real.gravity);
        let (size, axis, origin, sum) = self.parts(bodies);
        let none = [[0.0; N]; 3];
        // m changes by its product with a change of S, and by that of this with the direction of a rotation of the axis.
        let by_sum = if self.slides { none } else { cross(&gravity, &axis) };
        let mut along = none;
        if self.slides {
            add_times(&mut along, &gravity, &[size; N]);
        } else {
            along = cross(&sum, &gravity);
        }
        let by_turn = cross(&axis, &along);
        // These are the sum of sizes, and of sizes times positions, of the weights that a joint carries.
        let (mut carried, mut moment) = (0.0, none);
        for (index, (_, drawn)) in real.drawing.iter().enumerate().rev() {
            for (_, size, place) in self.weights.iter().filter(|it| it.0 == index + 1) {
                carried += size;
                add_times(&mut moment, &bodies[index + 1].act((*place).into(), *size), &[1.0; N]);
            }
            if index + 1 == self.after {
                // The origin moves with the axis.
                carried -= size;
                add_times(&mut moment, &origin, &[-size; N]);
            }
            let body = &bodies[index + 1];
            let carries_axis = index < self.after;
            let mut slope = [0.0; N];
            if drawn.screw.is_prismatic() {
                let changes = dot(&body.z, &by_sum);
                for l in 0..N {
                    slope[l] = drawn.factor * carried * changes[l];
                }
            } else {
                let mut of = moment;
                add_times(&mut of, &body.at, &[-carried; N]);
                let changes = dot(&cross(&body.z, &of), &by_sum);
                let turns = if carries_axis { dot(&body.z, &by_turn) } else { [0.0; N] };
                for l in 0..N {
                    slope[l] = drawn.factor * (changes[l] + turns[l]);
                }
            }
            tell(drawn.reading, &slope);
        }
    }
}
