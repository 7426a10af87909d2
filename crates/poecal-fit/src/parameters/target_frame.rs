//! Position and orientation of a target frame on the last link.

use nalgebra::Vector3;

use super::columns::{Column, ParameterColumns, ParameterSubject, of_freedom};
use crate::state::{Estimate, RowChain};
use poecal_arm::lie::{Freedom, TargetTwist, rotation};

/// The home pose of lou2009 (`M ← exp(Υ) M`), stepped at the target and in its own axes: columns `(R e_k; 0)` and `(0; R e_k)`
/// (theory.md §5 (24)). They are those of the observable motions (25a): a frame has all six, a face that lies on planes three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TargetFrame {
    /// Index of the target.
    pub target: usize,
    /// Observable motions, which are the unknowns.
    pub freedom: Freedom,
}

impl TargetFrame {
    /// A target whose motions are all observable.
    #[must_use]
    pub fn new(target: usize) -> Self {
        TargetFrame { target, freedom: Freedom::FRAME }
    }
}

impl ParameterColumns for TargetFrame {
    fn subject(&self) -> ParameterSubject {
        ParameterSubject::Target(self.target)
    }

    fn columns(&self) -> &'static [Column] {
        of_freedom(self.freedom)
    }

    fn target_twists(&self, chain: &RowChain, target: usize, out: &mut [TargetTwist]) {
        let zero = Vector3::zeros();
        for (out, &motion) in out.iter_mut().zip(self.freedom.motions()) {
            let own = if target == self.target { chain.target.rotation.column(motion % 3).into_owned() } else { zero };
            *out = if motion < 3 { (own, zero) } else { (zero, own) };
            if chain.shared == Some(self.target) {
                // The device's frame moves with the target: the base moves in the device's axes by the inverse.
                let axis = Vector3::ith(motion % 3, 1.0);
                if motion < 3 {
                    out.0 -= axis;
                } else {
                    out.0 -= axis.cross(&chain.target.translation);
                    out.1 -= axis;
                }
            }
        }
    }

    fn retract(&self, estimate: &mut Estimate, step: &[f64]) {
        let mut motion = [0.0; 6];
        self.freedom.motions().iter().zip(step).for_each(|(&at, value)| motion[at] = *value);
        let [x, y, z, rx, ry, rz] = motion;
        let pose = &mut estimate.base_from_target[self.target];
        pose.translation += pose.rotation * Vector3::new(x, y, z);
        pose.rotation *= rotation::exp(&Vector3::new(rx, ry, rz));
        *pose = pose.orthonormalized();
    }
}
