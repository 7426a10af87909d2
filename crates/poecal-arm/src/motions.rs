//! Motions of an arm to first order, with the point of its tip at rest or moving.

use nalgebra::{Matrix3, Vector3};

use crate::arm_state::{ArmState, MOST_JOINTS};
use crate::newton::TipResidual;

// The functions of numbers, where there is no standard library.
#[allow(unused_imports)]
use nalgebra::{ComplexField as _, RealField as _};

/// Motions of an arm to first order: with the tip's point at rest, and moving.
pub(crate) struct FirstOrderMotions {
    n: usize,
    /// Motions of the point, over the reach, and rotations.
    columns: [(Vector3<f64>, Vector3<f64>); MOST_JOINTS],
    /// (Jₚ Jₚᵀ)⁻¹.
    inverse: Option<Matrix3<f64>>,
}

impl FirstOrderMotions {
    pub(crate) fn from_placement(placed: &ArmState<MOST_JOINTS>, n: usize, scale: impl Fn(usize) -> f64) -> Self {
        let columns = core::array::from_fn(|joint| {
            let (v, w) = placed.column(joint);
            if joint < n { (v * scale(joint), w) } else { (Vector3::zeros(), Vector3::zeros()) }
        });
        let mut ways = FirstOrderMotions { n, columns, inverse: None };
        ways.invert();
        ways
    }

    /// Computes (Jₚ Jₚᵀ)⁻¹ of the columns.
    fn invert(&mut self) {
        let mut moves = Matrix3::zeros();
        for (v, _) in &self.columns[..self.n] {
            moves += v * v.transpose();
        }
        self.inverse = moves.try_inverse().filter(|it| it.iter().all(|it| it.is_finite()));
    }

    /// Least motion of the free joints that moves the point.
    pub(crate) fn to_point(&self, by: &Vector3<f64>) -> Option<[f64; MOST_JOINTS]> {
        let pull = self.inverse? * by;
        Some(core::array::from_fn(|joint| self.columns[joint].0.dot(&pull)))
    }

    /// Holds a joint.
    fn hold(&mut self, joint: usize) {
        self.columns[joint] = (Vector3::zeros(), Vector3::zeros());
        self.invert();
    }

    /// Changes from the zeros that remove the remainder, from the present changes. The other joints take over from a joint at its limit, up
    /// to their own limits.
    pub(crate) fn least_correction(
        mut self,
        left: &TipResidual,
        inverse_reach: f64,
        from: &[f64],
        most: &[f64],
    ) -> Option<[f64; MOST_JOINTS]> {
        let n = self.n;
        let (mut point, mut turn) = (left.position * inverse_reach, left.rotation);
        for ((v, w), from) in self.columns.iter().zip(from) {
            point += v * *from;
            turn += w * *from;
        }
        let (held, mut to) = self.move_point(point, &mut turn, most)?;
        for ((_, w), to) in self.columns[..n].iter().zip(&to) {
            turn -= w * *to;
        }
        let (turns, gram) = self.turns_at_rest()?;
        let eigen = gram.symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_unstable_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        for at in order {
            let direction = eigen.eigenvectors.column(at).into_owned();
            let size = eigen.eigenvalues[at].max(0.0).sqrt();
            let wanted = turn.dot(&direction);
            if size < 1e-9 {
                continue;
            }
            let way: [f64; MOST_JOINTS] = core::array::from_fn(|joint| turns[joint].dot(&direction) / size);
            let mut room = f64::INFINITY;
            for joint in 0..n {
                if way[joint].abs() > 1e-12 {
                    room = room.min((most[joint] - to[joint].abs()).max(0.0) / way[joint].abs());
                }
            }
            let exact = wanted / size;
            let along = if exact.abs() <= room {
                exact
            } else {
                // The step is continuous at the limit of reach, and 0 at the singularity.
                let share = room / exact.abs();
                room * exact.signum() * 2.0 * share / (1.0 + share * share)
            };
            to.iter_mut().zip(way).for_each(|(to, way)| *to += along * way);
        }
        to.iter_mut().zip(held).for_each(|(to, held)| *to += held);
        Some(to)
    }

    /// Holds joints that would have to move too far at their limits. Returns the values of these, and the motion of the others that moves
    /// the point to its goal.
    #[inline]
    fn move_point(
        &mut self,
        mut point: Vector3<f64>,
        turn: &mut Vector3<f64>,
        most: &[f64],
    ) -> Option<([f64; MOST_JOINTS], [f64; MOST_JOINTS])> {
        let n = self.n;
        let mut held = [0.0; MOST_JOINTS];
        let mut to = self.to_point(&point)?;
        for _ in 3..n {
            let over = |joint: &usize| to[*joint].abs() / most[*joint];
            let worst = (0..n).max_by(|a, b| over(a).total_cmp(&over(b)))?;
            if over(&worst) <= 1.0 {
                break;
            }
            held[worst] = most[worst] * to[worst].signum();
            let (v, w) = self.columns[worst];
            point -= v * held[worst];
            *turn -= w * held[worst];
            self.hold(worst);
            to = self.to_point(&point)?;
        }
        Some((held, to))
    }

    /// Rotations with the point at rest: for each joint the remainder of its rotation after the others have moved the point back; and their
    /// sum of squares.
    #[inline]
    fn turns_at_rest(&self) -> Option<([Vector3<f64>; MOST_JOINTS], Matrix3<f64>)> {
        let n = self.n;
        let inverse = self.inverse?;
        let mut across = Matrix3::zeros();
        for (v, w) in &self.columns[..n] {
            across += w * v.transpose();
        }
        let back = across * inverse;
        let mut turns = [Vector3::zeros(); MOST_JOINTS];
        let mut gram = Matrix3::zeros();
        for ((v, w), turn) in self.columns[..n].iter().zip(&mut turns) {
            *turn = w - back * v;
            gram += *turn * turn.transpose();
        }
        Some((turns, gram))
    }
}
