//! The offsets, base and tool with which the tip itself comes nearest.

use nalgebra::{Vector3, Vector6};

use super::fit::{Normal, OffsetState, wrapped};
use super::prediction::Predictions;
use super::{End, Explanation, OffsetOptions, explain, into_screws};
use crate::error::Result;
use crate::lie::{Pose, Twist, hat};
use crate::linalg;
use crate::robot::{JointKind, Robot};

/// Configurations that are fitted, of those in which what remains is stated: more change nothing that is seen.
const FITTED: usize = 5000;
/// Most steps; five do where the robots differ by degrees.
const STEPS: usize = 30;

/// The offsets, base motion and tip motion with which the tip of `nominal` comes nearest to that of `actual`: least squares of its positions
/// in random configurations, theory.md §8 (38d), from the result of [`explain`] with both ends free. It is what a controller gains that takes
/// offsets, a base and a tool, and nothing else. `configurations` are those in which what remains is stated.
///
/// # Errors
/// As [`explain`].
pub fn nearest_at_tip(
    nominal: &Robot,
    actual: &Robot,
    configurations: usize,
    seed: u64,
) -> Result<Explanation> {
    let options = OffsetOptions { base: End::Free, tip: End::Free, configurations, seed };
    let mut found = explain(nominal, actual, &options)?;
    let (nominal, actual) = (&nominal.without_offsets(), &actual.without_offsets());
    let fit = TipFit {
        nominal,
        predictions: Predictions::new(nominal, actual, &options),
        length_m: nominal.arm_m() / 3.0,
    };
    let start = OffsetState { offsets: found.offsets.clone(), base: found.base_motion };
    let state = fit.descend((start, found.tip_motion.translation))?.0;
    let (tip_motion, with_offsets) =
        fit.predictions.compare(&into_screws(nominal, &state.offsets)?, &state.base);
    // Where nothing decides, the screws have.
    if with_offsets.rms_m < found.with_offsets.rms_m {
        (found.offsets, found.base_motion) = (state.offsets, state.base);
        (found.tip_motion, found.with_offsets) = (tip_motion, with_offsets);
    }
    Ok(found)
}

/// Offsets and base motion, and the tip's shift.
type State = (OffsetState, Vector3<f64>);

struct TipFit<'a> {
    nominal: &'a Robot,
    predictions: Predictions,
    /// Metres that a radian counts.
    length_m: f64,
}

impl TipFit<'_> {
    /// Gauss-Newton, with steps halved while they do not descend.
    fn descend(&self, start: State) -> Result<State> {
        let mut state = start;
        let mut normal = self.normal(&state)?;
        for _ in 0..STEPS {
            let step = normal.step(0.0);
            let mut share = 1.0;
            let next = loop {
                let candidate = self.retract(&state, &step, share);
                let next = self.normal(&candidate)?;
                if next.cost < normal.cost {
                    break Some((candidate, next));
                }
                share *= 0.5;
                if share < 1e-3 {
                    break None;
                }
            };
            let Some((candidate, next)) = next else { break };
            let gained = normal.cost - next.cost;
            (state, normal) = (candidate, next);
            if gained < 1e-12 * normal.cost {
                break;
            }
        }
        Ok(state)
    }

    fn scales(&self) -> Vec<f64> {
        let joint = |kind| match kind {
            JointKind::Revolute => self.length_m,
            JointKind::Prismatic => 1.0,
        };
        let joints = self.nominal.joints.iter().map(|it| joint(it.kind));
        joints.chain([1.0; 3]).chain([self.length_m; 3]).chain([1.0; 3]).collect()
    }

    fn retract(&self, (state, tip): &State, step: &[f64], share: f64) -> State {
        let units: Vec<f64> =
            step.iter().zip(self.scales()).map(|(step, scale)| share * step / scale).collect();
        let (offsets, rest) = units.split_at(state.offsets.len());
        let (base, shift) = rest.split_at(6);
        let moved = state.offsets.iter().zip(offsets).zip(&self.nominal.joints);
        let offsets = moved.map(|((offset, step), joint)| match joint.kind {
            JointKind::Revolute => wrapped(offset + step),
            JointKind::Prismatic => offset + step,
        });
        let twist = Twist::from_vector(&Vector6::from_column_slice(base));
        let base = (Pose::exp(&twist) * state.base).orthonormalized();
        (OffsetState { offsets: offsets.collect(), base }, tip + Vector3::from_column_slice(shift))
    }

    /// Normal equations of the tip's positions.
    fn normal(&self, (state, tip): &State) -> Result<Normal> {
        let robot = into_screws(self.nominal, &state.offsets)?;
        let scales = self.scales();
        let n = scales.len();
        let (mut rows, mut residuals) = (Vec::new(), Vec::new());
        for (readings, actual) in self.predictions.pairs().take(FITTED) {
            let mut motion = state.base;
            let mut twists = Vec::with_capacity(robot.joints.len());
            for (joint, value) in robot.joints.iter().zip(robot.joint_values(readings)) {
                let screw = joint.screw.transformed(&motion);
                motion = screw.exp(value) * motion;
                twists.push(screw.twist());
            }
            let pose = motion * robot.home;
            let place = pose.act(tip);
            let residual = place - actual.translation;
            // The tip's motion by that of a joint, of the base, and of the tip in its own frame.
            let mut columns: Vec<Vector3<f64>> = twists.iter().map(|it| it.v + it.w.cross(&place)).collect();
            columns.extend([Vector3::x(), Vector3::y(), Vector3::z()]);
            columns.extend((-hat(&place)).column_iter().map(|column| column.into_owned()));
            columns.extend(pose.rotation.column_iter().map(|column| column.into_owned()));
            for (coordinate, value) in residual.iter().enumerate() {
                rows.extend(columns.iter().zip(&scales).map(|(column, scale)| column[coordinate] / scale));
                residuals.push(*value);
            }
        }
        let (mut gram, mut gradient) = (vec![0.0; n * n], vec![0.0; n]);
        linalg::add_gram(&mut gram, n, &rows, 0);
        linalg::add_gradient(&mut gradient, &rows, &residuals);
        Ok(Normal::new(&gram, gradient, &residuals))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::elbow;

    #[test]
    fn the_tip_comes_nearer_than_by_offsets_that_explain_the_screws() {
        let mut actual = elbow();
        let tilt = Pose::from_xyz_rpy([0.0, 0.001, 0.0], [0.01, 0.0, 0.0]);
        actual.joints[2].screw = actual.joints[2].screw.transformed(&tilt);
        let nearest = nearest_at_tip(&elbow(), &actual, 1000, 1).unwrap();
        let free = OffsetOptions { base: End::Free, tip: End::Free, ..OffsetOptions::default() };
        let explained = explain(&elbow(), &actual, &free).unwrap();
        assert!(nearest.with_offsets.rms_m < explained.with_offsets.rms_m);
    }
}
