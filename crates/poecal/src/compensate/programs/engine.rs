//! Corrects the targets of a program.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::f64::consts::TAU;
use std::ops::Range;

use super::super::{ChangeOptions, Compensated, Compensation, Outcome, Summary};
use super::forms::PoseForm;
use super::given::Given;
use super::parsed::{Meant, Motion, Number, Parsed, Target};
use super::place::PoseCompensation;
use super::stated::Stated;
use crate::error::Result;
use crate::lie::Pose;
use crate::robot::{Counting, Robot};

/// Reasons for which a target stays as it is.
mod reason {
    use std::borrow::Cow;

    pub(super) const NO_MOTION: Cow<'static, str> = Cow::Borrowed(
        "no motion of this file goes there: its tool and frame are not known, so correct it with the file that moves to it",
    );
    pub(super) const NO_TOOL: Cow<'static, str> = Cow::Borrowed("the tool is not known: state it by --tool");
    pub(super) const NO_FRAME: Cow<'static, str> =
        Cow::Borrowed("the frame is not known: state it by --frame");
    pub(super) const TWO_PLACES: Cow<'static, str> =
        Cow::Borrowed("it is used with several tools or frames: make a target for each");
    pub(super) const TWO_WAYS: Cow<'static, str> =
        Cow::Borrowed("it is reached in several configurations: make a target for each");
    pub(super) const NOTHING_STATED: Cow<'static, str> = Cow::Borrowed(
        "the program states no configuration, and the one before is not known: state where the robot starts by --start, or begin with a joint target",
    );
    pub(super) const WAY: Cow<'static, str> = Cow::Borrowed(
        "the way to it passes a singularity, or leaves the nominal robot's reach or limits: make it a joint target",
    );
    pub(super) const UNREACHABLE: Cow<'static, str> =
        Cow::Borrowed("the nominal robot does not reach it: check --tool, --frame, --base and --flange");
    pub(super) const NONE_FITS: Cow<'static, str> = Cow::Borrowed(
        "no configuration of the nominal robot fits the one that is stated: check it, --base and --flange",
    );
    pub(super) const SEVERAL_FIT: Cow<'static, str> = Cow::Borrowed(
        "several configurations of the nominal robot fit the one that is stated: make it a joint target",
    );
    pub(super) const NOT_SURE: Cow<'static, str> = Cow::Borrowed(
        "it is not sure which configuration is the nearest to the one before: make it a joint target",
    );
    pub(super) const OTHER: Cow<'static, str> = Cow::Borrowed(
        "the configuration that is stated is not the one to which the motion before leads: check both",
    );
    pub(super) const SINGULAR: Cow<'static, str> =
        Cow::Borrowed("it is at a singularity: make it a joint target");
    pub(super) const LIMITS: Cow<'static, str> =
        Cow::Borrowed("it is beyond the limits once corrected: move it");
    pub(super) const WORDS: Cow<'static, str> = Cow::Borrowed(
        "the corrected target is in a configuration that the program states otherwise: make it a joint target",
    );
    pub(super) const JOINTS: Cow<'static, str> =
        Cow::Borrowed("poses are corrected of robots with six joints or fewer: make it a joint target");
    pub(super) const NO_BRANCHES: Cow<'static, str> = Cow::Borrowed(
        "all configurations of a pose are known of robots with six turning joints alone: make it a joint target",
    );
    pub(super) const NOT_A_POSE: Cow<'static, str> = Cow::Borrowed("its numbers are no pose");
}

type Reason = Cow<'static, str>;

/// Distance (m) and angle (rad) that rounding may leave of a corrected target.
const ROUNDING: f64 = 2e-6;

/// A target's place while it is worked on.
#[derive(Clone, Debug, PartialEq)]
struct Placed {
    tool: Pose,
    frame: Pose,
    q: Vec<f64>,
    stated: Stated,
}

/// What becomes of a target.
#[derive(Clone, Debug)]
enum Fate {
    Open,
    Placed(Box<Placed>),
    Listed(Reason, usize),
}

/// A corrected program.
pub(crate) struct Corrected {
    /// Its text.
    pub(crate) text: Vec<u8>,
    /// Targets that were corrected, and the configurations that they mean.
    pub(crate) meant: Vec<(usize, Vec<f64>)>,
    /// What changes, and what stays as it is.
    pub(crate) summary: Summary,
}

/// Corrects a program's targets one after the other.
pub(crate) struct Engine<'e> {
    pub(crate) poses: PoseCompensation,
    pub(crate) given: &'e Given,
    /// Where the controller counts other readings than the model has.
    pub(crate) counting: Option<Counting>,
    robots: (&'e Robot, &'e Robot),
    factors: &'e [f64],
    options: &'e ChangeOptions,
    /// Readings that programs state as external axes: they stay as they are, and the others are corrected for them.
    external: Vec<usize>,
    /// The compensation at each of their values, by the bits of these.
    held: BTreeMap<Vec<u64>, PoseCompensation>,
}

impl<'e> Engine<'e> {
    pub(crate) fn new(
        robots: (&'e Robot, &'e Robot),
        factors: &'e [f64],
        given: &'e Given,
        options: &'e ChangeOptions,
    ) -> Result<Self> {
        let poses = PoseCompensation::new(robots.0, robots.1, factors, options)?;
        let (external, held) = (Vec::new(), BTreeMap::new());
        Ok(Engine { poses, given, counting: None, robots, factors, options, external, held })
    }

    /// Holds external axes at the values of each target.
    pub(crate) fn hold(&mut self, external: Vec<usize>, parsed: &Parsed) -> Result<()> {
        self.external = external;
        if self.external.is_empty() {
            return Ok(());
        }
        for target in &parsed.targets {
            let values = self.stated(target);
            if let Entry::Vacant(place) = self.held.entry(bits(&values)) {
                let held: Vec<(usize, f64)> = self.external.iter().copied().zip(values).collect();
                let (nominal, actual) = self.robots;
                let readings = Compensation::holding(nominal, actual, self.factors, &held, self.options)?;
                place.insert(PoseCompensation::of(readings));
            }
        }
        Ok(())
    }

    /// Values of the external axes at a target (rad, m).
    fn stated(&self, target: &Target) -> Vec<f64> {
        let numbers: Vec<f64> = target.numbers.iter().map(Number::scaled).collect();
        match target.meant {
            Meant::Joints => self.external_of(&self.readings(numbers)),
            // The last ones.
            Meant::Pose(_) => {
                numbers.get(numbers.len().saturating_sub(self.external.len())..).unwrap_or_default().to_vec()
            }
        }
    }

    fn external_of(&self, q: &[f64]) -> Vec<f64> {
        self.external.iter().map(|&it| q.get(it).copied().unwrap_or(0.0)).collect()
    }

    /// The compensation at these values of the external axes.
    fn holding(&self, external: &[f64]) -> &PoseCompensation {
        self.held.get(&bits(external)).unwrap_or(&self.poses)
    }

    /// The compensation at a configuration.
    pub(crate) fn at(&self, q: &[f64]) -> &PoseCompensation {
        self.holding(&self.external_of(q))
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

    /// What the controller counts at readings of the model.
    fn counted(&self, readings: &[f64]) -> Vec<f64> {
        self.counting.as_ref().map_or_else(|| readings.to_vec(), |it| it.counted(readings))
    }

    /// The arm's readings at a configuration, and the same as they are counted.
    fn both(&self, q: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let poses = self.at(q);
        (poses.of_arm(q), poses.of_arm(&self.counted(q)))
    }

    /// Corrects all targets of a text.
    pub(crate) fn correct(&mut self, text: &[u8], parsed: Parsed, each: bool) -> Corrected {
        let fates = self.fates(&parsed);
        let mut summary = Summary::new(self.poses.compensation());
        summary.listed.clone_from(&parsed.listed);
        summary.targets = each.then(Vec::new);
        let mut changes: Vec<(Range<usize>, String)> = Vec::new();
        let mut meant = Vec::new();
        for (index, (target, fate)) in parsed.targets.iter().zip(fates).enumerate() {
            let made = match fate {
                Fate::Open => Err(reason::NO_MOTION),
                Fate::Listed(reason, line) if line == target.line => Err(reason),
                Fate::Listed(reason, line) => Err(format!("{reason} (motion on line {line})").into()),
                Fate::Placed(placed) => self.write(target, &placed, &mut summary).map(|it| (it, placed.q)),
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
        Corrected { text: replaced(text, changes), meant, summary }
    }

    /// What the motions make of each target.
    fn fates(&self, parsed: &Parsed) -> Vec<Fate> {
        let mut fates: Vec<Fate> = parsed.targets.iter().map(|it| self.alone(it)).collect();
        let mut reached: Vec<Option<Vec<f64>>> = Vec::with_capacity(parsed.motions.len());
        let start = self.given.start.clone().map(|it| self.readings(it));
        for (number, motion) in parsed.motions.iter().enumerate() {
            let (Some(target), Some(fate)) =
                (parsed.targets.get(motion.target), fates.get_mut(motion.target))
            else {
                reached.push(None);
                continue;
            };
            let before = match motion.after {
                Some(before) => reached.get(before).and_then(Option::as_deref),
                None => start.as_deref().filter(|_| number == 0),
            };
            let placed = match (&target.meant, &*fate) {
                (Meant::Joints, _) if motion.refused.is_some() => {
                    Err(motion.refused.clone().unwrap_or_default().into())
                }
                (Meant::Joints, Fate::Placed(placed)) => Ok(Placed::clone(placed)),
                (Meant::Joints, Fate::Open | Fate::Listed(..)) => Err(reason::NOT_A_POSE),
                (Meant::Pose(form), _) => self.place(target, *form, motion, before),
            };
            reached.push(placed.as_ref().ok().map(|it| it.q.clone()));
            *fate = joined(std::mem::replace(fate, Fate::Open), placed, motion.line);
        }
        fates
    }

    /// What is known of a target without its motions.
    fn alone(&self, target: &Target) -> Fate {
        match target.meant {
            Meant::Pose(_) => Fate::Open,
            Meant::Joints => Fate::Placed(Box::new(Placed {
                tool: Pose::identity(),
                frame: Pose::identity(),
                q: self.readings(target.numbers.iter().map(Number::scaled).collect()),
                stated: Stated::Nothing,
            })),
        }
    }

    /// Where a motion to a pose leads.
    fn place(
        &self,
        target: &Target,
        form: PoseForm,
        motion: &Motion,
        before: Option<&[f64]>,
    ) -> std::result::Result<Placed, Reason> {
        let external = self.stated(target);
        let joints = self.holding(&external).compensation().readings().len();
        if joints > 6 {
            return Err(reason::JOINTS);
        }
        if let Some(reason) = &motion.refused {
            return Err(reason.clone().into());
        }
        let tool = motion.tool.ok_or(reason::NO_TOOL)?;
        let frame = motion.frame.ok_or(reason::NO_FRAME)?;
        let numbers: Vec<f64> = target.numbers.iter().map(Number::scaled).collect();
        let pose = form.pose(numbers.get(..form.names().len()).unwrap_or(&[])).ok_or(reason::NOT_A_POSE)?;
        let tip_from_tool = self.given.flange * tool;
        let base_from_tip = self.given.base * frame * pose * tip_from_tool.inverse();
        let q = self.configuration(motion, &base_from_tip, &tip_from_tool, (before, &external))?;
        if self.at(&q).is_singular(&q) {
            return Err(reason::SINGULAR);
        }
        Ok(Placed { tool, frame, q, stated: motion.stated.clone() })
    }

    fn configuration(
        &self,
        motion: &Motion,
        target: &Pose,
        tip_from_tool: &Pose,
        (before, external): (Option<&[f64]>, &[f64]),
    ) -> std::result::Result<Vec<f64>, Reason> {
        let poses = self.holding(external);
        let nominal = poses.compensation().nominal();
        // Where external axes move on the way too, it is none of the arm alone.
        let is_straight = motion.is_straight && before.is_none_or(|it| self.external_of(it) == external);
        match (&motion.stated, before) {
            (Stated::Near(near), _) => self.nearest(target, &self.readings(near.clone()), external),
            (Stated::Nothing, None) => Err(reason::NOTHING_STATED),
            (Stated::Nothing, Some(before)) if !is_straight => self.nearest(target, before, external),
            (stated, Some(before)) if is_straight => {
                let found = poses.follow(before, target, tip_from_tool).ok_or(reason::WAY)?;
                let fits = stated.fits(nominal, &self.both(&found));
                if fits { Ok(found) } else { Err(reason::OTHER) }
            }
            _ if !poses.has_branches() => Err(reason::NO_BRANCHES),
            (stated, _) => {
                let all = poses.all(target).into_iter();
                let mut all: Vec<Vec<f64>> = all.map(|q| self.with_external(q, external)).collect();
                if all.is_empty() {
                    return Err(reason::UNREACHABLE);
                }
                all.retain(|q| stated.fits(nominal, &self.both(q)));
                if all.len() > 1 {
                    all.retain(|q| stated.fits_best(nominal, &poses.of_arm(q)));
                }
                match all.len() {
                    0 => Err(reason::NONE_FITS),
                    1 => all.pop().ok_or(reason::NONE_FITS),
                    _ => Err(reason::SEVERAL_FIT),
                }
            }
        }
    }

    fn nearest(
        &self,
        target: &Pose,
        near: &[f64],
        external: &[f64],
    ) -> std::result::Result<Vec<f64>, Reason> {
        let poses = self.holding(external);
        if !poses.has_branches() {
            return Err(reason::NO_BRANCHES);
        }
        let found = poses.nearest(target, near).map(|q| self.with_external(q, external));
        found.ok_or_else(|| if poses.all(target).is_empty() { reason::UNREACHABLE } else { reason::NOT_SURE })
    }

    /// The changed numbers of a target that is placed, each with its bytes.
    fn write(
        &mut self,
        target: &Target,
        placed: &Placed,
        summary: &mut Summary,
    ) -> std::result::Result<Vec<(Range<usize>, String)>, Reason> {
        let held = bits(&self.external_of(&placed.q));
        let (told, found) = self.held.get_mut(&held).unwrap_or(&mut self.poses).at(&placed.q);
        let (outcome, left) = (found.outcome, (found.left_m, found.left_rad));
        let (is_corrected, moved) = (found.is_corrected, (found.moved_m, found.turned_rad));
        let readings = found.readings.to_vec();
        if !is_corrected {
            return Err(self.at(&placed.q).compensation().reason(outcome, left));
        }
        let numbers = match target.meant {
            Meant::Joints => self.commanded(target, &placed.q, &readings),
            Meant::Pose(form) => {
                if self.at(&placed.q).compensation().is_beyond_limits(&readings) {
                    return Err(reason::LIMITS);
                }
                let nominal = self.at(&placed.q).compensation().nominal();
                let tip_from_tool = self.given.flange * placed.tool;
                let pose = (self.given.base * placed.frame).inverse() * told * tip_from_tool;
                let before: Vec<f64> = target.numbers.iter().map(Number::scaled).collect();
                let count = form.names().len();
                let mut numbers = form.numbers(&pose, before.get(..count).unwrap_or(&[]));
                let words = placed.stated.words(nominal, &self.both(&readings));
                numbers.extend(words.ok_or(reason::WORDS)?);
                numbers
            }
        };
        let texts: Vec<String> = target
            .numbers
            .iter()
            .zip(&numbers)
            .enumerate()
            .map(|(at, it)| number(at, it, target.meant))
            .collect();
        let written = self.left(target, placed, &readings, &texts, left);
        let is_exact = outcome == Outcome::Reached;
        let most = if is_exact { (ROUNDING, ROUNDING) } else { (left.0 + ROUNDING, left.1 + ROUNDING) };
        if matches!(target.meant, Meant::Pose(_)) && (written.0 > most.0 || written.1 > most.1) {
            return Err(reason::SINGULAR);
        }
        let told = Compensated {
            readings: &readings,
            moved_m: moved.0,
            turned_rad: moved.1,
            left_m: written.0,
            left_rad: written.1,
            outcome,
            is_corrected,
        };
        summary.include(target.line, &placed.q, &told);
        let changed = target.numbers.iter().zip(texts).filter(|(_, text)| !text.is_empty());
        Ok(changed.map(|(number, text)| (number.range.clone(), text)).collect())
    }

    /// The numbers of a joint target once its readings are changed.
    fn commanded(&self, target: &Target, from: &[f64], to: &[f64]) -> Vec<f64> {
        let Some(counting) = &self.counting else { return to.to_vec() };
        let stated: Vec<f64> = target.numbers.iter().map(Number::scaled).collect();
        counting.moved(&stated, from, to)
    }

    /// Distance and angle that are left with the numbers as they are written.
    fn left(
        &self,
        target: &Target,
        placed: &Placed,
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
        let poses = self.at(&placed.q);
        let compensation = poses.compensation();
        let meant = compensation.nominal().forward_kinematics(&poses.of_arm(&placed.q));
        let commanded = match target.meant {
            Meant::Joints => poses.of_arm(&self.readings(written)),
            Meant::Pose(form) => {
                let Some(pose) = form.pose(written.get(..form.names().len()).unwrap_or(&[])) else {
                    return unrounded;
                };
                let tip_from_tool = self.given.flange * placed.tool;
                let told = self.given.base * placed.frame * pose * tip_from_tool.inverse();
                let mut q = poses.of_arm(readings);
                compensation.nominal().nearest(&told, &mut q);
                q
            }
        };
        compensation.actual().forward_kinematics(&commanded).apart(&meant)
    }
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|it| it.to_bits()).collect()
}

/// What another motion, on this line, makes of a target.
fn joined(fate: Fate, placed: std::result::Result<Placed, Reason>, line: usize) -> Fate {
    match (fate, placed) {
        (Fate::Open, Ok(placed)) => Fate::Placed(Box::new(placed)),
        (Fate::Open | Fate::Placed(_), Err(reason)) => Fate::Listed(reason, line),
        (Fate::Listed(reason, line), _) => Fate::Listed(reason, line),
        (Fate::Placed(one), Ok(other)) => match differs(&one, &other) {
            Some(reason) => Fate::Listed(reason, line),
            None => Fate::Placed(one),
        },
    }
}

/// In what two motions to one target differ.
fn differs(one: &Placed, other: &Placed) -> Option<Reason> {
    let is_same = |a: &Pose, b: &Pose| {
        let (metres, radians) = a.apart(b);
        metres < 1e-12 && radians < 1e-12
    };
    if !is_same(&one.tool, &other.tool) || !is_same(&one.frame, &other.frame) {
        return Some(reason::TWO_PLACES);
    }
    let is_turned = |a: &f64, b: &f64| {
        let turns = ((a - b) / TAU).round();
        (a - b - turns * TAU).abs() > 1e-6
    };
    one.q.iter().zip(&other.q).any(|(a, b)| is_turned(a, b)).then_some(reason::TWO_WAYS)
}

/// A number as it is written; empty if it stays as it is.
fn number(at: usize, (number, value): (&Number, &f64), meant: Meant) -> String {
    let count = match meant {
        Meant::Joints => usize::MAX,
        Meant::Pose(form) => form.names().len(),
    };
    if at >= count {
        let is_same = (value - number.value).abs() < 0.5;
        return if is_same { String::new() } else { format!("{value:.0}") };
    }
    let least = match meant {
        Meant::Pose(form) if number.scale == 1.0 => form.decimals(at),
        Meant::Pose(_) | Meant::Joints => match number.scale.abs() {
            it if it >= 0.5 => 9,
            it if it >= 0.01 => 7,
            _ => 6,
        },
    };
    let decimals = number.decimals.max(least).min(17);
    let value = value / number.scale;
    if (value - number.value).abs() < 0.5 * 10_f64.powi(-(decimals as i32)) {
        return String::new();
    }
    let text = format!("{value:.decimals$}");
    let is_zero = text.bytes().all(|it| matches!(it, b'-' | b'0' | b'.'));
    if is_zero { text.replace('-', "") } else { text }
}

/// A number with its sign as the old one has it: the spaces behind it stay, and a plus.
fn with_sign_as(old: &[u8], new: String) -> String {
    let Some(sign @ (b'+' | b'-')) = old.first() else { return new };
    let gap: String =
        old[1..].iter().take_while(|it| it.is_ascii_whitespace()).map(|&it| char::from(it)).collect();
    match (new.strip_prefix('-'), sign) {
        (Some(digits), _) => format!("-{gap}{digits}"),
        (None, b'+') => format!("+{gap}{new}"),
        (None, _) => format!("{gap}{new}"),
    }
}

/// A text with other bytes in some ranges.
fn replaced(text: &[u8], mut changes: Vec<(Range<usize>, String)>) -> Vec<u8> {
    changes.sort_by_key(|(range, _)| range.start);
    let mut out = Vec::with_capacity(text.len() + 4 * changes.len());
    let mut at = 0;
    for (range, new) in changes {
        out.extend_from_slice(text.get(at..range.start).unwrap_or_default());
        out.extend_from_slice(new.as_bytes());
        at = range.end;
    }
    out.extend_from_slice(text.get(at..).unwrap_or_default());
    out
}
