//! Registration from one station: closed forms on some of the rows, the best polished on all.

use nalgebra::{Matrix3, Vector3};

use super::averaging::{cube_rotations, mean_rotation, rigid_motion};
use super::hand_eye;
use super::placeless_devices::{self, StartRow};
use super::registration::{Registration, polish};
use crate::state::{Estimate, Linkage, RowChain, Unknowns, sample_rows};
use poecal_arm::lie::{Pose, rotation};

/// Rows of the search for a start; the polish afterwards uses all.
const SAMPLE: usize = 60;

/// Candidates that are polished and compared.
const FINALISTS: usize = 4;

/// Alternations of targets and device frame from a closed form.
const ROUNDS: usize = 4;

/// Root mean square distance, as a share of the data's own spread, above which the closed forms are not trusted alone.
const GOOD_MISFIT: f64 = 0.05;

/// Fewest measured positions that determine a frame alone.
const FEWEST_PLACES: usize = 3;

/// Registers the data to an estimate's screws as if they were measured from one station. Returns the cost of theory.md §6 (27) with it.
pub(crate) fn at_one_station(problem: &Registration<'_>, start: &Estimate) -> (Estimate, f64) {
    let sample = sample_rows(problem.rows, SAMPLE);
    let seen = SampledRows::new(problem, start, &sample);
    if let Some(best) = seen.by_others(problem, start, &sample) {
        return polish(problem, best, problem.rows.to_vec(), 50);
    }
    let mut best = seen.best_of(problem, start, &sample, seen.closed_forms(problem, start), ROUNDS);
    if problem.session.device_free && problem.targets_free && seen.misfit(&best.0) > GOOD_MISFIT {
        let turned = cube_rotations().map(|turn| seen.at_rotation(turn, start)).collect();
        // There is no alternation: all would converge to the same few device frames.
        let other = seen.best_of(problem, start, &sample, turned, 1);
        // A later start must be clearly better, so that rounding does not choose between equal ones.
        if other.1 < best.1 * (1.0 - 1e-6) {
            best = other;
        }
    }
    polish(problem, best.0, problem.rows.to_vec(), 50)
}

/// Best closed form and a few iterations.
pub(crate) fn roughly_at_one_station(problem: &Registration<'_>, start: &Estimate) -> Estimate {
    let sample = sample_rows(problem.rows, SAMPLE);
    let seen = SampledRows::new(problem, start, &sample);
    if let Some(best) = seen.by_others(problem, start, &sample) {
        return best;
    }
    let candidates = seen.closed_forms(problem, start).into_iter().map(|device| {
        let candidate = seen.alternate(problem, start, device, ROUNDS);
        (polish(problem, candidate.clone(), sample.clone(), 0).1, candidate)
    });
    let best = candidates.min_by(|a, b| a.0.total_cmp(&b.0));
    polish(problem, best.map_or_else(|| start.clone(), |(_, best)| best), sample.clone(), 8).0
}

/// Sampled rows: the arm's motion from zero in the base frame, and the measurements.
struct SampledRows {
    base_motion: Vec<Pose>,
    measured: Vec<Vector3<f64>>,
    turned: Vec<Option<Matrix3<f64>>>,
    target: Vec<usize>,
    /// Rows that measure no position.
    others: Vec<StartRow>,
    /// Spread of the measured positions, metres.
    spread_m: f64,
}

impl SampledRows {
    fn new(problem: &Registration<'_>, start: &Estimate, sample: &[u32]) -> Self {
        let mut in_base = start.clone();
        in_base.device_from_base = Pose::identity();
        let linkage = Linkage::new(&in_base);
        let mut chain = RowChain::default();
        let mut seen = SampledRows {
            base_motion: Vec::new(),
            measured: Vec::new(),
            turned: Vec::new(),
            target: Vec::new(),
            others: Vec::new(),
            spread_m: problem.session.data.spread_m(sample),
        };
        let of = |row: &u32| problem.session.observation(*row);
        // Too few positions are treated as components among others.
        let places = sample.iter().filter(|row| of(row).measurement.position().is_some()).count();
        let is_component = |row: &u32| of(row).measurement.is_part_of_position();
        let has_places = places >= FEWEST_PLACES || !sample.iter().any(is_component);
        for &row in sample {
            let observation = of(&row);
            let model = &observation.measurement;
            chain.evaluate(&linkage, problem.session.packed, row as usize, observation);
            let motion = chain.target * start.base_from_target[observation.target].inverse();
            let Some(position) = model.position().filter(|_| has_places) else {
                seen.others.push(StartRow { motion, measurement: observation.measurement, target: observation.target });
                continue;
            };
            seen.base_motion.push(motion);
            seen.measured.push(position);
            seen.turned.push(model.orientation());
            seen.target.push(observation.target);
        }
        seen
    }

    /// Lowest optimum from the best candidates, with its cost on the sample.
    fn best_of(
        &self,
        problem: &Registration<'_>,
        start: &Estimate,
        sample: &[u32],
        devices: Vec<Pose>,
        rounds: usize,
    ) -> (Estimate, f64) {
        let mut candidates: Vec<(f64, Estimate)> = devices
            .into_iter()
            .map(|device_from_base| {
                let candidate = self.alternate(problem, start, device_from_base, rounds);
                (polish(problem, candidate.clone(), sample.to_vec(), 0).1, candidate)
            })
            .collect();
        candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut best = (start.clone(), f64::INFINITY);
        let mut reached: Vec<Pose> = Vec::new();
        for (_, candidate) in candidates {
            let device = candidate.device_from_base;
            if reached.len() >= 2 * FINALISTS || reached.iter().any(|other| self.is_near(other, &device)) {
                continue;
            }
            let (polished, cost) = polish(problem, candidate, sample.to_vec(), 50);
            reached.extend([device, polished.device_from_base]);
            // A later start must be clearly better, so that rounding does not choose between equal ones.
            if cost < best.1 * (1.0 - 1e-6) {
                best = (polished, cost);
            }
        }
        best
    }

    /// Lowest optimum of a device that measures no positions; `None` for another device.
    fn by_others(&self, problem: &Registration<'_>, start: &Estimate, sample: &[u32]) -> Option<Estimate> {
        if !self.measured.is_empty() || self.others.is_empty() || !problem.session.device_free {
            return None;
        }
        let mut best: Option<(Estimate, f64)> = None;
        for candidate in placeless_devices::starts(&self.others, start, problem.targets_free) {
            let found = polish(problem, candidate, sample.to_vec(), 20);
            // A later start must be clearly better, so that rounding does not choose between equal ones.
            if best.as_ref().is_none_or(|(_, cost)| found.1 < cost * (1.0 - 1e-6)) {
                best = Some(found);
            }
        }
        best.map(|(best, _)| best)
    }

    /// True if two device frames lead to the same optimum: at most a few degrees and a tenth of the data's spread apart.
    fn is_near(&self, a: &Pose, b: &Pose) -> bool {
        let turn = rotation::log(&(a.rotation.transpose() * b.rotation)).norm();
        let count = self.base_motion.len().max(1) as f64;
        let middle = self.base_motion.iter().map(|motion| motion.translation).sum::<Vector3<f64>>() / count;
        turn < 0.1 && (a.act(&middle) - b.act(&middle)).norm() < 0.1 * self.spread_m
    }

    /// Root mean square distance from prediction to measurement over that of the measurements to their mean.
    fn misfit(&self, estimate: &Estimate) -> f64 {
        let count = self.measured.len().max(1) as f64;
        let missed: f64 = (0..self.measured.len())
            .map(|k| {
                let home = estimate.base_from_target[self.target[k]].translation;
                let predicted = estimate.device_from_base.act(&self.base_motion[k].act(&home));
                (self.measured[k] - predicted).norm_squared()
            })
            .sum();
        (missed / count).sqrt() / self.spread_m.max(f64::MIN_POSITIVE)
    }

    /// Candidates of the device frame: rigid motions of nominal targets and of targets on the last axis, theory.md §6 (32); the hand-eye
    /// rotation, theory.md §6 (33); and the mean rotation by nominal target orientations. The known frame alone if the device frame is
    /// known.
    fn closed_forms(&self, problem: &Registration<'_>, start: &Estimate) -> Vec<Pose> {
        if !problem.session.device_free {
            return vec![start.device_from_base];
        }
        if self.measured.is_empty() {
            return vec![start.device_from_base];
        }
        let mut candidates = vec![self.rigid(&start.base_from_target)];
        let framed: Vec<usize> = (0..self.turned.len()).filter(|&k| self.turned[k].is_some()).collect();
        if framed.len() >= 3 {
            let arm: Vec<_> = framed.iter().map(|&k| self.base_motion[k].rotation).collect();
            let seen: Vec<_> = framed.iter().filter_map(|&k| self.turned[k]).collect();
            let (turn, excitation) = hand_eye::device_rotation(&arm, &seen);
            if excitation > 1e-3 {
                candidates.push(self.at_rotation(turn, start));
            }
            // For data with few orientations: the mean rotation by nominal target orientations.
            let nominal = mean_rotation(framed.iter().zip(&seen).map(|(&k, turned)| {
                let arm = self.base_motion[k].rotation;
                turned * (arm * start.base_from_target[self.target[k]].rotation).transpose()
            }));
            candidates.push(self.at_rotation(nominal, start));
        }
        if problem.targets_free {
            let shrunk: Vec<Pose> = start.base_from_target.iter().map(|pose| self.on_last_axis(start, pose)).collect();
            candidates.push(self.rigid(&shrunk));
        }
        candidates
    }

    /// The target moved onto the last axis, where the last joint does not move it.
    fn on_last_axis(&self, start: &Estimate, target: &Pose) -> Pose {
        let place = start.screws().last().map_or(target.translation, |s| s.nearest_point(&target.translation));
        Pose::new(target.rotation, place)
    }

    fn rigid(&self, targets: &[Pose]) -> Pose {
        let from: Vec<_> = self
            .base_motion
            .iter()
            .zip(&self.target)
            .map(|(motion, &target)| motion.act(&targets[target].translation))
            .collect();
        rigid_motion(&from, &self.measured)
    }

    /// Device frame with a known rotation, and the translation between the means of theory.md §6 (32), with nominal targets.
    fn at_rotation(&self, turn: Matrix3<f64>, start: &Estimate) -> Pose {
        let count = self.measured.len().max(1) as f64;
        let shift: Vector3<f64> = (0..self.measured.len())
            .map(|k| {
                let place = self.base_motion[k].act(&start.base_from_target[self.target[k]].translation);
                self.measured[k] - turn * place
            })
            .sum();
        Pose::new(turn, shift / count)
    }

    /// Alternates between the targets for a fixed device frame and the device frame for fixed targets; targets come first and last.
    fn alternate(
        &self,
        problem: &Registration<'_>,
        start: &Estimate,
        device_from_base: Pose,
        rounds: usize,
    ) -> Estimate {
        let mut estimate = start.clone();
        estimate.device_from_base = device_from_base;
        if problem.targets_free && !self.measured.is_empty() {
            for round in 0..rounds {
                self.place_targets(&mut estimate, problem.session.unknowns);
                if problem.session.device_free && round + 1 < rounds {
                    estimate.device_from_base = self.rigid(&estimate.base_from_target);
                }
            }
        }
        estimate
    }

    /// Best position and orientation of each target on the last link, for a fixed device frame: theory.md §6 (32).
    fn place_targets(&self, estimate: &mut Estimate, unknowns: &Unknowns) {
        let base_from_device = estimate.device_from_base.inverse();
        for target in 0..estimate.base_from_target.len() {
            let rows = || (0..self.target.len()).filter(move |&k| self.target[k] == target);
            let count = rows().count();
            if count == 0 || !unknowns.moves_target(target) {
                continue;
            }
            let sum: Vector3<f64> =
                rows().map(|k| self.base_motion[k].inverse().act(&base_from_device.act(&self.measured[k]))).sum();
            let pose = &mut estimate.base_from_target[target];
            pose.translation = sum / count as f64;
            if rows().any(|k| self.turned[k].is_some()) {
                pose.rotation = mean_rotation(rows().filter_map(|k| {
                    let link_from_device =
                        (base_from_device.inverse().rotation * self.base_motion[k].rotation).transpose();
                    self.turned[k].map(|turned| link_from_device * turned)
                }));
            }
        }
    }
}
