//! Base and tool of the nominal robot, as if they were taught on the actual one.

use nalgebra::{Vector3, Vector6};

use crate::robot::Robot;
use poecal_arm::lie::{Pose, Twist, by_twist, hat};
use poecal_numerics::linalg::combination;

/// Number of steps of the fit: the motions are small.
const STEPS: usize = 2;

/// Motions of a nominal robot's base and tool that take its tips `N` nearest to the actual robot's `A`: `B N T ≈ A`.
pub struct TaughtFrames {
    /// `B`, the motion of the base.
    pub base: Pose,
    /// `T`, the motion of the tool.
    pub tool: Pose,
}

impl TaughtFrames {
    /// Least squares of `log((B N T)⁻¹ A)` over pairs of tips; `radian_m` metres count as a radian. A known base is held.
    pub fn from_tips(tips: &[(Pose, Pose)], radian_m: f64, base_is_known: bool) -> Self {
        TaughtFrames::with_points(tips, &[], radian_m, base_is_known)
    }

    /// The same with pairs of points `n`, `a` that the tool does not move, `B n ≈ a`.
    pub fn with_points(
        tips: &[(Pose, Pose)],
        points: &[(Vector3<f64>, Vector3<f64>)],
        radian_m: f64,
        base_is_known: bool,
    ) -> Self {
        let mut taught = TaughtFrames { base: Pose::identity(), tool: Pose::identity() };
        let weights = Vector6::from_fn(|k, _| if k < 3 { 1.0 } else { radian_m });
        let motions = if base_is_known { 6 } else { 12 };
        for _ in 0..STEPS {
            let numbers = 6 * tips.len() + 3 * points.len();
            let mut columns = vec![Vec::with_capacity(numbers); motions];
            let mut opposite = Vec::with_capacity(numbers);
            for (nominal, actual) in tips {
                let at = taught.tip(nominal).inverse();
                let left = (at * *actual).log().to_vector().component_mul(&weights);
                opposite.extend(left.iter().map(|it| -it));
                let by_base = at.adjoint();
                for (motion, column) in columns.iter_mut().enumerate() {
                    match motion.checked_sub(6) {
                        // A motion of the tool is one in the tip's own axes.
                        None => column.extend((0..6).map(|k| if k == motion { weights[k] } else { 0.0 })),
                        Some(motion) => column.extend((0..6).map(|k| weights[k] * by_base[(k, motion)])),
                    }
                }
            }
            for (nominal, actual) in points {
                let at = taught.base.act(nominal);
                opposite.extend((at - actual).iter());
                let by_base = by_twist(&at);
                for (motion, column) in columns.iter_mut().enumerate() {
                    match motion.checked_sub(6) {
                        None => column.extend([0.0; 3]),
                        Some(motion) => column.extend(by_base.column(motion).iter()),
                    }
                }
            }
            let Some(step) = combination(&columns, &opposite) else { break };
            let motion = |from: usize| {
                let part = Vector6::from_fn(|k, _| step.get(from + k).copied().unwrap_or(0.0));
                Pose::exp(&Twist::from_vector(&part))
            };
            taught.tool = taught.tool * motion(0);
            taught.base = motion(6) * taught.base;
        }
        taught
    }

    /// The same fit by the positions of the tips alone: least squares of their distances over base and the tool's shift.
    pub fn of_places(tips: &[(Pose, Pose)], base_is_known: bool) -> Self {
        let mut taught = TaughtFrames { base: Pose::identity(), tool: Pose::identity() };
        for _ in 0..STEPS {
            let motions = if base_is_known { 3 } else { 9 };
            let mut columns = vec![Vec::with_capacity(3 * tips.len()); motions];
            let mut opposite = Vec::with_capacity(3 * tips.len());
            for (nominal, actual) in tips {
                let at = taught.tip(nominal);
                opposite.extend((at.translation - actual.translation).iter());
                let by_turn = -hat(&at.translation);
                for (motion, column) in columns.iter_mut().enumerate() {
                    match motion {
                        0..3 => column.extend(at.rotation.column(motion).iter()),
                        3..6 => column.extend((0..3).map(|k| if k == motion - 3 { 1.0 } else { 0.0 })),
                        _ => column.extend(by_turn.column(motion - 6).iter()),
                    }
                }
            }
            let Some(step) = combination(&columns, &opposite) else { break };
            let part = |from: usize| Vector3::from_fn(|k, _| step.get(from + k).copied().unwrap_or(0.0));
            taught.tool.translation += taught.tool.rotation * part(0);
            taught.base = Pose::exp(&Twist::new(part(3), part(6))) * taught.base;
        }
        taught
    }

    /// Tip of the nominal robot with these frames.
    pub fn tip(&self, nominal: &Pose) -> Pose {
        self.base * *nominal * self.tool
    }
}

/// The nominal robot with the actual one's tool.
pub fn with_tool_of(actual: &Robot, nominal: &Robot) -> Option<Robot> {
    let last = nominal.joints.get(nominal.tip_body().joint()?)?;
    let own = actual.joints.iter().find(|joint| joint.name == last.name)?;
    Some(Robot { home: last.frame * own.frame.inverse() * actual.home, ..nominal.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_moved_base_and_tool_are_found() {
        let poses: Vec<Pose> = (0..40)
            .map(|k| {
                let k = f64::from(k);
                Pose::from_xyz_rpy([k.sin(), (1.3 * k).cos(), (0.7 * k).sin()], [k, 0.4 * k, 2.1 * k])
            })
            .collect();
        let base = Pose::from_xyz_rpy([0.01, -0.02, 0.005], [0.01, 0.02, -0.015]);
        let tool = Pose::from_xyz_rpy([0.004, 0.003, -0.01], [-0.02, 0.0, 0.03]);
        let tips: Vec<(Pose, Pose)> = poses.iter().map(|it| (*it, base * *it * tool)).collect();
        let taught = TaughtFrames::from_tips(&tips, 0.3, false);
        let worst = tips
            .iter()
            .map(|(nominal, actual)| (taught.tip(nominal).translation - actual.translation).norm())
            .fold(0.0, f64::max);
        println!("left of 20 mm and 1.5 degrees after {STEPS} steps: {worst:.1e} m");
        // The tolerance is for the third order of the motions.
        assert!(worst < 1e-6);
        let held = TaughtFrames::from_tips(&tips, 0.3, true);
        assert!((held.base.translation).norm() == 0.0);
    }
}
