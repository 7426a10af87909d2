//! Motions of the base that change nothing, in a fit in which some things are held.

use nalgebra::{Matrix6, Vector6};

use super::Layout;
use crate::estimate::Estimate;
use crate::lie::{Pose, Twist};
use crate::linalg;
use crate::measurement::Dataset;
use crate::parameters::{Parameter, Subject};
use crate::robot::JointKind;

/// Share of the largest information about the base below which held things do not see a motion of it: rounding.
const UNSEEN: f64 = 1e-12;

impl Layout {
    /// Motions of the base under everything that leave all held things where they are, as directions of a step: orthonormal, and without
    /// effect on what these rows measure (theory.md §8 (37)). There are none where the first device frame is held.
    #[must_use]
    pub(crate) fn base_motions(&self, estimate: &Estimate, data: &Dataset, rows: &[u32]) -> Vec<Vec<f64>> {
        let is_held = |station: usize| {
            let of_it =
                |(parameter, _): (&Parameter, _)| parameter.model().subject() == Subject::Instrument(station);
            !self.parameters().any(of_it)
        };
        let sees_axes = |station: usize| data.sees_axes(&data.seen_from(station, rows));
        if is_held(0) && estimate.tree.shared(0).is_none() && sees_axes(0) {
            return Vec::new();
        }
        let is_frame = data.frames(rows);
        let length_m = self.length_m();
        let mut moved: Vec<Vec<f64>> = vec![vec![0.0; self.dim()]; 6];
        // Information that the held things give about a motion of the base.
        let mut gram = Matrix6::zeros();
        let mut add = |subject: Subject, effect: &dyn Fn(usize) -> Vec<f64>| {
            let is_of = |parameter: &&Parameter| {
                parameter.model().subject() == subject && parameter.value_term().is_none()
            };
            let own = self.parameters().find(|(parameter, _)| is_of(parameter));
            let effects: Vec<Vec<f64>> = (0..6).map(effect).collect();
            match own {
                Some((_, places)) => {
                    for (step, effect) in moved.iter_mut().zip(&effects) {
                        places.iter().zip(effect).for_each(|(&(at, scale), value)| step[at] = value * scale);
                    }
                }
                None => {
                    gram += Matrix6::from_fn(|i, j| linalg::dot(&effects[i], &effects[j]));
                }
            }
        };
        let unit = |k: usize| {
            let mut twist = Vector6::zeros();
            // Rotations counted like lengths.
            twist[k] = if k < 3 { 1.0 } else { 1.0 / length_m };
            Twist::from_vector(&twist)
        };
        // Of a motion G of the base, in the axes of what stands at `frame`: places, then turns.
        let local =
            |frame: &Pose, k: usize| -> Vector6<f64> { frame.inverse().transform(&unit(k)).to_vector() };
        for (joint, (frame, kind)) in estimate.base_from_axis.iter().zip(estimate.kinds()).enumerate() {
            add(Subject::Joint(joint), &|k| {
                let step = local(frame, k);
                match kind {
                    JointKind::Revolute => vec![step[0], step[1], step[3], step[4]],
                    JointKind::Prismatic => vec![step[3], step[4]],
                }
            });
        }
        for (target, frame) in estimate.base_from_target.iter().enumerate() {
            let seen = if is_frame.get(target).is_some_and(|&is_frame| is_frame) { 6 } else { 3 };
            add(Subject::Target(target), &|k| local(frame, k).iter().copied().take(seen).collect());
        }
        for station in 0..=estimate.further_devices.len() {
            if estimate.tree.shared(station).is_none() {
                let about = self.parameters().find_map(|(parameter, _)| {
                    let Parameter::DeviceFrame(own) = parameter else { return None };
                    (own.station == station).then_some(own.about)
                });
                let device = estimate.device(station);
                // Of a device without axes the origin is all that is held.
                let seen = if sees_axes(station) { 6 } else { 3 };
                let at = Pose::from_translation(about.unwrap_or_default());
                // `device_from_base G⁻¹`, stepped in the device's axes about a point.
                add(Subject::Instrument(station), &|k| {
                    let step = -at.inverse().transform(&device.transform(&unit(k))).to_vector();
                    step.iter().copied().take(seen).collect()
                });
            }
        }
        null_space(&gram).into_iter().fold(Vec::new(), |mut found, motion| {
            let mut step = vec![0.0; self.dim()];
            for (share, moved) in motion.iter().zip(&moved) {
                step.iter_mut().zip(moved).for_each(|(step, moved)| *step += share * moved);
            }
            for known in &found {
                let along = linalg::dot(&step, known);
                step.iter_mut().zip(known).for_each(|(step, known): (&mut f64, &f64)| *step -= along * known);
            }
            let length = linalg::dot(&step, &step).sqrt();
            if length > UNSEEN {
                step.iter_mut().for_each(|value| *value /= length);
                found.push(step);
            }
            found
        })
    }
}

/// Unit vectors of the null space.
fn null_space(gram: &Matrix6<f64>) -> Vec<Vector6<f64>> {
    let upper: Vec<f64> = gram.as_slice().to_vec();
    let (values, vectors) = linalg::symmetric_eigen(&upper, 6);
    let largest = values.last().copied().unwrap_or(0.0);
    let count = values.iter().take_while(|&&value| value <= UNSEEN * largest.max(1.0)).count();
    vectors.column_iter().take(count).map(|it| Vector6::from_iterator(it.iter().copied())).collect()
}
