//! Corrects the targets of a program.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ops::Range;

use super::super::{ChangeOptions, CompensatedConfiguration, Compensation, CompensationSummary, CorrectionOutcome};
use super::pose_compensation::PoseCompensation;
use super::program_text::{number, replace_ranges, with_sign_as};
use super::reasons as reason;
use super::target_outcomes::{PlacedTarget, TargetOutcome, TargetResult, join_outcomes};
use poecal_arm::lie::Pose;
use poecal_model::robot::{ControllerMap, Robot};
use poecal_numerics::error::Result;
use poecal_programs::StatedFrames;
use poecal_programs::forms::PoseForm;
use poecal_programs::parsed_program::{ParsedProgram, PoseMeaning, ProgramMotion, ProgramTarget};
use poecal_programs::stated_configuration::StatedConfiguration;

/// Distance (m) and angle (rad) that rounding may leave at a corrected target.
const ROUNDING: f64 = 2e-6;

/// A corrected program.
pub(crate) struct CorrectedProgram {
    /// Its text.
    pub(crate) text: Vec<u8>,
    /// Corrected targets, and their intended configurations.
    pub(crate) meant: Vec<(usize, Vec<f64>)>,
    /// Changes, and unchanged targets.
    pub(crate) summary: CompensationSummary,
}

/// Corrects a program's targets one after the other.
pub(crate) struct Engine<'e> {
    pub(crate) poses: PoseCompensation,
    pub(crate) given: &'e StatedFrames,
    /// Conversion, if the controller counts other readings than the model.
    pub(crate) counting: Option<ControllerMap>,
    robots: (&'e Robot, &'e Robot),
    factors: &'e [f64],
    options: &'e ChangeOptions,
    /// Readings that programs state as external axes: they are held, and the others are corrected for them.
    external: Vec<usize>,
    /// The compensation at each set of their values, keyed by the bits of these.
    held: BTreeMap<Vec<u64>, PoseCompensation>,
}

impl<'e> Engine<'e> {
    pub(crate) fn new(
        robots: (&'e Robot, &'e Robot),
        factors: &'e [f64],
        given: &'e StatedFrames,
        options: &'e ChangeOptions,
    ) -> Result<Self> {
        let poses = PoseCompensation::new(robots.0, robots.1, factors, options)?;
        let (external, held) = (Vec::new(), BTreeMap::new());
        Ok(Engine { poses, given, counting: None, robots, factors, options, external, held })
    }

    /// Holds external axes at the values of each target.
    pub(crate) fn hold(&mut self, external: Vec<usize>, parsed: &ParsedProgram) -> Result<()> {
        self.external = external;
        if self.external.is_empty() {
            return Ok(());
        }
        for target in &parsed.targets {
            let values = self.external_values(target);
            if let Entry::Vacant(place) = self.held.entry(bits(&values)) {
                let held: Vec<(usize, f64)> = self.external.iter().copied().zip(values).collect();
                let (nominal, actual) = self.robots;
                let readings = Compensation::with_held_joints(nominal, actual, self.factors, &held, self.options)?;
                place.insert(PoseCompensation::from_compensation(readings));
            }
        }
        Ok(())
    }

    /// Values of the external axes at a target (rad, m).
    fn external_values(&self, target: &ProgramTarget) -> Vec<f64> {
        let numbers = target.scaled_numbers();
        match target.meant {
            PoseMeaning::Joints => self.external_of(&self.readings(numbers)),
            // The last numbers are the external axes.
            PoseMeaning::Pose(_) => {
                numbers.get(numbers.len().saturating_sub(self.external.len())..).unwrap_or_default().to_vec()
            }
        }
    }

    fn external_of(&self, q: &[f64]) -> Vec<f64> {
        self.external.iter().map(|&it| q.get(it).copied().unwrap_or(0.0)).collect()
    }

    /// The compensation at these values of the external axes.
    fn compensation_holding(&self, external: &[f64]) -> &PoseCompensation {
        self.held.get(&bits(external)).unwrap_or(&self.poses)
    }

    /// The compensation at a configuration.
    pub(crate) fn compensation_at(&self, q: &[f64]) -> &PoseCompensation {
        self.compensation_holding(&self.external_of(q))
    }

    /// A configuration with these values of the external axes.
    fn with_external(&self, mut q: Vec<f64>, external: &[f64]) -> Vec<f64> {
        for (&at, value) in self.external.iter().zip(external) {
            if let Some(it) = q.get_mut(at) {
                *it = *value;
            }
        }
        q
    }

    /// The model's readings for those that a program states.
    pub(crate) fn readings(&self, stated: Vec<f64>) -> Vec<f64> {
        match &self.counting {
            Some(counting) => counting.readings(&stated),
            None => stated,
        }
    }

    /// The controller's readings for those of the model.
    fn controller_readings(&self, readings: &[f64]) -> Vec<f64> {
        self.counting.as_ref().map_or_else(|| readings.to_vec(), |it| it.controller_readings(readings))
    }

    /// The arm's readings at a configuration, and the same as the controller counts them.
    fn model_and_controller_readings(&self, q: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let poses = self.compensation_at(q);
        (poses.of_arm(q), poses.of_arm(&self.controller_readings(q)))
    }

    /// Corrects all targets of a text.
    pub(crate) fn correct(&mut self, text: &[u8], parsed: ParsedProgram, each: bool) -> CorrectedProgram {
        let fates = self.fates(&parsed);
        let mut summary = CompensationSummary::new(self.poses.compensation());
        summary.listed.clone_from(&parsed.listed);
        summary.targets = each.then(Vec::new);
        let mut changes: Vec<(Range<usize>, String)> = Vec::new();
        let mut meant = Vec::new();
        for (index, (target, fate)) in parsed.targets.iter().zip(fates).enumerate() {
            let made = match fate {
                TargetOutcome::Open => Err(reason::NO_MOTION.into()),
                TargetOutcome::Listed(reason, line) if line == target.line => Err(reason),
                TargetOutcome::Listed(reason, line) => Err(format!("{reason} (motion on line {line})").into()),
                TargetOutcome::Placed(placed) => self.write(target, &placed, &mut summary).map(|it| (it, placed.q)),
            };
            match made {
                Ok((made, q)) => {
                    let signed = |(range, new): (Range<usize>, String)| {
                        let old = text.get(range.clone()).unwrap_or_default();
                        (range, with_sign_as(old, new))
                    };
                    changes.extend(made.into_iter().map(signed));
                    meant.push((index, q));
                }
                Err(reason) => summary.list(target.line, &target.name, reason),
            }
        }
        summary.listed.sort();
        summary.listed.dedup();
        CorrectedProgram { text: replace_ranges(text, changes), meant, summary }
    }

    /// Outcome of each target by the motions to it.
    fn fates(&self, parsed: &ParsedProgram) -> Vec<TargetOutcome> {
        let mut fates: Vec<TargetOutcome> = parsed.targets.iter().map(|it| self.outcome_without_motions(it)).collect();
        let mut reached: Vec<Option<Vec<f64>>> = Vec::with_capacity(parsed.motions.len());
        let start = self.given.start.clone().map(|it| self.readings(it));
        for (number, motion) in parsed.motions.iter().enumerate() {
            let (Some(target), Some(fate)) = (parsed.targets.get(motion.target), fates.get_mut(motion.target)) else {
                reached.push(None);
                continue;
            };
            let before = match motion.after {
                Some(before) => reached.get(before).and_then(Option::as_deref),
                None => start.as_deref().filter(|_| number == 0),
            };
            let placed = match (&target.meant, &*fate) {
                (PoseMeaning::Joints, _) if motion.refused.is_some() => {
                    Err(motion.refused.clone().unwrap_or_default().into())
                }
                (PoseMeaning::Joints, TargetOutcome::Placed(placed)) => Ok(PlacedTarget::clone(placed)),
                (PoseMeaning::Joints, TargetOutcome::Open | TargetOutcome::Listed(..)) => {
                    Err(reason::NOT_A_POSE.into())
                }
                (PoseMeaning::Pose(form), _) => self.place(target, *form, motion, before),
            };
            reached.push(placed.as_ref().ok().map(|it| it.q.clone()));
            *fate = join_outcomes(std::mem::replace(fate, TargetOutcome::Open), placed, motion.line);
        }
        fates
    }

    /// Outcome of a target without its motions.
    fn outcome_without_motions(&self, target: &ProgramTarget) -> TargetOutcome {
        match target.meant {
            PoseMeaning::Pose(_) => TargetOutcome::Open,
            PoseMeaning::Joints => TargetOutcome::Placed(Box::new(PlacedTarget {
                tool: Pose::identity(),
                frame: Pose::identity(),
                q: self.readings(target.scaled_numbers()),
                stated: StatedConfiguration::Nothing,
            })),
        }
    }

    /// Configuration that a motion to a pose reaches.
    fn place(
        &self,
        target: &ProgramTarget,
        form: PoseForm,
        motion: &ProgramMotion,
        before: Option<&[f64]>,
    ) -> TargetResult<PlacedTarget> {
        let external = self.external_values(target);
        let joints = self.compensation_holding(&external).compensation().readings().len();
        if joints > 6 {
            return Err(reason::JOINTS.into());
        }
        if let Some(reason) = &motion.refused {
            return Err(reason.clone().into());
        }
        let tool = motion.tool.ok_or(reason::NO_TOOL)?;
        let frame = motion.frame.ok_or(reason::NO_FRAME)?;
        let numbers = target.scaled_numbers();
        let pose = form.of_first(&numbers).ok_or(reason::NOT_A_POSE)?;
        let tip_from_tool = self.given.flange * tool;
        let base_from_tip = self.given.base * frame * pose * tip_from_tool.inverse();
        let q = self.configuration(motion, &base_from_tip, &tip_from_tool, (before, &external))?;
        if self.compensation_at(&q).is_singular(&q) {
            return Err(reason::SINGULAR.into());
        }
        Ok(PlacedTarget { tool, frame, q, stated: motion.stated.clone() })
    }

    fn configuration(
        &self,
        motion: &ProgramMotion,
        target: &Pose,
        tip_from_tool: &Pose,
        (before, external): (Option<&[f64]>, &[f64]),
    ) -> TargetResult<Vec<f64>> {
        let poses = self.compensation_holding(external);
        let nominal = poses.compensation().nominal_arm();
        // If external axes move on the path too, it is not a path of the arm alone.
        let is_straight = motion.is_straight && before.is_none_or(|it| self.external_of(it) == external);
        match (&motion.stated, before) {
            (StatedConfiguration::Near(near), _) => self.solve_nearest(target, &self.readings(near.clone()), external),
            (StatedConfiguration::Nothing, None) => Err(reason::NOTHING_STATED.into()),
            (StatedConfiguration::Nothing, Some(before)) if !is_straight => {
                self.solve_nearest(target, before, external)
            }
            (stated, Some(before)) if is_straight => {
                let found = poses.follow(before, target, tip_from_tool).ok_or(reason::WAY)?;
                let fits = stated.fits(nominal, &self.model_and_controller_readings(&found));
                if fits { Ok(found) } else { Err(reason::OTHER.into()) }
            }
            _ if !poses.has_branches() => Err(reason::NO_BRANCHES.into()),
            (stated, _) => {
                let all = poses.all(target).into_iter();
                let mut all: Vec<Vec<f64>> = all.map(|q| self.with_external(q, external)).collect();
                if all.is_empty() {
                    return Err(reason::UNREACHABLE.into());
                }
                all.retain(|q| stated.fits(nominal, &self.model_and_controller_readings(q)));
                if all.len() > 1 {
                    all.retain(|q| stated.fits_best(nominal, &poses.of_arm(q)));
                }
                match all.len() {
                    0 => Err(reason::NONE_FITS.into()),
                    1 => Ok(all.remove(0)),
                    _ => Err(reason::SEVERAL_FIT.into()),
                }
            }
        }
    }

    fn solve_nearest(&self, target: &Pose, near: &[f64], external: &[f64]) -> TargetResult<Vec<f64>> {
        let poses = self.compensation_holding(external);
        if !poses.has_branches() {
            return Err(reason::NO_BRANCHES.into());
        }
        let found = poses.solve_nearest(target, near).map(|q| self.with_external(q, external));
        let why = || if poses.all(target).is_empty() { reason::UNREACHABLE } else { reason::NOT_SURE };
        found.ok_or_else(|| why().into())
    }

    /// The changed numbers of a placed target, each with its bytes.
    fn write(
        &mut self,
        target: &ProgramTarget,
        placed: &PlacedTarget,
        summary: &mut CompensationSummary,
    ) -> TargetResult<Vec<(Range<usize>, String)>> {
        let held = bits(&self.external_of(&placed.q));
        let (told, found) = self.held.get_mut(&held).unwrap_or(&mut self.poses).compensate_at(&placed.q);
        let readings = found.readings.to_vec();
        let found = CompensatedConfiguration { readings: &readings, ..found };
        let left = (found.left_m, found.left_rad);
        if !found.is_corrected {
            return Err(self.compensation_at(&placed.q).compensation().reason(found.outcome, left));
        }
        let numbers = match target.meant {
            PoseMeaning::Joints => self.corrected_numbers(target, &placed.q, &readings),
            PoseMeaning::Pose(form) => {
                if self.compensation_at(&placed.q).compensation().is_beyond_limits(&readings) {
                    return Err(reason::LIMITS.into());
                }
                let nominal = self.compensation_at(&placed.q).compensation().nominal_arm();
                let tip_from_tool = self.given.flange * placed.tool;
                let pose = (self.given.base * placed.frame).inverse() * told * tip_from_tool;
                let before = target.scaled_numbers();
                let count = form.names().len();
                let mut numbers = form.numbers(&pose, before.get(..count).unwrap_or(&[]));
                let words = placed.stated.words(nominal, &self.model_and_controller_readings(&readings));
                numbers.extend(words.ok_or(reason::WORDS)?);
                numbers
            }
        };
        let texts: Vec<String> =
            target.numbers.iter().zip(&numbers).enumerate().map(|(at, it)| number(at, it, target.meant)).collect();
        let written = self.remaining_error(target, placed, &readings, &texts, left);
        let is_exact = found.outcome == CorrectionOutcome::Reached;
        let most = if is_exact { (ROUNDING, ROUNDING) } else { (left.0 + ROUNDING, left.1 + ROUNDING) };
        if matches!(target.meant, PoseMeaning::Pose(_)) && (written.0 > most.0 || written.1 > most.1) {
            return Err(reason::SINGULAR.into());
        }
        let found = CompensatedConfiguration { left_m: written.0, left_rad: written.1, ..found };
        summary.include(target.line, &placed.q, &found);
        let changed = target.numbers.iter().zip(texts).filter(|(_, text)| !text.is_empty());
        Ok(changed.map(|(number, text)| (number.range.clone(), text)).collect())
    }

    /// The numbers of a joint target after the change of its readings.
    fn corrected_numbers(&self, target: &ProgramTarget, from: &[f64], to: &[f64]) -> Vec<f64> {
        let Some(counting) = &self.counting else { return to.to_vec() };
        counting.moved_readings(&target.scaled_numbers(), from, to)
    }

    /// The arm's readings, near others, that a controller with the nominal robot commands for a pose of a tool in a frame.
    pub(crate) fn commanded_by(
        &self,
        poses: &PoseCompensation,
        pose: &Pose,
        (tool, frame): (Pose, Pose),
        near: &[f64],
    ) -> Vec<f64> {
        let told = self.given.base * frame * *pose * (self.given.flange * tool).inverse();
        let mut q = poses.of_arm(near);
        poses.compensation().nominal_arm().solve_nearest(&told, &mut q);
        q
    }

    /// Remaining distance and angle with the written numbers.
    fn remaining_error(
        &self,
        target: &ProgramTarget,
        placed: &PlacedTarget,
        readings: &[f64],
        texts: &[String],
        unrounded: (f64, f64),
    ) -> (f64, f64) {
        let written: Vec<f64> = target
            .numbers
            .iter()
            .zip(texts)
            .map(|(number, text)| text.parse().map_or(number.value, |it: f64| it) * number.scale)
            .collect();
        let poses = self.compensation_at(&placed.q);
        let compensation = poses.compensation();
        let meant = compensation.nominal_arm().forward_kinematics(&poses.of_arm(&placed.q));
        let commanded = match target.meant {
            PoseMeaning::Joints => poses.of_arm(&self.readings(written)),
            PoseMeaning::Pose(form) => {
                let Some(pose) = form.of_first(&written) else { return unrounded };
                self.commanded_by(poses, &pose, (placed.tool, placed.frame), readings)
            }
        };
        compensation.actual_arm().forward_kinematics(&commanded).distance_and_angle(&meant)
    }
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|it| it.to_bits()).collect()
}
