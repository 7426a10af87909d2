//! What weights turn a joint in several configurations, and how that changes.

use super::frames::{Frames, Row, Vectors, add_times, cross, dot};
use crate::placed::MOST_JOINTS;
use crate::real::{Moment, Real};

/// Bodies of the drawing, from the base on.
pub(super) type Bodies<const N: usize> = [Frames<N>; MOST_JOINTS + 1];

/// A vector that is the same in all configurations.
#[inline(always)]
fn same<const N: usize>(of: &nalgebra::Vector3<f64>) -> Vectors<N> {
    [[of.x; N], [of.y; N], [of.z; N]]
}

/// Moves the bodies of a drawing to readings, whose cosines and sines are known.
#[inline(always)]
pub(super) fn place<const N: usize>(
    real: &Real,
    q: &[Row<N>; MOST_JOINTS],
    found: &[[Row<N>; 2]; MOST_JOINTS],
    bodies: &mut Bodies<N>,
) {
    let mut body = Frames::BASE;
    bodies[0] = body;
    for ((frame, drawn), out) in real.drawing.iter().zip(&mut bodies[1..]) {
        body.advance(frame);
        let value = q[drawn.reading].map(|q| drawn.factor * q + drawn.constant);
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
    /// Sum of its weights, its axis, its origin, and the sum of weights times places less that of the origin.
    #[inline(always)]
    fn parts<const N: usize>(&self, bodies: &Bodies<N>) -> (f64, Vectors<N>, Vectors<N>, Vectors<N>) {
        let size: f64 = self.weights.iter().map(|(_, size, _)| size).sum();
        let body = &bodies[self.after];
        let axis = body.act(self.direction.into(), 0.0);
        let origin = body.act(self.place.into(), 1.0);
        let mut sum = origin;
        sum.iter_mut().flatten().for_each(|it| *it *= -size);
        for (after, size, place) in &self.weights {
            add_times(&mut sum, &bodies[*after].act((*place).into(), *size), &[1.0; N]);
        }
        (size, axis, origin, sum)
    }

    /// The joint's value by its weights.
    #[inline(always)]
    pub(super) fn values<const N: usize>(&self, real: &Real, bodies: &Bodies<N>) -> Row<N> {
        let gravity = same(&real.gravity);
        let (size, axis, _, sum) = self.parts(bodies);
        if self.slides {
            return dot(&axis, &gravity).map(|it| size * it);
        }
        dot(&axis, &cross(&sum, &gravity))
    }

    /// Tells how that changes with each reading.
    #[inline(always)]
    pub(super) fn slopes<const N: usize>(
        &self,
        real: &Real,
        bodies: &Bodies<N>,
        mut tell: impl FnMut(usize, &Row<N>),
    ) {
        let gravity = same(&real.gravity);
        let (size, axis, origin, sum) = self.parts(bodies);
        // What turns with the axis: m = z · (S × g), or s z · g.
        let along =
            if self.slides { gravity.map(|it| it.map(|it| size * it)) } else { cross(&sum, &gravity) };
        // Of the weights that a joint carries, the sum, and of sizes times places.
        let (mut carried, mut moment) = (0.0, [[0.0; N]; 3]);
        for (index, (_, drawn)) in real.drawing.iter().enumerate().rev() {
            for (_, size, place) in self.weights.iter().filter(|it| it.0 == index + 1) {
                carried += size;
                add_times(&mut moment, &bodies[index + 1].act((*place).into(), *size), &[1.0; N]);
            }
            let carries_axis = index < self.after;
            if carried == 0.0 && !carries_axis {
                continue;
            }
            let body = &bodies[index + 1];
            // The origin goes with the axis.
            let (mut rest, mut of) = (carried, moment);
            if carries_axis {
                rest -= size;
                add_times(&mut of, &origin, &[-size; N]);
            }
            let mut slope = [0.0; N];
            let mut add = |more: Row<N>| slope.iter_mut().zip(more).for_each(|(it, more)| *it += more);
            let changed = if drawn.screw.is_prismatic() {
                body.z.map(|it| it.map(|it| it * rest))
            } else {
                add_times(&mut of, &body.at, &[-rest; N]);
                if carries_axis {
                    add(dot(&cross(&body.z, &axis), &along));
                }
                cross(&body.z, &of)
            };
            if !self.slides {
                add(dot(&axis, &cross(&changed, &gravity)));
            }
            tell(drawn.reading, &slope.map(|it| it * drawn.factor));
        }
    }
}
