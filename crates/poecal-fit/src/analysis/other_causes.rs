//! Directions without a plain cause: dependent motion of the joints, and the remaining directions as they are.

use nalgebra::Vector3;

use super::causes::{Degree, ExplainedDirections, NOTABLE, join, joint_of};
use super::direction::Cause;
use super::excitation::target_name;
use super::spectrum::{PLAUSIBLE, Spectrum, WEAK};
use super::subspace;
use crate::parameters::{Parameter, TargetPlace};
use crate::problem::Problem;
use crate::state::{PackedValues, RangeTerm, Session, sample_rows};
use poecal_arm::lie::{Freedom, Pose};
use poecal_model::measurement::Dataset;
use poecal_model::robot::JointKind;
use poecal_numerics::linalg;
use poecal_numerics::solve::LeastSquares;

/// Rows with shuffled joint values, by which the effect of their combination is tested.
const SHUFFLED: usize = 400;

impl ExplainedDirections<'_> {
    /// The size of the robot and the cell: angles, contacts and directions alone do not determine it.
    pub(crate) fn size(&mut self) {
        let has_length = |row: &u32| self.setup.session.observation(*row).measurement.has_length();
        if self.setup.rows.iter().all(has_length) {
            return;
        }
        let size = self.growth();
        if self.take(std::slice::from_ref(&size)) == 0 {
            return;
        }
        let words = self.degree_words("is not determined, and stays near the model's", false, &[size]);
        let description = if self.setup.session.lacks_length(self.setup.rows) {
            format!(
                "nothing that was measured has a length: the size of the robot {words}; one known length gives it, such as the distance of \
                 two sockets (--socket-distance), the radius of a sphere, a height or a distance"
            )
        } else {
            format!(
                "the lengths that were measured are short: the size of the robot {words}; a longer or a more exact one determines it"
            )
        };
        self.add(Cause::NoLength, &[], 1, description);
    }

    /// Growth of axes, targets, other devices and zeros of distances about the origin of the first device of the rows.
    fn growth(&self) -> Vec<f64> {
        let estimate = self.setup.estimate;
        let origin = |station: usize| estimate.device_at_zero(station).inverse().translation;
        let about = origin(self.setup.session.data.first_station(self.setup.rows));
        let shown = |freedom: Freedom, moved: Vector3<f64>| -> Vec<f64> {
            freedom.motions().iter().map(|&motion| moved.iter().nth(motion).copied().unwrap_or(0.0)).collect()
        };
        let local = |frame: &Pose| frame.rotation.tr_mul(&(frame.translation - about));
        let mut growth = vec![0.0; self.setup.layout.dim()];
        for (parameter, places) in self.setup.layout.parameters() {
            let moved: Vec<f64> = match parameter {
                Parameter::ScrewAxis(axis) if axis.kind == JointKind::Revolute => {
                    let moved = local(&estimate.base_from_axis[axis.joint]);
                    vec![moved.x, moved.y, 0.0, 0.0]
                }
                Parameter::TargetPlace(TargetPlace { target }) => {
                    shown(Freedom::PLACE, local(&estimate.base_from_target[*target]))
                }
                Parameter::TargetFrame(it) => shown(it.freedom, local(&estimate.base_from_target[it.target])),
                Parameter::DeviceFrame(it) => {
                    let device = estimate.device(it.station);
                    shown(it.freedom, -(device.rotation * (origin(it.station) - about)))
                }
                Parameter::RangeUnknown(it) if it.term == RangeTerm::Zero => {
                    vec![estimate.range(it.station).zero_m]
                }
                Parameter::ScrewAxis(_)
                | Parameter::OtherScrew(_)
                | Parameter::ValueTerm(_)
                | Parameter::RangeUnknown(_)
                | Parameter::ClockUnknown(_) => Vec::new(),
            };
            places.iter().zip(moved).for_each(|(&(place, scale), moved)| growth[place] = moved * scale);
        }
        let length = linalg::dot(&growth, &growth).sqrt();
        growth.iter_mut().for_each(|part| *part /= length.max(f64::MIN_POSITIVE));
        growth
    }

    pub(crate) fn dependent_motion(&mut self) {
        let left = self.unexplained.ncols();
        let combined = self.found.iter().filter(|direction| direction.cause.is_combination());
        let explained: usize = combined.map(|direction| direction.directions).sum();
        if left == 0 || self.hidden_by_combination() < explained + left {
            return;
        }
        let joints = self.unexplained_joints();
        // A direction of tool and device alone is described by its parts.
        if joints.is_empty() {
            return;
        }
        let several = joints.len() > 1;
        let (open, subject) =
            if several { ("cannot be separated", "their screws") } else { ("cannot be determined", "its screw") };
        let words = self.degree_words(open, several, &self.screws(&joints));
        let directions = self.take(&self.places(|_| true));
        let description =
            format!("{} moved far enough, but not independently of the others: {subject} {words}", self.names(&joints));
        self.add(Cause::DependentMotion, &joints, directions, description);
    }

    /// Number of directions that would be determined if every joint had taken the same values independently of the others.
    pub(crate) fn hidden_by_combination(&self) -> usize {
        let setup = self.setup;
        let rows = sample_rows(setup.rows, SHUFFLED);
        let Session { robot, data: measured, length_m, .. } = setup.session;
        let (width, count) = (measured.reading_names().len(), rows.len());
        let mut data = Dataset::new(measured.reading_names().to_vec());
        data.targets.clone_from(&measured.targets);
        for (k, &row) in rows.iter().enumerate() {
            let other = |column| measured.readings(rows[shuffled(k, column, count)] as usize)[column];
            let readings: Vec<f64> = (0..width).map(other).collect();
            // Observations of a data set are valid in another one.
            let _ = data.push_observation(&readings, *setup.session.observation(row));
        }
        let packed = PackedValues::new(robot, data.all_readings(), width);
        let free: Vec<Parameter> = setup.layout.parameters().map(|(parameter, _)| *parameter).collect();
        let session = Session { data: &data, packed: &packed, ..setup.session };
        let problem = Problem::new(session, (0..count as u32).collect(), free, setup.noise);
        let mut gram = problem.normal(setup.estimate).gram;
        let scale = setup.rows.len() as f64 / count.max(1) as f64;
        gram.iter_mut().for_each(|value| *value *= scale);
        let shuffled_spectrum = Spectrum::new(&gram, setup.layout.dim(), self.spectrum.variance, length_m);
        // Weak directions have to improve by a factor of two; a smaller gain is no cause.
        let (limit_m, now) = match self.degree {
            Degree::Undetermined => (PLAUSIBLE * length_m, self.spectrum.undetermined),
            Degree::Weak(count) => (0.5 * WEAK * length_m, self.spectrum.undetermined + count),
        };
        let remaining = (0..shuffled_spectrum.values.len())
            .take_while(|&k| k < shuffled_spectrum.undetermined || shuffled_spectrum.sigma_m(k) > limit_m);
        now.saturating_sub(remaining.count())
    }

    /// Joints with a notable part in the unexplained directions.
    pub(crate) fn unexplained_joints(&self) -> Vec<usize> {
        let part = |joint: &usize| {
            let screws = self.screws(&[*joint]);
            let squares = self.unexplained.column_iter().map(|column| {
                screws.iter().map(|unit| column.iter().zip(unit).map(|(a, b)| a * b).sum::<f64>().powi(2)).sum::<f64>()
            });
            squares.fold(0.0, f64::max) > NOTABLE
        };
        (0..self.excitation.still.len()).filter(part).collect()
    }

    /// Directions that no rule explains, as they are; equal descriptions once.
    pub(crate) fn explain_other_directions(&mut self) {
        for direction in subspace::sparse_basis(&self.unexplained.clone()) {
            let (joints, parts) = self.parts(&direction);
            let (open, plural) = match (parts.len(), self.degree) {
                (1, _) => ("is not determined by these measurements", false),
                (_, Degree::Undetermined) => ("can change together without effect on these measurements", true),
                (_, Degree::Weak(_)) => ("", true),
            };
            let subject = if parts.is_empty() { "a combination of all unknowns".to_owned() } else { join(&parts) };
            let together = if self.degree != Degree::Undetermined && plural { " together" } else { "" };
            let words = self.degree_words(open, plural, &[direction]);
            let description = format!("{subject}{together} {words}");
            match self.found.iter_mut().find(|direction| direction.description == description) {
                Some(same) => same.directions += 1,
                None => self.add(Cause::Other, &joints, 1, description),
            }
        }
    }

    /// Joints with a part in a direction, and its parts in words.
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
                Parameter::ValueTerm(it) => format!("the {} of {}", it.term, name(it.joint)),
                Parameter::TargetPlace(it) => format!("the place of {}", target_name(self.setup, it.target)),
                Parameter::TargetFrame(it) => format!("the frame of {}", target_name(self.setup, it.target)),
                Parameter::DeviceFrame(it) if self.setup.session.data.station_count() > 1 => {
                    format!("the frame of {}", self.setup.session.data.station_words(it.station))
                }
                Parameter::DeviceFrame(_) => "the device's frame".to_owned(),
                Parameter::ClockUnknown(it) => {
                    let station = self.setup.session.data.station_words(it.station);
                    format!("the {} of the clock of {station}", it.term.name())
                }
                Parameter::RangeUnknown(it) => {
                    format!("the {} of {}", it.term.name(), self.setup.session.data.station_words(it.station))
                }
            });
        }
        (joints, parts)
    }
}

/// Position of the k-th of `count` in the shuffled column: a stride coprime to the count, a different one for each column.
fn shuffled(k: usize, column: usize, count: usize) -> usize {
    let divides = |a: usize| (2..=a).any(|d| a.is_multiple_of(d) && count.is_multiple_of(d));
    let fraction = ((column as f64 + 1.0) * 0.618_033_988_749_894_9).fract();
    let mut stride = (fraction * count as f64) as usize;
    while stride == 0 || divides(stride) {
        stride += 1;
    }
    (k * stride + column) % count.max(1)
}
