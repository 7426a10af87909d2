//! Device frame: the base in the measuring device's frame.

use nalgebra::Vector3;

use super::columns::{Column, ParameterColumns, ParameterSubject, Wrench, of_freedom};
use crate::state::{Estimate, RowChain};
use poecal_arm::lie::{Freedom, TargetTwist, rotation};

/// The device frame, stepped about the point `about` of that frame: the middle of the data, so that rotation and translation are nearly
/// uncorrelated. The columns are `(e_k; 0)` and `(e_k × (p - about); e_k)` (theory.md §5 (25)), of the observable motions (25a). They are
/// zero in rows of another station.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceFrame {
    /// Index of the station.
    pub station: usize,
    /// Point about which the step rotates, metres, device frame.
    pub about: Vector3<f64>,
    /// Observable motions of the frame, which are the unknowns.
    pub freedom: Freedom,
}

impl DeviceFrame {
    /// Frame of a device with axes, stepped about a point.
    #[must_use]
    pub fn new(station: usize, about: Vector3<f64>) -> Self {
        DeviceFrame { station, about, freedom: Freedom::FRAME }
    }

    /// Frame of a device whose measurements determine only these motions: the anchor of a wire, a plane that is touched.
    #[must_use]
    pub fn from_freedom(station: usize, freedom: Freedom) -> Self {
        DeviceFrame { station, about: Vector3::zeros(), freedom }
    }

    /// A step of these unknowns as all six motions.
    fn motion(&self, step: &[f64]) -> (Vector3<f64>, Vector3<f64>) {
        let mut motion = [0.0; 6];
        self.freedom.motions().iter().zip(step).for_each(|(&at, value)| motion[at] = *value);
        let [x, y, z, rx, ry, rz] = motion;
        (Vector3::new(x, y, z), Vector3::new(rx, ry, rz))
    }
}

impl ParameterColumns for DeviceFrame {
    fn subject(&self) -> ParameterSubject {
        ParameterSubject::Instrument(self.station)
    }

    fn columns(&self) -> &'static [Column] {
        of_freedom(self.freedom)
    }

    fn target_twists(&self, chain: &RowChain, _: usize, out: &mut [TargetTwist]) {
        if chain.station != self.station {
            out.fill((Vector3::zeros(), Vector3::zeros()));
            return;
        }
        let arm = chain.target.translation - self.about;
        for (out, &motion) in out.iter_mut().zip(self.freedom.motions()) {
            let axis = Vector3::ith(motion % 3, 1.0);
            *out = if motion < 3 { (axis, Vector3::zeros()) } else { (axis.cross(&arm), axis) };
        }
    }

    fn curvature(&self, chain: &RowChain, wrench: &Wrench, out: &mut [f64]) {
        if chain.station != self.station {
            return;
        }
        let arm = chain.target.translation - self.about;
        let motions = self.freedom.motions();
        let turns = || motions.iter().enumerate().filter(|(_, motion)| **motion >= 3);
        for (i, a) in turns().map(|(i, motion)| (i, motion - 3)) {
            for (j, b) in turns().map(|(j, motion)| (j, motion - 3)) {
                // ½ (ω_a × (ω_b × d) + ω_b × (ω_a × d)), contracted: unit vectors along the axes.
                let (fa, fb) = (wrench.force[a], wrench.force[b]);
                let along = if a == b { wrench.force.dot(&arm) } else { 0.0 };
                out[i * motions.len() + j] = 0.5 * (fa * arm[b] + fb * arm[a]) - along;
            }
        }
    }

    fn retract(&self, estimate: &mut Estimate, step: &[f64]) {
        let (shift, turn) = self.motion(step);
        let turn = rotation::exp(&turn);
        let pose = estimate.device_mut(self.station);
        pose.translation = turn * (pose.translation - self.about) + self.about + shift;
        pose.rotation = turn * pose.rotation;
        *pose = pose.orthonormalized();
    }
}
