//! Place and orientation of a target frame on the last link.

use nalgebra::Vector3;

use super::columns::{Column, Columns, FRAME, Subject};
use crate::estimate::{Chain, Estimate};
use crate::lie::{TargetTwist, rotation};

/// The home pose of lou2009 (`M ← exp(Υ) M`), stepped at the target and in its own axes: columns `(R e_k; 0)` and `(0; R e_k)`
/// (theory.md §5 (24)).
///
/// ```
/// use poecal::parameters::{Columns, TargetFrame};
/// assert_eq!(TargetFrame { target: 0 }.columns().len(), 6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TargetFrame {
    /// Index of the target.
    pub target: usize,
}

impl Columns for TargetFrame {
    fn subject(&self) -> Subject {
        Subject::Target(self.target)
    }

    fn columns(&self) -> &'static [Column] {
        &FRAME
    }

    fn target_twists(&self, chain: &Chain, target: usize, out: &mut [TargetTwist]) {
        let zero = Vector3::zeros();
        for k in 0..3 {
            let axis =
                if target == self.target { chain.target.rotation.column(k).into_owned() } else { zero };
            out[k] = (axis, zero);
            out[3 + k] = (zero, axis);
        }
        if chain.shared == Some(self.target) {
            // The device's frame moves with it: the base in the device's axes by the inverse.
            for k in 0..3 {
                let axis = Vector3::ith(k, 1.0);
                out[k].0 -= axis;
                out[3 + k].0 -= axis.cross(&chain.target.translation);
                out[3 + k].1 -= axis;
            }
        }
    }

    fn retract(&self, estimate: &mut Estimate, step: &[f64]) {
        let pose = &mut estimate.base_from_target[self.target];
        pose.translation += pose.rotation * Vector3::new(step[0], step[1], step[2]);
        pose.rotation *= rotation::exp(&Vector3::new(step[3], step[4], step[5]));
        *pose = pose.orthonormalized();
    }
}
