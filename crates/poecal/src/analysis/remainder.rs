//! What no plain cause explains: whether the joints' combination is to blame, and else the directions as they are.

use super::causes::{Degree, NOTABLE, Rules, join, joint_of};
use super::direction::Cause;
use super::excitation::target_name;
use super::spectrum::{PLAUSIBLE, Spectrum, WEAK};
use super::subspace;
use crate::estimate::{Packed, sample_rows};
use crate::measurement::Dataset;
use crate::parameters::Parameter;
use crate::problem::Problem;
use crate::robot::JointKind;
use crate::solve::LeastSquares;

/// Rows whose joint values are shuffled to see whether their combination was the cause.
const SHUFFLED: usize = 400;

impl Rules<'_> {
    pub(super) fn dependent_motion(&mut self) {
        let left = self.left.ncols();
        let combined = self.told.iter().filter(|told| told.cause.is_combination());
        let explained: usize = combined.map(|told| told.directions).sum();
        if left == 0 || self.hidden_by_combination() < explained + left {
            return;
        }
        let joints = self.joints_left();
        let several = joints.len() > 1;
        let (open, subject) = if several {
            ("cannot be separated", "their screws")
        } else {
            ("cannot be determined", "its screw")
        };
        let words = self.degree_words(open, several, &self.screws(&joints));
        let directions = self.take(&self.places(|_| true));
        let description = format!(
            "{} moved far enough, but not independently of the others: {subject} {words}",
            self.names(&joints)
        );
        self.tell(Cause::DependentMotion, &joints, directions, description);
    }

    /// How many directions that are open would be told if every joint had taken the same values independently of the others.
    pub(super) fn hidden_by_combination(&self) -> usize {
        let setup = self.setup;
        let rows = sample_rows(setup.rows, SHUFFLED);
        let width = setup.data.reading_names().len();
        let count = rows.len();
        let mut data = Dataset::new(setup.data.reading_names().to_vec());
        data.targets.clone_from(&setup.data.targets);
        for (k, &row) in rows.iter().enumerate() {
            let other = |column| setup.data.readings(rows[shuffled(k, column, count)] as usize)[column];
            let readings: Vec<f64> = (0..width).map(other).collect();
            // Numbers that came from a data set fit into one.
            let _ = data.push_observation(&readings, setup.data.observations[row as usize]);
        }
        let packed = Packed::new(setup.robot, data.all_readings(), width);
        let free: Vec<Parameter> = setup.layout.parameters().map(|(parameter, _)| *parameter).collect();
        let (noise, length_m) = (setup.noise, setup.length_m);
        let problem = Problem::new(&data, &packed, (0..count as u32).collect(), free, noise, length_m);
        let mut gram = problem.normal(setup.estimate).gram;
        let scale = setup.rows.len() as f64 / count.max(1) as f64;
        gram.iter_mut().for_each(|value| *value *= scale);
        let then = Spectrum::new(&gram, setup.layout.dim(), self.spectrum.variance, length_m);
        // What is weak would have to become twice as good: a little better is no cause.
        let (limit_m, now) = match self.degree {
            Degree::Open => (PLAUSIBLE * length_m, self.spectrum.open),
            Degree::Weak(count) => (0.5 * WEAK * length_m, self.spectrum.open + count),
        };
        let then_not = (0..then.values.len()).take_while(|&k| k < then.open || then.sigma_m(k) > limit_m);
        now.saturating_sub(then_not.count())
    }

    /// Joints with a notable part in what is left.
    pub(super) fn joints_left(&self) -> Vec<usize> {
        let part = |joint: &usize| {
            let screws = self.screws(&[*joint]);
            let squares = self.left.column_iter().map(|column| {
                screws
                    .iter()
                    .map(|unit| column.iter().zip(unit).map(|(a, b)| a * b).sum::<f64>().powi(2))
                    .sum::<f64>()
            });
            squares.fold(0.0, f64::max) > NOTABLE
        };
        (0..self.excitation.still.len()).filter(part).collect()
    }

    /// What no rule explains, as it is; equal sentences once.
    pub(super) fn others(&mut self) {
        for direction in subspace::sparse(&self.left.clone()) {
            let (joints, parts) = self.parts(&direction);
            let (open, plural) = match (parts.len(), self.degree) {
                (1, _) => ("is not determined by these measurements", false),
                (_, Degree::Open) => ("can change together without effect on these measurements", true),
                (_, Degree::Weak(_)) => ("", true),
            };
            let subject =
                if parts.is_empty() { "a combination of all unknowns".to_owned() } else { join(&parts) };
            let together = if self.degree != Degree::Open && plural { " together" } else { "" };
            let words = self.degree_words(open, plural, &[direction]);
            let description = format!("{subject}{together} {words}");
            match self.told.iter_mut().find(|told| told.description == description) {
                Some(told) => told.directions += 1,
                None => self.tell(Cause::Other, &joints, 1, description),
            }
        }
    }

    /// The joints that a direction concerns, and in words what of them and of the targets.
    fn parts(&self, direction: &[f64]) -> (Vec<usize>, Vec<String>) {
        let (mut joints, mut parts) = (Vec::new(), Vec::new());
        for (parameter, places) in self.setup.layout.parameters() {
            let share: Vec<f64> = places.iter().map(|&(place, _)| direction[place].powi(2)).collect();
            if share.iter().sum::<f64>() < NOTABLE {
                continue;
            }
            if let Some(joint) = joint_of(parameter).filter(|joint| !joints.contains(joint)) {
                joints.push(joint);
            }
            let name = |joint: usize| self.name(joint);
            parts.push(match parameter {
                Parameter::ScrewAxis(axis) => {
                    let shift = share.iter().take(2).sum::<f64>() >= NOTABLE;
                    let tilt = share.iter().skip(2).sum::<f64>() >= NOTABLE;
                    match (axis.kind, shift, tilt) {
                        (JointKind::Prismatic, _, _) => {
                            format!("the sliding direction of {}", name(axis.joint))
                        }
                        (JointKind::Revolute, false, _) => format!("the tilt of {}'s axis", name(axis.joint)),
                        (JointKind::Revolute, true, false) => {
                            format!("the place of {}'s axis", name(axis.joint))
                        }
                        (JointKind::Revolute, true, true) => {
                            format!("the place and tilt of {}'s axis", name(axis.joint))
                        }
                    }
                }
                Parameter::OtherScrew(screw) => format!("the screw of {}", name(screw.joint)),
                Parameter::JointOffset(offset) => format!("the offset of {}", name(offset.joint)),
                Parameter::TargetPlace(it) => format!("the place of {}", target_name(self.setup, it.target)),
                Parameter::TargetFrame(it) => format!("the frame of {}", target_name(self.setup, it.target)),
                Parameter::DeviceFrame(it) if self.setup.data.station_count() > 1 => {
                    format!("the frame of {}", self.setup.data.station_words(it.station))
                }
                Parameter::DeviceFrame(_) => "the device's frame".to_owned(),
            });
        }
        (joints, parts)
    }
}

/// Where the k-th of `count` goes in the shuffle of a column: a stride that shares no divisor with the count, another for each column.
fn shuffled(k: usize, column: usize, count: usize) -> usize {
    let divides = |a: usize| (2..=a).any(|d| a.is_multiple_of(d) && count.is_multiple_of(d));
    let fraction = ((column as f64 + 1.0) * 0.618_033_988_749_894_9).fract();
    let mut stride = (fraction * count as f64) as usize;
    while stride == 0 || divides(stride) {
        stride += 1;
    }
    (k * stride + column) % count.max(1)
}
