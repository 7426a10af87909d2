//! Denavit-Hartenberg tables to screws, in the standard and in Craig's modified convention.

use nalgebra::Vector3;

use super::{Joint, JointKind, Robot};
use poecal_arm::lie::{Pose, rotation};
use poecal_numerics::error::Result;

/// Convention of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DhTableConvention {
    /// `A_i = Rz(θ_i) Tz(d_i) Tx(a_i) Rx(α_i)`: the joint turns about z of the *previous* frame.
    Standard,
    /// `A_i = Rx(α_i) Tx(a_i) Rz(θ_i) Tz(d_i)` (Craig, with α and a of the same row): the joint turns about z of its *own* frame.
    Modified,
}

/// One row of a DH table, metres and radians.
#[derive(Clone, Debug, PartialEq)]
pub struct DhRow {
    /// Joint name.
    pub name: String,
    /// Revolute: the reading adds to θ. Prismatic: the reading adds to d.
    pub kind: JointKind,
    /// Link length a, metres.
    pub a_m: f64,
    /// Link twist α, radians.
    pub alpha_rad: f64,
    /// Link offset d, metres.
    pub d_m: f64,
    /// Joint angle θ at zero reading, radians.
    pub theta_rad: f64,
    /// A pose that follows the row and never moves: the next row, or the tip, is in the frame after it.
    pub fixed: Pose,
}

impl Robot {
    /// The robot of a DH table between `base_from_first` (the frame of row 0) and `last_from_tip`.
    ///
    /// # Errors
    /// As [`Robot::new`].
    pub fn from_dh(
        name: &str,
        convention: DhTableConvention,
        rows: &[DhRow],
        base_from_first: Pose,
        last_from_tip: Pose,
    ) -> Result<Self> {
        let mut base_from_frame = base_from_first;
        let mut joints = Vec::with_capacity(rows.len());
        for row in rows {
            let along_z = Pose::new(rotation::about(2, row.theta_rad), Vector3::new(0.0, 0.0, row.d_m));
            let along_x = Pose::new(rotation::about(0, row.alpha_rad), Vector3::new(row.a_m, 0.0, 0.0));
            let base_from_joint = match convention {
                DhTableConvention::Standard => base_from_frame,
                DhTableConvention::Modified => base_from_frame * along_x,
            };
            let axis = base_from_joint.rotation.column(2).into_owned();
            let screw = row.kind.screw(&axis, &base_from_joint.translation);
            joints.push(Joint { frame: base_from_joint, ..Joint::with_screw(&row.name, row.kind, screw) });
            let base_from_row = match convention {
                DhTableConvention::Standard => base_from_joint * along_z * along_x,
                DhTableConvention::Modified => base_from_joint * along_z,
            };
            base_from_frame = if row.fixed == Pose::identity() { base_from_row } else { base_from_row * row.fixed };
        }
        Robot::new(name, joints, base_from_frame * last_from_tip)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_of_a_planar_arm_add_up() {
        let row = |(name, a_m, d_m): (&str, f64, f64)| DhRow {
            name: name.to_owned(),
            kind: JointKind::Revolute,
            a_m,
            alpha_rad: 0.0,
            d_m,
            theta_rad: 0.0,
            fixed: Pose::identity(),
        };
        let rows = [("joint1", 0.3, 0.0), ("joint2", 0.2, 0.1)].map(row);
        let (convention, none) = (DhTableConvention::Standard, Pose::identity());
        let robot = Robot::from_dh("planar", convention, &rows, none, none).unwrap();
        let tip = robot.forward_kinematics(&[0.0, 0.0]).translation;
        assert!((tip - Vector3::new(0.5, 0.0, 0.1)).norm() < 1e-15);
    }
}
