//! Device frame: the base in the measuring device's frame.

use nalgebra::Vector3;

use super::columns::{Column, Columns, FRAME, PLACE, Subject, Wrench};
use crate::estimate::{Chain, Estimate};
use crate::lie::{TargetTwist, rotation};

/// The device frame, stepped about the point `about` of that frame (the middle of the data, so that rotation and translation are nearly
/// uncorrelated): columns `(e_k; 0)` and `(e_k × (p - about); e_k)` (theory.md §5 (25)). They are zero in rows of another station.
///
/// ```
/// use poecal::parameters::{Columns, DeviceFrame};
/// assert_eq!(DeviceFrame::new(0, nalgebra::Vector3::zeros()).columns().len(), 6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceFrame {
    /// Index of the station.
    pub station: usize,
    /// Point about which the step rotates, metres, device frame.
    pub about: Vector3<f64>,
    /// Whether the axes are unknown too; otherwise the device shows where it is, and not how it is turned (3 unknowns).
    pub turns: bool,
}

impl DeviceFrame {
    /// A device with axes, stepped about a point.
    #[must_use]
    pub fn new(station: usize, about: Vector3<f64>) -> Self {
        DeviceFrame { station, about, turns: true }
    }

    /// A device without axes that its measurements show: the anchor of a wire.
    #[must_use]
    pub fn anchor(station: usize) -> Self {
        DeviceFrame { station, about: Vector3::zeros(), turns: false }
    }
}

impl Columns for DeviceFrame {
    fn subject(&self) -> Subject {
        Subject::Instrument(self.station)
    }

    fn columns(&self) -> &'static [Column] {
        if self.turns { &FRAME } else { &PLACE }
    }

    fn target_twists(&self, chain: &Chain, _: usize, out: &mut [TargetTwist]) {
        if chain.station != self.station {
            out.fill((Vector3::zeros(), Vector3::zeros()));
            return;
        }
        let arm = chain.target.translation - self.about;
        for k in 0..3 {
            let mut axis = Vector3::zeros();
            axis[k] = 1.0;
            out[k] = (axis, Vector3::zeros());
            if self.turns {
                out[3 + k] = (axis.cross(&arm), axis);
            }
        }
    }

    fn curvature(&self, chain: &Chain, wrench: &Wrench, out: &mut [f64]) {
        if chain.station != self.station || !self.turns {
            return;
        }
        let arm = chain.target.translation - self.about;
        for a in 0..3 {
            for b in 0..3 {
                // ½ (ω_a × (ω_b × d) + ω_b × (ω_a × d)), contracted: unit vectors along the axes.
                let (fa, fb) = (wrench.force[a], wrench.force[b]);
                let along = if a == b { wrench.force.dot(&arm) } else { 0.0 };
                out[(3 + a) * 6 + 3 + b] = 0.5 * (fa * arm[b] + fb * arm[a]) - along;
            }
        }
    }

    fn retract(&self, estimate: &mut Estimate, step: &[f64]) {
        let turn = if self.turns { Vector3::new(step[3], step[4], step[5]) } else { Vector3::zeros() };
        let turn = rotation::exp(&turn);
        let shift = Vector3::new(step[0], step[1], step[2]);
        let pose = estimate.device_mut(self.station);
        pose.translation = turn * (pose.translation - self.about) + self.about + shift;
        pose.rotation = turn * pose.rotation;
        *pose = pose.orthonormalized();
    }
}
