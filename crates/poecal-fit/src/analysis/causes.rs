//! Descriptions of undetermined and weakly determined directions. Each rule looks for one cause in the configurations. It explains the
//! directions that would be determined if the quantities it names were known (theory.md §7 (36a)).

use nalgebra::{DMatrix, Matrix3, Vector3};

use super::direction::{Cause, Direction};
use super::excitation::{Excitation, ToolTurning};
use super::open_offsets::own_offsets;
use super::setup::AnalysisSetup;
use super::spectrum::Spectrum;
use super::subspace;
use crate::parameters::{Parameter, TargetFrame, TargetPlace, Unit};
use poecal_model::robot::{JointKind, Term};

/// Largest range of a joint with small motion: 20°. For a prismatic joint it is this share of the length that a radian counts.
const LITTLE_RAD: f64 = 0.35;
const LITTLE_SLIDE: f64 = 0.2;
/// Smallest squared component of a direction that is named in its description.
pub(crate) const NOTABLE: f64 = 0.02;

/// Directions to be explained.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Degree {
    /// Undetermined directions.
    Undetermined,
    /// This many weakly determined directions, which follow them in the spectrum.
    Weak(usize),
}

/// Descriptions of the undetermined, or of the weakly determined, directions.
pub(crate) fn explain(
    setup: &AnalysisSetup<'_>,
    excitation: &Excitation,
    spectrum: &Spectrum,
    degree: Degree,
) -> Vec<Direction> {
    let (first, count) = match degree {
        Degree::Undetermined => (0, spectrum.undetermined),
        Degree::Weak(count) => (spectrum.undetermined, count),
    };
    // With fewer numbers than unknowns, weak directions mean nothing.
    let too_few = excitation.numbers < setup.layout.dim();
    if count == 0 || too_few && degree != Degree::Undetermined {
        return Vec::new();
    }
    let space = spectrum.vectors.columns(first, count).into_owned();
    let mut rules = ExplainedDirections { setup, excitation, spectrum, degree, unexplained: space, found: Vec::new() };
    // Offsets beside screws are a structural kernel, reported as such.
    let own = own_offsets(setup);
    let offsets = rules.places(|parameter| {
        let term = parameter.value_term();
        term.is_some_and(|it| it.term != Term::OFFSET || own.iter().all(|(joint, _)| *joint != it.joint))
    });
    rules.take(&offsets);
    rules.explain_unseen_joints();
    rules.size();
    rules.stood_still();
    rules.too_few();
    rules.point_on_axis();
    rules.orientation();
    rules.moved_together();
    rules.small_motion();
    rules.dependent_motion();
    rules.explain_other_directions();
    rules.found
}

/// Directions to be explained, and the descriptions found so far.
pub(crate) struct ExplainedDirections<'a> {
    pub(crate) setup: &'a AnalysisSetup<'a>,
    pub(crate) excitation: &'a Excitation,
    pub(crate) spectrum: &'a Spectrum,
    pub(crate) degree: Degree,
    /// Directions that no rule has explained yet.
    pub(crate) unexplained: DMatrix<f64>,
    pub(crate) found: Vec<Direction>,
}

impl ExplainedDirections<'_> {
    /// Removes the dimensions that would be determined if these directions were known, and returns their number.
    pub(crate) fn take(&mut self, directions: &[Vec<f64>]) -> usize {
        if self.unexplained.ncols() == 0 {
            return 0;
        }
        let (left, taken) = subspace::remove_directions(&self.unexplained, directions);
        self.unexplained = left;
        taken
    }

    fn unit(&self, place: usize) -> Vec<f64> {
        let mut unit = vec![0.0; self.setup.layout.dim()];
        unit[place] = 1.0;
        unit
    }

    /// Unit vectors of the unknowns of some parameters.
    pub(crate) fn places(&self, chosen: impl Fn(&Parameter) -> bool) -> Vec<Vec<f64>> {
        let parameters = self.setup.layout.parameters().filter(|(parameter, _)| chosen(parameter));
        parameters.flat_map(|(_, places)| places.iter().map(|&(place, _)| self.unit(place))).collect()
    }

    pub(crate) fn screws(&self, joints: &[usize]) -> Vec<Vec<f64>> {
        self.places(|parameter| joint_of(parameter).is_some_and(|joint| joints.contains(&joint)))
    }

    pub(crate) fn add(&mut self, cause: Cause, joints: &[usize], directions: usize, description: String) {
        let joints = joints.iter().map(|&joint| self.name(joint).to_owned()).collect();
        self.found.push(Direction { description, joints, cause, directions });
    }

    pub(crate) fn name(&self, joint: usize) -> &str {
        self.setup.session.robot.joints.get(joint).map_or("", |joint| &joint.name)
    }

    pub(crate) fn names(&self, joints: &[usize]) -> String {
        join(&joints.iter().map(|&joint| self.name(joint).to_owned()).collect::<Vec<_>>())
    }

    /// Predicate of a description: `open` for undetermined directions, else the standard deviation along them.
    pub(crate) fn degree_words(&self, open: &str, plural: bool, directions: &[Vec<f64>]) -> String {
        let Degree::Weak(count) = self.degree else { return open.to_owned() };
        let first = self.spectrum.undetermined;
        let sigma_m = directions
            .iter()
            .map(|direction| {
                let along = |k: usize| {
                    let vector = self.spectrum.vectors.column(k);
                    vector.iter().zip(direction).map(|(a, b)| a * b).sum::<f64>()
                };
                (first..first + count).map(|k| (along(k) * self.spectrum.sigma_m(k)).powi(2)).sum::<f64>()
            })
            .fold(0.0, f64::max)
            .sqrt();
        let verb = if plural { "are" } else { "is" };
        let length = format!("{:.1} mm", sigma_m * 1e3);
        let angle = format!("{:.2} deg", (sigma_m / self.setup.session.length_m).to_degrees());
        let known = match self.units(directions) {
            (true, false) => length,
            (false, _) => angle,
            (true, true) => format!("{length} or {angle}"),
        };
        format!("{verb} known to {known} only (without the prior)")
    }

    /// Marks whether directions have a component in metres, and one in radians.
    fn units(&self, directions: &[Vec<f64>]) -> (bool, bool) {
        let (mut lengths, mut angles) = (false, false);
        for (parameter, places) in self.setup.layout.parameters() {
            for (column, &(place, _)) in parameter.model().columns().iter().zip(places) {
                let concerned = directions.iter().any(|direction| direction[place].powi(2) > NOTABLE);
                match column.unit {
                    Unit::Metre => lengths |= concerned,
                    Unit::Radian | Unit::One | Unit::Second => angles |= concerned,
                }
            }
        }
        (lengths, angles)
    }

    fn stood_still(&mut self) {
        // Joint by joint, so that one is named only if its own stillness hides something.
        let still = (0..self.excitation.still.len()).filter(|&joint| self.excitation.still[joint]);
        let (mut joints, mut directions, mut all) = (Vec::new(), 0, 0);
        for joint in still {
            let screw = self.screws(&[joint]);
            let taken = self.take(&screw);
            if taken > 0 {
                joints.push(joint);
                directions += taken;
                all += screw.len();
            }
        }
        if joints.is_empty() {
            return;
        }
        let jittered = joints.iter().any(|&joint| self.excitation.ranges[joint] > 0.0);
        let what = if jittered { "stood still but for the jitter of readings" } else { "never moved" };
        let several = joints.len() > 1;
        let (subject, open) =
            if several { ("their screws", "are undetermined") } else { ("its screw", "is undetermined") };
        let part = if directions < all { "part of " } else { "" };
        let words = self.degree_words(open, several, &self.screws(&joints));
        let description = format!("{} {what}: {part}{subject} {words}", self.names(&joints));
        self.add(Cause::StoodStill, &joints, directions, description);
    }

    fn too_few(&mut self) {
        let (numbers, unknowns) = (self.excitation.numbers, self.setup.layout.dim());
        if self.unexplained.ncols() == 0 || numbers >= unknowns {
            return;
        }
        let (rows, configurations) = (self.setup.rows.len(), self.excitation.configurations);
        let description = if configurations < rows {
            format!(
                "too few configurations: {rows} rows repeat {configurations}, which are {numbers} numbers for {unknowns} unknowns"
            )
        } else {
            format!("too few rows: {numbers} numbers for {unknowns} unknowns")
        };
        let directions = self.take(&self.places(|_| true));
        self.add(Cause::TooFew, &[], directions, description);
    }

    fn point_on_axis(&mut self) {
        let on_axis: Vec<usize> = (0..self.excitation.still.len())
            .filter(|&joint| !self.excitation.still[joint] && self.excitation.on_axis_m[joint].is_some())
            .collect();
        let mut taken = Vec::new();
        for &joint in &on_axis {
            let tilts = self.tilts(joint);
            let directions = self.take(&tilts);
            if directions > 0 {
                taken.push((joint, directions, tilts));
            }
        }
        if taken.is_empty() {
            return;
        }
        let joints: Vec<usize> = taken.iter().map(|(joint, _, _)| *joint).collect();
        let directions = taken.iter().map(|(_, directions, _)| directions).sum();
        let tilts: Vec<Vec<f64>> = taken.into_iter().flat_map(|(_, _, tilts)| tilts).collect();
        let away_m = joints.iter().filter_map(|&joint| self.excitation.on_axis_m[joint]).fold(0.0, f64::max);
        let several_axes = joints.len() > 1;
        let open = if several_axes { "are not determined" } else { "is not determined" };
        let words = self.degree_words(open, several_axes, &tilts);
        let several_targets = self.setup.session.data.targets.len() > 1;
        let (targets, one) = if several_targets { ("all targets are", "one") } else { ("the target is", "the target") };
        let (axes, tilt, off) = if several_axes {
            ("the axes", "the tilts of these axes", "these axes")
        } else {
            ("the axis", "the tilt of this axis", "the axis")
        };
        let description = format!(
            "{targets} on {axes} of {} (within {} mm), so {tilt} {words}; mount {one} off {off}",
            self.names(&joints),
            round_figure(away_m * 1e3)
        );
        self.add(Cause::PointOnAxis, &joints, directions, description);
    }

    /// Unit vectors of the unknowns that tilt a joint's axis; of a free screw all of them.
    fn tilts(&self, joint: usize) -> Vec<Vec<f64>> {
        let mut tilts = Vec::new();
        for (parameter, places) in self.setup.layout.parameters() {
            if joint_of(parameter) == Some(joint) {
                let columns = parameter.model().columns().iter().zip(places);
                let tilting = columns.filter(|(column, _)| column.unit == Unit::Radian);
                tilts.extend(tilting.map(|(_, &(place, _))| self.unit(place)));
            }
        }
        tilts
    }

    fn orientation(&mut self) {
        let directions: Vec<Vec<f64>> = match self.excitation.turning {
            ToolTurning::Freely => return,
            ToolTurning::Not => Matrix3::identity().column_iter().map(|u| self.shift(&u.into_owned())).collect(),
            ToolTurning::About(direction) => vec![self.shift(&direction)],
        };
        let before = self.unexplained.ncols();
        let mut taken = self.take(&directions);
        if taken == 0 {
            return;
        }
        let words = self.degree_words("cannot be separated", true, &directions);
        let (cause, description) = if self.excitation.turning == ToolTurning::Not {
            let tool = "the tool kept one orientation: its place on the last link and where the axes stand";
            (Cause::OneOrientation, format!("{tool} {words}"))
        } else {
            let tool = "the tool turned about one direction only: along it, its place on the last link and where the axes stand";
            (Cause::OneTurningDirection, format!("{tool} {words}"))
        };
        // Other directions that the joints hide by keeping the orientation have the same cause.
        if cause == Cause::OneOrientation && self.unexplained.ncols() > 0 && self.hidden_by_combination() >= before {
            taken += self.take(&self.places(|_| true));
        }
        let turns = |&joint: &usize| {
            !self.excitation.still[joint] && self.setup.session.robot.joints[joint].kind == JointKind::Revolute
        };
        let joints: Vec<usize> = (0..self.excitation.still.len()).filter(turns).collect();
        self.add(cause, &joints, taken, description);
    }

    /// Motion of all axes in one direction of the base, and of the tool by as much in the opposite direction on its link. The direction is
    /// constant in the axes of the last link. The motion is without effect if the link never turns that direction.
    fn shift(&self, direction: &Vector3<f64>) -> Vec<f64> {
        let estimate = self.setup.estimate;
        let last = self.excitation.last_joint.and_then(|joint| estimate.base_from_axis.get(joint));
        let turn = last.map_or_else(Matrix3::identity, |last| last.rotation);
        let seen = estimate.device_from_base.rotation.transpose() * self.excitation.mean_turn * direction;
        let tool = turn * direction - seen;
        let mut shift = vec![0.0; self.setup.layout.dim()];
        for (parameter, places) in self.setup.layout.parameters() {
            let (frame, by) = match parameter {
                Parameter::TargetPlace(TargetPlace { target }) | Parameter::TargetFrame(TargetFrame { target, .. }) => {
                    (estimate.base_from_target[*target].rotation, tool)
                }
                Parameter::ScrewAxis(axis) => (estimate.base_from_axis[axis.joint].rotation, -seen),
                Parameter::OtherScrew(_)
                | Parameter::ValueTerm(_)
                | Parameter::DeviceFrame(_)
                | Parameter::RangeUnknown(_)
                | Parameter::ClockUnknown(_) => continue,
            };
            let columns = parameter.model().columns().iter().zip(places);
            let shifting = columns.filter(|(column, _)| column.unit == Unit::Metre);
            for ((_, &(place, _)), part) in shifting.zip((frame.transpose() * by).iter()) {
                shift[place] = *part;
            }
        }
        let norm = shift.iter().map(|part| part * part).sum::<f64>().sqrt();
        shift.iter_mut().for_each(|part| *part /= norm.max(f64::MIN_POSITIVE));
        shift
    }

    fn moved_together(&mut self) {
        let excitation = self.excitation;
        for group in &excitation.together {
            let screws = self.screws(group);
            let directions = self.take(&screws);
            if directions == 0 {
                continue;
            }
            let kinds = || group.iter().map(|&joint| self.setup.session.robot.joints[joint].kind);
            let (what, subject) = if kinds().all(|kind| kind == JointKind::Prismatic) {
                ("moved only together", "only their common motion is observed, their own directions")
            } else if self.excitation.are_parallel(group) {
                ("parallel axes, moved only together", "their places")
            } else {
                ("moved only in a fixed relation", "their screws")
            };
            let open = if subject.starts_with("only") { "are not determined" } else { "cannot be separated" };
            let words = self.degree_words(open, true, &screws);
            let description = format!("{}: {what}: {subject} {words}", self.names(group));
            self.add(Cause::MovedTogether, group, directions, description);
        }
    }

    fn small_motion(&mut self) {
        let joints = &self.setup.session.robot.joints;
        let ranges = &self.excitation.ranges;
        let mut little: Vec<usize> = (0..joints.len())
            .filter(|&joint| {
                let least = match joints[joint].kind {
                    JointKind::Revolute => LITTLE_RAD,
                    JointKind::Prismatic => LITTLE_SLIDE * self.setup.session.length_m,
                };
                !self.excitation.still[joint] && ranges[joint] < least
            })
            .collect();
        little.sort_by(|&a, &b| ranges[a].total_cmp(&ranges[b]));
        for joint in little {
            let screw = self.screws(&[joint]);
            let directions = self.take(&screw);
            if directions > 0 {
                let by = match joints[joint].kind {
                    JointKind::Revolute => format!("{} deg", round_figure(ranges[joint].to_degrees())),
                    JointKind::Prismatic => format!("{} mm", round_figure(ranges[joint] * 1e3)),
                };
                let part = if directions < screw.len() { "part of " } else { "" };
                let words = self.degree_words("is lost in the noise", false, &screw);
                let description = format!("{} moved by {by} only: {part}its screw {words}", self.name(joint));
                self.add(Cause::SmallMotion, &[joint], directions, description);
            }
        }
    }
}

pub(crate) fn joint_of(parameter: &Parameter) -> Option<usize> {
    match parameter {
        Parameter::ScrewAxis(axis) => Some(axis.joint),
        Parameter::OtherScrew(screw) => Some(screw.joint),
        Parameter::ValueTerm(offset) => Some(offset.joint),
        Parameter::TargetPlace(_)
        | Parameter::TargetFrame(_)
        | Parameter::DeviceFrame(_)
        | Parameter::RangeUnknown(_)
        | Parameter::ClockUnknown(_) => None,
    }
}

/// A figure with about two digits.
fn round_figure(value: f64) -> String {
    if value < 9.95 { format!("{value:.1}") } else { format!("{value:.0}") }
}

pub(crate) fn join(parts: &[String]) -> String {
    match parts.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        Some((last, _)) => last.clone(),
        None => String::new(),
    }
}
